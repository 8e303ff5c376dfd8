//! The drivers: replace them with those of your hardware. These simulate a wall 90 cm ahead of the start, and a ghost echo
//! at 20 cm in every seventh reading.

use core::sync::atomic::{AtomicI32, AtomicU32, Ordering};

use mindgap_core::controller::Motors;
use mindgap_core::fixed::types::I16F16;

/// Frequency of the processor's clock.
pub const CLOCK_HZ: u32 = 25_000_000;

static DISTANCE_MM: AtomicI32 = AtomicI32::new(900);
static READINGS: AtomicU32 = AtomicU32::new(0);
static SPEED_MM: AtomicI32 = AtomicI32::new(0);

/// Sets the motors for the next step.
pub fn drive(motors: Motors) {
    SPEED_MM.store(i32::from(motors.left) + i32::from(motors.right), Ordering::Relaxed);
}

/// Reads the sonar once.
pub fn read_sonar_cm() -> Option<I16F16> {
    let moved_mm = SPEED_MM.load(Ordering::Relaxed);
    let distance_mm = DISTANCE_MM.load(Ordering::Relaxed) - moved_mm * 4 / 5;
    DISTANCE_MM.store(distance_mm, Ordering::Relaxed);
    let readings = READINGS.load(Ordering::Relaxed) + 1;
    READINGS.store(readings, Ordering::Relaxed);
    Some(if readings % 7 == 0 { I16F16::from_num(20) } else { I16F16::from_num(distance_mm) / 10 })
}
