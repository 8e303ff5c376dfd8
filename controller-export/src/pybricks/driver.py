from pybricks.parameters import Direction, Port
from pybricks.tools import StopWatch, wait

# The devices of an EV3, of an NXT, or of a hub with Powered Up ports (SPIKE, Technic). An NXT has both of the latter.
try:
    from pybricks.ev3devices import Motor, UltrasonicSensor
except ImportError:
    try:
        from pybricks.nxtdevices import Motor, UltrasonicSensor
    except ImportError:
        from pybricks.pupdevices import Motor, UltrasonicSensor

# Ports, the direction in which the left motor drives forward, and the distance that means that there was no echo.
if hasattr(Port, "S4"):  # EV3 and NXT
    LEFT, RIGHT, SONAR = Port.B, Port.C, Port.S4
    LEFT_FORWARD = Direction.CLOCKWISE
    NO_ECHO_MM = 2550
else:
    LEFT, RIGHT, SONAR = Port.A, Port.B, Port.C
    LEFT_FORWARD = Direction.COUNTERCLOCKWISE
    NO_ECHO_MM = 2000


class Missing(Exception):
    """A motor or sensor that is not there."""


def connect(what, port, device):
    """Returns the device on a port. Raises Missing if there is none."""
    try:
        return device(port)
    except OSError:
        raise Missing("no " + what + " on " + str(port))


class Robot:
    """The driver: change this part for another hub or sensor."""

    def __init__(self):
        self.left = connect("left motor", LEFT, lambda port: Motor(port, LEFT_FORWARD))
        self.right = connect("right motor", RIGHT, Motor)
        self.sonar = connect("sonar", SONAR, UltrasonicSensor)
        self.watch = StopWatch()

    def set_motors(self, left, right):
        self.left.dc(left)
        self.right.dc(right)

    def stop_motors(self):
        self.left.brake()
        self.right.brake()

    def rotations_deg(self):
        return self.left.angle(), self.right.angle()

    def distance_mm(self):
        """Returns the distance, or None without an echo. Raises OSError if the sensor does not answer."""
        distance_mm = self.sonar.distance()
        return distance_mm if distance_mm < NO_ECHO_MM else None

    def time_ms(self):
        return self.watch.time()

    def wait_until(self, t_ms):
        left_ms = t_ms - self.time_ms()
        if left_ms > 0:
            wait(left_ms)

