//! `detect`: what it answers, and the files it writes.

use super::*;
use intrinsym::{Limits, Mesh, io};
use std::ffi::OsStr;
use std::io::Write;
use std::process::Stdio;

/// Largest distance from a vertex's partner to its true mirror image, as a share of the square root of the area.
const TOLERANCE: f64 = 0.05;

/// Share of the vertices whose partner lies within [`TOLERANCE`] of the true one.
fn share_right(mesh_path: &Path, partners: &[i64], truth: &[i64]) -> f64 {
    let limits = Limits::default();
    let file = io::read(mesh_path, &limits).unwrap();
    let unit = Mesh::new(&file.polygons, &limits).unwrap().unit_length;
    assert_eq!(partners.len(), truth.len());
    let near = |(&partner, &mirror): (&i64, &i64)| {
        let Ok(partner) = usize::try_from(partner) else { return false };
        let (a, b) = (file.polygons.positions[partner], file.polygons.positions[mirror as usize]);
        let distance = (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
        distance <= TOLERANCE * unit
    };
    partners.iter().zip(truth).filter(|&pair| near(pair)).count() as f64 / truth.len() as f64
}

/// Runs `detect` on an example with every kind of output; the folder and the process's output.
fn detect_example(name: &str, further: &[&str]) -> (PathBuf, Output) {
    let folder = folder(&format!("{name}{}", further.concat()));
    let mut command = command();
    command.arg("detect").arg(example(&format!("{name}.ply"))).args(further);
    for (flag, file) in
        [("-o", "out.ply"), ("--map", "out.map"), ("--json", "out.json"), ("--picture", "out.png")]
    {
        command.arg(flag).arg(folder.join(file));
    }
    let output = command.output().unwrap();
    (folder, output)
}

fn json(path: &Path) -> serde_json::Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

#[test]
fn a_posed_human_is_paired_exactly_where_connectivity_is_mirrored() {
    let (folder, output) = detect_example("human", &[]);
    assert_eq!(output.status.code(), FOUND, "{}", stderr(&output));
    let partners = numbers(&folder.join("out.map"));
    let truth = numbers(&example("human.mirror"));
    assert!(partners == truth, "the bijection of the mirrored connectivity");
    let report = json(&folder.join("out.json"));
    assert_eq!(report["outcome"], "found");
    assert_eq!(report["symmetries"][0]["kind"], "reflection");
    assert_eq!(report["symmetries"][0]["exact_share"], 1.0);
    assert_eq!(report["options"]["effort"], "default");
    assert!(report["symmetries"][0]["fixed_curve_length"].as_f64().unwrap() > 1.0);
    assert!(
        stdout(&output).contains("found: reflection, 13380 of 13380 vertices paired"),
        "{}",
        stdout(&output)
    );
}

#[test]
fn every_shell_of_a_character_has_its_partner_shell() {
    let (folder, output) = detect_example("human_shells", &[]);
    assert_eq!(output.status.code(), FOUND, "{}", stderr(&output));
    let partners = numbers(&folder.join("out.map"));
    let truth = numbers(&example("human_shells.mirror"));
    let path = example("human_shells.ply");
    let right = share_right(&path, &partners, &truth);
    assert!(right >= 0.99, "{right}");
    let said = "of 10 shells ";
    assert!(
        stdout(&output).contains(said) && stdout(&output).contains(", 0 without a partner"),
        "{}",
        stdout(&output)
    );
    let limits = Limits::default();
    let mesh = Mesh::new(&io::read(&path, &limits).unwrap().polygons, &limits).unwrap();
    let shell = |vertex: usize| mesh.shell_of_point[mesh.point_of_vertex[vertex] as usize];
    for vertex in 0..truth.len() {
        let found = shell(usize::try_from(partners[vertex]).unwrap());
        assert_eq!(found, shell(truth[vertex] as usize), "vertex {vertex} of shell {}", shell(vertex));
    }
}

#[test]
fn an_animal_without_mirrored_connectivity_is_paired() {
    let (folder, output) = detect_example("quadruped", &[]);
    assert_eq!(output.status.code(), FOUND, "{}", stderr(&output));
    let partners = numbers(&folder.join("out.map"));
    let truth = numbers(&example("quadruped.mirror"));
    let right = share_right(&example("quadruped.ply"), &partners, &truth);
    assert!(right >= 0.9, "{right}");
}

#[test]
fn a_blob_without_symmetry_is_not_found_to_have_one() {
    let (_, output) = detect_example("blob", &[]);
    assert!([DOUBTFUL, NONE].contains(&output.status.code()), "{}", stderr(&output));
}

/// Triangles of different shapes, none the mirror image of another.
fn loose_triangles(path: &Path) {
    let coordinate = |index: usize| (4321.0 * (index as f64).sin()).fract();
    let mut text = "OFF\n600 200 0\n".to_string();
    (0..600).for_each(|v| {
        text += &format!("{} {} {}\n", coordinate(3 * v), coordinate(3 * v + 1), coordinate(3 * v + 2))
    });
    (0..200).for_each(|face| text += &format!("3 {} {} {}\n", 3 * face, 3 * face + 1, 3 * face + 2));
    std::fs::write(path, text).unwrap();
}

#[test]
fn loose_triangles_are_answered_none() {
    let folder = folder("loose");
    let (mesh, map, report) = (folder.join("loose.off"), folder.join("out.map"), folder.join("out.json"));
    loose_triangles(&mesh);
    let output =
        command().arg("detect").arg(mesh).arg("--map").arg(&map).arg("--json").arg(&report).output().unwrap();
    assert_eq!(output.status.code(), NONE, "{}", stderr(&output));
    assert!(stdout(&output).contains("no symmetry found"), "{}", stdout(&output));
    assert_eq!(json(&report)["outcome"], "none");
    assert!(numbers(&map).iter().all(|&partner| partner == -1));
}

#[test]
fn a_doubtful_map_is_written_and_the_summary_says_what_speaks_against_it() {
    let (folder, output) = detect_example("quadruped", &["--plausibility", "100"]);
    assert_eq!(output.status.code(), DOUBTFUL, "{}", stderr(&output));
    assert_eq!(names(&folder), ["out.json", "out.map", "out.ply", "out.png"]);
    assert_eq!(json(&folder.join("out.json"))["outcome"], "doubtful");
    assert!(numbers(&folder.join("out.map")).iter().all(|&partner| partner >= 0));
    for said in ["doubtful: reflection", "100 % of the surface has a partner", "it is given as doubtful"] {
        assert!(stdout(&output).contains(said), "{}", stdout(&output));
    }
}

#[test]
fn the_worst_of_many_meshes_is_the_exit_status() {
    let folder = folder("worst");
    loose_triangles(&folder.join("loose.off"));
    let status = |inputs: &[&str]| {
        let mut command = command();
        command
            .args(["detect", "--quiet", "--plausibility", "100", "--write", "json", "--output-dir"])
            .arg(&folder);
        let place = |name: &&str| if *name == "loose.off" { folder.join(name) } else { example(name) };
        command.args(inputs.iter().map(place)).output().unwrap().status.code()
    };
    assert_eq!(status(&["human.ply", "quadruped.ply"]), DOUBTFUL);
    assert_eq!(status(&["loose.off", "quadruped.ply"]), NONE);
    assert_eq!(status(&["quadruped.ply", "no_such.ply"]), FAILED);
}

#[test]
fn the_picture_is_a_png_and_nothing_else_is_left() {
    let (folder, _) = detect_example("quadruped", &["--up", "z"]);
    assert_eq!(names(&folder), ["out.json", "out.map", "out.ply", "out.png"]);
    assert!(std::fs::read(folder.join("out.png")).unwrap().starts_with(b"\x89PNG\r\n\x1a\n"));
}

#[test]
fn the_ply_keeps_the_inputs_attributes_and_adds_ours() {
    let folder = folder("attributes");
    let text = "ply\nformat ascii 1.0\ncomment kept\nelement vertex 4\nproperty double x\nproperty double y\n\
        property double z\nproperty uchar quality\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n\
        element face 4\nproperty list uchar uint vertex_indices\nproperty short material\nend_header\n\
        0 0 0.1 200 1 2 3\n1 0 0 201 4 5 6\n0 1 0 202 7 8 9\n0 0 1 203 10 11 12\n\
        3 0 2 1 -5\n3 0 1 3 6\n3 1 2 3 7\n3 2 0 3 8\n";
    std::fs::write(folder.join("in.ply"), text).unwrap();
    let header = |colors: &str| {
        let out = folder.join(format!("{colors}.ply"));
        let mut command = command();
        command.arg("detect").arg(folder.join("in.ply")).arg("-o").arg(&out).args(["--colors", colors]);
        let output = command.output().unwrap();
        assert!([FOUND, NONE].contains(&output.status.code()), "{}", stderr(&output));
        let bytes = std::fs::read(&out).unwrap();
        let end = bytes.windows(11).position(|window| window == b"end_header\n").unwrap();
        (String::from_utf8(bytes[..end].to_vec()).unwrap(), bytes[end + 11..].to_vec())
    };
    let (kept, body) = header("auto");
    for line in [
        "comment kept",
        "property double x",
        "property uchar quality",
        "property short material",
        "property int sym_vertex",
        "property float sym_confidence",
        "property int sym_side",
    ] {
        assert!(kept.lines().any(|found| found == line), "{line} is missing in\n{kept}");
    }
    // x, y, z, then quality, red, green, blue of the first vertex, as they were.
    assert_eq!(body[16..24], 0.1f64.to_le_bytes());
    assert_eq!(body[24..28], [200, 1, 2, 3]);
    let (replaced, body) = header("always");
    assert_eq!(replaced.matches("property uchar red").count(), 1);
    assert_ne!(body[25..28], [1, 2, 3]);
    assert_eq!(body[24], 200);
}

#[test]
fn many_inputs_go_on_after_a_bad_one() {
    let folder = folder("many");
    std::fs::write(folder.join("broken.off"), "OFF\n3 1 0\n0 0 0\n1 0 0\n").unwrap();
    let out = folder.join("results");
    let output = command()
        .args(["detect", "--jobs", "2", "--output-dir"])
        .args([&out, &folder.join("broken.off"), &example("quadruped.ply"), &example("blob.ply")])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), FAILED);
    assert!(stderr(&output).contains("broken.off"), "{}", stderr(&output));
    let expected = ["blob.json", "blob.map", "blob.ply", "quadruped.json", "quadruped.map", "quadruped.ply"];
    assert_eq!(names(&out), expected);
    assert_eq!(stdout(&output).lines().count(), 2, "{}", stdout(&output));
}

