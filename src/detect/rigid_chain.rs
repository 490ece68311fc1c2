//! Whole shells that have kept their shape, one after the other along the chain in which they hang on each other.
//!
//! What is round, as a head under a hat, lies on itself in many turns, and a thin neck says little of them to a map of eigenfunctions. Where it touches
//! what is settled before it says how it is turned. Shells that change places say best which side is which, so the chain starts from one of these.

use crate::base::error::Result;
use crate::base::progress::Progress;
use crate::base::symmetry_kind::SymmetryKind;
use crate::base::threads;
use crate::detect::assembly::PointMap;
use crate::geometry::embedded_triangles::TrianglePoint;
use crate::geometry::vertex_map::VertexMap;
use crate::mesh::vector::{Vector, subtract};
use crate::mesh::{Mesh, NONE, Shell};
use crate::refine::rigid_parts;
use std::collections::BTreeSet;

/// Shares of the surface of shells whose own form is asked how they are turned: the least, and the most, since larger ones are bodies, which a pose bends.
const LEAST: f64 = 0.001;
const MOST: f64 = 0.5;

/// Pairs of points where two shells touch, each both ways.
#[derive(Default)]
pub struct RigidChain {
    contacts: Vec<[u32; 2]>,
}

/// The shells of a mesh in their order along the chain.
struct Links<'a> {
    mesh: &'a Mesh,
    shells: &'a [Shell],
    contacts: &'a [[u32; 2]],
    /// How many shells are between each and the first of the chain.
    depths: Vec<usize>,
}

impl RigidChain {
    /// That of a shell whose parts `joints` join.
    pub fn new(joined: &Shell, joints: &[[u32; 3]]) -> RigidChain {
        let point = |local: u32| joined.points[local as usize];
        let both = |&[a, b, _]: &[u32; 3]| [[point(a), point(b)], [point(b), point(a)]];
        RigidChain { contacts: joints.iter().flat_map(both).collect() }
    }

    /// Replaces images of shells that are not settled yet, and that a rigid motion puts onto the shell to which most of their points go. Says whether there was any.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`].
    pub fn settle(
        &self,
        mesh: &Mesh,
        map: &mut PointMap,
        kind: SymmetryKind,
        threads: usize,
        progress: &Progress,
    ) -> Result<bool> {
        if mesh.shell_count < 2 {
            return Ok(false);
        }
        progress.report("whole shells", 0.96)?;
        let (token, shells) = (progress.token(), mesh.shells());
        let depths = self.depths(mesh, &shells, map);
        let links = Links { mesh, shells: &shells, contacts: &self.contacts, depths };
        let mut is_moved = false;
        for depth in 0..=links.depths.iter().copied().max().unwrap_or(0) {
            let own: Vec<usize> = (0..shells.len()).filter(|&own| links.depths[own] == depth).collect();
            let fit = |own: usize| token.check().map(|()| links.fit(map, own, kind));
            let found: Result<Vec<_>> = threads::map(threads, own.clone(), fit).into_iter().collect();
            for (own, found) in own.into_iter().zip(found?) {
                if let Some((target, images)) = found {
                    map.move_shell(mesh, &shells[own], &shells[target], &images, own == target);
                    is_moved = true;
                }
            }
        }
        Ok(is_moved)
    }

    /// How many shells are between each and the largest that changes places with another; 0 of what does not hang on that.
    fn depths(&self, mesh: &Mesh, shells: &[Shell], map: &PointMap) -> Vec<usize> {
        let shell_of = |point: u32| mesh.shell_of_point[point as usize] as usize;
        let mut depths = vec![None; shells.len()];
        // Shells come by falling area.
        let hanging: BTreeSet<usize> = self.contacts.iter().map(|&[a, _]| shell_of(a)).collect();
        let swaps = |own: &usize| partner(mesh, shells, map, *own).is_some_and(|target| target != *own);
        let mut now: Vec<usize> = hanging.into_iter().find(swaps).into_iter().collect();
        for depth in 0.. {
            now.retain(|&own| depths[own].is_none());
            if now.is_empty() {
                break;
            }
            now.iter().for_each(|&own| depths[own] = Some(depth));
            let beside = self.contacts.iter().filter(|[a, _]| depths[shell_of(*a)] == Some(depth));
            now = beside.map(|&[_, b]| shell_of(b)).collect();
        }
        depths.into_iter().map(|depth| depth.unwrap_or(0)).collect()
    }
}

