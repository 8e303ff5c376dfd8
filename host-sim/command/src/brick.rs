//! `mindgap brick`

pub mod results;
mod trace;

use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;
use mindgap_controller_export::brick::{self, Program, Report, RunConfig, ScriptedWorld};

use super::evolve::start_of;
use super::json_output::JsonOption;
use super::ports::PortOptions;
use super::{Run, kinds, textbook, warn};
use mindgap_applications::on_board::{OnBoard, Vehicle};
use mindgap_built_in_robot::{BuiltInRobot, default_robot};
use mindgap_figures::report::paths::{PathPanel, Trace};
use mindgap_figures::report::{Figure, paths};
use mindgap_files as files;
use mindgap_files::places::Places;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::executor::Executor;
use mindgap_foundations::geometry::Pose;
use mindgap_foundations::random::generator;
use mindgap_logs::world_script::{self, WorldScript};
use mindgap_logs::{self as logs, Robot, Scene, readings};
use mindgap_models::simulator::Noise;
use mindgap_models::simulator::body::SimulatedBody;
use mindgap_models::simulator::environment::Environment;
use mindgap_models::simulator::rollout::REACHED_CM;
use results::BrickResults;

/// Emulate a compiled NXT program and trace it: motors, tones, text and files.
///
/// Its sensors follow a script, or a robot in a scene: the built-in robot or a learned simulator.
#[derive(Args)]
pub struct Brick {
    /// Program to run, an .rxe file for the standard firmware.
    program: PathBuf,
    /// Answers of the ultrasonic sensor, one per request: a list such as 120,80,none,silent,hangs, or a CSV file with a
    /// column echo_cm. The sensor is silent after the last one.
    #[arg(long, value_name = "LIST|FILE", required_unless_present = "scene", conflicts_with = "scene")]
    readings: Option<String>,
    /// Inputs of the other sensors and the buttons: a CSV file with t_ms and any of port_1 to port_4 (percent; a touch
    /// sensor is pressed above 0), right, left and orange (1 while the button is down).
    #[arg(long, value_name = "FILE", conflicts_with = "scene")]
    world: Option<PathBuf>,
    /// Block the wheels: they do not turn.
    #[arg(long, conflicts_with = "scene")]
    blocked: bool,
    /// Scene in which the robot drives.
    #[arg(long, value_name = "FILE")]
    scene: Option<PathBuf>,
    /// Number of the start in the scene, from 1.
    #[arg(long, value_name = "N", default_value_t = 1, conflicts_with = "readings")]
    start: usize,
    /// Simulator that moves the robot (default: the built-in robot).
    #[arg(long, conflicts_with = "readings")]
    sim: Option<PathBuf>,
    /// Random seed.
    #[arg(long, value_name = "N", default_value_t = 1, conflicts_with = "readings")]
    seed: u64,
    /// Write the run as a log.
    #[arg(long, value_name = "RUN.csv", conflicts_with = "readings")]
    out: Option<PathBuf>,
    /// Draw the path, as .svg or .png.
    #[arg(long, value_name = "FILE", conflicts_with = "readings")]
    figure: Option<PathBuf>,
    #[command(flatten)]
    ports: PortOptions,
    /// Battery voltage.
    #[arg(long, default_value_t = 7800, conflicts_with = "scene")]
    battery_mv: u16,
    /// Time at which the dark grey button is pressed, which ends any program.
    #[arg(long, value_name = "MS", conflicts_with = "scene")]
    exit_ms: Option<u32>,
    /// Time limit on the brick's clock.
    #[arg(long, default_value_t = 120_000, value_parser = clap::value_parser!(u32).range(1..=600_000))]
    limit_ms: u32,
    /// Maximum number of events to report; later ones are only counted.
    #[arg(long, value_name = "N", default_value_t = 10_000)]
    limit_events: usize,
    #[command(flatten)]
    json: JsonOption,
}

impl Run for Brick {
    fn places(&self) -> Places {
        // `--readings` takes a list or a file.
        let readings = self.readings.as_ref().map(PathBuf::from);
        let inputs =
            [Some(&self.program), readings.as_ref(), self.world.as_ref(), self.scene.as_ref(), self.sim.as_ref()];
        Places::default()
            .reading(inputs.into_iter().flatten())
            .writing(self.json.path(), kinds::REPORT)
            .writing(&self.out, kinds::UNSIGNED)
            .writing(&self.figure, kinds::UNSIGNED)
    }

    fn run(&self, _: &dyn Executor) -> Result<String> {
        let file =
            fs::read(&self.program).map_err(|e| Error::in_file(&self.program, format!("cannot be read: {e}")))?;
        let program = Program::load(&file)
            .map_err(|e| Error::in_file(&self.program, format!("is not a program that an NXT can run: {e}")))?;
        let config = RunConfig { run_ms: self.limit_ms, limit_events: self.limit_events, ..RunConfig::default() };
        let (report, configured, world) = match &self.scene {
            Some(scene) => self.in_scene(scene, &program, &config)?,
            None => self.by_script(&program, &config)?,
        };
        let is_unconfigured = |port: &usize| report.ports_read[*port] && !configured.contains(port);
        let unconfigured: Vec<usize> = (0..report.ports_read.len()).filter(is_unconfigured).map(|at| at + 1).collect();
        for port in &unconfigured {
            warn(format!("{}: {}", self.program.display(), self.unconfigured(*port)));
        }
        self.json.emit_sorted(&BrickResults::new(&report, unconfigured), trace::text(&report) + &world)
    }
}

