//! Compares sessions of one robot: what differs between them, and the condition that goes with it.
//!
//! An effect differs between sessions if parameters of its own in each session predict the blocks of that session better than
//! the parameters that all sessions share, by what any effect has to gain, and if these parameters differ beyond their errors.
//! That one session alone names an effect and another does not says little: the second may not have excited it.

mod conditions;

use serde_json::{Map, Value};

use super::diagnose::{findings, split};
use super::explanation::Explanation;
use super::fit::{FitContext, Fitted};
use super::gain::Gain;
use super::interval::intervals;
use super::method::Method;
use super::request::{Answered, Request};
use super::sessions::{SessionEffect, SessionFindings};
use super::slot::FurtherGain;
use super::verdict::Verdict;
use conditions::{Estimate, goes_with};
use mindgap_foundations::error::Result;
use mindgap_logs::Logs;
use mindgap_logs::inspection::Inspection;
use mindgap_logs::sessions::Session;
use mindgap_models::effects::Candidate;
use mindgap_models::effects::applied::AppliedEffect;

/// The note of a diagnosis whose sessions differ while all together they show no gap.
const DIFFERING: &str = "All sessions together show no gap, but they differ from each other.";

/// Adds to a diagnosis of several sessions what differs between them. Where all together show no gap and some differ, the
/// verdict becomes `unknown`. With a single session nothing is added.
///
/// # Errors
/// If the simulator cannot be compared with logs.
pub fn compare(request: &Request, answered: &mut Answered, sessions: &[Session]) -> Result<()> {
    let [_, _, ..] = sessions else { return Ok(()) };
    let differences = Comparison::of(request, answered, sessions)?.differences()?;
    let diagnosis = &mut answered.findings.diagnosis;
    if !differences.is_empty() && diagnosis.verdict == Verdict::NoGap {
        diagnosis.verdict = Verdict::Unknown;
        diagnosis.notes.push(DIFFERING.into());
    }
    let z = request.method.calibration.judgement.rival_z;
    let found = |(at, session): (usize, &Session)| SessionFindings {
        folder: session.folder.display().to_string(),
        conditions: conditions::as_json(&session.conditions),
        effects: differences.iter().filter_map(|difference| difference.in_session(at, sessions, z)).collect(),
    };
    diagnosis.sessions = sessions.iter().enumerate().map(found).collect();
    Ok(())
}

/// Sessions that are compared.
struct Comparison<'a> {
    request: &'a Request<'a>,
    /// The logs of every session.
    parts: Vec<Logs>,
    /// The effects that may differ.
    candidates: Vec<Candidate>,
    /// The effects that all sessions share, with the parameters of all.
    shared: Vec<AppliedEffect>,
}

/// An effect that differs between sessions.
struct Difference {
    effect: &'static str,
    gain: Gain,
    /// Its fit in every session; none where nothing could be compared.
    fits: Vec<Option<OwnFit>>,
}

/// The fit of an effect in one session.
struct OwnFit {
    applied: AppliedEffect,
    parameters: Map<String, Value>,
    intervals: Map<String, Value>,
    estimates: Vec<Estimate>,
}

impl<'a> Comparison<'a> {
    /// Splits inspected logs by session. The effects that may differ are those that all sessions together name, and those that
    /// any of them names alone.
    fn of(request: &'a Request<'a>, answered: &Answered, sessions: &[Session]) -> Result<Self> {
        let Answered { findings: together, logs } = answered;
        let part = |session: &Session| {
            let runs = logs.runs.iter().filter(|run| run.session() == session.prefix()).cloned();
            Logs { robot: logs.robot, scene: logs.scene.clone(), runs: runs.collect() }
        };
        let parts: Vec<Logs> = sessions.iter().map(part).collect();
        let mut candidates: Vec<Candidate> = Vec::new();
        let mut add = |applied: &[AppliedEffect]| {
            for (candidate, _) in applied.iter().flat_map(|effect| effect.resolve(&logs.robot)) {
                if candidates.iter().all(|known| known.effect != candidate.effect) {
                    candidates.push(candidate);
                }
            }
        };
        add(&together.applied);
        // Nothing is driven for one session.
        let method = Method { is_driving: false, ..request.method };
        for part in parts.iter().filter(|part| !part.runs.is_empty()) {
            // A session in which nothing can be compared names nothing.
            if let Ok(alone) = findings(request.baseline(part)?, &Inspection::new(part.clone()), method) {
                add(&alone.applied);
            }
        }
        Ok(Comparison { request, parts, candidates, shared: together.applied.clone() })
    }

