//! Mean curvature, diffused over the surface: what the last refinement knows of the shape in space.
//!
//! A reflection keeps the mean curvature of a surface and a change of pose changes it at joints alone, so it
//! holds a map in place where eigenfunctions hardly do: a twist of a limb around its own axis. The curvature
//! of a vertex is half the normal part of its cotangent Laplacian (M. Meyer, M. Desbrun, P. Schroeder, A. H.
//! Barr, "Discrete Differential-Geometry Operators for Triangulated 2-Manifolds", 2003, section 3.5); one
//! implicit step of heat diffusion takes the noise away (M. Desbrun, M. Meyer, P. Schroeder, A. H. Barr,
//! "Implicit Fairing of Irregular Meshes using Diffusion and Curvature Flow", 1999).

use super::SymmetricSparse;
use crate::mesh::Shell;
use crate::mesh::vector::{dot, summed_normals};
use crate::spectral::signature::mean;

/// Times of diffusion in units of the area: heat spreads over about 0.035 and 0.06 sqrt(area).
const TIMES: [f64; 2] = [0.0003, 0.001];
/// Share of the surface at either end of the curvature's range that is cut to the range of the rest: creases,
/// tips and bad triangles.
const TRIMMED: f64 = 0.02;
/// Largest value of a channel, in root mean squares.
const LARGEST: f64 = 3.0;

const SOLVER_STEPS: usize = 200;
const SOLVER_TOLERANCE: f64 = 1e-4;

/// Diffused mean curvature, one column a time of diffusion.
///
/// Each has mean 0 and the squares of all columns together mean 1 (before the largest values are cut).
/// Empty for a shell without an inside and an outside, and for one without curvature. At most [`SOLVER_STEPS`]
/// times O(vertices) a column.
pub fn channels(shell: &Shell, stiffness: &SymmetricSparse, lumped_mass: &[f64]) -> Vec<Vec<f64>> {
    if !shell.orientable || shell.positions.is_empty() {
        return Vec::new();
    }
    let mut curvature = mean_curvature(shell, stiffness, lumped_mass);
    trim(&mut curvature);
    let diffused = TIMES.map(|time| diffuse(&curvature, time, stiffness, lumped_mass));
    diffused.into_iter().filter_map(|values| standardise(values, lumped_mass)).collect()
}

/// Signed mean curvature of every vertex, positive where the surface is convex; 0 on boundaries and where the
/// surface is no manifold.
fn mean_curvature(shell: &Shell, stiffness: &SymmetricSparse, lumped_mass: &[f64]) -> Vec<f64> {
    let normals = summed_normals(&shell.positions, &shell.triangles);
    let mut triangles_around = vec![0; shell.positions.len()];
    shell.triangles.as_flattened().iter().for_each(|&vertex| triangles_around[vertex as usize] += 1);
    let curvature = |vertex: usize| {
        // An inner vertex has as many neighbours as triangles; a row holds the vertex itself, too.
        let inner = stiffness.neighbours(vertex).len() == triangles_around[vertex] + 1;
        let normal = normals[vertex];
        let length = dot(normal, normal).sqrt();
        let along: f64 =
            stiffness.row(vertex).map(|(other, weight)| weight * dot(shell.positions[other], normal)).sum();
        if inner && length > 0.0 { 0.5 * along / (length * lumped_mass[vertex]) } else { 0.0 }
    };
    (0..shell.positions.len()).map(curvature).collect()
}

/// Cuts the ends of the values' range.
fn trim(values: &mut [f64]) {
    let mut sorted = values.to_vec();
    let cut = (TRIMMED * values.len() as f64) as usize;
    let last = values.len() - 1 - cut;
    let lowest = *sorted.select_nth_unstable_by(cut, f64::total_cmp).1;
    let highest = *sorted.select_nth_unstable_by(last, f64::total_cmp).1;
    values.iter_mut().for_each(|value| *value = value.clamp(lowest, highest));
}

