//! Loudness that belongs to the place: how a room makes an echo louder here and fainter there, the same every time.

use std::f64::consts::TAU;

use glam::DVec2;
use rand::RngExt;

use super::noise::normal;
use mindgap_foundations::chance::generator;
use mindgap_foundations::geometry::Pose;

/// How loud echoes are over a room, in standard deviations: a smooth function of the sensor's pose, random from room to
/// room, as a sum of plane waves (Rahimi and Recht 2007, Random features). The default is a room that is alike everywhere.
#[derive(Clone, Debug, Default)]
pub(super) struct Acoustics {
    waves: Vec<Wave>,
}

/// A wave over positions and headings.
#[derive(Clone, Copy, Debug)]
struct Wave {
    /// Wave vector, rad/cm.
    vector: DVec2,
    /// Waves in a full turn of the sensor.
    in_a_turn: f64,
    phase_rad: f64,
}

/// Enough that their sum is nearly normal everywhere.
const WAVES: usize = 100;
/// Length over which loudness changes: that of what stands at a wall, such as panels, radiators and skirting.
const LENGTH_CM: f64 = 40.0;
/// Turn over which it changes: about the beam's half-power width, which then takes in other parts of a wall.
const ANGLE_RAD: f64 = 0.45;
/// Stream key of a room's generator.
const ROOM: u64 = u64::from_be_bytes(*b"acoustic");

impl Acoustics {
    /// A room; any number stands for another one.
    pub fn of_room(number: f64) -> Self {
        let mut rng = generator(number.to_bits(), &[ROOM]);
        let waves = (0..WAVES).map(|_| Wave {
            vector: DVec2::new(normal(&mut rng), normal(&mut rng)) / LENGTH_CM,
            in_a_turn: (normal(&mut rng) / ANGLE_RAD).round(),
            phase_rad: rng.random_range(0.0..TAU),
        });
        Acoustics { waves: waves.collect() }
    }

    /// Loudness at a pose of the sensor, in standard deviations.
    pub fn at(&self, sensor: &Pose) -> f64 {
        let wave =
            |w: &Wave| libm::cos(w.vector.dot(sensor.position_cm) + w.in_a_turn * sensor.heading_rad + w.phase_rad);
        (2.0 / WAVES as f64).sqrt() * self.waves.iter().map(wave).sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Poses at random in a large room.
    fn poses() -> Vec<Pose> {
        let mut rng = generator(1, &[]);
        let mut pose =
            || Pose::new(rng.random_range(0.0..2000.0), rng.random_range(0.0..2000.0), rng.random_range(-3.0..3.0));
        (0..4000).map(|_| pose()).collect()
    }

    /// The mean product of the loudness at poses and at others near them.
    fn agreement(near: impl Fn(&Pose) -> Pose) -> f64 {
        let room = Acoustics::of_room(7.0);
        let poses = poses();
        poses.iter().map(|pose| room.at(pose) * room.at(&near(pose))).sum::<f64>() / poses.len() as f64
    }

    #[test]
    fn loudness_repeats_at_a_pose_and_is_forgotten_away_from_it() {
        let there = |x_cm: f64, turn_rad: f64| agreement(|p| p.compose(&Pose::new(x_cm, 0.0, turn_rad)));
        assert!((there(0.0, 0.0) - 1.0).abs() < 0.2, "{}", there(0.0, 0.0));
        // A Gaussian of the way in lengths: exp(-1/2) after one.
        assert!((there(LENGTH_CM, 0.0) - 0.61).abs() < 0.2, "{}", there(LENGTH_CM, 0.0));
        assert!(there(4.0 * LENGTH_CM, 0.0).abs() < 0.15 && there(0.0, 4.0 * ANGLE_RAD).abs() < 0.15);
    }

    #[test]
    fn rooms_differ_and_a_full_turn_changes_nothing() {
        let (pose, turned) = (Pose::new(80.0, 120.0, 1.0), Pose::new(80.0, 120.0, 1.0 + TAU));
        let [one, other] = [1.0, 2.0].map(Acoustics::of_room);
        assert!((one.at(&pose) - one.at(&turned)).abs() < 1e-9);
        assert!((one.at(&pose) - other.at(&pose)).abs() > 1e-3);
        assert_eq!(Acoustics::default().at(&pose), 0.0);
    }
}
