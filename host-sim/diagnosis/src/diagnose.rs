//! The method, from logs to a diagnosis, one stage after the other.

use super::account::GapReduction;
use super::budget::Budget;
use super::calibration::Calibration;
use super::confirm::Confirmed;
use super::diagnosis::Diagnosis;
use super::excitation::{Detectable, Excitation};
use super::explain::evidence::{Evidence, evidence};
use super::explain::profile::profiles;
use super::explain::room_map::{RoomMap, room_map};
use super::explain::strata::strata;
use super::fit::{FitContext, Fitted};
use super::formula::Formula;
use super::gain::Gain;
use super::method::Method;
use super::progress::Stage;
use super::propose::Experiment;
use super::sample::HoldOut;
use super::search::Fits;
use super::split::{Parts, Split};
use super::validate::{Validated, validate};
use super::verdict::{Conclusion, Verdict, with_shares, with_witnesses};
use super::{account, formula, predictive_check, propose, remainder};
use mindgap_foundations::error::Result;
use mindgap_foundations::schema_number::SchemaNumber;
use mindgap_logs::inspection::Inspection;
use mindgap_logs::{Logs, Robot};
use mindgap_models::effects::applied::AppliedEffect;
use mindgap_models::simulator::Simulator;
use mindgap_models::simulator::baseline::Baseline;

/// The last stage: a diagnosis, with what does not go into its JSON.
pub struct Findings {
    /// The diagnosis.
    pub diagnosis: Diagnosis,
    /// The effects that explain the gap, as a simulator file stores them; none unless they are named.
    pub applied: Vec<AppliedEffect>,
    /// The robot to whose simulator they are applied.
    pub robot: Robot,
    /// Noise that these effects leave, as standard deviations of forward (cm), lateral (cm) and turn (rad).
    pub noise: [f64; 3],
    /// The formula of what no effect explains, if one holds.
    pub formula: Option<Formula>,
    /// Residuals without and with each named effect.
    pub evidence: Vec<Evidence>,
    /// The size of what its budget divides, nats.
    pub gap_nats: f64,
    /// Map of the gap, if there is one.
    pub room_map: Option<RoomMap>,
    /// The script that would say most about the cause, if several names are left, even where none is certain enough to be named.
    pub proposal: Option<Experiment>,
}

/// Diagnoses logs with the default settings.
///
/// # Errors
/// If the logs contain nothing to compare with the baseline.
pub fn diagnose(baseline: Baseline, logs: &Logs) -> Result<Diagnosis> {
    Ok(findings(baseline, &Inspection::new(logs.clone()), Method::default())?.diagnosis)
}

/// Diagnoses inspected logs.
///
/// # Errors
/// If the logs contain nothing to compare with the baseline.
pub fn findings(baseline: Baseline, inspected: &Inspection, method: Method) -> Result<Findings> {
    findings_watched(baseline, inspected, method, |_| ())
}

/// Diagnoses inspected logs. `watch` receives each stage when it begins.
///
/// # Errors
/// As [`findings`].
pub fn findings_watched(
    mut baseline: Baseline,
    inspected: &Inspection,
    method: Method,
    watch: impl Fn(Stage),
) -> Result<Findings> {
    let (split, validated) = split(&mut baseline, inspected)?;
    let context = FitContext::new(&split.identification, method);
    let held_out = split.hold_out.as_ref().map_or(0, |rows| rows.rows.len());
    log::info!("{} rows to find effects on, {held_out} held out to confirm them", split.identification.rows.len());

    watch(Stage::Fitting);
    let fits = Fits::of(&context);
    watch(Stage::Comparing);
    let search = fits.search(&context);
    watch(Stage::Confirming);
    let confirmed = search.confirm(&context, split.hold_out.as_ref());
    watch(Stage::Explaining);
    Ok(Findings::of(confirmed, &context, &split, validated, inspected))
}

