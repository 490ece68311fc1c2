//! A library for `tests/c/panic.c` alone: the C library with one more function, which panics behind the border.
//! It is an example of cargo's, so that the product has no such function.
#![allow(unsafe_code)] // `no_mangle`

#[allow(dead_code)]
#[path = "../src/lib.rs"]
mod capi;

use capi::panic_boundary::boundary;
use capi::status::isym_status;

/// Panics, as a defect of ours would.
#[unsafe(no_mangle)]
pub extern "C" fn isym_test_panic() -> isym_status {
    boundary(|| panic!("provoked by a test"))
}
