//! Any sequence of C calls, with live, freed, foreign and NULL handles and lengths that do not fit.
//!
//! The one promise that the library trusts is kept: an array has at least the length that is said of it.
#![no_main]

// A library for C programs cannot be a dependency.
#[allow(dead_code)]
#[path = "../../capi/src/lib.rs"]
mod capi;

use capi::eigen::isym_eigen_free;
use capi::handles::isym_handle_count;
use capi::mesh::*;
use capi::options::*;
use capi::panic_boundary::isym_error_message;
use capi::progress::*;
use capi::result::*;
use capi::status::*;
use capi::tools::*;
use libfuzzer_sys::arbitrary::{self, Arbitrary};
use std::ffi::{CStr, c_void};
use std::mem::MaybeUninit;
use std::ptr;

/// Elements of every array that is handed over; no length is larger.
const ROOM: usize = 256;

#[derive(Debug, Arbitrary)]
enum Call {
    Mesh {
        positions: Vec<[i8; 3]>,
        triangles: Vec<[u8; 3]>,
    },
    Polygons {
        positions: Vec<[f32; 3]>,
        offsets: Vec<u8>,
        corners: Vec<u8>,
    },
    MeshSize {
        mesh: u8,
    },
    Options,
    Set {
        options: u8,
        name: u8,
        value: f64,
    },
    Progress,
    Cancel {
        progress: u8,
    },
    Detect {
        mesh: u8,
        options: u8,
        progress: u8,
    },
    DetectAgain {
        mesh: u8,
        previous: u8,
        options: u8,
        progress: u8,
    },
    Eigen {
        mesh: u8,
        count: u8,
        progress: u8,
    },
    Read {
        result: u8,
        symmetry: u8,
        what: u8,
        length: u8,
    },
    Restore {
        mesh: u8,
        kind: i8,
        partners: Vec<i8>,
        confidence: f32,
        side: i8,
        corner: u8,
        length: u8,
    },
    Mirror {
        result: u8,
        symmetry: u8,
        merge: i8,
        confidence: f32,
        weight: i8,
        what: u8,
        length: u8,
        number: f64,
    },
    Free {
        handle: u8,
        kind: u8,
    },
    NullOutput {
        mesh: u8,
    },
}

/// All handles that were ever made; freed ones stay, so that they are used again. The first is NULL.
struct Handles {
    all: Vec<*mut c_void>,
    options: *mut isym_options,
}

impl Handles {
    fn at<T>(&self, index: u8) -> *mut T {
        self.all[index as usize % self.all.len()].cast()
    }

    fn keep<T>(&mut self, status: isym_status, handle: *mut T) {
        assert_eq!(status == ISYM_OK, !handle.is_null(), "a handle comes with ISYM_OK, and only then");
        if status == ISYM_OK {
            self.all.push(handle.cast());
        }
    }
}

const NAMES: [&CStr; 4] = [c"samples", c"symmetries", c"beam_width", c"no_such_option"];

/// Any number in the place of an enumeration, as C may hand it over.
fn enumeration<T>(number: i8) -> MaybeUninit<T> {
    let mut value = MaybeUninit::<T>::uninit();
    // SAFETY: the header's enumerations are as wide as an `i32`.
    unsafe { value.as_mut_ptr().cast::<i32>().write(number.into()) };
    value
}

fn mirroring(merge: i8, confidence: f32, weight: i8) -> isym_mirroring {
    isym_mirroring {
        size: size_of::<isym_mirroring>(),
        merge: enumeration(merge),
        minimum_confidence: confidence,
        weight_by_confidence: weight.into(),
    }
}

