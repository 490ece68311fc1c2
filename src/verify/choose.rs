//! Which of the finished maps is the answer.

use crate::base::error::Result;
use crate::base::symmetry_kind::SymmetryKind;
use crate::search::candidates::GAP;
use crate::verify::acceptance::Judgement;
use crate::verify::hypothesis::Hypothesis;
use crate::verify::outcome::{Outcome, outcome};
use crate::verify::reason::Reason;

/// What is asked of the plausibility of a map for which the connectivity or the vertices speak, in percent.
pub const ANY: usize = 0;
/// A map of this plausibility comes before one that exchanges sheets.
const LIKELY: f64 = 0.5;

/// Maps of the searched shell, the best first.
pub type Maps = Vec<(Hypothesis, SymmetryKind)>;

/// The only reflection that the connectivity admits.
pub struct OneReflection<F> {
    /// Makes its map: asked only if that is the answer.
    pub map: F,
    /// Whether the connectivity admits it but for a few defects.
    pub has_defects: bool,
}

/// An answer, before it is carried to the caller's mesh.
pub struct Choice {
    /// The maps that are given.
    pub maps: Maps,
    /// What was asked of the plausibility of the first, in percent.
    pub asked: usize,
    /// The best map, which is refused if `maps` has none.
    best: Option<(Hypothesis, SymmetryKind)>,
    /// Why these.
    pub reasons: Vec<Reason>,
}

/// The best of the `finished` maps for whoever asks for at most `count` symmetries of `asked` percent of plausibility; if none of them counts
/// that of the connectivity; else the best one, if it is half as plausible as asked and `mirrors_vertices` of it, or if it may be doubtful.
///
/// # Errors
/// Those of `mirrors_vertices` and of the connectivity's map.
pub fn choose<F: FnOnce() -> Result<Hypothesis>>(
    finished: Maps,
    one: Option<OneReflection<F>>,
    mirrors_vertices: impl FnOnce(&Hypothesis, SymmetryKind) -> Result<bool>,
    (asked, count): (usize, usize),
) -> Result<Choice> {
    let best = finished.first().cloned();
    let mut choice = Choice { maps: finished, asked, best, reasons: Vec::new() };
    choice.reasons.push(choice.best.as_ref().map_or(Reason::NoCandidate, |(map, _)| verdict(map, asked)));
    retain_symmetries(&mut choice.maps, asked);
    choice.maps.truncate(count);
    if let Some(OneReflection { map, has_defects }) = one {
        let is_answer = choice.maps.is_empty();
        choice.reasons.push(Reason::OneReflection { has_defects, is_answer });
        if is_answer {
            choice.take((map()?, SymmetryKind::Reflection));
        }
    }
    let refused = choice.best.clone().filter(|_| choice.maps.is_empty());
    if let Some((map, kind)) = refused.filter(|(map, _)| map.judged.accepted(asked.div_ceil(2)))
        && mirrors_vertices(&map, kind)?
    {
        choice.reasons.push(Reason::MirroredVertices);
        choice.take((map, kind));
    }
    choice.or_doubtful();
    Ok(choice)
}

impl Choice {
    fn take(&mut self, map: (Hypothesis, SymmetryKind)) {
        self.asked = ANY;
        self.maps.push(map);
    }

    /// How the best map was judged, accepted or not.
    pub fn judged(&self) -> Option<Judgement> {
        self.best.as_ref().map(|(map, _)| map.judged)
    }

    /// Gives the best map where none counts but it may be doubtful.
    fn or_doubtful(&mut self) {
        let asked = self.asked;
        let is_given = |map: &Hypothesis| outcome(map.judged.plausibility, asked, 1.0, 1.0) != Outcome::None;
        if self.maps.is_empty() {
            self.maps.extend(self.best.clone().filter(|(map, _)| is_given(map)));
        }
    }
}

/// How a map was judged for whoever asks for `accepted_from` percent of plausibility.
pub fn verdict(map: &Hypothesis, accepted_from: usize) -> Reason {
    Reason::BestMap { judged: map.judged, score: map.score, accepted_from }
}

/// Leaves the maps that count as symmetries from `least` percent on: none, or the first and those not much worse than
/// the best.
pub fn retain_symmetries<T>(maps: &mut Vec<(Hypothesis, T)>, least: usize) {
    maps.retain(|(map, _)| map.judged.accepted(least));
    let best = maps.iter().map(|(map, _)| map.judged.isometry_score).fold(f64::INFINITY, f64::min);
    let mut first = true;
    maps.retain(|(map, _)| std::mem::take(&mut first) || map.judged.isometry_score < best + GAP);
}

