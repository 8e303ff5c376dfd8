//! Columns that hold the pose of one body, in space or in the plane.

use glam::{DQuat, DVec3};

use super::column::Column;
use super::spatial_pose::SpatialPose;
use super::table::Line;
use mindgap_foundations::error::Result;

/// Columns of the poses of a body.
#[derive(Clone, Debug)]
pub struct Body {
    /// Name of the body; empty if the file has a single one without a name.
    pub name: String,
    /// Columns of x, y and z; z may be absent.
    pub position: [Option<Column>; 3],
    /// Columns of the rotation.
    pub rotation: Rotation,
    /// Column that is negative where the body is lost.
    pub residual: Option<Column>,
    /// Whether a pose that is exactly zero means that the body is lost.
    pub is_lost_at_origin: bool,
}

/// Columns of a rotation.
#[derive(Clone, Debug)]
pub enum Rotation {
    /// The heading, rad.
    Heading(Column),
    /// Quaternion: x, y, z, w; absent parts are zero.
    Quaternion([Option<Column>; 4]),
    /// Angles about the body's own x, y and z axes, rad, one after the other in that order.
    Euler([Column; 3]),
    /// Rotation vector: the axis, as long as the angle, rad.
    Vector([Column; 3]),
}

impl Body {
    /// Returns the columns of the pose.
    pub fn columns(&self) -> impl Iterator<Item = &Column> {
        let rotation: Vec<&Column> = match &self.rotation {
            Rotation::Heading(column) => vec![column],
            Rotation::Quaternion(parts) => parts.iter().flatten().collect(),
            Rotation::Euler(angles) | Rotation::Vector(angles) => angles.iter().collect(),
        };
        self.position.iter().flatten().chain(rotation).chain(&self.residual)
    }

    /// Returns whether the poses are given in space, so that any axis may point upwards.
    pub fn is_spatial(&self) -> bool {
        self.position[2].is_some() && !matches!(self.rotation, Rotation::Heading(_))
    }

    /// Returns the pose in a line; `None` if the body was lost.
    ///
    /// # Errors
    /// When a cell is not a number.
    pub fn pose(&self, line: &Line) -> Result<Option<SpatialPose>> {
        let part = |column: &Option<Column>| column.as_ref().map_or(Ok(Some(0.0)), |column| column.value(line));
        let residual = self.residual.as_ref().map_or(Ok(None), |column| column.value(line))?;
        let mut place = [None; 3];
        for (part_of, column) in place.iter_mut().zip(&self.position) {
            *part_of = part(column)?;
        }
        let rotation = self.rotation.value(line)?;
        let ([Some(x), Some(y), Some(z)], Some(rotation)) = (place, rotation) else { return Ok(None) };
        let at_cm = DVec3::new(x, y, z);
        let is_lost = residual.is_some_and(|residual| residual < 0.0)
            || self.is_lost_at_origin && at_cm == DVec3::ZERO
            || !at_cm.is_finite();
        Ok((!is_lost).then_some(SpatialPose { at_cm, rotation }))
    }
}

impl Rotation {
    fn value(&self, line: &Line) -> Result<Option<DQuat>> {
        let all = |columns: &[Column; 3]| -> Result<Option<[f64; 3]>> {
            let [a, b, c] = [columns[0].value(line)?, columns[1].value(line)?, columns[2].value(line)?];
            Ok(a.zip(b).zip(c).map(|((a, b), c)| [a, b, c]))
        };
        let rotation = match self {
            Rotation::Heading(column) => column.value(line)?.map(|rad| about(DVec3::Z, rad)),
            Rotation::Quaternion(parts) => {
                let mut sum = [0.0; 4];
                for (value, column) in sum.iter_mut().zip(parts) {
                    let Some(part) = column.as_ref().map_or(Ok(Some(0.0)), |column| column.value(line))? else {
                        return Ok(None);
                    };
                    *value = part;
                }
                Some(DQuat::from_array(sum))
            }
            Rotation::Euler(angles) => {
                all(angles)?.map(|[x, y, z]| about(DVec3::X, x) * about(DVec3::Y, y) * about(DVec3::Z, z))
            }
            Rotation::Vector(parts) => all(parts)?.map(|parts| {
                let vector = DVec3::from_array(parts);
                vector.try_normalize().map_or(DQuat::IDENTITY, |axis| about(axis, vector.length()))
            }),
        };
        Ok(rotation.filter(|q| q.is_finite() && q.length_squared() > 1e-6).map(DQuat::normalize))
    }
}

/// Returns the rotation by an angle about an axis.
fn about(axis: DVec3, rad: f64) -> DQuat {
    let (sin, cos) = libm::sincos(rad / 2.0);
    DQuat::from_xyzw(axis.x * sin, axis.y * sin, axis.z * sin, cos)
}
