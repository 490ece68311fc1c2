//! How whole shells lie on their partners, all of a character together.
//!
//! What is round, as a head under a hat, lies on itself in many ways, and a thin neck says little of them to a map of eigenfunctions. Others say more: shells that touch each other stay
//! together, and what hangs on a shell goes to what hangs on its partner. So the ways are the labels of a random field on the graph of contacts, whose least energy is
//! sought by belief propagation (J. Pearl, "Probabilistic reasoning in intelligent systems", 1988). No contact counts more than a limit, since some mislead.

use crate::base::error::Result;
use crate::base::progress::Progress;
use crate::base::symmetry_kind::SymmetryKind;
use crate::base::threads;
use crate::detect::assembly::PointMap;
use crate::detect::companions::AREA_TOLERANCE;
use crate::detect::contact_place::ContactPlace;
use crate::detect::joined_shells::{JoinedShells, TOUCHING};
use crate::geometry::embedded_triangles::TrianglePoint;
use crate::geometry::surface_walk::SurfaceWalk;
use crate::mesh::vector::{Vector, mean, squared_norm, subtract};
use crate::mesh::{Mesh, NONE, Shell};
use crate::refine::rigid_parts::{Hint, WholeShell};

/// Shares of the surface of shells whose own form is asked how they are turned: the least, and the most, since larger ones are bodies, which a pose bends.
const LEAST: f64 = 0.001;
const MOST: f64 = 0.5;
/// Of what more than so many on a partner are like, as hair, it is hard to say where it goes.
const SWARM: usize = 6;
/// Places around a contact, which tell of turns, in sqrt(area) of the smaller shell from its middle.
const AROUND: f64 = 0.3;
/// Messages along each contact.
const MESSAGES: usize = 40;

/// What tells how shells lie on their partners.
pub struct ContactGraph {
    contacts: Vec<ContactPlace>,
    /// Shells that are carried along, by those on which they hang, the smallest first.
    hung: Vec<Vec<Hung>>,
    /// The likely twin of each shell, or [`NONE`].
    twins: Vec<u32>,
}

/// A shell that hangs on another: where it touches that and its middle, and the natural logarithm of its area.
struct Hung {
    places: [Vector; 2],
    size: f64,
}

/// A whole shell that is not settled yet, and its partner.
struct Node {
    own: usize,
    target: usize,
    shell: WholeShell,
}

/// A mesh whose shells are put where they belong.
struct Scene<'a> {
    mesh: &'a Mesh,
    shells: Vec<Shell>,
    kind: SymmetryKind,
}

impl ContactGraph {
    /// Shells of which all but the first hang on the vertices of that one that are their `anchors`. O(points log points).
    /// They touch each other as those that are `joined` do, though one of these alone be searched.
    pub fn new(mesh: &Mesh, shells: &[Shell], joined: &JoinedShells, anchors: &[Vec<u32>]) -> ContactGraph {
        let JoinedShells { joints, twins, .. } = joined;
        let mut graph =
            ContactGraph { contacts: Vec::new(), hung: Vec::new(), twins: vec![NONE; mesh.shell_count] };
        twins.iter().for_each(|&[own, twin]| graph.twins[own as usize] = twin);
        graph.hung.resize_with(mesh.shell_count, Vec::new);
        // One large shell has its images by the search.
        if shells.len() > 1 && (!joints.is_empty() || shells[0].area() < MOST) {
            graph.hang(mesh, shells, anchors);
        }
        graph.join(mesh, &joined.shells[0], joints);
        graph
    }

