//! The page of the demo: what the networks learned, what each start's controller does, and how the loop repairs a robot that
//! has changed.

use maud::{Markup, html};

use super::document::{Document, Script, Section, chart, open_table};
use super::evaluation;
use super::trials::{self, LINES, Map};
use super::words::{number, percent};
use mindgap_applications::demo::repair::Repair;
use mindgap_applications::demo::{JUDGED_RUNS, Summary, TRIALS};
use mindgap_applications::closed_loop::state::place_cm;
use mindgap_figures::report::paths::{PathPanel, Trace};
use mindgap_foundations::error::Result;
use mindgap_learning::evolve::fitness::Success;
use mindgap_models::simulator::rollout::REACHED_CM;

const STARTS_HEADER: [&str; 5] = ["start", "simulated", "cm off", "on the robot", "cm off"];

/// The page, whole in one file; `folder` has everything else.
///
/// # Errors
/// When a number in it has no form in JSON, or when there is no start.
pub fn page(summary: &Summary, folder: &str, seed: u64) -> Result<String> {
    let Summary { evaluation, panels, repair, .. } = summary;
    let mut sections = vec![
        Section {
            id: "networks",
            title: "What the simulator learned",
            body: evaluation::accuracy(&evaluation.networks),
        },
        Section { id: "starts", title: "A controller for each start", body: starts(summary) },
        Section { id: "change", title: "Then a motor gets weak", body: change(repair) },
    ];
    sections.extend(trials::sections(&repair.state, panels.len()));
    sections.push(Section { id: "next", title: "What to do next", body: next() });
    sections.push(Section { id: "compared", title: "What was run", body: source(folder, seed) });
    let maps = panels.iter().map(map).collect();
    Document {
        kind: "Demo",
        headline: &headline(summary),
        subject: folder,
        lead: html! {
            p {
                "The built-in robot, a stand-in for a real one, is logged; a simulator learns from the logs; controllers "
                "are evolved in it and tried on the robot."
            }
        },
        sections,
        scripts: &[Script::Trials],
    }
    .html(&trials::charts(&panels[0].scene, &repair.state, maps))
}

fn headline(Summary { starts, repair, .. }: &Summary) -> String {
    let works = starts.iter().filter(|start| start.real.rate > 0.5).count();
    format!(
        "{works} of {} controllers reach the target in most of their runs on the robot. When a motor gets weak, the loop brings \
         that of start {} from {} to {} of its runs.",
        starts.len(),
        repair.start,
        percent(repair.before.rate),
        percent(repair.after.rate)
    )
}

fn starts(Summary { starts, panels, .. }: &Summary) -> Markup {
    let reached = |success: &Success| percent(success.rate);
    let off = |success: &Success| number(success.median_cm, 1);
    let rows: Vec<[String; 5]> = (1..)
        .zip(starts)
        .map(|(number, s)| {
            [number.to_string(), reached(&s.simulated), off(&s.simulated), reached(&s.real), off(&s.real)]
        })
        .collect();
    html! {
        (open_table(STARTS_HEADER, &rows))
        p.quiet {
            "Shares of runs that end within " (number(REACHED_CM, 0)) " cm of the target without a crash, and the median distance "
            "to it: of " (JUDGED_RUNS) " simulated runs, and of " (TRIALS) " on the robot."
        }
        p { (LINES) }
        div.pairs {
            @for (place, panel) in panels.iter().enumerate() {
                (chart("map", place, &format!("{}: expected paths and the robot's", panel.title), html! {
                    (panel.title) "."
                }))
            }
        }
    }
}

fn change(repair: &Repair) -> Markup {
    html! {
        p {
            "The robot changes (" code { (repair.changed.to_string()) } "), and nobody tells the simulator. The controller of "
            "start " (repair.start) " then reaches the target in " (percent(repair.before.rate)) " of its runs. The loop drives "
            "the robot, learns from each run, and evolves anew; the controller that it settles on reaches it in "
            (percent(repair.after.rate)) "."
        }
    }
}

fn map(panel: &PathPanel) -> Map {
    let paths = |traces: &[Trace]| -> Vec<Vec<[f64; 2]>> {
        traces.iter().map(|trace| trace.points_cm.iter().map(|at| place_cm(*at)).collect()).collect()
    };
    Map { expected: paths(&panel.simulated), driven: paths(&panel.real) }
}

fn next() -> Markup {
    html! {
        ol {
            li {
                "Bring a robot of your own: " code { "mindgap new mine" } " makes the files to fill in, and "
                code { "mindgap import" } " makes logs of what it recorded."
            }
            li {
                "Ask what separates it from its simulator: "
                code { "mindgap diagnose kinematic mine/logs --html gap.html" } "."
            }
        }
    }
}

fn source(folder: &str, seed: u64) -> Markup {
    html! {
        dl {
            dt { "Folder" }
            dd { (folder) ": logs, simulator, controllers, NXC programs, figures and, in " code { "loop" } ", what the loop did" }
            dt { "Seed" } dd { (seed) }
        }
    }
}
