//! Rotations and other 3 x 3 matrices that take directions to directions.

use super::vector::Vector;

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

/// The rotation R that maximises `trace(R^T matrix)`: the largest eigenvector of a 4 x 4 matrix (B. K. P. Horn, "Closed-form
/// solution of absolute orientation using unit quaternions", 1987).
pub fn nearest_rotation(matrix: &Matrix) -> Matrix {
    let [[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]] = *matrix;
    let symmetric = [
        [xx + yy + zz, zy - yz, xz - zx, yx - xy],
        [zy - yz, xx - yy - zz, xy + yx, xz + zx],
        [xz - zx, xy + yx, yy - xx - zz, yz + zy],
        [yx - xy, xz + zx, yz + zy, zz - xx - yy],
    ];
    let [w, x, y, z] = leading_eigenvector(symmetric);
    [
        [w * w + x * x - y * y - z * z, 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), w * w - x * x + y * y - z * z, 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), w * w - x * x - y * y + z * z],
    ]
}

/// Unit eigenvector of the largest eigenvalue of a symmetric matrix, by cyclic Jacobi rotations.
fn leading_eigenvector(mut matrix: [[f64; 4]; 4]) -> [f64; 4] {
    let mut vectors: [[f64; 4]; 4] =
        std::array::from_fn(|i| std::array::from_fn(|j| if i == j { 1.0 } else { 0.0 }));
    let size = matrix.iter().flatten().fold(0.0f64, |largest, value| largest.max(value.abs()));
    for _ in 0..12 {
        let off: f64 =
            (0..4).flat_map(|i| (0..i).map(move |j| (i, j))).map(|(i, j)| matrix[i][j].abs()).sum();
        if off <= 1e-15 * size {
            break;
        }
        for p in 0..3 {
            for q in p + 1..4 {
                rotate(&mut matrix, &mut vectors, p, q);
            }
        }
    }
    let largest = (1..4).fold(0, |best, i| if matrix[i][i] > matrix[best][best] { i } else { best });
    std::array::from_fn(|row| vectors[row][largest])
}

/// One Jacobi rotation that makes `matrix[p][q]` zero.
fn rotate(matrix: &mut [[f64; 4]; 4], vectors: &mut [[f64; 4]; 4], p: usize, q: usize) {
    if matrix[p][q] == 0.0 {
        return;
    }
    let theta = (matrix[q][q] - matrix[p][p]) / (2.0 * matrix[p][q]);
    let tangent = theta.signum() / (theta.abs() + theta.hypot(1.0));
    let cosine = 1.0 / tangent.hypot(1.0);
    let sine = tangent * cosine;
    for row in matrix.iter_mut() {
        (row[p], row[q]) = (cosine * row[p] - sine * row[q], sine * row[p] + cosine * row[q]);
    }
    for k in 0..4 {
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

    /// Rotation about an axis through the origin by Rodrigues' formula.
    fn rotation(axis: Vector, angle: f64) -> Matrix {
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
