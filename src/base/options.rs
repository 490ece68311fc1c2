//! Every option once: its name, default, range and help sentence.
//!
//! The command line, the C header, MeshLab's dialog and Blender's panel take them from here.

use crate::base::error::{Error, Result};
use std::path::PathBuf;

/// How hard a detection tries.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Effort {
    /// The small plan alone.
    Fast,
    /// The small plan, and where its answer leaves doubts a wider search and then the large one.
    #[default]
    Default,
    /// The large plan at once.
    Thorough,
}

/// Options of a detection. All are scale-free.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Options {
    /// How hard to try. The four counts that are 0 by default follow from it.
    pub effort: Effort,
    /// Eigenfunctions of the functional map after refinement; 0: as the effort says.
    pub eigenfunctions: usize,
    /// Surface samples on which candidate maps are refined and scored; 0: as the effort says.
    pub samples: usize,
    /// Most symmetries to return, best first.
    pub symmetries: usize,
    /// Width of the beam that searches parity vectors; 0: as the effort says.
    pub beam_width: usize,
    /// Whether the sign network proposes beside the search.
    pub network: bool,
    /// Least plausibility, in percent, at which a map counts as a symmetry; half of it is enough for one that mirrors vertices. 0 accepts every finished map.
    pub plausibility: usize,
    /// Vertices of the largest shell up to which the map is sought on the shell itself; a finer one is simplified to
    /// about so many, and the map is carried back; 0: as the effort says.
    pub proxy_vertices: usize,
    /// Most memory of a detection in MB, estimated before it is taken; 0 for no limit.
    pub memory: usize,
    /// Seconds of wall time after which a detection ends with the best map so far, as doubtful; 0 for no limit. The result then depends
    /// on the machine.
    pub time_limit: usize,
    /// Threads that a detection uses at most; the result does not depend on it.
    pub threads: usize,
    /// A sign network of the caller's own instead of the embedded one: trusted input.
    pub model: Option<PathBuf>,
    /// Signs that a person knows of the mesh's eigenfunctions ([`crate::eigen`]), from the first on: 1 even, -1 odd,
    /// 0 unknown. They overrule the network.
    pub known_signs: Vec<i8>,
}

/// One option as the hosts show it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OptionSpec {
    /// Name in every host.
    pub name: &'static str,
    /// Value used when none is given.
    pub default: usize,
    /// Smallest accepted value but for the default.
    pub minimum: usize,
    /// Largest accepted value.
    pub maximum: usize,
    /// Names of the values from 0 on, where they have some.
    pub choices: &'static [&'static str],
    /// Whether only experts need it.
    pub expert: bool,
    /// One sentence for dialogs and `--help`.
    pub help: &'static str,
}

/// The table all hosts read.
pub const OPTIONS: [OptionSpec; 11] = [
    OptionSpec {
        choices: &["fast", "default", "thorough"],
        ..spec(
            "effort",
            1,
            [0, 2],
            "How hard to try: fast never looks twice, default looks again where its answer leaves doubts, thorough does at once.",
        )
    },
    spec(
        "symmetries",
        1,
        [1, 32],
        "Most distinct symmetries to return, best first; a square table has more than one.",
    ),
    spec(
        "plausibility",
        50,
        [0, 100],
        "Least plausibility in percent at which a map counts as a symmetry (half of it for one that mirrors vertices); 0 accepts the best map found.",
    ),
    spec("threads", 2, [1, 64], "Threads that one detection uses at most; the result does not depend on it."),
    spec(
        "memory",
        0,
        [0, 100_000_000],
        "Most memory in MB, mesh included, estimated before it is taken: a mesh that needs more is refused; 0: no limit.",
    ),
    spec(
        "time_limit",
        0,
        [1, 1_000_000],
        "Seconds after which a detection ends with the best map so far, as doubtful, or with an error if there is none; 0: no limit.",
    ),
    expert(
        "network",
        1,
        [0, 1],
        "Whether the sign network proposes even and odd eigenfunctions: 1 yes, 0 no.",
    ),
    expert(
        "eigenfunctions",
        0,
        [12, 200],
        "Laplace-Beltrami eigenfunctions of the refined map; 0: as the effort says.",
    ),
    expert(
        "samples",
        0,
        [100, 5000],
        "Surface samples on which candidate maps are refined; 0: as the effort says.",
    ),
    expert(
        "beam_width",
        0,
        [1, 256],
        "Width of the beam search over even and odd eigenfunctions; 0: as the effort says.",
    ),
    expert(
        "proxy_vertices",
        0,
        [1000, 100_000_000],
        "Vertices above which the map is found on a simplified mesh of about so many and carried back; 0: as the effort says.",
    ),
];

/// An option that everybody may need, without names of its values.
const fn spec(
    name: &'static str,
    default: usize,
    [minimum, maximum]: [usize; 2],
    help: &'static str,
) -> OptionSpec {
    OptionSpec { name, default, minimum, maximum, choices: &[], expert: false, help }
}

/// The same for experts.
const fn expert(name: &'static str, default: usize, range: [usize; 2], help: &'static str) -> OptionSpec {
    OptionSpec { expert: true, ..spec(name, default, range, help) }
}

