//! The blind test of the diagnosis from end to end.

use mindgap_tests::command::Workshop;
use mindgap_tests::rooms::challenge;
use serde_json::{Value, json};

#[test]
fn a_challenge_is_made_answered_and_scored() {
    let workshop = challenge(3);
    let refusal = workshop.refused("challenge score blind");
    assert!(refusal.contains("answers"), "nothing is answered yet: {refusal}");
    workshop.done("challenge answer blind");
    workshop.done("challenge score blind --json score.json --csv cases.csv");
    // What was sealed is what is scored, and each verdict is that of the case's answer.
    let (sealed, score) = (workshop.json("blind/sealed.json"), workshop.json("score.json"));
    let sealed = sealed.as_array().expect("a list");
    let truths = sealed.iter().map(|case| case["effects"].as_array().expect("a list"));
    let nothing: Vec<bool> = truths.map(Vec::is_empty).collect();
    let cases = nothing.len();
    assert!(cases == 3 && nothing.contains(&true) && nothing.contains(&false), "{sealed:?}");
    let alarms: Vec<bool> = sealed
        .iter()
        .map(|case| {
            let answer = format!("blind/answers/{}.json", case["case"].as_str().expect("a name"));
            workshop.json(&answer)["verdict"] != "no_gap"
        })
        .collect();
    let alarms_where = |is: bool| nothing.iter().zip(&alarms).filter(|(n, alarm)| **n == is && **alarm).count();
    let of = |is: bool| nothing.iter().filter(|n| **n == is).count();
    assert_eq!(score["false_alarms"], json!({"count": alarms_where(true), "of": of(true)}), "{score}");
    assert_eq!(score["detected"], json!({"count": alarms_where(false), "of": of(false)}), "{score}");

    // Who answers that nothing is different is right where that is so, and nowhere else.
    for case in sealed {
        let answer = format!("blind/answers/{}", case["case"].as_str().expect("a name"));
        let mut silent = workshop.json(&format!("{answer}.json"));
        (silent["verdict"], silent["effects"], silent["shrink"]) = (json!("no_gap"), json!([]), Value::Null);
        workshop.write(&format!("{answer}.json"), silent.to_string());
        workshop.write(&format!("{answer}-added.json"), "[]");
    }
    workshop.done("challenge score blind --json silent.json --csv silent.csv");
    let silent = workshop.json("silent.json");
    assert_eq!((&silent["false_alarms"]["count"], &silent["detected"]["count"]), (&json!(0), &json!(0)), "{silent}");
    let right: Vec<bool> = workshop.text("silent.csv").lines().skip(1).map(|line| line.ends_with(",true")).collect();
    assert_eq!(right, nothing, "{}", workshop.text("silent.csv"));

    workshop.edit("blind/sealed.json", |sealed| sealed.replacen("\"salt\": \"", "\"salt\": \"0", 1));
    let refusal = workshop.refused("challenge score blind");
    assert!(refusal.contains("does not match its commitment"), "{refusal}");
}

#[test]
fn diagnosis_without_gap_writes_every_output_but_the_applied_simulator() {
    let workshop = Workshop::with_logs();
    workshop.done("train logs --out sim.json");
    let said = workshop.done("diagnose sim.json logs --apply better.json --json gap.json --html gap.html");
    assert!(said.contains("No effect to apply: better.json was not written."), "{said}");
    assert_eq!(workshop.json("gap.json")["verdict"], "no_gap");
    assert!(workshop.text("gap.html").contains("</html>"));
    assert!(!workshop.path().join("better.json").exists());
}
