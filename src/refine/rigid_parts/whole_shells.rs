//! Whole shells that have kept their shape: plates of armour, links of a robot, wheels.
//!
//! What is round tells a map of eigenfunctions little of how it is turned, and a box lies on its partner in several ways. So the rigid motion nearest to the map, and others that are
//! turned from it, are brought to the partner's surface (Y. Chen, G. Medioni, "Object modelling by registration of multiple range images", 1992); those
//! that come to lie on it are the ways in which the shell may go. Which it is, others tell: what the shell touches, and what hangs on it.

use super::motion::{Approach, Motion, Oriented, Place, Spread};
use crate::base::symmetry_kind::SymmetryKind;
use crate::geometry::embedded_triangles::TrianglePoint;
use crate::geometry::surface_walk::SurfaceWalk;
use crate::geometry::vertex_map::VertexMap;
use crate::mesh::Shell;
use crate::mesh::rotation::{principal_axes, product, rotation, turned};
use crate::mesh::vector::{Vector, cross, point_areas, squared_norm, subtract, summed_normals, unit};
use crate::spectral::sampling::area_weighted_vertices;
use rstar::RTree;
use rstar::primitives::GeomWithData;
use std::f64::consts::{PI, TAU};

/// The square root of a shell's area, in the unit of parts: it is about as large as these.
const SIZE: f64 = 0.22;
/// Vertices that are compared, at first and in the end.
const FEW: usize = 48;
const MANY: usize = 200;
/// How a motion is brought to the surface, at first and in the end; and how from where others say that the shell goes.
const ROUGHLY: Approach = Approach { rounds: 6, noise: 0.0015, held: 0.05, free: true };
const FINELY: Approach = Approach { rounds: 24, ..ROUGHLY };
const FROM_AFAR: Approach = Approach { rounds: 12, noise: 0.01, ..ROUGHLY };
/// Rounds after each of which it ends if they gain less than this.
const ROUNDS: usize = 3;
const GAIN: f64 = 1e-5;
/// Turns about each axis of the shell.
const TURNS: u32 = 6;
/// Motions that are brought to the surface in the end.
const FOLLOWED: usize = 12;
/// Motions that put places so near each other are one.
const ALIKE: f64 = 0.005;
/// A shell lies on its partner if a motion leaves no more than this, and then every motion that leaves no more than that.
const LIES_ON: f64 = 0.0008;
const LIES_BESIDE: f64 = 0.002;
/// A shell that a pose bends, as a face, lies where it leaves this share of what is left near the map.
const MUCH_LESS: f64 = 0.35;
/// Or this share of how far the map strays from the nearest motion.
const NEXT_TO_NOTHING: f64 = 0.1;
/// What a motion leaves, and how far it goes from where it should, that are as bad: 1.
const LEFT: f64 = 0.0006;
const GONE: f64 = 0.05;
/// No single cost of a way is more than this.
const MOST: f64 = 4.0;
/// Weight of what the map says, where that of a neighbour is 1.
const MAP: f64 = 0.05;

/// A shell and the one to which it goes, its partner or itself, with the ways in which it lies there. Places are in the mesh's unit.
pub struct WholeShell {
    /// Positions of both, in the unit of parts.
    own: Vec<Vector>,
    target: Vec<Vector>,
    triangles: Vec<[u32; 3]>,
    tree: RTree<GeomWithData<Vector, u32>>,
    /// The unit of parts over that of the mesh.
    unit: f64,
    mirrored: bool,
    places: Vec<Place>,
    /// The motion nearest to the map.
    map: Motion,
    /// By how much more what is bent leaves than what has kept its shape: 1 or more.
    bent: f64,
    /// What each way leaves, over that, and the way.
    ways: Vec<(f64, Motion)>,
}

/// What says how a shell is turned: places on it or near it, and where each may go. It speaks with one voice.
pub struct Hint {
    /// Places.
    pub from: Vec<Vector>,
    /// For each place where it goes, in one way or another.
    pub to: Vec<Vec<Vector>>,
}

