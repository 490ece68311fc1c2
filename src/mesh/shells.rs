//! Shells: the connected components of the surface, each a small mesh of its own.

use super::edges::UnionFind;
use super::polygons::bucket;
use super::vector::{Vector, triangle_area};
use super::{Mesh, NONE};

/// Areas of shells, and moments, nearer to each other than this factor count as equal: those of twins are, but for rounding.
pub(super) const EQUAL: f64 = 1e-6;

/// One connected component, in numbering and scale of its own.
#[derive(Debug, Clone)]
pub struct Shell {
    /// The mesh's point of each local point, rising; [`NONE`] of what [fills holes](crate::detect::filled_holes).
    pub points: Vec<u32>,
    /// Positions of the local points, centred at their mean; the shell's own area is 1.
    pub positions: Vec<Vector>,
    /// Triangles over local points.
    pub triangles: Vec<[u32; 3]>,
    /// The mesh's triangle of each local triangle, rising; none of a simplified shell.
    pub triangle_of_local: Vec<u32>,
    /// Whether the triangles are consistently oriented.
    pub orientable: bool,
    /// Length in the shell's unit of one unit of the mesh's positions; the shell's share of the area
    /// is `1 / scale^2`. It is 0 for a shell without any area, whose positions stay in the mesh's unit.
    pub scale: f64,
}

impl Shell {
    /// The shell's share of the mesh's area, 0..=1.
    pub fn area(&self) -> f64 {
        if self.scale > 0.0 { (self.scale * self.scale).recip() } else { 0.0 }
    }
}

impl Shell {
    /// The local numbers of what is given for each point of the mesh, at the shell's points; `None` if any of it is not on the shell.
    pub fn numbered(&self, values: &[u32]) -> Option<Vec<u32>> {
        let local = |point: &u32| self.points.binary_search(point).ok().map(|local| local as u32);
        self.points.iter().map(|&point| local(&values[point as usize])).collect()
    }

    /// The same, centred and of unit area again after vertices or triangles were added.
    pub fn rescaled(mut self) -> Shell {
        centre(&mut self.positions);
        self.scale *= scale_to_unit_area(&mut self.positions, &self.triangles);
        self
    }

    /// The shell of other `triangles` over some of this one's points, and the local point here of each point there.
    pub fn with_triangles(&self, triangles: &[[u32; 3]]) -> (Shell, Vec<u32>) {
        let mut kept: Vec<u32> = triangles.as_flattened().to_vec();
        kept.sort_unstable();
        kept.dedup();
        let mut index = vec![NONE; self.points.len()];
        for (new, &old) in kept.iter().enumerate() {
            index[old as usize] = new as u32;
        }
        let triangles: Vec<[u32; 3]> = triangles.iter().map(|t| t.map(|old| index[old as usize])).collect();
        let mut positions: Vec<Vector> = kept.iter().map(|&old| self.positions[old as usize]).collect();
        centre(&mut positions);
        let scale = self.scale * scale_to_unit_area(&mut positions, &triangles);
        let points = kept.iter().map(|&old| self.points[old as usize]).collect();
        let shell = Shell {
            points,
            positions,
            triangles,
            triangle_of_local: Vec::new(),
            orientable: self.orientable,
            scale,
        };
        (shell, kept)
    }
}

/// Which shell each point belongs to, shells numbered by falling area, equal ones by their lowest points.
pub struct Partition {
    /// Shell of each point.
    pub shell_of_point: Vec<u32>,
    /// Number of shells.
    pub count: usize,
}

