//! The bijection by connectivity, on voxel figures whose mirror map is known from their coordinates.
//!
//! A figure is the surface of a set of voxels, each face cut into a grid of quads: irregular vertices at
//! its edges and corners, regular grids between. Reflecting x gives the truth.

use intrinsym::SymmetryKind::{HalfTurn, Reflection};
use intrinsym::internals::connectivity::automorphism::{Automorphism, Connectivity, Reliance};
use intrinsym::internals::mesh::half_edges::HalfEdges;
use intrinsym::{NONE, Progress, SymmetryKind};
use proptest::prelude::*;
use std::collections::{HashMap, HashSet};

type Cell = [i32; 3];

/// Faces over points at integer places; the truth is the reflection of x about 0.
#[derive(Clone, Default)]
struct Figure {
    places: Vec<Cell>,
    faces: Vec<Vec<u32>>,
}

impl Figure {
    /// The surface of `cells` (unit voxels, mirrored ones not added), each voxel face as `cuts` x `cuts` quads.
    fn of_voxels(cells: &[Cell], cuts: i32) -> Figure {
        let solid: HashSet<Cell> = cells.iter().copied().collect();
        let mut sorted: Vec<Cell> = solid.iter().copied().collect();
        sorted.sort_unstable();
        let (mut figure, mut point_at) = (Figure::default(), HashMap::new());
        for cell in sorted {
            for (axis, sign) in (0..3).flat_map(|axis| [(axis, -1), (axis, 1)]) {
                let mut beyond = cell;
                beyond[axis] += sign;
                if !solid.contains(&beyond) {
                    figure.add_side(cell, axis, sign, cuts, &mut point_at);
                }
            }
        }
        figure
    }

