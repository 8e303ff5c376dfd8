def ends(row, distance_mm):
    """Returns whether a distance is on the stated side of a tuple's threshold. The comparison is strict."""
    if distance_mm is None:
        return False
    if row[2] == LARGER:
        return distance_mm > 10 * row[3]
    return distance_mm < 10 * row[3]


def run(robot):
    """Drives until the controller is done. Returns how the run ended."""
    try:
        robot.distance_mm()
    except OSError:
        return "no sonar"
    number = 0
    steps = 0
    failed_steps = 0
    # Steps follow absolute times, so the time of a reading does not add up.
    next_ms = robot.time_ms()
    robot.set_motors(TUPLES[0][0], TUPLES[0][1])
    while True:
        next_ms += STEP_MS
        robot.wait_until(next_ms)
        distance_mm = None
        try:
            distance_mm = robot.distance_mm()
            failed_steps = 0
        except OSError:
            failed_steps += 1
        steps += 1
        if ends(TUPLES[number], distance_mm):
            number += 1
            if number < len(TUPLES) and steps < MAX_STEPS:
                robot.set_motors(TUPLES[number][0], TUPLES[number][1])
        if number == len(TUPLES):
            ending = "finished"
        elif failed_steps == FAILED_STEPS_TO_STOP:
            ending = "sonar dead"
        elif steps == MAX_STEPS:
            ending = "timed out"
        else:
            continue
        robot.stop_motors()
        return ending
