//! The mixture over everything that the sensor may report.

use super::fan::{AXIS, Fan};
use super::first_echo::first_echoes;
use super::model::{CONSTANT_SCATTER_CM, P_RAND, SonarModel};
use super::perturbation::{Perturbation, ROUNDED_BY_CM};
use mindgap_foundations::statistics::student;

/// Scatter of the floor's echo as a fraction of its distance: it comes from a patch and not from a line.
const FLOOR_SCATTER: f64 = 0.03;

/// Probabilities of all outcomes of a reading. They add up to one.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcomes {
    /// Probability of no reading.
    pub none: f64,
    /// The components that give a reading: the hits, nearest first, then the others.
    pub components: Vec<Component>,
    /// Readings beyond it are reported as its ends, cm.
    pub range_cm: [f64; 2],
}

/// One component of the mixture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Component {
    /// Where its readings come from.
    pub source: Source,
    /// Its probability.
    pub probability: f64,
    /// How its readings are distributed.
    pub distribution: Distribution,
}

/// Where a reading comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// The first echo.
    Hit,
    /// The ghost of a perturbation.
    Ghost,
    /// The constant reading of the sensor.
    Constant,
    /// A reading shorter than the distance along the axis.
    Short,
    /// A reading longer than the distance along the axis.
    Long,
    /// A reading from anywhere in the range.
    Stray,
}

/// The distribution of a component's readings, before they are limited to the sensor's range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Distribution {
    /// Student's t with five degrees of freedom.
    Student {
        /// Its centre, cm.
        middle_cm: f64,
        /// Its scale, cm.
        scale_cm: f64,
    },
    /// Student's t without the readings that a perturbation leads beyond the range.
    Within {
        /// The centre of the untruncated distribution, cm.
        middle_cm: f64,
        /// Its scale, cm.
        scale_cm: f64,
        /// Probability below the range.
        below: f64,
        /// Probability within the range.
        inside: f64,
        /// Probabilities below and above that are reported nevertheless, as the ends of the range.
        at_ends: [f64; 2],
    },
    /// Uniform on an interval.
    Uniform {
        /// Its lower end, cm.
        low_cm: f64,
        /// Its upper end, cm.
        high_cm: f64,
    },
}

/// The weights of the mixture if an echo arrives at the sensor, or if none does; the weight of the hit is for the echo that
/// arrives first. They add up to one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MixingWeights {
    /// Weight of the first echo.
    pub hit: f64,
    /// Weight of the ghost.
    pub ghost: f64,
    /// Weight of the constant reading.
    pub constant: f64,
    /// Weight of a short reading.
    pub short: f64,
    /// Weight of a long reading.
    pub long: f64,
    /// Weight of a reading from anywhere.
    pub stray: f64,
    /// Weight of no reading.
    pub none: f64,
}

impl MixingWeights {
    /// Returns the weights of a sensor if an echo `arrives`, or if none does.
    pub fn new(model: &SonarModel, perturbation: &Perturbation, arrives: bool) -> Self {
        let Perturbation { p_ghost_given_echo, p_ghost_given_none, p_long, .. } = *perturbation;
        let detected = if arrives { neither(model.p_dropout, perturbation.p_dropout) } else { 0.0 };
        let missed = 1.0 - detected;
        let no_ghost = [detected * (1.0 - p_ghost_given_echo), missed * (1.0 - p_ghost_given_none)];
        let ghost = detected * p_ghost_given_echo + missed * p_ghost_given_none;
        let constant = no_ghost[0] * model.constant[0] + no_ghost[1] * model.p_constant_given_none;
        let hit = no_ghost[0] * (1.0 - model.constant[0]);
        let none = no_ghost[1] * (1.0 - model.p_constant_given_none);

        let not_short = neither(model.p_short, perturbation.p_short);
        let detour = not_short * none * perturbation.p_long_given_none;
        let none = not_short * none - detour;
        let reading = 1.0 - none - detour;
        let not_long = 1.0 - p_long;
        let known = 1.0 - P_RAND;
        MixingWeights {
            hit: known * not_long * not_short * hit,
            ghost: known * not_long * not_short * ghost,
            constant: known * not_long * not_short * constant,
            short: known * not_long * (1.0 - not_short),
            long: known * (reading * p_long + detour),
            stray: 0.5 * P_RAND,
            none: known * none + 0.5 * P_RAND,
        }
    }
}