    fn add_side(&mut self, cell: Cell, axis: usize, sign: i32, cuts: i32, point_at: &mut HashMap<Cell, u32>) {
        let (second, third) = ((axis + 1) % 3, (axis + 2) % 3);
        for (row, column) in (0..cuts).flat_map(|row| (0..cuts).map(move |column| (row, column))) {
            let mut corners = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(right, up)| {
                // Doubled, so that voxel -1 and voxel 0 mirror each other about x = 0.
                let mut place = cell.map(|coordinate| 2 * coordinate * cuts);
                place[axis] += if sign > 0 { 2 * cuts } else { 0 };
                place[second] += 2 * (row + right);
                place[third] += 2 * (column + up);
                let places = &mut self.places;
                *point_at.entry(place).or_insert_with(|| {
                    places.push(place);
                    places.len() as u32 - 1
                })
            });
            if sign < 0 {
                corners.reverse();
            }
            self.faces.push(corners.to_vec());
        }
    }

    /// Cuts every quad into two triangles, along diagonals that mirror each other.
    fn triangulated(&self) -> Figure {
        self.cut_from(|[x, y, z]| [y, z, x.abs(), x])
    }

    /// Cuts every quad along a diagonal through its lowest corner by `key`.
    fn cut_from(&self, key: impl Fn(Cell) -> [i32; 4]) -> Figure {
        let mut faces = Vec::new();
        for quad in &self.faces {
            let start = (0..4).min_by_key(|&corner| key(self.places[quad[corner] as usize]));
            let [a, b, c, d] = [0, 1, 2, 3].map(|step| quad[(start.unwrap() + step) % 4]);
            faces.extend([vec![a, b, c], vec![a, c, d]]);
        }
        Figure { places: self.places.clone(), faces }
    }

    fn truth(&self) -> Vec<u32> {
        let point_at: HashMap<Cell, u32> =
            self.places.iter().enumerate().map(|(point, &place)| (place, point as u32)).collect();
        self.places.iter().map(|&[x, y, z]| point_at.get(&[-x, y, z]).copied().unwrap_or(NONE)).collect()
    }

    fn half_edges(&self) -> HalfEdges {
        let mut offsets = vec![0];
        for face in &self.faces {
            offsets.push(offsets[offsets.len() - 1] + face.len() as u32);
        }
        HalfEdges::new(self.places.len(), &offsets, &self.faces.concat()).unwrap()
    }

    /// The pairing, which must be the same whether a search without an estimate came before or not.
    fn find(&self, estimate: &[u32], kind: SymmetryKind) -> Option<Automorphism> {
        let (confidence, quiet) = (vec![0.5; self.places.len()], Progress::default());
        let mut searched = Connectivity::new(self.half_edges(), 0, |_| 0.0);
        let found = searched.find(estimate, &confidence, Reliance::Shells, kind, &quiet).unwrap();
        searched.find_unrivalled(|_| true, &quiet).unwrap();
        assert_eq!(searched.find(estimate, &confidence, Reliance::Shells, kind, &quiet).unwrap(), found);
        if let Some(automorphism) = &found {
            self.assert_involution(automorphism);
        }
        found
    }

    fn assert_involution(&self, found: &Automorphism) {
        let partner = &found.partner;
        for (point, &image) in partner.iter().enumerate() {
            assert!(image == NONE || partner[image as usize] == point as u32, "{point} -> {image}");
            assert!(image != NONE || !found.exact[point]);
        }
        assert_eq!(found.covered, partner.iter().filter(|&&image| image != NONE).count());
        assert!(!found.complete || self.faces_map_to_faces(partner));
    }

    fn faces_map_to_faces(&self, partner: &[u32]) -> bool {
        let sorted = |face: &[u32]| {
            let mut face = face.to_vec();
            face.sort_unstable();
            face
        };
        let known: HashSet<Vec<u32>> = self.faces.iter().map(|face| sorted(face)).collect();
        self.faces.iter().all(|face| {
            let image: Vec<u32> = face.iter().map(|&point| partner[point as usize]).collect();
            known.contains(&sorted(&image))
        })
    }

    /// Splits the edge between the first two corners of `face`, giving its triangles a new point.
    fn split_edge(&mut self, face: usize) {
        let (from, to) = (self.faces[face][0], self.faces[face][1]);
        let middle = self.places.len() as u32;
        let (start, end) = (self.places[from as usize], self.places[to as usize]);
        self.places.push([0, 1, 2].map(|axis| (start[axis] + end[axis]) / 2));
        let has_edge = |face: &[u32]| face.contains(&from) && face.contains(&to);
        let touched: Vec<usize> = (0..self.faces.len()).filter(|&face| has_edge(&self.faces[face])).collect();
        for face in touched {
            let with = |old: u32| {
                let replace = |&point: &u32| if point == old { middle } else { point };
                self.faces[face].iter().map(replace).collect::<Vec<u32>>()
            };
            let halves = [with(from), with(to)];
            self.faces.extend(halves[..1].to_vec());
            self.faces[face] = halves[1].clone();
        }
    }

    /// Flips the edge between a triangle's first two corners if both ends keep at least three edges.
    fn flip_edge(&mut self, face: usize) {
        let [a, b, c] = self.faces[face][..] else { panic!("a triangle") };
        let other = (0..self.faces.len())
            .find(|&other| other != face && self.faces[other].contains(&a) && self.faces[other].contains(&b));
        let Some(other) = other else { return };
        let d = *self.faces[other].iter().find(|&&point| point != a && point != b).unwrap();
        let taken = self.faces.iter().any(|face| face.contains(&c) && face.contains(&d));
        if !taken {
            self.faces[face] = vec![c, a, d];
            self.faces[other] = vec![d, b, c];
        }
    }

    fn renumbered(&self, shuffle: &mut Shuffle) -> (Figure, Vec<u32>) {
        let mut new_of: Vec<u32> = (0..self.places.len() as u32).collect();
        shuffle.shuffle(&mut new_of);
        let mut places = self.places.clone();
        for (old, &new) in new_of.iter().enumerate() {
            places[new as usize] = self.places[old];
        }
        let mut faces = self.faces.clone();
        shuffle.shuffle(&mut faces);
        for face in &mut faces {
            let turn = shuffle.below(face.len());
            face.rotate_left(turn);
            face.iter_mut().for_each(|point| *point = new_of[*point as usize]);
        }
        (Figure { places, faces }, new_of)
    }
}

