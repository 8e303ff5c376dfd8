//! Networks, controller and draws without anything that prints. It is linked only if no panic can be reached, its size
//! is what they take in flash, and `run.sh` counts the instructions between the two marks.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(target_os = "none"))]
fn main() {}

#[cfg(target_os = "none")]
mod on_target {
    use core::arch::asm;
    use core::hint::black_box;
    use core::panic::PanicInfo;

    use mindgap_core::chance::Generator;
    use mindgap_core::controller::Machine;
    use mindgap_firmware::controller::CONTROLLER;
    use mindgap_firmware::job;
    use rand_core::SeedableRng;

    #[cfg(cortex_m)]
    use cortex_m_rt as _;

    const SAMPLES: u32 = 20;

    #[unsafe(no_mangle)]
    extern "C" fn main() -> ! {
        let mut generator = Generator::seed_from_u64(black_box(1));
        let mut machine = Machine::start();
        for _ in 0..SAMPLES {
            let sample = black_box(job::sample(&mut generator));
            count_from_here();
            let answers = job::evaluate(&sample);
            count_to_here();
            machine.step(&CONTROLLER, job::reading_cm(&answers, &mut generator));
            black_box((machine.motors(&CONTROLLER), &answers));
        }
        #[cfg(feature = "reachable-panic")]
        assert!(black_box(machine.steps()) > 0);
        semihosting::process::exit(0)
    }

    #[unsafe(no_mangle)]
    #[inline(never)]
    extern "C" fn count_from_here() {
        // SAFETY: does nothing. One instruction here and two below keep the two marks apart.
        unsafe { asm!("nop") }
    }

    #[unsafe(no_mangle)]
    #[inline(never)]
    extern "C" fn count_to_here() {
        // SAFETY: does nothing.
        unsafe { asm!("nop", "nop") }
    }

    /// Calls what is defined nowhere: an image from which a panic can be reached does not link.
    #[panic_handler]
    fn panic(_: &PanicInfo<'_>) -> ! {
        unsafe extern "C" {
            safe fn a_panic_can_be_reached() -> !;
        }
        a_panic_can_be_reached()
    }
}
