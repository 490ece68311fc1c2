//! What may be typed. Numeric options come from the table that every host shares.

use crate::picture::Up;
use clap::builder::{PathBufValueParser, PossibleValuesParser, TypedValueParser};
use clap::parser::ValueSource;
use clap::{Arg, ArgMatches, Args, Command as ClapCommand, FromArgMatches, Parser, Subcommand};
use intrinsym::io::{self, MeshFile, Pose};
use intrinsym::{Limits, OPTIONS, OptionSpec, Options, Result};
use std::path::{Path, PathBuf};

const EXIT_STATUS: &str = "Exit status: 0 found (or done), 3 doubtful (the files are written), 1 no symmetry found, 2 error, 130 interrupted, \
     141 nobody reads standard output. Of several meshes the worst counts: 2 if any is an error, else 1 if any has no symmetry, \
     else 3 if any is doubtful.";

/// Finds the intrinsic mirror symmetry of a surface mesh, whatever its pose.
#[derive(Debug, Parser)]
#[command(name = "intrinsym", version, about, after_help = EXIT_STATUS)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The things to do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Find the mirror image of every vertex
    Detect(Box<Detect>),
    /// Say what the reader found in a file and what was repaired
    Info(Info),
    /// Write eigenvalues and eigenfunctions of the Laplace-Beltrami operator
    Eigen(Eigen),
    /// Print what makes a shell complete these commands
    Completions(Completions),
    /// Write the manual pages into a folder
    #[command(hide = true)]
    Manual(Manual),
}

/// `intrinsym completions`.
#[derive(Debug, Args)]
pub struct Completions {
    /// The shell, as in: intrinsym completions bash > ~/.local/share/bash-completion/completions/intrinsym
    #[arg(value_enum, value_name = "SHELL")]
    pub shell: clap_complete::Shell,
}

/// `intrinsym manual`.
#[derive(Debug, Args)]
pub struct Manual {
    /// A folder that exists
    #[arg(value_name = "FOLDER")]
    pub folder: PathBuf,
}

/// `intrinsym detect`.
#[derive(Debug, Args)]
#[command(after_help = EXIT_STATUS)]
pub struct Detect {
    /// Meshes to read: PLY, OBJ, OFF, STL, glTF or GLB
    #[arg(required = true, value_name = "IN")]
    pub inputs: Vec<PathBuf>,

    /// Write the mesh with its attributes, and sym_vertex, sym_confidence, sym_side and pair colours added; as OUT.glb, a glTF keeps
    /// its materials, skins and animations
    #[arg(short, long, value_name = "OUT.ply|OUT.glb",
        value_parser = named(&["ply", "glb"], "the mesh is written as PLY or GLB, which hold every attribute"))]
    pub output: Option<PathBuf>,

    /// Write one 0-based partner per line; -1 for none
    #[arg(long, value_name = "OUT.map")]
    pub map: Option<PathBuf>,

    /// Write the report as JSON
    #[arg(long, value_name = "REPORT.json")]
    pub json: Option<PathBuf>,

    /// Write a picture: two views, pairs in matching colours, the fixed curve drawn
    #[arg(long, value_name = "OUT.png", value_parser = named(&["png"], "the picture is written as PNG"))]
    pub picture: Option<PathBuf>,

    /// For several inputs: write NAME.map, NAME.ply, NAME.json and the like into this folder for each
    #[arg(long, value_name = "DIR", conflicts_with_all = ["output", "map", "json", "picture"])]
    pub output_dir: Option<PathBuf>,

    /// With --output-dir: what to write for each input
    #[arg(long, value_delimiter = ',', default_value = "map,ply,json", requires = "output_dir")]
    pub write: Vec<Kind>,

    /// Replace files that are not results of an earlier run, too; an input is never replaced
    #[arg(long)]
    pub force: bool,

    /// Meshes worked on at the same time; if more than one, each by one thread unless --threads is given
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub jobs: u16,

    /// The axis that points up in the picture
    #[arg(long, value_name = "AXIS", default_value = "auto", value_parser = up_axis, allow_hyphen_values = true)]
    pub up: Up,

    /// Whether the mesh gets pair colours: red, green, blue in a PLY, COLOR_0 in a GLB
    #[arg(long, value_enum, value_name = "WHEN", default_value = "auto")]
    pub colors: Colors,

    /// Use this sign network (ONNX) instead of the built-in one; trusted input, run by the ONNX Runtime library that
    /// ORT_DYLIB_PATH names (1.24 or newer)
    #[arg(long, value_name = "MODEL.onnx")]
    pub model: Option<PathBuf>,

    /// Signs you know of the first eigenfunctions: + even, - odd, ? unknown, as in "-++?-"
    #[arg(long, value_name = "SIGNS", value_parser = signs, allow_hyphen_values = true)]
    pub signs: Option<KnownSigns>,

    /// Numbers of the method, the same in every host.
    #[command(flatten)]
    pub options: NumericOptions,

    /// What is common to all commands.
    #[command(flatten)]
    pub common: Common,
}

