//! The simplified mesh on which earlier maps are judged, and what of it stays while the shape is deformed.
//!
//! [`crate::detect()`] makes one, results carry it, and [`crate::detect_again`] passes it on: its choice of
//! vertices and triangles, the analysis of its connectivity, eigenfunctions to start from and samples are those of the
//! shape that it was made of. Some 1 MB, at most 4, and 4 bytes for each vertex of the mesh.

use crate::base::effort::Plan;
use crate::base::error::Result;
use crate::base::options::Options;
use crate::base::progress::Progress;
use crate::detect::proxy::{Proxy, TOO_FINE};
use crate::detect::shell_symmetry::{COARSE_SIZE, PreparedShell};
use crate::geometry::surface_walk::SurfaceWalk;
use crate::geometry::vertex_map::VertexMap;
use crate::mesh::vector::Vector;
use crate::mesh::{Mesh, NONE, Shell};
use crate::spectral::eigenbasis::{Eigenbasis, Start};
use crate::spectral::laplacian::IntrinsicSurface;
use crate::spectral::sampling::Samples;
use std::sync::OnceLock;

/// The size that the options leave of it: as many vertices as the small plan's proxy has, which then need not be simplified again, as many eigenfunctions as a
/// search's maps have when their signatures are compared, and as many samples as candidates are scored on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Size {
    vertices: usize,
    eigenfunctions: usize,
    samples: usize,
}

impl Size {
    fn of(options: &Options) -> Size {
        let (small, stated) = (Plan::small(), |count: usize| if count == 0 { usize::MAX } else { count });
        Size {
            vertices: stated(options.proxy_vertices).min(small.proxy_vertices),
            eigenfunctions: stated(options.eigenfunctions).min(COARSE_SIZE),
            samples: stated(options.samples).min(small.samples),
        }
    }
}

/// A coarse mesh over some points of the largest shell, or the whole shell if it is coarse itself.
#[derive(Debug)]
pub struct JudgingMesh {
    size: Size,
    /// [`Mesh::connectivity_hash`] of the mesh.
    connectivity: u64,
    /// The mesh's point of each vertex.
    points: Vec<u32>,
    triangles: Vec<[u32; 3]>,
    orientable: bool,
    /// The vertex that is the fewest edges away from each of the mesh's points; [`NONE`] on other shells.
    nearest: Vec<u32>,
    /// Empty until it is solved, and on meshes so small that they need no start.
    kept: OnceLock<Kept>,
}

/// What else is kept of another shape.
#[derive(Debug)]
struct Kept {
    start: Start,
    /// Vertices.
    samples: Vec<u32>,
}

impl JudgingMesh {
    /// Simplifies `shell`, the largest, or rather its `proxy` if there is one; with the vertices of that which are left, unless all
    /// are. A point of the shell is the point `number` of `mesh`. O(vertices log vertices).
    fn simplified(
        mesh: &Mesh,
        number: impl Fn(u32) -> u32,
        shell: &Shell,
        proxy: Option<&Proxy>,
        options: &Options,
    ) -> (JudgingMesh, Option<Vec<u32>>) {
        let size = Size::of(options);
        let solved = proxy.map_or(shell, |proxy| &proxy.shell);
        let coarse = Proxy::new(solved, size.vertices, options.threads);
        let all = || (0..solved.points.len() as u32).collect::<Vec<_>>();
        let of_solved = coarse.as_ref().map_or_else(all, |coarse| coarse.nearest_by_edges().to_vec());
        let mut nearest = vec![NONE; mesh.positions.len()];
        for (local, &point) in shell.points.iter().enumerate() {
            let on_solved = proxy.map_or(local as u32, |proxy| proxy.nearest_by_edges()[local]);
            nearest[number(point) as usize] = of_solved[on_solved as usize];
        }
        let Shell { points, triangles, orientable, .. } =
            coarse.as_ref().map_or(solved, |coarse| &coarse.shell);
        let points = points.iter().map(|&point| number(point)).collect();
        let (triangles, orientable) = (triangles.clone(), *orientable);
        let vertices = coarse.as_ref().map(|coarse| coarse.vertices().to_vec());
        let connectivity = mesh.connectivity_hash();
        (
            JudgingMesh { size, connectivity, points, triangles, orientable, nearest, kept: OnceLock::new() },
            vertices,
        )
    }

    /// Of the largest shell of `mesh`.
    pub(crate) fn new(mesh: &Mesh, options: &Options) -> JudgingMesh {
        JudgingMesh::simplified(mesh, |point| point, &mesh.shells()[0], None, options).0
    }

