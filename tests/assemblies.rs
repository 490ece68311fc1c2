//! Characters of many shells: each goes to its twin, and what has none to none.

mod support;

use intrinsym::internals::detect::mirror_plane::MirrorPlane;
use intrinsym::{CancelToken, Detection, Options, Outcome, PolygonMesh, Progress, detect};
use support::*;

/// A part of a figure: an ellipsoid, a bump in front, its middle and half axes; the joint about which the pose turns it, and how far.
struct Part {
    middle: Vector,
    axes: Vector,
    joint: Vector,
    turn: [f64; 3],
}

/// Where a part's shell begins among the vertices.
struct Figure {
    polygons: PolygonMesh,
    /// Vertices of each part.
    of_part: Vec<std::ops::Range<usize>>,
    /// The part's twin, itself, or none.
    twins: Vec<Option<usize>>,
}

/// A figure of a trunk, a head, two arms and two legs of two parts each, and a rod in one hand; posed by `pose` radians.
fn figure(pose: f64, with_rod: bool) -> Figure {
    figure_of(&icosphere(3), 0.25, pose, with_rod)
}

/// The same, each part of a form that reaches from -1 to 1 and has a bump of that height.
fn figure_of(form: &PolygonMesh, bump: f64, pose: f64, with_rod: bool) -> Figure {
    let part = |middle, axes, joint, turn| Part { middle, axes, joint, turn };
    let still = [0.0; 3];
    let mut parts = vec![
        part([0.0, 0.0, 0.0], [0.5, 0.8, 0.3], still, still),
        part([0.0, 1.15, 0.05], [0.3, 0.4, 0.35], still, still),
    ];
    let limbs = [
        ([0.85, 0.55, 0.0], [0.42, 0.16, 0.16], [0.5, 0.55, 0.0], [0.0, 0.0, 0.8], [0.3, 0.0, -0.5]),
        ([1.55, 0.55, 0.05], [0.38, 0.13, 0.15], [0.5, 0.55, 0.0], [0.0, 0.0, 0.8], [0.3, 0.0, -0.5]),
        ([0.28, -1.15, 0.0], [0.2, 0.5, 0.2], [0.28, -0.7, 0.0], [0.9, 0.0, 0.1], [-0.4, 0.0, 0.0]),
        ([0.28, -1.95, 0.08], [0.16, 0.45, 0.2], [0.28, -0.7, 0.0], [0.9, 0.0, 0.1], [-0.4, 0.0, 0.0]),
    ];
    for (middle, axes, joint, right, left) in limbs {
        let mirrored = |[x, y, z]: Vector| [-x, y, z];
        parts.push(part(middle, axes, joint, right));
        parts.push(part(mirrored(middle), axes, mirrored(joint), left));
    }
    let mut twins: Vec<Option<usize>> = [0, 1, 3, 2, 5, 4, 7, 6, 9, 8].map(Some).to_vec();
    if with_rod {
        parts.push(part([1.75, 0.55, 0.8], [0.07, 0.07, 0.9], [0.5, 0.55, 0.0], [0.0, 0.0, 0.8]));
        twins.push(None);
    }
    let (mut positions, mut faces, mut of_part) = (Vec::new(), Vec::<Vec<u32>>::new(), Vec::new());
    for Part { middle, axes, joint, turn } in parts {
        let first = positions.len();
        for &[x, y, z] in &form.positions {
            let bump = if z > 0.0 { 1.0 + bump * z * z * z * (1.0 - 0.5 * y) } else { 1.0 };
            let mut at = [axes[0] * x + middle[0], axes[1] * y + middle[1], axes[2] * z * bump + middle[2]];
            for axis in 0..3 {
                let unit = std::array::from_fn(|k| f64::from(u8::from(k == axis)));
                let away = [0, 1, 2].map(|k| at[k] - joint[k]);
                let turned = rotated(away, unit, pose * turn[axis]);
                at = [0, 1, 2].map(|k| turned[k] + joint[k]);
            }
            positions.push(at);
        }
        faces.extend(
            form.face_vertices
                .chunks(form.face_vertices.len() / (form.face_offsets.len() - 1))
                .map(|corners| corners.iter().map(|c| c + first as u32).collect()),
        );
        of_part.push(first..positions.len());
    }
    let faces: Vec<&[u32]> = faces.iter().map(Vec::as_slice).collect();
    Figure { polygons: polygon_mesh(&positions, &faces), of_part, twins }
}

