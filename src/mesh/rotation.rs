//! Rotations and other 3 x 3 matrices that take directions to directions.

use super::vector::{Vector, cross, dot};

/// A 3 x 3 matrix by rows.
pub type Matrix = [[f64; 3]; 3];

/// `matrix * factor`.
pub fn scaled(matrix: Matrix, factor: f64) -> Matrix {
    matrix.map(|row| row.map(|value| value * factor))
}

/// `matrix * vector`.
pub fn turned(matrix: &Matrix, vector: Vector) -> Vector {
    matrix.map(|row| row[0] * vector[0] + row[1] * vector[1] + row[2] * vector[2])
}

/// `first * second`.
pub fn product(first: &Matrix, second: &Matrix) -> Matrix {
    first.map(|row| std::array::from_fn(|column| (0..3).map(|k| row[k] * second[k][column]).sum()))
}

/// The transpose.
pub fn transposed(matrix: &Matrix) -> Matrix {
    std::array::from_fn(|row| std::array::from_fn(|column| matrix[column][row]))
}

/// The inverse, by Cramer's rule; of a singular matrix, not finite.
pub fn inverse(matrix: &Matrix) -> Matrix {
    let [x, y, z] = *matrix;
    let columns = [cross(y, z), cross(z, x), cross(x, y)];
    scaled(transposed(&columns), 1.0 / dot(x, columns[0]))
}

/// Rotation about an axis through the origin by an angle in radians (Rodrigues' formula).
pub fn rotation(axis: Vector, angle: f64) -> Matrix {
    let length = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
    let [x, y, z] = axis.map(|coordinate| coordinate / length);
    let (s, c) = angle.sin_cos();
    let t = 1.0 - c;
    [
        [c + t * x * x, t * x * y - s * z, t * x * z + s * y],
        [t * x * y + s * z, c + t * y * y, t * y * z - s * x],
        [t * x * z - s * y, t * y * z + s * x, c + t * z * z],
    ]
}

/// The unit axis of a rotation and its angle, 0 to pi; any axis where the angle is 0.
pub fn axis_and_angle(rotation: &Matrix) -> (Vector, f64) {
    let [w, x, y, z] = unit_quaternion(rotation);
    let sine = (x * x + y * y + z * z).sqrt();
    if sine == 0.0 {
        return ([1.0, 0.0, 0.0], 0.0);
    }
    let sign = if w < 0.0 { -1.0 } else { 1.0 };
    ([x, y, z].map(|coordinate| sign * coordinate / sine), 2.0 * sine.atan2(w.abs()))
}

/// Orthonormal eigenvectors of a symmetric matrix.
pub fn principal_axes(matrix: Matrix) -> [Vector; 3] {
    let (_, vectors) = eigenvectors(matrix);
    transposed(&vectors)
}

/// The rotation R that maximises `trace(R^T matrix)`: the largest eigenvector of a 4 x 4 matrix (B. K. P. Horn, "Closed-form
/// solution of absolute orientation using unit quaternions", 1987).
pub fn nearest_rotation(matrix: &Matrix) -> Matrix {
    let [w, x, y, z] = unit_quaternion(matrix);
    [
        [w * w + x * x - y * y - z * z, 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), w * w - x * x + y * y - z * z, 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), w * w - x * x - y * y + z * z],
    ]
}

/// The quaternion, real part first, of the rotation nearest to a matrix.
fn unit_quaternion(matrix: &Matrix) -> [f64; 4] {
    let [[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]] = *matrix;
    let symmetric = [
        [xx + yy + zz, zy - yz, xz - zx, yx - xy],
        [zy - yz, xx - yy - zz, xy + yx, xz + zx],
        [xz - zx, xy + yx, yy - xx - zz, yz + zy],
        [yx - xy, xz + zx, yz + zy, zz - xx - yy],
    ];
    leading_eigenvector(symmetric)
}

/// Unit eigenvector of the largest eigenvalue of a symmetric matrix.
fn leading_eigenvector(matrix: [[f64; 4]; 4]) -> [f64; 4] {
    let (values, vectors) = eigenvectors(matrix);
    let largest = (1..4).fold(0, |best, i| if values[i] > values[best] { i } else { best });
    vectors.map(|row| row[largest])
}

/// Eigenvalues of a symmetric matrix and its orthonormal eigenvectors by columns, by cyclic Jacobi rotations.
pub fn eigenvectors<const N: usize>(mut matrix: [[f64; N]; N]) -> ([f64; N], [[f64; N]; N]) {
    let mut vectors: [[f64; N]; N] =
        std::array::from_fn(|i| std::array::from_fn(|j| if i == j { 1.0 } else { 0.0 }));
    let size = matrix.iter().flatten().fold(0.0f64, |largest, value| largest.max(value.abs()));
    for _ in 0..12 {
        let off: f64 =
            (0..N).flat_map(|i| (0..i).map(move |j| (i, j))).map(|(i, j)| matrix[i][j].abs()).sum();
        if off <= 1e-15 * size {
            break;
        }
        for p in 0..N - 1 {
            for q in p + 1..N {
                rotate(&mut matrix, &mut vectors, p, q);
            }
        }
    }
    (std::array::from_fn(|i| matrix[i][i]), vectors)
}

