//! From eigenfunctions to candidate maps: parities, starts, refinement on samples, scores.

pub mod candidate_score;
pub mod candidates;
pub mod compositions;
pub mod extrema_starts;
pub mod functional_map;
pub mod parity_search;
pub mod refinement;
pub mod sign_network;
pub mod twin_starts;