fn found(polygons: &PolygonMesh) -> Detection {
    let (mesh, options) = (validated(polygons), Options::default());
    let found = detect(&mesh, &options, &Progress::default()).unwrap();
    println!("{}", found.report.evidence());
    assert_keeps_its_contract(&mesh, &options, &found);
    found
}

/// The part that most of each part's vertices go to.
fn images(figure: &Figure, found: &Detection) -> Vec<Option<usize>> {
    let partner = &found.symmetries[0].partner;
    let part_of = |vertex: i32| figure.of_part.iter().position(|part| part.contains(&(vertex as usize)));
    let image = |part: &std::ops::Range<usize>| {
        let mut counts = vec![0; figure.of_part.len() + 1];
        for vertex in part.clone() {
            counts[part_of(partner[vertex]).map_or(figure.of_part.len(), |part| part)] += 1;
        }
        let most = (0..counts.len()).max_by_key(|&part| counts[part]).unwrap();
        (most < figure.of_part.len()).then_some(most)
    };
    figure.of_part.iter().map(image).collect()
}

#[test]
fn each_part_of_a_posed_figure_goes_to_its_twin() {
    let figure = figure(1.0, false);
    let found = found(&figure.polygons);
    assert_eq!(found.outcome, Outcome::Found);
    assert_eq!(images(&figure, &found), figure.twins);
    assert!(found.report.evidence().contains("plausibility"), "it was searched");
}

/// Blocks say nothing of whether a map reflects: their twins do.
#[test]
fn each_block_of_a_posed_figure_goes_to_its_twin() {
    let figure = figure_of(&cube_of_squares(1), 0.0, 0.8, false);
    assert_eq!(images(&figure, &found(&figure.polygons)), figure.twins);
}

/// As a negative scale leaves it.
#[test]
fn parts_of_one_side_whose_faces_look_inwards_go_to_their_twins() {
    for mut figure in [figure(1.0, false), figure_of(&cube_of_squares(1), 0.0, 0.8, false)] {
        let left: Vec<_> = figure.of_part.iter().skip(3).step_by(2).cloned().collect();
        let size = figure.polygons.face_offsets[1] as usize;
        for face in figure.polygons.face_vertices.chunks_mut(size) {
            if left.iter().any(|part| part.contains(&(face[0] as usize))) {
                face.reverse();
            }
        }
        assert_eq!(images(&figure, &found(&figure.polygons)), figure.twins);
    }
}

#[test]
fn parts_that_are_there_twice_in_one_place_go_to_their_twins_copy_to_copy() {
    for reversed in [false, true] {
        let mut figure = figure_of(&cube_of_squares(1), 0.0, 0.8, false);
        let Figure { polygons, of_part, twins } = &mut figure;
        let (points, parts, faces) = (polygons.positions.len(), twins.len(), polygons.face_vertices.clone());
        polygons.positions.extend_from_within(..);
        for face in faces.chunks(polygons.face_offsets[1] as usize) {
            let mut copy: Vec<u32> = face.iter().map(|corner| corner + points as u32).collect();
            if reversed {
                copy.reverse();
            }
            polygons.face_vertices.extend(copy);
            polygons.face_offsets.push(polygons.face_vertices.len() as u32);
        }
        of_part.extend(of_part.clone().into_iter().map(|part| part.start + points..part.end + points));
        twins.extend(twins.clone().into_iter().map(|twin| twin.map(|twin| twin + parts)));
        let found = found(&figure.polygons);
        assert_eq!(images(&figure, &found), figure.twins);
        let partner = &found.symmetries[0].partner;
        for (vertex, &own) in partner[..points].iter().enumerate() {
            assert_eq!(partner[vertex + points], own + points as i32, "of the copy of {vertex}");
        }
    }
}

