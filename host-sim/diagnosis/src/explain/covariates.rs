//! The covariates of a row on which a gap may depend.

use mindgap_learning::evaluation::observations::Observation;

/// Returns the time since the run began, s.
pub fn seconds(row: &Observation) -> f64 {
    60.0 * row.context.elapsed_min
}

/// Returns the mean magnitude of the commands.
pub fn speed(row: &Observation) -> f64 {
    let [left, right] = row.context.commands[0];
    0.5 * (left.abs() + right.abs())
}

/// Returns the larger change of the two commands.
pub fn change(row: &Observation) -> f64 {
    let [now, before, ..] = row.context.commands;
    (now[0] - before[0]).abs().max((now[1] - before[1]).abs())
}

/// Returns whether a motor reverses.
pub fn reverses(row: &Observation) -> bool {
    let [now, before, ..] = row.context.commands;
    (0..2).any(|m| now[m] * before[m] < 0.0)
}

/// Returns right minus left command, which is positive in turns to the left.
pub fn turning(row: &Observation) -> f64 {
    let [left, right] = row.context.commands[0];
    right - left
}

/// Returns the mean command, which is negative in reverse.
pub fn driving(row: &Observation) -> f64 {
    let [left, right] = row.context.commands[0];
    0.5 * (left + right)
}

/// Returns the heading, degrees.
pub fn heading_deg(row: &Observation) -> f64 {
    row.context.pose.heading_rad.to_degrees()
}

/// Returns the distance from the scene's middle, cm.
pub fn from_middle_cm(row: &Observation) -> f64 {
    row.context.pose.position_cm.distance(row.context.middle_cm)
}

/// Returns the x coordinate, cm.
pub fn x_cm(row: &Observation) -> f64 {
    row.context.pose.position_cm.x
}

/// Returns the y coordinate, cm.
pub fn y_cm(row: &Observation) -> f64 {
    row.context.pose.position_cm.y
}

/// Returns the distance along the sensor's axis, cm, at most 300.
pub fn distance_cm(row: &Observation) -> f64 {
    row.context.faced.map_or(300.0, |[distance_cm, _]| distance_cm.min(300.0))
}

/// Returns the incidence angle on the sensor's axis, degrees, positive where the wall leans to the left.
pub fn incidence_deg(row: &Observation) -> f64 {
    row.context.faced.map_or(0.0, |[_, incidence_rad]| incidence_rad.to_degrees())
}

/// Returns one if there was a reading before, otherwise zero.
pub fn echo_before(row: &Observation) -> f64 {
    f64::from(u8::from(row.context.echo_before == Some(true)))
}

/// Returns whether the side rays meet something much nearer or farther than the axis.
pub fn edge_in_beam(row: &Observation) -> bool {
    let Some([axis, _]) = row.context.faced else { return false };
    let [right, left] = row.side_ray_ranges_cm;
    let expected = 2.0 * right * left / (right + left);
    (axis - expected).abs() > 0.15 * axis
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::{Made, observations};
    use mindgap_foundations::geometry::Pose;

    fn row(made: Made) -> Observation {
        observations(1, 1, |_, _| made).rows.remove(0)
    }

    fn commanded(now: [f64; 2], before: [f64; 2]) -> Observation {
        row(Made { commands: [now, before], ..Made::default() })
    }

    fn placed(x_cm: f64, y_cm: f64, heading_deg: f64) -> Observation {
        row(Made { pose: Pose::new(x_cm, y_cm, f64::to_radians(heading_deg)), ..Made::default() })
    }

    #[test]
    fn covariates_of_commands() {
        let row = commanded([-20.0, 60.0], [30.0, 50.0]);
        assert_eq!([speed(&row), change(&row), turning(&row), driving(&row)], [40.0, 50.0, 80.0, 20.0]);
        assert!(reverses(&row));
        let row = commanded([0.0, -60.0], [30.0, -10.0]);
        assert_eq!([speed(&row), change(&row), turning(&row), driving(&row)], [30.0, 50.0, -60.0, -30.0]);
        assert!(!reverses(&row), "stopping is not reversing");
    }

    #[test]
    fn covariates_of_time_and_place() {
        assert_eq!(seconds(&row(Made { elapsed_min: 0.25, ..Made::default() })), 15.0);
        let row = placed(180.0, 60.0, -90.0);
        assert_eq!([x_cm(&row), y_cm(&row), from_middle_cm(&row)], [180.0, 60.0, 50.0]);
        assert!((heading_deg(&row) + 90.0).abs() < 1e-9);
    }

    /// The room is 300 by 200 cm.
    #[test]
    fn covariates_of_what_the_sensor_faces() {
        let oblique = placed(250.0, 100.0, 30.0);
        assert!((distance_cm(&oblique) - 50.0 / libm::cos(30f64.to_radians())).abs() < 1e-9);
        assert!((incidence_deg(&oblique).abs() - 30.0).abs() < 1e-9);
        assert!((incidence_deg(&oblique) + incidence_deg(&placed(250.0, 100.0, -30.0))).abs() < 1e-9);
        let open_ground = {
            let mut row = placed(250.0, 100.0, 0.0);
            row.context.faced = None;
            row
        };
        assert_eq!([distance_cm(&open_ground), incidence_deg(&open_ground)], [300.0, 0.0]);
    }

    #[test]
    fn covariate_of_the_reading_before() {
        let mut row = placed(150.0, 100.0, 0.0);
        let before = [None, Some(false), Some(true)].map(|echo| {
            row.context.echo_before = echo;
            echo_before(&row)
        });
        assert_eq!(before, [0.0, 0.0, 1.0]);
    }

    /// Inverse distances to a wall are linear in the tangent of the angle, so that a wall alone is no edge; a step of a
    /// fifth is one.
    #[test]
    fn edge_in_the_beam_differs_from_an_oblique_wall() {
        let mut row = placed(250.0, 100.0, 20.0);
        assert!(!edge_in_beam(&row));
        row.context.faced = row.context.faced.map(|[axis_cm, incidence_rad]| [1.2 * axis_cm, incidence_rad]);
        assert!(edge_in_beam(&row));
    }
}
