//! `isym_version`.

use std::ffi::{CStr, c_char};

const VERSION: &CStr = match CStr::from_bytes_with_nul(concat!(env!("CARGO_PKG_VERSION"), "\0").as_bytes()) {
    Ok(version) => version,
    Err(_) => panic!("the version holds a NUL"),
};

/// The version of the library that is running; compare with `ISYM_VERSION`, that of the header.
///
/// @return Such as "0.1.0". Never NULL, never freed.
#[unsafe(no_mangle)]
pub extern "C" fn isym_version() -> *const c_char {
    VERSION.as_ptr()
}
