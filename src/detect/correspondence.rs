//! The map as the caller gets it: partner, surface point, confidence, side and fixed curve.

use crate::base::symmetry_kind::SymmetryKind;
use crate::detect::coverage::Coverage;

/// A point of the surface: barycentric weights over three of the caller's vertices.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct SurfacePoint {
    /// The caller's face that holds the point.
    pub face: u32,
    /// Three of that face's vertices (the triangle of its triangulation that holds the point).
    pub vertices: [u32; 3],
    /// Weights of `vertices`, each in 0..=1, summing to 1.
    pub barycentric: [f32; 3],
}

/// A point on an edge of the mesh: `(1 - t) * from + t * to`, in the caller's vertices.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct EdgePoint {
    /// First vertex of the edge.
    pub from: u32,
    /// Second vertex of the edge; equal to `from` where the curve passes through a vertex.
    pub to: u32,
    /// Position along the edge, 0..=1.
    pub t: f32,
}

/// A piece of the fixed curve: consecutive points share a face.
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize)]
pub struct Polyline {
    /// The points in order.
    pub points: Vec<EdgePoint>,
    /// Whether the last point joins the first.
    pub closed: bool,
}

/// One symmetry of the mesh, in the caller's numbering. All vectors have one entry per caller's vertex.
#[derive(Debug, Clone, serde::Serialize)]
pub struct Symmetry {
    /// Reflection or half turn.
    pub kind: SymmetryKind,
    /// The partner vertex of each vertex, its image under the symmetry, or -1. Of several vertices in one place it is the one at the
    /// mirrored corner of the mirrored face; where left and right are not split alike, several vertices have one partner.
    #[serde(skip)]
    pub partner: Vec<i32>,
    /// The exact image of each vertex on the surface; `None` where `partner` is -1.
    #[serde(skip)]
    pub surface_point: Vec<Option<SurfacePoint>>,
    /// Probability that the partner lies within 0.05 sqrt(area) of the true mirror image, 0..=1.
    #[serde(skip)]
    pub confidence: Vec<f32>,
    /// +1 on one side of the fixed curve, -1 on the other, 0 on the curve, where there is no partner, and everywhere for a half turn.
    #[serde(skip)]
    pub side: Vec<i8>,
    /// Where a reflection leaves the surface in place.
    #[serde(skip)]
    pub fixed_curve: Vec<Polyline>,
    /// Lower is better; see `candidate_score`.
    pub score: f64,
    /// Probability, 0..=1, that the map is a symmetry at all; see `acceptance`.
    pub plausibility: f64,
    /// Mean of `confidence` over the surface.
    pub mean_confidence: f64,
    /// Share of the vertices whose partner comes from mirrored connectivity, an exact bijection; 0..=1.
    pub exact_share: f64,
    /// How much of the mesh it speaks of.
    #[serde(flatten)]
    pub coverage: Coverage,
}
