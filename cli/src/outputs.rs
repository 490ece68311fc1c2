//! Where the results of one input go, and writing them.

use crate::arguments::{Colors, Detect, Kind};
use crate::picture;
use crate::report;
use crate::targets::{self, Claims, Evidence};
use intrinsym::internals::base::atomic_file::write_atomically;
use intrinsym::io::{AttributeValues, MeshFile, VertexAttribute};
use intrinsym::mirror::pair_colour::pair_colours;
use intrinsym::{Coverage, Detection, Mesh, Result, Symmetry, SymmetryKind, io};
use std::path::{Path, PathBuf};

/// Kinds of results in the order in which they are written: the report, which lists the others, is last.
const KINDS: [(Kind, &str); 5] =
    [(Kind::Ply, "ply"), (Kind::Glb, "glb"), (Kind::Map, "map"), (Kind::Png, "png"), (Kind::Json, "json")];

/// The files to write for one input, and those that earlier runs have left in their place.
#[derive(Debug, Clone, Default)]
pub struct Outputs {
    wanted: Vec<(Kind, PathBuf)>,
    /// What a run into the same folder may have written that this one does not.
    unwanted: Vec<(Kind, PathBuf)>,
    /// Files that stood there before.
    earlier: Vec<PathBuf>,
}

impl Outputs {
    /// One entry per input. Nothing is written.
    ///
    /// # Errors
    /// A sentence for the user if a file would be written twice, or is an input, or is not a result of an earlier run and
    /// `--force` is not given.
    pub fn of_all(arguments: &Detect) -> Result<Vec<Outputs>, String> {
        let any_named = arguments.named_outputs().next().is_some();
        if any_named && arguments.inputs.len() > 1 {
            return Err("several inputs need --output-dir DIR: one output file cannot hold them all".into());
        }
        let mut claims = Claims::of_inputs(arguments.inputs.iter().chain(&arguments.model));
        let most = arguments.options().symmetries;
        let of_input = |input: &PathBuf| {
            let mut outputs = Outputs::of(input, arguments);
            for (kind, path) in outputs.possible(most) {
                claims.claim(&path, format!("the {} of {}", kind.name(), input.display()))?;
            }
            outputs.find_earlier(most, arguments.force)?;
            Ok(outputs)
        };
        arguments.inputs.iter().map(of_input).collect()
    }

    fn of(input: &Path, arguments: &Detect) -> Outputs {
        let Some(folder) = &arguments.output_dir else {
            let wanted = arguments.named_outputs().map(|(kind, path)| (kind, path.clone())).collect();
            return Outputs { wanted, ..Outputs::default() };
        };
        let stem = input.file_stem().unwrap_or(input.as_os_str());
        let file = |(kind, extension): (Kind, &str)| {
            let mut name = stem.to_os_string();
            name.push(".");
            name.push(extension);
            (kind, folder.join(name))
        };
        let (wanted, unwanted) =
            KINDS.into_iter().map(file).partition(|(kind, _)| arguments.write.contains(kind));
        Outputs { wanted, unwanted, earlier: Vec::new() }
    }

    /// All files that a run with up to `most` symmetries may write.
    fn possible(&self, most: usize) -> Vec<(Kind, PathBuf)> {
        let numbers = |kind: Kind| 0..if kind.is_numbered() { most } else { 1 };
        let files = self
            .wanted
            .iter()
            .flat_map(|(kind, path)| numbers(*kind).map(move |index| (*kind, numbered(path, index))));
        files.collect()
    }

    /// Enters the results of earlier runs that stand where this one may write, or beside it under further numbers.
    fn find_earlier(&mut self, most: usize, force: bool) -> Result<(), String> {
        let all = self.wanted.iter().chain(&self.unwanted);
        let report = all.clone().find(|(kind, _)| *kind == Kind::Json).map(|(_, path)| path.as_path());
        let evidence = Evidence::of_report(report);
        for (kind, path) in self.possible(most) {
            if path.exists() && !force && !evidence.is_ours(kind, &path) {
                return Err(targets::exists(&path));
            }
        }
        let found = |(kind, path): &(Kind, PathBuf)| {
            let further = (1..).map(|index| numbered(path, index)).take_while(|path| path.is_file());
            let further: Vec<PathBuf> = if kind.is_numbered() { further.collect() } else { Vec::new() };
            let first = Some(path.clone()).filter(|path| path.is_file());
            first.into_iter().chain(further).filter(|path| evidence.is_ours(*kind, path)).collect::<Vec<_>>()
        };
        self.earlier = all.flat_map(found).collect();
        Ok(())
    }

    /// Results of earlier runs that are still there, beside those just written.
    pub fn left_over(&self, written: &[PathBuf]) -> Vec<&Path> {
        let is_left = |path: &&PathBuf| !written.contains(path) && path.is_file();
        self.earlier.iter().filter(is_left).map(PathBuf::as_path).collect()
    }

    /// Writes every file that was asked for; those written. Where no symmetry was found, every vertex has the partner -1,
    /// so that no result of an earlier run is taken for this one's.
    ///
    /// # Errors
    /// [`Error::File`]; each file is written whole or not at all.
    pub fn write(&self, input: &Input, detection: &Detection, arguments: &Detect) -> Result<Vec<PathBuf>> {
        let none = [no_symmetry(detection.report.vertices)];
        let symmetries = if detection.symmetries.is_empty() { &none[..] } else { &detection.symmetries[..] };
        let mut written = Vec::new();
        for (kind, path) in &self.wanted {
            let count = if kind.is_numbered() { symmetries.len() } else { 1 };
            for (index, symmetry) in symmetries.iter().enumerate().take(count) {
                let path = numbered(path, index);
                match kind {
                    Kind::Ply => {
                        io::write_ply(&path, input.file, &attributes(input, symmetries, arguments.colors))?
                    }
                    Kind::Glb => {
                        io::write_glb(&path, input.file, &attributes(input, symmetries, arguments.colors))?
                    }
                    Kind::Map => io::write_map(&path, &symmetry.partner)?,
                    Kind::Png => {
                        let png = picture::png(input.mesh, symmetry, arguments.up)?;
                        write_atomically(&path, |file| file.write_all(&png))?;
                    }
                    Kind::Json => {
                        let mut left_over = self.left_over(&written);
                        left_over.retain(|file| *file != path);
                        let report =
                            report::json(input, detection, &arguments.options(), &written, &left_over)?;
                        write_atomically(&path, |file| file.write_all(format!("{report:#}\n").as_bytes()))?;
                    }
                }
                written.push(path);
            }
        }
        Ok(written)
    }
}

impl Kind {
    /// Whether each symmetry has a file of its own.
    fn is_numbered(self) -> bool {
        matches!(self, Kind::Map | Kind::Png)
    }

    /// As it stands in messages.
    fn name(self) -> &'static str {
        match self {
            Kind::Map => "map",
            Kind::Ply | Kind::Glb => "mesh",
            Kind::Json => "report",
            Kind::Png => "picture",
        }
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
        coverage: Coverage::default(),
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
