//! What is asked of a mesh, and what its connectivity and its rest pose say before its shells are joined.

use crate::base::effort::Mechanisms;
use crate::base::error::Result;
use crate::base::options::{Effort, Options};
use crate::base::progress::Progress;
use crate::connectivity::automorphism::{Automorphism, Connectivity};
use crate::detect::assembler::Gatherer;
use crate::detect::clock::Clock;
use crate::detect::companions;
use crate::detect::detection::{Detection, Report};
use crate::detect::joined_shells::JoinedShells;
use crate::detect::mirror_plane::MirrorPlane;
use crate::mesh::{Canonical, Mesh};
use crate::verify::reason::Reason;

/// A mesh, what is asked of it, and what is known of it before its shells are joined.
pub struct Question<'a> {
    /// The mesh as the caller gives it.
    pub given: &'a Mesh,
    /// The same in its own frame and numbering.
    pub mesh: &'a Mesh,
    /// The given mesh's point that each of its points is.
    pub given_points: &'a [u32],
    /// What is asked.
    pub options: &'a Options,
    /// What may be used.
    pub mechanisms: Mechanisms,
    /// Who is told, and may cancel.
    pub progress: &'a Progress<'a>,
    /// `None` where it is not mirrored.
    pub connectivity: Option<Connectivity>,
    /// The only reflection that the connectivity admits.
    pub unrivalled: Option<Automorphism>,
}

impl<'a> Question<'a> {
    /// Looks at the connectivity.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`], [`crate::Error::Internal`].
    pub fn new(
        given: &'a Mesh,
        Canonical { mesh, given_points }: &'a Canonical,
        options: &'a Options,
        mechanisms: Mechanisms,
        progress: &'a Progress<'a>,
        clock: &mut Clock,
    ) -> Result<Question<'a>> {
        progress.report("connectivity", 0.01)?;
        let mut connectivity = if mechanisms.connectivity { Connectivity::of(mesh)? } else { None };
        let unrivalled = match &mut connectivity {
            Some(connectivity) => {
                connectivity.find_unrivalled(|found| found.keeps_lengths(mesh), progress)?
            }
            None => None,
        };
        clock.lap("connectivity");
        Ok(Question { given, mesh, given_points, options, mechanisms, progress, connectivity, unrivalled })
    }

    /// Whether parts may be left out that have no counterpart: not where signs are those of the whole surface.
    pub fn may_be_partial(&self) -> bool {
        self.mechanisms.excess && self.options.asks_for_one()
    }

    /// Whether such parts are guessed: not where connectivity tells them.
    pub fn guesses_parts(&self) -> bool {
        self.may_be_partial() && self.options.effort != Effort::Fast && self.unrivalled.is_none()
    }

    /// The answer where a plane in space mirrors the mesh, as it does what is not posed yet: nothing is solved then.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`], [`crate::Error::Internal`].
    pub fn at_rest(&self) -> Result<Option<Detection>> {
        let Question { mesh, options, progress, .. } = *self;
        let wanted = self.mechanisms.mirror_plane && options.asks_for_one();
        progress.report("mirror plane", 0.02)?;
        let Some((plane, is_exact)) = wanted.then(|| MirrorPlane::of(mesh, options.threads)).flatten() else {
            return Ok(None);
        };
        progress.check()?;
        let joined = JoinedShells::alone(mesh.shells());
        let companions = companions::by_plane(mesh, &joined.shells, &plane, progress)?;
        // Vertices that an exact plane mirrors lie at their images.
        let vertices = self.mechanisms.mirrored_vertices && !is_exact;
        let gatherer =
            Gatherer::new(mesh, &joined.shells, &joined, None, self.connectivity.as_ref(), vertices);
        let found = gatherer.by_plane(&plane, &companions, options.threads, progress)?;
        Ok(found.map(|(symmetry, share)| {
            let reasons = vec![Reason::MirrorPlane { share }];
            Detection::new(vec![symmetry], options.plausibility, Report { reasons, ..Report::of(mesh) })
        }))
    }
}
