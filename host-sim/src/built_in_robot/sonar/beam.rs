//! The beam: rays over its cone, each losing strength with angle, way and surface, and the first echo that is loud
//! enough.

use std::f64::consts::FRAC_PI_2;

use glam::DVec2;

use crate::built_in_robot::hardware::Sonar;
use crate::built_in_robot::noise::normal;
use crate::chance::Generator;
use crate::geometry::{Hit, Pose, Wall, cast, direction};

const RAYS: u32 = 15;
/// Sound that has been mirrored starts a little off the wall, so that it does not meet it again.
const OFF_WALL_CM: f64 = 1e-6;

/// An echo that triggers the sensor.
#[derive(Clone, Copy, Debug)]
pub(super) struct Echo {
    /// Half of the way that the sound went.
    pub distance_cm: f64,
    /// Above what triggers the sensor.
    pub level_db: f64,
    /// 0 for sound that met its wall squarely, 1 along it.
    pub grazing: f64,
}

/// The nearest echo that triggers the sensor on a robot at `robot`.
pub(super) fn first_echo(sonar: &Sonar, sides: &[Wall], robot: &Pose, rng: &mut Generator) -> Option<Echo> {
    let sensor = robot.compose(&Pose { position_cm: sonar.place_cm, heading_rad: sonar.yaw_rad });
    let ping_db = sonar.ping_db * normal(rng);
    let mut first: Option<Echo> = None;
    for ray in 0..RAYS {
        // -1 at the right edge of the beam, 1 at the left one.
        let aside = 2.0 * f64::from(ray) / f64::from(RAYS - 1) - 1.0;
        let way = direction(sensor.heading_rad + aside * sonar.half_angle_rad);
        let sent_db = sonar.level_db + ping_db - sonar.edge_db * aside * aside + sonar.lean_db * aside;
        let speckle_db = sonar.speckle_db * normal(rng);
        let Some(hit) = cast(sides, sensor.position_cm, way) else { continue };
        let straight = returned(sonar, hit.distance_cm, hit.incidence_rad);
        let mirrored = mirrored(sonar, sides, sensor.position_cm, way, &hit);
        for echo in [Some(straight), mirrored].into_iter().flatten() {
            let level_db = echo.level_db + sent_db + speckle_db;
            let nearer = first.is_none_or(|f| echo.distance_cm < f.distance_cm);
            if level_db > 0.0 && echo.distance_cm >= sonar.min_cm && nearer {
                first = Some(Echo { level_db, ..echo });
            }
        }
    }
    first
}

/// What a wall sends back, against a square echo from one metre.
fn returned(sonar: &Sonar, distance_cm: f64, incidence_rad: f64) -> Echo {
    let way_m = distance_cm.max(1.0) / 100.0;
    let spread_db = 20.0 * libm::log10(way_m) + sonar.absorption_db_per_m * (way_m - 1.0);
    let lean = incidence_rad / sonar.facet_rad;
    let facing = libm::cos(incidence_rad);
    let share = (1.0 - sonar.diffuse) * libm::exp(-lean * lean) + sonar.diffuse * facing * facing;
    Echo { distance_cm, level_db: 20.0 * libm::log10(share) - spread_db, grazing: incidence_rad.abs() / FRAC_PI_2 }
}

/// Sound that a wall mirrors to a second one, and that comes back the same way: the reading is too long.
fn mirrored(sonar: &Sonar, sides: &[Wall], from_cm: DVec2, way: DVec2, hit: &Hit) -> Option<Echo> {
    let normal = direction(libm::atan2(-way.y, -way.x) + hit.incidence_rad);
    let away = way - normal * (2.0 * way.dot(normal));
    let at_cm = from_cm + way * hit.distance_cm + normal * OFF_WALL_CM;
    let second = cast(sides, at_cm, away)?;
    let echo = returned(sonar, hit.distance_cm + second.distance_cm, second.incidence_rad);
    Some(Echo { level_db: echo.level_db - 2.0 * sonar.mirror_db, ..echo })
}