/// A linear congruential generator: the tests must not depend on another crate's stream.
struct Shuffle(u64);

impl Shuffle {
    fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) % bound as u64) as usize
    }

    fn shuffle<T>(&mut self, items: &mut [T]) {
        for position in (1..items.len()).rev() {
            items.swap(position, self.below(position + 1));
        }
    }
}

fn mirrored(half: &[Cell]) -> Vec<Cell> {
    half.iter().flat_map(|&[x, y, z]| [[x, y, z], [-1 - x, y, z]]).collect()
}

/// A body with head, nose, two arms with thumbs, and two legs with feet.
fn person() -> Vec<Cell> {
    let body = (0..4).map(|y| [0, y, 0]);
    let head = [[0, 4, 0], [0, 5, 0], [0, 5, 1]];
    let arm = [[1, 3, 0], [2, 3, 0], [3, 3, 0], [3, 3, 1], [4, 3, 0]];
    let leg = [[1, 0, 0], [1, -1, 0], [1, -2, 0], [1, -3, 0], [1, -3, 1]];
    mirrored(&body.chain(head).chain(arm).chain(leg).collect::<Vec<_>>())
}

/// Moves each estimate by up to `steps` random edges.
fn blurred(figure: &Figure, truth: &[u32], steps: usize, shuffle: &mut Shuffle) -> Vec<u32> {
    let mut neighbours = vec![Vec::new(); figure.places.len()];
    for face in &figure.faces {
        for corner in 0..face.len() {
            neighbours[face[corner] as usize].push(face[(corner + 1) % face.len()]);
        }
    }
    let walk = |&start: &u32| {
        (0..steps).fold(start, |at, _| {
            if at == NONE {
                at
            } else {
                neighbours[at as usize][shuffle.below(neighbours[at as usize].len())]
            }
        })
    };
    truth.iter().map(walk).collect()
}

fn nothing(figure: &Figure) -> Vec<u32> {
    vec![NONE; figure.places.len()]
}

#[test]
fn a_figure_is_mapped_exactly_without_any_estimate() {
    for figure in [Figure::of_voxels(&person(), 1), Figure::of_voxels(&person(), 3)] {
        for figure in [figure.triangulated(), figure] {
            let found = figure.find(&nothing(&figure), Reflection).unwrap();
            assert!(found.complete);
            assert_eq!(found.partner, figure.truth());
        }
    }
}

#[test]
fn an_estimate_wrong_in_places_is_overruled_and_another_symmetry_is_not() {
    let figure = Figure::of_voxels(&person(), 2);
    let truth = figure.truth();
    let legs_stay = |point: usize| if figure.places[point][1] < 4 { point as u32 } else { truth[point] };
    let estimate: Vec<u32> = (0..truth.len()).map(legs_stay).collect();
    assert_eq!(figure.find(&estimate, Reflection).unwrap().partner, truth);
    let identity: Vec<u32> = (0..truth.len() as u32).collect();
    assert_eq!(figure.find(&identity, Reflection), None);
}

