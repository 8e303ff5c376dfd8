//! Models of a robot: its range sensor, the effects that a simulator may lack, and the learned simulator itself.

pub mod effects;
pub mod simulator;
pub mod sonar;

#[cfg(test)]
#[test]
#[should_panic = "attempt to add with overflow"]
fn tests_run_with_overflow_checks() {
    std::hint::black_box(std::hint::black_box(u8::MAX) + 1);
}
