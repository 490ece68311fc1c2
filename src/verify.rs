//! What speaks for a finished map: its measures, the verdict, the confidence of each vertex.

pub mod acceptance;
pub mod choose;
pub mod confidence;
pub mod hypothesis;
pub mod outcome;
pub mod reason;