/// Where `places` go with a surface of which some points go to others, each by its weight.
pub fn carried(goes: &[(Vector, Vector, f64)], kind: SymmetryKind, places: &[Vector]) -> Vec<Vector> {
    let fitted: Vec<Place> =
        goes.iter().map(|&(from, to, weight)| Place::unoriented(from, to, weight)).collect();
    let motion = Motion::between(&fitted, kind == SymmetryKind::Reflection);
    places.iter().map(|&place| motion.of(place)).collect()
}

impl WholeShell {
    /// From `images` of a shell's vertices on `target`, both of a mesh with `positions`; `None` if they are too few. Some hundred thousand steps on the surface.
    pub fn new(
        positions: &[Vector],
        own: &Shell,
        target: &Shell,
        images: &[Option<TrianglePoint>],
        kind: SymmetryKind,
    ) -> Option<WholeShell> {
        if own.scale == 0.0 || target.scale == 0.0 {
            return None;
        }
        let scale = SIZE * own.scale;
        let scaled = |shell: &Shell| -> Vec<Vector> {
            shell.points.iter().map(|&point| positions[point as usize].map(|x| scale * x)).collect()
        };
        let (from, to) = (scaled(own), scaled(target));
        let normals = summed_normals(&from, &own.triangles);
        let areas = point_areas(&from, &own.triangles);
        let place = |vertex: usize| {
            let image = images[vertex]?.interpolate_vectors(&target.triangles, &to);
            let own = Oriented { position: from[vertex], normal: unit(normals[vertex]) };
            Some(Place { own, image, partner: 0, weight: 1.0 })
        };
        let places = |count: usize| -> Vec<Place> {
            let mut picked = area_weighted_vertices(&areas, count);
            picked.dedup();
            picked.into_iter().filter_map(place).collect()
        };
        let (few, many) = (places(FEW), places(MANY));
        if few.len() < 4 {
            return None;
        }
        let mirrored = kind == SymmetryKind::Reflection;
        let leaves = to.iter().zip(0..).map(|(&at, vertex)| GeomWithData::new(at, vertex)).collect();
        let mut shell = WholeShell {
            own: from,
            tree: RTree::bulk_load(leaves),
            target: to,
            triangles: target.triangles.clone(),
            unit: scale,
            mirrored,
            map: Motion::between(&many, mirrored),
            places: many,
            bent: 1.0,
            ways: Vec::new(),
        };
        (shell.bent, shell.ways) = shell.found(&few);
        Some(shell)
    }

    /// How bent the shell is, and motions that lie on the target: that near the map, and from starts that are turned from it.
    fn found(&self, few: &[Place]) -> (f64, Vec<(f64, Motion)>) {
        let (surface, many) = (self.surface(), &self.places);
        let near = surface.settled(self.map, many, FINELY);
        let start = if near.0 < LIES_ON { near.1 } else { self.map };
        let spread = Spread::of(many);
        let axes = principal_axes(spread.moments).map(|axis| turned(&start.turn, axis));
        let about = start.of(spread.middle);
        let starts = (0..3).flat_map(|k| {
            let flips = [0.0, PI].map(|flip| rotation(axes[(k + 1) % 3], flip));
            let turn = move |turn: u32| rotation(axes[k], TAU * f64::from(turn) / f64::from(TURNS));
            (0..TURNS).map(turn).flat_map(move |turn| flips.map(|flip| product(&turn, &flip)))
        });
        let starts = starts.map(|turn| (0.0, start.then_turned(&turn, about))).collect();
        let roughly =
            distinct(starts, few).into_iter().map(|(_, start)| surface.settled(start, few, ROUGHLY));
        let finely = distinct(roughly.collect(), few).into_iter().take(FOLLOWED);
        let finely = finely.map(|(_, motion)| surface.settled(motion, many, FINELY));
        let found: Vec<(f64, Motion)> = [near].into_iter().chain(finely).collect();
        let least = found.iter().map(|found| found.0).fold(f64::INFINITY, f64::min);
        let stray = |place: &Place| squared_norm(subtract(self.map.of(place.own.position), place.image));
        let strays = (many.iter().map(stray).sum::<f64>() / many.len() as f64).sqrt();
        if least >= LIES_ON.max(MUCH_LESS * near.0).max(NEXT_TO_NOTHING * strays) {
            return (1.0, Vec::new());
        }
        let bent = (least / LIES_ON).max(1.0);
        let found = found.into_iter().map(|(left, motion)| (left / bent, motion));
        let lying = found.filter(|found| found.0 < LIES_BESIDE);
        (bent, distinct(lying.chain([(LIES_BESIDE, self.map)]).collect(), many))
    }

