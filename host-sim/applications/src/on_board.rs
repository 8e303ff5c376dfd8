//! A robot in a scene, controlled by an emulated brick program: the built-in robot, or one in a learned simulator.

use mindgap_controller_export::brick::{Drive, Shaft, Sonar, World};
use mindgap_controller_export::onboard::NO_ECHO_CM;
use mindgap_controller_export::wiring::Wiring;

use mindgap_built_in_robot::Body;
use mindgap_foundations::geometry::Pose;
use mindgap_foundations::random::Generator;
use mindgap_logs::Row;
use mindgap_models::simulator::body::SimulatedBody;

/// The simulated vehicle.
pub enum Vehicle<'r> {
    /// The built-in robot.
    BuiltIn(Box<Body<'r>>),
    /// A robot in a learned simulator, which does not model wheels or battery: shafts turn freely, the battery is charged.
    Simulated(Box<SimulatedBody<'r>>),
}

/// The world of a brick's program: a robot in a scene, with a log.
///
/// The log begins when a motor first runs. A row takes the commands and the reading shortly after its time, or a reading
/// just before it, since programs read the sensor at the beginning of a step and then set the motors.
pub struct OnBoard<'r> {
    vehicle: Vehicle<'r>,
    wiring: Wiring,
    command: [f64; 2],
    shafts: [Shaft; 2],
    t_ms: u32,
    /// Time between two rows of the log.
    row_ms: u32,
    /// Time at which a motor first ran.
    began_ms: Option<u32>,
    rows: Vec<Row>,
    /// The last reading that is not yet in a row, with its time.
    reading: Option<(u32, Option<f64>)>,
    /// Whether the log has ended with a crash.
    is_over: bool,
    rng: Generator,
}

const CHARGED_MV: u16 = 7_800;
/// Share of the row interval in which commands and readings belong to the preceding row.
const SOON: f64 = 0.25;
/// Maximum number of rows; later ones are dropped.
const MOST_ROWS: usize = 100_000;

impl<'r> OnBoard<'r> {
    /// Returns a robot at rest with the given wiring.
    pub fn new(vehicle: Vehicle<'r>, wiring: Wiring, row_ms: u32, rng: Generator) -> Self {
        OnBoard {
            vehicle,
            wiring,
            command: [0.0, 0.0],
            shafts: Default::default(),
            t_ms: 0,
            row_ms: row_ms.max(1),
            began_ms: None,
            rows: Vec::new(),
            reading: None,
            is_over: false,
            rng,
        }
    }

    /// Returns whether the robot has touched something.
    pub fn crashed(&self) -> bool {
        match &self.vehicle {
            Vehicle::BuiltIn(body) => body.crashed(),
            Vehicle::Simulated(body) => body.crashed(),
        }
    }

    /// Returns the true pose.
    pub fn pose(&self) -> Pose {
        match &self.vehicle {
            Vehicle::BuiltIn(body) => body.true_pose(),
            Vehicle::Simulated(body) => body.pose(),
        }
    }

    /// Ends the run at `end_ms` and returns its log. The last row is that of the crash or of the program's end.
    pub fn into_rows(mut self, end_ms: u32) -> Vec<Row> {
        self.advance(end_ms);
        if self.began_ms.is_none() {
            self.rows = vec![Row { t_ms: 0.0, ..self.row() }];
        }
        self.log();
        self.rows
    }

    fn advance(&mut self, t_ms: u32) {
        while self.t_ms < t_ms {
            let row_ms =
                self.began_ms.map(|began_ms| began_ms + ((self.t_ms - began_ms) / self.row_ms + 1) * self.row_ms);
            let until_ms = row_ms.map_or(t_ms, |row_ms| row_ms.min(t_ms));
            let passed_ms = f64::from(until_ms - self.t_ms);
            match &mut self.vehicle {
                Vehicle::BuiltIn(body) => body.drive(self.command, passed_ms, &mut self.rng),
                Vehicle::Simulated(body) => body.drive(self.command, passed_ms, &mut self.rng),
            }
            self.t_ms = until_ms;
            if Some(until_ms) == row_ms || self.crashed() {
                self.log();
            }
        }
    }

