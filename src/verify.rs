//! What speaks for a finished map: its measures, the verdict, the confidence of each vertex.

pub mod acceptance;
pub mod confidence;
pub mod hypothesis;
pub mod outcome;
