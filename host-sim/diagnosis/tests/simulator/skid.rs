//! Robots that turn less or more than their wheels say, against the textbook.

use mindgap_diagnosis::diagnose;
use mindgap_models::simulator::kinematic;

use crate::made_up::MadeUp;

#[test]
fn another_track_is_a_factor_on_turns_alone() {
    for stretch in [0.78, 1.22, 2.4] {
        let logs = MadeUp { stretch, ..MadeUp::TEXTBOOK }.logs(16, 23);
        let diagnosis = diagnose(kinematic::baseline(&logs), &logs).expect("comparable logs");
        let [found] = diagnosis.effects.as_slice() else { panic!("{stretch}: {:?}", diagnosis.effects) };
        let factor = found.parameters["factor"].as_f64().expect("a number");
        assert!(found.id == "track_width" && found.probability > 0.9, "{stretch}: {found:?}");
        assert!((factor * stretch - 1.0).abs() < 0.01, "{stretch}: {found:?}");
    }
}
