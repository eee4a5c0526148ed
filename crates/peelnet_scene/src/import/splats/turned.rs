//! Splats in another space: nodes of glTF files turn, scale and mirror them.

use super::Splat;
use glam::{DMat3, DVec3, Mat3, Mat4, Quat, Vec3, Vec4};
use std::f32::consts::TAU;

/// How far the columns of a matrix may be from orthogonal and equally long, as a part of their length, to count as a rotation and a scale.
const UNIFORM: f32 = 1e-5;

/// A transform of splats: space, covariance and the directions they are seen from.
pub(in crate::import) struct Turn {
    matrix: Mat4,
    linear: Mat3,
    /// The rotation, without a mirror image, and the scale, if that is all that the matrix does.
    uniform: Option<(Quat, f32)>,
    /// New coefficients of harmonics from the old ones, a row for each; `None` if they stay.
    harmonics: Option<Box<[[f32; 16]; 16]>>,
}

impl Turn {
    /// `None` of a matrix that has no inverse.
    pub fn new(matrix: Mat4) -> Option<Self> {
        let linear = Mat3::from_mat4(matrix);
        let turn = orthogonal(linear)?;
        let scale = linear.determinant().abs().cbrt();
        let difference = (linear - turn * scale).to_cols_array();
        let is_uniform = difference.iter().all(|x| x.abs() <= UNIFORM * scale);
        // A covariance is the same in all mirror images through the centre.
        let proper = turn * turn.determinant().signum();
        let is_turned = turn.abs_diff_eq(Mat3::IDENTITY, 1e-6);
        Some(Self {
            matrix,
            linear,
            uniform: is_uniform.then(|| (Quat::from_mat3(&proper), scale)),
            harmonics: (!is_turned).then(|| turned_harmonics(turn)),
        })
    }

    /// Moves a splat and its harmonics. Under a matrix that shears or stretches, harmonics follow its nearest rotation.
    pub fn apply(&self, splat: &mut Splat, harmonics: &mut [[f32; 3]]) {
        splat.center = self.matrix.transform_point3(splat.center);
        if let Some(rotation) = splat.rotation.try_normalize() {
            let rotation = Quat::from_vec4(rotation);
            (splat.scale, splat.rotation) = match self.uniform {
                Some((turn, scale)) => (splat.scale * scale, Vec4::from(turn * rotation)),
                None => {
                    let axes = Mat3::from_quat(rotation) * Mat3::from_diagonal(splat.scale);
                    ellipsoid((self.linear * axes).as_dmat3())
                }
            };
        }
        let Some(matrix) = &self.harmonics else {
            return;
        };
        let old = harmonics.to_vec();
        for (new, row) in harmonics.iter_mut().zip(matrix.iter()) {
            *new = [0, 1, 2].map(|k| old.iter().zip(row).map(|(old, m)| old[k] * m).sum());
        }
    }
}

/// The rotation or mirror image that is nearest to a matrix: its polar factor, by Newton's method (Higham 1986).
fn orthogonal(matrix: Mat3) -> Option<Mat3> {
    let mut turn = matrix.as_dmat3();
    let size = turn.determinant().abs().cbrt();
    if !(size > 0.0 && size.is_finite()) {
        return None;
    }
    turn *= 1.0 / size;
    for _ in 0..60 {
        turn = (turn + turn.inverse().transpose()) * 0.5;
    }
    turn.is_finite().then(|| turn.as_mat3())
}

/// Standard deviations and rotation of an ellipsoid, the image of the unit sphere: columns are turned into each other until they are orthogonal
/// (Hestenes 1958).
fn ellipsoid(matrix: DMat3) -> (Vec3, Vec4) {
    let mut axes: [DVec3; 3] = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
    for _ in 0..16 {
        for [i, j] in [[0, 1], [0, 2], [1, 2]] {
            let (a, b) = (axes[i], axes[j]);
            let product = a.dot(b);
            if product == 0.0 {
                continue;
            }
            let ratio = (b.length_squared() - a.length_squared()) / (2.0 * product);
            let tangent = ratio.signum() / (ratio.abs() + (1.0 + ratio * ratio).sqrt());
            let cosine = 1.0 / (1.0 + tangent * tangent).sqrt();
            let sine = cosine * tangent;
            (axes[i], axes[j]) = (a * cosine - b * sine, a * sine + b * cosine);
        }
    }
    axes.sort_by(|a, b| b.length_squared().total_cmp(&a.length_squared()));
    let scale = Vec3::from_array(axes.map(|axis| axis.length() as f32));
    let x = axes[0].normalize_or(DVec3::X);
    let y = axes[1] - x * axes[1].dot(x);
    let y = y.normalize_or(x.any_orthonormal_vector());
    let frame = DMat3::from_cols(x, y, x.cross(y));
    (scale, Vec4::from(Quat::from_mat3(&frame.as_mat3())))
}