/// As clothes that were made from it are.
#[test]
fn a_layer_on_a_part_is_not_its_twin() {
    for pose in [0.0, 1.0] {
        let mut figure = figure(pose, false);
        let Figure { polygons, of_part, twins } = &mut figure;
        let (parts, faces) = (twins.len(), polygons.face_vertices.clone());
        for part in (3..parts).step_by(2) {
            let own = of_part[part].clone();
            let first = polygons.positions.len();
            polygons.positions.extend_from_within(own.clone());
            polygons.positions[first..].iter_mut().for_each(|at| *at = at.map(|x| x + 0.01));
            for face in faces.chunks(3).filter(|face| own.contains(&(face[0] as usize))) {
                polygons.face_vertices.extend(face.iter().map(|&v| v - own.start as u32 + first as u32));
                polygons.face_offsets.push(polygons.face_vertices.len() as u32);
            }
            of_part.push(first..polygons.positions.len());
        }
        // A part's twin may be either of part and layer; the other has none.
        let images = images(&figure, &found(&figure.polygons));
        let part_of = |shell: usize| if shell < parts { shell } else { 3 + 2 * (shell - parts) };
        for (shell, image) in images.iter().enumerate() {
            let wanted = figure.twins[part_of(shell)];
            assert!(image.is_none() || image.map(part_of) == wanted, "{shell} in pose {pose}: {images:?}");
        }
        assert_eq!(images.iter().flatten().count(), parts, "in pose {pose}: {images:?}");
    }
}

/// Shells one above the other, each of a form, with the height of its middle, half axes and turn about the upright axis.
fn column(parts: &[(&PolygonMesh, f64, Vector, f64)]) -> Figure {
    let (mut positions, mut faces, mut of_part) = (Vec::new(), Vec::<Vec<u32>>::new(), Vec::new());
    for &(form, height, axes, turn) in parts {
        let first = positions.len();
        for &[x, y, z] in &form.positions {
            let [x, y, z] = rotated([axes[0] * x, axes[1] * y, axes[2] * z], [0.0, 1.0, 0.0], turn);
            positions.push([x, y + height, z]);
        }
        let corners = form.face_vertices.chunks(3);
        faces.extend(corners.map(|corners| corners.iter().map(|c| c + first as u32).collect()));
        of_part.push(first..positions.len());
    }
    let faces: Vec<&[u32]> = faces.iter().map(Vec::as_slice).collect();
    Figure {
        polygons: polygon_mesh(&positions, &faces),
        of_part,
        twins: (0..parts.len()).map(Some).collect(),
    }
}

/// A sphere with bumps of some heights in some directions.
fn lump(bumps: &[(Vector, f64)]) -> PolygonMesh {
    let mut form = icosphere(3);
    for at in &mut form.positions {
        let height = |(to, height): &(Vector, f64)| height * (-4.0 * distance(*at, *to).powi(2)).exp();
        let bumped = 1.0 + bumps.iter().map(height).sum::<f64>();
        *at = at.map(|x| bumped * x);
    }
    form
}

/// As a head with a trunk and hips that are posed apart, all of them their own images: none has half of the surface, and what one says of the others does not fit.
#[test]
fn shells_that_are_all_their_own_speak_together() {
    let form = &lump(&[([0.0, -0.3, 1.0], 0.4)]);
    let figure = column(&[
        (form, 0.0, [0.62, 0.5, 0.45], 0.0),
        (form, -0.9, [0.8, 0.45, 0.3], 0.75),
        (form, -1.65, [0.75, 0.35, 0.3], 2.3),
    ]);
    let found = found(&figure.polygons);
    assert_eq!(found.outcome, Outcome::Found);
    assert_eq!(images(&figure, &found), figure.twins);
}

#[test]
fn what_a_figure_holds_in_one_hand_has_no_partner() {
    let figure = figure(1.0, true);
    let found = found(&figure.polygons);
    assert_ne!(found.outcome, Outcome::None);
    assert_eq!(images(&figure, &found), figure.twins);
}