    /// Returns what differs, one effect after the other: each is fitted with the earlier ones as they are in each session, so
    /// that one difference is not reported under two names.
    fn differences(&self) -> Result<Vec<Difference>> {
        let mut found: Vec<Difference> = Vec::new();
        loop {
            let further = self.candidates.iter().filter(|c| found.iter().all(|known| known.effect != c.effect));
            let tried = further.map(|candidate| self.difference(candidate, &found)).collect::<Result<Vec<_>>>()?;
            let best = tried.into_iter().flatten().max_by(|a, b| a.gain.nats.total_cmp(&b.gain.nats));
            match best {
                Some(best) => found.push(best),
                None => return Ok(found),
            }
        }
    }

    /// Returns the effect with parameters of its own in each session, if that counts.
    fn difference(&self, candidate: &Candidate, earlier: &[Difference]) -> Result<Option<Difference>> {
        let (mut by_block, mut penalty, mut gate, mut fits) = (Vec::new(), 0.0, 0.0_f64, Vec::new());
        for (at, part) in self.parts.iter().enumerate() {
            if part.runs.is_empty() {
                fits.push(None);
                continue;
            }
            let mut baseline = self.request.baseline(part)?;
            baseline.applied.extend(self.others(candidate, earlier, at));
            let Ok((split, _)) = split(&mut baseline, &Inspection::new(part.clone())) else {
                fits.push(None);
                continue;
            };
            let context = FitContext::new(&split.identification, self.request.method);
            let null = Fitted::null(&context);
            let shared: Vec<AppliedEffect> =
                self.shared.iter().filter(|effect| effect.effect == candidate.effect).cloned().collect();
            let shared = Fitted::given(&shared, &context);
            let own = null.with(*candidate, &context);
            let further = FurtherGain::of(&own, &shared, &null, context.calibration.further_share, &context);
            by_block.extend(own.gains_over(&shared));
            penalty += own.complexity_penalty() + further.form_error_nats;
            gate = gate.max(context.calibration.effect_nats);
            fits.push(Some(OwnFit::of(&own, candidate, &context)));
        }
        let gain = Gain::of(&by_block).less(penalty);
        log::info!("{}: {:.1} nats gained by parameters of its own in each session", candidate.effect, gain.nats);
        let difference = Difference { effect: candidate.effect, gain, fits };
        let z = self.request.method.calibration.judgement.rival_z;
        let counts = gain.passes(gate) && difference.most_different(z).is_some();
        Ok(counts.then_some(difference))
    }

    /// Returns the other effects in a session: those that differ as they are there, and the shared ones.
    fn others(&self, candidate: &Candidate, earlier: &[Difference], session: usize) -> Vec<AppliedEffect> {
        let differs = |effect: &AppliedEffect| earlier.iter().any(|known| known.effect == effect.effect);
        let shared = self.shared.iter().filter(|effect| effect.effect != candidate.effect && !differs(effect)).cloned();
        let own = earlier.iter().filter_map(|known| Some(known.fits[session].as_ref()?.applied.clone()));
        shared.chain(own).collect()
    }
}

impl OwnFit {
    fn of(fit: &Fitted, candidate: &Candidate, context: &FitContext) -> Self {
        let robot = &context.baseline().robot;
        let estimate = |(value, error): (&f64, &f64)| Estimate { value: *value, error: *error };
        OwnFit {
            applied: AppliedEffect::new(candidate, &fit.values, robot),
            parameters: candidate.variant.reported(&fit.values, robot),
            intervals: intervals(fit, 0, robot),
            estimates: fit.values.iter().zip(&fit.errors).map(estimate).collect(),
        }
    }
}

impl Difference {
    /// Returns the parameter that differs most between two sessions, by standard errors, if one differs by more than `z`.
    fn most_different(&self, z: f64) -> Option<usize> {
        let fits: Vec<&OwnFit> = self.fits.iter().flatten().collect();
        let parameters = fits.first().map_or(0, |fit| fit.estimates.len());
        let largest = |parameter: usize| {
            let pairs = fits.iter().enumerate().flat_map(|(i, a)| fits[..i].iter().map(move |b| (a, b)));
            let distances = pairs.map(|(a, b)| a.estimates[parameter].errors_from(&b.estimates[parameter]));
            (parameter, distances.fold(0.0, f64::max))
        };
        let most = (0..parameters).map(largest).max_by(|a, b| a.1.total_cmp(&b.1));
        most.filter(|(_, distance)| *distance > z).map(|(parameter, _)| parameter)
    }

    /// Returns the effect as it is in a session, with the conditions that go with it.
    fn in_session(&self, at: usize, sessions: &[Session], z: f64) -> Option<SessionEffect> {
        let fit = self.fits[at].as_ref()?;
        let parameter = self.most_different(z)?;
        let estimates: Vec<Option<Estimate>> =
            self.fits.iter().map(|fit| Some(fit.as_ref()?.estimates[parameter])).collect();
        Some(SessionEffect {
            id: self.effect,
            parameters: fit.parameters.clone(),
            intervals: fit.intervals.clone(),
            goes_with: goes_with(&estimates, sessions, z),
        })
    }
}
