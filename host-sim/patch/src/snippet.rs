//! Lines for a driver that do what no tag says: ROS 2 nodes in Python.

use super::cause::Cause;
use mindgap_logs::Robot;

/// Returns a node for a cause, or `None` if there is none.
pub fn of(cause: &Cause, robot: &Robot) -> Option<String> {
    let number = |name: &str| cause.numbers.get(name).map(|estimate| estimate.value);
    match cause.effect.as_str() {
        "latency" => {
            let seconds = number("ms")? / 1000.0;
            (seconds > 0.0)
                .then(|| commands(&format!("threading.Timer({seconds}, self.publisher.publish, (message,)).start()")))
        }
        "battery_sag" => {
            let per_minute = number("loss_per_min")?;
            let code = format!(
                "minutes = (self.get_clock().now() - self.start).nanoseconds / 60e9\n        \
                 gain = max(1.0 - {per_minute} * minutes, 0.0)\n        \
                 message.linear.x *= gain\n        message.angular.z *= gain\n        self.publisher.publish(message)"
            );
            Some(commands(&code))
        }
        "sonar_scale" => Some(readings(&format!("message.range *= {}", number("factor")?))),
        "sonar_noise" => Some(readings(&format!("message.range += random.gauss(0.0, {})", number("cm")? / 100.0))),
        "sonar_ghost" => {
            let (probability, metres) = (number("probability")?, number("cm")? / 100.0);
            Some(readings(&format!("if random.random() < {probability}:\n            message.range = {metres}")))
        }
        "sonar_crosstalk" => {
            let probability = number("probability")?;
            let short = "message.range = random.uniform(message.min_range, message.range)";
            Some(readings(&format!("if random.random() < {probability}:\n            {short}")))
        }
        "deadband" => {
            let command = number("command")?;
            let lost_m_s = command / 100.0 * robot.full_speed_cm_s / 100.0;
            let half_track_m = robot.track_cm / 200.0;
            let code = format!(
                "lost, half = {lost_m_s}, {half_track_m}\n        \
                 v, w = message.linear.x, half * message.angular.z\n        \
                 left, right = (math.copysign(max(abs(x) - lost, 0.0), x) for x in (v - w, v + w))\n        \
                 message.linear.x, message.angular.z = (left + right) / 2, (right - left) / 2 / half\n        \
                 self.publisher.publish(message)"
            );
            Some(commands(&code))
        }
        _ => None,
    }
}

/// Returns a node between the sender of commands and the drive.
fn commands(on_message: &str) -> String {
    format!(
        "import math\nimport threading\n\nimport rclpy\nfrom geometry_msgs.msg import Twist\nfrom rclpy.node import Node\n\n\n\
         class Commands(Node):\n    def __init__(self):\n        super().__init__('commands')\n        \
         self.start = self.get_clock().now()\n        \
         self.publisher = self.create_publisher(Twist, 'cmd_vel_drive', 10)\n        \
         self.create_subscription(Twist, 'cmd_vel', self.on_message, 10)\n\n    \
         def on_message(self, message):\n        {on_message}\n\n\
         rclpy.init()\nrclpy.spin(Commands())\n"
    )
}

/// Returns a node between a range sensor and its readers.
fn readings(on_message: &str) -> String {
    format!(
        "import random\n\nimport rclpy\nfrom rclpy.node import Node\nfrom sensor_msgs.msg import Range\n\n\n\
         class Readings(Node):\n    def __init__(self):\n        super().__init__('readings')\n        \
         self.publisher = self.create_publisher(Range, 'range_real', 10)\n        \
         self.create_subscription(Range, 'range', self.on_message, 10)\n\n    \
         def on_message(self, message):\n        {on_message}\n        self.publisher.publish(message)\n\n\
         rclpy.init()\nrclpy.spin(Readings())\n"
    )
}
