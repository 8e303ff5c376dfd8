//! Confirmation: what holds on runs that nothing was sought on.

use super::compare::Comparison;
use super::fit::{FitContext, Fitted};
use super::remainder::Remainder;
use super::scatter;
use mindgap_learning::evaluation::observations::Observations;
use mindgap_learning::evaluation::paths::{Paths, Rollouts};

/// Effects that gain nothing on the runs held out explain nothing, and neither does the residual model.
pub fn confirm(mut found: Comparison, context: &FitContext, hold_out: Option<&Observations>) -> Comparison {
    if let Some(hold_out) = hold_out {
        let chosen = borne_out(&found.chosen, &found.none, context, hold_out);
        if chosen.ids() != found.chosen.ids() {
            found = found.choosing(chosen, context);
        }
        let hold = |remainders: Vec<Remainder>, beneath: &Fitted| {
            remainders.into_iter().map(|r| r.confirmed(beneath, context, hold_out)).collect()
        };
        found.beyond_none = hold(found.beyond_none, &found.none);
        found.beyond_chosen = hold(found.beyond_chosen, &found.chosen);
    }
    found.scatter = scatter::wider(&found.beyond_chosen, context, hold_out);
    found.paths = paths(&found, context, hold_out.unwrap_or(context.observations));
    found
}

/// None where motion is not compared.
fn paths(found: &Comparison, context: &FitContext, logs: &Observations) -> Vec<Paths> {
    let Some(drive) = &context.baseline.motion else { return Vec::new() };
    let [before, after] = [&found.none, &found.chosen].map(Fitted::effects);
    let scatter = found.chosen.scatter(context);
    Rollouts { drive, before: &before, after: &after, scatter }.paths(logs, context.seed)
}

/// Those of the effects that gain on the runs held out, all together and each beside the others.
pub fn borne_out(chosen: &Fitted, none: &Fitted, context: &FitContext, hold_out: &Observations) -> Fitted {
    if chosen.ids().is_empty() {
        return none.clone();
    }
    let judged = |fit: &Fitted| fit.judged_on(hold_out, context).total().iter().sum::<f64>();
    let chosen = without_idle(chosen.clone(), &judged, context);
    let gained = judged(&chosen) - judged(none);
    log::info!("{} gain {gained:.1} nats on runs kept back", chosen.ids().join("+"));
    if gained < context.calibration.judgement.strong_nats { none.clone() } else { chosen }
}

