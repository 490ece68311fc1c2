//! Between the caller's mesh and the shell that is solved: exact maps there, and finished maps back, with all that is
//! found once they are back.

use crate::base::effort::Plan;
use crate::base::error::Result;
use crate::base::options::Options;
use crate::base::progress::Progress;
use crate::base::symmetry_kind::SymmetryKind;
use crate::connectivity::automorphism::{Automorphism, Connectivity, Reliance};
use crate::connectivity::mirrored_vertices;
use crate::detect::assembly::{PointMap, Summary, symmetry};
use crate::detect::companions::{self, Companion, Primary};
use crate::detect::contact_graph::ContactGraph;
use crate::detect::correspondence::Symmetry;
use crate::detect::domain::movement;
use crate::detect::filled_holes::FilledShell;
use crate::detect::fixed_curve::{odd_function, zero_set};
use crate::detect::joined_shells::{JoinedShells, LEAST, union};
use crate::detect::mirror_plane::{MIRRORED, MOSTLY, MirrorPlane};
use crate::detect::proxy::Proxy;
use crate::detect::shell_symmetry::PreparedShell;
use crate::geometry::adjacency::nearest_seeds;
use crate::geometry::embedded_triangles::{Fans, TrianglePoint};
use crate::geometry::surface_walk::SurfaceWalk;
use crate::geometry::vertex_map::VertexMap;
use crate::mesh::vector::{Vector, dot, squared_norm, subtract};
use crate::mesh::{Mesh, NONE, Shell, anchors};
use crate::refine::full_refinement::MatchTarget;
use crate::refine::rigid_parts::{self, Carrier, Fitted};
use crate::spectral::displacement::mean_displacement;
use crate::verify::confidence::Evidence;
use crate::verify::hypothesis::{Hypothesis, exchanges_sheets};
use crate::verify::outcome::ALONE;
use rstar::RTree;
use rstar::primitives::GeomWithData;
use std::cell::LazyCell;

/// Distance of a plane's image from the surface, in sqrt(area), from which on a point has no partner.
const LOST: f64 = 0.03;

/// What completing the map of the searched shell to all shells needs.
pub struct Gatherer<'a> {
    mesh: &'a Mesh,
    shells: &'a [Shell],
    /// For each point of every other shell the vertex of the largest, or of its proxy, on which it sits.
    anchors: Vec<Vec<u32>>,
    connectivity: Option<&'a Connectivity>,
    /// Whether vertices that are mirrored where edges are not are looked for.
    mirrored_vertices: bool,
    contacts: ContactGraph,
}

/// Shells of which all but the first sit on the `anchors` of that one as it is `solved`, where it has such images.
struct Sitting<'a> {
    shells: &'a [Shell],
    anchors: &'a [Vec<u32>],
    solved: &'a Shell,
    images: &'a VertexMap,
}

/// Finds partners of shells that sit on one: [`companions::find`] or [`companions::left_over`].
type FindCompanions = fn(&Mesh, &[Shell], &[Vec<u32>], &Primary, &Progress) -> Result<Vec<Option<Companion>>>;

/// A map of the searched shell, or of its proxy.
struct Known<'a> {
    searched: &'a Shell,
    proxy: Option<&'a Proxy<'a>>,
    images: &'a VertexMap,
    summary: Summary,
}

impl<'a> Gatherer<'a> {
    /// `proxy` is that of the first of the `shells`, if it has one; these touch each other as those that are `joined` do. `connectivity` is `None` where it is not mirrored.
    pub fn new(
        mesh: &'a Mesh,
        shells: &'a [Shell],
        joined: &JoinedShells,
        proxy: Option<&Proxy>,
        connectivity: Option<&'a Connectivity>,
        mirrored_vertices: bool,
    ) -> Self {
        let mut anchors = if shells.len() > 1 { anchors(mesh, shells, 0) } else { Vec::new() };
        let contacts = ContactGraph::new(mesh, shells, joined, &anchors);
        if let Some(proxy) = proxy {
            for anchor in anchors.iter_mut().flatten() {
                *anchor = proxy.nearest_vertex(*anchor);
            }
        }
        Gatherer { mesh, shells, anchors, connectivity, mirrored_vertices, contacts }
    }

