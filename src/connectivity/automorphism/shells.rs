//! Connected components of the half-edge structure.

use crate::mesh::NONE;
use crate::mesh::half_edges::HalfEdges;

/// The main shell has one in so many of the vertices, or more: a body under its clothes.
const MAIN: usize = 4;
/// If none has, it has more than this share of the surface: a body of fewer vertices than its eyes.
const MOSTLY: f64 = 0.5;

/// Vertices grouped by shell, breadth first within each.
pub(super) struct Shells {
    /// The one shell with more vertices than any other, if these are many, or else that with most of the surface.
    main: Option<usize>,
    shell_of: Vec<u32>,
    starts: Vec<usize>,
    order: Vec<u32>,
}

impl Shells {
    /// Floods from each vertex not reached yet; `left_out` vertices of the mesh have no half-edges. `area_share` is that of a point in its surface.
    pub fn new(half_edges: &HalfEdges, left_out: usize, area_share: impl Fn(u32) -> f64) -> Self {
        let mut shells = Shells {
            main: None,
            shell_of: vec![NONE; half_edges.vertex_count()],
            starts: Vec::new(),
            order: Vec::new(),
        };
        for vertex in 0..half_edges.vertex_count() as u32 {
            if shells.shell_of[vertex as usize] == NONE {
                shells.starts.push(shells.order.len());
                shells.flood(half_edges, vertex);
            }
        }
        shells.starts.push(shells.order.len());
        let total = half_edges.vertex_count() + left_out;
        let by_size = shells.by_size();
        let size = |place: usize| by_size.get(place).map_or(0, |&shell| shells.vertices(shell).len());
        let area = |&vertex: &u32| area_share(half_edges.point_of_vertex[vertex as usize]);
        let area = |shell: usize| shells.vertices(shell).iter().map(area).sum::<f64>();
        shells.main = match MAIN * size(0) > total && size(0) > size(1) {
            true => by_size.first().copied(),
            false => by_size.into_iter().find(|&shell| area(shell) > MOSTLY),
        };
        shells
    }

    fn flood(&mut self, half_edges: &HalfEdges, start: u32) {
        let shell = self.starts.len() as u32 - 1;
        let mut head = self.order.len();
        self.shell_of[start as usize] = shell;
        self.order.push(start);
        while let Some(&vertex) = self.order.get(head) {
            head += 1;
            for half_edge in half_edges.outgoing_of(vertex) {
                let neighbour = half_edges.to_vertex[half_edge as usize];
                if self.shell_of[neighbour as usize] == NONE {
                    self.shell_of[neighbour as usize] = shell;
                    self.order.push(neighbour);
                }
            }
        }
    }

    /// Shells by falling number of vertices.
    pub fn by_size(&self) -> Vec<usize> {
        let mut shells: Vec<usize> = (0..self.starts.len() - 1).collect();
        shells.sort_by_key(|&shell| std::cmp::Reverse(self.vertices(shell).len()));
        shells
    }

    /// Whether a shell has more vertices than any other, and many, or most of the surface.
    pub fn is_main(&self, shell: usize) -> bool {
        self.main == Some(shell)
    }

    /// Vertices of a shell, breadth first.
    pub fn vertices(&self, shell: usize) -> &[u32] {
        &self.order[self.starts[shell]..self.starts[shell + 1]]
    }

    /// The shell that holds `vertex`.
    pub fn of(&self, vertex: u32) -> usize {
        self.shell_of[vertex as usize] as usize
    }

    /// Number of vertices of the shell that holds `vertex`.
    pub fn size_at(&self, vertex: u32) -> usize {
        self.vertices(self.of(vertex)).len()
    }
}
