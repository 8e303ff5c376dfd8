//! Does the job and reports it. On a processor it also reports the stack of the networks and a step of the controller.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(target_os = "none"))]
fn main() {
    mindgap_firmware::job::run();
}

#[cfg(target_os = "none")]
mod on_target {
    use core::hint::black_box;
    use core::panic::PanicInfo;

    use mindgap_core::chance::Generator;
    use mindgap_core::controller::Machine;
    use mindgap_core::rand_core::SeedableRng;
    use mindgap_firmware::controller::CONTROLLER;
    use mindgap_firmware::{job, report, stack};

    #[cfg(cortex_m)]
    use {cortex_m as _, cortex_m_rt as _, defmt_semihosting as _};

    #[unsafe(no_mangle)]
    extern "C" fn main() -> ! {
        job::run();
        report!("measured: stack {} bytes", stack::used_by(one_step));
        semihosting::process::exit(0)
    }

    fn one_step() {
        let mut generator = Generator::seed_from_u64(black_box(1));
        let mut machine = Machine::start(&CONTROLLER);
        let outputs = job::evaluate(&job::sample(&mut generator));
        machine.step(job::reading_cm(&outputs, &mut generator));
        black_box((machine.motors(), &outputs));
    }

    #[panic_handler]
    fn panic(_: &PanicInfo<'_>) -> ! {
        semihosting::process::exit(101)
    }
}