impl Findings {
    /// Concludes, accounts for the gap, explains it, and proposes what to drive next.
    fn of(
        confirmed: Confirmed,
        context: &FitContext,
        split: &Split,
        validated: Validated,
        inspected: &Inspection,
    ) -> Self {
        let Validated { mut notes, scope, moved_uncommanded } = validated;
        let Conclusion { verdict, effects } = conclusion(&confirmed, moved_uncommanded, &inspected.logs.robot, context);
        notes.extend(confirmed.beyond_chosen.iter().filter_map(|r| r.epistemic_note(&context.calibration)));
        if verdict == Verdict::PartlyKnown {
            notes.extend(predictive_check::note(&confirmed, &context.calibration));
        }
        let (named, is_gap) = (verdict.names_effects(), verdict != Verdict::NoGap);
        let is_unexplained = matches!(verdict, Verdict::PartlyKnown | Verdict::Unknown);
        let ids = if named { confirmed.chosen.ids() } else { Vec::new() };
        let account = is_gap.then(|| account::account(&confirmed, &ids, context, split.confirming()));
        let formula = is_gap.then(|| formula::search(&confirmed, context, split.hold_out.as_ref())).flatten();
        let stated = formula.as_ref().zip(account.as_ref());
        let stated = stated.map(|(formula, account)| formula.stated(&account.reducible, context.seed));
        let excitation = Excitation::around(&confirmed.chosen, context);
        let (reduction, budget) = account.map_or_else(Default::default, |a| (a.reduction, a.budget));
        let Budget { parts: budget, nats: gap_nats } = budget;
        let reduction = reduction.or_else(|| GapReduction::of_outliers(&confirmed.outliers, context.rows.rows.len()));
        let proposal = (named || is_gap && context.is_driving).then(|| propose::next(&confirmed, context)).flatten();
        let diagnosis = Diagnosis {
            schema: SchemaNumber,
            verdict,
            effects: with_shares(with_witnesses(effects, &confirmed, context), &budget),
            budget,
            strata: strata(&confirmed, verdict, context),
            reduction,
            final_positions: None,
            experiment: proposal.clone().filter(|proposal| named && proposal.is_worthwhile(context)),
            formula: stated,
            profiles: if is_unexplained { profiles(&confirmed, context) } else { Vec::new() },
            scope,
            data: inspected.findings.clone(),
            detectable: excitation.detectable(),
            unconfirmed: confirmed.unconfirmed.clone(),
            outliers: confirmed.outliers.clone(),
            untestable: excitation.untestable(),
            notes,
            sessions: Vec::new(),
        };
        Findings {
            diagnosis,
            applied: if named { confirmed.chosen.applied(&context.baseline().robot) } else { Vec::new() },
            robot: context.baseline().robot,
            gap_nats,
            noise: confirmed.chosen.noise,
            formula,
            evidence: if named { evidence(&confirmed, context) } else { Vec::new() },
            room_map: room_map(&confirmed, verdict, context),
            proposal,
        }
    }

    /// Returns all that closes the gap, as a simulator file stores it: the effects and the formula, fitted together.
    pub fn with_formula(&self) -> Vec<AppliedEffect> {
        self.formula.as_ref().map_or_else(|| self.applied.clone(), |formula| formula.fitted.applied(&self.robot))
    }
}

/// If the robot moves without commands, what is compared can agree and still not say what moves it. No regression looks for what
/// the counters of an untracked robot show beyond the effects; their scatter tells that there is something.
fn conclusion(found: &Confirmed, moved_uncommanded: bool, robot: &Robot, context: &FitContext) -> Conclusion {
    let conclusion = Conclusion::of(found, robot, &context.calibration);
    let is_untracked = context.rows.rows.iter().all(|row| row.motion.is_none());
    let is_left = is_untracked && found.chosen.witnesses.leave_much(context.rows);
    let is_open = (moved_uncommanded || is_left) && conclusion.verdict == Verdict::NoGap;
    if is_open { Conclusion { verdict: Verdict::Unknown, ..conclusion } } else { conclusion }
}

