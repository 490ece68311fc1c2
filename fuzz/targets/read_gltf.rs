//! Any bytes as a glTF file, text or binary.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| intrinsym_fuzz::read("fuzz.gltf", bytes));
