//! The bijection by connectivity on the shipped examples, whose mirror tables are the truth.

use intrinsym::SymmetryKind::Reflection;
use intrinsym::internals::connectivity::automorphism::{Automorphism, Connectivity, LengthChange, Reliance};
use intrinsym::internals::mesh::half_edges::HalfEdges;
use intrinsym::{Limits, Mesh, NONE, Progress, io};
use std::path::Path;

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/examples");

struct Example {
    mesh: Mesh,
    /// True partner of each point.
    truth: Vec<u32>,
}

impl Example {
    fn read_mesh(name: &str) -> Mesh {
        let path = Path::new(FOLDER).join(format!("{name}.ply"));
        Mesh::new(&io::read(&path, &Limits::default()).unwrap().polygons, &Limits::default()).unwrap()
    }

    fn read(name: &str) -> Example {
        let mesh = Example::read_mesh(name);
        let table = std::fs::read_to_string(Path::new(FOLDER).join(format!("{name}.mirror"))).unwrap();
        let mirror: Vec<usize> = table.lines().map(|line| line.parse().unwrap()).collect();
        let truth = mesh.vertex_of_point.iter().map(|&vertex| mesh.point_of_vertex[mirror[vertex as usize]]);
        Example { truth: truth.collect(), mesh }
    }

    fn half_edges(&self) -> HalfEdges {
        HalfEdges::new(self.truth.len(), &self.mesh.polygon_offsets, &self.mesh.polygon_points).unwrap()
    }

    fn find(&self, estimate: &[u32]) -> Option<Automorphism> {
        let (connectivity, confidence) =
            (Connectivity::new(self.half_edges(), 0, |_| 0.0), vec![1.0; self.truth.len()]);
        connectivity.find(estimate, &confidence, Reliance::Shells, Reflection, &Progress::default()).unwrap()
    }

    fn wrong(&self, found: &Automorphism) -> usize {
        let pairs = found.partner.iter().zip(&self.truth);
        pairs.filter(|&(&partner, &truth)| partner != NONE && partner != truth).count()
    }
}

#[test]
fn the_body_is_mapped_exactly_without_any_estimate() {
    let human = Example::read("human");
    let found = human.find(&vec![NONE; human.truth.len()]).unwrap();
    assert!(found.complete);
    assert_eq!(human.wrong(&found), 0);
    assert!(found.unrivalled.iter().all(|&unrivalled| unrivalled));
}

#[test]
fn every_shell_maps_to_its_partner_near_the_estimate() {
    let human = Example::read("human_shells");
    let found = human.find(&human.truth).unwrap();
    assert!(found.complete, "{} of {}", found.covered, human.truth.len());
    assert_eq!(human.wrong(&found), 0);
}

#[test]
fn an_estimate_some_edges_off_gives_the_same_bijection() {
    let human = Example::read("human_shells");
    let half_edges = human.half_edges();
    let off_by = |steps: usize| {
        let walk = |(point, &partner): (usize, &u32)| {
            let vertex = half_edges.point_of_vertex.partition_point(|&other| other < partner) as u32;
            let step = |at: u32, step: usize| {
                let degree = half_edges.outgoing_of(at).count();
                half_edges.outgoing_of(at).nth((point * 31 + step * 7) % degree).unwrap()
            };
            let end = (0..steps).fold(vertex, |at, count| half_edges.to_vertex[step(at, count) as usize]);
            half_edges.point_of_vertex[end as usize]
        };
        human.truth.iter().enumerate().map(walk).collect::<Vec<_>>()
    };
    for steps in [2, 5] {
        let found = human.find(&off_by(steps)).unwrap();
        assert!(found.complete);
        assert_eq!(human.wrong(&found), 0, "{steps} steps");
    }
}

#[test]
fn a_cut_quad_leaves_the_rest_of_the_body_paired() {
    let mut human = Example::read("human");
    let corners = human.mesh.polygon_points.split_off(human.mesh.polygon_points.len() - 4);
    human
        .mesh
        .polygon_points
        .extend([corners[0], corners[1], corners[2], corners[0], corners[2], corners[3]]);
    let last = human.mesh.polygon_offsets.pop().unwrap();
    human.mesh.polygon_offsets.extend([last - 1, last + 2]);
    let found = human.find(&human.truth).unwrap();
    assert!(!found.complete);
    assert!(found.covered > human.truth.len() * 98 / 100, "{} of {}", found.covered, human.truth.len());
    assert_eq!(human.wrong(&found), 0);
}

