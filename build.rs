//! Finds OpenMesh and compiles the C++ side of `src/mesh/openmesh.rs` and of `src/ffi/progress.rs`.

use std::path::{Path, PathBuf};
use std::process::exit;

const BRIDGE: &str = "src/mesh/openmesh.rs";
const SOURCES: [&str; 3] =
    ["cpp/openmesh/half_edges.cpp", "cpp/openmesh/half_edges.h", "cpp/ffi/callback.cpp"];
const HEADER: &str = "OpenMesh/Core/Mesh/PolyConnectivity.hh";

/// Where OpenMesh is: include folders, and folders to link from.
struct OpenMesh {
    include: Vec<PathBuf>,
    link: Vec<PathBuf>,
}

fn main() {
    let openmesh = find_openmesh().unwrap_or_else(|reason| {
        eprintln!(
            "error: OpenMesh is missing: {reason}.\n\
             On Debian or Ubuntu: apt-get install libopenmesh-dev pkg-config\n\
             Elsewhere: set OPENMESH_DIR to the folder that holds OpenMesh's include/ and lib/."
        );
        exit(1);
    });
    cxx_build::bridge(BRIDGE)
        .file(SOURCES[0])
        .file(SOURCES[2])
        .includes(&openmesh.include)
        .std("c++17")
        .flag_if_supported("-Wno-deprecated-copy")
        .compile("intrinsym_openmesh");
    link(&openmesh);
    name_shared_library();
    for path in SOURCES.iter().chain([&BRIDGE, &"build.rs"]) {
        println!("cargo:rerun-if-changed={path}");
    }
    println!("cargo:rerun-if-env-changed=OPENMESH_DIR");
}

fn find_openmesh() -> Result<OpenMesh, String> {
    match std::env::var_os("OPENMESH_DIR") {
        Some(folder) => openmesh_in(Path::new(&folder)),
        None => openmesh_by_pkg_config(),
    }
}

fn openmesh_in(folder: &Path) -> Result<OpenMesh, String> {
    let include = folder.join("include");
    if !include.join(HEADER).is_file() {
        return Err(format!("OPENMESH_DIR is {}, which has no include/{HEADER}", folder.display()));
    }
    let link =
        ["lib", "lib64"].map(|name| folder.join(name)).into_iter().filter(|path| path.is_dir()).collect();
    Ok(OpenMesh { include: vec![include], link })
}

fn openmesh_by_pkg_config() -> Result<OpenMesh, String> {
    let library =
        pkg_config::Config::new().cargo_metadata(false).atleast_version("8.0").probe("openmesh").map_err(
            |error| format!("pkg-config does not find openmesh 8 or later ({})", first_line(&error)),
        )?;
    Ok(OpenMesh { include: library.include_paths, link: library.link_paths })
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

/// Gives the shared library a name that changes with its ABI.
fn name_shared_library() {
    let major = std::env::var("CARGO_PKG_VERSION_MAJOR").unwrap_or_default();
    if std::env::var("CARGO_CFG_TARGET_OS").is_ok_and(|system| system == "linux") {
        println!("cargo:rustc-cdylib-link-arg=-Wl,-soname,libintrinsym.so.{major}");
    }
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
