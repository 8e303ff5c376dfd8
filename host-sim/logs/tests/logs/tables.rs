use mindgap_built_in_robot::{default_robot, record, training_room};
use mindgap_logs::Logs;
use mindgap_logs::tables::Table;

fn recorded() -> Logs {
    record(&default_robot(), &training_room(), 2, 12, &[], 7).expect("logs")
}

fn refused(change: impl FnOnce(&mut Table)) -> String {
    let logs = recorded();
    let mut table = Table::of(&logs.runs[0]);
    change(&mut table);
    Logs::of_tables(logs.robot, logs.scene, &[table], |_| ()).expect_err("refused").to_string()
}

#[test]
fn logs_come_back_from_their_tables() {
    let logs = recorded();
    let tables: Vec<Table> = logs.runs.iter().map(Table::of).collect();
    let back = Logs::of_tables(logs.robot, logs.scene.clone(), &tables, |odd| panic!("{odd}")).expect("logs");
    // Headings go through degrees and back, and lose a bit there.
    assert_eq!(back.runs.len(), 2);
    for (back, run) in back.runs.iter().zip(&logs.runs) {
        for (back, row) in back.rows.iter().zip(run.rows.iter()) {
            assert_eq!((back.t_ms, back.left, back.echo_cm), (row.t_ms, row.left, row.echo_cm));
            assert_eq!(back.pose.is_some(), row.pose.is_some());
        }
    }
}

#[test]
fn a_wrong_cell_is_told_with_its_run_and_line() {
    assert_eq!(refused(|t| t.columns[1].1[2] = 140.0), "run-000:4: left = 140 lies outside -100..100");
    assert!(refused(|t| t.columns[0].1[5] = f64::NAN).starts_with("run-000:7: t_ms"));
    assert_eq!(refused(|t| drop(t.columns.remove(0))), "run-000:1: column t_ms is missing");
    assert_eq!(
        refused(|t| {
            t.columns[2].1.pop();
        }),
        "run-000: column right has 12 rows, and the first has 13"
    );
}
