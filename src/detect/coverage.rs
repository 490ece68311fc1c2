//! How much of a mesh a symmetry speaks of.

use crate::detect::assembly::mean_over_surface;
use crate::mesh::{Mesh, NONE};

/// What share of the surface has a partner, and what becomes of the shells.
///
/// A shell counts as most of its vertices do: with partners on another shell, on itself, or without any.
#[derive(Debug, Clone, Copy, Default, PartialEq, serde::Serialize)]
pub struct Coverage {
    /// Share of the surface whose vertices have a partner, 0..=1.
    pub paired_share: f64,
    /// Shells whose mirror image is another shell.
    pub shells_paired: usize,
    /// Shells that are their own mirror image.
    pub shells_self_mirrored: usize,
    /// Shells without a mirror image.
    pub shells_alone: usize,
}

impl Coverage {
    /// Of a symmetry with these `partner`s, one for each caller's vertex, -1 for none.
    pub fn of(mesh: &Mesh, partner: &[i32]) -> Coverage {
        let of_point: Vec<u32> = mesh
            .vertex_of_point
            .iter()
            .map(|&vertex| partner_point(mesh, partner[vertex as usize]))
            .collect();
        let has_partner: Vec<f32> = of_point.iter().map(|&to| if to == NONE { 0.0 } else { 1.0 }).collect();
        let targets = targets_of_shells(mesh, &of_point);
        let count = |is_counted: &dyn Fn(usize, u32) -> bool| {
            targets.iter().enumerate().filter(|&(own, &target)| is_counted(own, target)).count()
        };
        Coverage {
            paired_share: mean_over_surface(mesh, &has_partner),
            shells_paired: count(&|own, target| target != NONE && target as usize != own),
            shells_self_mirrored: count(&|own, target| target as usize == own),
            shells_alone: count(&|_, target| target == NONE),
        }
    }

    /// One sentence, without a full stop.
    pub fn in_words(&self) -> String {
        let Coverage { paired_share, shells_paired, shells_self_mirrored, shells_alone } = *self;
        // What leaves anything alone is not 100 %, however small that is.
        let is_all = shells_alone == 0 && paired_share > 1.0 - 1e-9;
        let percent = if is_all { 100.0 } else { (100.0 * paired_share).min(99.0) };
        let share = format!("{percent:.0} % of the surface has a partner");
        let shells = shells_paired + shells_self_mirrored + shells_alone;
        if shells < 2 {
            return share;
        }
        format!(
            "{share}; of {shells} shells {shells_paired} are paired, {shells_self_mirrored} their own mirror image, \
             {shells_alone} without a partner"
        )
    }
}

/// The point of a caller's vertex, [`NONE`] for none, -1.
pub fn partner_point(mesh: &Mesh, partner: i32) -> u32 {
    usize::try_from(partner).map_or(NONE, |partner| mesh.point_of_vertex[partner])
}

/// Where most points of each shell go: to a shell, or [`NONE`].
pub fn targets_of_shells(mesh: &Mesh, of_point: &[u32]) -> Vec<u32> {
    let target = |&partner: &u32| if partner == NONE { NONE } else { mesh.shell_of_point[partner as usize] };
    let mut pairs: Vec<(u32, u32)> =
        mesh.shell_of_point.iter().copied().zip(of_point.iter().map(target)).collect();
    pairs.sort_unstable();
    let mut most = vec![(0, NONE); mesh.shell_count];
    for same in pairs.chunk_by(|a, b| a == b) {
        let (shell, target) = same[0];
        let known = &mut most[shell as usize];
        if same.len() > known.0 {
            *known = (same.len(), target);
        }
    }
    most.into_iter().map(|(_, target)| target).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::limits::Limits;
    use crate::mesh::PolygonMesh;

    /// Four triangles, one of them four times as large as the others.
    fn triangles() -> Mesh {
        let corner = |shell: usize, k: usize| {
            let size = if shell == 3 { 2.0 } else { 1.0 };
            let (x, y) = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)][k];
            [10.0 * shell as f64 + size * x, size * y, 0.0]
        };
        let polygons = PolygonMesh {
            positions: (0..12).map(|vertex| corner(vertex / 3, vertex % 3)).collect(),
            face_offsets: vec![0, 3, 6, 9, 12],
            face_vertices: (0..12).collect(),
        };
        Mesh::new(&polygons, &Limits::default()).expect("a usable mesh")
    }

    #[test]
    fn shells_are_paired_their_own_mirror_image_or_alone() {
        let found = Coverage::of(&triangles(), &[3, 4, 5, 0, 1, 2, 6, 8, 7, -1, -1, -1]);
        let expected =
            Coverage { paired_share: 3.0 / 7.0, shells_paired: 2, shells_self_mirrored: 1, shells_alone: 1 };
        assert!((found.paired_share - expected.paired_share).abs() < 1e-12);
        assert_eq!(found, Coverage { paired_share: found.paired_share, ..expected });
        assert_eq!(
            found.in_words(),
            "43 % of the surface has a partner; of 4 shells 2 are paired, 1 their own mirror image, 1 without a partner"
        );
    }

    #[test]
    fn what_leaves_anything_alone_is_not_all_of_the_surface() {
        let words = |paired_share, shells_alone| {
            Coverage { paired_share, shells_paired: 2, shells_self_mirrored: 0, shells_alone }.in_words()
        };
        assert!(words(1.0, 1).starts_with("99 %") && words(0.996, 0).starts_with("99 %"));
        assert!(words(1.0, 0).starts_with("100 %"));
    }

    #[test]
    fn a_shell_counts_as_most_of_its_vertices_do() {
        let found = Coverage::of(&triangles(), &[3, 4, -1, 0, -1, -1, -1, 8, 7, -1, -1, -1]);
        assert_eq!((found.shells_paired, found.shells_self_mirrored, found.shells_alone), (1, 1, 2));
    }
}