#[test]
fn a_figure_at_rest_is_answered_by_its_plane() {
    let figure = figure(0.0, false);
    let found = found(&figure.polygons);
    assert_eq!(images(&figure, &found), figure.twins);
    assert!(found.report.evidence().contains("plane in space"));
    assert!(found.symmetries[0].mean_confidence > 0.95);
}

/// The diagonals of a cube's sides admit one reflection, by a plane through two of its edges. That is not the plane of the four.
#[test]
fn cubes_cut_askew_follow_their_plane() {
    let corners = [
        [-1.0, -1.0, 1.0],
        [1.0, 1.0, 1.0],
        [1.0, -1.0, 1.0],
        [-1.0, 1.0, 1.0],
        [1.0, -1.0, -1.0],
        [-1.0, -1.0, -1.0],
        [-1.0, 1.0, -1.0],
        [1.0, 1.0, -1.0],
    ];
    let cut = ["210", "301", "204", "360", "540", "506", "241", "316", "714", "761", "564", "746"];
    let blocks: [(Vector, Vector); 4] = [
        ([0.0, 0.0, 0.0], [0.4, 0.4, 0.4]),
        ([0.0, 0.7, 0.1], [0.2, 0.2, 0.2]),
        ([0.9, 0.0, 0.1], [0.4, 0.1, 0.15]),
        ([-0.9, 0.0, 0.1], [0.4, 0.1, 0.15]),
    ];
    let place = |(middle, half): (Vector, Vector)| {
        corners.map(|corner: Vector| [0, 1, 2].map(|axis| middle[axis] + half[axis] * corner[axis]))
    };
    let positions: Vec<Vector> = blocks.into_iter().flat_map(place).collect();
    let of_block = |block: u32| {
        cut.map(|face| face.bytes().map(|digit| 8 * block + u32::from(digit - b'0')).collect::<Vec<u32>>())
    };
    let faces: Vec<Vec<u32>> = (0..4).flat_map(of_block).collect();
    let faces: Vec<&[u32]> = faces.iter().map(Vec::as_slice).collect();
    let found = found(&polygon_mesh(&positions, &faces));
    for (&[x, y, z], &partner) in positions.iter().zip(&found.symmetries[0].partner) {
        assert!(distance(positions[partner as usize], [-x, y, z]) < 1e-9, "{x} {y} {z}");
    }
}

#[test]
fn the_plane_of_a_turned_creature_is_its_own() {
    let turned = |position: Vector| rotated(position, [1.0, 2.0, 3.0], 0.7);
    let mut mesh = creature(4, 0.4);
    mesh.positions.iter_mut().for_each(|position| *position = turned(*position));
    let (plane, _) = MirrorPlane::of(&validated(&mesh), 2).expect("a plane");
    let normal = turned([1.0, 0.0, 0.0]);
    let along: f64 = (0..3).map(|axis| normal[axis] * plane.normal[axis]).sum();
    assert!(along.abs() > 0.9999, "{plane:?}");
}

/// What lies on one side, near the surface, as a bracer does.
#[test]
fn what_is_worn_on_one_side_does_not_turn_the_plane() {
    let mut mesh = creature(8, 0.4);
    let (_, is_exact) = MirrorPlane::of(&validated(&mesh), 2).expect("a plane");
    assert!(is_exact);
    let is_under = |[x, y, _]: &Vector| *x > 0.2 && (0.0..0.4).contains(y);
    mesh.positions.iter_mut().filter(|at| is_under(at)).for_each(|at| *at = at.map(|x| 1.04 * x));
    let (plane, _) = MirrorPlane::of(&validated(&mesh), 2).expect("a plane");
    assert!(plane.normal[1].hypot(plane.normal[2]) < 1e-3, "{plane:?}");
}

