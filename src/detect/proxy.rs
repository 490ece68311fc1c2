//! A simplified stand-in for a fine shell: the map is found on it and carried back to all vertices.
//!
//! A map of some hundred eigenfunctions says nothing about detail finer than some percent of the shell, so a mesh of some
//! ten thousand vertices carries it as well as one of a million. Edges are collapsed by quadric errors (M. Garland,
//! P. S. Heckbert, "Surface Simplification Using Quadric Error Metrics", 1997; meshoptimizer, with its penalty on
//! uneven triangles), onto vertices of the shell and with its topology. Each vertex of the shell then has its place
//! inside a triangle of the proxy, whose corners' images say where the vertex's own image is.

use crate::base::threads;
use crate::detect::fixed_curve::dissolve_specks;
use crate::geometry::adjacency::nearest_seeds;
use crate::geometry::embedded_triangles::TrianglePoint;
use crate::geometry::surface_walk::SurfaceWalk;
use crate::geometry::vertex_map::VertexMap;
use crate::mesh::vector::{Vector, point_areas, squared_norm, subtract};
use crate::mesh::{NONE, Shell, SplitHubs};
use meshopt::{SimplifyOptions, VertexDataAdapter, simplify};
use std::sync::OnceLock;

/// Images of a triangle's corners that lie farther apart than this many times the triangle's longest edge are discontinuous
/// apart: its points follow the nearest corner alone.
const DISCONTINUOUS: f64 = 4.0;

/// A proxy that has more than this many times the vertices asked for is not worth having.
pub(super) const TOO_FINE: usize = 4;

/// Vertices that one thread takes at a time.
const CHUNK: usize = 4096;

/// The simplified shell, and where the vertices of the fine one lie on it.
#[derive(Debug)]
pub struct Proxy<'a> {
    /// The simplified shell, of unit area.
    pub shell: Shell,
    fine: &'a Shell,
    walk: SurfaceWalk<'a>,
    /// The fine shell's vertex at each of the proxy's vertices, rising.
    vertices: Vec<u32>,
    /// The proxy's vertex that is the fewest edges away from each of the fine shell's.
    nearest: Vec<u32>,
    /// Place of each of the fine shell's vertices on the proxy, once asked for.
    places: OnceLock<Vec<TrianglePoint>>,
    threads: usize,
}

