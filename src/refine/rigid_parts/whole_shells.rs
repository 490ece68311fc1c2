//! Whole shells that have kept their shape: plates of armour, links of a robot, wheels.
//!
//! What is round tells a map of eigenfunctions little of how it is turned, but it is seldom round to the last digit. So the rigid motion nearest to the map, and others that are
//! turned from it, are brought to the partner's surface (Y. Chen, G. Medioni, "Object modelling by registration of multiple range images", 1992); one
//! that comes to lie on it is the map of the whole shell. Where the shell touches others, these say of one more start, and of which motion is nearest.

use super::motion::{Approach, Motion, Oriented, Place, Spread};
use crate::base::symmetry_kind::SymmetryKind;
use crate::geometry::embedded_triangles::TrianglePoint;
use crate::geometry::surface_walk::SurfaceWalk;
use crate::geometry::vertex_map::VertexMap;
use crate::mesh::Shell;
use crate::mesh::rotation::{principal_axes, rotation, turned};
use crate::mesh::vector::{Vector, cross, point_areas, squared_norm, subtract, summed_normals, unit};
use crate::spectral::sampling::area_weighted_vertices;

/// The square root of a shell's area, in the unit of parts: it is about as large as these.
const SIZE: f64 = 0.22;
/// Vertices that are compared, at first and in the end.
const FEW: usize = 48;
const MANY: usize = 200;
/// How a motion is brought to the surface, at first and in the end.
const ROUGHLY: Approach = Approach { rounds: 6, noise: 0.0015, held: 0.05, free: true };
const FINELY: Approach = Approach { rounds: 12, ..ROUGHLY };
/// The same from where contacts put it.
const FROM_AFAR: Approach = Approach { noise: 0.01, ..FINELY };
/// Turns, in radians, about each axis of the shell.
const TURNS: [f64; 4] = [-0.8, -0.4, 0.4, 0.8];
/// Motions that are brought to the surface in the end.
const FOLLOWED: usize = 4;
/// A shell lies on its partner if it leaves no more than this, and exactly if so little.
const LIES_ON: f64 = 0.0008;
const EXACTLY: f64 = 0.0001;
/// One that is put where what it touches goes lies on its partner if it leaves no more than this, since the two may be cut differently, or so small a part
/// of what the map leaves.
const LIES_BESIDE: f64 = 0.002;
const HALF: f64 = 0.5;
/// What a motion leaves, and how far it goes from the map, that are as bad.
const LEFT: f64 = 0.0003;
const GONE: f64 = 0.05;

/// Images of all vertices of `own` by the rigid motion that puts it onto `target`, its partner or itself, from `images` on that of some of its vertices; `None` if no such motion
/// is near. `contacts` are vertices that touch other shells, and where, in the target's unit, these say that they go. Some ten thousand steps on the surface.
pub fn fit_whole_shell(
    own: &Shell,
    target: &Shell,
    images: &[Option<TrianglePoint>],
    contacts: &[(u32, Vector)],
    kind: SymmetryKind,
) -> Option<VertexMap> {
    if own.scale == 0.0 || target.scale == 0.0 {
        return None;
    }
    // Both in one unit.
    let scaled = |shell: &Shell, factor: f64| -> Vec<Vector> {
        shell.positions.iter().map(|position| position.map(|x| factor * x)).collect()
    };
    let factor = SIZE * own.scale / target.scale;
    let (from, to) = (scaled(own, SIZE), scaled(target, factor));
    let surface = Surface {
        walk: SurfaceWalk::new(&to, &target.triangles),
        positions: &to,
        triangles: &target.triangles,
    };
    let normals = summed_normals(&from, &own.triangles);
    let areas = point_areas(&from, &own.triangles);
    let place = |vertex: usize| {
        let image = images[vertex]?;
        let own = Oriented { position: from[vertex], normal: unit(normals[vertex]) };
        let partner = target.triangles[image.triangle as usize][image.heaviest()];
        Some(Place { own, image: image.interpolate_vectors(&target.triangles, &to), partner, weight: 1.0 })
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
    let start = Motion::between(&many, mirrored);
    let near = surface.settled(start, &many, FINELY);
    let contact = |&(vertex, goal): &(u32, Vector)| Place {
        own: Oriented { position: from[vertex as usize], normal: [0.0; 3] },
        image: goal.map(|x| factor * x),
        partner: 0,
        weight: 1.0,
    };
    let held = Held { start, mirrored, contacts: contacts.iter().map(contact).collect() };
    let (_, motion) = match near.0 < EXACTLY && held.contacts.is_empty() {
        true => near,
        false => surface.best(near, &held, &few, &many)?,
    };
    let mut last = 0;
    let image = |(vertex, &position): (usize, &Vector)| {
        let goal = motion.of(position);
        let partner = images[vertex].map_or(last, |image| target.triangles[image.triangle as usize][0]);
        let (partner, point) = surface.walk.nearest(goal, surface.walk.nearer(goal, partner, last));
        last = partner;
        (partner, point)
    };
    let (partners, points) = from.iter().enumerate().map(image).unzip();
    Some(VertexMap { partners, points })
}

/// The surface to which motions are brought.
struct Surface<'a> {
    walk: SurfaceWalk<'a>,
    positions: &'a [Vector],
    triangles: &'a [[u32; 3]],
}

