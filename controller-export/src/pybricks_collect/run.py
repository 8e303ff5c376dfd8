try:
    from pybricks.hubs import ThisHub

    BATTERY = ThisHub().battery
except (ImportError, AttributeError):
    BATTERY = None


def print_row(t_ms, powers, robot, distance_mm):
    left_deg, right_deg = robot.rotations_deg()
    battery_mv = "" if BATTERY is None else BATTERY.voltage()
    echo_cm = "" if distance_mm is None else distance_mm / 10
    print(t_ms, powers[0], powers[1], left_deg, right_deg, battery_mv, echo_cm, sep=",")


def run(robot):
    """Drives the commands and prints a row per step. Returns how the run ended."""
    try:
        robot.distance_mm()
    except OSError:
        return "no sonar"
    commands = Commands()
    step = 0
    failed_steps = 0
    print("t_ms,left,right,rot_left_deg,rot_right_deg,battery_mv,echo_cm")
    # Steps follow absolute times, so the time of a reading does not add up.
    start_ms = robot.time_ms()
    next_ms = start_ms
    while True:
        distance_mm = None
        try:
            distance_mm = robot.distance_mm()
            failed_steps = 0
        except OSError:
            # The robot is then as blind as without an echo.
            failed_steps += 1
        if step == STEPS or failed_steps == FAILED_STEPS_TO_STOP:
            break
        powers = commands.next(distance_mm)
        robot.set_motors(powers[0], powers[1])
        print_row(robot.time_ms() - start_ms, powers, robot, distance_mm)
        step += 1
        next_ms += STEP_MS
        robot.wait_until(next_ms)
    robot.stop_motors()
    print_row(robot.time_ms() - start_ms, (0, 0), robot, distance_mm)
    return "finished" if step == STEPS else "sonar dead"
