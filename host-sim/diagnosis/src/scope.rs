//! Which channels a diagnosis speaks of, and why it does not speak of the others.

use serde::Serialize;

use super::channel::Channel;
use mindgap_logs::inspection::Part;

/// What was compared and what was not.
#[derive(Clone, Debug)]
pub struct Scope {
    /// Channels that were compared.
    pub compared: Vec<Channel>,
    /// Channels that were not.
    pub not_compared: Vec<NotCompared>,
}

/// A channel that was not compared.
#[derive(Clone, Debug, Serialize)]
pub struct NotCompared {
    /// Which.
    pub channel: Channel,
    /// Why.
    pub reason: String,
}

impl Scope {
    /// Everything but the parts that have a reason.
    pub fn without(reasons: &[(Part, String)]) -> Self {
        let part = |channel: &Channel| if channel.motion_axis().is_some() { Part::Motion } else { Part::Sonar };
        let reason = |channel: &Channel| reasons.iter().find(|(of, _)| *of == part(channel));
        let not_compared = Channel::ALL
            .into_iter()
            .filter_map(|channel| Some(NotCompared { channel, reason: reason(&channel)?.1.clone() }));
        Scope {
            compared: Channel::ALL.into_iter().filter(|channel| reason(channel).is_none()).collect(),
            not_compared: not_compared.collect(),
        }
    }
}
