//! Arduino sketches, compiled by Debian's compiler for AVR processors and run in simavr.
//!
//! A sketch in a scripted world is compared with the core's machine, a sketch with the real Arduino library runs with a
//! sensor on its pins, and networks are compared with the core's bits.

use std::collections::BTreeMap;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use fixed::types::I16F16;
use mindgap_controller_export::c_networks::c_networks;
use mindgap_controller_export::onboard::{BUTTON_POLL_MS, Ending};
use mindgap_controller_export::tabulated::Tabulated;
use mindgap_controller_export::{ExportError, Origin, arduino};
use mindgap_core::controller::{Controller, Motors, Tuple, When};
use mindgap_core::fixed_network::FixedNetwork;
use mindgap_core::network::Network;
use mindgap_foundations::random::{Generator, generator};
use mindgap_models::simulator::fixed_point::Quantised;
use mindgap_tests::command::workspace;
use mindgap_tests::controllers::at_its_limits;
use mindgap_tests::plausible_networks::{PlausibleNetworks, plausible_networks};
use rand::RngExt;

use super::scripted::{Answer, answers, controller, expected};

const CONTROLLERS: u64 = 5_000;
/// Number of inputs tried with each network.
const SAMPLES: usize = 200;
/// Bounds on the flash and memory of an ATmega328P that a sketch needs, and on the cycles of a step between reading and
/// motors.
const MAX_FLASH_BYTES: usize = 3_800;
const MAX_RAM_BYTES: usize = 300;
const MAX_CYCLES: u32 = 2_000;
/// Bounds on the flash of a program with all networks, and on the cycles of its slowest evaluation.
const MAX_NETWORKS_FLASH_BYTES: usize = 7_000;
const MAX_NETWORKS_CYCLES: u32 = 400_000;
/// The parts of the Arduino library that a sketch without further libraries needs.
const LIBRARY: [&str; 11] = [
    "wiring.c",
    "wiring_digital.c",
    "wiring_analog.c",
    "wiring_pulse.c",
    "wiring_pulse.S",
    "hooks.c",
    "main.cpp",
    "HardwareSerial.cpp",
    "HardwareSerial0.cpp",
    "Print.cpp",
    "abi.cpp",
];
const ARDUINO: &str = "/usr/share/arduino/hardware/arduino/avr";
/// The flags of Arduino's own `platform.txt` for an Uno.
const FLAGS: &str = "-Os -std=gnu++11 -fno-exceptions -ffunction-sections -fdata-sections -fno-threadsafe-statics -flto \
                     -mmcu=atmega328p -DF_CPU=16000000L -DARDUINO=10819 -DARDUINO_AVR_UNO -DARDUINO_ARCH_AVR";