/// One implicit step: `(mass + time * stiffness) result = mass * values`, by conjugate gradients with the
/// diagonal as preconditioner.
fn diffuse(values: &[f64], time: f64, stiffness: &SymmetricSparse, mass: &[f64]) -> Vec<f64> {
    let apply = |x: &[f64], out: &mut [f64]| {
        for (i, out) in out.iter_mut().enumerate() {
            let flow: f64 = stiffness.row(i).map(|(j, weight)| weight * x[j]).sum();
            *out = mass[i] * x[i] + time * flow;
        }
    };
    let diagonal = |i: usize| {
        mass[i] + time * stiffness.row(i).filter(|(j, _)| *j == i).map(|(_, weight)| weight).sum::<f64>()
    };
    let inverse: Vec<f64> = (0..mass.len()).map(|i| diagonal(i).recip()).collect();
    let inner = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    let precondition =
        |residual: &[f64]| -> Vec<f64> { residual.iter().zip(&inverse).map(|(r, d)| r * d).collect() };
    let mut result = values.to_vec();
    let mut image = vec![0.0; values.len()];
    apply(&result, &mut image);
    let mut residual: Vec<f64> = (0..values.len()).map(|i| mass[i] * values[i] - image[i]).collect();
    let mut conditioned = precondition(&residual);
    let mut direction = conditioned.clone();
    let mut energy = inner(&residual, &conditioned);
    let enough = SOLVER_TOLERANCE.powi(2) * energy;
    for _ in 0..SOLVER_STEPS {
        if energy <= enough || energy <= f64::MIN_POSITIVE {
            break;
        }
        apply(&direction, &mut image);
        let step = energy / inner(&direction, &image);
        for i in 0..values.len() {
            result[i] += step * direction[i];
            residual[i] -= step * image[i];
        }
        conditioned = precondition(&residual);
        let before = std::mem::replace(&mut energy, inner(&residual, &conditioned));
        for (direction, conditioned) in direction.iter_mut().zip(&conditioned) {
            *direction = conditioned + energy / before * *direction;
        }
    }
    result
}

