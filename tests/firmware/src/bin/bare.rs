//! Networks, controller and random draws without any output. The size of the image is their flash, and `run.sh` counts the
//! instructions between the two marks.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(target_os = "none"))]
fn main() {}

#[cfg(target_os = "none")]
mod on_target {
    use core::hint::black_box;

    use mindgap_core::chance::Generator;
    use mindgap_core::controller::Machine;
    use mindgap_core::rand_core::SeedableRng;
    use mindgap_firmware::controller::CONTROLLER;
    use mindgap_firmware::job;
    use mindgap_firmware::marks::{count_from_here, count_to_here};

    #[cfg(cortex_m)]
    use cortex_m_rt as _;

    mindgap_firmware::panics_must_not_link!();

    const SAMPLES: u32 = 20;

    #[unsafe(no_mangle)]
    extern "C" fn main() -> ! {
        let mut generator = Generator::seed_from_u64(black_box(1));
        let mut machine = Machine::start(&CONTROLLER);
        for _ in 0..SAMPLES {
            let sample = black_box(job::sample(&mut generator));
            count_from_here();
            let outputs = job::evaluate(&sample);
            count_to_here();
            machine.step(job::reading_cm(&outputs, &mut generator));
            black_box((machine.motors(), &outputs));
        }
        semihosting::process::exit(0)
    }
}
