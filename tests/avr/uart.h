// Input and output over the first UART.
#pragma once
#include <avr/io.h>
#include <stdint.h>

static void begin_uart() {
  UCSR0A = 1 << U2X0;
  UBRR0 = 0;
  UCSR0B = 1 << RXEN0 | 1 << TXEN0;
}

static uint8_t receive() {
  while (!(UCSR0A & 1 << RXC0)) {
  }
  return UDR0;
}

static uint16_t receive_word() {
  uint16_t low = receive();
  return low | (uint16_t)receive() << 8;
}

static int32_t receive_long() {
  uint32_t low = receive_word();
  return low | (uint32_t)receive_word() << 16;
}

static void send(char byte) {
  while (!(UCSR0A & 1 << UDRE0)) {
  }
  UDR0 = byte;
}

static void send_text(const char *text) {
  while (*text) {
    send(*text++);
  }
}

static void send_number(int32_t number) {
  char digits[12];
  ltoa(number, digits, 10);
  send_text(digits);
}

// Starts a clock that counts every eighth processor cycle.
static void begin_clock() {
  TCCR1B = 1 << CS11;
}