/// The effects without those that gain nothing beside the others. Any gain is enough: few runs are held out, and those on which
/// it was found asked for strong evidence of each effect already. Of several that gain nothing the one goes first without which
/// all runs together are likeliest: two that can stand for each other both gain nothing, and the few runs that are held out
/// do not tell which of them it is.
fn without_idle(chosen: Fitted, judged: &impl Fn(&Fitted) -> f64, context: &FitContext) -> Fitted {
    if chosen.ids().len() < 2 {
        return chosen;
    }
    let all = judged(&chosen);
    let without = |place| {
        let fit = chosen.without(place, context);
        let nats = judged(&fit);
        log::info!("{} gains {:.1} nats beside the others on runs kept back", chosen.ids()[place], all - nats);
        (nats, fit)
    };
    let idle = (0..chosen.ids().len()).map(without).filter(|(nats, _)| *nats >= all);
    let on_all_runs = |(nats, fit): &(f64, Fitted)| nats + fit.log_evidence();
    match idle.max_by(|a, b| on_all_runs(a).total_cmp(&on_all_runs(b))) {
        Some((_, fewer)) => {
            log::info!("of {} only {} gain on runs kept back", chosen.ids().join("+"), fewer.ids().join("+"));
            without_idle(fewer, judged, context)
        }
        None => chosen,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::*;
    use mindgap_foundations::geometry::Pose;

    /// Blocks of rows that go so much too far.
    fn longer_by(off_cm: f64, blocks: usize) -> Observations {
        let off = move |at| [off_cm + 0.9 * alternating(at), 0.0, 0.0];
        observations(blocks, 10, move |_, at| Made { off: off(at), ..Made::default() })
    }

    /// What is left of an effect of one centimetre when the runs held out go so much too far.
    fn confirmed(held_out_cm: f64) -> Comparison {
        let (baseline, rows) = (baseline(), longer_by(1.0, 8));
        let context = FitContext::new(&baseline, &rows, METHOD);
        let none = Fitted::none(&context);
        let chosen = none.with(candidate(&LONGER), &context);
        let rivals = vec![vec![chosen.clone()]];
        let found = Comparison { none, chosen, rivals, ..comparison(&[], &[0.0; 8], &context) };
        confirm(found, &context, Some(&longer_by(held_out_cm, 2)))
    }

    #[test]
    fn an_effect_that_the_runs_held_out_show_stays() {
        let found = confirmed(1.0);
        assert_eq!((found.chosen.ids(), found.rivals.len()), (vec!["longer"], 1));
    }

    /// Twenty rows that are right as they are lose ten nats by a centimetre more, and rows that go half of it too far
    /// gain nothing.
    #[test]
    fn an_effect_that_gains_nothing_on_the_runs_held_out_is_dropped() {
        for held_out_cm in [0.0, 0.5] {
            let found = confirmed(held_out_cm);
            assert!(found.chosen.ids().is_empty() && found.rivals.is_empty());
            assert_eq!(found.chosen.held_out, found.none.held_out);
            // What it explained is unexplained now, and the runs held out do not show that either.
            assert!(!found.beyond_chosen.is_empty() && !found.beyond_chosen.iter().any(Remainder::counts));
        }
    }

    /// All steps go a centimetre too far, and those to the left two more; on the runs held out too, or not.
    #[test]
    fn an_effect_that_gains_nothing_beside_the_others_on_the_runs_held_out_is_dropped() {
        let longer_by = |off_cm: [f64; 2], blocks| {
            observations(blocks, 10, move |_, at| Made {
                commands: [if at < 5 { STRAIGHT } else { SPIN }; 2],
                off: [off_cm[at / 5] + 0.9 * alternating(at), 0.0, 0.0],
                ..Made::default()
            })
        };
        let (baseline, rows) = (baseline(), longer_by([1.0, 3.0], 8));
        let context = FitContext::new(&baseline, &rows, METHOD);
        let none = Fitted::none(&context);
        let alone = none.with_each(None, &context);
        let found = |held_out_cm| {
            let found = Comparison::search(none.clone(), alone.clone(), &context);
            assert_eq!(found.chosen.ids().len(), 2);
            confirm(found, &context, Some(&longer_by(held_out_cm, 4)))
        };
        assert_eq!(found([1.0, 3.0]).chosen.ids().len(), 2);
        let fewer = found([2.0, 2.0]);
        assert_eq!((fewer.chosen.ids(), fewer.own.len(), fewer.rivals.len()), (vec!["longer"], 1, 1));
        assert_eq!(found([0.0, 0.0]).chosen.ids(), [""; 0]);
    }

    /// Eight of ten steps turn left and go three centimetres too far, the others one; of the steps held out hardly any goes
    /// straight on, and those to the left go 2.5 cm too far. Neither effect gains anything beside the other there, and one that
    /// adds 2.6 cm to every step does better than one that adds 3 cm to the left.
    #[test]
    fn of_two_that_can_stand_for_each_other_the_one_stays_that_all_runs_show() {
        let steps = |blocks, rows, straight: usize, off_cm: [f64; 2]| {
            observations(blocks, rows, move |_, at| {
                let (commands, off_cm) = if at < straight { (STRAIGHT, off_cm[0]) } else { (SPIN, off_cm[1]) };
                Made { commands: [commands; 2], off: [off_cm + 0.5 * alternating(at), 0.0, 0.0], ..Made::default() }
            })
        };
        let (baseline, rows, hold_out) = (baseline(), steps(8, 10, 2, [1.0, 3.0]), steps(1, 62, 2, [0.2, 2.5]));
        let context = FitContext::new(&baseline, &rows, METHOD);
        let none = Fitted::none(&context);
        let judged = |fit: &Fitted| fit.judged_on(&hold_out, &context).total().iter().sum::<f64>();
        let alone = |effect| none.with(candidate(effect), &context);
        let both = alone(&LONGER).with(candidate(&LONGER_TO_THE_LEFT), &context);
        assert!(judged(&alone(&LONGER)) > judged(&alone(&LONGER_TO_THE_LEFT)));
        assert!(judged(&alone(&LONGER_TO_THE_LEFT)) > judged(&both));
        assert_eq!(borne_out(&both, &none, &context, &hold_out).ids(), ["longer_to_the_left"]);
    }

    #[test]
    fn without_runs_held_out_all_stays() {
        let (baseline, rows) = (baseline(), longer_by(0.0, 2));
        let context = FitContext::new(&baseline, &rows, METHOD);
        let found = confirm(comparison(&[&LONGER], &[10.0; 2], &context), &context, None);
        assert_eq!(found.chosen.ids(), ["longer"]);
    }

    /// What comes of paths of five steps if every step goes 5 cm and so much farther, and an effect of a centimetre is found; one
    /// pose of the first run is thrown so far.
    fn five_steps(off_cm: fn(usize) -> f64, thrown_cm: f64) -> Paths {
        let baseline = baseline();
        let rows = observations(8, 20, move |block, at| {
            let gone_cm: f64 = (0..at).map(|step| 5.0 + off_cm(step)).sum();
            let thrown_cm = if (block, at) == (0, 9) { thrown_cm } else { 0.0 };
            let pose = Pose::new(20.0 + gone_cm, 100.0 + thrown_cm, 0.0);
            Made { pose, off: [off_cm(at), 0.0, 0.0], ..Made::default() }
        });
        let context = FitContext::new(&baseline, &rows, METHOD);
        let mut found = comparison(&[&LONGER], &[10.0; 8], &context);
        found.chosen.values = vec![1.0];
        paths(&found, &context, &rows).into_iter().find(|paths| paths.error.steps == 5).expect("paths")
    }

    /// All steps go a centimetre too far; or four of five do, and the fifth goes four too short, so that five steps end where
    /// the simulator says and a centimetre more takes them away from there.
    #[test]
    fn rollouts_bear_out_what_steps_say_or_they_do_not() {
        let Paths { error, nearer_ci95 } = five_steps(|_| 1.0, 0.0);
        assert!((error.before_cm - 5.0).abs() < 1e-9 && error.after_cm < 1e-9, "{error:?}");
        assert!(nearer_ci95.is_some_and(|[low, _]| low > 0.9), "{nearer_ci95:?}");
        let Paths { error, nearer_ci95 } = five_steps(|at| if at % 5 == 4 { -4.0 } else { 1.0 }, 0.0);
        assert!(error.before_cm < 1e-9 && (error.after_cm - 5.0).abs() < 1e-9, "{error:?}");
        assert!(nearer_ci95.is_some_and(|[_, high]| high < 0.0), "{nearer_ci95:?}");
    }

    #[test]
    fn a_wild_pose_does_not_move_what_rollouts_say() {
        let nearer_ci95 = five_steps(|_| 1.0, 1e9).nearer_ci95;
        assert!(nearer_ci95.is_some_and(|[low, _]| low > 0.8), "{nearer_ci95:?}");
    }

    /// Three blocks draw the same one three times too often for an interval.
    #[test]
    fn rollouts_of_few_runs_tell_nothing() {
        let (baseline, rows) = (baseline(), longer_by(1.0, 3));
        let context = FitContext::new(&baseline, &rows, METHOD);
        let told = paths(&comparison(&[&LONGER], &[10.0; 3], &context), &context, &rows);
        assert!(!told.is_empty() && told.iter().all(|paths| paths.nearer_ci95.is_none()));
    }
}
