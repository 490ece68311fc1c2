//! Every option once: its name, default, range and help sentence.
//!
//! The command line, the C header, MeshLab's dialog and Blender's panel take them from here.

use crate::error::{Error, Result};
use std::path::PathBuf;

/// Options of a detection. All are scale-free.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Options {
    /// Eigenfunctions of the functional map after refinement.
    pub eigenfunctions: usize,
    /// Surface samples on which candidate maps are refined and scored.
    pub samples: usize,
    /// Most symmetries to return, best first.
    pub symmetries: usize,
    /// Width of the beam that searches parity vectors.
    pub beam_width: usize,
    /// 1: the sign network proposes beside the search; 0: the search alone.
    pub network: usize,
    /// Least plausibility, in percent, at which a map counts as a symmetry; half of it is enough for one that mirrors vertices
    /// ([`crate::mirrored_vertices`]). 0 accepts every finished map.
    pub plausibility: usize,
    /// Vertices of the largest shell up to which the map is sought on the shell itself; a finer one is simplified to
    /// about so many, and the map is carried back.
    pub proxy_vertices: usize,
    /// Most memory of a detection in MB, estimated before it is taken; 0 for no limit.
    pub memory: usize,
    /// Threads that a detection uses at most; the result does not depend on it.
    pub threads: usize,
    /// EXPERIMENTAL. Most rotations of order three or more to return after the symmetries that are their own inverses.
    pub rotations: usize,
    /// A sign network of the caller's own instead of the embedded one: trusted input.
    pub model: Option<PathBuf>,
    /// Signs that a person knows of the mesh's eigenfunctions ([`crate::pipeline::eigen`]), from the first on: 1 even, -1 odd,
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
    /// Smallest accepted value.
    pub minimum: usize,
    /// Largest accepted value.
    pub maximum: usize,
    /// One sentence for dialogs and `--help`.
    pub help: &'static str,
}

/// The table all hosts read.
pub const OPTIONS: [OptionSpec; 10] = [
    OptionSpec {
        name: "eigenfunctions",
        default: 150,
        minimum: 12,
        maximum: 200,
        help: "Laplace-Beltrami eigenfunctions of the refined map: more resolve finer detail and cost more.",
    },
    OptionSpec {
        name: "samples",
        default: 1000,
        minimum: 100,
        maximum: 5000,
        help: "Surface samples on which candidate maps are refined before the full mesh is.",
    },
    OptionSpec {
        name: "symmetries",
        default: 1,
        minimum: 1,
        maximum: 32,
        help: "Most distinct symmetries to return, best first; a square table has more than one.",
    },
    OptionSpec {
        name: "beam_width",
        default: 16,
        minimum: 1,
        maximum: 256,
        help: "Width of the beam search over even and odd eigenfunctions: wider finds harder symmetries, slower.",
    },
    OptionSpec {
        name: "network",
        default: 1,
        minimum: 0,
        maximum: 1,
        help: "Whether the sign network proposes even and odd eigenfunctions beside the search: 1 yes, 0 no.",
    },
    OptionSpec {
        name: "plausibility",
        default: 50,
        minimum: 0,
        maximum: 100,
        help: "Least plausibility in percent at which a map counts as a symmetry (half of it for one that mirrors vertices); 0 accepts the best map found.",
    },
    OptionSpec {
        name: "proxy_vertices",
        default: 6_000,
        minimum: 1_000,
        maximum: 100_000_000,
        help: "Vertices above which the map is found on a simplified mesh of about so many and carried back.",
    },
    OptionSpec {
        name: "memory",
        default: 0,
        minimum: 0,
        maximum: 100_000_000,
        help: "Most memory in MB, mesh included, estimated before it is taken: a mesh that needs more is refused; 0: no limit.",
    },
    OptionSpec {
        name: "threads",
        default: 2,
        minimum: 1,
        maximum: 64,
        help: "Threads that one detection uses at most; the result does not depend on it.",
    },
    OptionSpec {
        name: "rotations",
        default: 0,
        minimum: 0,
        maximum: 32,
        help: "EXPERIMENTAL. Most rotations of order 3 to 12 to return after the other symmetries; 0: none is sought.",
    },
];

impl Default for Options {
    fn default() -> Self {
        Options {
            eigenfunctions: OPTIONS[0].default,
            samples: OPTIONS[1].default,
            symmetries: OPTIONS[2].default,
            beam_width: OPTIONS[3].default,
            network: OPTIONS[4].default,
            plausibility: OPTIONS[5].default,
            proxy_vertices: OPTIONS[6].default,
            memory: OPTIONS[7].default,
            threads: OPTIONS[8].default,
            rotations: OPTIONS[9].default,
            model: None,
            known_signs: Vec::new(),
        }
    }
}

impl Options {
    /// Refuses the first option outside its range.
    ///
    /// # Errors
    /// [`Error::Option`].
    pub fn validate(&self) -> Result<()> {
        OPTIONS.iter().zip(self.values()).try_for_each(|(spec, value)| spec.check(value))?;
        match self.known_signs.iter().find(|sign| !(-1..=1).contains(*sign)) {
            Some(sign) => Err(Error::Option {
                name: "known_signs",
                message: format!("{sign} is neither 1 (even), -1 (odd) nor 0 (unknown)"),
            }),
            None => Ok(()),
        }
    }

    /// Whether any sign is known.
    pub fn states_signs(&self) -> bool {
        self.known_signs.iter().any(|&sign| sign != 0)
    }

    /// The values in the order of [`OPTIONS`].
    pub fn values(&self) -> [usize; OPTIONS.len()] {
        [
            self.eigenfunctions,
            self.samples,
            self.symmetries,
            self.beam_width,
            self.network,
            self.plausibility,
            self.proxy_vertices,
            self.memory,
            self.threads,
            self.rotations,
        ]
    }

    /// Sets the option that is called `name` in [`OPTIONS`].
    ///
    /// # Errors
    /// [`Error::Option`] if there is no such option or the value is outside its range; nothing is set then.
    pub fn set(&mut self, name: &str, value: usize) -> Result<()> {
        let index = index_of(name)?;
        OPTIONS[index].check(value)?;
        let fields = [
            &mut self.eigenfunctions,
            &mut self.samples,
            &mut self.symmetries,
            &mut self.beam_width,
            &mut self.network,
            &mut self.plausibility,
            &mut self.proxy_vertices,
            &mut self.memory,
            &mut self.threads,
            &mut self.rotations,
        ];
        *fields.into_iter().nth(index).expect("one field per option") = value;
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
        if (self.minimum..=self.maximum).contains(&value) {
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
        assert!(options.set("sample", 500).unwrap_err().to_string().contains("known: eigenfunctions, "));
        assert_eq!(options, Options::default());
        options.known_signs = vec![1, 2];
        assert!(options.validate().unwrap_err().to_string().starts_with("option known_signs: 2 is neither"));
    }
}
