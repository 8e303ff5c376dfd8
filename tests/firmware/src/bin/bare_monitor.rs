//! The monitor without networks and without any output. `run.sh` counts the instructions between the two marks. The monitor's
//! flash is the size of this image without that of the same image with the feature `without-monitor`.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(target_os = "none"))]
fn main() {}

#[cfg(target_os = "none")]
mod on_target {
    use core::hint::black_box;

    use mindgap_core::chance::Generator;
    use mindgap_core::fixed::types::I16F16;
    #[cfg(not(feature = "without-monitor"))]
    use mindgap_core::monitor::Monitor;
    use mindgap_core::monitor::Step;
    use mindgap_core::rand_core::{Rng, SeedableRng};
    use mindgap_firmware::marks::{count_from_here, count_to_here};
    #[cfg(not(feature = "without-monitor"))]
    use mindgap_firmware::monitor::LAW;

    #[cfg(cortex_m)]
    use cortex_m_rt as _;

    mindgap_firmware::panics_must_not_link!();

    const STEPS: u32 = 100;

    #[unsafe(no_mangle)]
    extern "C" fn main() -> ! {
        #[cfg(not(feature = "without-monitor"))]
        let mut monitor = Monitor::new(&LAW);
        let mut generator = Generator::seed_from_u64(black_box(1));
        let mut before = [0; 2];
        for _ in 0..STEPS {
            // Predictions of a textbook robot, and measurements with the sum of two uniform draws as noise.
            let mut below = |most: u32| (generator.next_u32() >> 16).wrapping_mul(most) as i32 - (most << 15) as i32;
            let now = [below(160), below(160)];
            let predicted = [(now[0] + now[1]) / 12, (now[1] - now[0]) * 3 / 4];
            let measured = [predicted[0] + below(1) + below(1), predicted[1] + below(4) + below(4)];
            let [commands, predicted, measured] =
                [[now[0], now[1], before[0], before[1]], [predicted[0], predicted[1], 0, 0], [measured[0], measured[1], 0, 0]]
                    .map(|numbers| numbers.map(I16F16::from_bits));
            before = now;
            let [predicted, measured] = [[predicted[0], predicted[1]], [measured[0], measured[1]]];
            let step = black_box(Step { commands, predicted, measured: Some(measured), duration_ms: 401 });
            count_from_here();
            #[cfg(not(feature = "without-monitor"))]
            black_box(monitor.step(&LAW, &step));
            count_to_here();
            black_box(step);
        }
        semihosting::process::exit(0)
    }
}
