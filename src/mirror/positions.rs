//! Symmetrises a shape in the pose it is in: one side takes the other's shape, each keeps its pose.
//!
//! The edges that a vertex should have are those around its mirror image, turned into its own frame
//! ([`frames`](super::frames)); positions that have these edges, and stray little from the old ones, solve a
//! screened Poisson equation (O. Sorkine et al., "Laplacian Surface Editing", 2004, section 3; the local
//! frames come from the map instead of an unknown transformation). Shape much smaller than the surface is
//! carried whole; what is as large as a limb's pose stays.

use super::Mirroring;
use super::frames::{Frames, images};
use crate::base::error::Result;
use crate::base::progress::Progress;
use crate::detect::correspondence::Symmetry;
use crate::mesh::rotation::turned;
use crate::mesh::vector::{Vector, subtract};
use crate::mesh::{Mesh, NONE, Shell};
use crate::spectral::laplacian::IntrinsicSurface;

/// How strongly old positions hold, against an eigenvalue of the Laplacian at unit area: shape of eigenvalue
/// `e` is carried to the share `e / (e + HOLD)`. The halves of a body have 10, a fist 1000.
const HOLD: f64 = 100.0;
/// The hold of vertices that must not move.
const FIXED: f64 = 1e9;

/// New positions of the caller's vertices, in the unit of `positions`.
///
/// `positions` has one entry per caller's vertex: those of the mesh, or of another pose of it. With one
/// side winning, that side and the fixed curve stay as they are. Cost: one sparse Cholesky factorisation.
///
/// # Errors
/// As [`Mirroring::shares`]; [`Error::Cancelled`](crate::Error::Cancelled); [`Error::Internal`](crate::Error::Internal) if the factorisation breaks down.
///
/// # Panics
/// If `positions` has not one entry per vertex.
pub fn symmetrize(
    mesh: &Mesh,
    symmetry: &Symmetry,
    positions: &[Vector],
    mirroring: &Mirroring,
    progress: &Progress,
) -> Result<Vec<Vector>> {
    assert_eq!(positions.len(), symmetry.partner.len());
    let shares = mirroring.shares(symmetry)?;
    progress.report("frames", 0.0)?;
    let frames = Frames::new(mesh, symmetry, positions);
    let edges = WantedEdges { mesh, frames, positions, image: images(mesh, symmetry, positions), shares };
    progress.report("positions", 0.3)?;
    let mut correction = vec![[0.0; 3]; mesh.positions.len()];
    for shell in mesh.shells() {
        edges.solve(&shell, &mut correction)?;
        progress.report("positions", 0.6)?;
    }
    let moved = |(vertex, position): (usize, &Vector)| match mesh.point_of_vertex[vertex] {
        NONE => *position,
        point => [0, 1, 2].map(|axis| position[axis] + correction[point as usize][axis]),
    };
    let moved = positions.iter().enumerate().map(moved).collect();
    progress.report("done", 1.0)?;
    Ok(moved)
}

/// The edges that the mirrored shape wants.
struct WantedEdges<'a> {
    mesh: &'a Mesh,
    frames: Frames,
    positions: &'a [Vector],
    image: Vec<Option<Vector>>,
    shares: Vec<f64>,
}

impl WantedEdges<'_> {
    fn share(&self, point: u32) -> f64 {
        self.shares[self.mesh.vertex_of_point[point as usize] as usize]
    }

    fn position(&self, point: u32) -> Vector {
        self.positions[self.mesh.vertex_of_point[point as usize] as usize]
    }

    /// How the edge between two points should change, 0 where either has no image or keeps its shape.
    fn change(&self, from: u32, to: u32) -> Vector {
        let share = self.share(from).max(self.share(to));
        let (Some(start), Some(end)) = (self.image[from as usize], self.image[to as usize]) else {
            return [0.0; 3];
        };
        let (edge, mirrored) = (subtract(self.position(to), self.position(from)), subtract(end, start));
        let (first, second) = (
            turned(&self.frames.turn[from as usize], mirrored),
            turned(&self.frames.turn[to as usize], mirrored),
        );
        [0, 1, 2].map(|axis| share * (0.5 * (first[axis] + second[axis]) - edge[axis]))
    }

    /// Adds the correction of one shell's points: `(L + hold) x = divergence of the changes`.
    fn solve(&self, shell: &Shell, correction: &mut [Vector]) -> Result<()> {
        let surface = IntrinsicSurface::new(shell);
        let hold =
            |(&point, mass): (&u32, &f64)| if self.share(point) > 0.0 { HOLD * mass } else { FIXED * mass };
        let diagonal: Vec<f64> = shell.points.iter().zip(&surface.lumped_mass).map(hold).collect();
        let divergence = |(i, &point): (usize, &u32)| {
            let mut sum = [0.0; 3];
            for (j, value) in surface.stiffness.row(i).filter(|(j, _)| *j != i) {
                let change = self.change(shell.points[j], point);
                (0..3).for_each(|axis| sum[axis] -= value * change[axis]);
            }
            sum
        };
        let right: Vec<Vector> = shell.points.iter().enumerate().map(divergence).collect();
        let found = surface.solve(&diagonal, &right)?;
        for (i, &point) in shell.points.iter().enumerate().filter(|(_, point)| self.share(**point) > 0.0) {
            correction[point as usize] = found[i];
        }
        Ok(())
    }
}
