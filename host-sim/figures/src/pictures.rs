//! Figures of what commands find, as files: figures 2, 3 and 4 of the paper, and those of a diagnosis.

use std::path::Path;

use glam::{DVec2, DVec3};

use crate::report::curves::{Curve, CurveChart, Point};
use crate::report::expected_against_predicted::{Panel, Samples};
use crate::report::paths::{PathPanel, Trace};
use crate::report::shares::{Share, ShareChart};
use crate::report::sonar_surfaces::Surface;
use crate::report::style::{BLUE, GREY, VERMILION};
use crate::report::{self, Figure};
use mindgap_diagnosis::Diagnosis;
use mindgap_diagnosis::account::GapReduction;
use mindgap_diagnosis::budget::{Part, SCATTER, UNEXPLAINED};
use mindgap_diagnosis::explain::profile::{Bin, ResidualProfile};
use mindgap_diagnosis::scope::of_sensor;
use mindgap_files as files;
use mindgap_foundations::error::Result;
use mindgap_foundations::geometry::Pose;
use mindgap_learning::evaluation::accuracy::{Evaluation, Networks};
use mindgap_learning::evaluation::paths::PathError;
use mindgap_learning::evaluation::support::Support;
use mindgap_learning::learn::dataset::{Dataset, Datasets};
use mindgap_logs::{Logs, Scene, Termination, Ultrasonic};
use mindgap_models::simulator::rollout::REACHED_CM;
use mindgap_models::simulator::rollout_report::{Rollout, RolloutReport};
use mindgap_models::simulator::{Learned, Simulator};

/// Figure 3 shows at most one test sample in this many, so that single ones are visible,
const EVERY: usize = 4;
/// and about this many at most.
const MOST_SAMPLES: usize = 400;
/// Half width of a 95 % interval, in standard errors.
const Z95: f64 = 1.96;

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
    let expected = report::expected_against_predicted(&panels(&evaluation.networks));
    let mut figures = vec![named("figure-2-expected-against-predicted", expected)];
    let surfaces = surfaces(simulator, held_out);
    if surfaces.len() == 2 {
        figures.push(named("figure-3-sonar-surfaces", report::sonar_surfaces(&surfaces)));
    }
    figures
}

/// The held-out samples of each network that a simulator has, in the order of the paper.
pub fn panels(networks: &Networks) -> Vec<Panel> {
    let Networks { forward, lateral, turn, echo_probability, echo_value, .. } = networks;
    let values = [
        ("Forward", "cm", forward),
        ("Lateral", "cm", lateral),
        ("Turn", "deg", turn),
        ("Echo reading", "cm", echo_value),
    ];
    let mut panels: Vec<Panel> = values
        .into_iter()
        .filter_map(|(title, unit, value)| {
            let pairs = value.as_ref()?.points.iter().map(|p| DVec2::from_array(*p)).collect();
            Some(Panel { title: title.into(), samples: Samples::Values { unit: unit.into(), pairs } })
        })
        .collect();
    if let Some(probability) = echo_probability {
        let events = probability.points.iter().map(|[happened, predicted]| (*predicted, *happened > 0.5)).collect();
        let panel = Panel { title: "Echo probability".into(), samples: Samples::Events(events) };
        panels.insert(panels.len().min(3), panel);
    }
    panels
}

/// The responses of the sonar networks that a simulator has, with samples of logs.
pub fn surfaces<'a>(simulator: &'a Simulator, logs: &Logs) -> Vec<Surface<'a>> {
    let data = Datasets::from_logs(logs);
    let Some(Ultrasonic { max_cm, .. }) = simulator.robot.ultrasonic else { return Vec::new() };
    let surface = |title: &str, value_name: &str, learned: &'a Option<Learned<2>>, value, data: &Dataset<2>| {
        let network = &learned.as_ref()?.network;
        let support = Support::of(data, max_cm);
        Some(Surface {
            title: title.into(),
            value_name: value_name.into(),
            at: Box::new(|d: f64, alpha: f64| f64::from(network.evaluate([d as f32, alpha as f32]))),
            known: Box::new(move |d: f64, alpha: f64| support.has(d, alpha)),
            distance_cm: 0.0..max_cm,
            incidence_deg: 0.0..90.0,
            value,
            test: test_points(data),
        })
    };
    let (echo, value) = (&simulator.echo_probability, &simulator.echo_value);
    let echo = surface("Probability of an echo", "probability", echo, 0.0..1.0, &data.echo_probability);
    echo.into_iter().chain(surface("Reading", "reading (cm)", value, 0.0..max_cm, &data.echo_value)).collect()
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

