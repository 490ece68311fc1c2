//! How much work a detection does, as data.
//!
//! One pipeline follows any [`Plan`]. The default effort starts with the small one; if its answer leaves doubts, the same code follows the
//! next. `make ablate` measures what each count is worth.

use crate::base::options::{Effort, Options};

/// Counts that trade time for accuracy.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Plan {
    /// Vertices of the simplified mesh on which maps are sought.
    pub proxy_vertices: usize,
    /// Eigenpairs.
    pub eigenfunctions: usize,
    /// Farthest-point samples on which candidates are refined and scored.
    pub samples: usize,
    /// Sizes of the functional map while it grows.
    pub schedule: Vec<usize>,
    /// Where candidates come from.
    pub search: Search,
    /// Rigid and turned parts.
    pub parts: PartsEffort,
}

/// Where candidates come from.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Search {
    /// Starts that the sign network proposes.
    pub network_starts: usize,
    /// Width of the beam search over parities, and how many starts of each length it proposes; 0 for none, unless there is no network.
    pub beam_width: usize,
    /// Whether the ends of limbs are paired.
    pub limbs: bool,
    /// Whether half turns that fit better than all reflections are turned over.
    pub turned_over: bool,
}

/// Mechanisms beside the plans, each of which can be switched off for measuring.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Mechanisms {
    /// Connectivity that is mirrored.
    pub connectivity: bool,
    /// Vertices that are mirrored where edges are not.
    pub mirrored_vertices: bool,
    /// Mean curvature beside the eigenfunctions.
    pub curvature: bool,
    /// Small holes filled for the search.
    pub filled_holes: bool,
    /// A mirror plane in space.
    pub mirror_plane: bool,
    /// Parts that have no counterpart left out.
    pub excess: bool,
}

impl Default for Mechanisms {
    fn default() -> Mechanisms {
        Mechanisms {
            connectivity: true,
            mirrored_vertices: true,
            curvature: true,
            filled_holes: true,
            mirror_plane: true,
            excess: true,
        }
    }
}

impl Plan {
    /// The plan that most shapes need.
    pub fn small() -> Plan {
        Plan {
            proxy_vertices: 4000,
            eigenfunctions: 80,
            samples: 500,
            schedule: vec![25, 35, 45, 55, 65, 80, 80],
            search: Search { network_starts: 20, beam_width: 0, limbs: false, turned_over: false },
            parts: PartsEffort::default(),
        }
    }

    /// The small plan on a coarser proxy.
    pub fn fast() -> Plan {
        Plan { proxy_vertices: 2000, ..Plan::small() }
    }

    /// The small plan with a wider search, on what is solved already.
    pub fn wide() -> Plan {
        let small = Plan::small();
        Plan { search: Search { beam_width: 8, limbs: true, turned_over: true, ..small.search }, ..small }
    }

    /// The plan for shapes whose answers by the others leave doubts.
    pub fn large() -> Plan {
        Plan { proxy_vertices: 6000, ..Plan::wide() }
    }

    /// The plans to follow in turn until an answer leaves no doubts.
    ///
    /// Several symmetries ask for the large one.
    pub fn of(options: &Options) -> Vec<Plan> {
        let mut plans = match options.effort {
            _ if options.symmetries > 1 => vec![Plan::large()],
            Effort::Fast => vec![Plan::fast()],
            Effort::Default => vec![Plan::small(), Plan::wide(), Plan::large()],
            Effort::Thorough => vec![Plan::large()],
        };
        plans.iter_mut().for_each(|plan| plan.overrule(options));
        plans
    }

    /// Takes the counts that the options state.
    fn overrule(&mut self, options: &Options) {
        let stated = |own: &mut usize, value: usize| {
            if value > 0 {
                *own = value;
            }
        };
        stated(&mut self.proxy_vertices, options.proxy_vertices);
        stated(&mut self.eigenfunctions, options.eigenfunctions);
        stated(&mut self.samples, options.samples);
        stated(&mut self.search.beam_width, options.beam_width);
        if options.eigenfunctions > 0 {
            self.schedule.retain(|&size| size < self.eigenfunctions);
            let last = self.schedule.last().copied().unwrap_or(0);
            self.schedule.extend((last + 10..self.eigenfunctions).step_by(10));
            self.schedule.push(self.eigenfunctions);
        }
    }
}

/// How much work the fit of the rigid parts may take.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct PartsEffort {
    /// Parts of the first pass, which are large, and of the second.
    pub passes: [usize; 2],
    /// Rounds of the fit of a part's motion.
    pub rounds: usize,
    /// How turned parts are sought; `None` if they are not.
    pub turned: Option<TurnedEffort>,
}

/// The same for turned parts.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct TurnedEffort {
    /// Parts of each size that may be turned.
    pub parts: usize,
    /// Points of each that a motion is fitted to.
    pub points: usize,
    /// Turns about each axis that are tried.
    pub turns: usize,
    /// Small parts all over the surface that say where a turned one takes over.
    pub small: usize,
    /// How many of the turns are fitted to all points.
    pub fitted: usize,
    /// Parts for which turns are sought: those that fit worst.
    pub most: usize,
}

impl PartsEffort {
    /// The same without turned parts.
    pub fn without_turned(self) -> PartsEffort {
        PartsEffort { turned: None, ..self }
    }
}

impl Default for PartsEffort {
    fn default() -> PartsEffort {
        let turned = TurnedEffort { parts: 70, points: 100, turns: 12, small: 150, fitted: 4, most: 24 };
        PartsEffort { passes: [150, 300], rounds: 3, turned: Some(turned) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_schedule_rises_to_the_stated_eigenfunctions() {
        for eigenfunctions in [12, 50, 80, 150] {
            let options = Options { eigenfunctions, ..Options::default() };
            for plan in Plan::of(&options) {
                assert!(plan.schedule.is_sorted(), "{:?}", plan.schedule);
                assert_eq!(plan.schedule.last(), Some(&eigenfunctions));
            }
        }
    }
}
