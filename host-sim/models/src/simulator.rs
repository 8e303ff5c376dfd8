//! The learned simulator: five networks, how reality scatters about them, and the robot that they stand for.

pub mod baseline;
mod batch;
mod beam;
pub mod body;
pub mod draws;
mod effect_layer;
pub mod ensemble;
pub mod environment;
mod first_echo;
pub mod fixed_point;
pub mod further_sensor;
pub mod kinematic;
mod known_steps;
pub mod monitor;
pub mod motion;
pub mod nominal;
pub mod residuals;
pub mod rollout;
pub mod rollout_report;
pub mod room;
pub mod textbook;

use std::fmt;
use std::path::Path;

use mindgap_core::network::Network;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::effects::applied::AppliedEffect;
use crate::effects::chain::EffectChain;
use crate::effects::drive_filter::DriveFilter;
use crate::sonar::{FirstEchoLaw, SensorLaw};
use ensemble::{Ensemble, Posterior, Robots};
use further_sensor::FurtherSensor;
use mindgap_files as files;
use mindgap_foundations::error::{Error, Result};
use mindgap_logs::Robot;
use motion::MotionNetworks;
use nominal::NominalModel;
use residuals::{ConstantReading, ResidualQuantiles};

/// The version of the simulator file that is written and read.
pub const SCHEMA: u32 = 1;

/// A simulator as `mindgap train` writes it, in JSON.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Simulator {
    /// Version of the file.
    #[schemars(extend("const" = SCHEMA))]
    pub schema: u32,
    /// How it was made.
    pub origin: Origin,
    /// The robot whose logs it was learned from.
    pub robot: Robot,
    /// Name of its range sensor; none of `[ultrasonic]`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sensor: Option<String>,
    /// Smallest and largest motor command in those logs; the networks hold for no commands outside.
    pub commands: [f32; 2],
    /// Filter of the commands in front of the motion networks, if the robot takes more than a step to respond.
    #[serde(default, skip_serializing_if = "DriveFilter::is_none")]
    pub filter: DriveFilter,
    /// Turn to the left in a step, degrees.
    pub turn: Option<Learned<4>>,
    /// Forward motion in a step, cm.
    pub forward: Option<Learned<4>>,
    /// Motion to the left in a step, cm.
    pub lateral: Option<Learned<4>>,
    /// Probability that the sensor produces a value.
    pub echo_probability: Option<Learned<2>>,
    /// The reading if the sensor produces one, cm.
    pub echo_value: Option<Learned<2>>,
    /// The first-echo law of the sensor: its third model, beside the two networks and the reference's beam.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub first_echo: Option<FirstEchoLaw>,
    /// A constant wrong reading that comes now and then, if there is one.
    pub constant_reading: Option<ConstantReading>,
    /// The range sensors beyond the first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub further: Vec<FurtherSensor>,
    /// Reference model fitted to the same logs, against which a diagnosis measures the gap.
    #[serde(default)]
    pub reference: Option<NominalModel>,
    /// Epistemic uncertainty about the robot's motion, given those logs and the runs since.
    #[serde(default, skip_serializing_if = "Option::is_none", rename = "robots")]
    pub ensemble: Option<Ensemble>,
    /// What the same logs give with the sizes of the paper's Table I, when these networks have others.
    #[serde(default)]
    pub table_one: Option<Box<Simulator>>,
    /// Effects that a diagnosis confirmed, in the order in which they act.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub added: Vec<AppliedEffect>,
    /// The networks that the logs could not support.
    pub missing: Vec<Missing>,
}

/// What scatters in a simulated run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Noise {
    /// Everything that the simulator learned: echoes that fail, residuals, constant readings.
    Learned,
    /// Echoes that fail, as in the paper, and nothing else.
    Paper,
}

/// Where a simulator comes from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Origin {
    /// Version of the program.
    pub version: String,
    /// Name of the trainer.
    pub trainer: String,
    /// Its seed.
    pub seed: u64,
    /// Number of runs that it was learned from.
    pub runs: usize,
}

/// A network, and the distribution of the residuals of what was logged.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Learned<const N: usize> {
    /// The network.
    pub network: Network<f32, N>,
    /// Logged minus predicted: for the sonar in logs that the network was not trained on, for motion after correction of the
    /// bias that the reference knows of.
    #[serde(rename = "spread")]
    pub residuals: ResidualQuantiles,
}

/// A network that the logs could not support.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Missing {
    /// Its name.
    pub network: String,
    /// Why not.
    pub reason: String,
}

impl fmt::Display for Missing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "no {} network: {}", self.network, self.reason)
    }
}

impl Simulator {
    /// Reads a simulator file.
    ///
    /// # Errors
    /// When the file is missing, is no simulator, is of another version, or holds a network that cannot be evaluated.
    pub fn read(path: &Path) -> Result<Self> {
        if files::source::is_folder(path) {
            return Err(Error::in_file(path, "is a folder, not a simulator file: are the arguments exchanged?"));
        }
        let text = files::read_text(path)?;
        let version: SchemaOnly =
            serde_json::from_str(&text).map_err(|e| broken(path, &e, "is no simulator file of mindgap"))?;
        if version.schema != SCHEMA {
            let what =
                format!("is a simulator file of version {}; this program reads version {SCHEMA}", version.schema);
            return Err(Error::in_file(path, what));
        }
        let simulator: Self =
            serde_json::from_str(&text).map_err(|e| broken(path, &e, "is a broken simulator file"))?;
        simulator.check(path)?;
        Ok(simulator)
    }

