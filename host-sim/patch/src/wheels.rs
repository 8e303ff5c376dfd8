//! Wheels: which is left, and how far apart they stand.

use super::estimate::Estimate;

/// Something per side: left, right.
pub type Sides<T> = [Vec<T>; 2];

/// Metres by which a wheel's place must differ from the middle to say its side.
const APART_M: f64 = 1e-6;

/// Returns the side that a name says: 0 for left, 1 for right.
pub fn side_of_name(name: &str) -> Option<usize> {
    let name = name.to_lowercase();
    let words: Vec<&str> = name.split(|c: char| !c.is_ascii_alphabetic()).collect();
    let says = |long: &str, short: &[&str]| name.contains(long) || words.iter().any(|word| short.contains(word));
    match [says("left", &["l", "fl", "rl", "bl"]), says("right", &["r", "fr", "rr", "br"])] {
        [true, false] => Some(0),
        [false, true] => Some(1),
        _ => None,
    }
}

/// Sorts wheels by side: by their names, or else by their place, with y to the left.
///
/// # Errors
/// In words, if a side has no wheel.
pub fn by_side<T>(wheels: Vec<(T, String, f64)>) -> Result<Sides<T>, String> {
    let mut sides: Sides<T> = [Vec::new(), Vec::new()];
    let is_named = wheels.iter().all(|(_, name, _)| side_of_name(name).is_some());
    for (wheel, name, y) in wheels {
        let by_place = if y > APART_M {
            Some(0)
        } else if y < -APART_M {
            Some(1)
        } else {
            None
        };
        let side = if is_named { side_of_name(&name) } else { by_place };
        sides[side.ok_or_else(|| format!("the side of wheel {name} is shown neither by its name nor by its place"))?]
            .push(wheel);
    }
    if sides.iter().any(Vec::is_empty) {
        return Err("all wheels are on one side".into());
    }
    Ok(sides)
}

/// Where wheels of both sides stand in one frame.
#[derive(Clone, Debug)]
pub struct Axle {
    /// The axis of the frame, 0 to 2, along which they stand apart.
    pub axis: usize,
    middle: f64,
    distance: f64,
}

impl Axle {
    /// Returns the axle of wheels at these places, by side.
    ///
    /// # Errors
    /// In words, if they do not stand apart along an axis of their frame.
    pub fn of(places: &Sides<[f64; 3]>) -> Result<Self, String> {
        let mean = |side: usize, axis: usize| {
            places[side].iter().map(|place| place[axis]).sum::<f64>() / places[side].len() as f64
        };
        let apart = |axis: usize| mean(0, axis) - mean(1, axis);
        let axis = [0, 1, 2].into_iter().max_by(|a, b| apart(*a).abs().total_cmp(&apart(*b).abs())).unwrap_or(1);
        let distance = apart(axis).abs();
        let across = [0, 1, 2].into_iter().filter(|other| *other != axis).map(|other| apart(other).abs());
        if distance < APART_M {
            return Err("the wheels of both sides stand at one place".into());
        }
        if across.fold(0.0, f64::max) > 0.02 * distance {
            return Err("the wheels do not stand apart along an axis of the frame that they are placed in".into());
        }
        Ok(Axle { axis, middle: (mean(0, axis) + mean(1, axis)) / 2.0, distance })
    }

    /// Returns the distance between both sides.
    pub fn distance(&self) -> f64 {
        self.distance
    }

    /// Returns a coordinate of a wheel that stands at `place` along the axle if the track is divided by a factor. The
    /// coordinate `own` may be only a part of the place.
    pub fn moved(&self, own: f64, place: f64, factor: Estimate) -> Estimate {
        factor.map(|f| own + (place - self.middle) * (1.0 / f - 1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_are_read_from_names_and_else_from_places() {
        for name in ["left_wheel_joint", "wheel_l", "WheelLeft", "fl_wheel", "l.motor"] {
            assert_eq!(side_of_name(name), Some(0), "{name}");
        }
        assert_eq!((side_of_name("wheel_r_motor"), side_of_name("wheel_1")), (Some(1), None));
        let wheel = |name: &str, y: f64| (y, name.to_owned(), y);
        assert_eq!(by_side(vec![wheel("a", -1.0), wheel("b", 1.0)]), Ok([vec![1.0], vec![-1.0]]));
        assert!(by_side(vec![wheel("a", 1.0), wheel("b", 1.0)]).is_err());
        assert!(by_side(vec![wheel("a", 0.0), wheel("b", 1.0)]).is_err());
    }

    #[test]
    fn wheels_move_about_the_middle_of_their_axle() {
        let axle = Axle::of(&[vec![[0.1, 0.3, 0.0]], vec![[0.1, -0.1, 0.0]]]).expect("an axle");
        let factor = Estimate { value: 0.5, ci95: None };
        assert_eq!((axle.axis, axle.distance()), (1, 0.4));
        assert!((axle.moved(0.3, 0.3, factor).value - 0.5).abs() < 1e-12);
        assert!((axle.moved(-0.1, -0.1, factor).value + 0.3).abs() < 1e-12);
        assert!(Axle::of(&[vec![[0.1, 0.3, 0.0]], vec![[0.3, -0.1, 0.0]]]).is_err());
    }
}
