//! The few operations on 3-vectors that the mesh's files share.

/// A position or direction.
pub type Vector = [f64; 3];

/// `a - b`.
pub fn subtract(a: Vector, b: Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// Cross product.
pub fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Scalar product.
pub fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Squared length.
pub fn squared_norm(a: Vector) -> f64 {
    dot(a, a)
}

/// The vector scaled to length 1; 0 stays 0.
pub fn unit(a: Vector) -> Vector {
    a.map(|x| x / squared_norm(a).sqrt().max(f64::MIN_POSITIVE))
}

/// The mean of some positions; 0 of none.
pub fn mean(positions: impl IntoIterator<Item = Vector>) -> Vector {
    let (mut sum, mut count) = ([0.0; 3], 0.0);
    for position in positions {
        (0..3).for_each(|axis| sum[axis] += position[axis]);
        count += 1.0;
    }
    sum.map(|value| value / f64::max(count, 1.0))
}

/// Of sorted values, each with its weight, the first at which this share of all the weight is reached; `None` of no values.
pub fn quantile(sorted: &[(f64, f64)], share: f64) -> Option<f64> {
    let total: f64 = sorted.iter().map(|&(_, weight)| weight).sum();
    let mut sum = 0.0;
    let reached = sorted.iter().find(|&&(_, weight)| {
        sum += weight;
        sum >= share * total
    });
    reached.or(sorted.last()).map(|&(value, _)| value)
}

/// Area of a triangle, exactly 0 where its corners are collinear to within rounding.
pub fn triangle_area(a: Vector, b: Vector, c: Vector) -> f64 {
    let (ab, ac, bc) = (subtract(b, a), subtract(c, a), subtract(c, b));
    let longest = squared_norm(ab).max(squared_norm(ac)).max(squared_norm(bc));
    let area = 0.5 * squared_norm(cross(ab, ac)).sqrt();
    if area <= 8.0 * f64::EPSILON * longest { 0.0 } else { area }
}

/// The area that each point stands for: a third of every triangle around it.
pub fn point_areas(positions: &[Vector], triangles: &[[u32; 3]]) -> Vec<f64> {
    let mut areas = vec![0.0; positions.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|point| positions[point as usize]);
        triangle.iter().for_each(|&point| areas[point as usize] += triangle_area(a, b, c) / 3.0);
    }
    areas
}

/// The sum of the normals of the triangles around each point, each as long as twice the area of its triangle.
pub fn summed_normals(positions: &[Vector], triangles: &[[u32; 3]]) -> Vec<Vector> {
    let mut normals = vec![[0.0; 3]; positions.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|point| positions[point as usize]);
        let normal = cross(subtract(b, a), subtract(c, a));
        for &point in triangle {
            (0..3).for_each(|axis| normals[point as usize][axis] += normal[axis]);
        }
    }
    normals
}
