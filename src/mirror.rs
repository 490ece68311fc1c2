//! What a host does with a symmetry: mirror selections, attributes, displacements and positions.
//!
//! All arrays are in the caller's vertices. Every tool pulls: a vertex asks the surface point that is its
//! mirror image, so that no vertex is left without an answer where left and right differ in density.

pub mod curve_distance;
pub mod faces;
pub mod frames;
pub mod pair_colour;
pub mod positions;

use crate::base::error::{Error, Result};
use crate::base::symmetry_kind::SymmetryKind;
use crate::detect::correspondence::{SurfacePoint, Symmetry};

/// Which vertices take the value of their mirror image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Merge {
    /// Every vertex: the two sides are exchanged.
    Swap,
    /// Every vertex takes the mean of its own and its image's value.
    Average,
    /// Vertices with side -1; the positive side stays.
    PositiveWins,
    /// Vertices with side +1; the negative side stays.
    NegativeWins,
}

/// How mirrored values meet the old ones.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mirroring {
    /// Which vertices change.
    pub merge: Merge,
    /// Vertices with less confidence keep their value; 0..=1.
    pub minimum_confidence: f32,
    /// Whether a vertex changes by the share of its confidence instead of wholly.
    pub weight_by_confidence: bool,
}

impl Mirroring {
    /// All of every vertex, whatever the confidence.
    pub const fn whole(merge: Merge) -> Mirroring {
        Mirroring { merge, minimum_confidence: 0.0, weight_by_confidence: false }
    }

    /// Share of the mirrored value in the new value of each vertex, 0..=1.
    ///
    /// # Errors
    /// [`Error::Option`] for a confidence outside 0..=1, and for one side of a half turn, which has none.
    pub fn shares(&self, symmetry: &Symmetry) -> Result<Vec<f64>> {
        self.check(symmetry.kind)?;
        Ok((0..symmetry.partner.len()).map(|vertex| self.share(symmetry, vertex)).collect())
    }

    fn check(&self, kind: SymmetryKind) -> Result<()> {
        check_confidence(self.minimum_confidence)?;
        let sided = matches!(self.merge, Merge::PositiveWins | Merge::NegativeWins);
        if sided && kind == SymmetryKind::HalfTurn {
            let message = "a half turn has no sides of which one could win; use swap or average".into();
            return Err(Error::Option { name: "merge", message });
        }
        Ok(())
    }

    fn share(&self, symmetry: &Symmetry, vertex: usize) -> f64 {
        let confidence = symmetry.confidence[vertex];
        if symmetry.surface_point[vertex].is_none() || confidence < self.minimum_confidence {
            return 0.0;
        }
        let trust = if self.weight_by_confidence { f64::from(confidence) } else { 1.0 };
        let taken = match (self.merge, symmetry.side[vertex]) {
            (Merge::Swap, _) | (Merge::PositiveWins, -1) | (Merge::NegativeWins, 1) => 1.0,
            (Merge::Average, _) => 0.5,
            _ => 0.0,
        };
        taken * trust
    }
}

fn check_confidence(minimum: f32) -> Result<()> {
    if (0.0..=1.0).contains(&minimum) {
        return Ok(());
    }
    let message = format!("{minimum} is outside 0..=1");
    Err(Error::Option { name: "minimum_confidence", message })
}

/// Mirrors a selection: the vertices whose mirror image lies in it.
///
/// A vertex belongs if half or more of the weight of its image does. A selected vertex that no such vertex
/// names as its partner (a lone vertex on the denser side) selects its own partner, so that no selection
/// vanishes. Vertices below `minimum_confidence` are never selected. O(vertices).
///
/// # Errors
/// [`Error::Option`] for a confidence outside 0..=1.
///
/// # Panics
/// If `selected` has not one entry per vertex.
pub fn mirror_selection(
    symmetry: &Symmetry,
    selected: &[bool],
    minimum_confidence: f32,
) -> Result<Vec<bool>> {
    check_confidence(minimum_confidence)?;
    assert_eq!(selected.len(), symmetry.partner.len());
    let trusted = |vertex: usize| symmetry.confidence[vertex] >= minimum_confidence;
    let indicator: Vec<f64> = selected.iter().map(|&inside| f64::from(u8::from(inside))).collect();
    let belongs = |vertex: usize| {
        let point = symmetry.surface_point[vertex].filter(|_| trusted(vertex));
        point.is_some_and(|point| at(&point, &indicator, 1, 0) >= 0.5)
    };
    let mut mirrored: Vec<bool> = (0..selected.len()).map(belongs).collect();
    let mut named = vec![false; selected.len()];
    for vertex in (0..selected.len()).filter(|&vertex| mirrored[vertex]) {
        named[symmetry.partner[vertex] as usize] = true;
    }
    for vertex in (0..selected.len()).filter(|&vertex| selected[vertex] && !named[vertex]) {
        if let Ok(partner) = usize::try_from(symmetry.partner[vertex])
            && trusted(vertex)
        {
            mirrored[partner] = true;
        }
    }
    Ok(mirrored)
}

/// Mirrors an attribute of `components` values per vertex, given vertex by vertex. O(values).
///
/// Components are mirrored one by one: for vectors in space use [`frames`].
///
/// # Errors
/// As [`Mirroring::shares`].
///
/// # Panics
/// If `values` has not `components` entries per vertex.
pub fn mirror_values(
    symmetry: &Symmetry,
    values: &[f64],
    components: usize,
    mirroring: &Mirroring,
) -> Result<Vec<f64>> {
    assert_eq!(values.len(), components * symmetry.partner.len());
    let mut mirrored = values.to_vec();
    for (vertex, share) in mirroring.shares(symmetry)?.into_iter().enumerate() {
        let Some(point) = symmetry.surface_point[vertex].filter(|_| share > 0.0) else { continue };
        for component in 0..components {
            let value = &mut mirrored[components * vertex + component];
            *value = blend(*value, at(&point, values, components, component), share);
        }
    }
    Ok(mirrored)
}

/// `(1 - share) * own + share * image`, exact at both ends.
fn blend(own: f64, image: f64, share: f64) -> f64 {
    if share >= 1.0 { image } else { (1.0 - share) * own + share * image }
}

/// One component of an attribute at a point of the surface. Corners without weight are not read.
fn at(point: &SurfacePoint, values: &[f64], components: usize, component: usize) -> f64 {
    let (mut sum, mut total) = (0.0, 0.0);
    for (&vertex, &weight) in point.vertices.iter().zip(&point.barycentric) {
        if weight > 0.0 {
            sum += f64::from(weight) * values[components * vertex as usize + component];
            total += f64::from(weight);
        }
    }
    sum / total
}