    /// Writes a simulator file.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn write(&self, path: &Path) -> Result<()> {
        files::write_json(path, self)
    }

    /// A network that something needs.
    ///
    /// # Errors
    /// Names the network and why it is missing.
    pub fn need<'s, const N: usize>(&'s self, learned: &'s Option<Learned<N>>, name: &str) -> Result<&'s Learned<N>> {
        learned.as_ref().ok_or_else(|| {
            let reason = self.missing.iter().find(|m| m.network == name).map_or("it is not there", |m| &m.reason);
            Error::new(format!("the simulator has no {name} network: {reason}"))
        })
    }

    /// Returns what lies between commands and networks, and the effects that were added.
    pub fn chain(&self) -> EffectChain {
        EffectChain::of(self.filter, &self.added, &self.robot)
    }

    /// Whether the motion networks see commands as they are sent.
    ///
    /// # Errors
    /// Describes the filter before them, which programs for boards do not compute.
    pub fn need_no_filter(&self) -> Result<()> {
        if self.filter.is_none() {
            return Ok(());
        }
        let filter = self.filter.in_words(&self.robot);
        let what = format!("the motion networks see commands behind a filter ({filter}), which boards do not compute");
        Err(Error::new(format!("{what}: train again with `--trainer paper`, which has none")))
    }

    /// The three motion networks, if all are there.
    pub fn motion_networks(&self) -> Option<MotionNetworks<'_>> {
        MotionNetworks::of(self).ok()
    }

    /// Returns the law by which its sensor is judged: the reference's first-echo law if it is more likely, else its beam.
    pub fn sensor_law(&self) -> Option<SensorLaw> {
        let reference = self.reference.as_ref()?;
        let first_echo = reference.first_echo.clone().map(SensorLaw::FirstEcho);
        first_echo.or_else(|| reference.sonar.clone().map(SensorLaw::Beam))
    }

    /// The law by which readings are drawn that effects change: the beam, since vector lanes draw from it and evolution
    /// takes a tenth of the time; but an ideal ray is one by the first-echo law alone.
    pub fn drawn_law(&self) -> Option<SensorLaw> {
        let beam = self.reference.as_ref().and_then(|reference| reference.sonar.clone());
        self.sensor_law().filter(SensorLaw::is_ray).or_else(|| beam.map(SensorLaw::Beam))
    }

    /// The robot in the middle of what the logs leave open, and `count` drawn ones; none where that is not said.
    pub fn robots(&self, count: usize, seed: u64) -> Option<Robots> {
        let networks = self.motion_networks()?;
        self.ensemble.as_ref()?.robots(&networks, count, seed)
    }

    /// What the training logs alone say of the robot; none where that is not said.
    pub fn trained(&self) -> Option<Posterior> {
        let networks = self.motion_networks()?;
        self.ensemble.as_ref()?.trained(&networks)
    }

    fn check(&self, path: &Path) -> Result<()> {
        self.robot.check().map_err(|why| Error::in_file(path, format!("robot: {why}")))?;
        let [slowest, fastest] = self.commands;
        if !(slowest.is_finite() && fastest.is_finite() && slowest <= fastest) {
            return Err(Error::in_file(
                path,
                format!("commands [{slowest}, {fastest}] must be the smallest and the largest"),
            ));
        }
        for added in &self.added {
            let what = format!("the added effect {} ({})", added.effect, added.variant);
            added.resolve(&self.robot).map_err(|why| Error::in_file(path, format!("{what} is not possible: {why}")))?;
        }
        if !self.filter.is_sound() {
            return Err(Error::in_file(path, "the filter of the drive holds numbers that cannot be"));
        }
        if self.ensemble.as_ref().is_some_and(|ensemble| !ensemble.is_sound()) {
            return Err(Error::in_file(path, "the distribution over robots holds numbers that cannot be"));
        }
        if self.reference.as_ref().is_some_and(|reference| !reference.is_sound()) {
            return Err(Error::in_file(path, "the reference model holds numbers that cannot be"));
        }
        let motion = [("turn", &self.turn), ("forward", &self.forward), ("lateral", &self.lateral)];
        let sonar = [("echo_probability", &self.echo_probability), ("echo_value", &self.echo_value)];
        let motion = motion.map(|(name, l)| (name, l.as_ref().is_none_or(Learned::is_sound)));
        let sonar = sonar.map(|(name, l)| (name, l.as_ref().is_none_or(Learned::is_sound)));
        if self.first_echo.as_ref().is_some_and(|law| !law.is_sound()) {
            return Err(Error::in_file(path, "the first-echo law holds numbers that cannot be"));
        }
        self.check_further(path)?;
        self.table_one.as_ref().map_or(Ok(()), |paper| paper.check(path))?;
        match motion.iter().chain(&sonar).find(|(_, sound)| !sound) {
            Some((name, _)) => Err(Error::in_file(path, format!("the {name} network holds numbers that cannot be"))),
            None => Ok(()),
        }
    }
}

impl<const N: usize> Learned<N> {
    fn is_sound(&self) -> bool {
        self.network.check().is_ok() && self.residuals.is_sound()
    }
}

#[derive(Deserialize)]
struct SchemaOnly {
    schema: u32,
}

fn broken(path: &Path, e: &serde_json::Error, what: &str) -> Error {
    Error::at_line(path, e.line() as u64, format!("{what}: {e}"))
}
