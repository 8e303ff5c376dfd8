//! Motion of a step in the robot's own frame, by axis: a planar rigid-body increment, SE(2).

use std::ops::{Add, Index, IndexMut, Sub};

use glam::DVec2;
use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::geometry::{Pose, direction};

/// An axis along which a step moves a robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Axis {
    /// Straight ahead.
    Forward,
    /// To the left.
    Lateral,
    /// Counter-clockwise.
    Turn,
}

/// One value per axis. A displacement is in cm and a turn in radians, unless stated otherwise.
///
/// Files hold it as an array: forward, lateral, turn.
#[derive(Clone, Copy, Debug, Default, PartialEq, JsonSchema)]
#[schemars(with = "[T; 3]")]
pub struct Motion<T> {
    /// Straight ahead, at the heading with which the step begins.
    pub forward: T,
    /// To the left of that heading.
    pub lateral: T,
    /// Counter-clockwise.
    pub turn: T,
}

impl Axis {
    /// All axes, in the order of files.
    pub const ALL: [Axis; 3] = [Axis::Forward, Axis::Lateral, Axis::Turn];
}

impl<T> Motion<T> {
    /// Returns what `value` gives for each axis, asked in the order of [`Axis::ALL`].
    #[inline(always)]
    pub fn from_fn(value: impl FnMut(Axis) -> T) -> Self {
        Axis::ALL.map(value).into()
    }

    /// Returns the values in the order of [`Axis::ALL`].
    #[inline(always)]
    pub fn into_array(self) -> [T; 3] {
        [self.forward, self.lateral, self.turn]
    }

    /// Returns references to the values.
    #[inline(always)]
    pub fn each_ref(&self) -> Motion<&T> {
        Motion { forward: &self.forward, lateral: &self.lateral, turn: &self.turn }
    }

    /// Returns `change` of each value.
    #[inline(always)]
    pub fn map<U>(self, change: impl FnMut(T) -> U) -> Motion<U> {
        self.into_array().map(change).into()
    }

    /// Returns `combine` of the values of two motions, axis by axis.
    #[inline(always)]
    pub fn zip_with<U, V>(self, other: Motion<U>, mut combine: impl FnMut(T, U) -> V) -> Motion<V> {
        Motion {
            forward: combine(self.forward, other.forward),
            lateral: combine(self.lateral, other.lateral),
            turn: combine(self.turn, other.turn),
        }
    }

    /// Iterates over the values in the order of [`Axis::ALL`].
    #[inline(always)]
    pub fn iter(&self) -> std::array::IntoIter<&T, 3> {
        self.each_ref().into_array().into_iter()
    }

    /// Iterates over the values in the order of [`Axis::ALL`], and lets them be changed.
    #[inline(always)]
    pub fn iter_mut(&mut self) -> std::array::IntoIter<&mut T, 3> {
        [&mut self.forward, &mut self.lateral, &mut self.turn].into_iter()
    }
}

impl<T: Copy> Motion<T> {
    /// Returns the same value on every axis.
    pub const fn splat(value: T) -> Self {
        Motion { forward: value, lateral: value, turn: value }
    }
}

impl Motion<f64> {
    /// A robot at rest.
    pub const ZERO: Self = Motion::splat(0.0);

    /// Returns the motion from one pose to another.
    pub fn between(from: &Pose, to: &Pose) -> Self {
        let Pose { position_cm, heading_rad } = from.relative(to);
        Motion { forward: position_cm.x, lateral: position_cm.y, turn: heading_rad }
    }

    /// Returns the pose to which the motion leads from `pose`.
    pub fn end(&self, pose: &Pose) -> Pose {
        pose.compose(&Pose::new(self.forward, self.lateral, self.turn))
    }

    /// Returns this motion followed by another one.
    pub fn then(self, next: Self) -> Self {
        let mut turned = next;
        turned.rotate_translation(self.turn);
        self + turned
    }

    /// Returns the motion `factor` times as large.
    pub fn scaled(self, factor: f64) -> Self {
        self.map(|value| value * factor)
    }

    /// Rotates the translation and leaves the turn.
    pub fn rotate_translation(&mut self, angle_rad: f64) {
        let translation = direction(angle_rad).rotate(DVec2::new(self.forward, self.lateral));
        (self.forward, self.lateral) = (translation.x, translation.y);
    }

    /// Returns the arc that leads here.
    pub fn arc(&self) -> Arc {
        let mut along_chord = *self;
        along_chord.rotate_translation(-0.5 * self.turn);
        Arc { length_cm: along_chord.forward / chord(self.turn), across_cm: along_chord.lateral, turn_rad: self.turn }
    }

    /// Returns the motion with its turn, so far in radians, in degrees: for files and networks.
    pub fn turn_in_degrees(self) -> Self {
        Motion { turn: self.turn.to_degrees(), ..self }
    }

    /// Returns the motion with its turn, so far in degrees, in radians.
    pub fn turn_in_radians(self) -> Self {
        Motion { turn: self.turn.to_radians(), ..self }
    }
}

impl<T> From<[T; 3]> for Motion<T> {
    #[inline(always)]
    fn from([forward, lateral, turn]: [T; 3]) -> Self {
        Motion { forward, lateral, turn }
    }
}

impl<T> From<Motion<T>> for [T; 3] {
    fn from(motion: Motion<T>) -> Self {
        motion.into_array()
    }
}

impl<T> IntoIterator for Motion<T> {
    type Item = T;
    type IntoIter = std::array::IntoIter<T, 3>;

    #[inline(always)]
    fn into_iter(self) -> Self::IntoIter {
        self.into_array().into_iter()
    }
}

impl<T> Index<Axis> for Motion<T> {
    type Output = T;