#[test]
fn shapes_without_mirrored_connectivity_have_no_match() {
    let quadruped = Example::read("quadruped");
    assert_eq!(quadruped.find(&quadruped.truth), None, "left and right are meshed apart");
    let blob = Example::read_mesh("blob");
    let count = blob.positions.len() as u32;
    let half_edges = HalfEdges::new(count as usize, &blob.polygon_offsets, &blob.polygon_points).unwrap();
    let connectivity = Connectivity::new(half_edges, 0, |_| 0.0);
    for estimate in [vec![NONE; count as usize], (0..count).collect(), (0..count).rev().collect()] {
        assert_eq!(
            connectivity
                .find(
                    &estimate,
                    &vec![1.0; count as usize],
                    Reliance::Shells,
                    Reflection,
                    &Progress::default()
                )
                .unwrap(),
            None
        );
    }
}

#[test]
fn half_edges_are_made_only_where_colours_repeat() {
    let quiet = Progress::default();
    for name in ["quadruped", "blob"] {
        assert!(Connectivity::of(&Example::read_mesh(name)).unwrap().is_none(), "{name}");
    }
    for name in ["human", "human_shells"] {
        let mut connectivity = Connectivity::of(&Example::read_mesh(name)).unwrap().expect(name);
        assert!(connectivity.find_unrivalled(|_| true, &quiet).unwrap().is_some(), "{name}");
    }
    // A body beside creatures that are meshed apart.
    let human = Example::read_mesh("human");
    let count = human.positions.len();
    for creatures in [1, 4] {
        let mut all = human.clone();
        for _ in 0..creatures {
            add(&mut all, &Example::read_mesh("quadruped"));
        }
        assert_eq!(
            creatures == 1,
            2 * count > all.positions.len(),
            "the body has less than half beside four"
        );
        let found =
            Connectivity::of(&all).unwrap().unwrap().find_unrivalled(|_| true, &quiet).unwrap().unwrap();
        assert_eq!(found.covered, count);
        assert!(!found.complete, "nothing was sought on the creature");
    }
}

/// Adds another mesh's only shell.
fn add(mesh: &mut Mesh, other: &Mesh) {
    let (shift, last) = (mesh.positions.len() as u32, *mesh.polygon_offsets.last().unwrap());
    mesh.positions.extend(&other.positions);
    mesh.polygon_points.extend(other.polygon_points.iter().map(|point| point + shift));
    mesh.polygon_offsets.extend(other.polygon_offsets[1..].iter().map(|offset| offset + last));
    mesh.shell_of_point.extend(vec![mesh.shell_count as u32; other.positions.len()]);
    mesh.shell_count += 1;
}

#[test]
fn lengths_say_whether_the_shape_agrees() {
    let mut human = Example::read("human");
    let found = human.find(&vec![NONE; human.truth.len()]).unwrap();
    let change = |mesh: &Mesh| LengthChange::of(mesh, &found).unwrap();
    assert!(change(&human.mesh).agrees(), "{:?}", change(&human.mesh));
    let sheared = |position: &[f64; 3]| [position[0] + 0.4 * position[1], position[1], position[2]];
    let rest = human.mesh.positions.clone();
    human.mesh.positions = rest.iter().map(sheared).collect();
    assert!(!change(&human.mesh).agrees(), "sheared: {:?}", change(&human.mesh));
    // Every third vertex of one side is moved.
    let is_moved = |point: usize| point.is_multiple_of(3) && found.partner[point] < point as u32;
    let moved =
        |(point, p): (usize, &[f64; 3])| if is_moved(point) { p.map(|x| 1.01 * x + 0.01) } else { *p };
    human.mesh.positions = rest.iter().enumerate().map(moved).collect();
    assert!(!change(&human.mesh).agrees(), "rough: {:?}", change(&human.mesh));
    let nothing = Automorphism { partner: vec![NONE; rest.len()], ..found.clone() };
    assert_eq!(LengthChange::of(&human.mesh, &nothing), None);
}
