//! The shells of a character, joined where they touch: the surface on which its symmetry is sought.
//!
//! A body made of parts has no shell that speaks for it: the largest may be a hat. Its parts hang on each other, in any pose, where they touch. So large
//! shells are joined by triangles across their contacts, some at each, the more the larger it is, and what comes of it is searched like any other surface. A contact much smaller than
//! the others of its shells, as of a hand on a hip, joins nothing. Triangles that join are no part of the result.

use crate::connectivity::automorphism::{ShellColours, shell_colours};
use crate::detect::contact_place::ContactPlace;
use crate::detect::proxy::Proxy;
use crate::detect::{seen_twins, twins};
use crate::geometry::shortest_paths::EdgeLengths;
use crate::geometry::surface_grid::{Place, places};
use crate::geometry::surface_walk::SurfaceWalk;
use crate::mesh::vector::{Vector, squared_norm, subtract};
use crate::mesh::{Mesh, NONE, Shell};
use crate::spectral::twin_parts::MOST_PARTS;
use rstar::RTree;
use rstar::primitives::GeomWithData;
use std::collections::{HashMap, HashSet};

/// A largest shell with at least this share of the area speaks for the whole mesh.
const MAJORITY: f64 = 0.8;
/// Smaller shells, by their share of the area, are carried along: of a swarm of these, as hair and feathers, it is hard to say which is whose twin.
pub const LEAST: f64 = 0.008;
/// Distance of the places on surfaces that are compared, in sqrt(area).
const SPACING: f64 = 0.01;
/// Shells that are nearer to each other than this, in sqrt(area), touch.
pub const TOUCHING: f64 = 0.015;
/// Distance of the triangles that join, in sqrt(area), and most of them at one contact.
const APART: f64 = 0.03;
const MOST_JOINTS: usize = 32;
/// Vertices of the surface along which distances are measured.
const COARSE: usize = 16_000;
/// Part of a shell's largest contact that another of its contacts must have.
const SMALLEST_CONTACT: f64 = 0.5;

/// Shells of which the first is that on which the symmetry is sought.
pub struct JoinedShells {
    /// The joined shell, or the largest one, and all that are not joined, by falling area.
    pub shells: Vec<Shell>,
    /// Triangles over the first shell's points that join its parts.
    pub joints: Vec<[u32; 3]>,
    /// The mesh's shells that are joined, each with its likely twin.
    pub twins: Vec<[u32; 2]>,
}

impl JoinedShells {
    /// The largest shell alone.
    pub fn alone(shells: Vec<Shell>) -> JoinedShells {
        JoinedShells { shells, joints: Vec::new(), twins: Vec::new() }
    }

    /// Of all shells of the mesh: the large ones that have a likely twin or are their own, joined, where none holds four fifths of the area; else the largest shell alone. With vertices'
    /// `partner` in a map, shells are joined by the twins that this sees ([`seen_twins::pairs`]); the largest shell alone where it sees no others than it has.
    ///
    /// O(area / spacing^2 x log + shells x mesh).
    pub fn new(mesh: &Mesh, partner: Option<&[i32]>) -> JoinedShells {
        let shells = mesh.shells();
        let large = |shell: &&Shell| shell.area() >= LEAST;
        let members = shells.iter().take_while(large).take(MOST_PARTS).count();
        if members < 2 || shells[0].area() >= MAJORITY {
            return JoinedShells::alone(shells);
        }
        let contacts = Contacts::between(mesh, &shells[..members]);
        let layers = contacts.layers();
        let mut known: HashMap<[usize; 2], bool> = layers.iter().map(|&pair| (pair, false)).collect();
        if let Some(partner) = partner {
            let seen = seen_twins::pairs(mesh, &shells[..members], &contacts.middles(mesh), partner);
            if seen.is_empty() {
                return JoinedShells::alone(shells);
            }
            let others = seen
                .iter()
                .flatten()
                .flat_map(|&own| (0..members).map(move |other| [own.min(other), own.max(other)]));
            known.extend(others.map(|pair| (pair, false)));
            known.extend(seen.into_iter().map(|pair| (pair, true)));
        }
        let distances = contacts.distances(mesh, &shells[..members]);
        let colours = shell_colours(mesh);
        let colours: Vec<&ShellColours> = colours.iter().take(members).collect();
        let mut twins = twins::likely(&colours, &shells[..members], &distances, &known);
        contacts.add_hubs(&mut twins);
        twins::pair_own(&mut twins, &twins::lookalikes(&colours, &shells[..members]));
        drop_layers(&mut twins, &layers);
        if twins.iter().filter(|&&twin| twin != NONE).count() < 2 {
            return JoinedShells::alone(shells);
        }
        let is_joined = |shell: usize| shell < members && twins[shell] != NONE;
        let joints = contacts.joints(&twins);
        let (joined, rest): (Vec<_>, Vec<_>) =
            shells.into_iter().enumerate().partition(|(index, _)| is_joined(*index));
        let joined: Vec<Shell> = joined.into_iter().map(|(_, shell)| shell).collect();
        let whole = union(mesh, &joined.iter().collect::<Vec<_>>());
        let local = |point: u32| whole.points.binary_search(&point).expect("a point of it") as u32;
        let joints = joints.into_iter().map(|triangle| triangle.map(local)).collect();
        let rest = rest.into_iter().map(|(_, shell)| shell);
        let twins =
            twins.into_iter().zip(0..).filter(|(twin, _)| *twin != NONE).map(|(twin, own)| [own, twin]);
        JoinedShells { shells: [whole].into_iter().chain(rest).collect(), joints, twins: twins.collect() }
    }
}

