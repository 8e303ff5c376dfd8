//! The emulated brick runs programs of the real compiler and behaves as the real firmware was seen to.

use mindgap_controller_export::brick::{
    self, Drive, EventKind, Fault, LoadError, Press, Program, Report, RunConfig, ScriptedWorld, Sonar, Termination,
};
use mindgap_tests::nbc::{compile, compile_for};
use proptest::prelude::*;
use proptest::test_runner::TestRunner;

fn run(source: &str, world: &mut ScriptedWorld) -> Report {
    brick::run(&Program::load(&compile(source)).unwrap(), world, &RunConfig::default())
}

/// Returns the texts that a task with this body shows on the display.
fn shown(body: &str) -> Vec<String> {
    let report = run(&format!("task main() {{ {body} }}"), &mut ScriptedWorld::default());
    assert_eq!(report.end, Termination::Finished);
    texts(&report)
}

fn texts(report: &Report) -> Vec<String> {
    let text = |kind: &EventKind| match kind {
        EventKind::Text { text, .. } => Some(text.clone()),
        _ => None,
    };
    report.events.iter().filter_map(|event| text(&event.kind)).collect()
}

fn show(expressions: &[&str]) -> String {
    expressions.iter().map(|e| format!("NumOut(0, LCD_LINE1, {e});")).collect()
}

#[test]
fn integers_wrap_truncate_and_divide_by_zero() {
    let variables = "long big = 46341; int most = 32767; long seven = 7; long minus = -7; long zero = 0; byte b = 44;
        char c = 200; int i = 300; unsigned int u = 65535; long wide; most++; b = i; wide = u;";
    let expressions = ["big * big", "most", "minus / 2", "minus % 4", "seven / zero", "seven % zero", "b", "c", "wide"];
    let expected = ["-2147479015", "-32768", "-3", "-3", "0", "7", "44", "-56", "65535"];
    assert_eq!(shown(&format!("{variables} {}", show(&expressions))), expected);
}

#[test]
fn shifts_by_constants_round_toward_zero() {
    assert_eq!(shown(&format!("long x = -300; {}", show(&["x >> 3", "x << 2"]))), ["-37", "-1200"]);
}

#[test]
fn floats_print_two_decimals() {
    let variables = "float x = 3.14159; float half = 0.5; long n;  n = x * 100;";
    let expected = ["3.14", "0.5", "9", "314"];
    assert_eq!(shown(&format!("{variables} {}", show(&["x", "half", "sqrt(81.0)", "n"]))), expected);
}

#[test]
fn arrays_strings_and_structs() {
    let source = r#"
        struct Pair { int left; string name; };
        int squares[];
        string names[];
        int Sum(int values[]) { int sum = 0; for (int i = 0; i < ArrayLen(values); i++) sum += values[i]; return sum; }
        task main() {
          ArrayInit(squares, 0, 10);
          for (int i = 0; i < 10; i++) squares[i] = i * i;
          NumOut(0, LCD_LINE1, Sum(squares));
          int part[];
          ArraySubset(part, squares, 2, 3);
          NumOut(0, LCD_LINE1, Sum(part));
          int all[];
          ArrayBuild(all, part, 1, squares);
          NumOut(0, LCD_LINE1, ArrayLen(all));
          string whole = StrCat("one", "two");
          string middle = SubStr(whole, 2, 3);
          ArrayBuild(names, whole, middle);
          TextOut(0, LCD_LINE1, names[1]);
          Pair p, q;
          p.left = -5; p.name = "pair";
          q = p;
          TextOut(0, LCD_LINE1, q.name);
          NumOut(0, LCD_LINE1, q.left);
          NumOut(0, LCD_LINE1, StrToNum("-17 cm"));
          int sums[]; int more[] = {1, 2, 3};
          asm { add sums, more, more }
          NumOut(0, LCD_LINE1, sums[2]);
          NumOut(0, LCD_LINE1, whole == "onetwo");
          NumOut(0, LCD_LINE1, StrLen(FlattenVar(squares)));
        }"#;
    let report = run(source, &mut ScriptedWorld::default());
    assert_eq!(report.end, Termination::Finished);
    assert_eq!(texts(&report), ["285", "29", "14", "etw", "pair", "-5", "-17", "6", "1", "20"]);
}

#[test]
fn tasks_alternate_and_wait_for_a_mutex() {
    let source = r#"
        mutex lock;
        int shared = 0;
        task a() { for (int i = 0; i < 50; i++) { Acquire(lock); int s = shared; Wait(1); shared = s + 1; Release(lock); } }
        task b() { for (int i = 0; i < 50; i++) { Acquire(lock); int s = shared; Wait(1); shared = s + 1; Release(lock); } }
        task after() { NumOut(0, LCD_LINE1, shared); }
        task main() { Precedes(a, b); }"#;
    let report = run(
        &source.replace(
            "task main() { Precedes(a, b); }",
            "task main() { StartTask(a); StartTask(b); Wait(500); NumOut(0, LCD_LINE1, shared); }",
        ),
        &mut ScriptedWorld::default(),
    );
    assert_eq!((report.end, texts(&report)), (Termination::Finished, vec!["100".to_owned()]));
}

