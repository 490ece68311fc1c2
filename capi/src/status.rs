//! Status codes, the text of the last error, and the border that no panic crosses.

use super::memory::number;
use intrinsym::Error;
use std::any::Any;
use std::cell::RefCell;
use std::ffi::{CStr, CString, c_char};
use std::mem::MaybeUninit;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// What a call answers. A code is never given another meaning; treat one that you do not know as an error.
#[repr(i32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum isym_status {
    /// Done.
    ISYM_OK = 0,
    /// A pointer argument is NULL.
    ISYM_ERROR_NULL = 1,
    /// A handle was freed already, was never made, or is of another kind.
    ISYM_ERROR_HANDLE = 2,
    /// A length does not fit: an array has not the length that the mesh or result asks for.
    ISYM_ERROR_LENGTH = 3,
    /// An index is past the end: a symmetry or an option that does not exist.
    ISYM_ERROR_INDEX = 4,
    /// A text is not UTF-8.
    ISYM_ERROR_TEXT = 5,
    /// A value in an array, or a constant, is not among the accepted ones.
    ISYM_ERROR_VALUE = 6,
    /// A pointer is not aligned to its type.
    ISYM_ERROR_ALIGNMENT = 7,
    /// The `size` of a struct is not that of this library's: it was not set, or the header is of another version.
    ISYM_ERROR_SIZE = 8,
    /// The mesh cannot be used; the text names the element and the reason.
    ISYM_ERROR_MESH = 16,
    /// The file cannot be read or written; the text names the line or byte and what to do.
    ISYM_ERROR_FILE = 17,
    /// An option is unknown or outside its range.
    ISYM_ERROR_OPTION = 18,
    /// The sign network's model cannot be used.
    ISYM_ERROR_MODEL = 19,
    /// The mesh or file is larger than the limits allow.
    ISYM_ERROR_LIMIT = 20,
    /// The call was cancelled, by `isym_progress_cancel` or by the progress callback.
    ISYM_ERROR_CANCELLED = 21,
    /// The progress callback threw a C++ exception, which was stopped at the border.
    ISYM_ERROR_CALLBACK = 22,
    /// A defect of the library; please report it with the text. Handles stay usable.
    ISYM_ERROR_INTERNAL = 32,
}
pub use isym_status::*;

const NAMES: [(isym_status, &CStr); 17] = [
    (ISYM_OK, c"ISYM_OK"),
    (ISYM_ERROR_NULL, c"ISYM_ERROR_NULL"),
    (ISYM_ERROR_HANDLE, c"ISYM_ERROR_HANDLE"),
    (ISYM_ERROR_LENGTH, c"ISYM_ERROR_LENGTH"),
    (ISYM_ERROR_INDEX, c"ISYM_ERROR_INDEX"),
    (ISYM_ERROR_TEXT, c"ISYM_ERROR_TEXT"),
    (ISYM_ERROR_VALUE, c"ISYM_ERROR_VALUE"),
    (ISYM_ERROR_ALIGNMENT, c"ISYM_ERROR_ALIGNMENT"),
    (ISYM_ERROR_SIZE, c"ISYM_ERROR_SIZE"),
    (ISYM_ERROR_MESH, c"ISYM_ERROR_MESH"),
    (ISYM_ERROR_FILE, c"ISYM_ERROR_FILE"),
    (ISYM_ERROR_OPTION, c"ISYM_ERROR_OPTION"),
    (ISYM_ERROR_MODEL, c"ISYM_ERROR_MODEL"),
    (ISYM_ERROR_LIMIT, c"ISYM_ERROR_LIMIT"),
    (ISYM_ERROR_CANCELLED, c"ISYM_ERROR_CANCELLED"),
    (ISYM_ERROR_CALLBACK, c"ISYM_ERROR_CALLBACK"),
    (ISYM_ERROR_INTERNAL, c"ISYM_ERROR_INTERNAL"),
];

/// A status and what to tell about it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fault {
    /// Not `ISYM_OK`.
    pub status: isym_status,
    /// What is wrong, where, and what to do about it.
    pub message: String,
}

impl Fault {
    /// A fault with its text.
    pub fn new(status: isym_status, message: impl Into<String>) -> Fault {
        Fault { status, message: message.into() }
    }
}

