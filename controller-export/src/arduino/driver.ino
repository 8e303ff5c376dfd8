// The driver: change this part for another motor board or sensor. This one is for an Arduino Motor Shield, with the left
// motor on A and the right one on B, and an HC-SR04.
const uint8_t LEFT_DIRECTION = 12, LEFT_BRAKE = 9, LEFT_POWER = 3;
const uint8_t RIGHT_DIRECTION = 13, RIGHT_BRAKE = 8, RIGHT_POWER = 11;
const uint8_t LEFT_FORWARD = HIGH, RIGHT_FORWARD = HIGH; // LOW if the wheel turns the wrong way
const uint8_t TRIGGER = 7, ECHO = 6;
const uint8_t STOP_BUTTON = 2; // to ground; optional

const int16_t NO_ECHO = -1, NO_ANSWER = -2;
const uint16_t US_PER_CM = 58;
// The sensor's range. Without an echo it ends its pulse some time later: most after 38 ms, some after 200 ms, some never.
const uint16_t LONGEST_ECHO_US = 400 * US_PER_CM;
const uint32_t LONGEST_WAIT_US = 30000;
const uint16_t LONGEST_PULSE_MS = 250;
// Long enough for a sensor that holds its line to notice, and for the pull-up to raise a free line.
const uint8_t FREEING_US = 200;

void begin_driver() {
  const uint8_t outputs[] = {LEFT_DIRECTION, LEFT_BRAKE, LEFT_POWER, RIGHT_DIRECTION, RIGHT_BRAKE, RIGHT_POWER, TRIGGER};
  for (uint8_t i = 0; i < sizeof(outputs); i++) {
    pinMode(outputs[i], OUTPUT);
  }
  // A connected sensor holds its line low until it answers; without a sensor the line is high.
  pinMode(ECHO, INPUT_PULLUP);
  pinMode(STOP_BUTTON, INPUT_PULLUP);
}

void set_motor(uint8_t direction_pin, uint8_t brake_pin, uint8_t power_pin, uint8_t forward, int8_t power) {
  digitalWrite(brake_pin, power == 0 ? HIGH : LOW);
  digitalWrite(direction_pin, power < 0 ? !forward : forward);
  analogWrite(power_pin, (uint16_t)abs(power) * 255 / 100);
}

// Powers are -100..100; 0 brakes.
void set_motors(controller_motors motors) {
  set_motor(LEFT_DIRECTION, LEFT_BRAKE, LEFT_POWER, LEFT_FORWARD, motors.left);
  set_motor(RIGHT_DIRECTION, RIGHT_BRAKE, RIGHT_POWER, RIGHT_FORWARD, motors.right);
}

// Pulls the sensor's line low for a moment, which ends the pulse of a sensor that waits for an echo for ever. Returns whether
// the line stays low.
bool free_line() {
  pinMode(ECHO, OUTPUT);
  digitalWrite(ECHO, LOW);
  delayMicroseconds(FREEING_US);
  pinMode(ECHO, INPUT_PULLUP);
  delayMicroseconds(FREEING_US);
  return digitalRead(ECHO) == LOW;
}

// Returns the distance in whole centimetres, NO_ECHO, or NO_ANSWER if there is no sensor.
int16_t distance_cm() {
  static bool is_waiting_for_echo = false;
  static uint32_t requested_ms = 0;
  if (digitalRead(ECHO) == HIGH && !free_line()) {
    return is_waiting_for_echo && millis() - requested_ms < LONGEST_PULSE_MS ? NO_ECHO : NO_ANSWER;
  }
  requested_ms = millis();
  digitalWrite(TRIGGER, HIGH);
  delayMicroseconds(10);
  digitalWrite(TRIGGER, LOW);
  uint32_t echo_us = pulseIn(ECHO, HIGH, LONGEST_WAIT_US);
  // Without a pulse, either it is still high or it has not started.
  is_waiting_for_echo = echo_us == 0 && digitalRead(ECHO) == HIGH;
  if (is_waiting_for_echo || echo_us > LONGEST_ECHO_US) {
    return NO_ECHO;
  }
  return echo_us > 0 ? (echo_us + US_PER_CM / 2) / US_PER_CM : NO_ANSWER;
}

bool stop_is_pressed() {
  return digitalRead(STOP_BUTTON) == LOW;
}