#[test]
fn a_cube_has_many_bijections_and_the_estimate_picks() {
    let cube = Figure::of_voxels(&mirrored(&[[0, 0, 0], [0, 1, 0], [0, 0, 1], [0, 1, 1]]), 3);
    let mut shuffle = Shuffle(1);
    let estimate = blurred(&cube, &cube.truth(), 2, &mut shuffle);
    assert_eq!(cube.find(&estimate, Reflection).unwrap().partner, cube.truth());
    assert!(cube.find(&nothing(&cube), Reflection).is_none(), "nothing says which of ten");
    let turned = |place: Cell| [-place[0], place[1], 12 - place[2]];
    let half_turn: Vec<u32> = cube
        .places
        .iter()
        .map(|&place| {
            cube.places.iter().position(|&other| other == turned(place)).map_or(NONE, |at| at as u32)
        })
        .collect();
    assert!(!half_turn.contains(&NONE), "the cube is centred at z = 6");
    assert_eq!(cube.find(&half_turn, HalfTurn).unwrap().partner, half_turn);
}

#[test]
fn a_boundary_maps_to_a_boundary() {
    let mut figure = Figure::of_voxels(&person(), 2);
    figure.faces.retain(|face| face.iter().any(|&point| figure.places[point as usize][1] > -10));
    let found = figure.find(&nothing(&figure), Reflection).unwrap();
    assert!(found.complete && found.partner.contains(&NONE), "the soles' points have no face");
    let half_edges = figure.half_edges();
    assert!(half_edges.face.contains(&NONE));
}

#[test]
fn two_shells_swap() {
    let ear = [[5, 0, 0], [6, 0, 0], [6, 1, 0], [6, 1, 1], [8, 1, 1], [8, 2, 1], [8, 2, 2]];
    let figure = Figure::of_voxels(&mirrored(&ear), 2);
    let truth = figure.truth();
    assert_eq!(figure.find(&truth, Reflection).unwrap().partner, truth);
    let all: Vec<Cell> = person().into_iter().chain(mirrored(&ear)).collect();
    let figure = Figure::of_voxels(&all, 2);
    let truth = figure.truth();
    let found = figure.find(&blurred(&figure, &truth, 2, &mut Shuffle(2)), Reflection).unwrap();
    assert!(found.complete);
    assert_eq!(found.partner, truth);
}

#[test]
fn a_defect_of_one_of_two_shells_leaves_the_rest_of_them_paired() {
    let ear: Vec<Cell> = (0..5).map(|y| [6, y, 0]).chain([[7, 1, 0], [6, 3, 1]]).collect();
    let all: Vec<Cell> = person().into_iter().chain(mirrored(&ear)).collect();
    // Cut in no order.
    let mix = |[x, y, z]: Cell| (7 * x.abs() + 13 * y + 29 * z).rem_euclid(17);
    let mut figure = Figure::of_voxels(&all, 3).cut_from(|at| [mix(at), at[1], at[2], at[0].abs()]);
    let mut truth = figure.truth();
    let is_of_ear = |figure: &Figure, point: usize| figure.places[point][0].abs() > 30;
    let ears: Vec<usize> = (0..truth.len()).filter(|&point| is_of_ear(&figure, point)).collect();
    // No other shell is like them, and what lies on them says nothing of it.
    let whole = figure.find(&truth, Reflection).unwrap();
    assert!(ears.iter().all(|&point| whole.exact[point] && whole.unrivalled[point]));
    let face =
        figure.faces.iter().position(|face| face.iter().all(|&point| is_of_ear(&figure, point as usize)));
    figure.split_edge(face.expect("a face of an ear"));
    truth.push(NONE);
    let found = figure.find(&truth, Reflection).unwrap();
    let paired = ears.iter().filter(|&&point| found.partner[point] != NONE);
    assert!(paired.clone().count() > ears.len() * 9 / 10);
    assert!(paired.clone().all(|&point| found.partner[point] == truth[point]
        && found.unrivalled[point]
        && !found.exact[point]));
    // Without an estimate nothing says that they are twins.
    let found = figure.find(&nothing(&figure), Reflection).unwrap();
    assert!(ears.iter().all(|&point| found.partner[point] == NONE));
}