#[test]
fn motors_follow_their_flags_and_run_on_when_the_firmware_aborts() {
    let source = "task main() { OnFwd(OUT_B, 50); OnRev(OUT_C, 20); Off(OUT_B); Coast(OUT_C); OnFwd(OUT_A, -30);
        int a[] = {1}; int i = 5; NumOut(0, LCD_LINE1, a[i]); }";
    let report = run(source, &mut ScriptedWorld::default());
    let drives: Vec<_> = report.events.iter().map(|event| event.kind.clone()).collect();
    let motor = |port, drive| EventKind::Motor { port, drive };
    assert_eq!(
        drives,
        [
            motor(1, Drive::Power(50)),
            motor(2, Drive::Power(-20)),
            motor(1, Drive::Brake),
            motor(2, Drive::Coast),
            motor(0, Drive::Power(-30)),
        ]
    );
    assert_eq!(report.end, Termination::Failed(Fault::Argument));
    assert_eq!(report.motors, [Drive::Power(-30), Drive::Brake, Drive::Coast]);
}

#[test]
fn dark_button_ends_any_program_and_releases_the_motors() {
    let mut world = ScriptedWorld { exit_pressed_ms: Some(777), ..ScriptedWorld::default() };
    let report = run("task main() { OnFwd(OUT_BC, 50); Wait(5000); }", &mut world);
    assert_eq!((report.end, report.ended_ms, report.motors), (Termination::Aborted, 777, [Drive::Coast; 3]));
}

#[test]
fn buttons_battery_tones_and_ticks() {
    let source = "task main() { until (ButtonPressed(BTNCENTER, false)); NumOut(0, LCD_LINE1, CurrentTick() - FirstTick());
        Wait(100); NumOut(0, LCD_LINE1, ButtonCount(BTNCENTER, true)); NumOut(0, LCD_LINE1, ButtonCount(BTNCENTER, true));
        NumOut(0, LCD_LINE1, BatteryLevel()); PlayTone(440, 250); }";
    let mut world =
        ScriptedWorld { presses: vec![Press::orange(300, 350)], battery_mv: 7321, ..ScriptedWorld::default() };
    let report = run(source, &mut world);
    assert_eq!(texts(&report), ["300", "1", "0", "7321"]);
    assert_eq!(report.events.last().unwrap().kind, EventKind::Tone { hz: 440, ms: 250 });
}

#[test]
fn file_size_is_reserved_and_truncated_to_the_bytes_written() {
    let source = r#"
        task main() {
          byte h; int n; unsigned int size = 10;
          NumOut(0, LCD_LINE1, CreateFile("sixteen-letters-.csv", 10, h));
          NumOut(0, LCD_LINE1, CreateFile("huge.csv", 200000, h));
          NumOut(0, LCD_LINE1, CreateFile("LOG.csv", 10, h));
          NumOut(0, LCD_LINE1, WriteLnString(h, "12345", n));
          NumOut(0, LCD_LINE1, WriteLnString(h, "12345", n));
          CloseFile(h);
          NumOut(0, LCD_LINE1, CreateFile("log.CSV", 10, h));
          NumOut(0, LCD_LINE1, OpenFileRead("log.csv", size, h));
          NumOut(0, LCD_LINE1, size);
          string line;
          ReadLnString(h, line);
          TextOut(0, LCD_LINE1, line);
          CloseFile(h);
          NumOut(0, LCD_LINE1, DeleteFile("none.csv"));
          CreateFile("open.csv", 5000, h);
          WriteLnString(h, "a", n);
        }"#;
    let report = run(source, &mut ScriptedWorld::default());
    let [bad_name, no_space, full, exists, missing] =
        [0x9200, 0x8200, 0x8400, 0x8F00, 0x8700].map(|e: u32| e.to_string());
    let expected = [&*bad_name, &no_space, "0", "0", &full, &exists, "0", "10", "12345", &missing];
    assert_eq!(texts(&report), expected);
    let files: Vec<_> = report.files.into_iter().collect();
    let content = |text: &str| text.as_bytes().to_vec();
    assert_eq!(files, [("LOG.csv".into(), content("12345\r\n123")), ("open.csv".into(), content("a\r\n"))]);
}

