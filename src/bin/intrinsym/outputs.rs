//! Where the results of one input go, and writing them.

use crate::arguments::{Colors, Detect, Kind};
use crate::report;
use intrinsym::base::atomic_file::write_atomically;
use intrinsym::base::error::Result;
use intrinsym::base::symmetry_kind::SymmetryKind;
use intrinsym::detect::correspondence::Symmetry;
use intrinsym::detect::driver::Detection;
use intrinsym::mesh::Mesh;
use intrinsym::mesh::io::{self, AttributeValues, MeshFile, VertexAttribute};
use intrinsym::mirror::pair_colour::pair_colours;
use intrinsym::picture;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// The files to write for one input; `None` where none was asked for.
#[derive(Debug, Clone, Default)]
pub struct Outputs {
    ply: Option<PathBuf>,
    map: Option<PathBuf>,
    json: Option<PathBuf>,
    picture: Option<PathBuf>,
}

impl Outputs {
    /// One entry per input.
    ///
    /// # Errors
    /// A sentence for the user if two inputs would write the same file.
    pub fn of_all(arguments: &Detect) -> Result<Vec<Outputs>, String> {
        let Some(folder) = &arguments.output_dir else { return Outputs::named(arguments) };
        let mut taken = BTreeSet::new();
        let each = arguments.inputs.iter().map(|input| {
            let stem = input.file_stem().unwrap_or(input.as_os_str());
            if !taken.insert(stem.to_os_string()) {
                let stem = stem.display();
                return Err(format!(
                    "two inputs are called {stem}: their results would overwrite each other"
                ));
            }
            let file = |kind: Kind, extension: &str| {
                arguments.write.contains(&kind).then(|| {
                    let mut name = stem.to_os_string();
                    name.push(extension);
                    folder.join(name)
                })
            };
            Ok(Outputs {
                ply: file(Kind::Ply, ".ply"),
                map: file(Kind::Map, ".map"),
                json: file(Kind::Json, ".json"),
                picture: file(Kind::Png, ".png"),
            })
        });
        each.collect()
    }

    fn named(arguments: &Detect) -> Result<Vec<Outputs>, String> {
        let outputs = Outputs {
            ply: arguments.output.clone(),
            map: arguments.map.clone(),
            json: arguments.json.clone(),
            picture: arguments.picture.clone(),
        };
        let any = outputs.files().next().is_some();
        if any && arguments.inputs.len() > 1 {
            return Err("several inputs need --output-dir DIR: one output file cannot hold them all".into());
        }
        Ok(vec![outputs; arguments.inputs.len()])
    }

    /// The files, in the order in which they are written.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        [&self.ply, &self.map, &self.picture, &self.json].into_iter().flatten().map(PathBuf::as_path)
    }

    /// Writes every file that was asked for. Where no symmetry was found, every vertex has the partner -1,
    /// so that no result of an earlier run is taken for this one's.
    ///
    /// # Errors
    /// [`Error::File`]; each file is written whole or not at all.
    pub fn write(&self, input: &Input, detection: &Detection, arguments: &Detect) -> Result<()> {
        let none = [no_symmetry(detection.report.vertices)];
        let symmetries = if detection.symmetries.is_empty() { &none[..] } else { &detection.symmetries[..] };
        if let Some(path) = &self.ply {
            io::write_ply(path, input.file, &attributes(input, symmetries, arguments.colors))?;
        }
        for (index, symmetry) in symmetries.iter().enumerate() {
            if let Some(path) = &self.map {
                io::write_map(&numbered(path, index), &symmetry.partner)?;
            }
            if let Some(path) = &self.picture {
                let png = picture::png(input.mesh, symmetry, arguments.up)?;
                write_atomically(&numbered(path, index), |file| file.write_all(&png))?;
            }
        }
        if let Some(path) = &self.json {
            let text = format!("{:#}\n", report::json(input, detection, &arguments.options())?);
            write_atomically(path, |file| file.write_all(text.as_bytes()))?;
        }
        Ok(())
    }
}

/// One mesh as it was read.
pub struct Input<'a> {
    /// Where it came from.
    pub path: &'a Path,
    /// With the attributes of the file.
    pub file: &'a MeshFile,
    /// Validated.
    pub mesh: &'a Mesh,
}

/// `out.map` for the first symmetry, `out_2.map` for the second.
fn numbered(path: &Path, index: usize) -> PathBuf {
    if index == 0 {
        return path.to_path_buf();
    }
    let mut name = path.file_stem().unwrap_or_default().to_os_string();
    name.push(suffix(index));
    if let Some(extension) = path.extension() {
        name.push(".");
        name.push(extension);
    }
    path.with_file_name(name)
}

fn suffix(index: usize) -> String {
    if index == 0 { String::new() } else { format!("_{}", index + 1) }
}

fn no_symmetry(vertices: usize) -> Symmetry {
    Symmetry {
        kind: SymmetryKind::Reflection,
        partner: vec![-1; vertices],
        surface_point: vec![None; vertices],
        confidence: vec![0.0; vertices],
        side: vec![0; vertices],
        fixed_curve: Vec::new(),
        score: f64::INFINITY,
        plausibility: 0.0,
        mean_confidence: 0.0,
        exact_share: 0.0,
    }
}

/// `sym_vertex`, `sym_confidence` and `sym_side` of every symmetry, with a suffix from the second on, and the
/// colours of the first.
fn attributes(input: &Input, symmetries: &[Symmetry], colors: Colors) -> Vec<VertexAttribute> {
    let mut attributes = Vec::new();
    for (index, symmetry) in symmetries.iter().enumerate() {
        let mut add = |name: &str, values: AttributeValues| {
            attributes.push(VertexAttribute { name: format!("{name}{}", suffix(index)), values });
        };
        add("sym_vertex", AttributeValues::Int(symmetry.partner.clone()));
        add("sym_confidence", AttributeValues::Float(symmetry.confidence.clone()));
        add("sym_side", AttributeValues::Int(symmetry.side.iter().copied().map(i32::from).collect()));
    }
    let wanted = match colors {
        Colors::Auto => !input.file.has_vertex_colours(),
        Colors::Always => true,
        Colors::Never => false,
    };
    if wanted {
        let values = AttributeValues::Color(pair_colours(input.mesh, &symmetries[0]));
        attributes.push(VertexAttribute { name: "color".into(), values });
    }
    attributes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_further_symmetries_get_a_number_before_the_extension() {
        assert_eq!(numbered(Path::new("a/b.map"), 0), Path::new("a/b.map"));
        assert_eq!(numbered(Path::new("a/b.c.map"), 1), Path::new("a/b.c_2.map"));
        assert_eq!(numbered(Path::new("map"), 2), Path::new("map_3"));
    }
}