/// The figures of a diagnosis: its budget, the ends of paths, and what is left; only those for which it has data.
pub fn figures_of_diagnosis(diagnosis: &Diagnosis) -> Vec<NamedFigure> {
    let mut figures = Vec::new();
    if !diagnosis.budget.is_empty() {
        let title = "What the gap is made of".into();
        let budget = ShareChart { title, ..budget(diagnosis, |part| of_sensor(&part.id, part.sensor.as_deref())) };
        figures.push(named("budget", budget.draw()));
    }
    if let Some(reduction) = diagnosis.reduction.as_ref().filter(|reduction| !reduction.paths.is_empty()) {
        let title = "Median distance of predicted from logged ends".into();
        figures.push(named("path-ends", CurveChart { title, ..path_ends(reduction) }.draw()));
    }
    figures.extend(diagnosis.profiles.iter().map(|profile| {
        let ResidualProfile { channel, depends_on, unit, bins, .. } = profile;
        let title = format!("{} by {depends_on}", channel.name());
        let chart = residuals(depends_on, unit, &[("remaining residual, 95 %", bins)]);
        named(&format!("unexplained-{}", channel.name().replace('_', "-")), CurveChart { title, ..chart }.draw())
    }));
    figures
}

/// The parts of a gap, effects first and the largest of them at the top, with names from their ids.
pub fn budget(diagnosis: &Diagnosis, name: impl Fn(&Part) -> String) -> ShareChart {
    let mut parts: Vec<&Part> = diagnosis.budget.iter().collect();
    let effects = parts.partition_point(|part| part.id != SCATTER && part.id != UNEXPLAINED);
    parts[..effects].sort_by(|a, b| b.share.total_cmp(&a.share));
    let row = |part: &&Part| Share {
        name: name(part),
        share: part.share,
        interval: part.ci95,
        colour: match part.id.as_str() {
            SCATTER => BLUE,
            UNEXPLAINED => GREY,
            _ => VERMILION,
        },
    };
    ShareChart { axis: "share of the gap (%)".into(), rows: parts.iter().map(row).collect(), ..ShareChart::default() }
}

/// How far predicted paths end from logged ones.
pub fn path_ends(found: &GapReduction) -> CurveChart {
    let curve = |name: &str, of: fn(&PathError) -> f64| Curve {
        name: name.into(),
        points: found.paths.iter().map(|p| Point::new(p.steps as f64, of(p))).collect(),
    };
    CurveChart {
        x_name: "steps driven by the commands alone".into(),
        y_name: "distance from the logged end (cm)".into(),
        curves: vec![
            curve("without the effects", |p| p.before_cm),
            curve("with the effects", |p| p.after_cm),
            curve("scatter alone", |p| p.floor_cm),
        ],
        counts: found.paths.iter().map(|p| p.steps).collect(),
        ..CurveChart::default()
    }
}

/// Logged minus predicted values along a covariate, for one or more kinds of prediction.
pub fn residuals(depends_on: &str, unit: &str, kinds: &[(&str, &[Bin])]) -> CurveChart {
    let point = |bin: &Bin| Point {
        at: DVec2::new(0.5 * (bin.from + bin.to), bin.off),
        interval: [bin.off - Z95 * bin.error, bin.off + Z95 * bin.error],
    };
    let curve =
        |(name, bins): &(&str, &[Bin])| Curve { name: (*name).into(), points: bins.iter().map(point).collect() };
    CurveChart {
        x_name: depends_on.into(),
        y_name: format!("logged − predicted ({unit})"),
        curves: kinds.iter().map(curve).collect(),
        ..CurveChart::default()
    }
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
    Trace { points_cm, crashed: run.termination == Termination::Crashed }
}

fn test_points(data: &Dataset<2>) -> Vec<DVec3> {
    let every = data.inputs.len().div_ceil(MOST_SAMPLES).max(EVERY);
    let samples = data.inputs.iter().zip(&data.targets).step_by(every);
    samples.map(|(x, target)| DVec3::new(f64::from(x[0]), f64::from(x[1]), f64::from(*target))).collect()
}
