//! Any bytes as a PLY file.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| intrinsym_fuzz::read("fuzz.ply", bytes));
