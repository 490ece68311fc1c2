//! The C ABI: what `include/isym.h` declares, which cbindgen makes from the exported functions here.
//!
//! A handle is a number in a table, never an address ([`handles`]): one that was freed, or is of another
//! kind, is told apart from a live one without touching memory, and freeing in one thread what another is
//! working with is harmless. Callers' arrays are checked and copied at the border ([`memory`]), results are
//! copied out after everything else has succeeded, and no panic leaves ([`panic_boundary::boundary`]).
//!
//! Every exported function that takes a pointer trusts the caller in one thing alone: that the memory
//! it points to has the length that the documentation states.
#![allow(unsafe_code)] // The C ABI is one of the two places that may.
#![allow(non_camel_case_types)] // Names are those of the header.
#![allow(clippy::missing_safety_doc)] // The one condition stands above.

pub mod eigen;
pub mod handles;
pub mod memory;
pub mod mesh;
pub mod options;
pub mod panic_boundary;
pub mod progress;
pub mod result;
pub mod status;
pub mod tools;
pub mod version;
