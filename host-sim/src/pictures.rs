//! Figures of what commands find, as files: figures 2, 3 and 4 of the paper, and those of a diagnosis.

use std::path::Path;

use glam::{DVec2, DVec3};
use mindgap_core::network::Network;

use crate::error::Result;
use crate::evaluation::accuracy::Evaluation;
use crate::evaluation::paths::PathError;
use crate::evaluation::support::Support;
use crate::files;
use crate::gap::Diagnosis;
use crate::gap::account::GapReduction;
use crate::gap::explain::profile::ResidualProfile;
use crate::geometry::Pose;
use crate::learn::dataset::{Dataset, Datasets};
use crate::logs::{Logs, Scene};
use crate::report;
use crate::report::bars::Bar;
use crate::report::curves::Curve;
use crate::report::expected_against_predicted::{Panel, Samples};
use crate::report::paths::{PathPanel, Trace};
use crate::report::sonar_surfaces::Surface;
use crate::report::{Figure, curves};
use crate::simulator::Simulator;
use crate::simulator::rollout::REACHED_CM;
use crate::simulator::rollout_report::{Rollout, RolloutReport};

/// Figure 3 shows one test sample in this many, so that single ones are visible.
const EVERY: usize = 4;

/// A figure and the name of its files.
pub struct NamedFigure {
    /// The name, without an ending.
    pub name: String,
    /// The figure.
    pub figure: Figure,
}

/// Writes [`figures_of_networks`].
///
/// # Errors
/// When the folder cannot be written.
pub fn networks(folder: &Path, simulator: &Simulator, evaluation: &Evaluation, held_out: &Logs) -> Result<()> {
    write(folder, &figures_of_networks(simulator, evaluation, held_out))
}

/// Figure 2, expected against predicted, and figure 3, the sonar surfaces, of a simulator that has the sonar networks.
pub fn figures_of_networks(simulator: &Simulator, evaluation: &Evaluation, held_out: &Logs) -> Vec<NamedFigure> {
    let n = &evaluation.networks;
    let values = [
        ("Forward", "cm", &n.forward),
        ("Lateral", "cm", &n.lateral),
        ("Turn", "deg", &n.turn),
        ("Echo reading", "cm", &n.echo_value),
    ];
    let mut panels: Vec<Panel> = values
        .into_iter()
        .filter_map(|(title, unit, value)| {
            let pairs = value.as_ref()?.points.iter().map(|p| DVec2::from_array(*p)).collect();
            Some(Panel { title: title.into(), samples: Samples::Values { unit: unit.into(), pairs } })
        })
        .collect();
    if let Some(probability) = &n.echo_probability {
        let events = probability.points.iter().map(|[happened, predicted]| (*predicted, *happened > 0.5)).collect();
        panels
            .insert(panels.len().min(3), Panel { title: "Echo probability".into(), samples: Samples::Events(events) });
    }
    let expected = named("figure-2-expected-against-predicted", report::expected_against_predicted(&panels));
    let data = Datasets::from_logs(held_out);
    let max_cm = simulator.robot.ultrasonic.max_cm;
    let ask = |network: &Network<f32, 2>, d: f64, alpha: f64| f64::from(network.evaluate([d as f32, alpha as f32]));
    let (probability, value) = (&simulator.echo_probability, &simulator.echo_value);
    let (Some(probability), Some(value)) = (probability, value) else { return vec![expected] };
    let probability = |d: f64, alpha: f64| ask(&probability.network, d, alpha);
    let value = |d: f64, alpha: f64| ask(&value.network, d, alpha);
    let surface = |title: &str, value_name: &str, at, value, data: &Dataset<2>| {
        let support = Support::of(data, max_cm);
        Surface {
            title: title.into(),
            value_name: value_name.into(),
            at,
            known: Box::new(move |d: f64, alpha: f64| support.has(d, alpha)),
            distance_cm: 0.0..max_cm,
            incidence_deg: 0.0..90.0,
            value,
            test: test_points(data),
        }
    };
    let surfaces = [
        surface(
            "Probability of an echo",
            "probability",
            &probability as &dyn Fn(f64, f64) -> f64,
            0.0..1.0,
            &data.echo_probability,
        ),
        surface("Reading", "reading (cm)", &value, 0.0..max_cm, &data.echo_value),
    ];
    vec![expected, named("figure-3-sonar-surfaces", report::sonar_surfaces(&surfaces))]
}

