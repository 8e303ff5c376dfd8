//! Scores the diagnoses of a challenge.

use std::collections::BTreeMap;
use std::path::Path;

use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::Folder;
use super::coverage::{Coverage, Measured};
use super::seal::{Published, Sealed};
use super::share::Share;
use super::truth::{Truth, truth};
use mindgap_built_in_robot::{ActiveEffect, Driving, Effect, record_driving};
use mindgap_diagnosis::diagnose::closed;
use mindgap_diagnosis::verdict::Verdict;
use mindgap_files as files;
use mindgap_foundations::counter::Counter;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::schema_number::SchemaNumber;
use mindgap_logs::{Logs, Robot};
use mindgap_models::effects::applied::AppliedEffect;
use mindgap_models::effects::{CATALOGUE, Parameter};
use mindgap_models::simulator::Simulator;

/// Largest number of rivals of the first effect at which a set still counts as an answer.
const MOST_RIVALS: usize = 3;
/// Probability above which a wrong answer counts as confidently wrong.
const SURE: f64 = 0.9;
/// Probability above which a further effect counts as named.
const LIKELY: f64 = 0.5;
/// Number of new runs of a case, and of steps per run.
const FRESH: [usize; 2] = [48, 60];
/// Bin edges of the reliability table.
const BINS: [f64; 6] = [0.0, 0.5, 0.7, 0.9, 0.98, 1.01];

/// The score of one case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Scored {
    /// Name of the case.
    pub case: String,
    /// Injected effects with strengths, separated by spaces.
    pub truth: String,
    /// Verdict of the diagnosis.
    pub verdict: Verdict,
    /// Named effects, each with its rivals in brackets, separated by spaces.
    pub named: String,
    /// Probability of the first effect.
    pub probability: f64,
    /// Share of the reducible gap that the diagnosis claims to close.
    pub closed: Option<f64>,
    /// Share that these effects close on new runs of the case.
    pub closed_on_fresh_runs: Option<f64>,
    /// Whether the answer is right: no gap, all effects (as first or in a set of a few), or unknown.
    pub right: bool,
}

/// The score of a challenge.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Score {
    /// Version of the JSON.
    pub schema: SchemaNumber<1>,
    /// Cases without effects in which a gap was detected.
    pub false_alarms: Share,
    /// Cases with effects in which a gap was detected.
    pub detected: Share,
    /// Single effects that were named first.
    pub top_1: Share,
    /// Single effects that were named first or in a set of a few.
    pub top_set: Share,
    /// Known answers to single effects whose set contains the truth.
    pub covered: Share,
    /// Mean number of effects in these sets.
    pub set_size: f64,
    /// Pairs of effects that were both named.
    pub pairs: Share,
    /// Unknown effects for which a remainder was reported: verdict unknown or partly known.
    pub unknowns: Share,
    /// Known effects that were called unknown.
    pub false_unknowns: Share,
    /// Median absolute difference between the claimed gap reduction and that on new runs; null if none is claimed.
    pub closed_error: Option<f64>,
    /// Answers with a probability above 0.9 for a false effect.
    pub confidently_wrong: Share,
    /// Cases in which a false effect that is not the first has a probability above one half.
    pub false_seconds: Share,
    /// Coverage of the 95 % intervals of effects that are present.
    pub intervals: Coverage,
    /// Reliability: share of true first effects per bin of probability.
    pub calibration: Vec<(String, Share)>,
    /// Confusions: truth, answer, number of cases.
    pub confusions: Vec<(String, String, usize)>,
    /// All cases.
    #[serde(skip)]
    pub cases: Vec<Scored>,
    /// The reported parameters of effects that are present.
    #[serde(skip)]
    pub measured: Vec<Measured>,
}

/// A case with its answer.
struct Opened {
    robot: Robot,
    sealed: Sealed,
    answer: Answered,
    closed_on_fresh_runs: Option<f64>,
}

/// The parts of a written diagnosis that are scored.
#[derive(Deserialize)]
struct Answered {
    verdict: Verdict,
    effects: Vec<AnsweredEffect>,
    shrink: AnsweredReduction,
}

#[derive(Deserialize)]
struct AnsweredEffect {
    id: String,
    probability: f64,
    ambiguous_with: Vec<String>,
    parameters: BTreeMap<String, Value>,
    intervals: BTreeMap<String, Option<[f64; 2]>>,
}

#[derive(Deserialize)]
struct AnsweredReduction {
    reducible_closed: Option<f64>,
}