#[test]
fn quiet_prints_nothing() {
    let output = run(&["detect".as_ref(), example("quadruped.ply").as_os_str(), "--quiet".as_ref()]);
    assert_eq!((stdout(&output), stderr(&output)), (String::new(), String::new()));
}

/// The mesh comes through a pipe, so that the interrupt surely arrives before the work is done.
#[cfg(unix)]
#[test]
fn an_interrupt_ends_with_130_and_leaves_no_file() {
    let folder = folder("interrupt");
    let pipe = folder.join("in.ply");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let child = command()
        .arg("detect")
        .arg(&pipe)
        .args([OsStr::new("--map"), folder.join("out.map").as_os_str()])
        .args([OsStr::new("-o"), folder.join("out.ply").as_os_str()])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // Opening blocks until the program opens the other end, and by then it listens for interrupts.
    let mut writer = std::fs::OpenOptions::new().write(true).open(&pipe).unwrap();
    let kill = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(kill.success());
    std::thread::sleep(std::time::Duration::from_millis(200));
    writer.write_all(&std::fs::read(example("quadruped.ply")).unwrap()).unwrap();
    drop(writer);
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130), "{}", stdout(&output));
    assert!(stderr(&output).contains("interrupted, nothing was written"), "{}", stderr(&output));
    assert_eq!(names(&folder), ["in.ply"]);
}
