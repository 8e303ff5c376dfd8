//! A controller on a microcontroller, with simulator networks beside it: every 400 ms one task reads the sonar, asks the
//! networks whether the reading can be true, steps the controller and sets the motors.
#![no_std]
#![no_main]

mod drivers;
// Made by `mindgap_controller_export::rust_networks`.
#[rustfmt::skip]
mod networks;
mod robot;

use panic_halt as _;
use rtic_monotonics::systick::prelude::*;

systick_monotonic!(Mono, 1000);

// QEMU's board has no crate of its own. The task needs an interrupt that nothing else uses, and any device names some.
#[rtic::app(device = lm3s6965, dispatchers = [GPIOA])]
mod app {
    use cortex_m_semihosting::{debug, hprintln};
    use mindgap_core::controller::Status;

    use crate::robot::{CONTROLLER, Robot};
    use crate::{Mono, drivers};
    use rtic_monotonics::systick::prelude::*;

    #[shared]
    struct Shared {}

    #[local]
    struct Local {
        robot: Robot,
    }

    #[init]
    fn init(context: init::Context) -> (Shared, Local) {
        Mono::start(context.core.SYST, drivers::CLOCK_HZ);
        // The one task is spawned once, so there is room for it.
        let _ = run::spawn();
        (Shared {}, Local { robot: Robot::start() })
    }

    #[task(local = [robot], priority = 1)]
    async fn run(context: run::Context) {
        let robot = context.local.robot;
        let mut next = Mono::now();
        drivers::drive(robot.motors());
        while robot.status() == Status::Running {
            // Against the clock rather than a step after the last, so that reading and computing take no time.
            next += u32::from(CONTROLLER.step_ms).millis();
            Mono::delay_until(next).await;
            let motors = robot.step(drivers::read_sonar_cm());
            hprintln!("tuple {} left {} right {}", robot.tuple(), motors.left, motors.right);
            drivers::drive(motors);
        }
        hprintln!("{:?}", robot.status());
        debug::exit(debug::EXIT_SUCCESS);
    }
}