/// Its arms, each with a finger that no reflection of it leaves in its place, are shells of their own.
fn person_with_loose_arms() -> Vec<Cell> {
    let cells = person();
    let is_cut = |&[x, y, _]: &Cell| y == 3 && (x == 1 || x == -2);
    cells.into_iter().filter(|cell| !is_cut(cell)).chain(mirrored(&[[4, 4, 0]])).collect()
}

#[test]
fn the_only_bijection_onto_a_twin_is_accepted_though_the_estimate_is_wrong_inside() {
    let figure = Figure::of_voxels(&person_with_loose_arms(), 6);
    let truth = figure.truth();
    let is_arm = |point: usize| figure.places[point][0].abs() >= 24 && figure.places[point][1] >= 36;
    let of_arms = truth.iter().copied().filter(|&image| is_arm(image as usize));
    let [left, right] = [-1, 1].map(|side| {
        let on_side = |&point: &u32| side * figure.places[point as usize][0] > 0;
        of_arms.clone().find(on_side).expect("a point of an arm")
    });
    let wrong = |point: usize| if figure.places[point][0] < 0 { right } else { left };
    let estimate: Vec<u32> =
        (0..truth.len()).map(|point| if is_arm(point) { wrong(point) } else { truth[point] }).collect();
    let confidence = vec![1.0; truth.len()];
    let found = |reliance| {
        let connectivity = Connectivity::new(figure.half_edges(), 0, |_| 0.0);
        connectivity
            .find(&estimate, &confidence, reliance, Reflection, &Progress::default())
            .unwrap()
            .unwrap()
    };
    assert!(found(Reliance::Twins).partner == truth && found(Reliance::Shells).partner == truth);
    // A shell that is said to be its own has a reflection of its own, too: none of an arm.
    let own = |point: usize| if is_arm(point) { point as u32 } else { truth[point] };
    let own: Vec<u32> = (0..truth.len()).map(own).collect();
    let connectivity = Connectivity::new(figure.half_edges(), 0, |_| 0.0);
    let found = connectivity
        .find(&own, &confidence, Reliance::Shells, Reflection, &Progress::default())
        .unwrap()
        .unwrap();
    assert!((0..truth.len()).all(|point| !is_arm(point) || found.partner[point] == NONE));
}

#[test]
fn a_body_of_fewer_vertices_than_its_eyes_is_the_main_shell() {
    let body = Figure::of_voxels(&person(), 1);
    let eye: Vec<Cell> = (0..30).map(|y| [20 + y % 2, y, y / 7]).collect();
    let all: Vec<Cell> = person().into_iter().chain(mirrored(&eye)).collect();
    let figure = Figure::of_voxels(&all, 1);
    let is_body = |point: usize| figure.places[point][0].abs() < 20;
    let count = (0..figure.places.len()).filter(|&point| is_body(point)).count();
    assert!(count == body.places.len() && 3 * count < figure.places.len());
    let found = |share: f64| {
        let of_point = |point: u32| if is_body(point as usize) { share / count as f64 } else { 0.0 };
        let mut connectivity = Connectivity::new(figure.half_edges(), 0, of_point);
        connectivity.find_unrivalled(|_| true, &Progress::default()).unwrap()
    };
    assert!(found(0.4).is_none_or(|found| !found.unrivalled.contains(&true)));
    let found = found(0.6).expect("a bijection");
    let truth = figure.truth();
    for point in (0..truth.len()).filter(|&point| is_body(point)) {
        assert!(found.unrivalled[point] && found.partner[point] == truth[point]);
    }
}

#[test]
fn around_a_split_edge_the_rest_is_paired() {
    let whole = Figure::of_voxels(&person(), 3).triangulated();
    let truth = whole.truth();
    let mut shuffle = Shuffle(3);
    for _ in 0..5 {
        let mut figure = whole.clone();
        figure.split_edge(shuffle.below(whole.faces.len()));
        let mut estimate = blurred(&whole, &truth, 2, &mut shuffle);
        estimate.push(NONE);
        let found = figure.find(&estimate, Reflection).unwrap();
        assert!(!found.complete && found.exact.iter().all(|&exact| !exact));
        assert!(found.covered > truth.len() * 9 / 10, "{} of {}", found.covered, truth.len());
        let wrong = (0..truth.len()).filter(|&point| ![NONE, truth[point]].contains(&found.partner[point]));
        assert_eq!(wrong.count(), 0);
    }
}