impl Surface<'_> {
    /// What a motion that was brought to the surface leaves, and the motion.
    fn settled(&self, start: Motion, places: &[Place], approach: Approach) -> (f64, Motion) {
        let mut near: Vec<u32> = places.iter().map(|place| place.partner).collect();
        let mut nearest = |index: usize, goal: Oriented| {
            let (vertex, point) = self.walk.nearest(goal.position, near[index]);
            near[index] = vertex;
            let [a, b, c] =
                self.triangles[point.triangle as usize].map(|corner| self.positions[corner as usize]);
            let position = point.interpolate_vectors(self.triangles, self.positions);
            Oriented { position, normal: unit(cross(subtract(b, a), subtract(c, a))) }
        };
        let motion = start.settled(places, &mut nearest, approach);
        (motion.left(places, &mut nearest), motion)
    }

    /// The vertex nearest to a place. O(vertices).
    fn nearest(&self, goal: Vector) -> u32 {
        let away = |vertex: &u32| squared_norm(subtract(self.positions[*vertex as usize], goal));
        (0..self.positions.len() as u32).min_by(|a, b| away(a).total_cmp(&away(b))).unwrap_or(0)
    }

    /// The best of a motion and others, from starts that are turned and from where the shell is `held`, if it lies on the surface.
    fn best(&self, near: (f64, Motion), held: &Held, few: &[Place], many: &[Place]) -> Option<(f64, Motion)> {
        let spread = Spread::of(many);
        let axes = principal_axes(spread.moments).map(|axis| turned(&held.start.turn, axis));
        let starts = axes.iter().flat_map(|&axis| TURNS.map(|angle| rotation(axis, angle)));
        let about = held.start.of(spread.middle);
        let mut roughly: Vec<(f64, Motion)> = starts
            .map(|turn| self.settled(held.start.then_turned(&turn, about), few, ROUGHLY))
            .map(|found| (held.cost(&found, few), found.1))
            .collect();
        roughly.sort_by(|a, b| a.0.total_cmp(&b.0));
        // The map says nothing of where that is on the surface.
        let there = |motion: &Motion| -> Vec<Place> {
            let at = |place: &Place| self.nearest(motion.of(place.own.position));
            many.iter().map(|place| Place { partner: at(place), ..*place }).collect()
        };
        let settled = |start: Motion, approach: Approach| self.settled(start, &there(&start), approach);
        let by_contacts = held.by_contacts(&spread).map(|start| settled(settled(start, FROM_AFAR).1, FINELY));
        let least = LIES_BESIDE.max(HALF * near.0);
        let lies_beside =
            |found: &(f64, Motion)| found.0 < least && held.cost(found, many) < held.cost(&near, many);
        roughly
            .into_iter()
            .take(FOLLOWED)
            .map(|(_, motion)| self.settled(motion, many, FINELY))
            .chain([near])
            .filter(|found| found.0 < LIES_ON)
            .chain(by_contacts.filter(lies_beside))
            .min_by(|a, b| held.cost(a, many).total_cmp(&held.cost(b, many)))
    }
}

/// What says how a shell is turned beside its form: the shells that it touches, or the map.
struct Held {
    /// The motion nearest to the map.
    start: Motion,
    mirrored: bool,
    /// Places that touch others, with where these go.
    contacts: Vec<Place>,
}

impl Held {
    /// How bad is what a motion leaves, and how far it goes from what holds the shell.
    fn cost(&self, (left, motion): &(f64, Motion), places: &[Place]) -> f64 {
        let from_map = |place: &Place| {
            squared_norm(subtract(motion.of(place.own.position), self.start.of(place.own.position)))
        };
        let from_contact = |place: &Place| squared_norm(subtract(motion.of(place.own.position), place.image));
        let gone = match self.contacts.len() {
            0 => places.iter().map(from_map).sum::<f64>() / places.len() as f64,
            count => self.contacts.iter().map(from_contact).sum::<f64>() / count as f64,
        };
        (left / LEFT).powi(2) + gone / (GONE * GONE)
    }