/// Writes [`figure_of_paths`].
///
/// # Errors
/// When the folder cannot be written.
pub fn paths(folder: &Path, panels: &[PathPanel]) -> Result<()> {
    write(folder, &[figure_of_paths(panels)])
}

/// Figure 4: simulated and real paths, a panel a start.
pub fn figure_of_paths(panels: &[PathPanel]) -> NamedFigure {
    named("figure-4-simulated-and-real-paths", report::paths(panels))
}

/// A panel of figure 4 with simulated runs alone.
pub fn simulated_paths(title: String, scene: &Scene, start: Pose, rollouts: &RolloutReport) -> PathPanel {
    PathPanel {
        title,
        scene: scene.clone(),
        start,
        target_radius_cm: REACHED_CM,
        simulated: rollouts.runs.iter().map(simulated).collect(),
        real: Vec::new(),
    }
}

/// Writes [`figures_of_diagnosis`].
///
/// # Errors
/// When the folder cannot be written.
pub fn diagnosis(folder: &Path, diagnosis: &Diagnosis) -> Result<()> {
    write(folder, &figures_of_diagnosis(diagnosis))
}

/// The figures of a diagnosis: its budget, the ends of paths, and what is left; nothing of what it does not have.
pub fn figures_of_diagnosis(diagnosis: &Diagnosis) -> Vec<NamedFigure> {
    let budget: Vec<Bar> = diagnosis
        .budget
        .iter()
        .map(|part| Bar { name: part.id.clone(), share: part.share, interval: part.ci95 })
        .collect();
    let mut figures = Vec::new();
    if !budget.is_empty() {
        figures.push(named("budget", report::bars("What the gap is made of", "share of the gap (%)", &budget)));
    }
    let reduction = diagnosis.reduction.as_ref().filter(|reduction| !reduction.paths.is_empty());
    figures.extend(reduction.map(|reduction| named("path-ends", ends(reduction))));
    figures.extend(diagnosis.profiles.iter().map(|profile| {
        named(&format!("unexplained-{}", profile.channel.name().replace('_', "-")), unexplained(profile))
    }));
    figures
}

fn ends(found: &GapReduction) -> Figure {
    let curve = |name: &str, of: fn(&PathError) -> f64| Curve {
        name: name.into(),
        points: found.paths.iter().map(|p| DVec2::new(p.steps as f64, of(p))).collect(),
        reach: Vec::new(),
    };
    let all = [
        curve("the simulator as it is", |p| p.before_cm),
        curve("with the effects", |p| p.after_cm),
        curve("scatter alone", |p| p.floor_cm),
    ];
    curves("Median distance of predicted from logged ends", "steps", "cm", &all)
}

fn unexplained(part: &ResidualProfile) -> Figure {
    let middle = |from: f64, to: f64| 0.5 * (from + to);
    let curve = Curve {
        name: "logged minus predicted, 95 %".into(),
        points: part.bins.iter().map(|b| DVec2::new(middle(b.from, b.to), b.off)).collect(),
        reach: part.bins.iter().map(|b| 1.96 * b.error).collect(),
    };
    let name = part.channel.name();
    curves(&format!("{name} by {}", part.depends_on), part.depends_on, part.unit, &[curve])
}

fn named(name: &str, figure: Figure) -> NamedFigure {
    NamedFigure { name: name.into(), figure }
}

/// Writes figures into a folder, which is made where there is none: all of them or none.
fn write(folder: &Path, figures: &[NamedFigure]) -> Result<()> {
    if figures.is_empty() {
        return Ok(());
    }
    let ours = |file: &str| {
        figures.iter().any(|NamedFigure { name, .. }| file.rsplit_once('.').is_some_and(|(stem, _)| stem == name))
    };
    files::write_folder(folder, ours, |fresh| {
        figures.iter().try_for_each(|NamedFigure { name, figure }| figure.write(fresh, name))
    })
}

/// A simulated run as a path.
pub fn simulated(run: &Rollout) -> Trace {
    let points_cm = run.path.iter().map(|p| DVec2::new(p.x_cm, p.y_cm)).collect();
    Trace { points_cm, crashed: run.termination == "crashed" }
}

fn test_points(data: &Dataset<2>) -> Vec<DVec3> {
    let samples = data.inputs.iter().zip(&data.targets).step_by(EVERY);
    samples.map(|(x, target)| DVec3::new(f64::from(x[0]), f64::from(x[1]), f64::from(*target))).collect()
}
