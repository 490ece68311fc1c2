//! Wall time by stage.

use std::time::Instant;

/// Wall time by stage.
pub struct Clock {
    last: Instant,
    /// Seconds of each stage, in order.
    pub laps: Vec<(String, f64)>,
}

impl Clock {
    /// Starts with no stage.
    pub fn start() -> Clock {
        Clock { last: Instant::now(), laps: Vec::new() }
    }

    /// Ends a stage, which began where the last one ended.
    pub fn lap(&mut self, stage: &str) {
        let now = Instant::now();
        self.laps.push((stage.into(), (now - self.last).as_secs_f64()));
        self.last = now;
    }
}