    /// The symmetry that an exact bijection of the searched shell is, to which the shape agrees; its vertices go to `partners`.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`], [`crate::Error::Internal`].
    pub fn exact(
        &self,
        found: &Automorphism,
        partners: Vec<u32>,
        threads: usize,
        progress: &Progress,
    ) -> Result<Symmetry> {
        let shell = &self.shells[0];
        let mut map = PointMap::empty(self.mesh);
        let images = VertexMap::at_vertices(&shell.triangles, partners);
        let trust = vec![1.0; images.partners.len()];
        map.insert(shell, shell, &images, &trust);
        map.replace_by_connectivity(self.mesh, found);
        let summary = Summary { kind: SymmetryKind::Reflection, score: 0.0, plausibility: 1.0 };
        let known = Known { searched: shell, proxy: None, images: &images, summary };
        self.complete(map, known, threads, progress)
    }

    /// The symmetry that a plane in space is, and the share of the surface that it mirrors; `None` if that is not nearly all.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`], [`crate::Error::Internal`].
    pub fn by_plane(
        &self,
        plane: &MirrorPlane,
        companions: &[Option<Companion>],
        threads: usize,
        progress: &Progress,
    ) -> Result<Option<(Symmetry, f64)>> {
        let mesh = self.mesh;
        let mut map = PointMap::empty(mesh);
        let odd: Vec<f64> = mesh.positions.iter().map(|&at| dot(plane.normal, at) - plane.offset).collect();
        for (own, companion) in companions.iter().enumerate() {
            let Some(companion) = companion else { continue };
            let (shell, target) = (&self.shells[own], &self.shells[companion.target]);
            map.insert(shell, target, &companion.images, &vec![companion.trust(); shell.points.len()]);
        }
        add_elsewhere(mesh, plane, &mut map);
        let areas = mesh.point_areas();
        let mut mirrored = 0.0;
        for (point, &at) in mesh.positions.iter().enumerate() {
            if map.partner[point] == NONE {
                continue;
            }
            let image = map.image[point].interpolate_vectors(&mesh.triangles, &mesh.positions);
            let off = squared_norm(subtract(plane.image(at), image)).sqrt();
            mirrored += if off < MIRRORED { areas[point] } else { 0.0 };
            if off > LOST {
                map.partner[point] = NONE;
                map.confidence[point] = 0.0;
            }
        }
        let share = mirrored / areas.iter().sum::<f64>();
        if share < MOSTLY {
            return Ok(None);
        }
        map.odd = odd;
        let summary = Summary { kind: SymmetryKind::Reflection, score: 0.0, plausibility: share };
        Ok(Some((self.finished(map, summary, Reliance::Twins, threads, progress)?, share)))
    }

    /// The symmetry of all shells, from a `map` that holds the largest one's.
    fn complete(
        &self,
        mut map: PointMap,
        known: Known,
        threads: usize,
        progress: &Progress,
    ) -> Result<Symmetry> {
        let Known { searched, proxy, images, summary } = known;
        let is_moved = self.contacts.settle(self.mesh, &mut map, summary.kind, threads, progress)?;
        if self.shells.len() > 1 {
            // The others follow what whole shells and vertices say of this one, if they say something.
            let is_settled = self.settle(&mut map, summary.kind, Reliance::Shells, threads, progress)?;
            let partner = |point: u32| map.partner[point as usize];
            let settled = (is_moved || is_settled).then(|| images_by(searched, proxy, self.mesh, partner));
            let settled = settled.flatten();
            let solved = proxy.map_or(searched, |proxy| &proxy.shell);
            let images = settled.as_ref().unwrap_or(images);
            let sitting = Sitting { shells: self.shells, anchors: &self.anchors, solved, images };
            self.add_companions(&mut map, sitting, companions::find, summary.kind, progress)?;
            self.contacts.settle(self.mesh, &mut map, summary.kind, threads, progress)?;
            self.add_hanging(&mut map, summary.kind, threads, progress)?;
        }
        self.finished(map, summary, Reliance::Shells, threads, progress)
    }

