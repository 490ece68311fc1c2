//! How much work a detection does, as data.
//!
//! One pipeline follows any [`Plan`]. The default effort starts with the small one; if its answer leaves doubts, the same code follows the
//! next. Counts are those of `docs/ablation.md`, which says what each is worth.

use crate::options::Options;
use crate::rigid_parts::PartsEffort;

/// How hard a detection tries.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Effort {
    /// The small plan alone.
    Fast,
    /// The small plan, and where its answer leaves doubts a wider search and then the large one.
    #[default]
    Default,
    /// The large plan at once.
    Thorough,
}

/// Counts that trade time for accuracy.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Plan {
    /// Vertices of the simplified mesh on which maps are sought.
    pub proxy_vertices: usize,
    /// Eigenpairs.
    pub eigenfunctions: usize,
    /// Farthest-point samples on which candidates are refined and scored.
    pub samples: usize,
    /// Points, spread over the shell, on which the best candidate grows.
    pub points: usize,
    /// Sizes of the functional map while it grows; the last is that of the map of all vertices.
    pub schedule: Vec<usize>,
    /// Where candidates come from.
    pub search: Search,
    /// Rigid and turned parts.
    pub parts: PartsEffort,
}

/// Where candidates come from, and how many of them are finished.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Search {
    /// Starts that the sign network proposes.
    pub network_starts: usize,
    /// Width of the beam search over parities; 0 for none, unless there is no network.
    pub beam_width: usize,
    /// Starts that the beam search proposes, of each length.
    pub beam_starts: usize,
    /// Whether the ends of limbs are paired.
    pub limbs: bool,
    /// Whether half turns that fit better than all reflections are turned over.
    pub turned_over: bool,
}

impl Plan {
    /// The plan that most shapes need.
    pub fn small() -> Plan {
        Plan {
            proxy_vertices: 4000,
            eigenfunctions: 64,
            samples: 500,
            points: 2000,
            schedule: vec![20, 28, 36, 44, 52, 60],
            search: Search {
                network_starts: 20,
                beam_width: 0,
                beam_starts: 8,
                limbs: false,
                turned_over: false,
            },
            parts: PartsEffort::default(),
        }
    }

    /// The small plan with a wider search, on what is solved already.
    pub fn wide() -> Plan {
        let small = Plan::small();
        Plan { search: Search { beam_width: 16, turned_over: true, ..small.search }, ..small }
    }

    /// The plan for shapes whose answers by the others leave doubts.
    pub fn large() -> Plan {
        let wide = Plan::wide();
        Plan {
            proxy_vertices: 6000,
            points: 4000,
            search: Search { beam_width: 64, beam_starts: 16, limbs: true, ..wide.search },
            parts: PartsEffort::thorough(),
            ..wide
        }
    }

    /// The plans to follow in turn until an answer leaves no doubts.
    ///
    /// Several symmetries, rotations and stated signs ask for the large one.
    pub fn of(options: &Options) -> Vec<Plan> {
        let several = options.symmetries > 1 || options.rotations > 0;
        let mut plans = match options.effort {
            _ if several => vec![Plan::large()],
            Effort::Fast => vec![Plan::small()],
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
            let last = self.schedule.last().copied().unwrap_or(0);
            self.schedule.extend((last + 10..self.eigenfunctions).step_by(10));
            self.schedule.push(self.eigenfunctions);
        }
    }
}