/// Files that `--output-dir` can hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Kind {
    /// One partner per line
    Map,
    /// The mesh with attributes
    Ply,
    /// The mesh with attributes; a glTF keeps the rest of its file
    Glb,
    /// The report
    Json,
    /// The picture
    Png,
}

/// When to write pair colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Colors {
    /// Unless the input has vertex colours of its own
    Auto,
    /// Also in place of the input's own vertex colours
    Always,
    /// Not at all
    Never,
}

/// `intrinsym info`.
#[derive(Debug, Args)]
pub struct Info {
    /// Mesh to read: PLY, OBJ, OFF, STL, glTF or GLB
    #[arg(value_name = "IN")]
    pub input: PathBuf,

    /// Print JSON instead of text
    #[arg(long)]
    pub json: bool,

    /// What is common to all commands.
    #[command(flatten)]
    pub common: Common,
}

/// `intrinsym eigen`.
#[derive(Debug, Args)]
pub struct Eigen {
    /// Mesh to read: PLY, OBJ, OFF, STL, glTF or GLB
    #[arg(value_name = "IN")]
    pub input: PathBuf,

    /// Number of eigenfunctions, the constant one not counted
    #[arg(short = 'k', long, default_value_t = 50, value_parser = clap::value_parser!(u16).range(1..=1000))]
    pub count: u16,

    /// Write an archive for NumPy: eigenvalues (k), eigenfunctions (vertices x k) and mass (vertices)
    #[arg(short, long, value_name = "OUT.npz", value_parser = named(&["npz"], "the arrays are written as one NumPy archive"))]
    pub output: Option<PathBuf>,

    /// Replace a file that is not a result of an earlier run, too; the input is never replaced
    #[arg(long)]
    pub force: bool,

    /// What is common to all commands.
    #[command(flatten)]
    pub common: Common,
}

impl Detect {
    /// All options of the detection.
    pub fn options(&self) -> Options {
        let known_signs = self.signs.as_ref().map_or_else(Vec::new, |signs| signs.0.clone());
        let given = &self.options;
        let threads = if self.jobs > 1 && !given.threads_given { 1 } else { given.options.threads };
        Options { model: self.model.clone(), known_signs, threads, ..given.options.clone() }
    }

    /// The files that flags name, in the order in which they are written.
    pub fn named_outputs(&self) -> impl Iterator<Item = (Kind, &PathBuf)> {
        let is_glb = |path: &PathBuf| path.extension().is_some_and(|found| found.eq_ignore_ascii_case("glb"));
        let mesh = if self.output.as_ref().is_some_and(is_glb) { Kind::Glb } else { Kind::Ply };
        let named = [
            (mesh, &self.output),
            (Kind::Map, &self.map),
            (Kind::Png, &self.picture),
            (Kind::Json, &self.json),
        ];
        named.into_iter().filter_map(|(kind, path)| Some((kind, path.as_ref()?)))
    }
}

/// What `--signs` holds: 1 even, -1 odd, 0 unknown.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct KnownSigns(pub Vec<i8>);

/// Flags of every command.
#[derive(Debug, Args)]
pub struct Common {
    /// Print nothing but errors
    #[arg(short, long)]
    pub quiet: bool,

    /// Most vertices of a mesh that is read
    #[arg(long, value_name = "N", default_value_t = Limits::default().vertices)]
    pub max_vertices: u64,

    /// Most faces of a mesh that is read
    #[arg(long, value_name = "N", default_value_t = Limits::default().faces)]
    pub max_faces: u64,

    /// Read a glTF as it stands in this animation, not at rest
    #[arg(long, value_name = "NAME")]
    pub animation: Option<String>,

    /// With --animation: seconds from its start
    #[arg(long, value_name = "SECONDS", default_value_t = 0.0, requires = "animation", value_parser = seconds)]
    pub time: f64,
}

impl Common {
    /// Reads a mesh file.
    pub fn read(&self, path: &Path) -> Result<MeshFile> {
        let pose = self.animation.clone().map(|animation| Pose { animation, time: self.time });
        io::read_posed(path, &self.limits(), pose.as_ref())
    }

    /// Limits for the reader.
    pub fn limits(&self) -> Limits {
        Limits { vertices: self.max_vertices, faces: self.max_faces, ..Limits::default() }
    }
}

/// One flag for each entry of [`OPTIONS`]: name, default, range and help come from there.
#[derive(Debug, Clone)]
pub struct NumericOptions {
    options: Options,
    threads_given: bool,
}

impl Args for NumericOptions {
    fn augment_args(command: ClapCommand) -> ClapCommand {
        command.args(OPTIONS.iter().map(|spec| {
            let flag = Arg::new(spec.name).long(spec.name.replace('_', "-"));
            let flag = if spec.expert { flag.help_heading("For experts") } else { flag };
            match spec.choices {
                [] => flag
                    .value_name("N")
                    .default_value(spec.default.to_string())
                    .value_parser(|text: &str| number(text, spec))
                    .help(format!("{} Range {}..={}", spec.help, spec.minimum, spec.maximum)),
                choices => {
                    let index =
                        |name: String| choices.iter().position(|&own| own == name).unwrap_or_default() as u64;
                    flag.value_name("HOW")
                        .default_value(choices[spec.default])
                        .value_parser(PossibleValuesParser::new(choices).map(index))
                        .help(spec.help)
                }
            }
        }))
    }