    /// The symmetry that a `map` of all shells is, with what vertices and connectivity say of it.
    fn finished(
        &self,
        mut map: PointMap,
        summary: Summary,
        reliance: Reliance,
        threads: usize,
        progress: &Progress,
    ) -> Result<Symmetry> {
        let kind = summary.kind;
        self.settle(&mut map, kind, reliance, threads, progress)?;
        progress.report("fixed curve", 0.98)?;
        let curve = match kind {
            SymmetryKind::Reflection => zero_set(&self.mesh.triangles, &map.odd),
            SymmetryKind::HalfTurn => Vec::new(),
        };
        Ok(symmetry(self.mesh, &map, curve, summary))
    }

    /// Replaces images of points that are not settled yet by what vertices and connectivity say of them. Says
    /// whether there was any.
    fn settle(
        &self,
        map: &mut PointMap,
        kind: SymmetryKind,
        reliance: Reliance,
        threads: usize,
        progress: &Progress,
    ) -> Result<bool> {
        progress.report("connectivity", 0.97)?;
        let is_open = |&point: &u32| map.partner[point as usize] != NONE && !map.settled[point as usize];
        let open: Vec<u32> = (0..map.partner.len() as u32).filter(is_open).collect();
        let exact = match self.connectivity {
            Some(connectivity) => {
                connectivity.find(&map.partner, &map.confidence, reliance, kind, progress)?
            }
            None => None,
        };
        // A plane tells where points go: what changes lengths, or sends one elsewhere, is another pairing.
        let is_by_plane = reliance == Reliance::Twins;
        let exact = exact.filter(|found| !is_by_plane || found.keeps_lengths(self.mesh));
        let exact = exact.map(|found| match is_by_plane {
            true => found.within(&map.sent_within(LOST, self.mesh, &open, &found)),
            false => found.within(&open),
        });
        if let Some(found) = &exact {
            map.replace_by_connectivity(self.mesh, found);
        }
        progress.report("mirrored vertices", 0.975)?;
        let mirrored = match self.mirrored_vertices {
            true => {
                let mut partner = vec![NONE; map.partner.len()];
                open.iter().for_each(|&point| partner[point as usize] = map.partner[point as usize]);
                let estimate = mirrored_vertices::Estimate { partner: &partner, image: &map.image };
                mirrored_vertices::find(self.mesh, estimate, exact.as_ref(), kind, threads, progress)?
            }
            false => None,
        };
        if let Some(found) = &mirrored {
            map.replace_by_vertices(self.mesh, found);
        }
        open.iter().for_each(|&point| map.settled[point as usize] = true);
        Ok(mirrored.is_some() || exact.is_some_and(|found| found.covered > 0))
    }

    /// What hangs on other shells than the searched one follows them, again and again. One of a swarm, as hair, carries no other.
    fn add_hanging(
        &self,
        map: &mut PointMap,
        kind: SymmetryKind,
        threads: usize,
        progress: &Progress,
    ) -> Result<()> {
        let (mut count, mut left_over) = (1, false);
        loop {
            let is_known = |shell: &&Shell| map.partner[shell.points[0] as usize] != NONE;
            let (mut hosts, left): (Vec<&Shell>, Vec<&Shell>) = self.shells.iter().partition(is_known);
            hosts.retain(|shell| shell.area() >= LEAST);
            let is_new = hosts.len() > count;
            let is_most = hosts.iter().map(|shell| shell.area()).sum::<f64>() >= 1.0 - ALONE;
            if left.is_empty() || !is_new && (left_over || !is_most) {
                return Ok(());
            }
            (count, left_over) = (hosts.len(), !is_new);
            self.settle(map, kind, Reliance::Shells, threads, progress)?;
            let shells = [union(self.mesh, &hosts)].into_iter().chain(left.into_iter().cloned());
            let shells: Vec<Shell> = shells.collect();
            let images = images_by(&shells[0], None, self.mesh, |point| map.partner[point as usize]);
            let Some(images) = &images else { return Ok(()) };
            let anchors = &anchors(self.mesh, &shells, 0);
            let sitting = Sitting { shells: &shells, anchors, solved: &shells[0], images };
            let find = if left_over { companions::left_over } else { companions::find };
            self.add_companions(map, sitting, find, kind, progress)?;
        }
    }

