//! The method, from logs to an answer.

use super::calibration::Calibration;
use super::compare::{Comparison, most_alone};
use super::condition::Conditioned;
use super::diagnosis::{Answer, Diagnosis};
use super::explain::evidence::{Evidence, evidence};
use super::explain::room_map::{RoomMap, room_map};
use super::explain::{self, Judged};
use super::fit::{FitContext, Fitted, best_of_each};
use super::formula::Formula;
use super::gain::Gain;
use super::method::Method;
use super::progress::Stage;
use super::validate::Validated;
use super::{account, confirm, excitation, formula, propose, remainder, validate};
use mindgap_foundations::error::Result;
use mindgap_learning::evaluation::observations::Observations;
use mindgap_logs::inspection::Inspection;
use mindgap_logs::{Logs, Robot};
use mindgap_models::effects::applied::AppliedEffect;
use mindgap_models::simulator::Simulator;
use mindgap_models::simulator::baseline::Baseline;

/// A diagnosis, and what came of it beside the words.
pub struct Findings {
    /// What is written and told.
    pub diagnosis: Diagnosis,
    /// The effects that explain the gap, as a simulator takes them; none unless they are known.
    pub applied: Vec<AppliedEffect>,
    /// The robot to whose simulator they are applied.
    pub robot: Robot,
    /// How the steps scatter that these effects leave: forward (cm), lateral (cm), turn (rad).
    pub scatter: [f64; 3],
    /// The formula of what no effect explains, where one holds.
    pub formula: Option<Formula>,
    /// What each effect that explains the gap predicts against what was logged.
    pub evidence: Vec<Evidence>,
    /// Where in the room the gap lies.
    pub room_map: Option<RoomMap>,
}

impl Findings {
    /// All that shrinks the gap, as a simulator takes it: the effects with the formula of what they leave, fitted together.
    pub fn with_formula(&self) -> Vec<AppliedEffect> {
        self.formula.as_ref().map_or_else(|| self.applied.clone(), |formula| formula.fitted.applied(&self.robot))
    }
}

/// Diagnoses logs by the usual method.
///
/// # Errors
/// When the logs say nothing that the baseline could be compared with.
pub fn diagnose(baseline: Baseline, logs: &Logs) -> Result<Diagnosis> {
    Ok(findings(baseline, &Inspection::new(logs.clone()), Method::default())?.diagnosis)
}

/// Diagnoses inspected logs.
///
/// # Errors
/// When the logs say nothing that the baseline could be compared with.
pub fn findings(baseline: Baseline, inspected: &Inspection, method: Method) -> Result<Findings> {
    findings_watched(baseline, inspected, method, |_| ())
}