/// Breaks the seal of a challenge and scores its answers. `watch` is called with the number of scored cases and the total.
///
/// # Errors
/// If a case has no diagnosis, or a sealed entry does not match its commitment.
pub fn score(folder: &Path, watch: impl Fn(usize, usize) + Sync) -> Result<Score> {
    let folder = Folder(folder);
    let published = folder.published()?;
    let sealed: Vec<Sealed> = files::read_json(&folder.sealed())?;
    let counter = Counter::new(published.len(), watch);
    let opened = published
        .par_iter()
        .map(|case| {
            let sealed = sealed.iter().find(|s| s.case == case.case && s.commitment() == case.commitment);
            let broken =
                || Error::in_file(&folder.sealed(), format!("case {}: does not match its commitment", case.case));
            let sealed = sealed.cloned().ok_or_else(broken)?;
            let answer = files::read_json(&folder.answer(&case.case))?;
            let closed_on_fresh_runs = closed_on_fresh_runs(&folder, case, &sealed)?;
            counter.increment();
            let robot = Robot::read(&folder.case(&case.case).join("robot.toml"))?;
            Ok(Opened { robot, sealed, answer, closed_on_fresh_runs })
        })
        .collect::<Vec<Result<Opened>>>();
    // The first of several errors, whatever the order in which threads met them.
    let opened = opened.into_iter().collect::<Result<Vec<Opened>>>()?;
    Ok(Score::of(&opened))
}

/// Returns the gap reduction, on new runs, of the effects that a case's diagnosis adds to its robot's simulator.
fn closed_on_fresh_runs(folder: &Folder, case: &Published, sealed: &Sealed) -> Result<Option<f64>> {
    let added: Vec<AppliedEffect> = files::read_json(&folder.added(&case.case))?;
    if added.is_empty() {
        return Ok(None);
    }
    let seal = folder.sealed();
    let unknown = |what: &str| Error::in_file(&seal, format!("case {}: {what} is unknown", case.case));
    let effects = sealed.effects.iter().map(|e| e.parse::<ActiveEffect>().map_err(|_| unknown(e)));
    let effects = effects.collect::<Result<Vec<_>>>()?;
    let driving = Driving::named(&sealed.driving).ok_or_else(|| unknown(&sealed.driving))?;
    let logs = Logs::read(&folder.case(&case.case), |_| {})?;
    // A robot that hits something in every attempt has no new runs.
    match record_driving(&driving, &logs.robot, &logs.scene, FRESH, &effects, sealed.fresh_seed) {
        Ok(fresh) => closed(&Simulator::read(&folder.simulator(&case.robot))?, &added, &fresh),
        Err(_) => Ok(None),
    }
}

impl Opened {
    fn truth(&self) -> Vec<&str> {
        self.sealed.ids()
    }

    fn is_null(&self) -> bool {
        self.truth().is_empty()
    }

    fn is_outside(&self) -> bool {
        self.truth().iter().any(|id| id.parse::<Effect>().is_ok_and(|e| !e.in_table()))
    }

    fn is_single(&self) -> bool {
        self.truth().len() == 1 && !self.is_outside()
    }

    fn is_pair(&self) -> bool {
        self.truth().len() > 1 && !self.is_outside()
    }

    fn first(&self) -> Option<&str> {
        self.answer.effects.first().map(|e| e.id.as_str())
    }

    fn probability(&self) -> f64 {
        self.answer.effects.first().map_or(0.0, |e| e.probability)
    }

    fn first_is_there(&self) -> bool {
        self.first().is_some_and(|id| self.truth().contains(&id))
    }

    /// Returns whether an effect is named, directly or among at most `most_rivals` rivals of another.
    fn names(&self, id: &str, most_rivals: usize) -> bool {
        let stands_for = |rivals: &[String]| rivals.len() <= most_rivals && rivals.iter().any(|r| r == id);
        self.answer.effects.iter().any(|e| e.id == id || stands_for(&e.ambiguous_with))
    }

    fn is_right(&self) -> bool {
        if self.is_null() {
            self.answer.verdict == Verdict::NoGap
        } else if self.is_outside() {
            matches!(self.answer.verdict, Verdict::Unknown | Verdict::PartlyKnown)
        } else {
            self.truth().iter().all(|id| self.names(id, MOST_RIVALS))
        }
    }

    fn scored(&self) -> Scored {
        let named = self.answer.effects.iter().map(|e| match e.ambiguous_with.as_slice() {
            [] => e.id.clone(),
            rivals => format!("{}({})", e.id, rivals.join(",")),
        });
        Scored {
            case: self.sealed.case.clone(),
            truth: self.sealed.effects.join(" "),
            verdict: self.answer.verdict,
            named: named.collect::<Vec<String>>().join(" "),
            probability: self.probability(),
            closed: self.closed(),
            closed_on_fresh_runs: self.closed_on_fresh_runs,
            right: self.is_right(),
        }
    }

    fn closed(&self) -> Option<f64> {
        self.answer.shrink.reducible_closed
    }

    /// Returns whether a false effect that is not the first has a probability above one half.
    fn has_false_second(&self) -> bool {
        let truth = self.truth();
        self.answer.effects.iter().skip(1).any(|e| e.probability > LIKELY && !truth.contains(&e.id.as_str()))
    }

