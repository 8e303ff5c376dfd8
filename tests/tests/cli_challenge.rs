//! The blind test of the diagnosis from end to end.

use mindgap_tests::command::Workshop;

#[test]
fn a_challenge_is_made_answered_and_scored() {
    let workshop = Workshop::new();
    workshop.done("challenge make --cases 3 --seed 5 --out blind");
    let refusal = workshop.refused("challenge score blind");
    assert!(refusal.contains("answers"), "nothing is answered yet: {refusal}");
    workshop.done("challenge answer blind");
    workshop.done("challenge score blind --json score.json --csv cases.csv");
    let score = workshop.json("score.json");
    let (nothing, something) = (&score["false_alarms"]["of"], &score["detected"]["of"]);
    assert_eq!(nothing.as_u64().expect("a count") + something.as_u64().expect("a count"), 3, "{score}");
    workshop.edit("blind/sealed.json", |sealed| sealed.replacen("\"salt\": \"", "\"salt\": \"0", 1));
    let refusal = workshop.refused("challenge score blind");
    assert!(refusal.contains("not what was committed to"), "{refusal}");
}

#[test]
fn effects_are_added_only_to_a_simulator_and_only_if_there_are_any() {
    let workshop = Workshop::with_logs();
    let refusal = workshop.refused("diagnose kinematic logs --apply better.json");
    assert!(refusal.contains("needs a simulator file"), "{refusal}");
    workshop.done("train logs --out sim.json");
    let refusal = workshop.refused("diagnose sim.json logs --apply better.json");
    assert!(refusal.contains("nothing to add"), "{refusal}");
}
