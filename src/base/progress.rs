//! Progress and cancellation, handed down as an argument.

use crate::base::error::{Error, Result};
use std::cell::Cell;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Cancels a running call from any thread. Clones share the same flag.
#[derive(Debug, Clone, Default)]
pub struct CancelToken(Arc<AtomicBool>);

impl CancelToken {
    /// Asks the running call to stop; it returns [`Error::Cancelled`] after at most one solver step.
    pub fn cancel(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether [`CancelToken::cancel`] was called.
    pub fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    /// Answers whether to go on.
    ///
    /// # Errors
    /// [`Error::Cancelled`] if not.
    pub fn check(&self) -> Result<()> {
        if self.is_cancelled() { Err(Error::Cancelled) } else { Ok(()) }
    }
}

/// Called with a stage name and the fraction of the whole call, 0..=1, that is done.
pub type ProgressCallback<'a> = &'a dyn Fn(&str, f64);

/// Reports a stage name and a fraction that never decreases, and answers whether to go on.
pub struct Progress<'a> {
    callback: Option<ProgressCallback<'a>>,
    token: CancelToken,
    fraction: Cell<f64>,
}

impl Default for Progress<'_> {
    fn default() -> Self {
        Progress { callback: None, token: CancelToken::default(), fraction: Cell::new(0.0) }
    }
}

impl<'a> Progress<'a> {
    /// A progress that calls `callback(stage, fraction in 0..=1)` and stops when `token` is cancelled.
    pub fn new(callback: Option<ProgressCallback<'a>>, token: CancelToken) -> Self {
        Progress { callback, token, fraction: Cell::new(0.0) }
    }

    /// Answers whether to go on, without a word to the callback: for loops inside a stage.
    ///
    /// # Errors
    /// [`Error::Cancelled`] if the token was cancelled.
    pub fn check(&self) -> Result<()> {
        self.token.check()
    }

    /// The flag that [`Progress::check`] looks at, for other threads: they report nothing.
    pub fn token(&self) -> &CancelToken {
        &self.token
    }

    /// Says that `stage` has reached `fraction` of the whole call.
    ///
    /// # Errors
    /// [`Error::Cancelled`] if the token was cancelled.
    pub fn report(&self, stage: &str, fraction: f64) -> Result<()> {
        self.check()?;
        let fraction = fraction.clamp(self.fraction.get(), 1.0);
        self.fraction.set(fraction);
        if let Some(callback) = self.callback {
            callback(stage, fraction);
        }
        Ok(())
    }
}