/// Splits points into shells: points are in one shell where a chain of triangles joins them.
pub fn partition(triangles: &[[u32; 3]], positions: &[Vector]) -> Partition {
    let mut sets = UnionFind::new(positions.len());
    for &[a, b, c] in triangles {
        sets.join(a, b);
        sets.join(b, c);
    }
    let mut area = vec![0.0; positions.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|point| positions[point as usize]);
        area[sets.find(triangle[0]) as usize] += triangle_area(a, b, c);
    }
    let points = positions.len() as u32;
    let mut roots: Vec<u32> = (0..points).filter(|&point| sets.find(point) == point).collect();
    roots.sort_by(|&a, &b| area[b as usize].total_cmp(&area[a as usize]));
    let are_equal = |a: &u32, b: &u32| area[*b as usize] >= (1.0 - EQUAL) * area[*a as usize];
    roots.chunk_by_mut(are_equal).for_each(<[u32]>::sort_unstable);
    let mut shell_of_root = vec![NONE; positions.len()];
    for (shell, &root) in roots.iter().enumerate() {
        shell_of_root[root as usize] = shell as u32;
    }
    let shell_of_point = (0..points).map(|point| shell_of_root[sets.find(point) as usize]).collect();
    Partition { shell_of_point, count: roots.len() }
}

impl Mesh {
    /// All shells, by falling area. O(mesh) for all together.
    pub fn shells(&self) -> Vec<Shell> {
        let (point_starts, points) = bucket(self.shell_of_point.iter().copied(), self.shell_count);
        let shell_of_triangle =
            self.triangles.iter().map(|triangle| self.shell_of_point[triangle[0] as usize]);
        let (triangle_starts, triangles) = bucket(shell_of_triangle, self.shell_count);
        let mut local_of_point = vec![NONE; self.positions.len()];
        (0..self.shell_count)
            .map(|shell| {
                let points = &points[point_starts[shell] as usize..point_starts[shell + 1] as usize];
                let triangles =
                    &triangles[triangle_starts[shell] as usize..triangle_starts[shell + 1] as usize];
                self.extract(shell, points, triangles, &mut local_of_point)
            })
            .collect()
    }

    fn extract(&self, shell: usize, points: &[u32], triangles: &[u32], local_of_point: &mut [u32]) -> Shell {
        for (local, &point) in points.iter().enumerate() {
            local_of_point[point as usize] = local as u32;
        }
        let local_triangles: Vec<[u32; 3]> = triangles
            .iter()
            .map(|&triangle| self.triangles[triangle as usize].map(|point| local_of_point[point as usize]))
            .collect();
        let orientable = self.shell_orientable[shell];
        Shell {
            triangle_of_local: triangles.to_vec(),
            ..self.shell_of(points.to_vec(), local_triangles, orientable)
        }
    }

    /// The shell of given `triangles` over some of the mesh's points, with their positions.
    pub fn shell_of(&self, points: Vec<u32>, triangles: Vec<[u32; 3]>, orientable: bool) -> Shell {
        let mut positions: Vec<Vector> = points.iter().map(|&point| self.positions[point as usize]).collect();
        centre(&mut positions);
        let scale = scale_to_unit_area(&mut positions, &triangles);
        Shell { points, positions, triangles, triangle_of_local: Vec::new(), orientable, scale }
    }
}

/// Moves the mean of `positions` to the origin and returns it.
pub fn centre(positions: &mut [Vector]) -> Vector {
    let count = positions.len() as f64;
    let mean = [0, 1, 2].map(|axis| positions.iter().map(|position| position[axis]).sum::<f64>() / count);
    for position in positions.iter_mut() {
        *position = [0, 1, 2].map(|axis| position[axis] - mean[axis]);
    }
    mean
}

/// Total area.
pub fn total_area(positions: &[Vector], triangles: &[[u32; 3]]) -> f64 {
    triangles
        .iter()
        .map(|triangle| triangle.map(|at| positions[at as usize]))
        .map(|[a, b, c]| triangle_area(a, b, c))
        .sum()
}

/// Scales `positions` so that the area is 1 and returns the factor; leaves them and returns 0 if there is no area.
fn scale_to_unit_area(positions: &mut [Vector], triangles: &[[u32; 3]]) -> f64 {
    let area = total_area(positions, triangles);
    if area <= 0.0 {
        return 0.0;
    }
    let scale = area.sqrt().recip();
    for position in positions.iter_mut() {
        *position = position.map(|coordinate| coordinate * scale);
    }
    scale
}