    /// Whether no motion is known that puts the shell onto its target.
    pub fn has_none(&self) -> bool {
        self.ways.is_empty()
    }

    /// Gives a shell and its partner, whose partner it is, the same ways in the same order, each the other's inverse.
    pub fn share_ways(&mut self, other: &mut WholeShell) {
        let ratio = self.unit / other.unit;
        let theirs = other.ways.iter().map(|(_, motion)| motion.inverse().scaled(ratio));
        let all = self.ways.iter().map(|(_, motion)| *motion).chain(theirs);
        let bent = self.bent.max(other.bent);
        (self.bent, other.bent) = (bent, bent);
        let (own, others) = (self.surface(), other.surface());
        let both = |motion: Motion| {
            let [here, there] = [(&own, motion), (&others, motion.inverse().scaled(1.0 / ratio))]
                .map(|(surface, motion)| surface.left(motion));
            ((here.hypot(there) / 2f64.sqrt() / bent).min(LIES_BESIDE), motion)
        };
        let found = all.map(both).collect();
        self.ways = distinct(found, &self.places);
        let inverse = |(left, motion): &(f64, Motion)| (*left, motion.inverse().scaled(1.0 / ratio));
        other.ways = self.ways.iter().map(inverse).collect();
    }

    /// How bad is each way, beside what the `hints` say.
    pub fn costs(&self, hints: &[Hint]) -> Vec<f64> {
        self.ways.iter().map(|found| self.cost(found, hints)).collect()
    }

    /// How bad it is, in all ways of this shell and of one that it touches, that they take `places` between them apart.
    pub fn apart(&self, other: &WholeShell, places: &[Vector]) -> Vec<Vec<f64>> {
        let goals = |shell: &WholeShell| -> Vec<Vec<Vector>> {
            let put = |motion: &Motion, place: &Vector| {
                motion.of(place.map(|x| shell.unit * x)).map(|x| x / shell.unit)
            };
            let goals = |(_, motion): &(f64, Motion)| places.iter().map(|place| put(motion, place)).collect();
            shell.ways.iter().map(goals).collect()
        };
        let (one, two) = (goals(self), goals(other));
        let unit = self.unit.max(other.unit);
        let away = |a: &[Vector], b: &[Vector]| {
            let sum: f64 = a.iter().zip(b).map(|(&a, &b)| squared_norm(subtract(a, b))).sum();
            bad(unit * unit * sum / places.len() as f64)
        };
        one.iter().map(|a| two.iter().map(|b| away(a, b)).collect()).collect()
    }

    /// Images of all vertices by a `way`, or by what lies on the target nearer to what the `hints` say; `None` if neither is there.
    pub fn images(&self, way: Option<usize>, hints: &[Hint]) -> Option<VertexMap> {
        let surface = self.surface();
        let motion = self.best(&surface, way, hints)?;
        let image = |&position: &Vector| {
            let goal = motion.of(position);
            surface.walk.nearest(goal, self.nearest_vertex(goal))
        };
        let (partners, points) = self.own.iter().map(image).unzip();
        Some(VertexMap { partners, points })
    }

