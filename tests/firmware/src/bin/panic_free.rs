//! Calls everything in `mindgap-core`. The image is never run: it links only if no panic is reachable.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(target_os = "none"))]
fn main() {}

#[cfg(target_os = "none")]
mod on_target {
    use core::hint::black_box;

    use mindgap_core::controller::{Controller, Machine, Tuple};
    use mindgap_core::fixed_network::FixedNetwork;
    use mindgap_core::folded::{FoldedNetwork, evaluate_all};
    use mindgap_core::maths;
    use mindgap_core::monitor::{Alternative, Monitor, Step};
    use mindgap_core::network::{Network, ProductUnit, Scaling, SummationUnit};
    use mindgap_core::pair::Pair;
    use mindgap_firmware::controller::CONTROLLER;
    use mindgap_firmware::job;
    use mindgap_firmware::monitor::LAW;
    use mindgap_firmware::networks::{ECHO_VALUE, TURN};

    #[cfg(cortex_m)]
    use cortex_m_rt as _;

    mindgap_firmware::panics_must_not_link!();

    #[unsafe(no_mangle)]
    extern "C" fn main() -> ! {
        controller();
        network::<2>();
        network::<4>();
        fixed_network(&ECHO_VALUE);
        fixed_network(&TURN);
        functions(black_box(0.5));
        monitor();
        #[cfg(feature = "reachable-panic")]
        assert!(black_box(0) == 0);
        semihosting::process::exit(0)
    }

    fn controller() {
        let tuple = Tuple { left: black_box(0), threshold_cm: black_box(0), ..CONTROLLER.tuples[0] };
        let controller = Controller { step_ms: black_box(0), max_steps: black_box(0), tuples: black_box([tuple; 6]) };
        let mut machine = Machine::start(&controller);
        while black_box(machine.step(Some(black_box(1.0f32)))) != black_box(machine.status()) {}
        machine.hold(black_box(1));
        black_box((machine.motors(), machine.steps(), machine.tuple(), controller.check().is_ok()));
    }

    fn network<const N: usize>() {
        let number = || black_box(1.0f32);
        let mut network = Network::constant(black_box([Scaling::onto_one_to_two(number(), number()); N]), number());
        while black_box(true) {
            let weights = black_box([1.0; N]);
            let _ = network.summation.push(SummationUnit { weights, bias: number(), output: number() });
            let _ = network.product.push(ProductUnit { exponents: weights, output: number() });
        }
        let inputs = black_box([1.0f32; N]);
        black_box((network.evaluate(inputs), network.check().is_ok(), network.parameters()));
        let folded = black_box(FoldedNetwork::<f32, N>::fold(&network));
        black_box((folded.evaluate(inputs), evaluate_all(&[folded.clone()], inputs)));
        let (x, log2_x) = folded.scale(inputs.map(|input| Pair(input, input)));
        let pair = folded.evaluate_scaled_pair(&x, &log2_x);
        black_box((pair.0, pair.1, FoldedNetwork::<f64, N>::fold(&network)));
    }

    fn fixed_network<const N: usize, const POWERS: usize>(network: &FixedNetwork<N, POWERS>) {
        black_box(black_box(network.clone()).evaluate(black_box([job::HALF; N])));
    }

    fn monitor() {
        let mut monitor = Monitor::new(black_box(&LAW));
        monitor.start_run();
        let number = || black_box(job::HALF);
        let step = Step {
            commands: [number(); 4],
            predicted: [number(); 2],
            measured: black_box(Some([number(); 2])),
            duration_ms: black_box(400),
        };
        black_box((monitor.step(black_box(&LAW), &step), monitor.evidence(black_box(Alternative::Wider(0)))));
    }

    fn functions(x: f32) {
        black_box((maths::exp2(x), maths::log2(x), maths::sin(x), maths::cos(x)));
    }
}
