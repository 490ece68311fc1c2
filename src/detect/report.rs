//! The report of a detection as JSON, the same from every host.

use crate::base::error::{Error, Result};
use crate::base::options::Options;
use crate::detect::correspondence::{EdgePoint, Polyline};
use crate::detect::detection::Detection;
use crate::mesh::{Mesh, NONE};
use serde_json::{Value, json};

/// Everything but the maps: version, options, outcome, each symmetry's numbers, and the evidence.
///
/// # Errors
/// [`Error::Internal`] if a number cannot be written.
pub fn json(mesh: &Mesh, detection: &Detection, options: &Options) -> Result<Value> {
    let internal =
        |error: serde_json::Error| Error::Internal(format!("the report cannot be written: {error}"));
    let mut report = serde_json::to_value(detection).map_err(internal)?;
    report["report"]["evidence"] = json!(detection.report.evidence());
    report["version"] = json!(env!("CARGO_PKG_VERSION"));
    report["options"] = serde_json::to_value(options).map_err(internal)?;
    for (index, symmetry) in detection.symmetries.iter().enumerate() {
        let paired = symmetry.partner.iter().filter(|&&partner| partner >= 0).count();
        let entry = &mut report["symmetries"][index];
        entry["paired_vertices"] = json!(paired);
        entry["coverage"] = json!(symmetry.coverage.in_words());
        entry["fixed_curve_length"] = json!(curve_length(mesh, &symmetry.fixed_curve));
        entry["fixed_curve_pieces"] = json!(symmetry.fixed_curve.len());
    }
    Ok(report)
}

/// Length of all pieces, in the caller's unit.
pub fn curve_length(mesh: &Mesh, curve: &[Polyline]) -> f64 {
    let place = |point: &EdgePoint| {
        let at = |vertex: u32| match mesh.point_of_vertex[vertex as usize] {
            NONE => [f64::NAN; 3],
            point => mesh.positions[point as usize],
        };
        let (from, to, t) = (at(point.from), at(point.to), f64::from(point.t));
        std::array::from_fn::<f64, 3, _>(|k| (1.0 - t) * from[k] + t * to[k])
    };
    let distance = |a: &EdgePoint, b: &EdgePoint| {
        let (a, b) = (place(a), place(b));
        (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
    };
    let length = |line: &Polyline| {
        let open: f64 = line.points.windows(2).map(|pair| distance(&pair[0], &pair[1])).sum();
        match (line.closed, &line.points[..]) {
            (true, [first, .., last]) => open + distance(last, first),
            _ => open,
        }
    };
    // Added to zero: the sum of no lengths is -0.
    0.0 + mesh.unit_length * curve.iter().map(length).sum::<f64>()
}
