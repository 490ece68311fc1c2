//! The border to C: every exported function runs inside, so that no panic leaves the library and each error keeps its text.

use super::status::{Fault, ISYM_ERROR_INTERNAL, ISYM_OK, Result, isym_status};
use std::any::Any;
use std::cell::RefCell;
use std::ffi::{CString, c_char};
use std::panic::{AssertUnwindSafe, catch_unwind};

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::status::ISYM_ERROR_VALUE;
    use std::ffi::CStr;

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
}
