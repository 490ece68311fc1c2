//! The driver, what it simplifies and carries back, other shells, and the answer.

pub mod assembler;
pub mod assembly;
pub mod attempt;
pub mod clock;
pub mod companions;
pub mod contact_graph;
pub mod correspondence;
pub mod coverage;
pub mod detect_again;
pub mod detection;
pub mod domain;
pub mod driver;
pub mod eigen;
pub mod excess;
pub mod filled_holes;
pub mod finishing;
pub mod fixed_curve;
pub mod joined_shells;
pub mod judging_mesh;
pub mod mirror_plane;
pub mod proxy;
pub mod question;
pub mod report;
pub mod shell_symmetry;
pub mod spectrum;
pub mod stated_signs;
pub mod twins;
pub mod welded_vertices;

use crate::refine::rigid_parts::cluster_motion;