fn call(handles: &mut Handles, call: &Call) {
    // SAFETY: every array below has ROOM elements or more, or the length that is given.
    unsafe {
        match call {
            Call::Mesh { positions, triangles } => {
                let positions: Vec<f64> =
                    positions.as_flattened().iter().map(|&x| x.into()).chain([0.0]).collect();
                let corners: Vec<u32> =
                    triangles.as_flattened().iter().map(|&x| x.into()).chain([0]).collect();
                let mut mesh = ptr::null_mut();
                let (vertices, faces) = (positions.len() / 3, triangles.len());
                let status = isym_mesh_from_triangles(
                    positions.as_ptr(),
                    vertices,
                    corners.as_ptr(),
                    faces,
                    &mut mesh,
                );
                handles.keep(status, mesh);
            }
            Call::Polygons { positions, offsets, corners } => {
                let coordinates: Vec<f32> = positions.as_flattened().iter().copied().chain([0.0]).collect();
                let offsets: Vec<u32> = offsets.iter().map(|&x| x.into()).chain([0]).collect();
                let all_corners: Vec<u32> = corners.iter().map(|&x| x.into()).chain([0]).collect();
                let mut mesh = ptr::null_mut();
                let status = isym_mesh_from_polygons_f32(
                    coordinates.as_ptr(),
                    positions.len(),
                    offsets.as_ptr(),
                    offsets.len() - 1,
                    all_corners.as_ptr(),
                    corners.len(),
                    &mut mesh,
                );
                handles.keep(status, mesh);
            }
            Call::MeshSize { mesh } => {
                let mut size = [usize::MAX; 3];
                let [vertices, faces, corners] = &mut size;
                let status = isym_mesh_size(handles.at(*mesh), vertices, faces, corners);
                assert_eq!(status == ISYM_OK, size != [usize::MAX; 3], "on failure nothing is written");
            }
            Call::Options => {
                let mut options = ptr::null_mut();
                handles.keep(isym_options_new(&mut options), options);
            }
            Call::Set { options, name, value } => {
                isym_options_set(handles.at(*options), NAMES[*name as usize % NAMES.len()].as_ptr(), *value);
            }
            Call::Progress => {
                let mut progress = ptr::null_mut();
                handles.keep(isym_progress_new(&mut progress), progress);
            }
            Call::Cancel { progress } => {
                isym_progress_cancel(handles.at(*progress));
            }
            Call::Detect { mesh, options, progress } => {
                let mut result = ptr::null_mut();
                // Mostly the quick options: another set may ask for a hundred times as much.
                let options = if options % 4 == 0 { handles.at(*options) } else { handles.options };
                let status = isym_mesh_detect(handles.at(*mesh), options, handles.at(*progress), &mut result);
                handles.keep(status, result);
            }
            Call::DetectAgain { mesh, previous, options, progress } => {
                let mut result = ptr::null_mut();
                let options = if options % 4 == 0 { handles.at(*options) } else { handles.options };
                let (mesh, previous) = (handles.at(*mesh), handles.at(*previous));
                let status =
                    isym_mesh_detect_again(mesh, previous, options, handles.at(*progress), &mut result);
                handles.keep(status, result);
            }
            Call::Eigen { mesh, count, progress } => {
                let mut pairs = ptr::null_mut();
                let count = (*count % 16).into();
                let status = isym_mesh_eigen(handles.at(*mesh), count, handles.at(*progress), &mut pairs);
                handles.keep(status, pairs);
            }
            Call::Read { result, symmetry, what, length } => {
                read(handles, *result, *symmetry, *what, *length)
            }
            Call::Restore { mesh, kind, partners, confidence, side, corner, length } => {
                let mut all_partners: Vec<u32> = partners.iter().map(|&x| i32::from(x) as u32).collect();
                all_partners.resize(ROOM, ISYM_NONE);
                let mut result = ptr::null_mut();
                let status = isym_result_restore(
                    handles.at(*mesh),
                    enumeration(*kind),
                    all_partners.as_ptr(),
                    [*confidence; ROOM].as_ptr(),
                    [*side; ROOM].as_ptr(),
                    [0u32; ROOM].as_ptr(),
                    [u32::from(*corner); 3 * ROOM].as_ptr(),
                    [1.0f32 / 3.0; 3 * ROOM].as_ptr(),
                    (*length).into(),
                    &mut result,
                );
                handles.keep(status, result);
            }
            Call::Mirror { result, symmetry, merge, confidence, weight, what, length, number } => {
                let how = mirroring(*merge, *confidence, *weight);
                mirror(handles, *result, *symmetry, &how, *what, *length, *number);
            }
            Call::Free { handle, kind } => {
                match kind % 5 {
                    0 => isym_mesh_free(handles.at(*handle)),
                    1 => isym_options_free(handles.at(*handle)),
                    2 => isym_progress_free(handles.at(*handle)),
                    3 => isym_result_free(handles.at(*handle)),
                    _ => isym_eigen_free(handles.at(*handle)),
                };
            }
            Call::NullOutput { mesh } => {
                let status =
                    isym_mesh_size(handles.at(*mesh), ptr::null_mut(), ptr::null_mut(), ptr::null_mut());
                assert_ne!(status, ISYM_OK);
            }
        }
    }
    // SAFETY: no arguments; the text is valid until the next call.
    let message = unsafe { CStr::from_ptr(isym_error_message()) };
    assert!(message.to_str().is_ok());
}

/// # Safety
/// None is needed: all arrays are here.
unsafe fn read(handles: &Handles, result: u8, symmetry: u8, what: u8, length: u8) {
    let (result, symmetry, length) = (handles.at(result), symmetry.into(), usize::from(length));
    let mut bytes = [0u8; 3 * ROOM];
    let mut words = [[0u32; 3 * ROOM]; 3];
    let mut numbers = [0f32; 3 * ROOM];
    let [first, second, third] = &mut words;
    // SAFETY: lengths are below ROOM.
    unsafe {
        match what % 6 {
            0 => isym_result_partners(result, symmetry, first.as_mut_ptr(), length),
            1 => isym_result_confidences(result, symmetry, numbers.as_mut_ptr(), length),
            2 => isym_result_sides(result, symmetry, bytes.as_mut_ptr().cast(), length),
            3 => isym_result_pair_colours(result, symmetry, bytes.as_mut_ptr(), length),
            4 => isym_result_report(result, bytes.as_mut_ptr().cast(), length),
            _ => isym_result_surface_points(
                result,
                symmetry,
                second.as_mut_ptr(),
                third.as_mut_ptr(),
                numbers.as_mut_ptr(),
                length,
            ),
        };
    }
}

