/* Runs an image on an ATmega328P at 16 MHz: `run IMAGE.elf [PULSE_US...]`. The UART is standard input and output, and the
 * run ends when the processor sleeps with interrupts off. With pulses, an HC-SR04 with its trigger on pin 7 and its echo on
 * pin 6 answers with them; 0 means that there is no sensor, -1 a pulse
 * that lasts until the line is pulled low. Then every change of the echo and of the brake and direction pins
 * is printed with its time in microseconds, and the run ends with the first line that the image sends. */
#include <simavr/avr_ioport.h>
#include <simavr/avr_uart.h>
#include <simavr/sim_avr.h>
#include <simavr/sim_elf.h>
#include <stdio.h>
#include <stdlib.h>

enum { FLIGHT_US = 450, ECHO_BIT = 6 };

static avr_t *avr;
static avr_irq_t *uart_in, *echo;
static int can_receive;
static int has_sent_line;
static int is_held;
static char **pulses;

static void discard_log(avr_t *avr, const int level, const char *format, va_list arguments) {}

static void on_sent(struct avr_irq_t *irq, uint32_t byte, void *context) {
  putchar((int)byte);
  has_sent_line |= byte == '\n';
}

static void on_can_receive(struct avr_irq_t *irq, uint32_t value, void *context) {
  can_receive = context != NULL;
}

static avr_cycle_count_t end_pulse(avr_t *avr, avr_cycle_count_t when, void *context) {
  avr_raise_irq(echo, 0);
  return 0;
}

static avr_cycle_count_t begin_pulse(avr_t *avr, avr_cycle_count_t when, void *context) {
  int32_t pulse_us = *(int32_t *)context;
  avr_raise_irq(echo, 1);
  is_held = pulse_us < 0;
  if (!is_held) {
    avr_cycle_timer_register_usec(avr, (uint32_t)pulse_us, end_pulse, NULL);
  }
  return 0;
}

/* An output that the image drives low frees a held line. */
static void on_direction(struct avr_irq_t *irq, uint32_t outputs, void *context) {
  if (is_held && outputs & 1 << ECHO_BIT) {
    is_held = 0;
    avr_raise_irq(echo, 0);
  }
}

/* The end of the trigger is a request. The last pulse is repeated for ever. */
static void on_trigger(struct avr_irq_t *irq, uint32_t level, void *context) {
  static int32_t pulse_us;
  if (level == 0 && irq->value == 1) {
    pulse_us = atoi(*pulses);
    if (pulses[1] != NULL) {
      pulses++;
    }
    if (pulse_us != 0) {
      avr_cycle_timer_register_usec(avr, FLIGHT_US, begin_pulse, &pulse_us);
    }
  }
}

static void on_pin(struct avr_irq_t *irq, uint32_t level, void *context) {
  if (level != irq->value) {
    printf("%llu %s %u\n", (unsigned long long)(avr->cycle * 1000000 / avr->frequency), (const char *)context, level);
  }
}

static void watch(char port, int pin, avr_irq_notify_t notify, void *context) {
  avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_IOPORT_GETIRQ(port), pin), notify, context);
}

int main(int count, char **arguments) {
  avr_global_logger_set(discard_log);
  elf_firmware_t firmware = {{0}};
  if (count < 2 || elf_read_firmware(arguments[1], &firmware) != 0) {
    fputs("no image\n", stderr);
    return 1;
  }
  avr = avr_make_mcu_by_name("atmega328p");
  avr_init(avr);
  avr->frequency = 16000000;
  avr_load_firmware(avr, &firmware);
  uint32_t flags = 0;
  avr_ioctl(avr, AVR_IOCTL_UART_SET_FLAGS('0'), &flags);
  uart_in = avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_INPUT);
  avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUTPUT), on_sent, NULL);
  avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUT_XON), on_can_receive, avr);
  avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUT_XOFF), on_can_receive, NULL);
  pulses = arguments + 2;
  if (*pulses != NULL) {
    echo = avr_io_getirq(avr, AVR_IOCTL_IOPORT_GETIRQ('D'), ECHO_BIT);
    watch('D', 7, on_trigger, NULL);
    watch('D', IOPORT_IRQ_DIRECTION_ALL, on_direction, NULL);
    /* Overrides the pull-ups: a connected sensor holds its line low. */
    avr_ioport_external_t lines = {.name = 'D', .mask = 1 << ECHO_BIT | 1 << 2, .value = (atoi(*pulses) == 0) << ECHO_BIT | 1 << 2};
    avr_ioctl(avr, AVR_IOCTL_IOPORT_SET_EXTERNAL('D'), &lines);
    watch('D', ECHO_BIT, on_pin, "echo");
    watch('B', 1, on_pin, "left-brake");
    watch('B', 4, on_pin, "left-direction");
    watch('B', 0, on_pin, "right-brake");
    watch('B', 5, on_pin, "right-direction");
  }
  int state = cpu_Running;
  while (state != cpu_Done && state != cpu_Crashed) {
    if (can_receive && *pulses == NULL) {
      int byte = getchar();
      can_receive = byte != EOF;
      if (can_receive) {
        avr_raise_irq(uart_in, (uint32_t)byte);
      }
    }
    state = avr_run(avr);
    if (*pulses != NULL && has_sent_line) {
      state = cpu_Done;
    }
  }
  return state == cpu_Done ? 0 : 1;
}