    fn log(&mut self) {
        let mut row = self.row();
        // The program's clock starts slightly before its motors, so a reading may come just before the row's time.
        if let Some((read_ms, echo_cm)) = self.reading.take()
            && f64::from(self.t_ms - read_ms) <= self.soon_ms()
        {
            row.echo_cm = echo_cm;
        }
        let is_later = self.rows.last().is_none_or(|last| last.t_ms < row.t_ms);
        if is_later && !self.is_over && self.rows.len() < MOST_ROWS {
            self.rows.push(row);
        }
        self.is_over |= self.crashed();
    }

    /// Returns the last row if it is still current.
    fn row_of_now(&mut self) -> Option<&mut Row> {
        let now_ms = f64::from(self.t_ms - self.began_ms?);
        let soon_ms = self.soon_ms();
        self.rows.last_mut().filter(|row| now_ms - row.t_ms <= soon_ms)
    }

    fn soon_ms(&self) -> f64 {
        SOON * f64::from(self.row_ms)
    }

    fn row(&mut self) -> Row {
        let t_ms = f64::from(self.t_ms - self.began_ms.unwrap_or(0));
        match &self.vehicle {
            Vehicle::BuiltIn(body) => Row { t_ms, ..body.row(self.command, None, &mut self.rng) },
            Vehicle::Simulated(body) => {
                let [left, right] = &mut self.shafts;
                Row {
                    t_ms,
                    left: self.command[0],
                    right: self.command[1],
                    pose: Some(body.pose()),
                    echo_cm: None,
                    rot_left_deg: Some(left.angle_deg(self.t_ms).into()),
                    rot_right_deg: Some(right.angle_deg(self.t_ms).into()),
                    battery_mv: Some(CHARGED_MV.into()),
                    gyro_deg_s: None,
                }
            }
        }
    }

    fn side(&self, port: usize) -> Option<usize> {
        [self.wiring.left, self.wiring.right].into_iter().position(|motor| motor as usize == port)
    }
}

impl World for OnBoard<'_> {
    fn sonar(&mut self, port: usize, t_ms: u32) -> Sonar {
        if port != self.wiring.sonar as usize {
            return Sonar::Silent;
        }
        self.advance(t_ms);
        let echo_cm = match &mut self.vehicle {
            Vehicle::BuiltIn(body) => body.read_sonar(&mut self.rng),
            Vehicle::Simulated(body) => body.read_sonar(&mut self.rng),
        };
        match self.row_of_now() {
            Some(row) => row.echo_cm = echo_cm,
            None => self.reading = Some((t_ms, echo_cm)),
        }
        Sonar::Echo(echo_cm.map_or(NO_ECHO_CM, |echo_cm| libm::round(echo_cm) as u8))
    }

    fn sonar_answers(&mut self, port: usize, _: u32) -> Sonar {
        if port == self.wiring.sonar as usize { Sonar::Echo(NO_ECHO_CM) } else { Sonar::Silent }
    }

    fn motor(&mut self, port: usize, drive: Drive, t_ms: u32) {
        self.advance(t_ms);
        let Some(side) = self.side(port) else { return };
        self.command[side] = match drive {
            Drive::Power(power) => f64::from(power.clamp(-100, 100)),
            Drive::Brake | Drive::Coast => 0.0,
        };
        self.shafts[side].set(drive, t_ms);
        let command = self.command;
        if self.began_ms.is_none() && command != [0.0, 0.0] {
            self.began_ms = Some(t_ms);
            self.log();
        }
        if let Some(row) = self.row_of_now() {
            [row.left, row.right] = command;
        }
    }

    fn rotation_deg(&mut self, port: usize, t_ms: u32) -> i32 {
        self.advance(t_ms);
        let Some(side) = self.side(port) else { return 0 };
        match &self.vehicle {
            Vehicle::Simulated(_) => self.shafts[side].angle_deg(t_ms),
            Vehicle::BuiltIn(_) => {
                let row = self.row();
                [row.rot_left_deg, row.rot_right_deg][side].map_or(0, |deg| libm::round(deg) as i32)
            }
        }
    }

    fn battery_mv(&mut self, t_ms: u32) -> u16 {
        self.advance(t_ms);
        self.row().battery_mv.unwrap_or_default() as u16
    }
}
