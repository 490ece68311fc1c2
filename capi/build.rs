//! Compiles the C++ side of `src/progress.rs`.

const CALLBACK: &str = "cpp/callback.cpp";

fn main() {
    let mut build = cc::Build::new();
    build.cpp(true).std("c++17").file(CALLBACK);
    // `src/progress.rs` names what is linked: cargo would link it into the library alone, and the example needs it, too.
    build.cargo_metadata(false).compile("intrinsym_callback");
    println!("cargo:rustc-link-search=native={}", std::env::var("OUT_DIR").expect("cargo's folder"));
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