    fn hang(&mut self, mesh: &Mesh, shells: &[Shell], anchors: &[Vec<u32>]) {
        let at = |point: u32| mesh.positions[point as usize];
        let base: Vec<Vector> = shells[0].points.iter().map(|&point| at(point)).collect();
        let walk = SurfaceWalk::new(&base, &shells[0].triangles);
        for (shell, anchors) in shells.iter().zip(anchors).skip(1) {
            let on_base = |(&point, &anchor): (&u32, &u32)| {
                let (host, there) = walk.nearest(at(point), anchor);
                let there = there.interpolate_vectors(&shells[0].triangles, &base);
                let host = mesh.shell_of_point[shells[0].points[host as usize] as usize] as usize;
                (at(point), host, squared_norm(subtract(at(point), there)).sqrt())
            };
            let all: Vec<(Vector, usize, f64)> = shell.points.iter().zip(anchors).map(on_base).collect();
            let least = all.iter().map(|(.., away)| *away).fold(f64::INFINITY, f64::min);
            let mut touching: Vec<(usize, Vec<Vector>)> = Vec::new();
            for (place, host, away) in all {
                if least < TOUCHING && away < least + TOUCHING {
                    gather(&mut touching, host, [place]);
                }
            }
            let middle = mean(shell.points.iter().map(|&point| at(point)));
            for (host, places) in touching {
                self.hung[host].push(Hung { places: [mean(places), middle], size: shell.area().ln() });
            }
        }
        self.hung.iter_mut().for_each(|hung| hung.sort_by(|a, b| a.size.total_cmp(&b.size)));
    }

    fn join(&mut self, mesh: &Mesh, searched: &Shell, joints: &[[u32; 3]]) {
        let mut points: Vec<([usize; 2], Vec<Vector>)> = Vec::new();
        for joint in joints {
            let pair = [joint[0], joint[1]].map(|local| searched.points[local as usize]);
            let mut shells = pair.map(|point| mesh.shell_of_point[point as usize] as usize);
            shells.sort_unstable();
            gather(&mut points, shells, pair.map(|point| mesh.positions[point as usize]));
        }
        self.contacts.extend(points.into_iter().map(|(shells, points)| ContactPlace::new(shells, &points)));
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
        let token = progress.token();
        let scene = Scene { mesh, shells: mesh.shells(), kind };
        let node = |own: usize| token.check().map(|()| scene.node(map, own, self.twins[own]));
        let nodes: Result<Vec<_>> =
            threads::map(threads, (0..scene.shells.len()).collect(), node).into_iter().collect();
        let mut nodes: Vec<Node> = nodes?.into_iter().flatten().collect();
        share_ways(&mut nodes);
        let ways = self.ways(&scene, map, &nodes);
        let mut is_moved = false;
        // Each by its way, and then after those that it touches.
        for follows in [false, true] {
            for (node, &way) in nodes.iter().zip(&ways) {
                token.check()?;
                let hints = if follows { self.hints(&scene, map, node, |_| true) } else { Vec::new() };
                if let Some(images) = node.shell.images(way, &hints) {
                    let (own, target) = (&scene.shells[node.own], &scene.shells[node.target]);
                    map.move_shell(mesh, own, target, &images, node.own == node.target);
                    is_moved = true;
                }
            }
        }
        Ok(is_moved)
    }

    /// The way of each node, where it has any, by which the energy of all is least, or nearly.
    fn ways(&self, scene: &Scene, map: &PointMap, nodes: &[Node]) -> Vec<Option<usize>> {
        let mut node_of = vec![None; scene.shells.len()];
        for (index, node) in nodes.iter().enumerate().filter(|(_, node)| !node.shell.has_none()) {
            node_of[node.own] = Some(index);
        }
        // A shell and its twin choose together.
        let variable = |index: usize| match node_of[nodes[index].target] {
            Some(twin) if nodes[twin].target == nodes[index].own => twin.min(index),
            _ => index,
        };
        let mut costs: Vec<Vec<f64>> = vec![Vec::new(); nodes.len()];
        for (index, node) in nodes.iter().enumerate() {
            let hints = self.hints(scene, map, node, |other| node_of[other].is_none());
            let own = node.shell.costs(&hints);
            let sums = &mut costs[variable(index)];
            sums.resize(own.len(), 0.0);
            sums.iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
        }
        let mut edges = Vec::new();
        for contact in &self.contacts {
            let [Some(a), Some(b)] = contact.shells.map(|shell| node_of[shell]) else { continue };
            let (first, second) = (variable(a), variable(b));
            let apart = nodes[a].shell.apart(&nodes[b].shell, &scene.around(contact));
            match first == second {
                true => apart.iter().enumerate().for_each(|(way, row)| costs[first][way] += row[way]),
                false => edges.push(([first, second], apart)),
            }
        }
        let ways = least_energy(&costs, &edges);
        (0..nodes.len()).map(|index| ways[variable(index)]).collect()
    }