    /// The motion by the contacts and the middle, which weighs as much as they.
    fn by_contacts(&self, spread: &Spread) -> Option<Motion> {
        let own = Oriented { position: spread.middle, normal: [0.0; 3] };
        let weight = self.contacts.len() as f64;
        let middle = Place { own, image: self.start.of(spread.middle), partner: 0, weight };
        let places: Vec<Place> = self.contacts.iter().copied().chain([middle]).collect();
        (weight > 0.0).then(|| Motion::nearest(&places, self.mirrored, |place| place.weight))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::limits::Limits;
    use crate::mesh::{Mesh, PolygonMesh};

    const AROUND: u32 = 24;
    const ALONG: u32 = 13;

    /// A tube with a mirror plane, nearly round, whose middle goes where `to` says.
    fn tube(to: impl Fn(Vector) -> Vector) -> Shell {
        let position = |index: u32| {
            let (along, around) =
                (index / AROUND, f64::from(index % AROUND) * std::f64::consts::TAU / f64::from(AROUND));
            let height = f64::from(along) / f64::from(ALONG - 1);
            let radius =
                0.3 + 0.02 * (2.0 * around).cos() + 0.02 * (3.0 * around).cos() + 0.1 * height * height;
            to([radius * around.sin(), radius * around.cos(), 1.2 * height])
        };
        let quads = (0..ALONG - 1).flat_map(|along| (0..AROUND).map(move |around| [along, around]));
        let corner = |along: u32, around: u32| along * AROUND + around % AROUND;
        let polygons = PolygonMesh {
            positions: (0..AROUND * ALONG).map(position).collect(),
            face_offsets: (0..=AROUND * (ALONG - 1)).map(|face| 4 * face).collect(),
            face_vertices: quads
                .flat_map(|[i, k]| [corner(i, k), corner(i, k + 1), corner(i + 1, k + 1), corner(i + 1, k)])
                .collect(),
        };
        Mesh::new(&polygons, &Limits::default()).expect("a usable mesh").shells().swap_remove(0)
    }

    /// The mirror image of a vertex, turned on by some steps around.
    fn mirrored(vertex: u32, steps: u32) -> u32 {
        vertex / AROUND * AROUND + (AROUND - vertex % AROUND + steps) % AROUND
    }

    /// What a map, mirrored and turned on by some steps of 15 degrees, and contacts say of a tube on another.
    fn found(own: &Shell, target: &Shell, steps: u32, contacts: &[(u32, Vector)]) -> Option<Vec<u32>> {
        let partners = (0..AROUND * ALONG).map(|vertex| mirrored(vertex, steps)).collect();
        let images = VertexMap::at_vertices(&target.triangles, partners).points.into_iter().map(Some);
        let images: Vec<_> = images.collect();
        Some(fit_whole_shell(own, target, &images, contacts, SymmetryKind::Reflection)?.partners)
    }

    #[test]
    fn what_its_map_turns_far_goes_where_it_touches_others() {
        let own = tube(|[x, y, z]| [x, 0.9 * y, z]);
        let expected: Vec<u32> = (0..AROUND * ALONG).map(|vertex| mirrored(vertex, 0)).collect();
        let contact = |vertex: u32| (vertex, own.positions[mirrored(vertex, 0) as usize]);
        let turned = |contacts: &[(u32, Vector)]| found(&own, &own, 12, contacts);
        assert_ne!(turned(&[]).as_ref(), Some(&expected));
        assert_eq!(turned(&[2, 8, 13].map(contact)).as_ref(), Some(&expected));
    }

    /// Images of a tube on another by a map that is turned by two steps of 15 degrees.
    fn moved(own: &Shell, target: &Shell) -> Option<Vec<u32>> {
        found(own, target, 2, &[])
    }

    #[test]
    fn what_is_nearly_round_is_turned_back_onto_itself_and_onto_a_twin() {
        let own = tube(|at| at);
        let twin = tube(|[x, y, z]| [3.0 + z, x, y]);
        let expected: Vec<u32> = (0..AROUND * ALONG).map(|vertex| mirrored(vertex, 0)).collect();
        assert_eq!(moved(&own, &own).as_ref(), Some(&expected));
        assert_eq!(moved(&own, &twin).as_ref(), Some(&expected));
    }

    #[test]
    fn what_is_bent_follows_its_map() {
        let bent = tube(|[x, y, z]| [x, y + 0.3 * z * z, z]);
        assert_eq!(moved(&tube(|at| at), &bent), None);
    }
}
