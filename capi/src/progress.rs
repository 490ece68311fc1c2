//! `isym_progress_*`: a callback, a fraction that can be polled, and cancellation from any thread.

use super::handles::Table;
use super::memory::Output;
use super::panic_boundary::boundary;
use super::status::{Fault, ISYM_ERROR_CALLBACK, ISYM_ERROR_NULL, Result, isym_status};
use intrinsym::{CancelToken, Progress};
use std::cell::RefCell;
use std::ffi::{CStr, CString, c_char, c_void};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// Progress of a call, and the way to cancel it. Make one for each call: once cancelled it stays so.
pub struct isym_progress(());

/// What a call reports to. It runs in the thread of that call.
///
/// @param stage Name of the stage: UTF-8, valid during this call.
/// @param fraction How much of the whole call is done, 0..=1; it never decreases.
/// @param user_data As given to `isym_progress_set_callback`.
/// @return 0 to go on; any other number cancels.
pub type isym_progress_callback =
    Option<unsafe extern "C" fn(stage: *const c_char, fraction: f64, user_data: *mut c_void) -> i32>;

#[link(name = "intrinsym_callback", kind = "static")]
unsafe extern "C" {
    /// `cpp/callback.cpp`.
    fn intrinsym_call_progress(
        callback: isym_progress_callback,
        stage: *const c_char,
        fraction: f64,
        user_data: *mut c_void,
        what: *mut c_char,
        capacity: usize,
    ) -> i32;
}

/// A host's callback with its data.
#[derive(Clone, Copy)]
struct Callback {
    function: isym_progress_callback,
    user_data: *mut c_void,
}

// SAFETY: the host is told that the callback runs in the thread of the call, and gave it for that.
unsafe impl Send for Callback {}

/// What a progress handle stands for.
#[derive(Default)]
pub struct ProgressObject {
    token: CancelToken,
    fraction: AtomicU64,
    callback: Mutex<Option<Callback>>,
}

/// Live progress handles.
pub static PROGRESSES: Table<isym_progress, ProgressObject> = Table::new("progress handle");

/// The progress of a handle; for NULL one that nobody sees.
pub fn progress_of(handle: *const isym_progress) -> Result<Arc<ProgressObject>> {
    if handle.is_null() { Ok(Arc::default()) } else { PROGRESSES.get(handle) }
}

impl ProgressObject {
    /// Runs a stage with this progress. A callback's exception is the result, whatever the stage answers.
    pub fn run<T>(&self, stage: impl FnOnce(&Progress) -> intrinsym::Result<T>) -> Result<T> {
        let callback = *self.callback.lock().unwrap_or_else(PoisonError::into_inner);
        let thrown = RefCell::new(None);
        let report = |stage: &str, fraction: f64| {
            self.fraction.store(fraction.to_bits(), Ordering::Relaxed);
            if let Some(Err(fault)) = callback.map(|callback| callback.call(stage, fraction, &self.token)) {
                thrown.borrow_mut().get_or_insert(fault);
            }
        };
        let outcome = stage(&Progress::new(Some(&report), self.token.clone()));
        match thrown.take() {
            Some(fault) => Err(fault),
            None => Ok(outcome?),
        }
    }
}

impl Callback {
    fn call(self, stage: &str, fraction: f64, token: &CancelToken) -> Result {
        let stage = CString::new(stage).unwrap_or_default();
        let mut what = [0 as c_char; 256];
        // SAFETY: the host's function with the host's data; `what` is as long as said and ends in a NUL.
        let answer = unsafe {
            let (text, room) = (what.as_mut_ptr(), what.len());
            intrinsym_call_progress(self.function, stage.as_ptr(), fraction, self.user_data, text, room)
        };
        if answer != 0 {
            token.cancel();
        }
        if answer != 2 {
            return Ok(());
        }
        // SAFETY: the other side wrote a text with its end.
        let what = unsafe { CStr::from_ptr(what.as_ptr()) }.to_string_lossy();
        Err(Fault::new(ISYM_ERROR_CALLBACK, format!("the progress callback threw: {what}")))
    }
}

/// Makes a progress without a callback.
///
/// @param[out] progress Free it with `isym_progress_free`.
/// @return `ISYM_OK`, or an error that any call has.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isym_progress_new(progress: *mut *mut isym_progress) -> isym_status {
    boundary(|| {
        // SAFETY: the caller's one promise.
        let output = unsafe { Output::new(progress, 1, "progress") }?;
        output.write(&[PROGRESSES.insert(ProgressObject::default())]);
        Ok(())
    })
}

/// Gives the function that later calls with this progress report to.
///
/// @param progress The progress.
/// @param callback A C++ exception thrown by it ends the call with `ISYM_ERROR_CALLBACK`.
/// @param user_data Handed to the callback; may be NULL.
/// @return `ISYM_OK`, or an error that any call has.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isym_progress_set_callback(
    progress: *mut isym_progress,
    callback: isym_progress_callback,
    user_data: *mut c_void,
) -> isym_status {
    boundary(|| {
        let progress = PROGRESSES.get(progress)?;
        if callback.is_none() {
            return Err(Fault::new(ISYM_ERROR_NULL, "the callback is NULL"));
        }
        let callback = Some(Callback { function: callback, user_data });
        *progress.callback.lock().unwrap_or_else(PoisonError::into_inner) = callback;
        Ok(())
    })
}

/// Reads how much of the call that last reported here is done. From any thread.
///
/// @param progress The progress.
/// @param[out] fraction 0..=1.
/// @return `ISYM_OK`, or an error that any call has.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isym_progress_fraction(
    progress: *const isym_progress,
    fraction: *mut f64,
) -> isym_status {
    boundary(|| {
        let progress = PROGRESSES.get(progress)?;
        // SAFETY: the caller's one promise.
        let output = unsafe { Output::new(fraction, 1, "fraction") }?;
        output.write(&[f64::from_bits(progress.fraction.load(Ordering::Relaxed))]);
        Ok(())
    })
}

/// Cancels the running call, and every later one, with this progress. From any thread, also from the callback.
///
/// The call returns `ISYM_ERROR_CANCELLED` within half a second on a mesh of 100,000 vertices, whatever its form.
///
/// @param progress The progress.
/// @return `ISYM_OK`, or an error that any call has.
#[unsafe(no_mangle)]
pub extern "C" fn isym_progress_cancel(progress: *mut isym_progress) -> isym_status {
    boundary(|| {
        PROGRESSES.get(progress)?.token.cancel();
        Ok(())
    })
}

/// Frees a progress. A call that runs with it goes on, and can no longer be cancelled.
///
/// @param progress The progress; NULL is fine.
/// @return `ISYM_OK`, `ISYM_ERROR_HANDLE`.
#[unsafe(no_mangle)]
pub extern "C" fn isym_progress_free(progress: *mut isym_progress) -> isym_status {
    boundary(|| PROGRESSES.remove(progress))
}