    /// What says how a node's shell is turned: shells it touches that are `asked`, and what hangs on it.
    fn hints(&self, scene: &Scene, map: &PointMap, node: &Node, asked: impl Fn(usize) -> bool) -> Vec<Hint> {
        let beside = self.contacts.iter().filter_map(|contact| {
            let [a, b] = contact.shells;
            let other = if a == node.own { b } else { a };
            let is_asked = contact.shells.contains(&node.own) && asked(other);
            is_asked.then(|| scene.hint(map, other, contact)).flatten()
        });
        let hanging = self.hung[node.own].iter().filter_map(|hung| {
            let there = &self.hung[node.target];
            let [first, last] = [-AREA_TOLERANCE, AREA_TOLERANCE]
                .map(|apart| there.partition_point(|other| other.size < hung.size + apart));
            let to = |place: usize| there[first..last].iter().map(|other| other.places[place]).collect();
            (1..=SWARM)
                .contains(&(last - first))
                .then(|| Hint { from: hung.places.to_vec(), to: vec![to(0), to(1)] })
        });
        beside.chain(hanging).collect()
    }
}

impl Scene<'_> {
    /// A shell that may be whole, if some of its points go to its likely `twin` or most to one shell.
    fn node(&self, map: &PointMap, own: usize, twin: u32) -> Option<Node> {
        let (mesh, shell) = (self.mesh, &self.shells[own]);
        let target = partner(mesh, &self.shells, map, own, twin)?;
        let there = &self.shells[target];
        let on_target = |&point: &u32| {
            let image = map.image[point as usize];
            let triangle = there.triangle_of_local.binary_search(&image.triangle).ok()?;
            (map.partner[point as usize] != NONE)
                .then_some(TrianglePoint { triangle: triangle as u32, ..image })
        };
        let images: Vec<Option<TrianglePoint>> = shell.points.iter().map(on_target).collect();
        let shell = WholeShell::new(&mesh.positions, shell, there, &images, self.kind)?;
        Some(Node { own, target, shell })
    }

    /// The middle of a contact, and places around it.
    fn around(&self, contact: &ContactPlace) -> Vec<Vector> {
        let [a, b] = contact.shells.map(|shell| self.shells[shell].area());
        let around = AROUND * a.min(b).sqrt();
        let beside = (0..6).map(|side| {
            let mut place = contact.middle;
            place[side / 2] += if side % 2 == 0 { around } else { -around };
            place
        });
        [contact.middle].into_iter().chain(beside).collect()
    }

    /// Where a shell takes the places of a contact; `None` if few of its points go anywhere.
    fn hint(&self, map: &PointMap, shell: usize, contact: &ContactPlace) -> Option<Hint> {
        let (mesh, from) = (self.mesh, self.around(contact));
        let goes = |&point: &u32| {
            let point = point as usize;
            let image = map.image[point].interpolate_vectors(&mesh.triangles, &mesh.positions);
            (map.partner[point] != NONE).then_some([mesh.positions[point], image])
        };
        let goes = self.shells[shell].points.iter().filter_map(goes);
        let to = contact.carried(goes, self.kind, &from)?;
        Some(Hint { from, to: to.into_iter().map(|to| vec![to]).collect() })
    }
}

/// Adds places to those of a key.
fn gather<K: PartialEq>(all: &mut Vec<(K, Vec<Vector>)>, key: K, places: impl IntoIterator<Item = Vector>) {
    match all.iter_mut().find(|(other, _)| *other == key) {
        Some((_, known)) => known.extend(places),
        None => all.push((key, places.into_iter().collect())),
    }
}

/// Gives each shell and its twin the same ways.
fn share_ways(nodes: &mut [Node]) {
    for first in 1..nodes.len() {
        let (before, after) = nodes.split_at_mut(first);
        let one = &mut before[first - 1];
        if let Some(two) = after.iter_mut().find(|two| two.own == one.target && two.target == one.own) {
            one.shell.share_ways(&mut two.shell);
        }
    }
}