/// One shell of all points and triangles of several.
pub fn union(mesh: &Mesh, shells: &[&Shell]) -> Shell {
    let mut points: Vec<u32> = shells.iter().flat_map(|shell| &shell.points).copied().collect();
    points.sort_unstable();
    let mut local = vec![NONE; mesh.positions.len()];
    points.iter().enumerate().for_each(|(index, &point)| local[point as usize] = index as u32);
    let mut of_mesh: Vec<u32> = shells.iter().flat_map(|shell| &shell.triangle_of_local).copied().collect();
    of_mesh.sort_unstable();
    let corners = |&triangle: &u32| mesh.triangles[triangle as usize].map(|point| local[point as usize]);
    let triangles = of_mesh.iter().map(corners).collect();
    let orientable = shells.iter().all(|shell| shell.orientable);
    Shell { triangle_of_local: of_mesh, ..mesh.shell_of(points, triangles, orientable) }
}

/// Leaves no twin to a shell that is its own, where it lies on one that has its twin elsewhere.
fn drop_layers(twins: &mut [u32], layers: &HashSet<[usize; 2]>) {
    let is_own = |shell: usize| twins[shell] as usize == shell;
    let is_elsewhere = |shell: usize| twins[shell] != NONE && !is_own(shell);
    let both = layers.iter().flat_map(|&[a, b]| [[a, b], [b, a]]);
    let dropped: Vec<usize> =
        both.filter(|&[own, other]| is_own(own) && is_elsewhere(other)).map(|[own, _]| own).collect();
    dropped.into_iter().for_each(|own| twins[own] = NONE);
}

/// Where two shells come near each other.
struct Contact {
    shells: [usize; 2],
    distance: f64,
    joints: Vec<[u32; 3]>,
}

/// Where shells come near each other.
struct Contacts {
    /// For each shell.
    places: Vec<Vec<Place>>,
    trees: Vec<RTree<GeomWithData<Vector, usize>>>,
    /// Those of shells that touch.
    touching: Vec<Contact>,
}

impl Contacts {
    fn between(mesh: &Mesh, shells: &[Shell]) -> Contacts {
        let on_shell = |shell: &Shell| {
            let triangles =
                shell.triangle_of_local.iter().map(|&triangle| &mesh.triangles[triangle as usize]);
            places(&mesh.positions, triangles, SPACING)
        };
        let places: Vec<Vec<Place>> = shells.iter().map(on_shell).collect();
        let tree = |places: &Vec<Place>| {
            RTree::bulk_load(
                places.iter().enumerate().map(|(i, place)| GeomWithData::new(place.at, i)).collect(),
            )
        };
        let trees = places.iter().map(tree).collect();
        let mut contacts = Contacts { places, trees, touching: Vec::new() };
        for second in 1..shells.len() {
            for first in 0..second {
                if !contacts.may_touch(first, second) {
                    continue;
                }
                let contact = contact([first, second], &contacts.places, &contacts.trees);
                if contact.distance <= TOUCHING {
                    contacts.touching.push(contact);
                }
            }
        }
        contacts
    }

    /// Whether boxes around two shells are near each other.
    fn may_touch(&self, first: usize, second: usize) -> bool {
        let [a, b] = [first, second].map(|shell| self.trees[shell].root().envelope());
        (0..3).all(|axis| {
            a.lower()[axis] <= b.upper()[axis] + TOUCHING && b.lower()[axis] <= a.upper()[axis] + TOUCHING
        })
    }