/// The same; `watch` is told each stage when it begins.
///
/// # Errors
/// As [`findings`].
pub fn findings_watched(
    mut baseline: Baseline,
    inspected: &Inspection,
    method: Method,
    watch: impl Fn(Stage),
) -> Result<Findings> {
    // Validate and condition: what the logs cannot say, and what they say row by row.
    let logs = &inspected.logs;
    let (conditioned, Validated { mut notes, scope, moved_uncommanded }) = conditioned(&mut baseline, inspected)?;
    let context = FitContext::new(&baseline, &conditioned.identification, method);
    let rows = |part: &Observations| part.rows.len();
    let held_out = conditioned.hold_out.as_ref().map_or(0, rows);
    log::info!("{} rows to find effects on, {held_out} held out to confirm", rows(&conditioned.identification));

    // Fit every variant of every effect alone; compare them and their combinations; confirm on runs held out.
    let compared = compared(&context, &watch);
    watch(Stage::Confirming);
    let confirmed = confirm::confirm(compared, &context, conditioned.hold_out.as_ref());
    log::info!(
        "confirmed: {}",
        if confirmed.chosen.ids().is_empty() { "nothing".into() } else { confirmed.chosen.ids().join("+") }
    );

    notes.extend(confirmed.beyond_chosen.iter().filter_map(|remainder| remainder.own_error(&context.calibration)));

    watch(Stage::Explaining);
    // Account for the gap, explain it, put what is left into a formula, propose what to drive next.
    let judged = match Judged::of(&confirmed, &logs.robot, &context.calibration) {
        // What is compared agrees, and does not say what moves the robot.
        Judged::NoGap if moved_uncommanded => Judged::Unknown,
        judged => judged,
    };
    let strata = explain::strata::strata(&confirmed, &judged, &context);
    let room_map = room_map(&confirmed, &judged, &context);
    let untestable = excitation::untestable(&confirmed.none, &context);
    let formula = match judged {
        Judged::NoGap => None,
        _ => formula::search(&confirmed, &context, conditioned.hold_out.as_ref()),
    };
    let account = |named: &[&'static str]| account::account(&confirmed, named, &context, conditioned.confirming());
    let ids = confirmed.chosen.ids();
    let answer = match judged {
        Judged::NoGap => Answer::NoGap,
        Judged::Known { effects } => {
            let (account, experiment) = (account(&ids), propose::next(&confirmed, &context));
            Answer::Known { effects: explain::with_shares(effects, &account.budget), account, experiment }
        }
        Judged::PartlyKnown { effects } => {
            notes.extend(explain::rollouts::refutation(&confirmed, &context.calibration));
            let (account, experiment) = (account(&ids), propose::next(&confirmed, &context));
            let profiles = explain::profile::profiles(&confirmed, &context);
            Answer::PartlyKnown {
                effects: explain::with_shares(effects, &account.budget),
                account,
                experiment,
                profiles,
            }
        }
        Judged::Unknown => {
            Answer::Unknown { account: account(&[]), profiles: explain::profile::profiles(&confirmed, &context) }
        }
    };
    let (applied, evidence) = match answer {
        Answer::Known { .. } | Answer::PartlyKnown { .. } => {
            (confirmed.chosen.applied(&baseline.robot), evidence(&confirmed, &context))
        }
        Answer::NoGap | Answer::Unknown { .. } => Default::default(),
    };
    let stated = formula.as_ref().zip(answer.account());
    let stated = stated.map(|(formula, account)| formula.stated(&account.reducible, context.seed));
    let diagnosis = Diagnosis {
        data: inspected.findings.clone(),
        scope,
        answer,
        formula: stated,
        strata,
        final_positions: None,
        untestable,
        notes,
    };
    let scatter = confirmed.chosen.scatter(&context);
    Ok(Findings { diagnosis, applied, robot: baseline.robot, scatter, formula, evidence, room_map })
}

/// The effects that logs could not show, and what else limits a diagnosis of them.
pub struct Excitation {
    /// Ids of effects, in the order of the catalogue.
    pub untestable: Vec<&'static str>,
    /// One sentence each.
    pub notes: Vec<String>,
}

/// What inspected logs could show, without a search.
///
/// # Errors
/// When the logs say nothing that the baseline could be compared with.
pub fn excitation(mut baseline: Baseline, inspected: &Inspection) -> Result<Excitation> {
    let (conditioned, Validated { notes, .. }) = conditioned(&mut baseline, inspected)?;
    let context = FitContext::new(&baseline, &conditioned.identification, Method::default());
    Ok(Excitation { untestable: excitation::untestable(&Fitted::none(&context), &context), notes })
}

/// What the logs gain at most, before any threshold.
pub struct GapStatistics {
    /// By the best effect.
    pub effect: Gain,
    /// By the omnibus residual model in a channel.
    pub remainder: Gain,
    /// Number of rows that gain it.
    pub rows: usize,
}

/// The statistics from which gates are set.
///
/// # Errors
/// When the logs say nothing that the baseline could be compared with.
pub fn statistics(mut baseline: Baseline, logs: &Logs, method: Method) -> Result<GapStatistics> {
    let (conditioned, _) = conditioned(&mut baseline, &Inspection::new(logs.clone()))?;
    let context = FitContext::new(&baseline, &conditioned.identification, method);
    let none = Fitted::none(&context);
    let singles = best_of_each(none.with_each(None, &context));
    Ok(GapStatistics {
        effect: most_alone(&singles, &none, &context),
        remainder: remainder::most(&none, &context),
        rows: context.observations.rows.len(),
    })
}

/// What `look` makes of what explains logs, and of the runs held out, by each of these calibrations; effects alone are fitted
/// once for all.
///
/// # Errors
/// When the logs say nothing that the baseline could be compared with.
pub fn confirmed<T>(
    mut baseline: Baseline,
    logs: &Logs,
    calibrations: &[Calibration],
    look: impl Fn(Comparison, &FitContext, Option<&Observations>) -> T,
) -> Result<Vec<T>> {
    let (conditioned, _) = conditioned(&mut baseline, &Inspection::new(logs.clone()))?;
    let context = |method: Method| FitContext::new(&baseline, &conditioned.identification, method);
    let hold_out = conditioned.hold_out.as_ref();
    let usual = context(Method::default());
    let none = Fitted::none(&usual);
    let alone = none.with_each(None, &usual);
    let by = |calibration: &Calibration| {
        let context = context(Method { calibration: *calibration, ..Method::default() });
        let compared = Comparison::search(none.clone(), alone.clone(), &context);
        look(confirm::confirm(compared, &context, hold_out), &context, hold_out)
    };
    Ok(calibrations.iter().map(by).collect())
}

/// The share of the reducible gap that given effects close on logs, without a search; none where there is no gap.
///
/// # Errors
/// When the logs say nothing that the simulator could be compared with.
pub fn closed(simulator: &Simulator, applied: &[AppliedEffect], logs: &Logs) -> Result<Option<f64>> {
    let mut baseline = Baseline::at_posterior_mean(simulator)?;
    let (conditioned, _) = conditioned(&mut baseline, &Inspection::new(logs.clone()))?;
    let context = FitContext::new(&baseline, &conditioned.identification, Method::default());
    let given = Comparison::given(applied, &context);
    let reduction = account::account(&given, &[], &context, conditioned.confirming()).reduction;
    Ok(reduction.map(|reduction| reduction.whole.reducible_closed))
}

/// Observations of what the baseline knows, and what has to be said about them.
fn conditioned(baseline: &mut Baseline, inspected: &Inspection) -> Result<(Conditioned, Validated)> {
    let conditioned = Conditioned::of(&inspected.logs, baseline);
    let mut validated = validate::validate(baseline, &conditioned.identification, inspected)?;
    validated.notes.extend(conditioned.caveat(inspected.logs.runs.len()));
    Ok((conditioned.expecting(baseline), validated))
}

fn compared(context: &FitContext, watch: impl Fn(Stage)) -> Comparison {
    watch(Stage::Fitting);
    let none = Fitted::none(context);
    let singles = none.with_each(None, context);
    watch(Stage::Comparing);
    Comparison::search(none, singles, context)
}
