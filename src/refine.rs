//! From a candidate to the map of all vertices: spectral upsampling, then rigid parts.

pub mod full_refinement;
pub mod mesh_descent;
pub mod rigid_parts;
pub mod vertex_rows;