    /// Where each two that touch do.
    fn middles(&self, mesh: &Mesh) -> Vec<ContactPlace> {
        let at = |point: u32| mesh.positions[point as usize];
        let place = |contact: &Contact| {
            let ends = contact.joints.iter().flat_map(|joint| [at(joint[0]), at(joint[1])]);
            ContactPlace::new(contact.shells, &Vec::from_iter(ends))
        };
        self.touching.iter().map(place).collect()
    }

    /// Distances of shells from each other along their surface, row by row: the mean over the vertices of both.
    fn distances(&self, mesh: &Mesh, shells: &[Shell]) -> Vec<f64> {
        let count = shells.len();
        let mut whole = union(mesh, &shells.iter().collect::<Vec<_>>());
        let points = whole.points.clone();
        let local = |point: u32| points.binary_search(&point).expect("a point of it") as u32;
        let all: Vec<u32> = (0..count as u32).collect();
        whole.triangles.extend(self.joints(&all).into_iter().map(|triangle| triangle.map(local)));
        let proxy = Proxy::new(&whole, COARSE, 1);
        let Shell { positions, triangles, .. } = proxy.as_ref().map_or(&whole, |proxy| &proxy.shell);
        let edges = EdgeLengths::of_walk(&SurfaceWalk::new(positions, triangles), positions);
        let place = |&point: &u32| match &proxy {
            Some(proxy) => proxy.nearest_by_edges()[local(point) as usize],
            None => local(point),
        };
        let part = |shell: &Shell| shell.points.iter().map(place).collect();
        let parts: Vec<Vec<u32>> = shells.iter().map(part).collect();
        let mut distances = vec![0.0; count * count];
        for (own, part) in parts.iter().enumerate() {
            let from = edges.distances(part);
            for (other, part) in parts.iter().enumerate() {
                let sum: f64 = part.iter().map(|&vertex| from[vertex as usize]).sum();
                let mean = 0.5 * sum / part.len() as f64;
                distances[own * count + other] += mean;
                distances[other * count + own] += mean;
            }
        }
        distances
    }

    /// Joints of each shell's largest contact with another one `among` some.
    fn largest(&self, among: impl Fn(usize) -> bool) -> Vec<usize> {
        let mut largest = vec![0; self.places.len()];
        for contact in self.touching.iter().filter(|contact| contact.shells.iter().all(|&shell| among(shell)))
        {
            for shell in contact.shells {
                largest[shell] = largest[shell].max(contact.joints.len());
            }
        }
        largest
    }

    /// Makes shells without a twin their own if they touch twins mostly in pairs, as a trunk touches both arms.
    fn add_hubs(&self, twins: &mut [u32]) {
        let touching = self.pairs();
        let touch = |a: usize, b: usize| touching.contains(&[a.min(b), a.max(b)]);
        let alone = (0..twins.len()).filter(|&own| twins[own] == NONE);
        let is_hub = |&own: &usize| {
            let swaps = |&other: &usize| twins[other] != NONE && twins[other] as usize != other;
            let (both, one): (Vec<usize>, Vec<usize>) = (0..twins.len())
                .filter(swaps)
                .filter(|&other| touch(own, other))
                .partition(|&other| touch(own, twins[other] as usize));
            both.len() > one.len()
        };
        let hubs: Vec<usize> = alone.filter(is_hub).collect();
        hubs.into_iter().for_each(|own| twins[own] = own as u32);
    }

    /// Pairs of shells in one place: skin and what fits it tightly, or a copy beside its original. Their twins are elsewhere.
    fn layers(&self) -> HashSet<[usize; 2]> {
        let lies_on = |own: usize, other: usize| {
            // Mostly it does not, and a few places say so.
            let mut left = TOUCHING * self.places[own].len() as f64;
            self.places[own].iter().all(|place| {
                let near = self.trees[other].nearest_neighbor(place.at).expect("a shell has places");
                left -= squared_norm(subtract(place.at, *near.geom())).sqrt();
                left > 0.0
            })
        };
        self.pairs().into_iter().filter(|&[a, b]| lies_on(a, b) && lies_on(b, a)).collect()
    }

    /// Pairs of shells that touch.
    fn pairs(&self) -> HashSet<[usize; 2]> {
        self.touching.iter().map(|contact| contact.shells).collect()
    }

