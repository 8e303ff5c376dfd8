// Runs a sketch case by case. The UART receives a case: step time and step limit, six tuples (left, right, whether larger,
// threshold), the clock at the start, the time of a button press after the first motor command, and the pulses of the
// sensor in microseconds. It sends the motors whenever they are set, the ending, and the largest number of cycles of a step.
#include <avr/interrupt.h>
#include <avr/sleep.h>

#include "uart.h"

enum { MAX_PULSES = 64, NO_ECHO_US = 65535, DEAD_US = 65534 };
static uint16_t pulses_us[MAX_PULSES];
static uint8_t pulse_index;
static bool has_started, is_echo_held;
static uint32_t start_ms, now_ms, press_ms;
static uint8_t levels[14], duties[14];
static bool has_set_motors;
static uint16_t step_start, longest_step;
uint16_t case_step_ms, case_max_steps;
ScriptedSerial Serial;

static void send_motor(uint8_t direction, uint8_t brake, uint8_t power) {
  send(' ');
  if (levels[brake]) {
    send_text("brake");
  } else {
    send_number(levels[direction] ? duties[power] : -(int16_t)duties[power]);
  }
}

// Sends the motors if they were set since the last call.
static void send_motors() {
  if (!has_set_motors) {
    return;
  }
  has_set_motors = false;
  if (!has_started) {
    has_started = true;
    start_ms = now_ms;
  }
  send_number(now_ms - start_ms);
  send_motor(LEFT_DIRECTION, LEFT_BRAKE, LEFT_POWER);
  send_motor(RIGHT_DIRECTION, RIGHT_BRAKE, RIGHT_POWER);
  send('\n');
}

// A step has done its work when it next reads the time.
static void end_step() {
  uint16_t cycles = TCNT1 - step_start;
  if (step_start != 0 && cycles > longest_step) {
    longest_step = cycles;
  }
  step_start = 0;
}

void ScriptedSerial::println(const __FlashStringHelper *text) {
  end_step();
  send_motors();
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
  send_motors();
  // Requests before the start take no pulse from the script.
  uint16_t pulse_us = pulses_us[has_started ? pulse_index++ : 0];
  step_start = TCNT1 | 1;
  is_echo_held = pulse_us == NO_ECHO_US;
  return pulse_us < DEAD_US ? pulse_us : 0;
}

uint32_t millis() {
  end_step();
  is_echo_held = false;
  send_motors();
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
    pulse_index = 0;
    longest_step = 0;
    has_started = is_echo_held = false;
    setup();
  }
  cli();
  sleep_cpu();
}