    /// What sits on the first of some shells follows that.
    fn add_companions(
        &self,
        map: &mut PointMap,
        Sitting { shells, anchors, solved, images }: Sitting,
        find: FindCompanions,
        kind: SymmetryKind,
        progress: &Progress,
    ) -> Result<()> {
        // What fills a hole is on no side.
        let odd = solved.points.iter().map(|&point| map.odd.get(point as usize).copied().unwrap_or(0.0));
        let (carrier, odd) = (Carrier::new(solved, images, kind), odd.collect());
        let primary = Primary { index: 0, shell: solved, carrier, odd };
        let mut companions = find(self.mesh, shells, anchors, &primary, progress)?;
        companions::leave_own(self.mesh, shells, primary.index, &mut companions);
        for (own, companion) in companions.iter().enumerate() {
            let Some(companion) = companion else { continue };
            // What fills a hole says nothing.
            let at = |&anchor: &u32| {
                Some(solved.points[anchor as usize] as usize).filter(|&at| at != NONE as usize)
            };
            let anchors: Vec<Option<usize>> = anchors[own].iter().map(at).collect();
            let share = companion.trust();
            let trust: Vec<f32> =
                anchors.iter().map(|at| at.map_or(0.0, |at| share * map.confidence[at])).collect();
            let odd: Vec<f64> = anchors.iter().map(|at| at.map_or(0.0, |at| map.odd[at])).collect();
            map.insert(&shells[own], &shells[companion.target], &companion.images, &trust);
            map.insert_sides(&shells[own], own, companion, &odd);
        }
        Ok(())
    }
}

/// Gives points that a plane sends away from their shell's partner what is there, as where a wheel is one surface with the car on one side alone; points of a
/// shell without a partner only where these come back to it.
fn add_elsewhere(mesh: &Mesh, plane: &MirrorPlane, map: &mut PointMap) {
    let off = |image: &TrianglePoint, at: Vector| {
        let image = image.interpolate_vectors(&mesh.triangles, &mesh.positions);
        squared_norm(subtract(plane.image(at), image)).sqrt()
    };
    let is_apart = |&point: &usize| {
        map.partner[point] == NONE || off(&map.image[point], mesh.positions[point]) > MIRRORED
    };
    let (alone, mut apart): (Vec<usize>, Vec<usize>) =
        (0..mesh.positions.len()).filter(is_apart).partition(|&point| map.partner[point] == NONE);
    if apart.is_empty() {
        return;
    }
    let walk = SurfaceWalk::new(&mesh.positions, &mesh.triangles);
    let leaf = |(&position, point): (&Vector, u32)| GeomWithData::new(position, point);
    let tree = RTree::bulk_load(mesh.positions.iter().zip(0..).map(leaf).collect());
    apart.extend(alone);
    for point in apart {
        let goal = plane.image(mesh.positions[point]);
        let near = tree.nearest_neighbor(goal).expect("a mesh has points").data;
        let (partner, image) = walk.nearest(goal, near);
        let comes_back = || {
            let back = map.partner[partner as usize];
            back != NONE && mesh.shell_of_point[back as usize] == mesh.shell_of_point[point]
        };
        if off(&image, mesh.positions[point]) < MIRRORED && (map.partner[point] != NONE || comes_back()) {
            map.confidence[point] = if map.partner[point] == NONE { 1.0 } else { map.confidence[point] };
            (map.partner[point], map.image[point]) = (partner, image);
        }
    }
}

/// What turning a shell's map into the caller's symmetry needs, prepared once.
pub struct Assembler<'a> {
    gatherer: Gatherer<'a>,
    filled: Option<&'a FilledShell>,
    /// The searched shell, filled if it has holes, or its proxy.
    pub shell: &'a PreparedShell,
    proxy: Option<&'a Proxy<'a>>,
    /// The same for refinement.
    pub target: MatchTarget<'a>,
    /// The plan that is followed.
    pub plan: &'a Plan,
    /// From which plausibility on a map counts, in percent.
    pub least: usize,
}