impl<'a> Proxy<'a> {
    /// A proxy of about `wanted` vertices; `None` where the shell has no more than that, or where its topology
    /// allows none much coarser. It will use at most `threads` threads. O(vertices log vertices).
    pub fn new(fine: &'a Shell, wanted: usize, threads: usize) -> Option<Proxy<'a>> {
        Proxy::over(fine, &simplified(fine, wanted)?, wanted, threads)
    }

    /// The same of the triangles that [`simplified`] has left.
    pub fn over(fine: &'a Shell, triangles: &[[u32; 3]], wanted: usize, threads: usize) -> Option<Proxy<'a>> {
        let (shell, vertices) = fine.with_triangles(triangles);
        if vertices.len() > TOO_FINE * wanted || vertices.len() >= fine.points.len() || shell.scale <= 0.0 {
            return None;
        }
        let walk = SurfaceWalk::new(&fine.positions, &fine.triangles);
        let nearest = nearest_seeds(fine.positions.len(), &vertices, |vertex| walk.around(vertex));
        let on_shell = SurfaceWalk::new(&shell.positions, &shell.triangles);
        let linked = nearest_seeds(vertices.len(), &[0], |vertex| on_shell.around(vertex));
        if nearest.contains(&NONE) || linked.contains(&NONE) {
            return None;
        }
        Some(Proxy { shell, fine, walk, vertices, nearest, places: OnceLock::new(), threads })
    }

    /// The proxy's vertex that is the fewest edges away from each of the fine shell's.
    pub fn nearest_by_edges(&self) -> &[u32] {
        &self.nearest
    }

    /// The fine shell's vertex at each of the proxy's, rising.
    pub fn vertices(&self) -> &[u32] {
        &self.vertices
    }

    /// The proxy's vertex that weighs most at the place of a fine vertex.
    pub fn nearest_vertex(&self, fine_vertex: u32) -> u32 {
        self.heaviest_corner(&self.places()[fine_vertex as usize])
    }

    fn heaviest_corner(&self, place: &TrianglePoint) -> u32 {
        self.shell.triangles[place.triangle as usize][place.heaviest()]
    }

    fn places(&self) -> &[TrianglePoint] {
        let all = || (0..self.fine.positions.len() as u32).collect::<Vec<_>>();
        self.places.get_or_init(|| self.placed(&all()))
    }

    /// Where vertices of the fine shell lie on the proxy.
    fn placed(&self, fine_vertices: &[u32]) -> Vec<TrianglePoint> {
        let corner = |&vertex: &u32| self.fine.positions[vertex as usize];
        let corners: Vec<Vector> = self.vertices.iter().map(corner).collect();
        let walk = SurfaceWalk::new(&corners, &self.shell.triangles);
        let place = |vertex: &u32, _: Option<&TrianglePoint>| {
            walk.nearest(self.fine.positions[*vertex as usize], self.nearest[*vertex as usize]).1
        };
        in_chunks(fine_vertices, self.threads, place)
    }

    /// Values at the fine shell's vertices from those at the proxy's, linear inside its triangles.
    pub fn carry_values(&self, values: &[impl Copy + Into<f64>]) -> Vec<f64> {
        self.places().iter().map(|place| place.interpolate(&self.shell.triangles, values)).collect()
    }

    /// Images of the fine shell's vertices from those of the proxy's.
    ///
    /// Images of a triangle's corners are joined by straight lines; the nearest point of the fine shell is taken.
    pub fn carry_images(&self, images: &VertexMap) -> VertexMap {
        let image_points: Vec<Vector> = images.points.iter().map(|point| self.position(point)).collect();
        let image_of = |place: &TrianglePoint, previous: Option<&(u32, TrianglePoint)>| {
            let corners = self.shell.triangles[place.triangle as usize];
            let heaviest = self.heaviest_corner(place) as usize;
            let ends = corners.map(|corner| image_points[corner as usize]);
            let sources = corners.map(|corner| self.corner(corner));
            let discontinuous = longest(ends) > DISCONTINUOUS * DISCONTINUOUS * longest(sources);
            let goal = if discontinuous { image_points[heaviest] } else { weighted(ends, place.barycentric) };
            // Vertices that follow each other are often neighbours, and so are their images.
            let start = self.vertices[images.partners[heaviest] as usize];
            self.walk.nearest(goal, previous.map_or(start, |(near, _)| self.walk.nearer(goal, start, *near)))
        };
        let found = in_chunks(self.places(), self.threads, image_of);
        let (partners, points) = found.into_iter().unzip();
        VertexMap { partners, points }
    }

    /// The images of the proxy's vertices under a map that is known for the fine shell's: `partners` are vertices.
    pub fn restrict(&self, partners: &[u32]) -> VertexMap {
        let images: Vec<u32> = self.vertices.iter().map(|&vertex| partners[vertex as usize]).collect();
        let points = self.placed(&images);
        let heaviest = |point: &TrianglePoint| self.heaviest_corner(point);
        VertexMap { partners: points.iter().map(heaviest).collect(), points }
    }

    /// The odd function of the fine shell's vertices from that of the proxy's. Where neighbours have places apart, as in a
    /// crease, parts of the wrong sign may appear; small ones are dissolved.
    pub fn carry_odd(&self, odd: &[f64]) -> Vec<f64> {
        let mut carried = self.carry_values(odd);
        let mass = point_areas(&self.fine.positions, &self.fine.triangles);
        dissolve_specks(|vertex| self.walk.around(vertex as u32), &mass, &mut carried);
        carried
    }

    /// In the fine shell's coordinates.
    fn position(&self, point: &TrianglePoint) -> Vector {
        let corners = self.shell.triangles[point.triangle as usize];
        weighted(corners.map(|corner| self.corner(corner)), point.barycentric)
    }

    /// The same of a vertex of the proxy.
    fn corner(&self, vertex: u32) -> Vector {
        self.fine.positions[self.vertices[vertex as usize] as usize]
    }
}

/// Triangles over about `wanted` vertices of `fine`; `None` where it has no more than that.
pub fn simplified(fine: &Shell, wanted: usize) -> Option<Vec<[u32; 3]>> {
    if fine.points.len() <= wanted {
        return None;
    }
    let split = SplitHubs::new(&fine.positions, &fine.triangles);
    if split.as_ref().is_some_and(SplitHubs::has_fan) {
        return None;
    }
    let (positions, triangles) = match &split {
        Some(split) => (&split.positions, &split.triangles),
        None => (&fine.positions, &fine.triangles),
    };
    let coordinates = positions.iter().flatten();
    let bytes: Vec<u8> = coordinates.flat_map(|&value| (value as f32).to_ne_bytes()).collect();
    let vertices = VertexDataAdapter::new(&bytes, 3 * size_of::<f32>(), 0).ok()?;
    // A closed surface has about twice as many triangles as vertices; one with long boundaries has fewer, and keeps its share.
    let (closed, here) = (2 * wanted, fine.triangles.len());
    let kept = if closed < here { closed } else { here * wanted / fine.positions.len() };
    let left =
        simplify(triangles.as_flattened(), &vertices, 3 * kept, f32::MAX, SimplifyOptions::Regularize, None);
    let left = left.as_chunks().0;
    let triangles = split.map_or_else(|| left.to_vec(), |split| split.joined(left));
    (!triangles.is_empty()).then_some(triangles)
}

fn weighted(corners: [Vector; 3], weights: [f32; 3]) -> Vector {
    std::array::from_fn(|axis| (0..3).map(|c| f64::from(weights[c]) * corners[c][axis]).sum())
}

/// Squared length of a triangle's longest edge.
fn longest([a, b, c]: [Vector; 3]) -> f64 {
    squared_norm(subtract(a, b)).max(squared_norm(subtract(b, c))).max(squared_norm(subtract(c, a)))
}

/// `work` of all items, in order; it is told the result before, but at the start of a chunk.
fn in_chunks<T: Sync, R: Send>(
    items: &[T],
    threads: usize,
    work: impl Fn(&T, Option<&R>) -> R + Sync,
) -> Vec<R> {
    let done = threads::map(threads, items.chunks(CHUNK).collect(), |chunk| {
        let mut results = Vec::with_capacity(chunk.len());
        for item in chunk {
            let result = work(item, results.last());
            results.push(result);
        }
        results
    });
    done.into_iter().flatten().collect()
}
