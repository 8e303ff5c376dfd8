//! The further range sensors of a simulator's robot, each with its own networks and laws.

use std::path::Path;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::nominal::NominalModel;
use super::residuals::ConstantReading;
use super::{Learned, Missing, Simulator};
use crate::effects::applied::AppliedEffect;
use crate::sonar::FirstEchoLaw;
use mindgap_foundations::error::{Error, Result};
use mindgap_logs::heard::Heard;
use mindgap_logs::range_sensor::{RangeSensor, Sensors, ULTRASONIC};
use mindgap_logs::robot::same_robot;
use mindgap_logs::{Logs, Robot};

/// A range sensor beyond the first, as learned from logs. Its fields are those of [`Simulator`] for the first.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FurtherSensor {
    /// Its name, mounting and range.
    pub sensor: RangeSensor,
    /// Probability that the sensor produces a value.
    pub echo_probability: Option<Learned<2>>,
    /// The reading if the sensor produces one, cm.
    pub echo_value: Option<Learned<2>>,
    /// The first-echo law of the sensor.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub first_echo: Option<FirstEchoLaw>,
    /// A constant wrong reading that comes now and then, if there is one.
    pub constant_reading: Option<ConstantReading>,
    /// What the training logs say beyond the networks; nothing of the motion.
    #[serde(default)]
    pub reference: Option<NominalModel>,
}

/// A further range sensor of a simulator and of logs.
pub struct Matched<'h> {
    /// Its name.
    pub sensor: String,
    /// The simulator of a robot with this sensor alone and the logs as it heard them, or why there are none to compare.
    pub compared: std::result::Result<Box<(Simulator, &'h Logs)>, String>,
}

impl Simulator {
    /// Returns the name of the first range sensor, which a controller asks unless it names another.
    pub fn first_sensor(&self) -> &str {
        self.sensor.as_deref().unwrap_or(ULTRASONIC)
    }

    /// Returns the names of all range sensors, the first one first.
    pub fn sensor_names(&self) -> Vec<&str> {
        let first = self.robot.ultrasonic.map(|_| self.first_sensor());
        first.into_iter().chain(self.further.iter().map(|further| further.sensor.name.as_str())).collect()
    }

    /// Returns its range sensors as `robot.toml` has them.
    pub fn sensors(&self) -> Sensors {
        Sensors::new(self.sensor.clone(), self.further.iter().map(|further| further.sensor.clone()).collect())
    }

    /// Returns the simulator of the same robot with one of its range sensors alone.
    ///
    /// # Errors
    /// When it has no sensor of this name.
    pub fn asking(&self, name: &str) -> Result<Simulator> {
        if name == self.first_sensor() && self.robot.ultrasonic.is_some() {
            return Ok(Simulator { further: Vec::new(), ..self.clone() });
        }
        let Some(further) = self.further.iter().find(|further| further.sensor.name == name) else {
            let names = self.sensor_names().join(", ");
            let known = if names.is_empty() { "none".into() } else { names };
            return Err(Error::new(format!("the simulator's robot has no range sensor {name:?}: it has {known}")));
        };
        let further = further.clone();
        let mut robot = self.robot;
        robot.ultrasonic = Some(further.sensor.mount());
        let is_kept = |added: &&AppliedEffect| match &added.sensor {
            Some(sensor) => sensor == name,
            None => !added.is_of_sensor(),
        };
        let own = |added: &AppliedEffect| AppliedEffect { sensor: None, ..added.clone() };
        let motion = self.reference.as_ref().map(|reference| (reference.motion.clone(), reference.wheels.clone()));
        let reference =
            further.reference.zip(motion).map(|(own, (motion, wheels))| NominalModel { motion, wheels, ..own });
        Ok(Simulator {
            robot,
            sensor: Some(name.into()),
            echo_probability: further.echo_probability,
            echo_value: further.echo_value,
            first_echo: further.first_echo,
            constant_reading: further.constant_reading,
            reference,
            further: Vec::new(),
            added: self.added.iter().filter(is_kept).map(own).collect(),
            missing: self.missing.iter().map(|missing| missing.of_sensor(name)).collect(),
            ..self.clone()
        })
    }