impl Default for Options {
    fn default() -> Self {
        Options {
            effort: Effort::Default,
            symmetries: OPTIONS[1].default,
            plausibility: OPTIONS[2].default,
            threads: OPTIONS[3].default,
            memory: OPTIONS[4].default,
            time_limit: OPTIONS[5].default,
            network: OPTIONS[6].default == 1,
            eigenfunctions: OPTIONS[7].default,
            samples: OPTIONS[8].default,
            beam_width: OPTIONS[9].default,
            proxy_vertices: OPTIONS[10].default,
            model: None,
            known_signs: Vec::new(),
        }
    }
}

impl Options {
    /// Refuses the first option outside its range, and a model that cannot be read, whether or not the mesh needs one.
    ///
    /// # Errors
    /// [`Error::Option`], [`Error::Model`].
    pub fn validate(&self) -> Result<()> {
        OPTIONS.iter().zip(self.values()).try_for_each(|(spec, value)| spec.check(value))?;
        if let Some(path) = self.model.as_ref().filter(|_| self.network) {
            let failed =
                |fault: std::io::Error| Error::Model(format!("{}: cannot be read: {fault}", path.display()));
            std::fs::File::open(path).map_err(failed)?;
        }
        match self.known_signs.iter().find(|sign| !(-1..=1).contains(*sign)) {
            Some(sign) => Err(Error::Option {
                name: "known_signs",
                message: format!("{sign} is neither 1 (even), -1 (odd) nor 0 (unknown)"),
            }),
            None => Ok(()),
        }
    }

    /// Whether any sign is known.
    pub(crate) fn states_signs(&self) -> bool {
        self.known_signs.iter().any(|&sign| sign != 0)
    }

    /// Whether the best reflection is all that is asked for, whichever its signs.
    pub(crate) fn asks_for_one(&self) -> bool {
        self.symmetries == 1 && !self.states_signs()
    }

    /// The values in the order of [`OPTIONS`].
    pub(crate) fn values(&self) -> [usize; OPTIONS.len()] {
        [
            self.effort as usize,
            self.symmetries,
            self.plausibility,
            self.threads,
            self.memory,
            self.time_limit,
            usize::from(self.network),
            self.eigenfunctions,
            self.samples,
            self.beam_width,
            self.proxy_vertices,
        ]
    }

    /// Sets the option that is called `name` in [`OPTIONS`].
    ///
    /// # Errors
    /// [`Error::Option`] if there is no such option or the value is outside its range; nothing is set then.
    pub fn set(&mut self, name: &str, value: usize) -> Result<()> {
        OPTIONS[index_of(name)?].check(value)?;
        match name {
            "effort" => self.effort = [Effort::Fast, Effort::Default, Effort::Thorough][value],
            "symmetries" => self.symmetries = value,
            "plausibility" => self.plausibility = value,
            "threads" => self.threads = value,
            "memory" => self.memory = value,
            "time_limit" => self.time_limit = value,
            "network" => self.network = value == 1,
            "eigenfunctions" => self.eigenfunctions = value,
            "samples" => self.samples = value,
            "beam_width" => self.beam_width = value,
            "proxy_vertices" => self.proxy_vertices = value,
            _ => unreachable!("every option of the table is here"),
        }
        Ok(())
    }

    /// The value of the option that is called `name` in [`OPTIONS`].
    ///
    /// # Errors
    /// [`Error::Option`] if there is no such option.
    pub fn get(&self, name: &str) -> Result<usize> {
        Ok(self.values()[index_of(name)?])
    }
}

/// Place of an option in [`OPTIONS`].
fn index_of(name: &str) -> Result<usize> {
    OPTIONS.iter().position(|spec| spec.name == name).ok_or_else(|| {
        let known = OPTIONS.map(|spec| spec.name).join(", ");
        Error::Option { name: "name", message: format!("no option {name:?}; known: {known}") }
    })
}

impl OptionSpec {
    /// Refuses a value outside the range.
    fn check(&self, value: usize) -> Result<()> {
        if value == self.default || (self.minimum..=self.maximum).contains(&value) {
            return Ok(());
        }
        let message = format!("{value} is outside {}..={}", self.minimum, self.maximum);
        Err(Error::Option { name: self.name, message })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_default_is_in_range() {
        Options::default().validate().unwrap();
    }

    #[test]
    fn a_model_that_is_not_there_is_refused() {
        let mut options = Options { model: Some("no/such.onnx".into()), ..Options::default() };
        assert!(options.validate().unwrap_err().to_string().contains("no/such.onnx"));
        options.network = false;
        options.validate().unwrap();
    }

    #[test]
    fn setting_by_name_changes_that_option_alone() {
        for spec in &OPTIONS {
            let mut options = Options::default();
            options.set(spec.name, spec.minimum).unwrap();
            for (other, value) in OPTIONS.iter().zip(options.values()) {
                let expected = if other.name == spec.name { spec.minimum } else { other.default };
                assert_eq!(value, expected, "{} after setting {}", other.name, spec.name);
                assert_eq!(options.get(other.name).unwrap(), expected);
            }
        }
    }

    #[test]
    fn values_out_of_range_and_unknown_names_are_refused() {
        let mut options = Options::default();
        let message = options.set("samples", 7).unwrap_err().to_string();
        assert_eq!(message, "option samples: 7 is outside 100..=5000");
        assert!(options.set("sample", 500).unwrap_err().to_string().contains("known: effort, "));
        assert_eq!(options, Options::default());
        options.known_signs = vec![1, 2];
        assert!(options.validate().unwrap_err().to_string().starts_with("option known_signs: 2 is neither"));
    }
}
