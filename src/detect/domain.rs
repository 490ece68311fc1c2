//! The shell on which the symmetries of a mesh are sought.

use crate::base::error::Result;
use crate::connectivity::automorphism::LengthChange;
use crate::detect::assembler::Gatherer;
use crate::detect::detection::{Detection, Report};
use crate::detect::filled_holes::FilledShell;
use crate::detect::joined_shells::JoinedShells;
use crate::detect::proxy::Proxy;
use crate::detect::question::Question;
use crate::geometry::vertex_map::VertexMap;
use crate::mesh::vector::{Vector, point_areas, squared_norm, subtract};
use crate::mesh::{NONE, Shell};
use crate::spectral::twin_parts::{MOST_PARTS, TwinParts};
use crate::verify::choose::ANY;
use crate::verify::hypothesis::exchanges_sheets;
use crate::verify::reason::Reason;

/// A mesh with the shell on which its symmetries are sought.
pub struct Domain<'a> {
    /// What is asked of which mesh.
    pub question: &'a Question<'a>,
    /// That shell, joined of several or the largest one, and the others.
    pub joined: &'a JoinedShells,
    /// The first of those, its holes filled, if it has some.
    pub filled: Option<FilledShell>,
}

impl<'a> Domain<'a> {
    /// That of a mesh whose shells are `joined`.
    pub fn new(question: &'a Question<'a>, joined: &'a JoinedShells) -> Domain<'a> {
        // Who states signs means those of the functions that the mesh has as it is.
        let fills = question.mechanisms.filled_holes && !question.options.states_signs();
        let filled = FilledShell::new(&joined.shells[0], &joined.joints, fills);
        Domain { question, joined, filled }
    }

    /// The searched shell, its holes filled.
    pub fn searched(&self) -> &Shell {
        self.filled.as_ref().map_or(&self.joined.shells[0], |filled| &filled.shell)
    }

    /// Carries maps of the searched shell, or of its `proxy`, to all shells.
    pub fn gatherer(&self, proxy: Option<&Proxy>) -> Gatherer<'_> {
        self.gatherer_with(self.joined, proxy)
    }

    fn gatherer_with(&self, contacts: &JoinedShells, proxy: Option<&Proxy>) -> Gatherer<'_> {
        let Question { mesh, mechanisms, connectivity, .. } = self.question;
        let vertices = mechanisms.mirrored_vertices;
        Gatherer::new(mesh, &self.joined.shells, contacts, proxy, connectivity.as_ref(), vertices)
    }

    /// The answer where the connectivity of the searched shell admits one reflection and the shape agrees with it: nothing is solved then. Others lie as the
    /// `contacts` of joined shells say, though this one be searched alone.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`], [`crate::Error::Internal`].
    pub fn exact(&self, contacts: &JoinedShells) -> Result<Option<Detection>> {
        let Domain {
            joined: JoinedShells { shells, .. },
            question: Question { mesh, options, progress, .. },
            ..
        } = *self;
        let wanted = options.asks_for_one();
        let Some(found) = self.question.unrivalled.as_ref().filter(|_| wanted) else { return Ok(None) };
        // A pairing of all of them that has no rival, and to which lengths agree, is as good as a bijection, though defects or a part be left out.
        let mut found = found.within(&shells[0].points);
        found.exact.iter_mut().zip(&found.partner).for_each(|(exact, partner)| *exact = *partner != NONE);
        progress.report("lengths", 0.03)?;
        let (Some(partners), Some(change)) =
            (shells[0].numbered(&found.partner), LengthChange::of(mesh, &found))
        else {
            return Ok(None);
        };
        if !change.agrees()
            || exchanges_sheets(root_mean_square(&shells[0], |own| {
                shells[0].positions[partners[own] as usize]
            }))
        {
            return Ok(None);
        }
        let gatherer = self.gatherer_with(contacts, None);
        let symmetry = gatherer.exact(&found, partners, options.threads, progress)?;
        let reasons = vec![Reason::MirroredConnectivity { length_change: change.median }];
        Ok(Some(Detection::new(vec![symmetry], ANY, Report { reasons, ..Report::of(mesh) })))
    }

    /// The joined shell that each vertex of the solved one lies on, and its likely twin; what fills a hole goes with what is beside it.
    pub fn parts(&self, solved: &Shell) -> Option<TwinParts> {
        if self.joined.twins.is_empty() {
            return None;
        }
        let number = self.numbers();
        let mut part_of = vec![NONE; solved.points.len()];
        for (part, &point) in part_of.iter_mut().zip(&solved.points).filter(|(_, point)| **point != NONE) {
            *part = number[self.question.mesh.shell_of_point[point as usize] as usize];
        }
        for triangle in &solved.triangles {
            let known = triangle.iter().map(|&corner| part_of[corner as usize]).find(|&part| part != NONE);
            for &corner in triangle.iter().filter(|_| known.is_some()) {
                let part = &mut part_of[corner as usize];
                *part = if *part == NONE { known.unwrap_or(0) } else { *part };
            }
        }
        let mut twin_of = [0; MOST_PARTS];
        for [own, twin] in self.joined.twins.iter().map(|pair| pair.map(|shell| number[shell as usize])) {
            twin_of[own as usize] = twin as u8;
        }
        Some(TwinParts {
            twin: part_of.iter().map(|&part| twin_of[part as usize]).collect(),
            own: part_of.iter().map(|&part| part as u8).collect(),
        })
    }

    /// The number of each shell among the joined ones. Those of two twins differ in all bits: on the way to its twin, a part's own code is the farthest.
    fn numbers(&self) -> Vec<u32> {
        let last = MOST_PARTS as u32 - 1;
        let mut free = (0..).flat_map(|number| [number, last - number]);
        let mut numbers = vec![NONE; self.question.mesh.shell_count];
        let pairs = self.joined.twins.iter().filter(|[own, twin]| own < twin).flatten();
        let alone = self.joined.twins.iter().filter(|[own, twin]| own == twin).map(|[own, _]| own);
        pairs.chain(alone).zip(&mut free).for_each(|(&shell, number)| numbers[shell as usize] = number);
        numbers
    }
}

/// [`root_mean_square`] of a shell's vertices from their images.
pub fn movement(shell: &Shell, images: &VertexMap) -> f64 {
    root_mean_square(shell, |own| images.points[own].interpolate_vectors(&shell.triangles, &shell.positions))
}

/// Root mean square distance in space of a shell's vertices from where they go, over the surface, in sqrt(area).
fn root_mean_square(shell: &Shell, image: impl Fn(usize) -> Vector) -> f64 {
    let areas = point_areas(&shell.positions, &shell.triangles);
    let moved = |own: usize| squared_norm(subtract(shell.positions[own], image(own)));
    let sum: f64 = areas.iter().enumerate().map(|(own, area)| area * moved(own)).sum();
    (sum / areas.iter().sum::<f64>()).sqrt()
}