    fn best(&self, surface: &Surface, way: Option<usize>, hints: &[Hint]) -> Option<Motion> {
        let mut best = way.map(|way| self.ways[way]);
        let start = best.map_or(self.map, |found| found.1);
        if let Some(start) = self.by_hints(&start, hints) {
            let near = surface.settled(start, &self.places, FROM_AFAR).1;
            let (left, motion) = surface.settled(near, &self.places, FINELY);
            let found = (left / self.bent, motion);
            let is_near = |other: &Motion| moved(&self.places, &found.1, other) < GONE * GONE;
            let is_better = best
                .is_none_or(|best| is_near(&best.1) && self.cost(&found, hints) < self.cost(&best, hints));
            if found.0 < LIES_BESIDE && is_better {
                best = Some(found);
            }
        }
        best.map(|found| found.1)
    }

    /// How bad is what a motion leaves, and what the map and hints say against it.
    fn cost(&self, (left, motion): &(f64, Motion), hints: &[Hint]) -> f64 {
        let away = |place: Vector, goal: Vector| squared_norm(subtract(motion.of(place), goal));
        let scaled = |at: &Vector| at.map(|x| self.unit * x);
        let from_hint = |hint: &Hint| {
            let nearest = |(from, to): (&Vector, &Vec<Vector>)| {
                to.iter().map(|to| away(scaled(from), scaled(to))).fold(f64::INFINITY, f64::min)
            };
            bad(hint.from.iter().zip(&hint.to).map(nearest).sum::<f64>() / hint.from.len() as f64)
        };
        let says: f64 = hints.iter().map(from_hint).sum();
        (left / LEFT).powi(2).min(MOST) + says + MAP * bad(moved(&self.places, motion, &self.map))
    }

    /// The motion by hints, of several goals that nearest to where `motion` puts a place, and by the middle, which weighs as much as all.
    fn by_hints(&self, motion: &Motion, hints: &[Hint]) -> Option<Motion> {
        let scaled = |at: &Vector| at.map(|x| self.unit * x);
        let place = |(from, to): (&Vector, &Vec<Vector>)| {
            let position = scaled(from);
            let away = |to: &Vector| squared_norm(subtract(*to, motion.of(position)));
            let image = to.iter().map(scaled).min_by(|a, b| away(a).total_cmp(&away(b)))?;
            let weight = 1.0 / (1.0 + away(&image) / (GONE * GONE));
            Some(Place::unoriented(position, image, weight))
        };
        let all = hints.iter().flat_map(|hint| hint.from.iter().zip(&hint.to));
        let mut places: Vec<Place> = all.filter_map(place).collect();
        let weight: f64 = places.iter().map(|place| place.weight).sum();
        let middle = Spread::of(&self.places).middle;
        places.push(Place::unoriented(middle, motion.of(middle), weight));
        (weight > 0.0).then(|| Motion::nearest(&places, self.mirrored, |place| place.weight))
    }

    fn nearest_vertex(&self, goal: Vector) -> u32 {
        self.tree.nearest_neighbor(goal).expect("a shell has points").data
    }

    fn surface(&self) -> Surface<'_> {
        Surface { shell: self, walk: SurfaceWalk::new(&self.target, &self.triangles) }
    }
}

/// How bad a squared distance is from where something should be.
fn bad(squared: f64) -> f64 {
    (squared / (GONE * GONE)).min(MOST)
}

/// The surface to which motions are brought.
struct Surface<'a> {
    shell: &'a WholeShell,
    walk: SurfaceWalk<'a>,
}

