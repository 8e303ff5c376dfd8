//! The built-in robot with a brick on it that runs a real onboard program.

use mindgap_controller_export::brick::{Drive, Sonar, World};
use mindgap_controller_export::onboard::NO_ECHO_CM;
use mindgap_controller_export::wiring::Wiring;
use mindgap_host_sim::built_in_robot::Body;
use mindgap_host_sim::chance::Generator;

/// A robot in its room, as the brick's program sees and moves it.
pub struct OnBoard<'r> {
    /// The robot.
    pub body: Body<'r>,
    wiring: Wiring,
    command: [f64; 2],
    t_ms: u32,
    rng: Generator,
}

impl<'r> OnBoard<'r> {
    /// A robot at rest whose motors and sensor are plugged in so.
    pub fn new(body: Body<'r>, wiring: Wiring, rng: Generator) -> Self {
        OnBoard { body, wiring, command: [0.0, 0.0], t_ms: 0, rng }
    }

    fn advance(&mut self, t_ms: u32) {
        let passed_ms = t_ms - self.t_ms;
        if passed_ms > 0 {
            self.body.drive(self.command, f64::from(passed_ms), &mut self.rng);
        }
        self.t_ms = t_ms;
    }
}

impl World for OnBoard<'_> {
    fn sonar(&mut self, port: usize, t_ms: u32) -> Sonar {
        if port != self.wiring.sonar as usize {
            return Sonar::Silent;
        }
        self.advance(t_ms);
        let echo_cm = self.body.read_sonar(&mut self.rng);
        Sonar::Echo(echo_cm.map_or(NO_ECHO_CM, |echo_cm| echo_cm.round() as u8))
    }

    fn motor(&mut self, port: usize, drive: Drive, t_ms: u32) {
        self.advance(t_ms);
        let power = match drive {
            Drive::Power(power) => f64::from(power),
            Drive::Brake | Drive::Coast => 0.0,
        };
        for (side, motor) in [self.wiring.left, self.wiring.right].into_iter().enumerate() {
            if motor as usize == port {
                self.command[side] = power;
            }
        }
    }

    fn rotation_deg(&mut self, port: usize, t_ms: u32) -> i32 {
        self.advance(t_ms);
        let row = self.body.row(self.command, None, &mut self.rng);
        let side = if port == self.wiring.left as usize { row.rot_left_deg } else { row.rot_right_deg };
        side.unwrap_or_default().round() as i32
    }

    fn battery_mv(&mut self, t_ms: u32) -> u16 {
        self.advance(t_ms);
        self.body.row(self.command, None, &mut self.rng).battery_mv.unwrap_or_default() as u16
    }
}