/// Two ears, and a hat as large as both, so far away that no direction in the plane of the three has larger moments than another.
#[test]
fn what_a_round_body_wears_tells_its_plane() {
    let balls = [([0.0, 0.0, 0.0], 1.0), ([1.2, 0.0, 0.0], 0.3), ([-1.2, 0.0, 0.0], 0.3)];
    let hat = ([0.0, 1.288, 0.0], 0.3 * 2f64.sqrt());
    let form = icosphere(3);
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    for (middle, radius) in balls.into_iter().chain([hat]) {
        let first = positions.len() as u32;
        let place = |at: &Vector| [0, 1, 2].map(|axis| middle[axis] + radius * at[axis]);
        positions.extend(form.positions.iter().map(|at| rotated(place(at), [1.0, 2.0, 3.0], 0.7)));
        faces.extend(
            form.face_vertices
                .chunks(3)
                .map(|corners| corners.iter().map(|c| c + first).collect::<Vec<u32>>()),
        );
    }
    let faces: Vec<&[u32]> = faces.iter().map(Vec::as_slice).collect();
    let (plane, _) = MirrorPlane::of(&validated(&polygon_mesh(&positions, &faces)), 2).expect("a plane");
    let normals = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]].map(|normal| rotated(normal, [1.0, 2.0, 3.0], 0.7));
    let along = |normal: Vector| (0..3).map(|axis| normal[axis] * plane.normal[axis]).sum::<f64>().abs();
    assert!(normals.into_iter().any(|normal| along(normal) > 0.999), "{plane:?}");
}

#[test]
fn a_sphere_has_no_plane_of_its_own() {
    assert!(MirrorPlane::of(&validated(&icosphere(3)), 2).is_none());
}

/// A body that left and right mirror exactly, and front and back but for a nose.
#[test]
fn the_plane_that_mirrors_more_is_taken() {
    for (width, nose, height) in [(1.1, 0.2, 0.5), (1.2, 0.2, 0.2), (1.2, 0.3, 0.5), (1.3, 0.2, 0.5)] {
        let mut mesh = icosphere(4);
        for position in &mut mesh.positions {
            let [x, y, z] = *position;
            let bump = (-(x * x + (z - height).powi(2)) / 0.05).exp();
            let nose = if y > 0.0 { nose * bump } else { 0.0 };
            *position = [width * x, 0.75 * y + nose, 1.7 * z * (1.0 + 0.2 * z)];
        }
        let partner = &found(&mesh).symmetries[0].partner;
        let is_right = |&vertex: &usize| {
            let ([x, y, z], image) = (mesh.positions[vertex], mesh.positions[partner[vertex] as usize]);
            distance(image, [-x, y, z]) < 0.1
        };
        let right = (0..partner.len()).filter(is_right).count();
        assert!(10 * right > 9 * partner.len(), "{width} {nose} {height}: {right} of {}", partner.len());
    }
}

/// A posed body of mirrored connectivity under two coats, cut at random, over most of it, and a round hat.
fn dressed() -> PolygonMesh {
    let body = example("human");
    let (mut positions, mut faces) = (body.positions.clone(), faces_of(&body));
    let mut heights: Vec<f64> = body.positions.iter().map(|at| at[2]).collect();
    heights.sort_by(f64::total_cmp);
    let top = heights[heights.len() * 7 / 10];
    let cut = with_random_diagonals(&body);
    for scale in [1.02, 1.04] {
        let first = positions.len() as u32;
        positions.extend(body.positions.iter().map(|at| at.map(|x| scale * x)));
        let is_covered =
            |face: &Vec<u32>| face.iter().all(|&corner| body.positions[corner as usize][2] < top);
        let coat = faces_of(&cut).into_iter().filter(is_covered);
        faces.extend(coat.map(|face| face.iter().map(|corner| corner + first).collect()));
    }
    let (hat, first) = (geodesic_sphere(6), positions.len() as u32);
    let head = body.positions.iter().copied().max_by(|a, b| a[2].total_cmp(&b[2])).expect("vertices");
    positions.extend(hat.positions.iter().map(|at| [0, 1, 2].map(|axis| head[axis] + 0.12 * at[axis])));
    faces.extend(hat.face_vertices.chunks(3).map(|face| face.iter().map(|corner| corner + first).collect()));
    polygon_mesh(&positions, &faces)
}

