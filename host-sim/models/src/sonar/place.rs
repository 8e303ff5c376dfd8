//! Places of a sensor: cells of poses within which its view is similar.

use std::f64::consts::TAU;

use mindgap_foundations::geometry::Pose;

/// A cell of the sensor's position and facing.
pub type Place = [i32; 3];

/// A beam of 40 degrees covers 70 cm of a wall that is a metre away: a sensor that has moved by less than that, or turned by
/// less than the beam, hears mostly the same surfaces.
const CELL_CM: f64 = 60.0;
/// Number of sectors of 45 degrees.
const SECTORS: f64 = 8.0;

/// Returns the place of a sensor.
pub fn place_of(sensor: &Pose) -> Place {
    let sector = (sensor.heading_rad.rem_euclid(TAU) / TAU * SECTORS).floor();
    let [x, y] = [sensor.position_cm.x, sensor.position_cm.y].map(|cm| (cm / CELL_CM).floor() as i32);
    [x, y, (sector % SECTORS) as i32]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn place_is_60_cm_and_an_eighth_of_a_turn() {
        let place = |x_cm: f64, deg: f64| place_of(&Pose::new(x_cm, 90.0, deg.to_radians()));
        assert_eq!(place(10.0, 10.0), place(50.0, 40.0));
        assert_ne!(place(10.0, 10.0), place(70.0, 10.0));
        assert_ne!(place(10.0, 10.0), place(10.0, 50.0));
        assert_eq!(place(10.0, -10.0), place(10.0, 350.0));
        assert_eq!(place(10.0, -1e-18)[2], 0);
    }
}