/// The shell to which most points of a shell go; `None` if it is settled, too small or too large.
fn partner(mesh: &Mesh, shells: &[Shell], map: &PointMap, own: usize) -> Option<usize> {
    if !(LEAST..MOST).contains(&shells[own].area()) {
        return None;
    }
    let is_open = |&&point: &&u32| {
        let point = point as usize;
        map.partner[point] != NONE && !map.settled[point] && !map.exact[point]
    };
    let mut counts = vec![0; shells.len()];
    for &point in shells[own].points.iter().filter(is_open) {
        counts[mesh.shell_of_point[map.partner[point as usize] as usize] as usize] += 1;
    }
    counts.iter().position(|&count| 2 * count > shells[own].points.len())
}

impl Links<'_> {
    /// The partner of a shell, and its images there by a rigid motion.
    fn fit(&self, map: &PointMap, own: usize, kind: SymmetryKind) -> Option<(usize, VertexMap)> {
        let (mesh, shell) = (self.mesh, &self.shells[own]);
        let number = partner(mesh, self.shells, map, own)?;
        let target = &self.shells[number];
        let on_target = |&point: &u32| {
            let image = map.image[point as usize];
            let triangle = target.triangle_of_local.binary_search(&image.triangle).ok()?;
            (map.partner[point as usize] != NONE)
                .then_some(TrianglePoint { triangle: triangle as u32, ..image })
        };
        let images: Vec<Option<TrianglePoint>> = shell.points.iter().map(on_target).collect();
        let shell_of = |point: u32| mesh.shell_of_point[point as usize] as usize;
        let is_settled = |&&[a, b]: &&[u32; 2]| {
            shell_of(a) == own
                && self.depths[shell_of(b)] < self.depths[own]
                && map.partner[b as usize] != NONE
        };
        let origin = mesh.positions[target.points[0] as usize];
        let goal = |&[a, b]: &[u32; 2]| {
            let image = map.image[b as usize].interpolate_vectors(&mesh.triangles, &mesh.positions);
            let away = subtract(image, origin);
            let goal: Vector = std::array::from_fn(|j| target.positions[0][j] + target.scale * away[j]);
            (shell.points.binary_search(&a).expect("a point of it") as u32, goal)
        };
        let contacts: Vec<(u32, Vector)> = self.contacts.iter().filter(is_settled).map(goal).collect();
        rigid_parts::fit_whole_shell(shell, target, &images, &contacts, kind).map(|images| (number, images))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::limits::Limits;
    use crate::mesh::PolygonMesh;

    /// A block, and a smaller one on each side of it. A bit of a corner's number says on which side of an axis it is.
    fn blocks() -> Mesh {
        let bit = |corner: u32, axis: u32| f64::from(corner >> axis & 1) - 0.5;
        let block = |x: f64, [w, d, h]: [f64; 3]| {
            (0..8).map(move |corner| [x + w * bit(corner, 0), d * bit(corner, 1), h * bit(corner, 2)])
        };
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let arm = [0.8, 0.8, 0.8];
        let polygons = PolygonMesh {
            positions: block(0.0, [1.0, 1.0, 1.2]).chain(block(-1.0, arm)).chain(block(1.0, arm)).collect(),
            face_offsets: (0..=18).map(|face| 4 * face).collect(),
            face_vertices: (0..3)
                .flat_map(|block| faces.as_flattened().iter().map(move |corner| 8 * block + corner))
                .collect(),
        };
        Mesh::new(&polygons, &Limits::default()).expect("a usable mesh")
    }

    #[test]
    fn what_lies_on_itself_in_two_ways_follows_what_changes_places() {
        let mesh = blocks();
        let shells = mesh.shells();
        let settled = |contacts: Vec<[u32; 2]>| {
            let mut map = PointMap::empty(&mesh);
            // The arms change places, the middle is mirrored to its back.
            for (own, target, axes) in [(0, 0, 2), (1, 2, 1), (2, 1, 1)] {
                let partners = (0..8).map(|corner| corner ^ axes).collect();
                let images = VertexMap::at_vertices(&shells[target].triangles, partners);
                map.insert(&shells[own], &shells[target], &images, &[1.0; 8]);
            }
            let chain = RigidChain { contacts };
            chain
                .settle(&mesh, &mut map, SymmetryKind::Reflection, 1, &Progress::default())
                .expect("an answer");
            (0..8).map(|corner| map.partner[corner]).collect::<Vec<u32>>()
        };
        let onto = |axes: u32| (0..8).map(|corner| corner ^ axes).collect::<Vec<u32>>();
        assert_eq!(settled(Vec::new()), onto(2));
        // The middle's left side touches the left arm's right one.
        let touching = (0..4u32).map(|k| 2 * k).flat_map(|left| {
            let arm = 8 + (left ^ 1);
            [[left, arm], [arm, left]]
        });
        assert_eq!(settled(touching.collect()), onto(1));
    }
}
