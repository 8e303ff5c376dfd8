// Evaluates networks case by case: the UART receives the number of a network and its inputs, and sends output and cycles.
#include <avr/interrupt.h>
#include <avr/sleep.h>
#include <stdlib.h>

#include "networks.h"
#include "uart.h"

static volatile uint16_t wraps;

ISR(TIMER1_OVF_vect) {
  wraps++;
}

static int32_t evaluate(uint8_t network, const int32_t *in) {
  switch (network) {
    case 1: return network_turn(in[0], in[1], in[2], in[3]);
    case 2: return network_forward(in[0], in[1], in[2], in[3]);
    case 3: return network_lateral(in[0], in[1], in[2], in[3]);
    case 4: return network_echo_probability(in[0], in[1]);
    default: return network_echo_value(in[0], in[1]);
  }
}

int main() {
  begin_uart();
  begin_clock();
  TIMSK1 = 1 << TOIE1;
  for (uint8_t network = receive(); network != 0; network = receive()) {
    int32_t in[4];
    for (uint8_t i = 0; i < (network < 4 ? 4 : 2); i++) {
      in[i] = receive_long();
    }
    wraps = 0;
    TCNT1 = 0;
    sei();
    int32_t out = evaluate(network, in);
    cli();
    uint32_t cycles = ((uint32_t)wraps << 16 | TCNT1) * 8;
    send_number(out);
    send(' ');
    send_number(cycles);
    send('\n');
  }
  sleep_cpu();
}