#[test]
fn but_for_a_few_defects_a_figure_is_paired_without_any_estimate() {
    let whole = Figure::of_voxels(&person(), 3).triangulated();
    let mut shuffle = Shuffle(8);
    for (splits, flips) in [(0, 1), (1, 0), (1, 1), (0, 3), (2, 1), (2, 2)] {
        let mut figure = whole.clone();
        (0..splits).for_each(|_| figure.split_edge(shuffle.below(whole.faces.len())));
        (0..flips).for_each(|_| figure.flip_edge(shuffle.below(whole.faces.len())));
        let found = figure.find(&nothing(&figure), Reflection);
        let found = found.unwrap_or_else(|| panic!("{splits} splits, {flips} flips"));
        let truth = figure.truth();
        assert!(!found.complete && found.exact.iter().all(|&exact| !exact));
        assert!(found.covered > truth.len() * 99 / 100, "{} of {}", found.covered, truth.len());
        for (point, &image) in found.partner.iter().enumerate() {
            assert_eq!(found.unrivalled[point], image != NONE);
            assert!(image == NONE || image == truth[point]);
        }
        // An estimate of something else is not overruled.
        let identity: Vec<u32> = (0..figure.places.len() as u32).collect();
        assert_eq!(figure.find(&identity, Reflection), None);
    }
}

#[test]
fn with_defects_and_two_mirror_planes_nothing_says_which() {
    let half: Vec<Cell> = (0..6).map(|x| [x, 0, 0]).chain([[2, 1, 0], [5, 1, 0], [5, 2, 0]]).collect();
    let back = half.iter().map(|&[x, y, z]| [x, y, -1 - z]);
    let cells: Vec<Cell> = half.iter().copied().chain(back).collect();
    let whole = Figure::of_voxels(&mirrored(&cells), 3);
    assert_eq!(whole.find(&nothing(&whole), Reflection), None, "it has two reflections");
    let triangles = whole.triangulated();
    for mut figure in [whole, triangles] {
        figure.faces.pop();
        assert_eq!(figure.find(&nothing(&figure), Reflection), None);
    }
}

#[test]
fn of_several_pairings_the_one_that_agrees_is_taken() {
    let half: Vec<Cell> = (0..6).map(|x| [x, 0, 0]).chain([[2, 1, 0], [5, 1, 0], [5, 2, 0]]).collect();
    let back = half.iter().map(|&[x, y, z]| [x, y, -1 - z]);
    let cells: Vec<Cell> = half.iter().copied().chain(back).collect();
    let mut figure = Figure::of_voxels(&mirrored(&cells), 3);
    figure.faces.pop();
    let truth = figure.truth();
    let is_left_to_right = |found: &Automorphism| {
        let pairs = || found.partner.iter().zip(&truth).filter(|(image, _)| **image != NONE);
        2 * pairs().filter(|(image, truth)| image == truth).count() > pairs().count()
    };
    let find = |agrees: &dyn Fn(&Automorphism) -> bool| {
        Connectivity::new(figure.half_edges(), 0, |_| 0.0)
            .find_unrivalled(agrees, &Progress::default())
            .unwrap()
    };
    let found = find(&is_left_to_right).expect("left to right");
    assert!(is_left_to_right(&found) && found.covered > truth.len() * 99 / 100);
    let other = find(&|found| !is_left_to_right(found)).expect("front to back");
    assert!(!is_left_to_right(&other));
    assert_eq!(find(&|_| true), None, "both agree");
    assert_eq!(find(&|_| false), None, "neither agrees");
}