/// The library's own call takes 30 ms and returns the last good value of a dead sensor.
#[test]
fn library_call_for_the_sonar_behaves_as_in_the_firmware() {
    let source = "task main() { SetSensorLowspeed(IN_4); for (int i = 0; i < 5; i++) { long t = CurrentTick();
        NumOut(0, LCD_LINE1, SensorUS(IN_4)); NumOut(0, LCD_LINE2, CurrentTick() - t); } }";
    let sonar = [Sonar::Echo(77), Sonar::Echo(255), Sonar::Silent, Sonar::Hangs, Sonar::Silent];
    let report = run(source, &mut ScriptedWorld::sonar(sonar));
    let shown: Vec<i32> = texts(&report).iter().map(|text| text.parse().unwrap()).collect();
    let readings: Vec<i32> = shown.iter().step_by(2).copied().collect();
    assert_eq!(readings, [77, 255, 255, 255, 255]);
    assert!((29..=33).contains(&shown[1]) && (29..=33).contains(&shown[3]), "{shown:?}");
}

/// nbc's code for old firmware executes the last wait a second time.
#[test]
fn compiler_defect_for_old_firmware_is_reproduced() {
    let source = "task main() { SetSensorLowspeed(IN_4); NumOut(0, LCD_LINE1, SensorUS(IN_4)); Wait(1000);
        long t = CurrentTick(); int r = SensorUS(IN_4); NumOut(0, LCD_LINE2, CurrentTick() - t); }";
    let took_ms = |firmware| {
        let program = Program::load(&compile_for(source, firmware)).unwrap();
        let report = brick::run(&program, &mut ScriptedWorld::sonar([Sonar::Echo(9); 2]), &RunConfig::default());
        texts(&report)[1].parse::<i32>().unwrap()
    };
    assert!((29..=33).contains(&took_ms("-v=128")), "{}", took_ms("-v=128"));
    assert!((1020..=1050).contains(&took_ms("-v=105")), "{}", took_ms("-v=105"));
}

#[test]
fn array_larger_than_the_memory_ends_the_program() {
    let body = |count| {
        format!(
            "task main() {{ long a[]; ArrayInit(a, 7, {count}); int last = {count} - 1; NumOut(0, LCD_LINE1, a[last]); }}"
        )
    };
    assert_eq!(texts(&run(&body(7000), &mut ScriptedWorld::default())), ["7"]);
    assert_eq!(run(&body(8000), &mut ScriptedWorld::default()).end, Termination::Failed(Fault::Memory));
}

