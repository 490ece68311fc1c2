//! What is solved of a domain, once for all searches on it.

use crate::base::effort::Plan;
use crate::base::error::Result;
use crate::base::limits::{check_memory, estimated_memory};
use crate::base::threads;
use crate::detect::clock::Clock;
use crate::detect::domain::Domain;
use crate::detect::proxy::{Proxy, simplified};
use crate::detect::question::Question;
use crate::detect::shell_symmetry::{PreparedShell, signs};
use crate::detect::stated_signs;
use crate::search::sign_network::SignPrediction;
use crate::search::twin_starts::TwinDistances;
use crate::spectral::continuous_family::{Orbits, orbits};
use crate::spectral::eigenbasis::Eigenbasis;
use crate::spectral::laplacian::IntrinsicSurface;
use crate::spectral::sampling::Samples;

/// The searched shell or its proxy with all that does not depend on the search.
pub struct Spectrum<'a> {
    /// The plan for which it was made.
    plan: Plan,
    /// The simplified shell, if the shell is too fine to be solved.
    pub proxy: Option<Proxy<'a>>,
    /// What is solved.
    pub shell: PreparedShell,
    /// What is known of the parity of its first functions.
    pub signs: Vec<SignPrediction>,
    /// Whether it has infinitely many symmetries.
    pub orbits: Orbits,
    /// Distances from likely twins.
    pub twins: Option<TwinDistances>,
}

impl<'a> Spectrum<'a> {
    /// Simplifies and solves the searched shell of a domain.
    ///
    /// # Errors
    /// [`crate::Error::Limit`], [`crate::Error::Model`], [`crate::Error::Cancelled`], [`crate::Error::Internal`].
    pub fn new(domain: &'a Domain, plan: &Plan, clock: &mut Clock) -> Result<Spectrum<'a>> {
        let Question { mesh, options, progress, ref mechanisms, .. } = *domain.question;
        progress.report("simplification", 0.04)?;
        let (searched, wanted) = (domain.searched(), plan.proxy_vertices);
        let triangles = simplified(searched, wanted);
        progress.check()?;
        let proxy =
            triangles.and_then(|triangles| Proxy::over(searched, &triangles, wanted, options.threads));
        clock.lap("proxy");
        let solved = proxy.as_ref().map_or(searched, |proxy| &proxy.shell);
        let needed = estimated_memory(mesh.positions.len(), solved.points.len(), plan.eigenfunctions);
        check_memory(needed, options.memory)?;
        progress.report("laplacian", 0.06)?;
        let mut surface = match mechanisms.curvature {
            true => IntrinsicSurface::with_mean_curvature(solved),
            false => IntrinsicSurface::new(solved),
        };
        surface.parts = domain.parts(solved);
        clock.lap("laplacian");
        let basis = Eigenbasis::new(&surface, plan.eigenfunctions, options.threads, progress)?;
        clock.lap("eigenfunctions");
        progress.report("samples", 0.42)?;
        let known = match &proxy {
            Some(proxy) if options.states_signs() => {
                let known = &options.known_signs;
                stated_signs::on_proxy(&domain.joined.shells[0], proxy, &surface, &basis, known, progress)?
            }
            _ => options.known_signs.clone(),
        };
        let (samples, (orbits, signs)) = threads::join(
            options.threads,
            || Samples::farthest(&basis, plan.samples).with_parts(surface.parts.as_ref()),
            || (orbits(&surface, &basis), signs(&surface, &basis, options, &known)),
        );
        clock.lap("samples, signs");
        progress.check()?;
        let twins = TwinDistances::new(&surface, &samples);
        let shell = PreparedShell::new(surface, basis, samples)?;
        Ok(Spectrum { twins, plan: plan.clone(), proxy, shell, signs: signs?, orbits })
    }

    /// Whether it, and what was finished on it, would be the same by another plan: one that differs in the search alone.
    pub fn serves(&self, plan: &Plan) -> bool {
        Plan { search: plan.search.clone(), ..self.plan.clone() } == *plan
    }
}
