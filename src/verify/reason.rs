//! Why an answer is what it is: facts for programs, and each in words.

use crate::search::candidate_score::Score;
use crate::verify::acceptance::Judgement;
use std::fmt::{Display, Formatter, Result};

/// One thing that speaks for an answer or against it.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Reason {
    /// A plane in space mirrors so much of the surface, 0..=1; nothing is searched then.
    MirrorPlane {
        /// Share of the surface.
        share: f64,
    },
    /// The connectivity of the largest part admits one reflection, and lengths agree with it; nothing is searched then.
    MirroredConnectivity {
        /// Median of the relative differences between edges and their images.
        length_change: f64,
    },
    /// How the best finished map was judged.
    BestMap {
        /// The measures, and the plausibility.
        judged: Judgement,
        /// The score of its candidate.
        score: Score,
        /// Plausibility in percent from which on it counts.
        accepted_from: usize,
    },
    /// There is no map to judge.
    NoCandidate,
    /// An earlier shape's map leads off the largest shell.
    NotOntoItself,
    /// The connectivity admits one reflection.
    OneReflection {
        /// Whether a few defects are left out of account.
        has_defects: bool,
        /// Whether it is the answer, since no map that was searched is accepted.
        is_answer: bool,
    },
    /// Vertices are each other's mirror images near the best map, which is less plausible than asked for.
    MirroredVertices,
    /// The symmetry is that of a part of the surface that was searched, since the rest has no counterpart.
    OfRest {
        /// Share of that part, 0..=1.
        share: f64,
    },
    /// The shape has infinitely many symmetries.
    ContinuousFamily {
        /// Arbitrary ones of them that are given.
        listed: usize,
    },
    /// The plausibility of the answer is below the one asked for.
    LowPlausibility,
    /// The answer is doubtful for its mean confidence over the surface, 0..=1.
    LowConfidence {
        /// That.
        mean: f64,
    },
    /// The answer is doubtful for the share of the surface that has a partner, 0..=1.
    FewPartners {
        /// That.
        share: f64,
    },
    /// The answer says nothing of nearly the whole surface, and is none.
    NothingSaid {
        /// Mean confidence over the surface, 0..=1.
        mean_confidence: f64,
    },
    /// The time limit ended the search before a larger plan could remove the doubts about the answer.
    TimeLimit,
    /// The symmetry was kept by the caller, and is not judged.
    Restored,
    /// What was known of an earlier shape is no symmetry of this one.
    NotKept {
        /// Why.
        because: Vec<Reason>,
    },
}

/// All of the `reasons`, each in words.
pub fn in_words(reasons: &[Reason]) -> String {
    reasons.iter().map(Reason::to_string).collect::<Vec<String>>().join("; ")
}

impl Display for Reason {
    fn fmt(&self, to: &mut Formatter) -> Result {
        match self {
            Reason::MirrorPlane { share } => {
                write!(to, "a plane in space mirrors {:.0} % of the surface", 100.0 * share)
            }
            Reason::MirroredConnectivity { length_change } => write!(
                to,
                "the connectivity of the largest part admits one reflection, and lengths agree with it: edges and their images differ by {:.1} % in the median",
                100.0 * length_change
            ),
            Reason::BestMap { judged, score, accepted_from } => best_map(judged, score, *accepted_from, to),
            Reason::NoCandidate => to.write_str("no candidate map reverses orientation"),
            Reason::NotOntoItself => to.write_str("it does not map the largest shell onto itself"),
            Reason::OneReflection { has_defects, is_answer } => {
                to.write_str(if *has_defects { "but for a few defects " } else { "" })?;
                to.write_str("its connectivity admits one reflection")?;
                to.write_str(if *is_answer { ", and that is the answer" } else { "" })
            }
            Reason::MirroredVertices => {
                to.write_str("but vertices are each other's mirror images near it, and that is the answer")
            }
            Reason::OfRest { share } => write!(
                to,
                "{:.0} % of the surface that was searched has no counterpart, and the symmetry is that of the rest",
                100.0 * (1.0 - share)
            ),
            Reason::ContinuousFamily { listed } => {
                to.write_str("the shape has a continuous family of symmetries, as a sphere or a vase has")?;
                to.write_str(match listed {
                    1 => ": the one given is an arbitrary one of them",
                    _ => ": those given are arbitrary ones of them",
                })
            }
            Reason::LowPlausibility => {
                to.write_str("its plausibility is below the one asked for: it is given as doubtful")
            }
            Reason::LowConfidence { mean } => {
                write!(to, "it is doubtful: its mean confidence over the surface is {mean:.2}")
            }
            Reason::FewPartners { share } => {
                write!(to, "it is doubtful: {:.0} % of the surface has a partner", 100.0 * share)
            }
            Reason::NothingSaid { mean_confidence } => write!(
                to,
                "but over the whole surface its mean confidence is {mean_confidence:.3}: it is no symmetry of the mesh"
            ),
            Reason::TimeLimit => to.write_str("the time limit ended the search"),
            Reason::Restored => to.write_str("restored from stored arrays"),
            Reason::NotKept { because } => {
                write!(to, "an earlier shape's map was not kept: {}", in_words(because))
            }
        }
    }
}

fn best_map(judged: &Judgement, score: &Score, accepted_from: usize, to: &mut Formatter) -> Result {
    write!(
        to,
        "the best map is a symmetry with a plausibility of {:.0} % (accepted from {accepted_from} %): heat kernel \
         signatures of partners differ by {:.3}, score {:.2}, orientation correlation {:+.2} (-1 for a \
         reflection), {:.0} % of the samples hardly move",
        100.0 * judged.plausibility,
        judged.signature_mismatch,
        score.total(),
        score.orientation,
        100.0 * score.fixed
    )?;
    let Some((apart, scatter)) = judged.disagreement.zip(judged.scatter) else { return Ok(()) };
    write!(
        to,
        ", rigid parts of it put a point {apart:.4} sqrt(area) apart, images leave {:.1} % of the surface empty beyond what is usual",
        100.0 * scatter
    )
}
