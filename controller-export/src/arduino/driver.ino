// The driver: change this part for another motor board or sensor. This one is for an Arduino Motor Shield, with the left
// motor on A and the right one on B, and an HC-SR04.
const uint8_t LEFT_DIRECTION = 12, LEFT_BRAKE = 9, LEFT_POWER = 3;
const uint8_t RIGHT_DIRECTION = 13, RIGHT_BRAKE = 8, RIGHT_POWER = 11;
const uint8_t LEFT_FORWARD = HIGH, RIGHT_FORWARD = HIGH; // LOW if the wheel turns the wrong way
const uint8_t TRIGGER = 7, ECHO = 6;
const uint8_t STOP_BUTTON = 2; // to ground; optional

const int16_t NO_ECHO = -1, NO_ANSWER = -2;
// Without an echo the sensor ends its pulse after 38 ms or later.
const uint32_t LONGEST_ECHO_US = 30000;
const uint16_t US_PER_CM = 58;

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

// Returns the distance in whole centimetres, NO_ECHO, or NO_ANSWER if there is no sensor.
int16_t distance_cm() {
  if (digitalRead(ECHO) == HIGH) {
    return NO_ANSWER;
  }
  digitalWrite(TRIGGER, HIGH);
  delayMicroseconds(10);
  digitalWrite(TRIGGER, LOW);
  uint32_t echo_us = pulseIn(ECHO, HIGH, LONGEST_ECHO_US);
  if (echo_us > 0) {
    return (echo_us + US_PER_CM / 2) / US_PER_CM;
  }
  // Either the pulse is still high, or it has not started.
  return digitalRead(ECHO) == HIGH ? NO_ECHO : NO_ANSWER;
}

bool stop_is_pressed() {
  return digitalRead(STOP_BUTTON) == LOW;
}