impl Surface<'_> {
    /// What a motion that is brought to the surface leaves, and the motion.
    fn settled(&self, start: Motion, places: &[Place], approach: Approach) -> (f64, Motion) {
        let WholeShell { target, triangles, .. } = self.shell;
        let at = |place: &Place| self.shell.nearest_vertex(start.of(place.own.position));
        let mut near: Vec<u32> = places.iter().map(at).collect();
        let mut nearest = |index: usize, goal: Oriented| {
            let (vertex, point) = self.walk.nearest(goal.position, near[index]);
            near[index] = vertex;
            let [a, b, c] = triangles[point.triangle as usize].map(|corner| target[corner as usize]);
            let position = point.interpolate_vectors(triangles, target);
            Oriented { position, normal: unit(cross(subtract(b, a), subtract(c, a))) }
        };
        let mut best = (start.left(places, &mut nearest), start);
        for _ in 0..approach.rounds / ROUNDS {
            let motion = best.1.settled(places, &mut nearest, Approach { rounds: ROUNDS, ..approach });
            let left = motion.left(places, &mut nearest);
            let gain = best.0 - left;
            if gain > 0.0 {
                best = (left, motion);
            }
            if gain < GAIN {
                break;
            }
        }
        best
    }

    /// What a motion of the shell leaves.
    fn left(&self, motion: Motion) -> f64 {
        self.settled(motion, &self.shell.places, Approach { rounds: 0, ..FINELY }).0
    }
}

/// How far apart two motions put places: the mean of the squares.
fn moved(places: &[Place], one: &Motion, other: &Motion) -> f64 {
    let there = |place: &Place| subtract(one.of(place.own.position), other.of(place.own.position));
    places.iter().map(|place| squared_norm(there(place))).sum::<f64>() / places.len() as f64
}