fn faces_of(mesh: &PolygonMesh) -> Vec<Vec<u32>> {
    let ends = mesh.face_offsets.windows(2);
    ends.map(|ends| mesh.face_vertices[ends[0] as usize..ends[1] as usize].to_vec()).collect()
}

#[test]
fn a_body_of_mirrored_connectivity_is_followed_by_what_it_wears() {
    let dressed = dressed();
    let truth = example_truth("human");
    let found = found(&dressed);
    assert!(found.report.evidence().contains("connectivity"), "nothing was searched");
    let partner = &found.symmetries[0].partner;
    assert!(truth.iter().zip(partner).all(|(&truth, &partner)| truth as i32 == partner));
}

/// Mitts that are posed apart from the body are the only two of their connectivity; the beads on them, four alike, follow the mitts.
#[test]
fn what_hangs_on_a_part_that_is_posed_apart_follows_that() {
    let body = example("human");
    let (mut positions, mut faces) = (body.positions.clone(), faces_of(&body));
    let height =
        [f64::max, f64::min].map(|of| body.positions.iter().map(|at| at[2]).reduce(of).expect("vertices"));
    let height = height[0] - height[1];
    let forms = [with_flipped_edges(&icosphere(2), 7), with_flipped_edges(&icosphere(1), 5)];
    let mut truth = example_truth("human");
    let mut added = Vec::new();
    for side in [1.0, -1.0] {
        for (form, at, size) in
            [(0, [0.6, 0.0, 0.0], 0.07), (1, [0.6, 0.08, 0.0], 0.02), (1, [0.69, 0.0, 0.02], 0.02)]
        {
            let first = positions.len();
            added.push(first..first + forms[form].positions.len());
            for point in &forms[form].positions {
                let stretch = [1.0, 0.8, 0.6];
                let place: Vector = std::array::from_fn(|k| height * (at[k] + size * stretch[k] * point[k]));
                let place = [side * place[0], place[1], place[2]];
                // One side is turned about the body, and lifted.
                let posed = if side > 0.0 { place } else { rotated(place, [0.0, 0.6, 0.8], 0.9) };
                positions.push(posed);
            }
            faces.extend(faces_of(&forms[form]).into_iter().map(|mut face| {
                face.iter_mut().for_each(|corner| *corner += first as u32);
                if side < 0.0 {
                    face.reverse();
                }
                face
            }));
        }
    }
    for (own, twin) in [(0, 3), (1, 4), (2, 5), (3, 0), (4, 1), (5, 2)] {
        truth.extend(added[own].clone().zip(added[twin].clone()).map(|(_, twin)| twin as u32));
    }
    let found = found(&polygon_mesh(&positions, &faces));
    let partner = &found.symmetries[0].partner;
    for (part, points) in added.iter().enumerate() {
        let right = points.clone().filter(|&point| partner[point] == truth[point] as i32).count();
        assert_eq!(right, points.len(), "part {part}");
    }
}

