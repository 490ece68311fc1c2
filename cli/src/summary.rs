//! What stdout shows: a few lines that a person can read.

use intrinsym::report::curve_length;
use intrinsym::{Detection, Mesh, Outcome, RepairReport, SymmetryKind};
use std::fmt::Write;
use std::path::Path;

/// The whole summary of one detection.
pub fn detection(input: &Path, mesh: &Mesh, detection: &Detection) -> String {
    let report = &detection.report;
    let mut text = format!(
        "{}: {} vertices, {}, {}\n",
        input.display(),
        report.vertices,
        counted(report.faces, "face"),
        counted(report.shells, "shell")
    );
    let outcome = if detection.outcome == Outcome::Doubtful { "doubtful" } else { "found" };
    for (index, symmetry) in detection.symmetries.iter().enumerate() {
        let kind = kind_name(symmetry.kind);
        let number = if index == 0 { String::new() } else { format!(" {}", index + 1) };
        let partners = symmetry.partner.iter().filter(|&&partner| partner >= 0).count();
        let family = if report.continuous_family { ", one of a continuous family" } else { "" };
        let _ = writeln!(
            text,
            "  {outcome}{number}: {kind}{family}, {partners} of {} vertices paired",
            report.vertices
        );
        let _ = writeln!(
            text,
            "    mean confidence {:.2}, exact for {:.0} % of the vertices",
            symmetry.mean_confidence,
            100.0 * symmetry.exact_share
        );
        let _ = writeln!(text, "    {}", symmetry.coverage.in_words());
        if symmetry.kind == SymmetryKind::Reflection {
            let length = curve_length(mesh, &symmetry.fixed_curve);
            let pieces = counted(symmetry.fixed_curve.len(), "piece");
            let _ = writeln!(text, "    fixed curve {} long, in {pieces}", measure(length));
        }
    }
    if detection.symmetries.is_empty() {
        let hint = if report.judged.is_some() { " (--plausibility 0 gives the best map)" } else { "" };
        let _ = writeln!(text, "  no symmetry found{hint}");
    }
    let _ = writeln!(text, "  {}", report.evidence());
    for line in repairs(&report.repairs) {
        let _ = writeln!(text, "  {line}");
    }
    if report.filled_holes > 0 {
        let _ =
            writeln!(text, "  for the search alone: {} filled", counted(report.filled_holes, "small hole"));
    }
    let seconds: f64 = report.seconds.iter().map(|(_, seconds)| seconds).sum();
    let _ = writeln!(text, "  {seconds:.2} s");
    text
}

/// One line for each kind of repair that happened.
pub fn repairs(repairs: &RepairReport) -> Vec<String> {
    let lines = [
        (
            repairs.unreferenced_vertices,
            "vertex that no face uses: without a partner",
            "vertices that no face uses: without a partner",
        ),
        (
            repairs.degenerate_faces,
            "face with fewer than three corners: left out",
            "faces with fewer than three corners: left out",
        ),
        (
            repairs.duplicate_faces,
            "face that repeats another: left out",
            "faces that repeat others: left out",
        ),
        (
            repairs.flipped_faces,
            "face turned to agree with its neighbours",
            "faces turned to agree with their neighbours",
        ),
        (
            repairs.non_manifold_edges,
            "edge with more than two faces: kept",
            "edges with more than two faces: kept",
        ),
        (
            repairs.non_manifold_vertices,
            "vertex with more than one fan of faces: kept",
            "vertices with more than one fan of faces: kept",
        ),
        (
            repairs.welded_vertices,
            "vertex joined with another at its place",
            "vertices joined with others at their place",
        ),
        (repairs.zero_area_faces, "face without area: kept", "faces without area: kept"),
    ];
    lines
        .into_iter()
        .filter(|&(count, _, _)| count > 0)
        .map(|(count, one, many)| format!("repaired: {count} {}", if count == 1 { one } else { many }))
        .collect()
}

/// "1 shell", "2 shells".
pub fn counted(count: usize, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}

/// A length or an area in the caller's unit: six decimals, or as many digits of what is smaller or huge.
pub fn measure(value: f64) -> String {
    if value == 0.0 || (1e-3..1e9).contains(&value) { format!("{value:.6}") } else { format!("{value:.6e}") }
}

/// One line about one of many inputs.
pub fn one_line(input: &Path, detection: &Detection) -> String {
    let seconds: f64 = detection.report.seconds.iter().map(|(_, seconds)| seconds).sum();
    let outcome = match (detection.symmetries.first(), detection.report.judged) {
        (None, None) => "none".to_string(),
        (None, Some(judged)) => format!("none (best map: plausibility {:.0} %)", 100.0 * judged.plausibility),
        (Some(best), _) => format!(
            "{}{}{}, mean confidence {:.2}, exact {:.0} %, partners on {:.0} % of the surface",
            doubts(detection.outcome, best.plausibility),
            kind_name(best.kind),
            if detection.report.continuous_family { " of a continuous family" } else { "" },
            best.mean_confidence,
            100.0 * best.exact_share,
            100.0 * best.coverage.paired_share
        ),
    };
    format!("{}: {outcome}, {seconds:.2} s\n", input.display())
}

fn doubts(outcome: Outcome, plausibility: f64) -> String {
    match outcome {
        Outcome::Doubtful => format!("doubtful (plausibility {:.0} %): ", 100.0 * plausibility),
        Outcome::Found | Outcome::None => String::new(),
    }
}

fn kind_name(kind: SymmetryKind) -> &'static str {
    match kind {
        SymmetryKind::Reflection => "reflection",
        SymmetryKind::HalfTurn => "half turn",
    }
}
