class Robot:
    """The driver: change this part for another hub or sensor."""

    def __init__(self):
        self.left = Motor(LEFT, Direction.COUNTERCLOCKWISE)
        self.right = Motor(RIGHT)
        self.sonar = UltrasonicSensor(SONAR)
        self.watch = StopWatch()

    def set_motors(self, left, right):
        self.left.dc(left)
        self.right.dc(right)

    def stop_motors(self):
        self.left.brake()
        self.right.brake()

    def distance_mm(self):
        """Returns the distance, or None without an echo. Raises OSError if there is no sensor."""
        distance_mm = self.sonar.distance()
        return distance_mm if distance_mm < NO_ECHO_MM else None

    def time_ms(self):
        return self.watch.time()

    def wait_ms(self, ms):
        wait(ms)