/// The letters F and J cut out of a board, whose triangles in front are not those behind.
#[test]
fn what_is_thin_exchanges_its_sides_if_nothing_else_mirrors_it() {
    const FINE: usize = 3;
    let letters = ["###...#", "#......#", "##.....#", "#....#.#", "#....###"];
    let is_wood = |x: usize, y: usize| {
        letters.get(y / FINE).is_some_and(|row| row.as_bytes().get(x / FINE) == Some(&b'#'))
    };
    let (columns, rows) = (8 * FINE, 5 * FINE);
    let mut numbers = std::collections::HashMap::new();
    let (mut positions, mut faces): (Vec<Vector>, Vec<Vec<u32>>) = (Vec::new(), Vec::new());
    let mut corner = |[x, y, z]: [usize; 3]| {
        *numbers.entry([x, y, z]).or_insert_with(|| {
            positions.push([x as f64, y as f64, 0.4 * z as f64 - 0.2]);
            positions.len() as u32 - 1
        })
    };
    for (x, y) in (0..columns).flat_map(|x| (0..rows).map(move |y| (x, y))).filter(|&(x, y)| is_wood(x, y)) {
        let around = [[x, y], [x + 1, y], [x + 1, y + 1], [x, y + 1]];
        let [behind, front] = [0, 1].map(|z| around.map(|[x, y]| corner([x, y, z])));
        faces.push(front.to_vec());
        faces.push(behind.into_iter().rev().collect());
        let beside = [(x, y.wrapping_sub(1)), (x + 1, y), (x, y + 1), (x.wrapping_sub(1), y)];
        for side in (0..4).filter(|&side| !is_wood(beside[side].0, beside[side].1)) {
            let next = (side + 1) % 4;
            faces.push(vec![behind[side], behind[next], front[next], front[side]]);
        }
    }
    let polygons = with_random_diagonals(&polygon_mesh(&positions, &faces));
    let found = found(&polygons);
    assert_eq!(found.outcome, Outcome::Found);
    assert!(found.report.evidence().contains("a plane in space"), "{}", found.report.evidence());
    for (&[x, y, z], &partner) in positions.iter().zip(&found.symmetries[0].partner) {
        assert!(distance(positions[partner as usize], [x, y, -z]) < 1e-9, "{x} {y} {z}");
    }
    // It is doubtful where time ends the search for another one.
    let wait = |stage: &str, _: f64| {
        if stage == "candidates" {
            std::thread::sleep(std::time::Duration::from_millis(1100));
        }
    };
    let options = Options { time_limit: 1, ..Options::default() };
    let progress = Progress::new(Some(&wait), CancelToken::default());
    let late = detect(&validated(&polygons), &options, &progress).expect("the plane's answer");
    assert_eq!((late.outcome, late.symmetries.len()), (Outcome::Doubtful, 1));
    assert_eq!(late.symmetries[0].partner, found.symmetries[0].partner);
    // A flat sheet lies on its own mirror image, which is no symmetry of it.
    let flat: Vec<Vector> = positions.iter().map(|&[x, y, _]| [x, y, 0.0]).collect();
    let front: Vec<Vec<u32>> =
        faces.into_iter().filter(|face| face.iter().all(|&at| positions[at as usize][2] > 0.0)).collect();
    let sheet = with_random_diagonals(&polygon_mesh(&flat, &front));
    let found = detect(&validated(&sheet), &Options::default(), &Progress::default()).expect("an answer");
    assert!(found.outcome != Outcome::Found, "{}", found.report.evidence());
}

/// A body and four wheels, of which one is one surface with the body.
#[test]
fn at_rest_a_wheel_has_its_twin_though_it_is_one_surface_with_the_car() {
    let form = icosphere(2);
    let count = form.positions.len() as u32;
    let body = |&[x, y, z]: &Vector| [x, 0.5 * y, if z > 0.0 { 2.0 * z } else { 1.7 * z }];
    let mut positions: Vec<Vector> = form.positions.iter().map(body).collect();
    let wheels = [[1.2, -0.3, 1.0], [-1.2, -0.3, 1.0], [1.2, -0.3, -1.0], [-1.2, -0.3, -1.0]];
    for [x, y, z] in wheels {
        positions.extend(form.positions.iter().map(|at| [x + 0.1 * at[0], y + 0.4 * at[1], z + 0.4 * at[2]]));
    }
    let shifted = |shell: u32| {
        form.face_vertices.chunks(3).map(move |face| face.iter().map(|v| v + shell * count).collect())
    };
    let mut faces: Vec<Vec<u32>> = (0..5).flat_map(shifted).collect();
    // A thread from an edge of the body to one of the first wheel.
    let ([a, b], [c, d]) = ([faces[0][0], faces[0][1]], [faces[0][0] + count, faces[0][1] + count]);
    faces.extend([vec![a, b, c], vec![b, c, d]]);
    let mesh = polygon_mesh(&positions, &faces);
    assert_eq!(validated(&mesh).shell_count, 4);
    let found = found(&mesh);
    for (&[x, y, z], &partner) in positions.iter().zip(&found.symmetries[0].partner) {
        let image = positions.get(partner as usize);
        assert!(image.is_some_and(|&image| distance(image, [-x, y, z]) < 1e-6), "{x} {y} {z}: {image:?}");
    }
}
