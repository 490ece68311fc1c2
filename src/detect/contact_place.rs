//! Where two shells touch, and where a map takes that place.

use crate::base::symmetry_kind::SymmetryKind;
use crate::mesh::vector::{Vector, mean, squared_norm, subtract};
use crate::refine::rigid_parts;

/// Distance from a contact, in sqrt(area), at which a point of a shell has less to say there.
const NEAR: f64 = 0.03;

/// Where two shells touch: the middle, and how far it reaches, squared.
pub struct ContactPlace {
    /// Both.
    pub shells: [usize; 2],
    /// In the mesh's unit.
    pub middle: Vector,
    reach: f64,
}

impl ContactPlace {
    /// Around `points` of both.
    pub fn new(shells: [usize; 2], points: &[Vector]) -> ContactPlace {
        let middle = mean(points.iter().copied());
        let reach = points.iter().map(|&at| squared_norm(subtract(at, middle))).fold(0.0, f64::max);
        ContactPlace { shells, middle, reach }
    }

    /// Where a shell takes `places` at the contact, by where its points go; `None` if these are few.
    pub fn carried(
        &self,
        goes: impl Iterator<Item = [Vector; 2]>,
        kind: SymmetryKind,
        places: &[Vector],
    ) -> Option<Vec<Vector>> {
        let weighted = |[from, to]: [Vector; 2]| {
            let away = squared_norm(subtract(from, self.middle));
            (from, to, 1.0 / (1.0 + away / (self.reach + NEAR * NEAR)).powi(2))
        };
        let goes: Vec<(Vector, Vector, f64)> = goes.map(weighted).collect();
        (goes.len() > 3).then(|| rigid_parts::carried(&goes, kind, places))
    }
}