/// Mean 0 and mean square 1 over the number of channels, the largest values cut; `None` for a constant.
fn standardise(mut values: Vec<f64>, mass: &[f64]) -> Option<Vec<f64>> {
    let (middle, largest) =
        (mean(mass, values.iter().copied()), values.iter().fold(0f64, |most, value| most.max(value.abs())));
    values.iter_mut().for_each(|value| *value -= middle);
    let deviation = mean(mass, values.iter().map(|value| value * value)).sqrt();
    // What rounding leaves of the constant curvature of a sphere is no feature of it.
    if deviation.is_nan() || deviation <= 1e-3 * largest {
        return None;
    }
    let share = (TIMES.len() as f64).sqrt();
    values.iter_mut().for_each(|value| *value = (*value / deviation).clamp(-LARGEST, LARGEST) / share);
    Some(values)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::limits::Limits;
    use crate::mesh::{Mesh, PolygonMesh};
    use crate::spectral::laplacian::IntrinsicSurface;
    use std::f64::consts::TAU;

    /// A grid of quads whose columns close; its rows close where `rows_close`.
    fn grid(columns: u32, rows: u32, rows_close: bool, place: impl Fn(u32, u32) -> [f64; 3]) -> Shell {
        let quads = if rows_close { rows } else { rows - 1 };
        let positions = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
        let corner = |column: u32, row: u32| (row % rows) * columns + column % columns;
        let faces: Vec<[u32; 4]> = (0..quads)
            .flat_map(|row| (0..columns).map(move |column| (column, row)))
            .map(|(i, j)| [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)])
            .collect();
        let polygons = PolygonMesh {
            positions: positions.map(|(column, row)| place(column, row)).collect(),
            face_offsets: (0..=faces.len() as u32).map(|face| 4 * face).collect(),
            face_vertices: faces.into_iter().flatten().collect(),
        };
        Mesh::new(&polygons, &Limits::default()).expect("a usable mesh").shells().remove(0)
    }

    fn torus() -> Shell {
        grid(120, 60, true, |column, row| {
            let (around, tube) = (TAU * f64::from(column) / 120.0, TAU * f64::from(row) / 60.0);
            let distance = 1.0 + 0.4 * tube.cos();
            [distance * around.cos(), distance * around.sin(), 0.4 * tube.sin()]
        })
    }

    fn cylinder() -> Shell {
        grid(60, 30, false, |column, row| {
            let angle = TAU * f64::from(column) / 60.0;
            [angle.cos(), angle.sin(), 0.1 * f64::from(row)]
        })
    }

    #[test]
    fn a_torus_has_the_mean_curvature_of_its_closed_form() {
        let shell = torus();
        let surface = IntrinsicSurface::new(&shell);
        let curvature = mean_curvature(&shell, &surface.stiffness, &surface.lumped_mass);
        let unit = shell.positions.iter().map(|p| dot(*p, *p).sqrt()).fold(0.0, f64::max) / 1.4;
        // Single vertices have more or fewer triangles than their neighbours: rings around the axis are measured.
        for (row, (found, mass)) in curvature.chunks(120).zip(surface.lumped_mass.chunks(120)).enumerate() {
            let cosine = (TAU * row as f64 / 60.0).cos();
            let expected = (1.0 + 0.8 * cosine) / (0.8 * (1.0 + 0.4 * cosine)) / unit;
            let found = found.iter().zip(mass).map(|(h, m)| h * m).sum::<f64>() / mass.iter().sum::<f64>();
            assert!((found - expected).abs() < 0.02 * expected.abs() + 0.02, "{row}: {found} {expected}");
        }
    }

    #[test]
    fn channels_have_mean_zero_and_together_mean_square_one() {
        let surface = IntrinsicSurface::with_mean_curvature(&torus());
        let mean = |column: &[f64], power| -> f64 {
            column.iter().zip(&surface.lumped_mass).map(|(value, mass)| mass * value.powi(power)).sum()
        };
        assert_eq!(surface.mean_curvature.len(), TIMES.len());
        assert!(surface.mean_curvature.iter().all(|column| mean(column, 1).abs() < 1e-9));
        let squares: f64 = surface.mean_curvature.iter().map(|column| mean(column, 2)).sum();
        assert!((squares - 1.0).abs() < 1e-3, "{squares}");
    }

    #[test]
    fn diffusion_solves_its_equation_and_keeps_the_total() {
        let surface = IntrinsicSurface::with_mean_curvature(&torus());
        let mass = &surface.lumped_mass;
        let values: Vec<f64> = (0..mass.len()).map(|i| ((i * 7919) % 101) as f64).collect();
        let time = 0.01;
        let found = diffuse(&values, time, &surface.stiffness, mass);
        let scale: f64 = values.iter().zip(mass).map(|(value, mass)| value * mass).sum();
        let kept: f64 = found.iter().zip(mass).map(|(value, mass)| value * mass).sum();
        assert!((kept / scale - 1.0).abs() < 1e-3, "{kept} of {scale}");
        let squared_residual = |x: &[f64]| -> f64 {
            let flow = |i: usize| surface.stiffness.row(i).map(|(j, weight)| weight * x[j]).sum::<f64>();
            (0..mass.len()).map(|i| (mass[i] * (x[i] - values[i]) + time * flow(i)).powi(2)).sum()
        };
        assert!(squared_residual(&found) < 1e-6 * squared_residual(&values));
    }

    #[test]
    fn a_cylinder_has_no_channels_but_at_its_rims_and_its_rims_no_curvature() {
        let shell = cylinder();
        let surface = IntrinsicSurface::new(&shell);
        let curvature = mean_curvature(&shell, &surface.stiffness, &surface.lumped_mass);
        assert!(curvature[..60].iter().chain(&curvature[29 * 60..]).all(|value| *value == 0.0));
        let unit = (shell.positions[29 * 60][2] - shell.positions[0][2]) / 2.9;
        assert!(curvature[60..29 * 60].iter().all(|value| (value * unit / 0.5 - 1.0).abs() < 0.01));
    }

    #[test]
    fn a_surface_without_sides_has_no_channels() {
        let mut shell = torus();
        shell.orientable = false;
        assert!(IntrinsicSurface::with_mean_curvature(&shell).mean_curvature.is_empty());
    }

    #[test]
    fn a_constant_is_no_channel() {
        assert_eq!(standardise(vec![2.0; 5], &[0.2; 5]), None);
        assert_eq!(standardise(vec![0.0; 5], &[0.2; 5]), None);
    }
}