impl Outcomes {
    /// Returns the outcomes of a reading of `fan`.
    pub fn new(model: &SonarModel, fan: &Fan, perturbation: &Perturbation) -> Self {
        let echoes = first_echoes(model, fan, perturbation);
        let arrives: f64 = echoes.iter().map(|echo| echo.probability).sum();
        let [heard, silent] = [true, false].map(|arrives| MixingWeights::new(model, perturbation, arrives));
        let total = |weight: fn(&MixingWeights) -> f64| arrives * weight(&heard) + (1.0 - arrives) * weight(&silent);

        let [low, high] = model.range_cm;
        let [least, most] = model.reach_bounds_cm();
        let reach = fan[AXIS].distance_cm.clamp(least, most);
        let about = |middle_cm| Distribution::Student { middle_cm, scale_cm: CONSTANT_SCATTER_CM };
        let between = |low_cm, high_cm| Distribution::Uniform { low_cm, high_cm };
        let others = [
            (Source::Ghost, total(|w| w.ghost), about(perturbation.ghost_cm)),
            (Source::Constant, total(|w| w.constant), about(perturbation.reading_cm(model.constant[1]))),
            (Source::Short, total(|w| w.short), between(low, reach)),
            (Source::Long, total(|w| w.long), between(reach, high)),
            (Source::Stray, total(|w| w.stray), between(low, high)),
        ];
        let hits = echoes.iter().map(|echo| Component {
            source: Source::Hit,
            probability: echo.probability * heard.hit,
            distribution: Distribution::Student { middle_cm: echo.middle_cm, scale_cm: echo.scale_cm },
        });
        let others = others.map(|(source, probability, distribution)| Component { source, probability, distribution });
        let components = hits.chain(others).collect();
        let outcomes = Outcomes { none: total(|w| w.none), components, range_cm: model.range_cm };
        outcomes.without_hits_led_beyond_range(perturbation).above_floor(perturbation, reach)
    }

    /// Returns the outcomes with the faults of a perturbation, which replace other outcomes: the ghost, then a short
    /// reading, then a long one, each in place of all before it, and a long one in place of none. `reach_cm` is the distance
    /// along the axis, within the range on both sides.
    pub(super) fn with_faults(mut self, change: &Perturbation, reach_cm: f64) -> Self {
        let [low_cm, high_cm] = self.range_cm;
        let reading = 1.0 - self.none;
        let ghost = change.p_ghost_given_echo * reading + change.p_ghost_given_none * self.none;
        let not_short = 1.0 - change.p_short;
        let not_long = 1.0 - change.p_long;
        let kept = (1.0 - change.p_ghost_given_echo) * not_short * not_long;
        self.components.iter_mut().for_each(|component| component.probability *= kept);
        self.none *= (1.0 - change.p_ghost_given_none) * not_short;
        let detour = self.none * change.p_long_given_none;
        let long = (1.0 - self.none) * change.p_long + detour;
        self.none -= detour;
        let about_ghost = Distribution::Student { middle_cm: change.ghost_cm, scale_cm: CONSTANT_SCATTER_CM };
        let between = |low_cm, high_cm| Distribution::Uniform { low_cm, high_cm };
        let faults = [
            (Source::Ghost, ghost * not_short * not_long, about_ghost),
            (Source::Short, change.p_short * not_long, between(low_cm, reach_cm)),
            (Source::Long, long, between(reach_cm, high_cm)),
        ];
        let faults = faults.map(|(source, probability, distribution)| Component { source, probability, distribution });
        self.components.extend(faults.into_iter().filter(|fault| fault.probability > 0.0));
        self
    }

    /// Returns the outcomes without the hits that a perturbation leads beyond the range. Other hits beyond the range are
    /// reported as its ends, as in the logs that the model was fitted to.
    pub(super) fn without_hits_led_beyond_range(mut self, change: &Perturbation) -> Self {
        let ends = change.leads_ends_beyond(self.range_cm);
        if change.scatter_cm > 0.0 || ends.contains(&true) {
            for hit in self.components.iter_mut().filter(|component| component.source == Source::Hit) {
                let within = hit.within(self.range_cm, ends, change.scatter_cm);
                self.none += hit.probability - within.probability;
                *hit = within;
            }
        }
        self
    }