#[test]
fn fragmented_memory_is_compacted() {
    let source = "task main() { string a = \"\"; string b = \"\";
        for (int i = 0; i < 400; i++) { a = StrCat(a, \"0123456789\"); b = StrCat(a, \"!\"); }
        NumOut(0, LCD_LINE1, StrLen(b)); }";
    assert_eq!(texts(&run(source, &mut ScriptedWorld::default())), ["4001"]);
}

#[test]
fn endless_program_runs_out_of_time() {
    let report = run("task main() { while (true) Wait(7); }", &mut ScriptedWorld::default());
    assert_eq!((report.end, report.ended_ms), (Termination::OutOfTime, RunConfig::default().run_ms));
    let busy = RunConfig { run_ms: 1000, ..RunConfig::default() };
    let program = Program::load(&compile("task main() { int i; while (true) i++; }")).unwrap();
    let report = brick::run(&program, &mut ScriptedWorld::default(), &busy);
    // A hundred per millisecond, less the longer array operations at the start of the program.
    assert_eq!(report.end, Termination::OutOfTime);
    assert!((99_900..=100_000).contains(&report.instructions), "{}", report.instructions);
}

#[test]
fn jump_out_of_the_code_ends_the_program() {
    const JUMP: [u8; 2] = 0x4025u16.to_le_bytes();
    let intact = compile("task main() { int i; while (true) i++; }");
    let place = intact.windows(2).rposition(|word| word == JUMP).expect("the loop jumps back") + 2;
    for offset in [i16::MIN, -30_000, 1_000, i16::MAX] {
        let mut rxe = intact.clone();
        rxe[place..place + 2].copy_from_slice(&offset.to_le_bytes());
        let report = brick::run(&Program::load(&rxe).unwrap(), &mut ScriptedWorld::default(), &RunConfig::default());
        assert_eq!(report.end, Termination::Failed(Fault::Instruction), "{offset}");
    }
}

/// The compiler refuses recursion, so the targets of calls are changed: among others, every subroutine then calls itself.
#[test]
fn subroutine_that_calls_itself_does_not_hang_the_emulator() {
    let subs = "int n; sub Inner() { n++; } sub Outer() { Inner(); n++; Inner(); }";
    let intact = compile(&format!("{subs} task main() {{ Outer(); Outer(); NumOut(0, LCD_LINE1, n); }}"));
    let is_call = |place: &usize| intact[*place + 1] == 0x4b;
    let calls: Vec<usize> = (0..intact.len() - 1).step_by(2).filter(is_call).collect();
    assert!(calls.len() >= 4, "two calls of each");
    let mut stuck = 0;
    for (place, change) in calls.iter().flat_map(|place| (-3..=3).map(move |change: i8| (*place, change))) {
        let mut rxe = intact.clone();
        rxe[place] = rxe[place].wrapping_add_signed(change);
        let Ok(program) = Program::load(&rxe) else { continue };
        let report =
            brick::run(&program, &mut ScriptedWorld::default(), &RunConfig { run_ms: 500, ..RunConfig::default() });
        assert!(report.ended_ms <= 500, "{report:?}");
        stuck += usize::from(texts(&report) != ["6"]);
    }
    assert!(stuck > 0, "no change made a subroutine call itself");
}

/// Compiles a program that uses most features of the firmware.
fn large_program() -> Vec<u8> {
    compile(
        r#"
        struct Pair { int left; string name; };
        string names[];
        sub Say(string text) { TextOut(0, LCD_LINE1, text); }
        task other() { for (int i = 0; i < 3; i++) Wait(10); }
        task main() {
          StartTask(other);
          SetSensorLowspeed(IN_4);
          byte h; int n; Pair p; Pair many[]; int a[] = {1, 2, 3};
          CreateFile("a.csv", 100, h);
          for (int i = 0; i < 5; i++) {
            a[i % 3] += SensorUS(IN_4);
            p.name = StrCat(NumToStr(a[0]), "!");
            string number = NumToStr(i);
            ArrayBuild(names, p.name, number);
            ArrayInit(many, p, i);
            string name = names[0];
            WriteLnString(h, name, n);
            OnFwd(OUT_BC, a[1] / 3);
            Say(FlattenVar(a));
          }
          Off(OUT_BC);
        }"#,
    )
}

#[test]
fn complete_program_is_loaded_and_a_truncated_one_is_rejected() {
    let rxe = large_program();
    assert!(Program::load(&rxe).is_ok());
    for length in 0..rxe.len() {
        let refused: Result<_, LoadError> = Program::load(&rxe[..length]);
        assert!(refused.is_err(), "accepted {length} of {} bytes", rxe.len());
    }
}

/// A damaged file can do harm only inside the emulator.
#[test]
fn damaged_files_neither_panic_nor_hang() {
    let intact = large_program();
    let setup = RunConfig { run_ms: 300, ..RunConfig::default() };
    let sonar = prop_oneof![any::<u8>().prop_map(Sonar::Echo), Just(Sonar::Silent), Just(Sonar::Hangs)];
    let changes = prop::collection::vec((0..intact.len(), any::<u8>()), 1..12);
    let config = ProptestConfig { cases: 3000, failure_persistence: None, ..ProptestConfig::default() };
    let outcome = TestRunner::new(config).run(&(changes, prop::collection::vec(sonar, 5)), |(changes, sonar)| {
        let mut rxe = intact.clone();
        for (at, value) in changes {
            rxe[at] = value;
        }
        if let Ok(program) = Program::load(&rxe) {
            let report = brick::run(&program, &mut ScriptedWorld::sonar(sonar), &setup);
            prop_assert!(report.ended_ms <= setup.run_ms);
            prop_assert!(report.instructions <= u64::from(setup.run_ms) * u64::from(setup.instructions_per_ms));
        }
        Ok(())
    });
    outcome.unwrap();
}

/// Any part of the header and of the tables after it is overwritten with zeros or ones.
#[test]
fn overwritten_tables_neither_panic_nor_hang() {
    let intact = large_program();
    let setup = RunConfig { run_ms: 100, ..RunConfig::default() };
    let mut loaded = 0;
    for hole in [2, 4, 10, 64] {
        for at in (0..intact.len() - hole).step_by(2) {
            for value in [0, 0xFF] {
                let mut rxe = intact.clone();
                rxe[at..at + hole].fill(value);
                let Ok(program) = Program::load(&rxe) else { continue };
                loaded += 1;
                let report = brick::run(&program, &mut ScriptedWorld::sonar([Sonar::Echo(9); 5]), &setup);
                assert!(report.ended_ms <= setup.run_ms, "{hole} bytes at {at}");
            }
        }
    }
    assert!(loaded > 1_000, "{loaded} programs");
}

#[test]
fn calls_of_every_module_are_supported() {
    let report = run(include_str!("every_module.nxc"), &mut ScriptedWorld::sonar([Sonar::Echo(50); 9]));
    assert_eq!(report.end, Termination::Finished, "{:?}", report.failed_at);
    assert_eq!(texts(&report).last().map(String::as_str), Some("done"));
}
