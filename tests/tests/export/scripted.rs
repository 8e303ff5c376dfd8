//! Runs by script of programs for boards: random controllers, what the sensor answers, and what the core's machine does.

use mindgap_controller_export::onboard::{Ending, FAILED_STEPS_TO_STOP};
use mindgap_core::controller::{Controller, Machine, Motors, Status, Tuple, When};
use mindgap_foundations::chance::Generator;
use rand::RngExt;

/// What the sensor answers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Answer {
    /// A distance in mm.
    Mm(u16),
    /// No echo.
    NoEcho,
    /// No answer.
    Dead,
}

/// Answers of a run at most.
pub const MOST_STEPS: u16 = 40;

/// When motors were set, and to what.
pub type Command = (u32, Motors);

/// Any controller whose run ends.
pub fn controller(least_step_ms: u16, rng: &mut Generator) -> Controller {
    let mut tuple = || Tuple {
        left: rng.random_range(-100..=100),
        right: rng.random_range(-100..=100),
        when: if rng.random() { When::Larger } else { When::Smaller },
        threshold_cm: rng.random_range(0..=255),
    };
    let tuples = std::array::from_fn(|_| tuple());
    Controller { step_ms: rng.random_range(least_step_ms..1_000), max_steps: rng.random_range(1..MOST_STEPS), tuples }
}

/// Answers of a sensor that tells whole multiples of `resolution_mm`, often the controller's own thresholds.
pub fn answers(controller: &Controller, resolution_mm: u16, rng: &mut Generator) -> Vec<Answer> {
    let mut answer = || match rng.random_range(0..20) {
        0 => Answer::Dead,
        1..4 => Answer::NoEcho,
        4..8 => Answer::Mm(10 * controller.tuples[rng.random_range(0..6)].threshold_cm as u16),
        _ => Answer::Mm(rng.random_range(0..2_000 / resolution_mm) * resolution_mm),
    };
    (0..MOST_STEPS).map(|_| answer()).collect()
}

/// The ending and all motor commands with their times, as the core's machine has them. The first answer also tells whether
/// a sensor is there, before anything moves.
pub fn expected(controller: &Controller, answers: &[Answer]) -> (Ending, Vec<Command>) {
    if answers[0] == Answer::Dead {
        return (Ending::NoSonar, Vec::new());
    }
    let mut machine = Machine::start();
    let mut commands = vec![(0, machine.motors(controller))];
    let mut failed_steps = 0;
    for (step, answer) in (1u32..).zip(answers) {
        let tuple = machine.tuple();
        let reading_cm = match answer {
            Answer::Mm(mm) => Some(f32::from(*mm) / 10.0),
            Answer::NoEcho | Answer::Dead => None,
        };
        failed_steps = if *answer == Answer::Dead { failed_steps + 1 } else { 0 };
        let status = machine.step(controller, reading_cm);
        let t_ms = step * u32::from(controller.step_ms);
        let ending = match status {
            Status::Finished => Some(Ending::Finished),
            _ if failed_steps == FAILED_STEPS_TO_STOP => Some(Ending::SonarDead),
            Status::TimedOut => Some(Ending::TimedOut),
            Status::Running => None,
        };
        if let Some(ending) = ending {
            commands.push((t_ms, Motors { left: 0, right: 0 }));
            return (ending, commands);
        }
        if machine.tuple() != tuple {
            commands.push((t_ms, machine.motors(controller)));
        }
    }
    panic!("more steps than answers");
}
