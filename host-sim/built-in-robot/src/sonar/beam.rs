//! The beam: rays over its cone, attenuated by angle, distance and surface, and the first echo above the threshold.

use std::f64::consts::FRAC_PI_2;

use glam::DVec2;

use crate::hardware::Sonar;
use crate::noise::normal;
use crate::sonar::Ping;
use mindgap_foundations::geometry::{Hit, Pose, Wall, cast, direction};
use mindgap_foundations::random::Generator;

const RAYS: u32 = 15;
/// Reflected rays start this far off the wall, so that they do not hit it again.
const OFF_WALL_CM: f64 = 1e-6;

/// An echo that triggers the sensor.
#[derive(Clone, Copy, Debug)]
pub(super) struct Echo {
    /// Half of the path length of the sound.
    pub distance_cm: f64,
    /// Level above the threshold of the sensor.
    pub level_db: f64,
    /// 0 for normal incidence on the wall, 1 for grazing incidence.
    pub grazing: f64,
}

/// Returns the nearest echo of a ping that triggers the sensor.
pub(super) fn first_echo(sonar: &Sonar, sides: &[Wall], ping: &Ping, rng: &mut Generator) -> Option<Echo> {
    let sensor = ping.from.compose(&Pose { position_cm: sonar.mount_cm, heading_rad: sonar.yaw_rad });
    let here_db = sonar.place_db * sonar.acoustics.at(&sensor);
    let ping_db = sonar.ping_db * normal(rng) + here_db - sonar.whine_db * ping.wheel_speed;
    let mut first: Option<Echo> = None;
    for ray in 0..RAYS {
        // -1 at the right edge of the beam, 1 at the left one.
        let offset = 2.0 * f64::from(ray) / f64::from(RAYS - 1) - 1.0;
        let along = direction(sensor.heading_rad + offset * sonar.half_angle_rad);
        let sent_db = sonar.level_db + ping_db - sonar.edge_db * offset * offset + sonar.lean_db * offset;
        let speckle_db = sonar.speckle_db * normal(rng);
        let Some(hit) = cast(sides, sensor.position_cm, along) else { continue };
        let straight = returned(sonar, &hit);
        let mirrored = mirrored(sonar, sides, sensor.position_cm, along, &hit);
        let floor = floor(sonar, offset * sonar.half_angle_rad);
        let above_floor =
            [Some(straight), mirrored].into_iter().flatten().filter(|e| e.distance_cm < floor.distance_cm);
        let bare_floor = Some(floor).filter(|floor| floor.distance_cm <= hit.distance_cm);
        for echo in above_floor.chain(bare_floor) {
            let level_db = echo.level_db + sent_db + speckle_db;
            let nearer = first.is_none_or(|f| echo.distance_cm < f.distance_cm);
            if level_db > 0.0 && echo.distance_cm >= sonar.min_cm && nearer {
                first = Some(Echo { level_db, ..echo });
            }
        }
    }
    first
}

/// Returns the direct echo of a wall, relative to normal incidence at one metre. The wall's facets scatter, so the sound spreads
/// on the way there and again on the way back.
fn returned(sonar: &Sonar, hit: &Hit) -> Echo {
    let spread_db = 2.0 * spread_db(hit.distance_cm);
    let level_db = scattered_db(sonar, hit) - spread_db - absorbed_db(sonar, hit.distance_cm);
    Echo { distance_cm: hit.distance_cm, level_db, grazing: grazing(hit) }
}

/// Returns the echo of the floor on a ray at this angle to the axis, where a beam that points down meets it. It grazes the floor,
/// whose grain alone scatters some of it back. Of a level beam it is infinitely far and faint.
fn floor(sonar: &Sonar, offset_rad: f64) -> Echo {
    let distance_cm = sonar.floor_cm / libm::cos(offset_rad);
    let grain_db = 20.0 * libm::log10(sonar.diffuse);
    let level_db = grain_db - 2.0 * spread_db(distance_cm) - absorbed_db(sonar, distance_cm);
    Echo { distance_cm, level_db, grazing: 1.0 }
}

