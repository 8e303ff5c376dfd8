//! `mindgap evaluate`

use std::path::PathBuf;

use clap::Args;

use super::json_output::JsonOption;
use super::table::{self, number};
use super::{Run, kinds, progress, textbook, warn};
use mindgap_figures::pictures;
use mindgap_files as files;
use mindgap_files::places::Places;
use mindgap_foundations::error::Result;
use mindgap_foundations::executor::Executor;
use mindgap_learning::evaluation::accuracy::{self, Evaluation, Networks, OfSensor, Probability, Value};
use mindgap_learning::evaluation::sensor_models::SensorModels;
use mindgap_logs::robot::same_robot;
use mindgap_pages::evaluation::{Subject, page};

/// Evaluate a simulator's networks on held-out logs.
#[derive(Args)]
pub struct Evaluate {
    /// The simulator file.
    sim: PathBuf,
    /// Folder of logs that were not used for training.
    logs: PathBuf,
    #[command(flatten)]
    json: JsonOption,
    /// Write an HTML page.
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,
    /// Write figures into this folder, as SVG and PNG.
    #[arg(long, value_name = "DIR")]
    figures: Option<PathBuf>,
}

impl Run for Evaluate {
    fn places(&self) -> Places {
        let places = Places::default().reading([&self.sim, &self.logs]).writing(self.json.path(), kinds::REPORT);
        places.writing(&self.html, kinds::PAGE).filling(&self.figures)
    }

    fn run(&self, _: &dyn Executor) -> Result<String> {
        let simulator = textbook::simulator(&self.sim)?;
        let heard = super::read_sound_logs_by_sensor(&self.logs)?;
        let logs = &heard[0].logs;
        same_robot(&simulator.robot, &logs.robot)?;
        let bar = progress::shares();
        let watch = progress::part(&bar, 0..100, "evaluating the networks");
        let evaluation = accuracy::evaluate_sensors(&simulator, &heard, watch, warn);
        bar.finish_and_clear();
        let evaluation = evaluation?;
        if let Some(path) = &self.html {
            let names = [&self.sim, &self.logs].map(|path| path.display().to_string());
            let names = names.each_ref().map(String::as_str);
            let subject = Subject { evaluation: &evaluation, simulator: &simulator, logs, names };
            files::write(path, page(&subject))?;
        }
        if let Some(folder) = &self.figures {
            pictures::networks(folder, &simulator, &evaluation, logs)?;
        }
        self.json.emit(&evaluation, describe(&evaluation))
    }
}

/// Returns an evaluation as tables, with the reliability diagram of the echo probability.
fn describe(evaluation: &Evaluation) -> String {
    let mut text = accuracy(&evaluation.networks);
    if let Some(table_one) = &evaluation.table_one {
        text += &format!("\nWith the sizes of the paper's Table I:\n{}", accuracy(table_one));
    }
    if let Some(p) = &evaluation.networks.echo_probability {
        let bins: Vec<[String; 3]> = p
            .reliability
            .iter()
            .map(|b| [number(Some(b.predicted), 3), number(Some(b.observed), 3), b.n.to_string()])
            .collect();
        let title = "reliability: predicted probability of a reading and observed share";
        text += &format!("\n{title}\n{}", table::text(["predicted", "observed", "n"], &bins));
    }
    if let Some(models) = &evaluation.sensor_models {
        text += &format!("\n{}", sensor_models(models));
    }
    text
}

/// Returns the mean log-likelihood of the readings under each sensor model as a table.
fn sensor_models(models: &SensorModels) -> String {
    let SensorModels { n, networks, beam, first_echo, ideal_ray } = models;
    let models = [("networks", networks), ("beam", beam), ("first echo", first_echo), ("ideal ray", ideal_ray)];
    let rows: Vec<[String; 4]> = models
        .into_iter()
        .filter_map(|(name, nats)| Some((name, nats.as_ref()?)))
        .map(|(name, nats)| {
            [name.into(), number(Some(nats.as_logged), 3), number(nats.poses_refitted, 3), n.to_string()]
        })
        .collect();
    table::text(["sensor model", "nats per reading", "scan poses refitted", "n"], &rows)
}

/// Returns the accuracy of every network as tables.
pub fn accuracy(networks: &Networks) -> String {
    let Networks { turn, forward, lateral, echo_value, named, .. } = networks;
    let [turn, forward, lateral] = [turn, forward, lateral].map(Option::as_ref);
    let reading = networks.unnamed_value();
    let values =
        [("turn (deg)", turn), ("forward (cm)", forward), ("lateral (cm)", lateral), ("echo value (cm)", reading)];
    let row = |(name, v): (&str, &Value)| {
        let (slope, intercept) = v.trend.map(|t| (t.slope, t.intercept)).unzip();
        let trend = [number(slope, 3), number(intercept, 2)];
        let [slope, intercept] = trend;
        [name.into(), number(v.r2, 4), number(Some(v.mse), 4), slope, intercept, v.n.to_string()]
    };
    let values = values.into_iter().filter_map(|(name, value)| Some((name, value?)));
    let rows: Vec<[String; 6]> = values.chain(networks.named_values()).map(row).collect();
    let mut text = table::text(["network", "R2", "MSE", "slope", "intercept", "n"], &rows);
    if let Some(mae_cm) = echo_value.as_ref().and_then(|v| v.mae_cm) {
        text += &format!("echo value: mean absolute error {mae_cm:.2} cm\n");
    }
    let row = |(name, p): (&str, &Probability)| {
        let [brier, log_loss] = [p.brier, p.log_loss].map(|score| number(Some(score), 4));
        [name.into(), brier, log_loss, number(p.auc, 4), number(p.r2, 4), p.n.to_string()]
    };
    let of_sensors = named.iter().filter_map(|(name, of)| match of {
        OfSensor::Probability(probability) => Some((name.as_str(), probability)),
        OfSensor::Value(_) => None,
    });
    let first = networks.unnamed_probability().map(|probability| ("echo", probability));
    let rows: Vec<[String; 6]> = first.into_iter().chain(of_sensors).map(row).collect();
    if !rows.is_empty() {
        let header = ["probability", "Brier", "log loss", "AUC", "R2", "n"];
        text += &format!("\n{}", table::text(header, &rows));
    }
    text
}
