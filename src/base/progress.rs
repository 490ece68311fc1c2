//! Progress and cancellation, handed down as an argument.

use crate::base::error::{Error, Result};
use std::cell::Cell;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Cancels a running call from any thread. Clones share the same flag.
#[derive(Debug, Clone, Default)]
pub struct CancelToken {
    flag: Arc<AtomicBool>,
    /// When the call has to end, however far it is.
    deadline: Option<Instant>,
}

impl CancelToken {
    /// Asks the running call to stop; it returns [`Error::Cancelled`] within half a second on a mesh of 100,000 vertices.
    pub fn cancel(&self) {
        self.flag.store(true, Ordering::Relaxed);
    }

    /// Whether [`CancelToken::cancel`] was called.
    pub fn is_cancelled(&self) -> bool {
        self.flag.load(Ordering::Relaxed)
    }

    /// Answers whether to go on.
    ///
    /// # Errors
    /// [`Error::Cancelled`] or [`Error::TimeLimit`] if not.
    pub fn check(&self) -> Result<()> {
        if self.is_cancelled() {
            return Err(Error::Cancelled);
        }
        let is_late = self.deadline.is_some_and(|deadline| Instant::now() >= deadline);
        if is_late { Err(Error::TimeLimit { stage: "" }) } else { Ok(()) }
    }
}

/// Called with a stage name and the fraction of the whole call, 0..=1, that is done.
pub type ProgressCallback<'a> = &'a dyn Fn(&str, f64);

/// Reports a stage name and a fraction that never decreases, and answers whether to go on.
pub struct Progress<'a> {
    callback: Option<ProgressCallback<'a>>,
    token: CancelToken,
    fraction: Cell<f64>,
    /// The last stage that was reported.
    stage: Cell<&'static str>,
}

impl Default for Progress<'_> {
    fn default() -> Self {
        Progress::new(None, CancelToken::default())
    }
}

impl<'a> Progress<'a> {
    /// A progress that calls `callback(stage, fraction in 0..=1)` and stops when `token` is cancelled.
    pub fn new(callback: Option<ProgressCallback<'a>>, token: CancelToken) -> Self {
        Progress { callback, token, fraction: Cell::new(0.0), stage: Cell::new("") }
    }

    /// The same for a call that ends with [`Error::TimeLimit`] after so many `seconds` from now; 0 for no limit.
    pub(crate) fn within(&self, seconds: usize) -> Progress<'a> {
        let deadline = match seconds {
            0 => None,
            _ => Instant::now().checked_add(Duration::from_secs(seconds as u64)),
        };
        Progress::new(self.callback, CancelToken { deadline, ..self.token.clone() })
    }

    /// Names the stage in which the time ended.
    pub(crate) fn name_stage<T>(&self, result: Result<T>) -> Result<T> {
        result.map_err(|error| match error {
            Error::TimeLimit { .. } => Error::TimeLimit { stage: self.stage.get() },
            other => other,
        })
    }

    /// Answers whether to go on, without a word to the callback: for loops inside a stage.
    ///
    /// # Errors
    /// Those of [`CancelToken::check`].
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
    /// Those of [`CancelToken::check`].
    pub fn report(&self, stage: &'static str, fraction: f64) -> Result<()> {
        self.stage.set(stage);
        self.check()?;
        self.tell(stage, fraction);
        Ok(())
    }

    /// Says that the stage that was reported last goes on.
    ///
    /// # Errors
    /// Those of [`CancelToken::check`].
    pub(crate) fn goes_on(&self) -> Result<()> {
        self.report(self.stage.get(), self.fraction.get())
    }

    /// Says that the answer is there, however late it is.
    ///
    /// # Errors
    /// [`Error::Cancelled`].
    pub(crate) fn done(&self) -> Result<()> {
        if self.token.is_cancelled() {
            return Err(Error::Cancelled);
        }
        self.tell("done", 1.0);
        Ok(())
    }

    fn tell(&self, stage: &str, fraction: f64) {
        let fraction = fraction.clamp(self.fraction.get(), 1.0);
        self.fraction.set(fraction);
        if let Some(callback) = self.callback {
            callback(stage, fraction);
        }
    }
}