/// Returns the echo of sound that a wall reflects specularly to a second one and that returns the same way, which makes the
/// reading too long. Specular reflection adds no spreading.
fn mirrored(sonar: &Sonar, sides: &[Wall], from_cm: DVec2, along: DVec2, hit: &Hit) -> Option<Echo> {
    let normal = direction(libm::atan2(-along.y, -along.x) + hit.incidence_rad);
    let away = along - normal * (2.0 * along.dot(normal));
    let at_cm = from_cm + along * hit.distance_cm + normal * OFF_WALL_CM;
    let second = cast(sides, at_cm, away)?;
    let distance_cm = hit.distance_cm + second.distance_cm;
    let lost_db = spread_db(distance_cm) + absorbed_db(sonar, distance_cm) + 2.0 * sonar.mirror_db;
    let level_db = scattered_db(sonar, &second) - lost_db;
    Some(Echo { distance_cm, level_db, grazing: grazing(&second) })
}

/// Returns the backscatter of a wall relative to normal incidence on a hard one, dB; most of it from facets that face the
/// sensor.
fn scattered_db(sonar: &Sonar, hit: &Hit) -> f64 {
    let lean = hit.incidence_rad / sonar.facet_rad;
    let facing = libm::cos(hit.incidence_rad);
    let share = (1.0 - sonar.diffuse) * libm::exp(-lean * lean) + sonar.diffuse * facing * facing;
    let surface_db = if hit.wall < sonar.arena_sides { 0.0 } else { sonar.obstacle_db };
    20.0 * libm::log10(share) + surface_db
}

/// Returns 0 for normal incidence, 1 for grazing incidence.
fn grazing(hit: &Hit) -> f64 {
    hit.incidence_rad.abs() / FRAC_PI_2
}

/// Returns the spreading loss over a path, dB relative to one metre.
fn spread_db(path_cm: f64) -> f64 {
    20.0 * libm::log10(path_cm.max(1.0) / 100.0)
}

/// Returns the absorption in air over a path, dB relative to one metre.
fn absorbed_db(sonar: &Sonar, path_cm: f64) -> f64 {
    sonar.absorption_db_per_m * (path_cm / 100.0 - 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hardware::Hardware;
    use crate::{default_robot, training_room};
    use mindgap_foundations::geometry::Rectangle;
    use mindgap_foundations::random::generator;

    /// A noise-free sensor at the centre of the axle.
    fn steady() -> Sonar {
        let sonar = Hardware::new(&default_robot(), &training_room()).sonar;
        Sonar { mount_cm: DVec2::ZERO, ping_db: 0.0, speckle_db: 0.0, ..sonar }
    }

    fn room() -> Vec<Wall> {
        Rectangle { low_cm: DVec2::ZERO, high_cm: DVec2::new(200.0, 100.0) }.edges().to_vec()
    }

    fn echo(sonar: &Sonar, x_cm: f64, heading_deg: f64) -> Option<Echo> {
        let from = Pose::new(x_cm, 50.0, heading_deg.to_radians());
        first_echo(sonar, &room(), &Ping { from, t_ms: 0.0, wheel_speed: 0.0 }, &mut generator(1, &[]))
    }

    #[test]
    fn wall_ahead_is_read_at_its_distance_and_fades_with_distance() {
        let (near, far) = (echo(&steady(), 160.0, 0.0).unwrap(), echo(&steady(), 120.0, 0.0).unwrap());
        assert!((near.distance_cm - 40.0).abs() < 1e-9 && (far.distance_cm - 80.0).abs() < 1e-9);
        assert!(near.level_db > far.level_db + 10.0);
    }

    #[test]
    fn oblique_wall_is_fainter_and_read_at_the_near_side_of_the_beam() {
        let (square, oblique) = (echo(&steady(), 160.0, 0.0).unwrap(), echo(&steady(), 160.0, 30.0).unwrap());
        let along_axis_cm = 40.0 / libm::cos(30f64.to_radians());
        assert!(oblique.level_db < square.level_db && oblique.grazing > 0.1);
        assert!((40.0..along_axis_cm).contains(&oblique.distance_cm), "{}", oblique.distance_cm);
    }

    #[test]
    fn specular_reflection_into_a_corner_reads_too_long() {
        // To the upper wall at 60 degrees from its normal, then on to the right one.
        let sonar = Sonar { half_angle_rad: 0.0, diffuse: 0.0, mirror_db: 0.0, level_db: 30.0, ..steady() };
        let found = echo(&sonar, 100.0, 30.0).unwrap();
        let legs_cm = (50.0 / libm::sin(30f64.to_radians()), 100.0 / libm::cos(30f64.to_radians()) - 100.0);
        assert!((found.distance_cm - legs_cm.0 - legs_cm.1).abs() < 1e-3, "{found:?}");
    }
}
