//! The channels that a diagnosis compares, and why it does not compare the others.

use schemars::JsonSchema;
use serde::Serialize;

use super::channel::Channel;
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
}

impl Scope {
    /// Compares everything but the parts of the logs for which there is a reason not to.
    pub fn without(reasons: &[(Part, String)]) -> Self {
        let part = |channel: &Channel| if channel.motion_axis().is_some() { Part::Motion } else { Part::Sonar };
        let reason = |channel: &Channel| reasons.iter().find(|(excluded, _)| *excluded == part(channel));
        let not_compared = Channel::ALL
            .into_iter()
            .filter_map(|channel| Some(NotCompared { channel, reason: reason(&channel)?.1.clone() }));
        Scope {
            compared: Channel::ALL.into_iter().filter(|channel| reason(channel).is_none()).collect(),
            not_compared: not_compared.collect(),
        }
    }
}