/// # Safety
/// None is needed: all arrays are here.
unsafe fn mirror(
    handles: &Handles,
    result: u8,
    symmetry: u8,
    how: &isym_mirroring,
    what: u8,
    length: u8,
    number: f64,
) {
    let (result, symmetry, length) = (handles.at(result), symmetry.into(), usize::from(length));
    let mut positions: Vec<f64> = (0..3 * ROOM).map(|index| (index % 17) as f64).collect();
    positions[1] = number;
    let mut numbers = vec![number; 3 * ROOM];
    let mut bytes = [1u8; ROOM];
    let (read, write) = (positions.as_ptr(), numbers.as_mut_ptr());
    // SAFETY: lengths are below ROOM, three numbers each.
    unsafe {
        match what % 6 {
            0 => isym_result_mirror_selection(
                result,
                symmetry,
                bytes.as_ptr(),
                how.minimum_confidence,
                bytes.as_mut_ptr(),
                length,
            ),
            1 => isym_result_mirror_face_selection(
                result,
                symmetry,
                bytes.as_ptr(),
                how.minimum_confidence,
                bytes.as_mut_ptr(),
                length,
            ),
            2 => isym_result_mirror_values(result, symmetry, how, read, 3, write, length),
            3 => isym_result_carry_displacement(result, symmetry, how, read, write, write, length),
            4 => isym_result_curve_distances(result, symmetry, read, write, length),
            _ => {
                let mut progress = ptr::null_mut();
                isym_progress_new(&mut progress);
                isym_result_symmetrize_positions(result, symmetry, how, read, progress, write, length);
                isym_progress_free(progress)
            }
        };
    }
}

/// Options that make a detection quick.
fn quick_options() -> *mut isym_options {
    let mut options = ptr::null_mut();
    // SAFETY: a pointer to write to, names that end.
    unsafe {
        isym_options_new(&mut options);
        for (name, value) in [(c"eigenfunctions", 12.0), (c"samples", 100.0), (c"beam_width", 1.0)] {
            assert_eq!(isym_options_set(options, name.as_ptr(), value), ISYM_OK);
        }
    }
    options
}

/// NULL, options, a square of four squares, its mirror symmetry, and a progress: so that calls soon go deep.
fn first_handles() -> Handles {
    let options = quick_options();
    let (mut mesh, mut result, mut progress) = (ptr::null_mut(), ptr::null_mut(), ptr::null_mut());
    let positions: [f64; 27] = std::array::from_fn(|index| {
        let vertex = index / 3;
        [(vertex % 3) as f64, 1.5 * (vertex / 3) as f64, 0.0][index % 3]
    });
    let squares = [0, 1, 4, 3, 1, 2, 5, 4, 3, 4, 7, 6, 4, 5, 8, 7];
    let partners: [u32; 9] = [2, 1, 0, 5, 4, 3, 8, 7, 6];
    let corners: [u32; 27] = std::array::from_fn(|index| partners[index / 3]);
    let weights: [f32; 27] = std::array::from_fn(|index| if index % 3 == 0 { 1.0 } else { 0.0 });
    let sides = [1, 0, -1, 1, 0, -1, 1, 0, -1];
    // SAFETY: nine vertices and four faces, as said.
    unsafe {
        let offsets = [0, 4, 8, 12, 16];
        isym_mesh_from_polygons(positions.as_ptr(), 9, offsets.as_ptr(), 4, squares.as_ptr(), 16, &mut mesh);
        isym_progress_new(&mut progress);
        let status = isym_result_restore(
            mesh,
            MaybeUninit::new(ISYM_KIND_REFLECTION),
            partners.as_ptr(),
            [0.5; 9].as_ptr(),
            sides.as_ptr(),
            [0; 9].as_ptr(),
            corners.as_ptr(),
            weights.as_ptr(),
            9,
            &mut result,
        );
        assert_eq!(status, ISYM_OK);
    }
    let all = vec![ptr::null_mut(), options.cast(), mesh.cast(), result.cast(), progress.cast()];
    Handles { all, options }
}

libfuzzer_sys::fuzz_target!(|calls: Vec<Call>| {
    let mut handles = first_handles();
    calls.iter().take(64).for_each(|one| call(&mut handles, one));
    for &handle in &handles.all {
        // Of another kind, or freed already, they are refused.
        isym_mesh_free(handle.cast());
        isym_options_free(handle.cast());
        isym_progress_free(handle.cast());
        isym_result_free(handle.cast());
        isym_eigen_free(handle.cast());
    }
    assert_eq!(isym_handle_count(), 0, "every handle can be freed");
});
