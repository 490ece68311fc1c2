//! Compiles the C++ side of `capi/src/progress.rs`, which `c_calls` links.

fn main() {
    let callback = "../capi/cpp/callback.cpp";
    let mut build = cc::Build::new();
    build.cpp(true).std("c++17").file(callback).cargo_metadata(false).compile("intrinsym_callback");
    println!("cargo:rustc-link-search=native={}", std::env::var("OUT_DIR").expect("cargo's folder"));
    println!("cargo:rerun-if-changed={callback}");
}