/// One Jacobi rotation that makes `matrix[p][q]` zero.
fn rotate<const N: usize>(matrix: &mut [[f64; N]; N], vectors: &mut [[f64; N]; N], p: usize, q: usize) {
    if matrix[p][q] == 0.0 {
        return;
    }
    let theta = (matrix[q][q] - matrix[p][p]) / (2.0 * matrix[p][q]);
    let tangent = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
    let cosine = 1.0 / (tangent * tangent + 1.0).sqrt();
    let sine = tangent * cosine;
    for row in matrix.iter_mut() {
        (row[p], row[q]) = (cosine * row[p] - sine * row[q], sine * row[p] + cosine * row[q]);
    }
    for k in 0..N {
        (matrix[p][k], matrix[q][k]) =
            (cosine * matrix[p][k] - sine * matrix[q][k], sine * matrix[p][k] + cosine * matrix[q][k]);
    }
    for row in vectors.iter_mut() {
        (row[p], row[q]) = (cosine * row[p] - sine * row[q], sine * row[p] + cosine * row[q]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rotation_is_its_own_nearest_one() {
        for (axis, angle) in [([1.0, 0.0, 0.0], 0.0), ([1.0, 2.0, 3.0], 1.0), ([0.3, -1.0, 0.1], 3.1)] {
            let expected = rotation(axis, angle);
            let found = nearest_rotation(&scaled(expected, 7.5));
            for (a, b) in found.as_flattened().iter().zip(expected.as_flattened()) {
                assert!((a - b).abs() < 1e-12, "{found:?} instead of {expected:?}");
            }
        }
    }

    #[test]
    fn a_rotation_has_its_axis_and_angle() {
        for (axis, angle) in [([0.0, 0.6, 0.8], 0.3), ([1.0, 0.0, 0.0], 2.9), ([0.48, -0.6, 0.64], 1e-3)] {
            let (found, turned) = axis_and_angle(&rotation(axis, angle));
            assert!((turned - angle).abs() < 1e-9, "{turned} instead of {angle}");
            assert!((0..3).all(|k| (found[k] - axis[k]).abs() < 1e-9), "{found:?} instead of {axis:?}");
            let (back, turned) = axis_and_angle(&rotation(axis, -angle));
            assert!((turned - angle).abs() < 1e-9 && (back[2] + axis[2]).abs() < 1e-9, "{back:?} {turned}");
        }
        assert_eq!(axis_and_angle(&rotation([0.0, 0.0, 1.0], 0.0)).1, 0.0);
    }

    #[test]
    fn a_matrix_times_its_inverse_is_the_identity() {
        let matrix = [[1.0, 2.0, -1.0], [0.5, -3.0, 0.2], [0.0, 1.0, 4.0]];
        let found = product(&matrix, &inverse(&matrix));
        for (row, column) in (0..9).map(|k| (k / 3, k % 3)) {
            let expected = f64::from(u8::from(row == column));
            assert!((found[row][column] - expected).abs() < 1e-12, "{found:?}");
        }
    }

    #[test]
    fn principal_axes_diagonalise() {
        let turn = rotation([1.0, 2.0, -1.0], 0.8);
        let diagonal = [[3.0, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, 1.0]];
        let symmetric = product(&turn, &product(&diagonal, &transposed(&turn)));
        let mut values: Vec<f64> = Vec::new();
        for axis in principal_axes(symmetric) {
            let image = turned(&symmetric, axis);
            let value: f64 = (0..3).map(|k| axis[k] * image[k]).sum();
            assert!((0..3).all(|k| (image[k] - value * axis[k]).abs() < 1e-12), "{axis:?}");
            values.push(value);
        }
        values.sort_by(f64::total_cmp);
        assert!([0.5, 1.0, 3.0].iter().zip(&values).all(|(a, b)| (a - b).abs() < 1e-12), "{values:?}");
    }

    #[test]
    fn edges_in_a_plane_give_the_rotation_of_the_plane() {
        let expected = rotation([1.0, -2.0, 0.5], 0.7);
        let edges = [[1.0, 0.0, 0.0], [0.3, 1.0, 0.0], [-1.0, 0.4, 0.0]];
        let mut covariance = Matrix::default();
        for edge in edges {
            let image = turned(&expected, edge);
            for row in 0..3 {
                for column in 0..3 {
                    covariance[row][column] += image[row] * edge[column];
                }
            }
        }
        let found = nearest_rotation(&covariance);
        for (a, b) in found.as_flattened().iter().zip(expected.as_flattened()) {
            assert!((a - b).abs() < 1e-12, "{found:?} instead of {expected:?}");
        }
    }
}
