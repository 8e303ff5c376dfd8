// Runs a sketch case after case. A case comes by the UART: step and step limit, six tuples (left, right, whether larger,
// threshold), the clock at the start, when the button goes down after the motors first ran, and pulses of the sensor in
// microseconds. Back come the motors whenever they were set, the ending, and the most cycles of a step.
#include <avr/interrupt.h>
#include <avr/sleep.h>

#include "uart.h"

enum { MOST_PULSES = 64, NO_ECHO_US = 65535, DEAD_US = 65534 };
static uint16_t pulses_us[MOST_PULSES];
static uint8_t asked;
static bool has_started, is_echo_held;
static uint32_t start_ms, now_ms, press_ms;
static uint8_t levels[14], duties[14];
static bool has_set_motors;
static uint16_t step_began, longest_step;
uint16_t case_step_ms, case_max_steps;
ScriptedSerial Serial;

static void tell_motor(uint8_t direction, uint8_t brake, uint8_t power) {
  send(' ');
  if (levels[brake]) {
    send_text("brake");
  } else {
    send_number(levels[direction] ? duties[power] : -(int16_t)duties[power]);
  }
}

// Tells motors that were set since it was last called.
static void tell_motors() {
  if (!has_set_motors) {
    return;
  }
  has_set_motors = false;
  if (!has_started) {
    has_started = true;
    start_ms = now_ms;
  }
  send_number(now_ms - start_ms);
  tell_motor(LEFT_DIRECTION, LEFT_BRAKE, LEFT_POWER);
  tell_motor(RIGHT_DIRECTION, RIGHT_BRAKE, RIGHT_POWER);
  send('\n');
}

// A step has done its work when it next asks for the time.
static void end_step() {
  uint16_t took = TCNT1 - step_began;
  if (step_began != 0 && took > longest_step) {
    longest_step = took;
  }
  step_began = 0;
}

void ScriptedSerial::println(const __FlashStringHelper *text) {
  end_step();
  tell_motors();
  send_text(reinterpret_cast<const char *>(text));
  send(' ');
  send_number((int32_t)longest_step * 8);
  send('\n');
}

void pinMode(uint8_t, uint8_t) {}
void delayMicroseconds(uint16_t) {}

void digitalWrite(uint8_t pin, uint8_t level) {
  levels[pin] = level;
}

int digitalRead(uint8_t pin) {
  if (pin == STOP_BUTTON) {
    return has_started && now_ms - start_ms >= press_ms ? LOW : HIGH;
  }
  return pin == ECHO ? is_echo_held : levels[pin];
}

void analogWrite(uint8_t pin, int duty) {
  duties[pin] = duty;
  has_set_motors = has_set_motors || pin == RIGHT_POWER;
}

uint32_t pulseIn(uint8_t, uint8_t, uint32_t) {
  tell_motors();
  // Questions before the start take no pulse out of the script.
  uint16_t pulse_us = pulses_us[has_started ? asked++ : 0];
  step_began = TCNT1 | 1;
  is_echo_held = pulse_us == NO_ECHO_US;
  return pulse_us < DEAD_US ? pulse_us : 0;
}

uint32_t millis() {
  end_step();
  is_echo_held = false;
  tell_motors();
  return now_ms;
}

void delay(uint32_t ms) {
  now_ms += ms;
}

int main() {
  begin_uart();
  begin_clock();
  for (case_step_ms = receive_word(); case_step_ms != 0; case_step_ms = receive_word()) {
    case_max_steps = receive_word();
    for (uint8_t i = 0; i < CONTROLLER_TUPLES; i++) {
      controller_tuples[i].motors.left = receive();
      controller_tuples[i].motors.right = receive();
      controller_tuples[i].when_larger = receive() == 1;
      controller_tuples[i].threshold_cm = receive_word();
    }
    now_ms = receive_long();
    press_ms = receive_long();
    uint8_t count = receive();
    for (uint8_t i = 0; i < count; i++) {
      pulses_us[i] = receive_word();
    }
    asked = 0;
    longest_step = 0;
    has_started = is_echo_held = false;
    setup();
  }
  cli();
  sleep_cpu();
}
