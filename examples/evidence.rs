//! What confidence is made of, for fitting it: `evaluation/confidence.py` runs this.
//!
//! `cargo run --release --example evidence FOLDER MESH...` writes FOLDER/NAME.evidence for each mesh: for every vertex on which
//! the small plan seeks the map `vertex partner` and the columns of `Evidence::features`. The best map is used, fitted to the rigid
//! parts as answers are, accepted or not, and whatever the connectivity says.

use intrinsym::internals::base::effort::Plan;
use intrinsym::internals::detect::proxy::Proxy;
use intrinsym::internals::detect::shell_symmetry::{PreparedShell, candidates, finish, signs};
use intrinsym::internals::refine::full_refinement::MatchTarget;
use intrinsym::internals::refine::rigid_parts;
use intrinsym::internals::search::candidates::{Hints, Tried};
use intrinsym::internals::spectral::eigenbasis::Eigenbasis;
use intrinsym::internals::spectral::laplacian::IntrinsicSurface;
use intrinsym::internals::spectral::sampling::Samples;
use intrinsym::internals::verify::confidence::Evidence;
use intrinsym::internals::verify::hypothesis::Hypothesis;
use intrinsym::{Limits, Mesh, Options, Progress, SymmetryKind, io};
use std::fmt::Write;
use std::path::Path;

fn main() -> intrinsym::Result<()> {
    let mut arguments = std::env::args().skip(1);
    let folder = arguments.next().expect("a folder to write into, then meshes");
    for mesh in arguments {
        let mesh = Path::new(&mesh);
        let name = mesh.file_stem().expect("a file").display();
        let text = evidence(mesh)?;
        std::fs::write(Path::new(&folder).join(format!("{name}.evidence")), text)
            .expect("a folder to write into");
    }
    Ok(())
}

/// Empty if no candidate reverses orientation.
fn evidence(path: &Path) -> intrinsym::Result<String> {
    let (limits, options, plan) = (Limits::default(), Options::default(), Plan::small());
    let progress = Progress::default();
    let mesh = Mesh::new(&io::read(path, &limits)?.polygons, &limits)?;
    let shells = mesh.shells();
    let proxy = Proxy::new(&shells[0], plan.proxy_vertices, 1);
    let solved = proxy.as_ref().map_or(&shells[0], |proxy| &proxy.shell);
    let surface = IntrinsicSurface::with_mean_curvature(solved);
    let basis = Eigenbasis::new(&surface, plan.eigenfunctions, 1, &progress)?;
    let samples = Samples::farthest(&basis, plan.samples);
    let shell = PreparedShell::new(surface, basis, samples)?;
    let signs = signs(&shell.surface, &shell.basis, &options, &[])?;
    let found = candidates(
        &shell,
        &Hints { signs: &signs, twins: None },
        &plan.search,
        &options,
        &mut Tried::default(),
        &progress,
    )?;
    let Some(candidate) = found.first() else { return Ok(String::new()) };
    let target = MatchTarget::new(&shell.surface, &shell.basis, 1);
    let map = finish(&shell, &target, candidate, &plan, 0, &progress)?;
    let kind = SymmetryKind::Reflection;
    let fitted = rigid_parts::fit(solved, &shell.surface, &map.images, kind, &plan.parts, 1, &progress)?;
    let evidence = Evidence::new(&target, &Hypothesis { images: fitted.images.clone(), ..map });
    let vertex = |local: u32| mesh.vertex_of_point[solved.points[local as usize] as usize];
    let mut text = String::new();
    for (local, partner) in fitted.images.partners.iter().enumerate() {
        write!(text, "{} {}", vertex(local as u32), vertex(*partner)).expect("memory");
        for feature in evidence.features(local) {
            write!(text, " {feature}").expect("memory");
        }
        text.push('\n');
    }
    Ok(text)
}