    /// Returns the reported numbers of the effects that are there.
    fn measured(&self) -> Vec<Measured> {
        let injected = self.sealed.effects.iter().filter_map(|effect| effect.parse::<ActiveEffect>().ok());
        let of_effect = |active: ActiveEffect| {
            let answered = self.answer.effects.iter().find(|answered| answered.id == active.effect.id());
            answered.map_or_else(Vec::new, |answered| answered.measured(&active, &self.robot))
        };
        injected.flat_map(of_effect).collect()
    }

    fn answered(&self) -> String {
        self.first().map_or_else(|| format!("({:?})", self.answer.verdict), String::from)
    }
}

impl AnsweredEffect {
    fn measured(&self, active: &ActiveEffect, robot: &Robot) -> Vec<Measured> {
        let variants = CATALOGUE.iter().filter(|known| known.id == self.id).flat_map(|known| known.variants);
        let parameters: Vec<&Parameter> = variants.flat_map(|variant| variant.parameters).collect();
        let number = |(name, value): Truth| {
            let (reported, ends) = (self.parameters.get(name)?.as_f64()?, (*self.intervals.get(name)?)?);
            let parameter = parameters.iter().find(|parameter| parameter.setting().0 == name)?;
            // Directions differ by less than half a turn.
            let turns = if name.ends_with("direction_deg") { ((value - reported) / 360.0).round() } else { 0.0 };
            let value = value - 360.0 * turns;
            Some(Measured {
                effect: self.id.clone(),
                parameter: name,
                error: reported - value,
                half_width: 0.5 * (ends[1] - ends[0]),
                is_inside: (ends[0]..=ends[1]).contains(&value),
                departure: parameter.departure(reported, robot),
            })
        };
        truth(active).into_iter().filter_map(number).collect()
    }
}

impl Score {
    fn of(cases: &[Opened]) -> Self {
        let share = |among: fn(&Opened) -> bool, holds: &dyn Fn(&Opened) -> bool| {
            let among: Vec<&Opened> = cases.iter().filter(|c| among(c)).collect();
            Share { count: among.iter().filter(|c| holds(c)).count(), of: among.len() }
        };
        let sees_gap = |c: &Opened| c.answer.verdict != Verdict::NoGap;
        let named = |c: &Opened| c.is_single() && !c.answer.effects.is_empty();
        let sizes: Vec<usize> =
            cases.iter().filter(|c| named(c)).map(|c| 1 + c.answer.effects[0].ambiguous_with.len()).collect();
        let calibration = BINS.windows(2).map(|bin| {
            let inside = |c: &&Opened| c.first().is_some() && (bin[0]..bin[1]).contains(&c.probability());
            let inside: Vec<&Opened> = cases.iter().filter(inside).collect();
            let there = Share { count: inside.iter().filter(|c| c.first_is_there()).count(), of: inside.len() };
            (format!("{:.2} to {:.2}", bin[0], bin[1].min(1.0)), there)
        });
        let mut confusions: BTreeMap<(String, String), usize> = BTreeMap::new();
        for case in cases.iter().filter(|c| !c.is_right()) {
            *confusions.entry((case.truth().join("+"), case.answered())).or_default() += 1;
        }
        let closed_error = |c: &Opened| Some((c.closed()? - c.closed_on_fresh_runs?).abs());
        let mut closed_errors: Vec<f64> = cases.iter().filter_map(closed_error).collect();
        closed_errors.sort_by(f64::total_cmp);
        let measured: Vec<Measured> = cases.iter().flat_map(Opened::measured).collect();
        let confidently_wrong = |c: &Opened| c.probability() > SURE && !c.first_is_there();
        Score {
            schema: SchemaNumber,
            false_alarms: share(Opened::is_null, &sees_gap),
            detected: share(|c| !c.is_null(), &sees_gap),
            top_1: share(Opened::is_single, &Opened::first_is_there),
            top_set: share(Opened::is_single, &Opened::is_right),
            covered: share(named, &|c| c.names(c.truth()[0], usize::MAX)),
            set_size: sizes.iter().sum::<usize>() as f64 / sizes.len().max(1) as f64,
            pairs: share(Opened::is_pair, &Opened::is_right),
            unknowns: share(Opened::is_outside, &Opened::is_right),
            false_unknowns: share(|c| c.is_single() || c.is_pair(), &|c| c.answer.verdict == Verdict::Unknown),
            closed_error: closed_errors.get(closed_errors.len() / 2).copied(),
            confidently_wrong: share(|_| true, &confidently_wrong),
            false_seconds: share(|_| true, &Opened::has_false_second),
            intervals: Coverage::of(&measured),
            measured,
            calibration: calibration.collect(),
            confusions: confusions.into_iter().map(|((truth, answer), n)| (truth, answer, n)).collect(),
            cases: cases.iter().map(Opened::scored).collect(),
        }
    }
}