    /// Returns the outcomes of a beam that meets the floor: of what is beyond it nothing comes back, and where nothing stands before
    /// it the floor itself may. `reach_cm` is the distance along the axis.
    pub(super) fn above_floor(mut self, change: &Perturbation, reach_cm: f64) -> Self {
        if !change.meets_floor() {
            return self;
        }
        let bare = change.behind_floor(reach_cm);
        let mut silent = self.none * bare;
        for component in &mut self.components {
            let lost = match (component.source, component.distribution) {
                (Source::Hit, Distribution::Student { middle_cm, .. } | Distribution::Within { middle_cm, .. }) => {
                    change.behind_floor(middle_cm)
                }
                (Source::Long, _) => bare,
                _ => 0.0,
            };
            silent += lost * component.probability;
            self.none += lost * component.probability;
            component.probability *= 1.0 - lost;
        }
        let probability = change.p_floor * silent;
        self.none -= probability;
        let scale_cm = libm::hypot(CONSTANT_SCATTER_CM, FLOOR_SCATTER * change.floor_cm);
        let distribution = Distribution::Student { middle_cm: change.floor_cm, scale_cm };
        self.components.push(Component { source: Source::Hit, probability, distribution });
        self
    }

    /// Returns the mean reading of the hits, cm; `None` if no echo can return.
    pub fn mean_hit_cm(&self) -> Option<f64> {
        let [low, high] = self.range_cm;
        let hits = self.components.iter().filter(|c| c.source == Source::Hit && c.probability > 0.0);
        let (sum, probability) = hits.fold((0.0, 0.0), |(sum, probability), hit| {
            (sum + hit.probability * hit.distribution.mean_cm().clamp(low, high), probability + hit.probability)
        });
        (probability > 0.0).then(|| sum / probability)
    }

    /// Returns a reading minus the mean hit, cm; `None` if there is no reading or no echo can return.
    pub fn off_cm(&self, echo_cm: Option<f64>) -> Option<f64> {
        Some(echo_cm? - self.mean_hit_cm()?)
    }
}

impl Component {
    /// Returns the part of a hit that is reported within a range. At an end that readings are led beyond, all readings
    /// beyond it are lost; at other ends, those that the additional scatter `further_cm`, which is part of the scale, leads
    /// there.
    fn within(self, [low_cm, high_cm]: [f64; 2], leads_ends_beyond: [bool; 2], further_cm: f64) -> Self {
        let Distribution::Student { middle_cm, scale_cm } = self.distribution else { return self };
        let farther = |by_cm: f64, scale_cm: f64| {
            if scale_cm > 0.0 { student::cumulative(-by_cm / scale_cm) } else { 0.0 }
        };
        let end = |room_cm: f64, is_led_beyond: bool| {
            let beyond = farther(room_cm, scale_cm);
            let leads_cm = if is_led_beyond { scale_cm } else { further_cm };
            [beyond, beyond - farther(room_cm + ROUNDED_BY_CM, leads_cm)]
        };
        let below = end(middle_cm - low_cm, leads_ends_beyond[0]);
        let above = end(high_cm - middle_cm, leads_ends_beyond[1]);
        let distribution = Distribution::Within {
            middle_cm,
            scale_cm,
            below: below[0],
            inside: (1.0 - below[0] - above[0]).max(0.0),
            at_ends: [below[1], above[1]],
        };
        Component { probability: self.probability * distribution.reported(), distribution, ..self }
    }
}

impl Distribution {
    /// Returns the share of its readings that is reported.
    pub(super) fn reported(&self) -> f64 {
        match *self {
            Distribution::Within { inside, at_ends: [low, high], .. } => inside + low + high,
            Distribution::Student { .. } | Distribution::Uniform { .. } => 1.0,
        }
    }

    fn mean_cm(&self) -> f64 {
        match *self {
            Distribution::Student { middle_cm, .. } | Distribution::Within { middle_cm, .. } => middle_cm,
            Distribution::Uniform { low_cm, high_cm } => 0.5 * (low_cm + high_cm),
        }
    }
}

impl SonarModel {
    /// Returns the outcomes of a reading; see [`Outcomes::new`].
    pub fn outcomes(&self, fan: &Fan, perturbation: &Perturbation) -> Outcomes {
        Outcomes::new(self, fan, perturbation)
    }
}

/// Returns the probability of neither of two independent events.
fn neither(p: f64, q: f64) -> f64 {
    (1.0 - p) * (1.0 - q)
}