/// Sorts maps by kind, those of a kind by their plausibility, the highest first. `kind_plausibility_sheets` says of a map whether it exchanges sheets,
/// too: then it comes behind all that are likely.
pub fn rank<M>(maps: &mut [M], kind_plausibility_sheets: impl Fn(&M) -> (SymmetryKind, f64, bool)) {
    let merit = |map: &M| {
        let (kind, plausibility, exchanges_sheets) = kind_plausibility_sheets(map);
        (kind, if exchanges_sheets { plausibility.min(LIKELY) } else { plausibility })
    };
    maps.sort_by(|a, b| {
        let ((kind, own), (other_kind, other)) = (merit(a), merit(b));
        kind.cmp(&other_kind).then(other.total_cmp(&own))
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::vertex_map::VertexMap;
    use crate::search::candidate_score::Score;
    use SymmetryKind::{HalfTurn, Reflection};
    use faer::Mat;

    /// A map of this plausibility, known by its size.
    fn hypothesis(plausibility: f64, size: usize) -> Hypothesis {
        let score = Score {
            commutator: 0.05,
            orientation: -1.0,
            fixed: 0.0,
            disagreement: 0.0,
            trace: 0.0,
            by_twins: false,
        };
        let judged = Judgement { plausibility, ..Judgement::new(&score, 0.3, 0.7) };
        let images = VertexMap { partners: Vec::new(), points: Vec::new() };
        Hypothesis { map: Mat::zeros(size, size), images, score, doubts: Vec::new(), judged }
    }

    /// What is chosen of reflections of these plausibilities, of sizes 1, 2 and so on, for whoever asks for 50 percent; that of the
    /// connectivity is of size 9.
    fn chosen(plausibilities: &[f64], by_connectivity: bool, mirrors_vertices: bool) -> (Vec<usize>, Choice) {
        let maps = plausibilities.iter().enumerate();
        let maps = maps.map(|(place, &own)| (hypothesis(own, place + 1), Reflection)).collect();
        let one =
            by_connectivity.then_some(OneReflection { map: || Ok(hypothesis(0.3, 9)), has_defects: true });
        let choice = choose(maps, one, |_, _| Ok(mirrors_vertices), (50, 2)).unwrap();
        (choice.maps.iter().map(|(map, _)| map.map.nrows()).collect(), choice)
    }

    #[test]
    fn accepted_maps_are_the_answer_as_many_as_are_asked_for() {
        let (given, choice) = chosen(&[0.9, 0.8, 0.7, 0.2], false, false);
        assert_eq!((given, choice.asked), (vec![1, 2], 50));
        let (given, _) = chosen(&[0.2, 0.8], false, false);
        assert_eq!(given, [2]);
        assert_eq!(choice.judged().unwrap().plausibility, 0.9);
    }

    #[test]
    fn the_reflection_of_the_connectivity_is_the_answer_where_no_map_is_accepted() {
        let (given, choice) = chosen(&[0.4], true, true);
        assert_eq!((given, choice.asked), (vec![9], ANY));
        let reason = |is_answer| Reason::OneReflection { has_defects: true, is_answer };
        assert_eq!(choice.reasons[1..], [reason(true)]);
        let (given, choice) = chosen(&[0.6], true, true);
        assert_eq!((given, choice.asked), (vec![1], 50));
        assert_eq!(choice.reasons[1..], [reason(false)]);
    }

    #[test]
    fn mirrored_vertices_speak_for_a_map_that_is_half_as_plausible_as_asked() {
        let (given, choice) = chosen(&[0.25], false, true);
        assert_eq!((given, choice.asked), (vec![1], ANY));
        assert_eq!(choice.reasons[1..], [Reason::MirroredVertices]);
        assert_eq!(chosen(&[0.24], false, true).1.reasons.len(), 1);
    }

    #[test]
    fn what_is_refused_is_given_as_doubtful_unless_it_is_hopeless() {
        let (given, choice) = chosen(&[0.12, 0.11], false, false);
        assert_eq!((given, choice.asked), (vec![1], 50));
        assert!(chosen(&[0.09], false, false).0.is_empty());
        let (given, choice) = chosen(&[], false, false);
        assert!(given.is_empty() && choice.judged().is_none());
        assert_eq!(choice.reasons, [Reason::NoCandidate]);
    }

    #[test]
    fn plausibility_ranks_maps_of_a_kind() {
        let ranked = |mut maps: Vec<(SymmetryKind, f64)>| {
            rank(&mut maps, |(kind, plausibility)| (*kind, *plausibility, false));
            maps.into_iter().map(|(_, plausibility)| plausibility).collect::<Vec<f64>>()
        };
        assert_eq!(ranked(vec![(Reflection, 0.6), (Reflection, 0.4), (Reflection, 0.9)]), [0.9, 0.6, 0.4]);
        assert_eq!(ranked(vec![(Reflection, 0.1), (HalfTurn, 1.0)]), [0.1, 1.0]);
    }

    #[test]
    fn exchanged_sheets_come_behind_what_is_likely() {
        let ranked = |mut maps: Vec<(f64, bool)>| {
            rank(&mut maps, |(plausibility, sheets)| (Reflection, *plausibility, *sheets));
            maps
        };
        assert_eq!(ranked(vec![(1.0, true), (0.51, false)]), [(0.51, false), (1.0, true)]);
        assert_eq!(ranked(vec![(0.49, false), (1.0, true)]), [(1.0, true), (0.49, false)]);
        assert_eq!(ranked(vec![(0.3, true), (0.2, false)]), [(0.3, true), (0.2, false)]);
    }
}
