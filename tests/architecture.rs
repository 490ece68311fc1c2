//! The shape of `src/`: data flows one way, positions end at the Laplacian, `unsafe` lives in two places.
//!
//! A file imports only from files above it in [`ORDER`]. Comments, strings and test modules do not count.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// The files of `src/` (with their folders) from the shared vocabulary to the products.
const ORDER: [&str; 60] = [
    "error",
    "options",
    "limits",
    "progress",
    "threads",
    "atomic_file",
    "symmetry_kind",
    "effort",
    "mesh",
    "symmetric_sparse",
    "sparse_cholesky",
    "laplacian",
    "shortest_ways",
    "dense",
    "eigenbasis",
    "sampling",
    "sign_network",
    "parity_search",
    "functional_map",
    "refinement",
    "extrema_starts",
    "candidate_score",
    "candidates",
    "compositions",
    "adjacency",
    "embedded_triangles",
    "vertex_rows",
    "mesh_descent",
    "full_refinement",
    "continuous_family",
    "signature",
    "displacement",
    "acceptance",
    "shell_symmetry",
    "rotations",
    "confidence",
    "fixed_curve",
    "correspondence",
    "automorphism",
    "mirrored_vertices",
    "filled_holes",
    "surface_walk",
    "proxy",
    "stated_signs",
    "rigid_parts",
    "companions",
    "judging_mesh",
    "assembly",
    "assembler",
    "finishing",
    "detection",
    "pipeline",
    "detect_again",
    "report",
    "mirror_tools",
    "pair_colour",
    "picture",
    "ffi",
    "lib",
    "bin",
];

/// `error` and `options`, `limits`, `progress` may name each other: they are one vocabulary.
const VOCABULARY: usize = 6;

struct SourceFile {
    path: PathBuf,
    /// First component below `src/`, without its ending.
    module: String,
    /// The code without comments, strings and test modules.
    code: String,
}

fn source_files() -> Vec<SourceFile> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut found = Vec::new();
    let mut folders = vec![root.clone()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|ending| ending == "rs") {
                let below = path.strip_prefix(&root).unwrap().to_path_buf();
                let first = Path::new(below.iter().next().unwrap()).file_stem().unwrap();
                let code = bare_code(&std::fs::read_to_string(&path).unwrap());
                found.push(SourceFile { module: first.to_str().unwrap().to_string(), path: below, code });
            }
        }
    }
    found.sort_by(|first, second| first.path.cmp(&second.path));
    found
}

/// Removes comments, string contents and everything from the test module on.
fn bare_code(source: &str) -> String {
    let mut bare = String::new();
    let mut rest = source.split("#[cfg(test)]\nmod tests").next().unwrap();
    while let Some(character) = rest.chars().next() {
        let skipped = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if rest.starts_with("/*") {
            rest.find("*/").map_or(rest.len(), |end| end + 2)
        } else if rest.starts_with("r#\"") {
            rest.find("\"#").map_or(rest.len(), |end| end + 2)
        } else if rest.starts_with("'\"'") || rest.starts_with("b'\"'") {
            rest.find("\"'").map_or(rest.len(), |end| end + 2)
        } else if character == '"' {
            string_length(rest)
        } else {
            bare.push(character);
            character.len_utf8()
        };
        rest = &rest[skipped..];
    }
    bare
}

fn string_length(text: &str) -> usize {
    let mut escaped = false;
    for (position, character) in text.char_indices().skip(1) {
        match character {
            '"' if !escaped => return position + 1,
            _ => escaped = character == '\\' && !escaped,
        }
    }
    text.len()
}

fn words(code: &str) -> impl Iterator<Item = &str> {
    code.split(|character: char| !character.is_alphanumeric() && character != '_')
}

fn is_word(name: &str) -> bool {
    !name.is_empty() && name.chars().all(|character| character.is_alphanumeric() || character == '_')
}

/// Modules named as `crate::module` or within `crate::{...}`.
fn imports(code: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for (_, after) in code.match_indices("crate::").map(|(at, text)| (at, &code[at + text.len()..])) {
        match after.strip_prefix('{') {
            Some(group) => found.extend(group_heads(group)),
            None => found.extend(words(after).next().map(str::to_string)),
        }
    }
    found
}

/// First names of the entries of a braced group, whose opening brace is gone.
fn group_heads(group: &str) -> Vec<String> {
    let (mut depth, mut heads, mut start) = (1, Vec::new(), 0);
    for (position, character) in group.char_indices() {
        let ends = match character {
            '{' => {
                depth += 1;
                false
            }
            '}' => {
                depth -= 1;
                depth == 0
            }
            ',' => depth == 1,
            _ => false,
        };
        if ends {
            let head = group[start..position].split(':').next().unwrap().trim();
            heads.extend(is_word(head).then(|| head.to_string()));
            start = position + 1;
        }
        if depth == 0 {
            break;
        }
    }
    heads
}

fn rank(module: &str) -> Option<usize> {
    ORDER.iter().position(|&name| name == module)
}

/// What breaks the order in one file.
fn upward_imports(module: &str, code: &str) -> Vec<String> {
    let own =
        rank(module).unwrap_or_else(|| panic!("`{module}` has no place in ORDER of tests/architecture.rs"));
    let is_upward = |import: &String| {
        rank(import).is_some_and(|other| other > own && (own >= VOCABULARY || other >= VOCABULARY))
    };
    imports(code).into_iter().filter(is_upward).collect()
}

#[test]
fn a_file_imports_only_from_files_above_it() {
    for file in source_files().iter().filter(|file| file.module != "lib") {
        let upward = upward_imports(&file.module, &file.code);
        assert!(upward.is_empty(), "src/{} imports {upward:?} from below it", file.path.display());
    }
}

#[test]
fn every_library_file_is_declared_in_order() {
    let files = source_files();
    let top: BTreeSet<&str> = files.iter().map(|file| file.module.as_str()).collect();
    for module in top {
        assert!(rank(module).is_some(), "src/{module}.rs has no place in ORDER of tests/architecture.rs");
    }
}

#[test]
fn unsafe_is_only_in_the_bridge_and_the_c_abi() {
    for file in source_files() {
        let allowed = file.path == Path::new("mesh/openmesh.rs") || file.module == "ffi";
        let used = words(&file.code).any(|word| word == "unsafe") || file.code.contains("allow(unsafe_code)");
        assert!(allowed || !used, "src/{} uses unsafe", file.path.display());
    }
}

#[test]
fn stages_after_the_laplacian_see_no_positions() {
    let (laplacian, last) = (rank("laplacian").unwrap(), rank("automorphism").unwrap());
    for file in source_files() {
        let intrinsic = rank(&file.module).is_some_and(|own| own > laplacian && own <= last);
        let sees = words(&file.code).any(|word| word == "positions");
        assert!(!intrinsic || !sees, "src/{} names positions", file.path.display());
    }
}

#[test]
fn the_checks_see_what_they_look_for() {
    let code = bare_code(
        "use crate::{error::{Error, Result}, pipeline}; // crate::ffi\nlet a = \"crate::bin \\\" crate::bin\";\n\
         let b = '\"'; crate::mesh::NONE; /* unsafe */\n#[cfg(test)]\nmod tests { use crate::ffi; }",
    );
    let found: Vec<String> = imports(&code).into_iter().collect();
    assert_eq!(found, ["error", "mesh", "pipeline"]);
    assert_eq!(upward_imports("automorphism", &code), ["pipeline"]);
    assert!(upward_imports("bin", &code).is_empty());
    assert!(words(&code).all(|word| word != "unsafe"));
}