/// A label for each variable, by the costs of its labels and of those of pairs, whose sum is least, or nearly; `None` where there is no label. O(messages x labels^2).
fn least_energy(costs: &[Vec<f64>], edges: &[([usize; 2], Vec<Vec<f64>>)]) -> Vec<Option<usize>> {
    let mut beliefs = costs.to_vec();
    let quiet = |[a, b]: [usize; 2]| [vec![0.0; costs[b].len()], vec![0.0; costs[a].len()]];
    let mut messages: Vec<[Vec<f64>; 2]> = edges.iter().map(|(pair, _)| quiet(*pair)).collect();
    for _ in 0..MESSAGES {
        for ((pair, cost), messages) in edges.iter().zip(&mut messages) {
            for back in 0..2 {
                let (from, to) = (pair[back], pair[1 - back]);
                let at = |i: usize, j: usize| if back == 0 { cost[i][j] } else { cost[j][i] };
                let known = |i: usize| beliefs[from][i] - messages[1 - back][i];
                let least = |j: usize| {
                    (0..costs[from].len()).map(|i| known(i) + at(i, j)).fold(f64::INFINITY, f64::min)
                };
                let said: Vec<f64> = (0..costs[to].len()).map(least).collect();
                let floor = said.iter().copied().fold(f64::INFINITY, f64::min);
                for (label, said) in said.into_iter().enumerate() {
                    // Half of what is new, so that rings come to rest.
                    let step = 0.5 * (said - floor - messages[back][label]);
                    messages[back][label] += step;
                    beliefs[to][label] += step;
                }
            }
        }
    }
    let least = |costs: &Vec<f64>| (0..costs.len()).min_by(|&i, &j| costs[i].total_cmp(&costs[j]));
    beliefs.iter().map(least).collect()
}

