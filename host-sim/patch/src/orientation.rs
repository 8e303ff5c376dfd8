//! Orientations in the forms of model files, turned about the vertical.

/// A rotation matrix, by rows.
pub type Rotation = [[f64; 3]; 3];

/// No rotation.
pub const IDENTITY: Rotation = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Returns the rotation about an axis, 0 to 2.
pub fn about(axis: usize, angle_rad: f64) -> Rotation {
    let (sin, cos) = (libm::sin(angle_rad), libm::cos(angle_rad));
    let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut rotation = IDENTITY;
    (rotation[j][j], rotation[j][k], rotation[k][j], rotation[k][k]) = (cos, -sin, sin, cos);
    rotation
}

/// Returns the product of two rotations.
pub fn times(a: &Rotation, b: &Rotation) -> Rotation {
    let mut product = [[0.0; 3]; 3];
    for (i, row) in product.iter_mut().enumerate() {
        for (j, entry) in row.iter_mut().enumerate() {
            *entry = (0..3).map(|k| a[i][k] * b[k][j]).sum();
        }
    }
    product
}

/// Returns the inverse.
pub fn transposed(r: &Rotation) -> Rotation {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| r[j][i]))
}

/// Returns the direction of one of the axes, 0 to 2, of the rotated frame.
pub fn axis(r: &Rotation, index: usize) -> [f64; 3] {
    [0, 1, 2].map(|i| r[i][index])
}

/// Three axes of rotations that follow one another, such as `xyz`; in capitals about fixed axes, as in MJCF.
#[derive(Clone, Copy, Debug)]
pub struct Sequence {
    axes: [usize; 3],
    is_fixed: bool,
}

impl Sequence {
    /// Roll, pitch and yaw of URDF and SDF: about the fixed axes x, y and z.
    pub const ROLL_PITCH_YAW: Sequence = Sequence { axes: [0, 1, 2], is_fixed: true };

    /// Reads a sequence of three different axes.
    pub fn parse(text: &str) -> Option<Self> {
        let is_fixed = text.chars().all(|c| c.is_ascii_uppercase());
        let axes: Vec<usize> = text.to_lowercase().chars().filter_map(|c| "xyz".find(c)).collect();
        let axes: [usize; 3] = axes.try_into().ok()?;
        let is_different = axes[0] != axes[1] && axes[1] != axes[2] && axes[0] != axes[2];
        let is_mixed = !is_fixed && text.chars().any(|c| c.is_ascii_uppercase());
        (is_different && !is_mixed && text.len() == 3).then_some(Sequence { axes, is_fixed })
    }

    /// Returns the rotation by three angles.
    pub fn rotation(&self, angles_rad: [f64; 3]) -> Rotation {
        let [a, b, c] = [0, 1, 2].map(|i| about(self.axes[i], angles_rad[i]));
        if self.is_fixed { times(&c, &times(&b, &a)) } else { times(&a, &times(&b, &c)) }
    }

    /// Returns the three angles of a rotation.
    pub fn angles_rad(&self, r: &Rotation) -> [f64; 3] {
        // About fixed axes it is the reverse sequence about moving ones.
        let [i, j, k] = if self.is_fixed { [self.axes[2], self.axes[1], self.axes[0]] } else { self.axes };
        let sign = if (i + 1) % 3 == j { 1.0 } else { -1.0 };
        let b = libm::asin((sign * r[i][k]).clamp(-1.0, 1.0));
        let is_locked = r[i][k].abs() > 1.0 - 1e-12;
        let (a, c) = if is_locked {
            (libm::atan2(sign * r[k][j], r[j][j]), 0.0)
        } else {
            (libm::atan2(-sign * r[j][k], r[k][k]), libm::atan2(-sign * r[i][j], r[i][i]))
        };
        if self.is_fixed { [c, b, a] } else { [a, b, c] }
    }
}

/// Returns the rotation of a quaternion, w first.
pub fn of_quaternion(q: [f64; 4]) -> Rotation {
    let length = q.iter().map(|x| x * x).sum::<f64>().sqrt();
    let [w, x, y, z] = q.map(|x| x / length);
    [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ]
}

/// Returns a quaternion turned to the left about the vertical, w first.
pub fn turned_quaternion(q: [f64; 4], yaw_rad: f64) -> [f64; 4] {
    let (s, c) = (libm::sin(yaw_rad / 2.0), libm::cos(yaw_rad / 2.0));
    let [w, x, y, z] = q;
    [c * w - s * z, c * x - s * y, c * y + s * x, c * z + s * w]
}

/// Returns the quaternion of a rotation about an axis of any length, w first.
pub fn quaternion_about(axis: [f64; 3], angle_rad: f64) -> [f64; 4] {
    let length = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
    let s = if length > 0.0 { libm::sin(angle_rad / 2.0) / length } else { 0.0 };
    [libm::cos(angle_rad / 2.0), s * axis[0], s * axis[1], s * axis[2]]
}

/// Returns axis and angle of a quaternion; about z if it does not turn.
pub fn axis_and_angle(q: [f64; 4]) -> ([f64; 3], f64) {
    let [w, x, y, z] = if q[0] < 0.0 { q.map(|x| -x) } else { q };
    let s = (x * x + y * y + z * z).sqrt();
    if s < 1e-15 { ([0.0, 0.0, 1.0], 0.0) } else { ([x / s, y / s, z / s], 2.0 * libm::atan2(s, w)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_same(a: &Rotation, b: &Rotation) {
        let off = (0..9).map(|i| (a[i / 3][i % 3] - b[i / 3][i % 3]).abs()).fold(0.0, f64::max);
        assert!(off < 1e-9, "{a:?} {b:?}");
    }

    #[test]
    fn angles_of_every_sequence_are_read_back() {
        for name in ["xyz", "xzy", "yxz", "yzx", "zxy", "zyx", "XYZ", "ZYX", "YXZ"] {
            let sequence = Sequence::parse(name).expect("three axes");
            for angles in [[0.1, 0.2, 0.3], [-2.0, 1.2, 3.0], [0.0, std::f64::consts::FRAC_PI_2, 0.4], [0.0; 3]] {
                let rotation = sequence.rotation(angles);
                assert_same(&rotation, &sequence.rotation(sequence.angles_rad(&rotation)));
            }
        }
        assert!(["zxz", "xy", "xyZ", "abc"].iter().all(|name| Sequence::parse(name).is_none()));
    }

    #[test]
    fn quaternions_turn_as_matrices_do() {
        let q = quaternion_about([1.0, 2.0, 0.5], 0.8);
        assert_same(&of_quaternion(turned_quaternion(q, 0.3)), &times(&about(2, 0.3), &of_quaternion(q)));
        let (axis, angle_rad) = axis_and_angle(q);
        assert_same(&of_quaternion(quaternion_about(axis, angle_rad)), &of_quaternion(q));
    }
}
