//! Progress of long commands on a terminal: the share done and the time left.

use std::process::Command;

use mindgap_tests::command::{Outcome, Sandbox, program};
use mindgap_tests::rooms::with_scene;

/// Calls the command on a pseudo-terminal.
fn on_a_terminal(sandbox: &Sandbox, arguments: &str) -> Outcome {
    let mut terminal = Command::new("script");
    terminal.args(["-qec", &format!("{} {arguments}", program().display()), "/dev/null"]);
    terminal.current_dir(sandbox.path()).env("TERM", "xterm").env("COLUMNS", "120");
    sandbox.execute(terminal)
}

#[test]
fn progress_is_shown_on_a_terminal_only() {
    let sandbox = with_scene();
    sandbox.run("evolve sim.json --scene scene.toml --out controller.toml --max-steps 6 --paper");
    sandbox.write("drive.csv", drive());
    for (call, shown) in [
        ("evaluate sim.json logs", " %"),
        ("simulate sim.json controller.toml --scene scene.toml --runs 3000", "/3000"),
        ("import streams drive.csv --out imported", " %"),
        ("crosscheck sim.json logs --runs 40", "/40"),
        ("diagnose sim.json logs", " %"),
    ] {
        let seen = on_a_terminal(&sandbox, call);
        assert_eq!(seen.code, 0, "{call}: {}", seen.out);
        assert!(seen.out.contains(" left]") && seen.out.contains(shown), "{call}: {}", seen.out);
        let quiet = on_a_terminal(&sandbox, &format!("{call} -q --force"));
        assert_eq!((quiet.code, quiet.out.as_str()), (0, ""), "{call}");
        let piped = sandbox.call(&format!("{call} --force"));
        assert!(!piped.out.contains(" left]") && !piped.err.contains(" left]"), "{call}: {}", piped.err);
    }
}

/// Returns the stream of a robot that drives straight and in arcs by turns, with exact poses.
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