impl<'a> Assembler<'a> {
    /// `shell` is the solved one: the first of the gatherer's, `filled` if it has holes, or that of its `proxy`.
    pub fn new(
        gatherer: Gatherer<'a>,
        filled: Option<&'a FilledShell>,
        shell: &'a PreparedShell,
        proxy: Option<&'a Proxy<'a>>,
        plan: &'a Plan,
        options: &Options,
    ) -> Self {
        let target = MatchTarget::new(&shell.surface, &shell.basis, options.threads);
        let least = options.plausibility;
        Assembler { gatherer, filled, shell, proxy, target, plan, least }
    }

    /// The symmetry of the caller's mesh that a map with images by [`Assembler::with_parts`] is.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`], [`crate::Error::Internal`].
    pub fn assemble(
        &self,
        found: &Hypothesis,
        kind: SymmetryKind,
        threads: usize,
        progress: &Progress,
    ) -> Result<Symmetry> {
        progress.report("all vertices", 0.93)?;
        let mut map = PointMap::empty(self.gatherer.mesh);
        let trust = Evidence::new(&self.target, found).confidence();
        let odd = odd_function(&self.shell.surface, &self.shell.basis, &found.images);
        self.insert_searched(&mut map, &found.images, &trust, &odd);
        let (score, plausibility) = (found.score.total(), found.judged.plausibility);
        let summary = Summary { kind, score, plausibility };
        let known = Known { searched: self.searched(), proxy: self.proxy, images: &found.images, summary };
        self.gatherer.complete(map, known, threads, progress)
    }

    /// Whether vertices of the searched shell are mirrored, though edges need not be, near a map.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`].
    pub fn mirrors_vertices(
        &self,
        found: &Hypothesis,
        kind: SymmetryKind,
        threads: usize,
        progress: &Progress,
    ) -> Result<bool> {
        if !self.gatherer.mirrored_vertices {
            return Ok(false);
        }
        let mut map = PointMap::empty(self.gatherer.mesh);
        let count = found.images.partners.len();
        self.insert_searched(&mut map, &found.images, &vec![0.0; count], &vec![0.0; count]);
        let estimate = mirrored_vertices::Estimate { partner: &map.partner, image: &map.image };
        Ok(mirrored_vertices::find(self.gatherer.mesh, estimate, None, kind, threads, progress)?.is_some())
    }

    /// The map with images that follow the rigid parts of the searched shell, judged anew: a reflection by what its parts
    /// say, others by how far they move the surface, since the motions of a half turn's parts may all be the identity, and agree. In a map
    /// that will not count whatever they say, turned parts are not sought.
    ///
    /// # Errors
    /// Those of [`rigid_parts::fit`].
    pub fn with_parts(
        &self,
        found: Hypothesis,
        kind: SymmetryKind,
        threads: usize,
        progress: &Progress,
    ) -> Result<Hypothesis> {
        let parts = &self.plan.parts;
        let effort = match found.judged.is_hopeless(self.least) {
            true => &parts.clone().without_turned(),
            false => parts,
        };
        let Fitted { images, rigidity } = rigid_parts::fit(
            self.solved(),
            &self.shell.surface,
            &found.images,
            kind,
            effort,
            threads,
            progress,
        )?;
        let judged = match kind {
            SymmetryKind::Reflection => found.judged.with_parts(rigidity).by(&found.score),
            SymmetryKind::HalfTurn => {
                let (basis, areas) = (&self.shell.basis, &self.shell.surface.lumped_mass);
                found.judged.with_displacement(mean_displacement(basis, areas, &images.partners))
            }
        };
        Ok(Hypothesis { images, judged, ..found })
    }

    /// Whether a map exchanges the sides of a thin sheet.
    pub fn exchanges_sheets(&self, map: &Hypothesis) -> bool {
        exchanges_sheets(movement(self.solved(), &map.images))
    }

