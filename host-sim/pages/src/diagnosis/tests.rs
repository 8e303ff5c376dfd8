//! Made-up diagnoses as pages: foreign words stay words, and what is missing is said or left out.

use serde_json::json;

use super::*;
use crate::made_up::{EVIL, logs};
use mindgap_diagnosis::account::{ChannelReduction, GapReduction, Reduction, RunnerUp};
use mindgap_diagnosis::budget::SCATTER;
use mindgap_diagnosis::confirm::unconfirmed::Unconfirmed;
use mindgap_diagnosis::excitation::Detectable;
use mindgap_diagnosis::explain::evidence::Evidence;
use mindgap_diagnosis::explain::profile::{Bin, ResidualProfile};
use mindgap_diagnosis::explain::room_map::{RoomMap, Square};
use mindgap_diagnosis::explain::strata::Stratum;
use mindgap_diagnosis::formula::Statement;
use mindgap_diagnosis::outliers::Outliers;
use mindgap_diagnosis::scope::{NotCompared, Scope};
use mindgap_diagnosis::verdict::NamedEffect;
use mindgap_foundations::channel::Channel;
use mindgap_foundations::schema_number::SchemaNumber;
use mindgap_learning::evaluation::paths::PathError;
use mindgap_logs::inspection::{Finding, Handling, Part as Inspected};
use mindgap_models::simulator::kinematic;

static EVIL_EFFECT: Effect = Effect {
    id: EVIL,
    name: EVIL,
    what: EVIL,
    in_logs: EVIL,
    imitated_by: &[],
    check: EVIL,
    place: None,
    needs_known_robot: false,
    variants: &[],
};

fn no_gap() -> Findings {
    let diagnosis = Diagnosis {
        schema: SchemaNumber,
        verdict: Verdict::NoGap,
        budget: Vec::new(),
        effects: Vec::new(),
        strata: Vec::new(),
        reduction: None,
        final_positions: None,
        experiment: None,
        formula: None,
        profiles: Vec::new(),
        scope: Scope { compared: Channel::ALL.to_vec(), not_compared: Vec::new() },
        data: Vec::new(),
        detectable: Vec::new(),
        unconfirmed: Vec::new(),
        outliers: Vec::new(),
        untestable: Vec::new(),
        notes: Vec::new(),
        sessions: Vec::new(),
    };
    Findings {
        diagnosis,
        applied: Vec::new(),
        robot: mindgap_built_in_robot::default_robot(),
        gap_nats: 0.0,
        noise: [1.0; 3],
        formula: None,
        evidence: Vec::new(),
        room_map: None,
        proposal: None,
    }
}

/// Something foreign in every field that holds words.
fn evil() -> Findings {
    let reduction = Reduction { before: 1.0, after: 0.1, reducible_closed: Some(0.9), ci95: Some([0.8, 1.0]) };
    let bins = || vec![Bin { from: -1.0, to: 1.0, off: 0.2, error: 0.1 }];
    let profile = ResidualProfile { channel: Channel::Turn, depends_on: EVIL, unit: EVIL, bins: bins(), sensor: None };
    let gap_reduction = GapReduction {
        whole: reduction,
        floor: 0.0,
        runner_up: Some(RunnerUp { id: format!("{EVIL}+{EVIL}"), reducible_closed: 0.5 }),
        channels: vec![ChannelReduction { channel: Channel::Turn, reduction, sensor: None }],
        paths: vec![PathError { steps: 5, before_cm: 2.0, after_cm: 1.0, floor_cm: 0.5 }],
    };
    let effect = NamedEffect {
        place: None,
        sensor: None,
        id: EVIL,
        probability: 0.9,
        parameters: [(EVIL.into(), json!(EVIL))].into_iter().collect(),
        ambiguous_with: vec![EVIL],
        share: Some(0.9),
        intervals: [(EVIL.into(), json!([EVIL, EVIL]))].into_iter().collect(),
        at_bound: vec![EVIL],
        witness: vec![EVIL],
        ruler: Some(EVIL.into()),
    };
    let finding = Finding {
        id: EVIL,
        rows_by_run: Vec::new(),
        handling: Handling::Reported,
        withholds: &[Inspected::Motion],
        sentence: EVIL.into(),
    };
    let diagnosis = Diagnosis {
        verdict: Verdict::PartlyKnown,
        budget: vec![Part { id: EVIL.into(), share: 0.9, ci95: [0.8, 1.0], sensor: None }],
        effects: vec![effect],
        reduction: Some(gap_reduction),
        profiles: vec![profile],
        data: vec![finding],
        scope: Scope {
            compared: Vec::new(),
            not_compared: vec![NotCompared { channel: Channel::Turn, reason: EVIL.into(), sensor: None }],
        },
        formula: Some(Statement { channel: Channel::Turn, text: EVIL.into(), share: 0.1, ci95: [0.0, 0.2] }),
        strata: vec![Stratum {
            channel: Channel::Turn,
            context: EVIL,
            gap: 1.0,
            ci95: [0.5, 1.5],
            share: 0.5,
            sensor: None,
        }],
        detectable: vec![Detectable { id: EVIL, parameter: EVIL, smallest: Some(0.1), sensor: None }],
        unconfirmed: vec![Unconfirmed { id: EVIL, found_nats: 9.0, confirmed_nats: -1.0, sensor: None }],
        outliers: vec![Outliers {
            channel: Channel::Turn,
            run: None,
            place_cm: None,
            share: 0.05,
            nats: 9.0,
            sensor: None,
        }],
        untestable: vec![EVIL],
        notes: vec![EVIL.into()],
        ..no_gap().diagnosis
    };
    let evidence = Evidence {
        sensor: None,
        effect: EVIL.into(),
        channel: Channel::Turn,
        depends_on: EVIL,
        unit: EVIL,
        without: bins(),
        with: bins(),
    };
    let square = Square { x_cm: 0.0, y_cm: 0.0, rows: 1, nats: 1.0 };
    let room_map = Some(RoomMap { side_cm: 10.0, squares: vec![square] });
    Findings { diagnosis, evidence: vec![evidence], room_map, ..no_gap() }
}

