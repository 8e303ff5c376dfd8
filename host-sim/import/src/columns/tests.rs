use std::path::Path;

use super::*;

/// Returns the times, ms, in a table, with the chosen clock and the guesses.
fn times(text: &str) -> Result<(Vec<f64>, String, Vec<String>)> {
    let table = Table::find(Path::new("t.csv"), text.to_owned())?;
    let columns = Columns::find(&table, None, &Units::default(), &[])?;
    let mut times = ReadTimes::new(&table, &columns.times);
    table.for_each(|line| times.push(line))?;
    let times = times.choose()?;
    Ok((times.ms, times.name, times.guessed))
}

#[test]
fn one_of_several_clocks_is_chosen() {
    for (header, rows, ms, name) in [
        ("t_s", ["0.5", "1"], [500.0, 1000.0], "t_s"),
        ("stamp.sec,stamp.nanosec", ["7,500000000", "8,0"], [7500.0, 8000.0], "stamp.sec and stamp.nanosec"),
        ("sec,nsec", ["7,500000000", "8,0"], [7500.0, 8000.0], "sec and nsec"),
        ("time_s,time_ms", ["7.5,7500", "8,8000"], [7500.0, 8000.0], "time_s"),
        ("date,time", ["1970-01-01,23:59:59.5", "1970-01-02,00:00:00"], [86_399_500.0, 86_400_000.0], "date and time"),
        ("time,millis", ["12:00:01,5500", "12:00:01,6000"], [5500.0, 6000.0], "millis"),
        (
            "%time,header.stamp",
            ["1718000000004000000,1718000000000000000", "1718000001004000000,1718000001000000000"],
            [1.718e12, 1.718_000_001e12],
            "header.stamp",
        ),
        (
            "%time,header.stamp",
            ["1718000000004000000,0", "1718000001004000000,0"],
            [1.718_000_000_004e12, 1.718_000_001_004e12],
            "time",
        ),
        (
            "Time,header.stamp.secs,header.stamp.nsecs",
            ["1718000000.5,100,0", "1718000001.5,101,0"],
            [1.718_000_000_5e12, 1.718_000_001_5e12],
            "Time",
        ),
        ("__time", ["0.000001", "2.5"], [0.001, 2500.0], "__time"),
        ("t_s", ["0.1234567890", "1.1234567890"], [123.456_789, 1_123.456_789], "t_s"),
    ] {
        let text = format!("{header},v_m_s,w_rad_s\n{},1,1\n{},1,1\n", rows[0], rows[1]);
        let (found, chosen, _) = times(&text).expect(header);
        assert!(found.iter().zip(ms).all(|(a, b)| (a - b).abs() < 1e-3) && found.len() == 2, "{header}: {found:?}");
        assert_eq!(chosen, name, "{header}");
    }
    let error = times("sec,nsec,v_m_s,w_rad_s\nx,0,1,1\n1,y,1,1\n").expect_err("no clock").to_string();
    assert!(error.contains(":2: sec = \"x\" is not a time"), "{error}");
}

#[test]
fn units_of_messages_are_si_and_unused_columns_are_noted() {
    let text = "Time,pose.position.x,pose.position.y,pose.orientation.z,pose.orientation.w,battery\n0,1,1,0,1,7\n1,1,1,0,1,7\n";
    let table = Table::find(Path::new("t.csv"), text.to_owned()).expect("a table");
    let columns = Columns::find(&table, None, &Units::default(), &[]).expect("columns");
    assert!(
        columns.guessed[0].contains("metres") && columns.guessed[0].contains("pose.position.x"),
        "{:?}",
        columns.guessed
    );
    assert_eq!(columns.bodies[0].position[0].as_ref().and_then(|x| x.unit).map(|unit| unit.factor), Some(100.0));
    assert_eq!(columns.left_out.iter().map(|unused| unused.name.as_str()).collect::<Vec<_>>(), ["battery"]);
}

#[test]
fn time_of_flight_is_a_distance() {
    let text = "t_s,echo_us\n0,583\n1,0\n";
    let table = Table::find(Path::new("t.csv"), text.to_owned()).expect("a table");
    let columns = Columns::find(&table, None, &Units::default(), &[]).expect("columns");
    let (_, range) = columns.ranges.first().expect("a range");
    let mut readings = Vec::new();
    table.for_each(|line| range.reading_cm(line).map(|cm| readings.push(cm))).expect("rows");
    assert!((readings[0].expect("an echo") - 10.0).abs() < 0.01 && readings[1].is_none(), "{readings:?}");
}
