//! The channels that a diagnosis compares, and why it does not compare the others.

use schemars::JsonSchema;
use serde::Serialize;

use mindgap_foundations::channel::Channel;
use mindgap_logs::inspection::Part;

/// The channels that were compared and those that were not.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Scope {
    /// Channels that were compared.
    pub compared: Vec<Channel>,
    /// Channels that were not compared.
    pub not_compared: Vec<NotCompared>,
}

/// A channel that was not compared.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct NotCompared {
    /// The channel.
    pub channel: Channel,
    /// The reason, as a sentence.
    pub reason: String,
    /// The range sensor concerned, where there are several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensor: Option<String>,
}

/// Returns a name, followed by that of a sensor if there are several.
pub fn of_sensor(name: &str, sensor: Option<&str>) -> String {
    sensor.map_or_else(|| name.into(), |sensor| format!("{name} of {sensor}"))
}

const NOT_LEARNED: &str = "The simulator's training logs have no rotation counters: they are not compared.";

impl Scope {
    /// Compares everything but the parts of the logs for which there is a reason not to.
    pub fn without(reasons: &[(Part, String)]) -> Self {
        let part = |channel: &Channel| if channel.motion_axis().is_some() { Part::Motion } else { Part::Sonar };
        let reason = |channel: &Channel| reasons.iter().find(|(excluded, _)| *excluded == part(channel));
        let not_compared = Channel::SIMULATED
            .into_iter()
            .filter_map(|channel| Some(NotCompared { channel, reason: reason(&channel)?.1.clone(), sensor: None }));
        Scope {
            compared: Channel::SIMULATED.into_iter().filter(|channel| reason(channel).is_none()).collect(),
            not_compared: not_compared.collect(),
        }
    }

    /// Returns a sentence for each further range sensor that was not compared.
    pub fn sensors_not_compared(&self) -> Vec<String> {
        let of_values = self.not_compared.iter().filter(|not| not.channel == Channel::EchoValue);
        let named = of_values.filter_map(|not| Some((not.sensor.as_ref()?, &not.reason)));
        named.map(|(sensor, reason)| format!("Range sensor {sensor} is not compared: {reason}")).collect()
    }

    /// Adds the witnesses that were logged: they are compared if the simulator's motion is and it knows them.
    pub fn with_witnesses(
        mut self,
        logged: &[Channel],
        motion_is_compared: bool,
        is_known: impl Fn(Channel) -> bool,
    ) -> Self {
        let of_motion = self.not_compared.iter().find(|not| not.channel == Channel::Forward);
        let of_motion = of_motion.filter(|_| !motion_is_compared).map(|not| not.reason.clone());
        for channel in logged.iter().copied() {
            let unknown = || (!is_known(channel)).then(|| NOT_LEARNED.into());
            match of_motion.clone().or_else(unknown) {
                None => self.compared.push(channel),
                Some(reason) => self.not_compared.push(NotCompared { channel, reason, sensor: None }),
            }
        }
        self
    }
}