    /// The searched shell, joined of several or the largest one, filled if it has holes.
    fn searched(&self) -> &Shell {
        self.filled.map_or(&self.gatherer.shells[0], |filled| &filled.shell)
    }

    /// That or its proxy.
    fn solved(&self) -> &Shell {
        self.proxy.map_or(self.searched(), |proxy| &proxy.shell)
    }

    /// Enters the searched shell's images, confidence and odd function, carried back from the proxy if there is one.
    fn insert_searched(&self, map: &mut PointMap, images: &VertexMap, trust: &[f32], odd: &[f64]) {
        let shell = self.searched();
        let (mut images, mut trust, odd) = match self.proxy {
            Some(proxy) => {
                let trust = proxy.carry_values(trust).into_iter().map(|value| value as f32).collect();
                (proxy.carry_images(images), trust, proxy.carry_odd(odd))
            }
            None => (images.clone(), trust.to_vec(), odd.to_vec()),
        };
        if let Some(filled) = self.filled {
            let kept = filled.leave_fillings(&mut images);
            trust.iter_mut().zip(kept).for_each(|(trust, kept)| *trust *= kept);
        }
        map.insert(shell, shell, &images, &trust);
        map.insert_odd(shell, &odd);
    }

    /// Images under the only pairing of the searched shell that the connectivity admits; `None` if it pairs less than half of the shell.
    pub fn images_of_all(&self, found: &Automorphism) -> Option<VertexMap> {
        let partner =
            |point: u32| if found.unrivalled[point as usize] { found.partner[point as usize] } else { NONE };
        images_by(self.searched(), self.proxy, self.gatherer.mesh, partner)
    }
}

/// Images of a shell's vertices, or of its proxy's, where the mesh's points have a `partner`; a vertex without one goes where the nearest with one goes. `None` if
/// less than half of the shell has one.
fn images_by(
    shell: &Shell,
    proxy: Option<&Proxy>,
    mesh: &Mesh,
    partner: impl Fn(u32) -> u32,
) -> Option<VertexMap> {
    let mut local = vec![NONE; mesh.positions.len()];
    for (index, &point) in shell.points.iter().enumerate().filter(|(_, point)| **point != NONE) {
        local[point as usize] = index as u32;
    }
    let image = |&point: &u32| match point {
        NONE => NONE,
        point => local.get(partner(point) as usize).copied().unwrap_or(NONE),
    };
    let mut partners: Vec<u32> = shell.points.iter().map(image).collect();
    let left_out = partners.iter().filter(|&&partner| partner == NONE).count();
    if 2 * left_out > partners.len() {
        return None;
    }
    if left_out > 0 {
        fill_from_neighbours(&mut partners, shell);
    }
    Some(match proxy {
        Some(proxy) => proxy.restrict(&partners),
        None => VertexMap::at_vertices(&shell.triangles, partners),
    })
}

/// Gives vertices without a partner that of the nearest vertex with one, counted in edges, or in space where a piece has none.
fn fill_from_neighbours(partners: &mut [u32], shell: &Shell) {
    let Shell { positions, triangles, .. } = shell;
    let fans = Fans::new(partners.len(), triangles);
    let has_partner = |vertex: &u32| partners[*vertex as usize] != NONE;
    let paired: Vec<u32> = (0..partners.len() as u32).filter(has_partner).collect();
    let around = |vertex: u32| fans.of(vertex).iter().flat_map(|&triangle| triangles[triangle as usize]);
    let nearest = nearest_seeds(partners.len(), &paired, around);
    let leaf = |&vertex: &u32| GeomWithData::new(positions[vertex as usize], vertex);
    let tree = LazyCell::new(|| RTree::bulk_load(paired.iter().map(leaf).collect()));
    for vertex in 0..partners.len() {
        let in_space = || tree.nearest_neighbor(positions[vertex]).expect("some are paired").data;
        if partners[vertex] == NONE {
            let near = paired.get(nearest[vertex] as usize).copied().unwrap_or_else(in_space);
            partners[vertex] = partners[near as usize];
        }
    }
}