    /// Of the `shell`, the largest of a mesh, that has been `solved`, itself or its `proxy`. That mesh's points are `given_points` of the
    /// `given` one. `None` if too few eigenfunctions are known to start from.
    pub(crate) fn of_solved(
        given: &Mesh,
        given_points: &[u32],
        shell: &Shell,
        proxy: Option<&Proxy>,
        solved: &PreparedShell,
        options: &Options,
    ) -> Option<JudgingMesh> {
        let eigenfunctions = Size::of(options).eigenfunctions;
        if solved.basis.count() < Start::functions(eigenfunctions) {
            return None;
        }
        let number = |point: u32| given_points[point as usize];
        let (own, vertices) = JudgingMesh::simplified(given, number, shell, proxy, options);
        match vertices {
            Some(vertices) => drop(own.keep(&solved.basis.at(&vertices, Start::functions(eigenfunctions)))),
            None => {
                let sampled = solved.sampled();
                own.keep_from(&solved.basis, sampled[..own.size.samples.min(sampled.len())].to_vec());
            }
        }
        Some(own)
    }

    /// Whether it was made of `mesh` or another shape of it, with options that want the same. O(corners).
    ///
    /// The polygons must be the same, after welding and repairs, and the same shell the largest.
    pub(crate) fn fits(&self, mesh: &Mesh, options: &Options) -> bool {
        self.size == Size::of(options)
            && self.nearest.len() == mesh.positions.len()
            && mesh.shell_of_point[self.points[0] as usize] == 0
            && self.connectivity == mesh.connectivity_hash()
    }

    /// It in the shape of `mesh`, which it must fit.
    pub(crate) fn shell(&self, mesh: &Mesh) -> Shell {
        mesh.shell_of(self.points.clone(), self.triangles.clone(), self.orientable)
    }

    /// Solves one shape. The first one leaves what others start from.
    ///
    /// # Errors
    /// As [`Eigenbasis::new`].
    pub(crate) fn solve(
        &self,
        surface: IntrinsicSurface,
        options: &Options,
        progress: &Progress,
    ) -> Result<PreparedShell> {
        let (count, threads) = (self.size.eigenfunctions, options.threads);
        if let Some(kept) = self.kept.get() {
            let basis = Eigenbasis::continued(&surface, &kept.start, count, threads, progress)?;
            let samples = Samples::at(&basis, kept.samples.clone());
            return PreparedShell::new(surface, basis, samples);
        }
        let more = Eigenbasis::new(&surface, Start::functions(count), threads, progress)?;
        let basis = more.truncated(count);
        let samples = self.keep(&more);
        let samples = Samples::at(&basis, samples);
        PreparedShell::new(surface, basis, samples)
    }

    /// Chooses samples by the `basis` of one shape. They are kept with it, if other shapes can start from it.
    fn keep(&self, basis: &Eigenbasis) -> Vec<u32> {
        let samples = Samples::farthest(basis, self.size.samples).vertices;
        self.keep_from(basis, samples.clone());
        samples
    }

    /// The same with samples that are chosen already.
    fn keep_from(&self, basis: &Eigenbasis, samples: Vec<u32>) {
        // A shell that cannot be simplified keeps nothing to start from.
        let small = self.points.len() <= TOO_FINE * Plan::small().proxy_vertices;
        if let Some(start) = Start::new(basis, self.size.eigenfunctions).filter(|_| small) {
            self.kept.get_or_init(|| Kept { start, samples });
        }
    }

    /// Images of the vertices under a map that is known for the vertices of `mesh`; `None` if it leads off the shell.
    pub(crate) fn images(&self, mesh: &Mesh, partners: &[i32]) -> Option<VertexMap> {
        let partner = |point: usize| -> Option<u32> {
            let partner = partners[mesh.vertex_of_point[point] as usize];
            let point = *mesh.point_of_vertex.get(usize::try_from(partner).ok()?)?;
            (*self.nearest.get(point as usize)? != NONE).then_some(point)
        };
        let mut on_shell = (0..self.nearest.len()).filter(|&point| self.nearest[point] != NONE);
        if on_shell.any(|point| partner(point).is_none()) {
            return None;
        }
        let corners: Vec<Vector> = self.points.iter().map(|&point| mesh.positions[point as usize]).collect();
        let walk = SurfaceWalk::new(&corners, &self.triangles);
        let place = |&point: &u32| {
            let image = partner(point as usize)? as usize;
            Some(walk.nearest(mesh.positions[image], self.nearest[image]).1)
        };
        let points = self.points.iter().map(place).collect::<Option<Vec<_>>>()?;
        let partners = points.iter().map(|point| self.triangles[point.triangle as usize][point.heaviest()]);
        Some(VertexMap { partners: partners.collect(), points })
    }
}
