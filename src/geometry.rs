//! Surfaces in space: adjacency, points of triangles, shortest paths, walks, and the map that every stage passes on.

pub mod adjacency;
pub mod embedded_triangles;
pub mod shortest_paths;
pub mod surface_grid;
pub mod surface_walk;
pub mod vertex_map;