    /// Triangles over the mesh's points that make one surface of the shells that have a twin, where the twins of two that touch do, too.
    fn joints(&self, twins: &[u32]) -> Vec<[u32; 3]> {
        let is_joined = |shell: usize| twins[shell] != NONE;
        let touching = self.pairs();
        let is_kept = |contact: &Contact| {
            let [a, b] = contact.shells.map(|shell| twins[shell] as usize);
            touching.contains(&[a.min(b), a.max(b)])
        };
        let shells: Vec<usize> = (0..self.places.len()).filter(|&shell| is_joined(shell)).collect();
        let largest = self.largest(is_joined);
        let mut group: Vec<usize> = (0..self.places.len()).collect();
        let mut joined = Vec::new();
        let mut join = |contact: &Contact, group: &mut Vec<usize>| {
            let [from, to] = contact.shells.map(|shell| group[shell]);
            joined.extend(&contact.joints);
            group.iter_mut().filter(|own| **own == from).for_each(|own| *own = to);
        };
        for contact in self.touching.iter().filter(|contact| is_kept(contact)) {
            let least = contact.shells.map(|shell| SMALLEST_CONTACT * largest[shell] as f64);
            if contact.joints.len() as f64 >= least[0].min(least[1]) {
                join(contact, &mut group);
            }
        }
        // What is still apart, by its nearest places.
        let pairs = shells.iter().flat_map(|&a| shells.iter().map(move |&b| [a, b]));
        let apart = pairs.filter(|[a, b]| a < b && group[*a] != group[*b]);
        let contacts = apart.map(|pair| contact(pair, &self.places, &self.trees));
        let mut contacts: Vec<Contact> = contacts.collect();
        contacts.sort_by(|a, b| a.distance.total_cmp(&b.distance));
        for contact in &contacts {
            let [a, b] = contact.shells;
            if group[a] != group[b] {
                join(contact, &mut group);
            }
        }
        joined
    }
}

/// The nearest places of two shells, and the triangles there.
fn contact(
    shells: [usize; 2],
    places: &[Vec<Place>],
    trees: &[RTree<GeomWithData<Vector, usize>>],
) -> Contact {
    let [first, second] = shells;
    let mut near: Vec<(f64, usize, usize)> = Vec::new();
    let mut reach = f64::INFINITY;
    for (index, place) in places[first].iter().enumerate() {
        let leaf = trees[second].nearest_neighbor(place.at).expect("a shell has places");
        let distance = squared_norm(subtract(place.at, *leaf.geom())).sqrt();
        if distance <= reach {
            near.push((distance, index, leaf.data));
            reach = reach.min(distance + SPACING);
        }
    }
    near.retain(|(distance, ..)| *distance <= reach);
    near.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let (mut taken, mut joints): (Vec<Vector>, Vec<[u32; 3]>) = (Vec::new(), Vec::new());
    for &(_, a, b) in &near {
        let (a, b) = (places[first][a], places[second][b]);
        let is_far = |other: &Vector| squared_norm(subtract(a.at, *other)) >= APART * APART;
        if joints.len() < MOST_JOINTS && taken.iter().all(is_far) {
            taken.push(a.at);
            joints.push([a.corners[0], b.corners[0], b.corners[1]]);
        }
    }
    Contact { shells, distance: near.first().map_or(f64::INFINITY, |near| near.0), joints }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_trunk_between_twins_is_its_own_and_what_one_of_them_holds_is_not() {
        // A trunk, two arms that touch it, a rod that one of them holds, and a bag on the trunk.
        let touching = [[0, 1], [0, 2], [1, 3], [0, 4]];
        let touching = touching.map(|shells| Contact { shells, distance: 0.0, joints: Vec::new() });
        let contacts = Contacts { places: Vec::new(), trees: Vec::new(), touching: touching.into() };
        let mut twins = [NONE, 2, 1, NONE, NONE];
        contacts.add_hubs(&mut twins);
        assert_eq!(twins, [0, 2, 1, NONE, NONE]);
    }

    #[test]
    fn what_lies_on_an_arm_is_not_its_own_and_what_lies_on_a_trunk_may_be() {
        // A trunk, two arms, and what lies on each of the first two.
        let mut twins = [0, 2, 1, 3, 4];
        drop_layers(&mut twins, &HashSet::from([[0, 3], [1, 4]]));
        assert_eq!(twins, [0, 2, 1, 3, NONE]);
    }
}