/// What logs could show, and other limits of a diagnosis of them.
pub struct Prospect {
    /// Ids of the effects that they could not show, in the order of the catalogue.
    pub untestable: Vec<&'static str>,
    /// The smallest strength of each effect that they could show.
    pub detectable: Vec<Detectable>,
    /// One sentence each.
    pub notes: Vec<String>,
}

/// Returns what inspected logs could show, without a search.
///
/// # Errors
/// If the logs contain nothing to compare with the baseline.
pub fn prospect(mut baseline: Baseline, inspected: &Inspection, method: Method) -> Result<Prospect> {
    let (split, Validated { notes, .. }) = split(&mut baseline, inspected)?;
    let context = FitContext::new(&split.identification, method);
    let excitation = Excitation::around(&Fitted::null(&context), &context);
    Ok(Prospect { untestable: excitation.untestable(), detectable: excitation.detectable(), notes })
}

/// The largest gains on some logs, before any threshold.
pub struct GapStatistics {
    /// Gain of the best effect.
    pub effect: Gain,
    /// Gain of the omnibus regression in the best channel.
    pub remainder: Gain,
    /// Number of rows.
    pub rows: usize,
}

/// Returns the statistics from which gates are calibrated.
///
/// # Errors
/// If the logs contain nothing to compare with the baseline.
pub fn statistics(mut baseline: Baseline, logs: &Logs, method: Method) -> Result<GapStatistics> {
    let (split, _) = split(&mut baseline, &Inspection::new(logs.clone()))?;
    let context = FitContext::new(&split.identification, method);
    let fits = Fits::of(&context);
    Ok(GapStatistics {
        effect: fits.best_single(&context),
        remainder: remainder::largest_gain(&fits.null, &context),
        rows: split.identification.rows.len(),
    })
}

/// Returns what `look` makes of the confirmed effects and of the held-out rows with each of these calibrations. Single effects
/// are fitted once for all.
///
/// # Errors
/// If the logs contain nothing to compare with the baseline.
pub fn confirmed<T>(
    mut baseline: Baseline,
    logs: &Logs,
    calibrations: &[Calibration],
    look: impl Fn(Confirmed, &FitContext, Option<&HoldOut>) -> T,
) -> Result<Vec<T>> {
    let (split, _) = split(&mut baseline, &Inspection::new(logs.clone()))?;
    let context = |method: Method| FitContext::new(&split.identification, method);
    let fits = Fits::of(&context(Method::default()));
    let with = |calibration: &Calibration| {
        let context = context(Method { calibration: *calibration, ..Method::default() });
        let hold_out = split.hold_out.as_ref();
        look(fits.clone().search(&context).confirm(&context, hold_out), &context, hold_out)
    };
    Ok(calibrations.iter().map(with).collect())
}

/// Returns the fraction of the reducible gap that given effects close on logs, or `None` if there is no gap.
///
/// # Errors
/// If the logs contain nothing to compare with the simulator.
pub fn closed(simulator: &Simulator, applied: &[AppliedEffect], logs: &Logs) -> Result<Option<f64>> {
    let mut baseline = Baseline::at_posterior_mean(simulator)?;
    let (split, _) = split(&mut baseline, &Inspection::new(logs.clone()))?;
    let context = FitContext::new(&split.identification, Method::default());
    let given = Confirmed::given(applied, &context);
    let reduction = account::account(&given, &[], &context, split.confirming()).reduction;
    Ok(reduction.and_then(|reduction| reduction.whole.reducible_closed))
}

/// Splits logs into rows of what the baseline knows, with the notes about them.
pub(super) fn split<'b>(baseline: &'b mut Baseline<'_>, inspected: &Inspection) -> Result<(Split<'b>, Validated)> {
    let parts = Parts::of(&inspected.logs, baseline);
    let mut validated = validate(baseline, &parts.identification, inspected)?;
    validated.notes.extend(parts.caveat(inspected.logs.runs.len()));
    Ok((parts.against(baseline), validated))
}
