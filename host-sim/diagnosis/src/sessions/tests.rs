use super::*;

fn session(folder: &str, factor: f64) -> SessionFindings {
    let effect = SessionEffect {
        id: "track_width",
        parameters: [("factor".to_string(), factor.into())].into_iter().collect(),
        intervals: [("factor".to_string(), vec![factor - 0.01, factor + 0.01].into())].into_iter().collect(),
        goes_with: vec!["floor".into()],
    };
    let floor = if factor > 1.0 { "carpet" } else { "tiles" };
    let conditions = [("floor".to_string(), floor.into())].into_iter().collect();
    SessionFindings { folder: folder.into(), conditions, effects: vec![effect] }
}

#[test]
fn a_difference_is_described_with_its_condition() {
    let lines = lines(&[session("a", 1.0), session("b", 1.1)]);
    let [first, condition, a, b] = lines.as_slice() else { panic!("{lines:?}") };
    assert_eq!([first.as_str(), condition], ["Differences between sessions:", "  track_width goes with floor:"]);
    assert!(a.starts_with("    a (floor tiles): factor 1") && b.starts_with("    b (floor carpet): factor 1.1"), "{b}");
}

#[test]
fn sessions_without_a_difference_are_said_to_have_none() {
    let alike = |folder| SessionFindings { effects: Vec::new(), ..session(folder, 1.0) };
    assert_eq!(lines(&[alike("a"), alike("b")]), ["No difference between the 2 sessions was found."]);
    assert!(lines(&[]).is_empty());
}
