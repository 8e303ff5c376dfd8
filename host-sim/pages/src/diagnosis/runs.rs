//! The runs: how far simulated paths end from logged ones, and the runs themselves as a replay.

use std::collections::BTreeMap;

use maud::html;

use super::Subject;
use crate::document::{Section, chart, table};
use crate::replay::{RECORDED, ROBOT, Replay, ReplayedRun, SIMULATOR, WITH_EFFECTS, sampled};
use crate::words;
use mindgap_applications::compare::pairs::alongside;
use mindgap_diagnosis::diagnosis::Diagnosis;
use mindgap_figures::pictures;
use mindgap_figures::report::room::Room;
use mindgap_learning::evaluation::replay::{Moment, PUT_BACK_STEPS, Player};
use mindgap_logs::{Row, Run};

/// How far the longest paths go astray, in a sentence; `None` where no path was compared.
pub fn astray(diagnosis: &Diagnosis) -> Option<String> {
    let longest = diagnosis.reduction.as_ref()?.paths.last()?;
    Some(format!(
        "After {} steps of the same commands the simulated robot is {:.1} cm from the real one, {:.1} cm {}; scatter alone \
         makes {:.1} cm.",
        longest.steps,
        longest.before_cm,
        longest.after_cm,
        words::with(diagnosis),
        longest.floor_cm
    ))
}

/// How far paths end from where the robot was; `None` where no path was compared.
pub fn ends(diagnosis: &Diagnosis) -> Option<Section> {
    let paths = diagnosis.reduction.as_ref().map_or(&[][..], |reduction| &reduction.paths);
    if paths.is_empty() && diagnosis.final_positions.is_none() {
        return None;
    }
    let rows: Vec<[String; 4]> = paths
        .iter()
        .map(|p| {
            let [before, after, floor] = [p.before_cm, p.after_cm, p.floor_cm].map(|cm| words::number(cm, 1));
            [p.steps.to_string(), before, after, floor]
        })
        .collect();
    let last = astray(diagnosis);
    let drawn = diagnosis.reduction.as_ref().map(|reduction| pictures::path_ends(reduction).draw());
    let body = html! {
        @if let (Some(last), Some(drawn)) = (&last, &drawn) {
            p { (last) }
            (chart("paths", drawn, last, html! {
                "The simulator drives by the logged commands alone, from a place where the robot was; medians over "
                "all such paths. No simulator can get below the line of scatter alone."
            }))
            (table("The same in numbers", ["steps", "without (cm)", "with (cm)", "scatter alone (cm)"], &rows))
        }
        @if let Some(of) = &diagnosis.final_positions {
            p {
                "The controller's " (of.runs) " runs end " (words::number(of.before_cm, 1))
                " cm from where the simulator "
                "expects, " (words::number(of.after_cm, 1)) " cm with the effects; scatter alone makes "
                (words::number(of.floor_cm, 1)) " cm."
            }
        }
    };
    Some(Section { id: "ends", title: "How far simulated paths go astray", body })
}

/// The runs as a replay.
pub fn section(replay: Option<&Replay>, diagnosis: &Diagnosis) -> Section {
    let body = match replay {
        Some(replay) => html! {
            p {
                "The robot as it was logged, and the simulator with the same commands"
                @if diagnosis.effects.is_empty() { "." } @else { ", without and with the effects." }
                " Simulated robots start at the first logged position of the real one and return to it every "
                (PUT_BACK_STEPS)
                " steps. Walls do not stop them."
                @if replay.shows(&RECORDED) {
                    " Where the simulator's recording has the same commands, it is moved to the robot's start and shown too."
                }
            }
            (replay.markup())
        },
        None => html! { p { "The tracker never saw the robot in these logs, so there is nothing to show on a map." } },
    };
    Section { id: "replay", title: "Replay", body }
}

/// The replay of the runs; `None` where the robot was never seen.
pub fn replay(subject: &Subject, room: Room) -> Option<Replay> {
    let Subject { findings, logs, baseline, comparison, .. } = subject;
    let seen: Vec<&Run> = logs.runs.iter().filter(|run| run.rows.iter().any(|row| row.pose.is_some())).collect();
    if seen.is_empty() {
        return None;
    }
    let player = Player::new(baseline, logs);
    let before = baseline.chain();
    let found = findings.with_formula();
    let after = baseline.chain_with(&found);
    let chosen = sampled(&seen.iter().map(|run| run.rows.len()).collect::<Vec<_>>());
    let is_recorded = chosen.iter().any(|(number, _)| comparison.recorded(seen[*number]).is_some());
    let run = |(number, rows): (usize, usize)| {
        let whole = seen[number];
        let run = Run { name: whole.name.clone(), rows: whole.rows.beginning(rows) };
        let mut tracks = BTreeMap::from([
            (ROBOT.id, Player::logged(&run).into()),
            (SIMULATOR.id, player.simulated(&before, &run).into()),
        ]);
        if !found.is_empty() {
            tracks.insert(WITH_EFFECTS.id, player.simulated(&after, &run).into());
        }
        if is_recorded {
            let recorded = comparison.recorded(whole).map(|recorded| alongside(&run, recorded, logs.robot.step_ms));
            tracks.insert(RECORDED.id, recorded.unwrap_or_else(|| vec![Moment::default(); rows]).into());
        }
        let cut = rows < whole.rows.len();
        ReplayedRun {
            name: if cut { format!("{} (first {rows} rows)", run.name) } else { run.name.clone() },
            t_s: run.rows.iter().map(|row| (row.t_ms - run.rows.at(0).t_ms) / 1000.0).collect(),
            remarks: run.rows.iter().map(commands).collect(),
            tracks,
        }
    };
    let runs = chosen.iter().copied().map(run).collect();
    let kinds =
        [Some(ROBOT), Some(SIMULATOR), (!found.is_empty()).then_some(WITH_EFFECTS), is_recorded.then_some(RECORDED)];
    Some(Replay::new(&logs.robot, room, kinds.into_iter().flatten().collect(), runs, logs.runs.len()))
}

fn commands(row: Row) -> String {
    format!("commands {}, {}", words::number(row.left, 0), words::number(row.right, 0))
}
