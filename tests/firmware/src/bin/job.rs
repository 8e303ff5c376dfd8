//! Does the job and reports it; on a processor also how much stack the networks and a controller's step take.
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
    use mindgap_firmware::{job, report, stack};
    use rand_core::SeedableRng;

    #[cfg(cortex_m)]
    use {cortex_m as _, cortex_m_rt as _, defmt_semihosting as _};

    #[unsafe(no_mangle)]
    extern "C" fn main() -> ! {
        job::run();
        report!("measured: stack {} bytes", stack::used_by(evaluate_once));
        semihosting::process::exit(0)
    }

    fn evaluate_once() {
        let sample = job::sample(&mut Generator::seed_from_u64(black_box(1)));
        black_box(job::evaluate(&sample));
    }

    #[panic_handler]
    fn panic(_: &PanicInfo<'_>) -> ! {
        semihosting::process::exit(101)
    }
}