    #[inline(always)]
    fn index(&self, axis: Axis) -> &T {
        match axis {
            Axis::Forward => &self.forward,
            Axis::Lateral => &self.lateral,
            Axis::Turn => &self.turn,
        }
    }
}

impl<T> IndexMut<Axis> for Motion<T> {
    #[inline(always)]
    fn index_mut(&mut self, axis: Axis) -> &mut T {
        match axis {
            Axis::Forward => &mut self.forward,
            Axis::Lateral => &mut self.lateral,
            Axis::Turn => &mut self.turn,
        }
    }
}

impl<T: Add> Add for Motion<T> {
    type Output = Motion<T::Output>;

    #[inline(always)]
    fn add(self, other: Self) -> Self::Output {
        self.zip_with(other, T::add)
    }
}

impl<T: Sub> Sub for Motion<T> {
    type Output = Motion<T::Output>;

    #[inline(always)]
    fn sub(self, other: Self) -> Self::Output {
        self.zip_with(other, T::sub)
    }
}

impl<T: Serialize> Serialize for Motion<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.each_ref().into_array().serialize(serializer)
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Motion<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        <[T; 3]>::deserialize(deserializer).map(Motion::from)
    }
}

/// The arc that the middle of the axle follows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arc {
    /// Its length, cm.
    pub length_cm: f64,
    /// What the robot slides to the left of the arc's chord, cm.
    pub across_cm: f64,
    /// Its angle, rad.
    pub turn_rad: f64,
}

impl Arc {
    /// Returns the motion along it.
    pub fn motion(&self) -> Motion<f64> {
        let Arc { length_cm, across_cm, turn_rad } = *self;
        let mut motion = Motion { forward: length_cm * chord(turn_rad), lateral: across_cm, turn: turn_rad };
        motion.rotate_translation(0.5 * turn_rad);
        motion
    }

    /// Returns the arc along `factor` times its length.
    pub fn scaled(self, factor: f64) -> Self {
        Arc { length_cm: factor * self.length_cm, across_cm: factor * self.across_cm, turn_rad: factor * self.turn_rad }
    }

    /// Returns the arc whose length, slide and angle are the sums of both.
    pub fn plus(self, other: Self) -> Self {
        Arc {
            length_cm: self.length_cm + other.length_cm,
            across_cm: self.across_cm + other.across_cm,
            turn_rad: self.turn_rad + other.turn_rad,
        }
    }

    /// Returns the distances that the left and right wheel cover, for a distance of `track_cm` between them.
    pub fn wheels_cm(&self, track_cm: f64) -> [f64; 2] {
        let half_cm = 0.5 * track_cm * self.turn_rad;
        [self.length_cm - half_cm, self.length_cm + half_cm]
    }

    /// Returns the arc of wheels that cover these distances; the robot slides as before.
    pub fn with_wheels(self, [left_cm, right_cm]: [f64; 2], track_cm: f64) -> Self {
        Arc { length_cm: 0.5 * (left_cm + right_cm), turn_rad: (right_cm - left_cm) / track_cm, ..self }
    }
}

/// Returns the length of an arc's chord as a share of the arc's. Near a full circle, where it vanishes, it is kept away from zero:
/// no step turns so far, but a fit may try.
fn chord(turn_rad: f64) -> f64 {
    let half_rad = 0.5 * turn_rad;
    if half_rad.abs() < 1e-6 { 1.0 } else { (libm::sin(half_rad) / half_rad).max(0.1) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn every_axis_has_its_own_value() {
        let mut motion = Motion::from_fn(|axis| axis);
        assert!(Axis::ALL.into_iter().eq(motion));
        assert!(Axis::ALL.iter().all(|axis| motion[*axis] == *axis));
        motion[Axis::Lateral] = Axis::Turn;
        assert_eq!(motion.into_array(), [Axis::Forward, Axis::Turn, Axis::Turn]);
    }

    fn motion() -> impl Strategy<Value = Motion<f64>> {
        prop::array::uniform3(-3.0..3.0).prop_map(Motion::from)
    }

    proptest! {
        #[test]
        fn motion_leads_from_one_pose_to_the_other(motion in motion(), x in -9.0..9.0, y in -9.0..9.0, h in -3.0..3.0) {
            let from = Pose::new(x, y, h);
            let found = Motion::between(&from, &motion.end(&from));
            prop_assert!((found - motion).into_iter().all(|off| off.abs() < 1e-9), "{found:?}");
        }

        #[test]
        fn wheels_give_back_the_motion(motion in motion(), track_cm in 5.0..30.0) {
            let arc = motion.arc();
            let found = arc.with_wheels(arc.wheels_cm(track_cm), track_cm).motion();
            prop_assert!((found - motion).into_iter().all(|off| off.abs() < 1e-9), "{found:?}");
        }

        /// A quarter circle of radius r leads to (r, r), whatever the track.
        #[test]
        fn wheels_follow_an_arc(radius_cm in 1.0..100.0, track_cm in 5.0..30.0) {
            let quarter_rad = std::f64::consts::FRAC_PI_2;
            let wheels_cm = [radius_cm - 0.5 * track_cm, radius_cm + 0.5 * track_cm].map(|wheel| wheel * quarter_rad);
            let arc = Motion::ZERO.arc().with_wheels(wheels_cm, track_cm);
            let found = arc.motion();
            let expected = Motion { forward: radius_cm, lateral: radius_cm, turn: quarter_rad };
            prop_assert!((found - expected).into_iter().all(|off| off.abs() < 1e-9), "{found:?}");
            let found = Arc { turn_rad: 0.0, ..arc }.motion();
            prop_assert!((found.forward - radius_cm * quarter_rad).abs() < 1e-9 && found.lateral.abs() < 1e-9, "{found:?}");
        }
    }
}