/// The likely twin of a shell if any of its points go there, or else where most go; `None` if it is settled, too small or too large.
fn partner(mesh: &Mesh, shells: &[Shell], map: &PointMap, own: usize, twin: u32) -> Option<usize> {
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
    let likely = Some(twin as usize).filter(|&twin| counts.get(twin).is_some_and(|&count| count > 0));
    likely.or_else(|| counts.iter().position(|&count| 2 * count > shells[own].points.len()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::limits::Limits;
    use crate::geometry::vertex_map::VertexMap;
    use crate::mesh::{PolygonMesh, anchors};

    /// A block, and a smaller one on each side of it, nearer to its front and its top. A bit of a corner's number says on which side of an axis it is.
    fn blocks() -> Mesh {
        let bit = |corner: u32, axis: u32| f64::from(corner >> axis & 1) - 0.5;
        let block = |[x, y, z]: Vector, [w, d, h]: [f64; 3]| {
            let place =
                move |corner| [x + w * bit(corner, 0), y + d * bit(corner, 1), z + h * bit(corner, 2)];
            (0..8).map(place)
        };
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let arm = |x: f64| block([x, 0.4, 0.4], [0.8, 0.8, 0.8]);
        let polygons = PolygonMesh {
            positions: block([0.0; 3], [1.0, 1.0, 1.2]).chain(arm(-0.9)).chain(arm(0.9)).collect(),
            face_offsets: (0..=18).map(|face| 4 * face).collect(),
            face_vertices: (0..3)
                .flat_map(|block| faces.as_flattened().iter().map(move |corner| 8 * block + corner))
                .collect(),
        };
        Mesh::new(&polygons, &Limits::default()).expect("a usable mesh")
    }

    /// Partners of the middle's corners, which the map sends to its back; its arms' are known or not.
    fn settled(mesh: &Mesh, graph: &ContactGraph, with_arms: bool) -> Vec<u32> {
        let shells = mesh.shells();
        let mut map = PointMap::empty(mesh);
        let known = [(0, 0, 2), (1, 2, 1), (2, 1, 1)];
        for &(own, target, axes) in if with_arms { &known[..] } else { &known[..1] } {
            let partners = (0..8).map(|corner| corner ^ axes).collect();
            let images = VertexMap::at_vertices(&shells[target].triangles, partners);
            map.insert(&shells[own], &shells[target], &images, &[1.0; 8]);
        }
        let kind = SymmetryKind::Reflection;
        graph.settle(mesh, &mut map, kind, 1, &Progress::default()).expect("an answer");
        map.partner[..8].to_vec()
    }

    fn onto(axes: u32) -> Vec<u32> {
        (0..8).map(|corner| corner ^ axes).collect()
    }

    #[test]
    fn what_lies_on_itself_in_several_ways_follows_what_it_touches() {
        let mesh = blocks();
        let whole = vec![mesh.shell_of((0..24).collect(), mesh.triangles.clone(), true)];
        let mut joined = JoinedShells::alone(whole);
        assert_eq!(settled(&mesh, &ContactGraph::new(&mesh, &joined.shells, &joined, &[]), true), onto(2));
        // The middle's left side touches the left arm's right one.
        joined.joints = [0, 2, 4, 6].map(|left: u32| [left, 8 + (left ^ 1), 8]).to_vec();
        assert_eq!(settled(&mesh, &ContactGraph::new(&mesh, &joined.shells, &joined, &[]), true), onto(1));
        // Also where one is searched alone.
        let shells = mesh.shells();
        assert_eq!(settled(&mesh, &ContactGraph::new(&mesh, &shells, &joined, &[]), true), onto(1));
    }

    #[test]
    fn what_hangs_on_a_shell_says_how_it_is_turned() {
        let mesh = blocks();
        let joined = JoinedShells::alone(mesh.shells());
        let graph = ContactGraph::new(&mesh, &joined.shells, &joined, &anchors(&mesh, &joined.shells, 0));
        assert_eq!(settled(&mesh, &graph, false), onto(1));
    }

    #[test]
    fn a_shell_goes_to_its_likely_twin_if_some_of_its_points_do() {
        let mesh = blocks();
        let (mut joined, shells) = (JoinedShells::alone(mesh.shells()), mesh.shells());
        let ends = |joined: &JoinedShells| {
            let mut map = PointMap::empty(&mesh);
            for own in [1, 2] {
                // Half of its corners go to the middle.
                for (target, half) in [(0, 0..4), (3 - own, 4..8)] {
                    let images =
                        VertexMap::at_vertices(&shells[target].triangles, (0..8).map(|c| c ^ 1).collect());
                    let mut part = shells[own].clone();
                    part.points = part.points[half.clone()].to_vec();
                    let images = VertexMap {
                        partners: images.partners[half.clone()].to_vec(),
                        points: images.points[half].to_vec(),
                    };
                    map.insert(&part, &shells[target], &images, &[1.0; 4]);
                }
            }
            let graph = ContactGraph::new(&mesh, &joined.shells, joined, &[]);
            graph
                .settle(&mesh, &mut map, SymmetryKind::Reflection, 1, &Progress::default())
                .expect("an answer");
            map.partner[8..].to_vec()
        };
        assert_eq!(ends(&joined)[..4], [1, 0, 3, 2], "most go nowhere");
        joined.twins = vec![[1, 2], [2, 1]];
        let onto_twin: Vec<u32> = (16..24).chain(8..16).map(|corner| corner ^ 1).collect();
        assert_eq!(ends(&joined), onto_twin);
    }

    #[test]
    fn a_chain_has_its_least_energy() {
        let mut state = 1u32;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 16)
        };
        let mut numbers = |count: usize| (0..count).map(|_| next()).collect::<Vec<f64>>();
        let costs: Vec<Vec<f64>> = (0..4).map(|_| numbers(3)).collect();
        let tables: Vec<Vec<Vec<f64>>> = (0..3).map(|_| (0..3).map(|_| numbers(3)).collect()).collect();
        let energy = |labels: &[usize]| -> f64 {
            let own: f64 = (0..4).map(|i| costs[i][labels[i]]).sum();
            own + (0..3).map(|i| tables[i][labels[i]][labels[i + 1]]).sum::<f64>()
        };
        let all = (0..81).map(|code| [code % 3, code / 3 % 3, code / 9 % 3, code / 27]);
        let least = all.min_by(|a, b| energy(a).total_cmp(&energy(b))).expect("a labelling");
        let edges: Vec<_> = tables.iter().enumerate().map(|(i, table)| ([i, i + 1], table.clone())).collect();
        let found: Vec<usize> = least_energy(&costs, &edges).into_iter().flatten().collect();
        assert_eq!(found, least);
    }
}