/// Runs a command that has to succeed. Returns its standard output.
fn run_command(command: &mut Command) -> String {
    let output = command.output().unwrap_or_else(|e| panic!("{command:?}: {e}; tests/run.sh installs what is missing"));
    assert!(output.status.success(), "{command:?}\n{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Compiles a source for an ATmega328P with warnings as errors. `objects` are linked.
fn compile(folder: &Path, source: &str, includes: &[PathBuf], objects: &[PathBuf]) -> PathBuf {
    let (file, image) = (folder.join("image.cpp"), folder.join("image.elf"));
    fs::write(&file, source).unwrap();
    let includes = includes.iter().map(|include| format!("-I{}", include.display()));
    let mut compiler = Command::new("avr-g++");
    compiler.args(FLAGS.split_whitespace()).args(["-Wall", "-Wextra", "-Werror", "-Wl,--gc-sections"]).args(includes);
    run_command(compiler.arg(&file).args(objects).arg("-o").arg(&image));
    image
}

/// Compiles the simulator `tests/avr/run.c`.
fn simulator(folder: &Path) -> PathBuf {
    let program = folder.join("run");
    run_command(
        Command::new("cc").arg("-O2").arg(workspace().join("tests/avr/run.c")).arg("-o").arg(&program).arg("-lsimavr"),
    );
    program
}

/// Returns the output of an image with this input.
fn output_of(folder: &Path, image: &Path, input: Vec<u8>) -> String {
    let mut child =
        Command::new(simulator(folder)).arg(image).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    let mut stdin = child.stdin.take().unwrap();
    let feeder = std::thread::spawn(move || stdin.write_all(&input));
    let output = child.wait_with_output().unwrap();
    feeder.join().unwrap().unwrap();
    assert!(output.status.success(), "{image:?} crashed");
    String::from_utf8(output.stdout).unwrap()
}

/// Returns the flash and the memory of an image, in bytes.
fn sizes(image: &Path) -> [usize; 2] {
    let table = run_command(Command::new("avr-size").arg(image));
    let row = table.lines().nth(1).unwrap().split_whitespace().map(|word| word.parse::<usize>().unwrap_or(0));
    let row: Vec<_> = row.collect();
    [row[0] + row[1], row[1] + row[2]]
}

/// Changes a sketch so that each case brings its own controller.
fn with_any_controller(sketch: &str) -> String {
    let line = |name: &str| {
        let start = sketch.find(&format!("#define {name} ")).unwrap();
        sketch[start..].lines().next().unwrap().to_owned()
    };
    sketch
        .replace("static const controller_tuple controller_tuples", "static controller_tuple controller_tuples")
        .replace(&line("CONTROLLER_STEP_MS"), "#define CONTROLLER_STEP_MS case_step_ms")
        .replace(&line("CONTROLLER_MAX_STEPS"), "#define CONTROLLER_MAX_STEPS case_max_steps")
}

/// Returns the answers as pulses of the sensor, with a random part that rounds to the same centimetre.
fn pulses_us(answers: &[Answer], rng: &mut Generator) -> Vec<u16> {
    let pulse_us = |answer: &Answer| match answer {
        Answer::Mm(mm) => (mm / 10 * 58).saturating_add_signed(rng.random_range(-29..29)).max(1),
        Answer::NoEcho => 65_535,
        Answer::Dead => 65_534,
    };
    answers.iter().map(pulse_us).collect()
}

/// Returns a case in the format of `tests/avr/scripted.h`.
fn case(controller: &Controller, start_ms: u32, press_ms: u32, pulses_us: &[u16]) -> Vec<u8> {
    let mut bytes = [controller.step_ms.to_le_bytes(), controller.max_steps.to_le_bytes()].concat();
    for Tuple { left, right, when, threshold_cm } in controller.tuples {
        bytes.extend([left as u8, right as u8, u8::from(when == When::Larger)]);
        bytes.extend(threshold_cm.to_le_bytes());
    }
    bytes.extend(start_ms.to_le_bytes());
    bytes.extend(press_ms.to_le_bytes());
    bytes.push(pulses_us.len() as u8);
    bytes.extend(pulses_us.iter().flat_map(|us| us.to_le_bytes()));
    bytes
}

fn motor(power: i8) -> String {
    let duty = i32::from(power.unsigned_abs()) * 255 / 100;
    if power == 0 { "brake".to_owned() } else { (duty * i32::from(power.signum())).to_string() }
}

/// Returns the output of the sketch for these cases.
fn run_sketch(cases: Vec<u8>) -> String {
    let folder = tempfile::tempdir().unwrap();
    let sketch = arduino::sketch(&at_its_limits(), &Origin::default()).unwrap();
    let source = format!("#include \"Arduino.h\"\n{}\n#include \"scripted.h\"\n", with_any_controller(&sketch));
    let image = compile(folder.path(), &source, &[workspace().join("tests/avr")], &[]);
    output_of(folder.path(), &image, cases)
}

#[test]
fn button_stops_a_sketch_at_once() {
    let controller = Controller { max_steps: 12, ..at_its_limits() };
    let presses_ms = (1..4_000).step_by(37);
    let cases = presses_ms.clone().flat_map(|press_ms| case(&controller, 5_000, press_ms, &[60 * 58; 12]));
    let output = run_sketch(cases.chain([0, 0]).collect());
    let stops = output.lines().filter_map(|line| line.strip_suffix(" brake brake"));
    let stops_ms: Vec<u32> = stops.map(|t_ms| t_ms.parse().unwrap()).collect();
    assert_eq!(output.lines().filter(|line| line.starts_with(Ending::Stopped.text())).count(), stops_ms.len());
    assert_eq!(stops_ms.len(), presses_ms.clone().count());
    for (stop_ms, press_ms) in stops_ms.into_iter().zip(presses_ms) {
        assert!((press_ms..=press_ms + u32::from(BUTTON_POLL_MS)).contains(&stop_ms), "{press_ms}, {stop_ms}");
    }
}

#[test]
fn sketch_behaves_like_the_core() {
    let (mut input, mut runs) = (Vec::new(), Vec::new());
    for number in 0..CONTROLLERS {
        let mut rng = generator(8, &[number]);
        let controller = controller(arduino::MIN_STEP_MS, &mut rng);
        let answers = answers(&controller, 10, &mut rng);
        // Some clocks wrap during the run.
        let start_ms = u32::MAX - rng.random_range(0..40_000);
        input.extend(case(&controller, start_ms, u32::MAX, &pulses_us(&answers, &mut rng)));
        runs.push(expected(&controller, &answers));
    }
    input.extend([0, 0]);
    let output = run_sketch(input);
    let mut lines = output.lines();
    for (number, (ending, mut commands)) in runs.into_iter().enumerate() {
        if ending == Ending::NoSonar {
            commands.push((0, Motors { left: 0, right: 0 }));
        }
        for (t_ms, Motors { left, right }) in commands {
            let expected = format!("{t_ms} {} {}", motor(left), motor(right));
            assert_eq!(lines.next(), Some(expected.as_str()), "case {number}");
        }
        let (text, cycles) = lines.next().unwrap().rsplit_once(' ').unwrap();
        assert_eq!(text, ending.text(), "case {number}");
        assert!(cycles.parse::<u32>().unwrap() <= MAX_CYCLES, "{cycles} cycles");
    }
    assert_eq!(lines.next(), None);
}

/// Compiles the Arduino library. Returns its objects.
fn library(folder: &Path, includes: &[PathBuf]) -> Vec<PathBuf> {
    let compile = |name: &&str| {
        let object = folder.join(format!("{name}.o"));
        let flags = FLAGS.split_whitespace().filter(|flag| name.ends_with(".cpp") || !flag.contains("threadsafe"));
        let flags = flags.filter(|flag| name.ends_with(".cpp") || !flag.contains("std="));
        let includes = includes.iter().map(|include| format!("-I{}", include.display()));
        let mut compiler = Command::new(if name.ends_with(".cpp") { "avr-g++" } else { "avr-gcc" });
        compiler.args(flags).args(if name.ends_with(".S") { &["-x", "assembler-with-cpp"][..] } else { &[] });
        run_command(compiler.args(includes).arg("-c").arg(library_sources().join(name)).arg("-o").arg(&object));
        object
    };
    LIBRARY.iter().map(compile).collect()
}

fn library_sources() -> PathBuf {
    Path::new(ARDUINO).join("cores/arduino")
}

/// A sketch on an Uno drives when its sensor answers and stops by its controller. Without a sensor nothing moves.
#[test]
fn sketch_on_a_board_reads_its_sensor_and_sets_its_pins() {
    let ahead = |when, threshold_cm| Tuple { left: 50, right: -60, when, threshold_cm };
    let tuples = [When::Smaller, When::Larger].map(|when| ahead(when, 100));
    let tuples = [tuples[0], tuples[1], tuples[0], tuples[1], tuples[0], tuples[1]];
    let controller = Controller { step_ms: arduino::MIN_STEP_MS, max_steps: 20, tuples };
    let folder = tempfile::tempdir().unwrap();
    let includes = [library_sources(), Path::new(ARDUINO).join("variants/standard")];
    let sketch = arduino::sketch(&controller, &Origin::default()).unwrap();
    let library = library(folder.path(), &includes);
    let image = compile(folder.path(), &format!("#include <Arduino.h>\n{sketch}"), &includes, &library);
    let [flash_bytes, ram_bytes] = sizes(&image);
    assert!(flash_bytes <= MAX_FLASH_BYTES && ram_bytes <= MAX_RAM_BYTES, "{flash_bytes} and {ram_bytes} bytes");

    let simulator = simulator(folder.path());
    let run = |pulses_us: &[&str]| {
        let output = run_command(Command::new(&simulator).arg(&image).args(pulses_us));
        let (events, ending) = output.trim_end().rsplit_once('\n').unwrap();
        let event = |line: &str| {
            let [t_us, pin, level] = line.split(' ').collect::<Vec<_>>()[..] else { panic!("{line}") };
            (t_us.parse::<u32>().unwrap(), format!("{pin} {level}"))
        };
        (events.lines().map(event).collect::<Vec<_>>(), ending.trim().to_owned())
    };
    let cm = ["5800", "2900", "8700", "38000", "2900", "8700", "2900", "8700"];
    let (events, ending) = run(&cm);
    assert_eq!(ending, Ending::Finished.text());
    let times_us =
        |wanted: &str| events.iter().filter(|(_, event)| event == wanted).map(|(t_us, _)| *t_us).collect::<Vec<_>>();
    let (echoes_us, stopped_us) = (times_us("echo 0"), times_us("left-brake 1"));
    assert_eq!(echoes_us.len(), cm.len());
    // Nothing moves before the first answer, the last one stops the wheels within 0.2 ms, and steps keep their time.
    let moved_us = events.iter().find(|(_, event)| event.contains("direction")).unwrap().0;
    assert!(moved_us > echoes_us[0] && stopped_us.len() == 1, "{events:?}");
    assert!((1..200).contains(&(stopped_us[0] - echoes_us[7])), "{events:?}");
    let measured_us = times_us("echo 1");
    let step_us = 1_000 * u32::from(controller.step_ms);
    assert!((measured_us[7] - measured_us[1]).abs_diff(6 * step_us) < 3_000, "{events:?}");

    let (events, ending) = run(&["0"]);
    assert_eq!(ending, Ending::NoSonar.text());
    let first_move = events.iter().find(|(_, event)| !event.starts_with("echo")).unwrap();
    assert_eq!(first_move.1, "left-brake 1", "{events:?}");
    let (_, ending) = run(&["5800", "0"]);
    assert_eq!(ending, Ending::SonarDead.text());

    // Open space between the readings, with sensors that end their pulse early, after some steps, or never. All drive on.
    for (open, most_us) in [("25000", 35_000), ("38000", 45_000), ("200000", 260_000), ("-1", 70_000)] {
        let (events, ending) = run(&["5800", open, open, "2900", "8700", open, "2900", "8700", "2900", "8700"]);
        assert_eq!(ending, Ending::Finished.text(), "{open}: {events:?}");
        let (rises, falls): (Vec<_>, Vec<_>) =
            events.iter().filter(|(_, event)| event.starts_with("echo")).partition(|(_, event)| event == "echo 1");
        let longest_us = rises.iter().zip(&falls).map(|(up, down)| down.0 - up.0).max().unwrap();
        assert!((20_000..most_us).contains(&longest_us), "{open}: {longest_us}");
    }
}

#[test]
fn step_too_short_for_the_sensor_is_rejected() {
    let hasty = Controller { step_ms: arduino::MIN_STEP_MS - 1, ..at_its_limits() };
    assert!(matches!(arduino::sketch(&hasty, &Origin::default()), Err(ExportError::OutOfRange { value: 59, .. })));
}

fn quantised<const N: usize>(network: &Network<f32, N>) -> FixedNetwork<N> {
    Quantised::new(network).expect("a network of plausible weights").network
}

/// Draws inputs from slightly more than the trained range.
fn inputs<const N: usize>(ranges: [(f64, f64); N], rng: &mut Generator) -> [I16F16; N] {
    ranges.map(|(low, high)| I16F16::from_num(rng.random_range(1.1 * low - 1.0..1.1 * high)))
}

#[test]
fn networks_in_c_equal_the_core_to_the_bit() {
    let PlausibleNetworks { turn, forward, lateral, echo_probability, echo_value } = plausible_networks(9);
    let motion = [quantised(&turn), quantised(&forward), quantised(&lateral)];
    let sonar = [quantised(&echo_probability), quantised(&echo_value)];
    let commands = ["left", "right", "previous_left", "previous_right"];
    let facing = ["distance_cm", "incidence_deg"];
    let networks = [
        Tabulated::new("turn", "Degrees.", commands, &motion[0]),
        Tabulated::new("forward", "Cm.", commands, &motion[1]),
        Tabulated::new("lateral", "Cm.", commands, &motion[2]),
        Tabulated::new("echo_probability", "0 to 1.", facing, &sonar[0]),
        Tabulated::new("echo_value", "Cm.", facing, &sonar[1]),
    ];
    let (mut input, mut expected) = (Vec::new(), Vec::new());
    let rng = &mut generator(9, &[1]);
    let mut add = |number: usize, inputs: &[I16F16], answer: I16F16| {
        input.push(number as u8);
        input.extend(inputs.iter().flat_map(|x| x.to_bits().to_le_bytes()));
        expected.push((number, answer.to_bits()));
    };
    for _ in 0..SAMPLES {
        for (number, network) in (1..).zip(&motion) {
            let x = inputs([(-100.0, 100.0); 4], rng);
            add(number, &x, network.evaluate(x).value);
        }
        for (number, network) in (4..).zip(&sonar) {
            let x = inputs([(0.0, 255.0), (0.0, 90.0)], rng);
            add(number, &x, network.evaluate(x).value);
        }
    }
    input.push(0);
    let folder = tempfile::tempdir().unwrap();
    let header = c_networks(&networks, "");
    let path = folder.path().join("networks.h");
    fs::write(&path, &header).unwrap();
    let strict = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Wconversion", "-Werror", "-fsyntax-only", "-x", "c"];
    run_command(Command::new("cc").args(strict).arg(&path));
    let source = "#include \"networks.cpp\"\n";
    let includes = [workspace().join("tests/avr"), folder.path().to_owned()];
    let image = compile(folder.path(), source, &includes, &[]);
    let [flash_bytes, _] = sizes(&image);
    assert!(flash_bytes <= MAX_NETWORKS_FLASH_BYTES, "{flash_bytes} bytes");
    let output = output_of(folder.path(), &image, input);
    let mut slowest = BTreeMap::new();
    assert_eq!(output.lines().count(), expected.len());
    for (line, (number, bits)) in output.lines().zip(expected) {
        let (answer, cycles) = line.split_once(' ').unwrap();
        assert_eq!(answer.parse::<i32>().unwrap(), bits, "network {number}");
        let most: &mut u32 = slowest.entry(number).or_default();
        *most = cycles.parse::<u32>().unwrap().max(*most);
    }
    assert!(slowest.values().all(|cycles| *cycles <= MAX_NETWORKS_CYCLES), "{slowest:?} cycles");
    println!("{flash_bytes} bytes of flash; cycles of the slowest evaluation of each network: {slowest:?}");
}
