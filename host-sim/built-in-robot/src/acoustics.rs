//! Place-dependent loudness: a room makes echoes louder in some places and fainter in others, repeatably.

use std::f64::consts::TAU;

use glam::DVec2;
use rand::RngExt;

use super::noise::normal;
use mindgap_foundations::geometry::Pose;
use mindgap_foundations::random::generator;

/// Echo loudness over a room, in standard deviations: a smooth random function of the sensor's pose, as a sum of plane waves
/// (Rahimi and Recht 2007, Random features). The default is a uniform room.
#[derive(Clone, Debug, Default)]
pub(super) struct Acoustics {
    waves: Vec<Wave>,
}

/// A wave over positions and headings.
#[derive(Clone, Copy, Debug)]
struct Wave {
    /// Wave vector, rad/cm.
    vector: DVec2,
    /// Number of waves in a full turn of the sensor.
    per_turn: f64,
    phase_rad: f64,
}

/// Number of waves: enough for their sum to be nearly normal everywhere.
const WAVES: usize = 100;
/// Correlation length of loudness: the size of features along a wall, such as panels, radiators and skirting.
const LENGTH_CM: f64 = 40.0;
/// Correlation angle of loudness: about the beam's half-power width.
const ANGLE_RAD: f64 = 0.45;
/// Stream key of a room's generator.
const ROOM: u64 = u64::from_be_bytes(*b"acoustic");

impl Acoustics {
    /// Returns the acoustics of a room; each number stands for a different room.
    pub fn of_room(number: f64) -> Self {
        let mut rng = generator(number.to_bits(), &[ROOM]);
        let waves = (0..WAVES).map(|_| Wave {
            vector: DVec2::new(normal(&mut rng), normal(&mut rng)) / LENGTH_CM,
            per_turn: (normal(&mut rng) / ANGLE_RAD).round(),
            phase_rad: rng.random_range(0.0..TAU),
        });
        Acoustics { waves: waves.collect() }
    }

    /// Returns the loudness at a pose of the sensor, in standard deviations.
    pub fn at(&self, sensor: &Pose) -> f64 {
        let wave =
            |w: &Wave| libm::cos(w.vector.dot(sensor.position_cm) + w.per_turn * sensor.heading_rad + w.phase_rad);
        (2.0 / WAVES as f64).sqrt() * self.waves.iter().map(wave).sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Random poses in a large room.
    fn poses() -> Vec<Pose> {
        let mut rng = generator(1, &[]);
        let mut pose =
            || Pose::new(rng.random_range(0.0..2000.0), rng.random_range(0.0..2000.0), rng.random_range(-3.0..3.0));
        (0..4000).map(|_| pose()).collect()
    }

    /// The mean product of the loudness at poses and at poses near them.
    fn correlation(near: impl Fn(&Pose) -> Pose) -> f64 {
        let room = Acoustics::of_room(7.0);
        let poses = poses();
        poses.iter().map(|pose| room.at(pose) * room.at(&near(pose))).sum::<f64>() / poses.len() as f64
    }

    #[test]
    fn loudness_repeats_at_a_pose_and_decorrelates_away_from_it() {
        let moved = |x_cm: f64, turn_rad: f64| correlation(|p| p.compose(&Pose::new(x_cm, 0.0, turn_rad)));
        assert!((moved(0.0, 0.0) - 1.0).abs() < 0.2, "{}", moved(0.0, 0.0));
        // A Gaussian of the distance in correlation lengths: exp(-1/2) after one.
        assert!((moved(LENGTH_CM, 0.0) - 0.61).abs() < 0.2, "{}", moved(LENGTH_CM, 0.0));
        assert!(moved(4.0 * LENGTH_CM, 0.0).abs() < 0.15 && moved(0.0, 4.0 * ANGLE_RAD).abs() < 0.15);
    }

    #[test]
    fn rooms_differ_and_full_turns_change_nothing() {
        let (pose, turned) = (Pose::new(80.0, 120.0, 1.0), Pose::new(80.0, 120.0, 1.0 + TAU));
        let [one, other] = [1.0, 2.0].map(Acoustics::of_room);
        assert!((one.at(&pose) - one.at(&turned)).abs() < 1e-9);
        assert!((one.at(&pose) - other.at(&pose)).abs() > 1e-3);
        assert_eq!(Acoustics::default().at(&pose), 0.0);
    }
}
