//! How much work the fit of the rigid parts may take.

use serde::{Deserialize, Serialize};

/// Counts that trade time for accuracy.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PartsEffort {
    /// Parts of the first pass, which are large, and of the second.
    pub passes: [usize; 2],
    /// Points of a part that its motion is fitted to.
    pub points: usize,
    /// Rounds of that fit.
    pub rounds: usize,
    /// How turned parts are sought; `None` if they are not.
    pub turned: Option<TurnedEffort>,
}

/// The same for turned parts.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TurnedEffort {
    /// Parts of each size that may be turned.
    pub parts: usize,
    /// Points of each that a motion is fitted to.
    pub points: usize,
    /// Turns about each axis that are tried.
    pub turns: usize,
    /// Small parts all over the surface that say where a turned one takes over.
    pub small: usize,
    /// How many of the turns are fitted to all points.
    pub fitted: usize,
    /// Parts for which turns are sought: those that fit worst.
    pub most: usize,
}

impl PartsEffort {
    /// Slower and a little more exact than the default.
    pub fn thorough() -> PartsEffort {
        let turned = TurnedEffort { parts: 70, points: 100, turns: 12, small: 300, fitted: 4, most: 100 };
        PartsEffort { passes: [200, 400], points: 80, rounds: 5, turned: Some(turned) }
    }

    /// The same without turned parts.
    pub fn without_turned(self) -> PartsEffort {
        PartsEffort { turned: None, ..self }
    }
}

impl Default for PartsEffort {
    fn default() -> PartsEffort {
        let turned = TurnedEffort { parts: 70, points: 100, turns: 12, small: 150, fitted: 2, most: 12 };
        PartsEffort { passes: [100, 200], points: 40, rounds: 3, turned: Some(turned) }
    }
}
