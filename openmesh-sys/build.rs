//! Finds OpenMesh, or builds it from source, and compiles the C++ side of the bridge.

use std::env::var_os;
use std::path::{Path, PathBuf};
use std::process::exit;

const BRIDGE: &str = "src/lib.rs";
const SOURCES: [&str; 2] = ["cpp/half_edges.cpp", "cpp/half_edges.h"];
const HEADER: &str = "OpenMesh/Core/Mesh/PolyConnectivity.hh";
/// What the half-edges need of OpenMesh's source.
const CORE: [&str; 5] = [
    "Mesh/ArrayKernel.cc",
    "Mesh/BaseKernel.cc",
    "Mesh/PolyConnectivity.cc",
    "System/omstream.cc",
    "Utils/BaseProperty.cc",
];

/// Where OpenMesh is.
struct OpenMesh {
    include: Vec<PathBuf>,
    /// Folders to link from.
    link: Vec<PathBuf>,
    /// C++ files to build, if there is no library to link.
    sources: Vec<PathBuf>,
}

fn main() {
    for path in SOURCES.iter().chain([&BRIDGE, &"build.rs"]) {
        println!("cargo:rerun-if-changed={path}");
    }
    for variable in ["OPENMESH_SOURCE", "OPENMESH_DIR", "DOCS_RS"] {
        println!("cargo:rerun-if-env-changed={variable}");
    }
    // Documentation links nothing.
    if var_os("DOCS_RS").is_some() {
        return;
    }
    let openmesh = find_openmesh().unwrap_or_else(|reason| {
        eprintln!(
            "error: OpenMesh is missing: {reason}.\n\
             On Debian or Ubuntu: apt-get install libopenmesh-dev pkg-config\n\
             Elsewhere: set OPENMESH_DIR to the folder that holds OpenMesh's include/ and lib/,\n\
             or OPENMESH_SOURCE to its source, which is built then."
        );
        exit(1);
    });
    cxx_build::bridge(BRIDGE)
        .file(SOURCES[0])
        .includes(&openmesh.include)
        .std("c++17")
        .flag_if_supported("-Wno-deprecated-copy")
        .compile("intrinsym_openmesh");
    if openmesh.sources.is_empty() {
        link(&openmesh);
    } else {
        build(&openmesh);
    }
}

fn find_openmesh() -> Result<OpenMesh, String> {
    match (var_os("OPENMESH_SOURCE"), var_os("OPENMESH_DIR")) {
        (Some(folder), _) => openmesh_from(Path::new(&folder)),
        (None, Some(folder)) => openmesh_in(Path::new(&folder)),
        (None, None) => openmesh_by_pkg_config(),
    }
}

fn openmesh_from(folder: &Path) -> Result<OpenMesh, String> {
    let include = folder.join("src");
    if !include.join(HEADER).is_file() {
        return Err(format!("OPENMESH_SOURCE is {}, which has no src/{HEADER}", folder.display()));
    }
    let core = include.join("OpenMesh/Core");
    let sources = CORE.map(|name| core.join(name)).to_vec();
    if let Some(missing) = sources.iter().find(|path| !path.is_file()) {
        return Err(format!("OPENMESH_SOURCE is {}, which has no {}", folder.display(), missing.display()));
    }
    Ok(OpenMesh { include: vec![include], link: Vec::new(), sources })
}

fn openmesh_in(folder: &Path) -> Result<OpenMesh, String> {
    let include = folder.join("include");
    if !include.join(HEADER).is_file() {
        return Err(format!("OPENMESH_DIR is {}, which has no include/{HEADER}", folder.display()));
    }
    let link =
        ["lib", "lib64"].map(|name| folder.join(name)).into_iter().filter(|path| path.is_dir()).collect();
    Ok(OpenMesh { include: vec![include], link, sources: Vec::new() })
}

fn openmesh_by_pkg_config() -> Result<OpenMesh, String> {
    let library =
        pkg_config::Config::new().cargo_metadata(false).atleast_version("8.0").probe("openmesh").map_err(
            |error| format!("pkg-config does not find openmesh 8 or later ({})", first_line(&error)),
        )?;
    Ok(OpenMesh { include: library.include_paths, link: library.link_paths, sources: Vec::new() })
}

fn first_line(error: &pkg_config::Error) -> String {
    error
        .to_string()
        .lines()
        .find(|line| !line.trim().is_empty())
        .unwrap_or("no reason given")
        .trim()
        .to_string()
}

/// Links OpenMeshCore only, from a static archive if one lies there, so that a shared library of ours
/// stands alone. Debian ships none: there the product needs `libopenmesh1` at run time.
fn link(openmesh: &OpenMesh) {
    for folder in &openmesh.link {
        println!("cargo:rustc-link-search=native={}", folder.display());
    }
    let archived = openmesh.link.iter().any(|folder| folder.join("libOpenMeshCore.a").is_file());
    println!("cargo:rustc-link-lib={}=OpenMeshCore", if archived { "static" } else { "dylib" });
}

fn build(openmesh: &OpenMesh) {
    cc::Build::new()
        .cpp(true)
        .std("c++17")
        .define("OM_STATIC_BUILD", None)
        .includes(&openmesh.include)
        .files(&openmesh.sources)
        .warnings(false)
        .flag_if_supported("-w")
        .compile("OpenMeshCore");
}
