//! A frame in which any mesh has coordinates within -1..=1, whatever its unit and position.

use super::vector::Vector;

/// Maps the caller's positions to local ones, without overflow or underflow.
#[derive(Debug, Clone, Copy)]
pub struct Frame {
    /// A power of two that brings extreme coordinates into the safe range; 1 for ordinary ones.
    factor: f64,
    /// Middle of the bounding box, times `factor`.
    middle: Vector,
    /// Half of the longest side of the bounding box, times `factor`; 1 if the box is a point.
    half_extent: f64,
}

impl Frame {
    /// The frame of the vertices that `used` lists (at least one).
    pub fn of(used: impl Iterator<Item = u32> + Clone, positions: &[Vector]) -> Frame {
        let points = used.map(|vertex| positions[vertex as usize]);
        let largest =
            points.clone().flatten().fold(0.0, |largest: f64, coordinate| largest.max(coordinate.abs()));
        let factor = match largest {
            1e150.. => 2f64.powi(-600),
            1e-150.. => 1.0,
            _ => 2f64.powi(600),
        };
        let mut low = [f64::INFINITY; 3];
        let mut high = [f64::NEG_INFINITY; 3];
        for point in points {
            for axis in 0..3 {
                low[axis] = low[axis].min(point[axis] * factor);
                high[axis] = high[axis].max(point[axis] * factor);
            }
        }
        let middle = [0, 1, 2].map(|axis| 0.5 * (low[axis] + high[axis]));
        let half_extent = (0..3).map(|axis| 0.5 * (high[axis] - low[axis])).fold(0.0, f64::max);
        Frame { factor, middle, half_extent: if half_extent > 0.0 { half_extent } else { 1.0 } }
    }

    /// Local position.
    pub fn localise(&self, position: Vector) -> Vector {
        [0, 1, 2].map(|axis| (position[axis] * self.factor - self.middle[axis]) / self.half_extent)
    }

    /// The caller's position of a local one.
    pub fn globalise(&self, local: Vector) -> Vector {
        [0, 1, 2].map(|axis| (self.middle[axis] + local[axis] * self.half_extent) / self.factor)
    }

    /// The caller's length of a local one; the largest number if it would overflow.
    pub fn global_length(&self, local: f64) -> f64 {
        (local * self.half_extent / self.factor).min(f64::MAX)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extreme_coordinates_become_ordinary() {
        for scale in [f64::MIN_POSITIVE / 1024.0, 1e-200, 1e-9, 1.0, 1e9, 1e200, f64::MAX] {
            let positions = [[-scale, 0.0, scale], [scale, scale, 0.0]];
            let frame = Frame::of(0..2, &positions);
            assert_eq!(frame.localise(positions[0]), [-1.0, -0.5, 0.5]);
            assert_eq!(frame.globalise([1.0, 0.5, -0.5]), positions[1]);
            assert!((frame.global_length(0.5) / scale - 0.5).abs() < 1e-12);
        }
    }
}
