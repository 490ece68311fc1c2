//! `intrinsym info`: what the reader found in a file, and what was repaired.

use crate::Ending;
use crate::arguments::Info;
use crate::summary::{counted, measure, repairs};
use crate::terminal;
use intrinsym::internals::mesh::vector::triangle_area;
use intrinsym::io::MeshFile;
use intrinsym::{Mesh, Result};
use serde::Serialize;
use serde_json::{Value, json};
use std::collections::HashMap;

/// Most shells that the text lists.
const SHELLS_SHOWN: usize = 12;

/// Runs the command.
pub fn run(arguments: &Info) -> Ending {
    match describe(arguments) {
        Ok(text) => terminal::answer(&text, arguments.common.quiet),
        Err(error) => terminal::complain(&arguments.input, &error),
    }
}

fn describe(arguments: &Info) -> Result<String> {
    let limits = arguments.common.limits();
    let file = arguments.common.read(&arguments.input)?;
    let mesh = Mesh::new(&file.polygons, &limits)?;
    let name = arguments.input.display();
    Ok(match arguments.json {
        true => format!("{:#}\n", json_facts(&name.to_string(), &file, &mesh)),
        false => format!("{name}:\n{}", text_facts(&file, &mesh)),
    })
}

fn json_facts(name: &str, file: &MeshFile, mesh: &Mesh) -> Value {
    json!({
        "input": name,
        "format": file.format,
        "notes": file.notes,
        "vertices": mesh.point_of_vertex.len(),
        "faces": mesh.face_count,
        "triangles": mesh.triangles.len(),
        "area": mesh.unit_length * mesh.unit_length,
        "unit_length": mesh.unit_length,
        "centre": mesh.centre,
        "extent": extent(mesh),
        "shells": shell_facts(mesh),
        "repairs": mesh.repairs,
    })
}

fn text_facts(file: &MeshFile, mesh: &Mesh) -> String {
    let [width, depth, height] = extent(mesh).map(measure);
    let mut lines = vec![
        format!(
            "{:?}, {} vertices, {} ({})",
            file.format,
            mesh.point_of_vertex.len(),
            counted(mesh.face_count, "face"),
            counted(mesh.triangles.len(), "triangle")
        ),
        format!("extent {width} x {depth} x {height}, area {}", measure(mesh.unit_length.powi(2))),
        counted(mesh.shell_count, "shell"),
    ];
    let shells = shell_facts(mesh);
    let shown = if shells.len() > SHELLS_SHOWN + 1 { SHELLS_SHOWN } else { shells.len() };
    lines.extend(shells[..shown].iter().map(|shell| format!("  {}", shell.text())));
    if shown < shells.len() {
        lines.push(format!("  and {} smaller ones (--json lists all)", shells.len() - shown));
    }
    lines.extend(file.notes.iter().cloned());
    lines.extend(repairs(&mesh.repairs));
    lines.into_iter().map(|line| format!("  {line}\n")).collect()
}

/// Size of the box round the surface, in the caller's unit.
fn extent(mesh: &Mesh) -> [f64; 3] {
    std::array::from_fn(|axis| {
        let values = mesh.positions.iter().map(|position| position[axis]);
        let high = values.clone().fold(f64::NEG_INFINITY, f64::max);
        (high - values.fold(f64::INFINITY, f64::min)) * mesh.unit_length
    })
}

/// One connected piece of the surface.
#[derive(Debug, Clone, Default, Serialize)]
struct ShellFacts {
    points: usize,
    triangles: usize,
    /// In the caller's unit squared.
    area: f64,
    /// Edges with a triangle on one side only.
    boundary_edges: usize,
    orientable: bool,
}

impl ShellFacts {
    fn text(&self) -> String {
        let boundary = match self.boundary_edges {
            0 => "closed".to_string(),
            count => counted(count, "boundary edge"),
        };
        let orientable = if self.orientable { "" } else { ", not orientable" };
        format!(
            "{} points, {}, area {}, {boundary}{orientable}",
            self.points,
            counted(self.triangles, "triangle"),
            measure(self.area)
        )
    }
}

/// The facts of every shell, by falling area.
fn shell_facts(mesh: &Mesh) -> Vec<ShellFacts> {
    let mut facts: Vec<ShellFacts> = mesh
        .shell_orientable
        .iter()
        .map(|&orientable| ShellFacts { orientable, ..ShellFacts::default() })
        .collect();
    for &shell in &mesh.shell_of_point {
        facts[shell as usize].points += 1;
    }
    let shell_of = |point: u32| mesh.shell_of_point[point as usize] as usize;
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|point| mesh.positions[point as usize]);
        let facts = &mut facts[shell_of(triangle[0])];
        facts.triangles += 1;
        facts.area += triangle_area(a, b, c) * mesh.unit_length * mesh.unit_length;
    }
    for (edge, count) in edge_uses(mesh) {
        facts[shell_of(edge[0])].boundary_edges += usize::from(count == 1);
    }
    facts
}

/// How many triangles use each edge.
fn edge_uses(mesh: &Mesh) -> HashMap<[u32; 2], u32> {
    let mut uses = HashMap::with_capacity(3 * mesh.triangles.len() / 2);
    for &[a, b, c] in &mesh.triangles {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            *uses.entry([from.min(to), from.max(to)]).or_insert(0) += 1;
        }
    }
    uses
}