/// Harmonics of a unit direction, in the order and with the signs of the INRIA files.
pub(super) fn harmonics(d: Vec3) -> [f32; 16] {
    let Vec3 { x, y, z } = d;
    let [xx, yy, zz] = [x * x, y * y, z * z];
    [
        0.282_094_8,
        -0.488_602_5 * y,
        0.488_602_5 * z,
        -0.488_602_5 * x,
        1.092_548_4 * x * y,
        -1.092_548_4 * y * z,
        0.315_391_57 * (2.0 * zz - xx - yy),
        -1.092_548_4 * x * z,
        0.546_274_2 * (xx - yy),
        -0.590_043_6 * y * (3.0 * xx - yy),
        2.890_611_4 * x * y * z,
        -0.457_045_8 * y * (4.0 * zz - xx - yy),
        0.373_176_34 * z * (2.0 * zz - 3.0 * xx - 3.0 * yy),
        -0.457_045_8 * x * (4.0 * zz - xx - yy),
        1.445_305_7 * z * (xx - yy),
        -0.590_043_6 * x * (xx - 3.0 * yy),
    ]
}

/// The matrix from coefficients of harmonics to those of the same function turned: integrals of products of harmonics over all directions. Sums over
/// four heights (Gauss and Legendre) and eight angles are exact for polynomials of degree 7, and the products have 6.
fn turned_harmonics(turn: Mat3) -> Box<[[f32; 16]; 16]> {
    const HEIGHTS: [[f32; 2]; 4] = [
        [-0.861_136_3, 0.347_854_85],
        [-0.339_981_05, 0.652_145_15],
        [0.339_981_05, 0.652_145_15],
        [0.861_136_3, 0.347_854_85],
    ];
    let back = turn.transpose();
    let mut matrix = Box::new([[0.0; 16]; 16]);
    for [z, weight] in HEIGHTS {
        for k in 0..8 {
            let (sin, cos) = (TAU * k as f32 / 8.0).sin_cos();
            let ring = (1.0 - z * z).sqrt();
            let d = Vec3::new(ring * cos, ring * sin, z);
            let (new, old) = (harmonics(d), harmonics((back * d).normalize()));
            for (row, new) in matrix.iter_mut().zip(new) {
                for (element, old) in row.iter_mut().zip(old) {
                    *element += weight * TAU / 8.0 * new * old;
                }
            }
        }
    }
    matrix
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A turned splat looks from a turned direction as it did, and its covariance is turned; also mirrored, and stretched.
    #[test]
    fn turned_splats_look_the_same() {
        let old = Splat {
            center: Vec3::new(1.0, 2.0, 3.0),
            scale: Vec3::new(0.3, 0.1, 0.0),
            rotation: Vec4::new(0.1, -0.2, 0.3, 0.9),
            opacity: 0.5,
        };
        let turn = Mat3::from_quat(Quat::from_xyzw(0.5, -0.1, 0.3, 0.2).normalize());
        let mirror = Mat3::from_diagonal(Vec3::new(1.0, -1.0, 1.0));
        let stretch = Mat3::from_diagonal(Vec3::new(2.0, 1.0, 0.5));
        let some: Vec<[f32; 3]> = (0..16u8)
            .map(|k| [f32::from(k), 1.0, -0.1 * f32::from(k * k)])
            .collect();
        for (linear, is_exact) in [
            (Mat3::IDENTITY, true),
            (turn * 2.0, true),
            (turn * mirror * 0.1, true),
            (stretch * turn, false),
        ] {
            let matrix = Mat4::from_mat3(linear);
            let (mut new, mut coefficients) = (old, some.clone());
            Turn::new(matrix)
                .expect("has an inverse")
                .apply(&mut new, &mut coefficients);
            let covariance = |splat: &Splat, by: Mat3| {
                let rotation = Quat::from_vec4(splat.rotation.normalize());
                let axes = by * Mat3::from_quat(rotation) * Mat3::from_diagonal(splat.scale);
                axes * axes.transpose()
            };
            let [got, want] = [covariance(&new, Mat3::IDENTITY), covariance(&old, linear)];
            assert!(got.abs_diff_eq(want, 1e-6), "{got} {want}");
            assert!((new.center - linear * old.center).length() < 1e-5);
            let color = |c: &[[f32; 3]], d: Vec3| {
                let terms = c.iter().zip(harmonics(d.normalize()));
                terms.fold(Vec3::ZERO, |sum, (c, h)| sum + Vec3::from_array(*c) * h)
            };
            for d in [Vec3::X, Vec3::NEG_Y, Vec3::new(1.0, -2.0, 0.5)] {
                let [got, want] = [color(&coefficients, linear * d), color(&some, d)];
                assert!(!is_exact || (got - want).length() < 1e-3, "{got} {want}");
            }
        }
        assert!(Turn::new(Mat4::from_scale(Vec3::new(1.0, 0.0, 1.0))).is_none());
    }
}