impl From<Error> for Fault {
    fn from(error: Error) -> Fault {
        let status = match &error {
            Error::Mesh(_) => ISYM_ERROR_MESH,
            Error::File { .. } => ISYM_ERROR_FILE,
            Error::Option { .. } => ISYM_ERROR_OPTION,
            Error::Model(_) => ISYM_ERROR_MODEL,
            Error::Limit { .. } | Error::TimeLimit { .. } => ISYM_ERROR_LIMIT,
            Error::Cancelled => ISYM_ERROR_CANCELLED,
            // `Error::Internal`, and a kind that has no status yet.
            _ => ISYM_ERROR_INTERNAL,
        };
        Fault::new(status, error.to_string())
    }
}

/// What the functions behind the border return.
pub type Result<T = (), E = Fault> = std::result::Result<T, E>;

thread_local! {
    static MESSAGE: RefCell<CString> = RefCell::default();
}

/// Runs the inside of an exported function: keeps the error's text for `isym_error_message`, and turns a
/// panic into [`ISYM_ERROR_INTERNAL`].
pub fn boundary(call: impl FnOnce() -> Result) -> isym_status {
    let outcome = catch_unwind(AssertUnwindSafe(call)).unwrap_or_else(|panic| {
        Err(Fault::new(
            ISYM_ERROR_INTERNAL,
            format!("internal error, please report it: {}", text_of(&*panic)),
        ))
    });
    let (status, message) = match outcome {
        Ok(()) => (ISYM_OK, String::new()),
        Err(fault) => (fault.status, fault.message.replace('\0', "?")),
    };
    // A thread that is ending has no text any more; the status still says what happened.
    let _ = MESSAGE.try_with(|kept| *kept.borrow_mut() = CString::new(message).unwrap_or_default());
    status
}

fn text_of(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("a panic without text")
}

/// What went wrong in the last call of this thread that returned a status.
///
/// @return A sentence in UTF-8, for people; empty if that call returned `ISYM_OK`. Never NULL. Valid until this thread's
/// next such call.
#[unsafe(no_mangle)]
pub extern "C" fn isym_error_message() -> *const c_char {
    MESSAGE.try_with(|kept| kept.borrow().as_ptr()).unwrap_or(c"".as_ptr())
}

/// The name of a status in this header.
///
/// @param status Any number.
/// @return Such as "ISYM_ERROR_MESH"; "unknown status" for a number that is none. Never NULL, never freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isym_status_name(status: MaybeUninit<isym_status>) -> *const c_char {
    // SAFETY: C hands a number over.
    let status = unsafe { number(status) };
    let known = NAMES.iter().find(|(code, _)| *code as i32 == status);
    known.map_or(c"unknown status", |(_, name)| *name).as_ptr()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message() -> String {
        // SAFETY: never NULL, and no call of this thread comes between.
        unsafe { CStr::from_ptr(isym_error_message()) }.to_str().unwrap().to_string()
    }

    #[test]
    fn a_panic_becomes_a_status_with_its_text() {
        assert_eq!(boundary(|| panic!("vertex {} went missing", 7)), ISYM_ERROR_INTERNAL);
        assert_eq!(message(), "internal error, please report it: vertex 7 went missing");
        assert_eq!(boundary(|| std::panic::panic_any(3)), ISYM_ERROR_INTERNAL);
        assert!(message().ends_with("a panic without text"));
    }

    #[test]
    fn the_text_is_that_of_this_thread_s_last_call() {
        let fail = || boundary(|| Err(Fault::new(ISYM_ERROR_VALUE, "no \0 here")));
        assert_eq!(fail(), ISYM_ERROR_VALUE);
        assert_eq!(message(), "no ? here");
        std::thread::spawn(|| assert_eq!(message(), "")).join().unwrap();
        assert_eq!(boundary(|| Ok(())), ISYM_OK);
        assert_eq!(message(), "");
    }

    #[test]
    fn each_code_has_its_name() {
        for (code, name) in NAMES {
            // SAFETY: never NULL, never freed.
            let found = unsafe { CStr::from_ptr(isym_status_name(MaybeUninit::new(code))) };
            assert_eq!((found, name.to_str().unwrap()), (name, format!("{code:?}").as_str()));
        }
    }
}