    fn augment_args_for_update(command: ClapCommand) -> ClapCommand {
        Self::augment_args(command)
    }
}

impl FromArgMatches for NumericOptions {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let mut options = NumericOptions { options: Options::default(), threads_given: false };
        options.update_from_arg_matches(matches)?;
        Ok(options)
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        for spec in &OPTIONS {
            if let Some(&value) = matches.get_one::<u64>(spec.name) {
                let set = self.options.set(spec.name, value as usize);
                set.map_err(|error| clap::Error::raw(clap::error::ErrorKind::ValueValidation, error))?;
            }
        }
        self.threads_given = matches.value_source("threads") == Some(ValueSource::CommandLine);
        Ok(())
    }
}

/// A value of an option in its range, or its default.
fn number(text: &str, spec: &OptionSpec) -> Result<u64, String> {
    let range = || format!("{}..={}", spec.minimum, spec.maximum);
    let value: u64 = text.parse().map_err(|_| format!("expected a whole number in {}", range()))?;
    let fits = value == spec.default as u64 || (spec.minimum as u64..=spec.maximum as u64).contains(&value);
    fits.then_some(value).ok_or_else(|| format!("{value} is not in {}", range()))
}

/// A path, of any bytes that the system allows, with one of these extensions.
fn named(
    extensions: &'static [&'static str],
    reason: &'static str,
) -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(move |path| match path.extension() {
        Some(found) if extensions.iter().any(|extension| found.eq_ignore_ascii_case(extension)) => Ok(path),
        _ => Err(format!("{reason}: name the file something.{}", extensions.join(" or something."))),
    })
}

fn signs(text: &str) -> Result<KnownSigns, String> {
    let sign = |letter| match letter {
        '+' => Ok(1),
        '-' => Ok(-1),
        '?' => Ok(0),
        other => Err(format!("{other:?} is neither + (even), - (odd) nor ? (unknown)")),
    };
    text.chars().map(sign).collect::<Result<_, _>>().map(KnownSigns)
}

fn seconds(text: &str) -> Result<f64, String> {
    let finite = text.parse().ok().filter(|seconds: &f64| seconds.is_finite());
    finite.ok_or_else(|| "expected a number of seconds".into())
}

fn up_axis(text: &str) -> Result<Up, String> {
    let (reversed, name) = text.strip_prefix('-').map_or((false, text), |name| (true, name));
    match ["x", "y", "z"].iter().position(|&axis| axis == name) {
        Some(axis) => Ok(Up::Axis { axis, reversed }),
        None if text == "auto" => Ok(Up::Auto),
        None => Err("expected x, y, z, -x, -y, -z or auto".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn options_come_from_the_shared_table() {
        for spec in &OPTIONS {
            let flag = format!("--{}", spec.name.replace('_', "-"));
            let named =
                |value: usize| spec.choices.get(value).map_or_else(|| value.to_string(), |&name| name.into());
            let parse = |value: usize| {
                Arguments::try_parse_from(["intrinsym", "detect", "in.ply", &flag, &named(value)])
            };
            let Command::Detect(detect) = parse(spec.maximum).unwrap().command else { unreachable!() };
            let mut expected = Options::default();
            expected.set(spec.name, spec.maximum).unwrap();
            assert_eq!(detect.options(), expected);
            assert!(parse(spec.maximum + 1).is_err());
            let below = spec.minimum.wrapping_sub(1);
            assert_eq!(parse(below).is_err(), below != spec.default, "{}", spec.name);
        }
    }

    #[test]
    fn meshes_side_by_side_have_one_thread_each_unless_told_otherwise() {
        let threads = |flags: &[&str]| {
            let line = ["intrinsym", "detect", "in.ply"].iter().chain(flags);
            let Command::Detect(detect) = Arguments::parse_from(line).command else { unreachable!() };
            detect.options().threads
        };
        assert_eq!(threads(&[]), Options::default().threads);
        assert_eq!(threads(&["--jobs", "8"]), 1);
        assert_eq!(threads(&["--jobs", "8", "--threads", "3"]), 3);
        assert_eq!(threads(&["--jobs", "1", "--threads", "5"]), 5);
    }

    #[test]
    fn known_signs_are_read() {
        assert_eq!(signs("-+?"), Ok(KnownSigns(vec![-1, 1, 0])));
        assert!(signs("-+0").unwrap_err().contains("'0' is neither"));
    }

    #[test]
    fn axes_are_read_with_their_sign() {
        assert_eq!(up_axis("-y"), Ok(Up::Axis { axis: 1, reversed: true }));
        assert_eq!(up_axis("auto"), Ok(Up::Auto));
        assert!(up_axis("-auto").is_err() && up_axis("w").is_err());
    }
}
