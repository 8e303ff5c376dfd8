//! What commands that take long show on a terminal: how much is done, and how long the rest will take.

use std::process::Command;

use mindgap_tests::command::{Done, Workshop, program};
use mindgap_tests::rooms::with_scene;

/// Calls the command on a terminal of its own.
fn on_a_terminal(workshop: &Workshop, arguments: &str) -> Done {
    let mut terminal = Command::new("script");
    terminal.args(["-qec", &format!("{} {arguments}", program().display()), "/dev/null"]);
    terminal.current_dir(workshop.path()).env("TERM", "xterm").env("COLUMNS", "120");
    workshop.run(terminal)
}

#[test]
fn a_terminal_sees_how_much_is_done_and_a_pipe_does_not() {
    let workshop = with_scene();
    workshop.done("evolve sim.json --scene scene.toml --out controller.toml --max-steps 6");
    workshop.write("drive.csv", drive());
    for (call, shown) in [
        ("evaluate sim.json logs", " %"),
        ("simulate sim.json controller.toml --scene scene.toml --runs 3000", "/3000"),
        ("import streams drive.csv --out imported", " %"),
        ("crosscheck sim.json logs --runs 40", "/40"),
        ("diagnose kinematic logs", " %"),
    ] {
        let seen = on_a_terminal(&workshop, call);
        assert_eq!(seen.code, 0, "{call}: {}", seen.out);
        assert!(seen.out.contains(" left]") && seen.out.contains(shown), "{call}: {}", seen.out);
        let quiet = on_a_terminal(&workshop, &format!("{call} -q --force"));
        assert_eq!((quiet.code, quiet.out.as_str()), (0, ""), "{call}");
        let piped = workshop.call(&format!("{call} --force"));
        assert!(!piped.out.contains(" left]") && !piped.err.contains(" left]"), "{call}: {}", piped.err);
    }
}

/// A robot that goes straight on, then turns, as a stream: it knows its place exactly.
fn drive() -> String {
    let mut text = String::from("t_s,v_m_s,w_rad_s,x_m,y_m,yaw_rad\n");
    let (mut x, mut y, mut yaw) = (0.0_f64, 0.0_f64, 0.0_f64);
    for step in 0..400 {
        let (v, w) = if step / 40 % 2 == 0 { (0.2, 0.0) } else { (0.1, 0.5) };
        text += &format!("{:.2},{v},{w},{x:.4},{y:.4},{yaw:.4}\n", 0.05 * f64::from(step));
        x += v * 0.05 * libm::cos(yaw);
        y += v * 0.05 * libm::sin(yaw);
        yaw += w * 0.05;
    }
    text
}