/// Of motions that put places nearly alike the one that leaves least; the best first.
fn distinct(mut motions: Vec<(f64, Motion)>, places: &[Place]) -> Vec<(f64, Motion)> {
    let mut kept = Vec::new();
    while let Some(&best) = motions.iter().min_by(|a, b| a.0.total_cmp(&b.0)) {
        motions.retain(|(_, motion)| moved(places, motion, &best.1) > ALIKE * ALIKE);
        kept.push(best);
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::limits::Limits;
    use crate::mesh::{Mesh, PolygonMesh};

    const AROUND: u32 = 24;
    const ALONG: u32 = 13;
    const EACH: u32 = AROUND * ALONG;

    /// Tubes with one mirror plane, nearly round, or with `corners` alike, each put where it says.
    fn tubes(corners: Option<f64>, to: &[&dyn Fn(Vector) -> Vector]) -> Mesh {
        let position = |index: u32| {
            let (along, around) =
                (index / AROUND, f64::from(index % AROUND) * std::f64::consts::TAU / f64::from(AROUND));
            let height = f64::from(along) / f64::from(ALONG - 1);
            let bumps = match corners {
                Some(corners) => 0.03 * (corners * around).cos(),
                None => 0.02 * (2.0 * around).cos() + 0.02 * (3.0 * around).cos(),
            };
            let radius = 0.3 + bumps + 0.1 * height * height;
            [radius * around.sin(), radius * around.cos(), 1.2 * height]
        };
        let quads = (0..ALONG - 1).flat_map(|along| (0..AROUND).map(move |around| [along, around]));
        let corner = |along: u32, around: u32| along * AROUND + around % AROUND;
        let quad =
            |[i, k]: [u32; 2]| [corner(i, k), corner(i, k + 1), corner(i + 1, k + 1), corner(i + 1, k)];
        let faces: Vec<u32> = quads.flat_map(quad).collect();
        let count = to.len() as u32;
        let polygons = PolygonMesh {
            positions: to.iter().flat_map(|to| (0..EACH).map(move |index| to(position(index)))).collect(),
            face_offsets: (0..=count * AROUND * (ALONG - 1)).map(|face| 4 * face).collect(),
            face_vertices: (0..count).flat_map(|tube| faces.iter().map(move |v| v + tube * EACH)).collect(),
        };
        Mesh::new(&polygons, &Limits::default()).expect("a usable mesh")
    }

    /// The mirror image of a vertex, turned on by some steps around.
    fn mirrored(vertex: u32, steps: u32) -> u32 {
        vertex / AROUND * AROUND + (AROUND - vertex % AROUND + steps) % AROUND
    }

    fn all_mirrored(steps: u32) -> Vec<u32> {
        (0..EACH).map(|vertex| mirrored(vertex, steps)).collect()
    }

    /// One tube on another by a map that is mirrored, and turned on by some steps of 15 degrees.
    fn whole(mesh: &Mesh, own: u32, target: u32, steps: u32) -> WholeShell {
        let shells = mesh.shells();
        let tube =
            |number: u32| shells.iter().find(|shell| shell.points[0] == number * EACH).expect("a tube");
        let images = VertexMap::at_vertices(&tube(target).triangles, all_mirrored(steps)).points;
        let images: Vec<_> = images.into_iter().map(Some).collect();
        WholeShell::new(&mesh.positions, tube(own), tube(target), &images, SymmetryKind::Reflection)
            .expect("enough images")
    }

    /// Partners by the way that costs least.
    fn partners(shell: &WholeShell, hints: &[Hint]) -> Vec<u32> {
        let costs = shell.costs(hints);
        let way = (0..costs.len()).min_by(|&a, &b| costs[a].total_cmp(&costs[b]));
        shell.images(way, hints).expect("images").partners
    }

    #[test]
    fn what_is_nearly_round_is_turned_back_onto_itself_and_onto_a_twin() {
        let mesh = tubes(None, &[&|at| at, &|[x, y, z]| [3.0 + z, x, y]]);
        for (target, steps) in [(0, 2), (1, 2), (0, 12)] {
            assert_eq!(partners(&whole(&mesh, 0, target, steps), &[]), all_mirrored(0), "{target} {steps}");
        }
    }

    #[test]
    fn what_lies_on_itself_in_many_ways_goes_where_others_say() {
        let mesh = tubes(Some(6.0), &[&|at| at]);
        let shell = whole(&mesh, 0, 0, 0);
        assert_eq!(partners(&shell, &[]), all_mirrored(0));
        let at = |vertex: u32| mesh.positions[vertex as usize];
        let from = [2, 8, 13];
        let to = from.map(|vertex| vec![at(mirrored(vertex, 12)), at(100)]);
        let hint = Hint { from: from.map(at).to_vec(), to: to.to_vec() };
        assert_eq!(partners(&shell, &[hint]), all_mirrored(12));
    }

    #[test]
    fn twins_go_to_each_other_and_back_in_the_same_ways() {
        let mesh = tubes(Some(6.0), &[&|at| at, &|[x, y, z]| [3.0 + z, x, y]]);
        let (mut one, mut two) = (whole(&mesh, 0, 1, 0), whole(&mesh, 1, 0, 8));
        one.share_ways(&mut two);
        assert!(one.ways.len() > 5 && one.ways.len() == two.ways.len());
        for way in 0..one.ways.len() {
            let [there, back] =
                [&one, &two].map(|shell| shell.images(Some(way), &[]).expect("images").partners);
            let around = (0..EACH as usize).filter(|&vertex| back[there[vertex] as usize] != vertex as u32);
            assert_eq!(around.count(), 0, "{way}");
        }
    }

    #[test]
    fn what_is_a_little_bent_is_turned_back_too() {
        let mesh = tubes(None, &[&|at| at, &|[x, y, z]| [3.0 + x, y + 0.1 * z * z, z]]);
        let shell = whole(&mesh, 0, 1, 8);
        assert!(!shell.has_none());
        let partners = partners(&shell, &[]);
        let is_beside =
            |vertex: u32| (0..3).any(|step| partners[vertex as usize] == mirrored(vertex, AROUND - 1 + step));
        let right = (0..EACH).filter(|&vertex| is_beside(vertex)).count() as u32;
        assert!(3 * right > 2 * EACH, "{right} of {EACH}");
    }

    #[test]
    fn what_is_bent_follows_its_map() {
        let mesh = tubes(None, &[&|at| at, &|[x, y, z]| [3.0 + x, y + 0.3 * z * z, z]]);
        let shell = whole(&mesh, 0, 1, 2);
        assert!(shell.has_none() && shell.images(None, &[]).is_none());
    }
}