impl Brick {
    /// Returns the warning about a sensor port that the program reads and that has no sensor.
    fn unconfigured(&self, port: usize) -> String {
        let sensors = match &self.scene {
            Some(_) => "the robot in the scene has only the ultrasonic sensor of --sonar".to_owned(),
            None => format!("--sonar {port} puts the ultrasonic sensor there, column port_{port} of --world another"),
        };
        format!("the program reads port {port}, which no option configures, as empty; {sensors}")
    }

    /// Returns the report, the ports that have a sensor, and a line about the readings used.
    fn by_script(&self, program: &Program, config: &RunConfig) -> Result<(Report, Vec<usize>, String)> {
        let sonar = self.readings.as_deref().map_or(Ok(Vec::new()), readings::read)?;
        let WorldScript { levels, presses } =
            self.world.as_deref().map_or(Ok(WorldScript::default()), world_script::read)?;
        let configured = levels.iter().map(|level| level.port).chain([self.ports.wiring().sonar as usize]).collect();
        let mut world = ScriptedWorld {
            sonar_port: self.ports.wiring().sonar as usize,
            battery_mv: self.battery_mv,
            exit_pressed_ms: self.exit_ms,
            wheels_blocked: self.blocked,
            levels,
            presses,
            ..ScriptedWorld::sonar(sonar)
        };
        let report = brick::run(program, &mut world, config);
        let used = world.requests.min(world.sonar.len());
        Ok((report, configured, format!("the program asked for {used} of {} readings\n", world.sonar.len())))
    }

    /// Returns the report, the ports that have a sensor, and a line about the end of the run.
    fn in_scene(&self, path: &Path, program: &Program, config: &RunConfig) -> Result<(Report, Vec<usize>, String)> {
        let wiring = self.ports.wiring();
        wiring.check().map_err(|e| Error::new(e.to_string()))?;
        if let Some(figure) = self.figure.as_ref().filter(|figure| !is_svg(figure) && !has_ending(figure, "png")) {
            return Err(Error::in_file(figure, "must end with .svg or .png"));
        }
        let scene = Scene::read(path)?;
        let simulator = self.sim.as_deref().map(textbook::simulator).transpose()?;
        let robot = simulator.as_ref().map_or_else(default_robot, |simulator| simulator.robot);
        let start = start_of(&scene, self.start, &robot, path)?;
        let mut rng = generator(self.seed, &[self.start as u64]);
        let built_in = BuiltInRobot::new(&robot, &scene, &[]);
        let environment = simulator
            .as_ref()
            .map(|simulator| Environment::new(simulator, &scene, start, Noise::Learned))
            .transpose()?;
        let vehicle = match &environment {
            Some(environment) => Vehicle::Simulated(Box::new(SimulatedBody::at_rest(environment, &scene))),
            None => Vehicle::BuiltIn(Box::new(built_in.start(start, &mut rng))),
        };
        let mut world = OnBoard::new(vehicle, wiring, robot.step_ms as u32, rng);
        let report = brick::run(program, &mut world, config);
        let (end, crashed) = (world.pose(), world.crashed());
        let name = self.out.as_deref().and_then(Path::file_stem).unwrap_or_default().to_string_lossy().into_owned();
        let run = logs::Run { name, rows: world.into_rows(report.ended_ms).into_iter().collect() };
        if let Some(out) = &self.out {
            run.write(out)?;
        }
        if let Some(path) = &self.figure {
            let figure = self.draw(&scene, start, &run, crashed);
            if is_svg(path) { files::write(path, figure.svg()) } else { files::write(path, figure.png()) }?;
        }
        Ok((report, vec![wiring.sonar as usize], self.end_text(&scene, &robot, end, crashed)))
    }

    fn draw(&self, scene: &Scene, start: Pose, run: &logs::Run, crashed: bool) -> Figure {
        let points_cm = run.rows.iter().filter_map(|row| Some(row.pose?.position_cm)).collect();
        let trace = Trace { points_cm, crashed };
        let (simulated, real) = if self.sim.is_some() { (vec![trace], Vec::new()) } else { (Vec::new(), vec![trace]) };
        let title = self.program.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let panel = PathPanel { title, scene: scene.clone(), start, target_radius_cm: REACHED_CM, simulated, real };
        paths(&[panel])
    }

    fn end_text(&self, scene: &Scene, robot: &Robot, end: Pose, crashed: bool) -> String {
        let who = if self.sim.is_some() { "simulated robot" } else { "built-in robot" };
        let at_cm = end.position_cm;
        let how = if crashed { "crashed" } else { "stopped" };
        let target = scene
            .target_cm
            .map_or(String::new(), |target_cm| format!(", {:.1} cm from the target", at_cm.distance(target_cm)));
        format!("the {who} {how} at {:.1}, {:.1} cm{target}; one row per {} ms\n", at_cm.x, at_cm.y, robot.step_ms)
    }
}

fn is_svg(path: &Path) -> bool {
    has_ending(path, "svg")
}

fn has_ending(path: &Path, ending: &str) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(ending))
}