    /// Pairs each further range sensor, of the simulator or of logs, with the simulator of a robot with this sensor alone and with
    /// the logs as it heard them; or gives the reason why these cannot be compared. `heard` has the first sensor first.
    ///
    /// # Errors
    /// When the first sensors of both differ.
    pub fn matched<'h>(&self, heard: &'h [Heard]) -> Result<Vec<Matched<'h>>> {
        let [first, others] = [&heard[..1], &heard[1..]];
        let (own, its) = (self.first_sensor(), first[0].sensor.as_str());
        if own != its && self.robot.ultrasonic.is_some() && first[0].logs.robot.ultrasonic.is_some() {
            return Err(Error::new(format!(
                "the first range sensor is {own:?} in the simulator and {its:?} in the logs' robot.toml: write them in one order"
            )));
        }
        let logged = others.iter().map(|heard| {
            let simulator = self.asking(&heard.sensor).map_err(|error| error.to_string());
            let checked = simulator.and_then(|simulator| {
                // The body was compared with the first sensor, in the steps of the simulator.
                let logged = Robot { ultrasonic: heard.logs.robot.ultrasonic, ..simulator.robot };
                let same = same_robot(&simulator.robot, &logged);
                same.map(|()| (simulator, &heard.logs)).map_err(|error| error.to_string())
            });
            Matched { sensor: heard.sensor.clone(), compared: checked.map(Box::new) }
        });
        let is_logged = |name: &str| others.iter().any(|heard| heard.sensor == name);
        let unheard = self.further.iter().map(|further| further.sensor.name.clone()).filter(|name| !is_logged(name));
        let unheard = unheard.map(|sensor| {
            let reason = format!("the logs' robot.toml has no range_sensor named {sensor:?}");
            Matched { sensor, compared: Err(reason) }
        });
        Ok(logged.chain(unheard).collect())
    }

    /// Takes the sensor of another simulator of the same robot as a further one.
    pub fn with_sensor_of(mut self, name: &str, other: Simulator) -> Self {
        let reference = other.reference.map(|reference| NominalModel { motion: None, wheels: None, ..reference });
        self.further.extend(other.robot.ultrasonic.map(|mount| FurtherSensor {
            sensor: RangeSensor::new(name.into(), mount),
            echo_probability: other.echo_probability,
            echo_value: other.echo_value,
            first_echo: other.first_echo,
            constant_reading: other.constant_reading,
            reference,
        }));
        self
    }

    /// Checks the further sensors of a file at `path`, and that effects name sensors that are there.
    pub(super) fn check_further(&self, path: &Path) -> Result<()> {
        let names = self.sensor_names();
        let twice = names.iter().enumerate().find(|(k, name)| names[..*k].contains(name));
        if let Some((_, name)) = twice {
            return Err(Error::in_file(path, format!("two range sensors are named {name:?}")));
        }
        let named = self.added.iter().filter_map(|added| Some((added, added.sensor.as_deref()?)));
        if let Some((added, sensor)) = named.into_iter().find(|(_, sensor)| !names.contains(sensor)) {
            let what =
                format!("the added effect {} concerns a range sensor {sensor:?} that is not there", added.effect);
            return Err(Error::in_file(path, what));
        }
        match self.further.iter().find(|further| !further.is_sound()) {
            Some(further) => {
                let name = &further.sensor.name;
                Err(Error::in_file(path, format!("the model of range sensor {name:?} holds numbers that cannot be")))
            }
            None => Ok(()),
        }
    }
}

impl FurtherSensor {
    fn is_sound(&self) -> bool {
        let networks = [&self.echo_probability, &self.echo_value];
        networks.iter().all(|l| l.as_ref().is_none_or(Learned::is_sound))
            && self.reference.as_ref().is_none_or(NominalModel::is_sound)
            && self.first_echo.as_ref().is_none_or(FirstEchoLaw::is_sound)
    }
}

impl Missing {
    /// Returns the name of a network of a further sensor.
    pub fn network_of(network: &str, sensor: &str) -> String {
        format!("{network}_{sensor}")
    }

    /// Returns it under the name that it has where this sensor is the only one.
    fn of_sensor(&self, sensor: &str) -> Missing {
        let own =
            ["echo_probability", "echo_value"].into_iter().find(|own| self.network == Missing::network_of(own, sensor));
        Missing { network: own.unwrap_or(&self.network).into(), reason: self.reason.clone() }
    }
}
