//! Calls all that `mindgap-core` offers. It is never run: it is linked only if no panic can be reached from any of it.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(target_os = "none"))]
fn main() {}

#[cfg(target_os = "none")]
mod on_target {
    use core::hint::black_box;

    use mindgap_core::binary::Binary;
    use mindgap_core::controller::{Controller, Machine};
    use mindgap_core::fixed_network::FixedNetwork;
    use mindgap_core::folded::FoldedNetwork;
    use mindgap_core::maths;
    use mindgap_core::network::Network;
    use mindgap_firmware::job;

    #[cfg(cortex_m)]
    use cortex_m_rt as _;

    mindgap_firmware::panics_must_not_link!();

    #[unsafe(no_mangle)]
    extern "C" fn main() -> ! {
        let mut buffer = black_box([0; 1024]);
        controller(&mut buffer);
        network::<2>(&mut buffer);
        network::<4>(&mut buffer);
        functions(black_box(0.5));
        #[cfg(feature = "reachable-panic")]
        assert!(black_box(buffer[0]) == 0);
        semihosting::process::exit(0)
    }

    fn controller(buffer: &mut [u8]) {
        let Ok(controller) = Controller::from_bytes(black_box(buffer)) else { return };
        let mut machine = Machine::start();
        while black_box(machine.step(&controller, Some(black_box(1.0f32)))) != black_box(machine.status()) {}
        black_box((machine.motors(&controller), machine.steps(), machine.tuple()));
        black_box((controller.check().is_ok(), controller.to_bytes(buffer).is_ok()));
    }

    fn network<const N: usize>(buffer: &mut [u8])
    where
        Network<f32, N>: Binary,
    {
        let Ok(network) = Network::<f32, N>::from_bytes(black_box(buffer)) else { return };
        let inputs = black_box([1.0f32; N]);
        black_box((network.evaluate(inputs), network.check().is_ok(), network.parameters()));
        black_box(network.to_bytes(buffer).is_ok());
        if let Some(folded) = FoldedNetwork::fold(&network) {
            black_box(folded.evaluate(inputs.map(f64::from)));
        }
        if let Ok(quantised) = FixedNetwork::quantise(&network) {
            black_box((quantised.network.evaluate(black_box([job::HALF; N])), quantised.error_bound));
        }
    }

    fn functions(x: f32) {
        black_box((maths::exp2(x), maths::log2(x), maths::sin(x), maths::cos(x)));
    }
}