#[test]
fn a_cut_that_parts_the_halves_leaves_both_parts_paired() {
    let mut figure = Figure::of_voxels(&person(), 3).triangulated();
    let truth = figure.truth();
    // The neck's left half is gone: no patch comes from the body to the head.
    let is_of_neck = |&point: &u32| {
        let [x, y, _] = figure.places[point as usize];
        x >= 0 && (3 * 4..=3 * 5).contains(&y)
    };
    let kept = figure.faces.iter().filter(|face| !face.iter().all(is_of_neck)).cloned().collect();
    figure.faces = kept;
    let is_true = |found: &Automorphism| {
        found.partner.iter().zip(&truth).all(|(image, truth)| *image == NONE || image == truth)
    };
    let find = |agrees: &dyn Fn(&Automorphism) -> bool| {
        Connectivity::new(figure.half_edges(), 0, |_| 0.0)
            .find_unrivalled(agrees, &Progress::default())
            .unwrap()
    };
    let found = find(&is_true).expect("both parts");
    let is_paired = |low: i32, high: i32| {
        let points = (0..truth.len()).filter(|&point| (low..high).contains(&figure.places[point][1]));
        let (all, paired) = points.fold((0, 0), |(all, paired), point| {
            (all + 1, paired + usize::from(found.partner[point] != NONE))
        });
        paired * 10 > all * 9
    };
    assert!(is_true(&found) && is_paired(-9, 9) && is_paired(17, 19));
    assert_eq!(find(&|_| false), None, "patches apart from each other need the shape's word");
}

#[test]
fn what_has_no_mirror_image_is_left_out() {
    let sword: Vec<Cell> = (4..12).flat_map(|y| [[4, y, 0], [4, y, 1]]).collect();
    let cells: Vec<Cell> = person().into_iter().chain(sword).collect();
    let figure = Figure::of_voxels(&cells, 3).triangulated();
    let (truth, found) = (figure.truth(), figure.find(&nothing(&figure), Reflection).expect("a pairing"));
    assert!((0..truth.len()).all(|point| truth[point] != NONE || found.partner[point] == NONE));
    assert!(found.covered > truth.iter().filter(|&&image| image != NONE).count() * 95 / 100);
    for (point, &image) in found.partner.iter().enumerate().filter(|(_, image)| **image != NONE) {
        assert_eq!(image, truth[point], "{:?}", figure.places[point]);
    }
}

#[test]
fn a_few_flips_leave_a_partial_match_and_many_leave_none() {
    let whole = Figure::of_voxels(&person(), 3).triangulated();
    let truth = whole.truth();
    let mut shuffle = Shuffle(4);
    for (flips, expected) in [(3, true), (whole.faces.len(), false)] {
        let mut figure = whole.clone();
        for _ in 0..flips {
            figure.flip_edge(shuffle.below(whole.faces.len()));
        }
        let found = figure.find(&truth, Reflection);
        assert_eq!(found.is_some(), expected, "{flips} flips");
        if let Some(found) = found {
            let wrong =
                (0..truth.len()).filter(|&point| ![NONE, truth[point]].contains(&found.partner[point]));
            assert_eq!(wrong.count(), 0);
        }
    }
}

#[test]
fn an_asymmetric_figure_of_regular_grids_has_no_match() {
    let lopsided: Vec<Cell> = vec![
        [0, 0, 0],
        [1, 0, 0],
        [2, 0, 0],
        [3, 0, 0],
        [3, 1, 0],
        [3, 1, 1],
        [0, 0, 1],
        [0, 0, 2],
        [0, -1, 2],
    ];
    let figure = Figure::of_voxels(&lopsided, 8);
    let mut shuffle = Shuffle(5);
    let anywhere: Vec<u32> =
        figure.places.iter().map(|_| shuffle.below(figure.places.len()) as u32).collect();
    let identity: Vec<u32> = (0..figure.places.len() as u32).collect();
    for estimate in [nothing(&figure), anywhere, identity] {
        for figure in [figure.clone(), figure.triangulated()] {
            assert_eq!(figure.find(&estimate, Reflection), None);
        }
    }
}

