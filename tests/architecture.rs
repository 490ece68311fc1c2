//! The shape of `src/`: data flows one way, and the search sees no positions.

use std::path::{Path, PathBuf};

/// The folders of `src/`, in the order of the data. Each imports only from those above it.
const ORDER: [&str; 10] = [
    "base",
    "mesh",
    "geometry",
    "spectral",
    "search",
    "refine",
    "connectivity",
    "verify",
    "detect",
    "mirror",
];

/// Folders and files that see no positions, but for what is [`EXTRINSIC`].
const INTRINSIC: [&str; 11] = [
    "geometry/adjacency",
    "geometry/embedded_triangles",
    "spectral/",
    "search/",
    "refine/",
    "connectivity/automorphism",
    "verify/",
    "detect/correspondence",
    "detect/fixed_curve",
    "detect/rotations",
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
    assert!(found.len() > 100, "{}", root.display());
    found
}

fn bare_code(source: &str) -> String {
    let code = source.split("#[cfg(test)]\nmod tests").next().unwrap();
    let bare = |line: &'_ str| line.split("//").next().unwrap().to_string() + "\n";
    code.lines().map(bare).collect()
}

fn words(code: &str) -> impl Iterator<Item = &str> {
    code.split(|character: char| !character.is_alphanumeric() && character != '_')
}

/// Place in [`ORDER`] of the folder that a file is in; none for `lib.rs`.
fn rank(path: &Path) -> Option<usize> {
    let folder = Path::new(path.iter().next()?).file_stem()?;
    ORDER.iter().position(|name| folder == *name)
}

/// Folders named as `crate::folder` that stand below `own`.
fn upward_imports(own: usize, code: &str) -> Vec<&str> {
    let named = code.match_indices("crate::").filter_map(|(at, _)| words(&code[at + 7..]).next());
    named.filter(|name| ORDER[own + 1..].contains(name)).collect()
}

#[test]
fn a_folder_imports_only_from_folders_above_it() {
    for (path, code) in source_files() {
        if path == Path::new("lib.rs") {
            continue;
        }
        let own = rank(&path).unwrap_or_else(|| panic!("src/{} is in no folder of ORDER", path.display()));
        let upward = upward_imports(own, &code);
        assert!(upward.is_empty(), "src/{} imports {upward:?} from below it", path.display());
    }
    assert_eq!(upward_imports(3, "use crate::search::a; // crate::base\nuse crate::base::b;"), ["search"]);
}

#[test]
fn the_search_and_the_spectral_refinement_see_no_positions() {
    let sees = |code: &str| words(code).any(|word| word == "positions");
    let mut seen = 0;
    for (path, code) in source_files() {
        let intrinsic = INTRINSIC.iter().any(|name| path.to_str().unwrap().starts_with(name));
        let may = EXTRINSIC.iter().any(|name| path.to_str().unwrap().starts_with(name));
        assert!(!intrinsic || may || !sees(&code), "src/{} names positions", path.display());
        seen += usize::from(intrinsic && may && sees(&code));
    }
    assert!(seen > 0, "the check sees what it looks for");
}
