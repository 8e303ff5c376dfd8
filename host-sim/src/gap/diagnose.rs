//! The method, from logs to an answer.

use super::account::GapReduction;
use super::compare::{Comparison, first_gain};
use super::condition::Conditioned;
use super::diagnosis::{Answer, Diagnosis};
use super::explain::{self, Judged};
use super::fit::{FitContext, Fitted, Gain, best_of_each};
use super::method::Method;
use super::{account, confirm, excitation, propose, remainder, validate};
use crate::effects::applied::AppliedEffect;
use crate::error::Result;
use crate::logs::Logs;
use crate::simulator::Simulator;
use crate::simulator::baseline::Baseline;

/// A diagnosis, and what came of it beside the words.
pub struct Findings {
    /// What is written and told.
    pub diagnosis: Diagnosis,
    /// The effects that explain the gap, as a simulator takes them; none unless they are known.
    pub applied: Vec<AppliedEffect>,
}

/// Diagnoses logs by the usual method.
///
/// # Errors
/// When the logs say nothing that the baseline could be compared with.
pub fn diagnose(baseline: Baseline, logs: &Logs) -> Result<Diagnosis> {
    Ok(findings(baseline, logs, Method::default())?.diagnosis)
}

/// Diagnoses logs.
///
/// # Errors
/// When the logs say nothing that the baseline could be compared with.
pub fn findings(mut baseline: Baseline, logs: &Logs, method: Method) -> Result<Findings> {
    // Validate and condition: what the logs cannot say, and what they say row by row.
    let (conditioned, notes) = conditioned(&mut baseline, logs)?;
    let context = FitContext::new(&baseline, &conditioned.identification, method);

    // Fit every variant of every effect alone; compare them and their combinations; confirm on runs held out.
    let compared = compared(&context);
    let confirmed = confirm::confirm(compared, &context, conditioned.hold_out.as_ref());

    // Account for the gap, explain it, propose what to drive next.
    let judged = Judged::of(&confirmed, &logs.robot, &context.calibration);
    let reduction = || account::reduction(&confirmed, &context, conditioned.confirming());
    let strata = explain::strata::strata(&confirmed, &judged, &context);
    let untestable = excitation::untestable(&confirmed.none, &context);
    let (answer, applied) = match judged {
        Judged::NoGap => (Answer::NoGap, Vec::new()),
        Judged::Known { effects } => {
            let experiment = propose::next(&confirmed, &context);
            (Answer::Known { effects, reduction: reduction(), experiment }, confirmed.chosen.applied())
        }
        Judged::Unknown => {
            let profiles = explain::profile::profiles(&confirmed, &context);
            (Answer::Unknown { reduction: reduction(), profiles }, Vec::new())
        }
    };
    let diagnosis = Diagnosis { answer, strata, final_positions: None, untestable, notes };
    Ok(Findings { diagnosis, applied })
}

/// What the logs gain at most, before any threshold.
pub struct GapStatistics {
    /// By the best effect.
    pub effect: Gain,
    /// By the omnibus residual model in a channel, or by a wider scatter on top of it.
    pub remainder: Gain,
    /// Number of rows that gain it.
    pub rows: usize,
}

/// The statistics from which gates are set.
///
/// # Errors
/// When the logs say nothing that the baseline could be compared with.
pub fn statistics(mut baseline: Baseline, logs: &Logs, method: Method) -> Result<GapStatistics> {
    let (conditioned, _) = conditioned(&mut baseline, logs)?;
    let context = FitContext::new(&baseline, &conditioned.identification, method);
    let none = Fitted::none(&context);
    let singles = best_of_each(none.with_each(None, &context), &context.calibration);
    Ok(GapStatistics {
        effect: first_gain(&singles, &none, &context.calibration),
        remainder: remainder::most(&none, &context),
        rows: context.observations.rows.len(),
    })
}

/// What explains logs, before anything is made of it.
///
/// # Errors
/// When the logs say nothing that the baseline could be compared with.
pub fn confirmed(mut baseline: Baseline, logs: &Logs, method: Method) -> Result<Comparison> {
    let (conditioned, _) = conditioned(&mut baseline, logs)?;
    let context = FitContext::new(&baseline, &conditioned.identification, method);
    Ok(confirm::confirm(compared(&context), &context, conditioned.hold_out.as_ref()))
}

/// The share of the reducible gap that given effects close on logs, without a search; none where there is no gap.
///
/// # Errors
/// When the logs say nothing that the simulator could be compared with.
pub fn closed(simulator: &Simulator, applied: &[AppliedEffect], logs: &Logs) -> Result<Option<f64>> {
    let mut baseline = Baseline::learned(simulator)?;
    let (conditioned, _) = conditioned(&mut baseline, logs)?;
    let context = FitContext::new(&baseline, &conditioned.identification, Method::default());
    let given = Comparison::given(applied, &context);
    let reduction: Option<GapReduction> = account::reduction(&given, &context, conditioned.confirming());
    Ok(reduction.map(|reduction| reduction.whole.reducible_closed))
}

/// Observations of what the baseline knows, and what has to be said about them.
fn conditioned(baseline: &mut Baseline, logs: &Logs) -> Result<(Conditioned, Vec<String>)> {
    let conditioned = Conditioned::of(logs, baseline);
    let notes = validate::validate(baseline, &conditioned.identification, logs)?;
    Ok((conditioned.expecting(baseline), notes))
}

fn compared(context: &FitContext) -> Comparison {
    let none = Fitted::none(context);
    let singles = none.with_each(None, context);
    Comparison::search(none, singles, context)
}
