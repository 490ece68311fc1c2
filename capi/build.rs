//! Compiles the C++ side of `src/progress.rs`.

const CALLBACK: &str = "cpp/callback.cpp";

fn main() {
    cc::Build::new().cpp(true).std("c++17").file(CALLBACK).compile("intrinsym_callback");
    // What is linked for the library alone, `examples/c_panic.rs` needs, too.
    let folder = std::env::var("OUT_DIR").expect("cargo's folder");
    println!("cargo:rustc-link-arg-examples={folder}/libintrinsym_callback.a");
    name_shared_library();
    for path in [CALLBACK, "build.rs"] {
        println!("cargo:rerun-if-changed={path}");
    }
}

/// Gives the shared library a name that changes with its ABI.
fn name_shared_library() {
    let major = std::env::var("CARGO_PKG_VERSION_MAJOR").unwrap_or_default();
    if std::env::var("CARGO_CFG_TARGET_OS").is_ok_and(|system| system == "linux") {
        println!("cargo:rustc-cdylib-link-arg=-Wl,-soname,libintrinsym.so.{major}");
    }
}
