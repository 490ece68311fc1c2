//! Parts of a surface that go to each other: a map sends each vertex to the part that is the twin of its own.
//!
//! Images are sought by distances in coordinates. Coordinates that tell parts apart, of a vertex those of its part and of its image those of the twin,
//! far from all others, keep them where they belong.

/// Coordinates of a part.
pub const CODE: usize = 6;
/// Parts at most.
pub const MOST_PARTS: usize = 1 << CODE;
/// The size of each coordinate, beside eigenfunctions whose squares have mean 1.
const SIZE: f32 = 10.0;

/// The part of each vertex, and the twin of that, both less than [`MOST_PARTS`].
#[derive(Debug, Clone)]
pub struct TwinParts {
    /// Part of each vertex.
    pub own: Vec<u8>,
    /// Part of its image.
    pub twin: Vec<u8>,
}

impl TwinParts {
    /// Whether some parts are not their own twins.
    pub fn any_exchange(&self) -> bool {
        self.own != self.twin
    }

    /// Those of some of the vertices.
    pub fn at(&self, vertices: &[u32]) -> TwinParts {
        let of = |parts: &[u8]| vertices.iter().map(|&vertex| parts[vertex as usize]).collect();
        TwinParts { own: of(&self.own), twin: of(&self.twin) }
    }
}

/// The coordinates of a part: two parts differ by twice their size in one at least.
pub fn code(part: u8) -> [f32; CODE] {
    std::array::from_fn(|bit| if part >> bit & 1 == 1 { SIZE } else { -SIZE })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn twins_tell_a_map_from_the_identity_where_some_part_is_not_its_own() {
        let parts = |twin: [u8; 3]| TwinParts { own: vec![0, 1, 2], twin: twin.to_vec() };
        assert!(parts([1, 0, 2]).any_exchange());
        assert!(!parts([0, 1, 2]).any_exchange());
    }
}