#[test]
fn a_bar_that_is_longer_on_one_side_is_not_matched_by_sliding_its_grid() {
    let bar: Vec<Cell> = (-4..12).map(|x| [x, 0, 0]).chain([[-4, 1, 0], [11, 1, 0], [2, 0, 1]]).collect();
    let figure = Figure::of_voxels(&bar, 4);
    let truth = figure.truth();
    if let Some(found) = figure.find(&truth, Reflection) {
        let wrong = (0..truth.len()).filter(|&point| ![NONE, truth[point]].contains(&found.partner[point]));
        assert_eq!(wrong.count(), 0);
    }
}

#[test]
fn a_grid_cut_along_parallel_diagonals_has_no_match_near_the_truth() {
    for cuts in [2, 5, 9] {
        let figure = Figure::of_voxels(&person(), cuts).cut_from(|[x, y, z]| [x + y + z, x, y, z]);
        assert_eq!(figure.find(&figure.truth(), Reflection), None);
    }
}

#[test]
fn a_large_figure_takes_seconds() {
    let cuts = std::env::var("INTRINSYM_STRESS_CUTS").map_or(20, |cuts| cuts.parse().unwrap());
    let figure = Figure::of_voxels(&person(), cuts);
    let truth = figure.truth();
    let half_edges = figure.half_edges();
    let started = std::time::Instant::now();
    let found = Connectivity::new(half_edges, 0, |_| 0.0)
        .find(&truth, &vec![1.0; truth.len()], Reliance::Shells, Reflection, &Progress::default())
        .unwrap()
        .unwrap();
    println!("{} points: {:.2} s", truth.len(), started.elapsed().as_secs_f64());
    assert_eq!(found.partner, truth);
    let lopsided = Figure::of_voxels(&person()[1..], cuts);
    let half_edges = lopsided.half_edges();
    let started = std::time::Instant::now();
    let estimate = lopsided.truth();
    let found = Connectivity::new(half_edges, 0, |_| 0.0)
        .find(&estimate, &vec![1.0; estimate.len()], Reliance::Shells, Reflection, &Progress::default())
        .unwrap();
    println!("asymmetric: {:.2} s", started.elapsed().as_secs_f64());
    assert!(found.is_none_or(|found| !found.complete));
}

fn half_of_a_random_figure() -> impl Strategy<Value = Vec<Cell>> {
    prop::collection::vec((0..3i32, 0..3i32, 0..3i32).prop_map(<[i32; 3]>::from), 1..9)
}

proptest! {
    #[test]
    fn the_truth_is_found_from_the_truth(half in half_of_a_random_figure(), triangles in any::<bool>()) {
        let figure = Figure::of_voxels(&mirrored(&half), 2);
        let figure = if triangles { figure.triangulated() } else { figure };
        let found = figure.find(&figure.truth(), Reflection).unwrap();
        prop_assert_eq!(found.partner, figure.truth());
    }

    #[test]
    fn renumbering_renumbers_the_result(half in half_of_a_random_figure(), seed in any::<u64>()) {
        let figure = Figure::of_voxels(&mirrored(&half), 2);
        let (renumbered, new_of) = figure.renumbered(&mut Shuffle(seed));
        let found = figure.find(&figure.truth(), Reflection).unwrap();
        let again = renumbered.find(&renumbered.truth(), Reflection).unwrap();
        for (point, &image) in found.partner.iter().enumerate() {
            let expected = if image == NONE { NONE } else { new_of[image as usize] };
            prop_assert_eq!(again.partner[new_of[point] as usize], expected);
        }
    }
}
