//! Compiles the C++ side of `src/ffi/progress.rs`.

fn main() {
    let source = "cpp/ffi/callback.cpp";
    cc::Build::new().cpp(true).std("c++17").file(source).compile("intrinsym_callback");
    name_shared_library();
    for path in [source, "build.rs"] {
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
