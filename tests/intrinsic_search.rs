//! The search is intrinsic: it sees the Laplacian, and no positions.

use std::path::{Path, PathBuf};

/// Folders and files of `src/` that see no positions, but for what is [`EXTRINSIC`].
const INTRINSIC: [&str; 10] = [
    "geometry/adjacency",
    "geometry/embedded_triangles",
    "spectral/",
    "search/",
    "refine/",
    "connectivity/automorphism",
    "verify/",
    "detect/correspondence",
    "detect/fixed_curve",
    "detect/shell_symmetry",
];
const EXTRINSIC: [&str; 2] = ["spectral/laplacian", "refine/rigid_parts"];

/// Path below `src/` and code, without comments and test modules, of each file.
fn source_files() -> Vec<(PathBuf, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let (mut found, mut folders) = (Vec::new(), vec![root.clone()]);
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                let code = bare_code(&std::fs::read_to_string(&path).unwrap());
                found.push((path.strip_prefix(&root).unwrap().to_path_buf(), code));
            }
        }
    }
    found
}

fn bare_code(source: &str) -> String {
    let code = source.split("#[cfg(test)]\nmod tests").next().unwrap();
    let bare = |line: &'_ str| line.split("//").next().unwrap().to_string() + "\n";
    code.lines().map(bare).collect()
}

#[test]
fn the_search_and_the_spectral_refinement_see_no_positions() {
    let is_word = |character: char| character.is_alphanumeric() || character == '_';
    let sees = |code: &str| code.split(|character| !is_word(character)).any(|word| word == "positions");
    let mut seen = [0; INTRINSIC.len()];
    for (path, code) in source_files() {
        let path = path.to_str().unwrap();
        let Some(own) = INTRINSIC.iter().position(|name| path.starts_with(name)) else { continue };
        let may = EXTRINSIC.iter().any(|name| path.starts_with(name));
        assert!(may || !sees(&code), "src/{path} names positions");
        assert!(
            !may || sees(&code) || path.contains("rigid_parts/"),
            "src/{path} sees none: it is intrinsic, too"
        );
        seen[own] += 1;
    }
    assert!(seen.iter().all(|&files| files > 0), "what is listed exists: {seen:?}");
}
