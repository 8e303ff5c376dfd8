// Waits until a time of the board's clock, which may wrap. Returns false if the button was pressed.
bool wait_until(uint32_t t_ms) {
  while (!stop_is_pressed()) {
    int32_t left_ms = t_ms - millis();
    if (left_ms <= 0) {
      return true;
    }
    delay(min(left_ms, (int32_t)BUTTON_POLL_MS));
  }
  return false;
}

// Returns whether the sensor answers one of a few requests, which do not count as readings.
bool sonar_answers() {
  uint32_t t_ms = millis();
  for (uint8_t probe = 0; probe < SONAR_PROBES; probe++) {
    t_ms += SONAR_WARM_UP_MS;
    if (!wait_until(t_ms)) {
      return false;
    }
    if (distance_cm() != NO_ANSWER) {
      return true;
    }
  }
  return false;
}

// Drives until the controller is done. Returns how the run ended.
const __FlashStringHelper *run() {
  if (!sonar_answers()) {
    return stop_is_pressed() ? F("stopped") : F("no sonar");
  }
  controller_machine machine = {};
  uint8_t failed_steps = 0;
  set_motors(controller_motors_now(&machine));
  // Steps follow absolute times, so the time of a reading does not add up.
  uint32_t next_ms = millis();
  while (true) {
    next_ms += CONTROLLER_STEP_MS;
    if (!wait_until(next_ms)) {
      return F("stopped");
    }
    int16_t reading_cm = distance_cm();
    failed_steps = reading_cm == NO_ANSWER ? failed_steps + 1 : 0;
    uint8_t tuple = machine.tuple;
    controller_status status = controller_step(&machine, reading_cm >= 0, reading_cm);
    if (status == CONTROLLER_FINISHED) {
      return F("finished");
    }
    if (failed_steps == FAILED_STEPS_TO_STOP) {
      return F("sonar dead");
    }
    if (status == CONTROLLER_TIMED_OUT) {
      return F("timed out");
    }
    if (machine.tuple != tuple) {
      set_motors(controller_motors_now(&machine));
    }
  }
}

void setup() {
  Serial.begin(115200);
  begin_driver();
  const __FlashStringHelper *ending = run();
  set_motors({0, 0});
  Serial.println(ending);
}

void loop() {
}
