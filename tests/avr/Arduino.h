// The part of Arduino.h that a sketch needs, for an AVR in a scripted world: time passes only while the sketch waits, the
// script gives the pulses of the sensor, and the motor pins are reported. See scripted.h.
#pragma once
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>

#define HIGH 1
#define LOW 0
#define INPUT_PULLUP 2
#define OUTPUT 1
#define F(text) (reinterpret_cast<const __FlashStringHelper *>(text))
#define min(a, b) ((a) < (b) ? (a) : (b))

class __FlashStringHelper;

struct ScriptedSerial {
  void begin(uint32_t) {}
  void println(const __FlashStringHelper *text);
};
extern ScriptedSerial Serial;

// The numbers of the controller, which replace the sketch's constants.
extern uint16_t case_step_ms, case_max_steps;

void pinMode(uint8_t pin, uint8_t mode);
void digitalWrite(uint8_t pin, uint8_t level);
int digitalRead(uint8_t pin);
void analogWrite(uint8_t pin, int duty);
uint32_t pulseIn(uint8_t pin, uint8_t level, uint32_t timeout_us);
uint32_t millis();
void delay(uint32_t ms);
void delayMicroseconds(uint16_t us);