fn page_of(findings: &Findings, logs: &Logs, name: &str) -> String {
    let source =
        || Source { simulator: name.into(), logs: name.into(), written: Some([name.into(), name.into()]), seed: 1 };
    let baseline = &kinematic::baseline(logs);
    page(&Subject {
        findings,
        logs,
        baseline,
        catalogue: &[&EVIL_EFFECT],
        source: source(),
        comparison: Comparison::default(),
    })
    .expect("a page")
}

#[test]
fn markup_in_any_field_is_escaped() {
    let page = page_of(&evil(), &logs(2, 5, EVIL), EVIL);
    assert!(!page.contains("<x-mark"), "markup came through");
    let escaped = page.matches("&lt;x-mark").count() + page.matches("\\u003cx-mark").count();
    assert!(escaped > 30, "{escaped} fields are shown");
    // Scripts end where this program ends them: the data, and what moves the replay.
    assert_eq!(page.matches("</script").count(), 2);
}

#[test]
fn without_a_gap_there_are_no_empty_parts() {
    let page = page_of(&no_gap(), &logs(2, 5, "run-"), "logs");
    assert!(page.contains("No gap: "));
    for part in ["budget", "causes", "where", "ends"] {
        assert!(!page.contains(&format!("<section id=\"{part}\"")), "{part}");
    }
}

#[test]
fn without_poses_there_is_no_map_and_the_page_says_so() {
    let mut logs = logs(2, 5, "run-");
    logs.runs.iter_mut().for_each(|run| run.rows.edit_each(|row| row.pose = None));
    let page = page_of(&no_gap(), &logs, "logs");
    assert!(page.contains("never saw the robot") && !page.contains("id=\"stage\""));
}

#[test]
fn ten_thousand_runs_are_sampled_and_the_page_says_so() {
    let page = page_of(&evil(), &logs(10_000, 60, "run-"), "logs");
    assert!(page.len() < 2_000_000, "{} bytes", page.len());
    assert!(page.contains("of 10000 runs, evenly spread"));
}

#[test]
fn the_largest_part_of_the_gap_is_checked_first_even_if_it_is_scatter() {
    let mut findings = evil();
    let part = |id: &str, share: f64| Part { id: id.into(), share, ci95: [share, share], sensor: None };
    findings.diagnosis.budget = vec![part(EVIL, 0.2), part(SCATTER, 0.7), part(UNEXPLAINED, 0.1)];
    let page = page_of(&findings, &logs(2, 5, "run-"), "logs");
    let (_, next) = page.split_once("<section id=\"next\"").expect("what to do next");
    let place = |words: &str| next.find(words).unwrap_or_else(|| panic!("{words} is missing"));
    let order = ["wider scatter</strong>, 70\u{a0}%", "</strong>, 20\u{a0}%", "10\u{a0}% of the gap is not"];
    assert!(order.map(place).is_sorted());
    let (header, _) = page.split_once("<nav").expect("a header");
    assert!(header.contains("2.0 cm from the real one, 1.0 cm with the effects"), "how far");
}

#[test]
fn the_headline_has_the_size_of_an_effect_and_its_range_sensor() {
    let mut diagnosis = evil().diagnosis;
    let effect = &mut diagnosis.effects[0];
    effect.id = "sonar_scale";
    effect.parameters = [("factor".to_owned(), 1.05.into())].into_iter().collect();
    effect.sensor = Some("left".into());
    let headline = headline(&diagnosis, &[], &logs(1, 2, "run-").robot);
    assert!(headline.contains(": 100 cm are read as 105 cm of left ("), "{headline}");
}
