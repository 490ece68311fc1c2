//! The files of a run: none is mixed up with another, none is lost, and what cannot be written is said.

use super::*;
use std::ffi::OsStr;
use std::io::Read;
use std::process::Stdio;

/// A mesh with a symmetry, found at once.
const MESH: &str = "OFF\n4 4 0\n1 1 1\n1 -1 -1\n-1 1 -1\n-1 -1 1.2\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n";

fn with_meshes(name: &str, meshes: &[&str]) -> PathBuf {
    let folder = folder(name);
    meshes.iter().for_each(|mesh| std::fs::write(folder.join(mesh), MESH).unwrap());
    folder
}

fn run_in<A: AsRef<OsStr>>(folder: &Path, arguments: &[A]) -> Output {
    command().current_dir(folder).args(arguments).output().unwrap()
}

#[track_caller]
fn refused(folder: &Path, arguments: &[&str], expected: &[&str]) {
    let before = names(folder);
    let output = run_in(folder, arguments);
    assert_eq!(output.status.code(), FAILED, "{arguments:?}: {}", stderr(&output));
    for text in expected {
        assert!(stderr(&output).contains(text), "{arguments:?}: {}", stderr(&output));
    }
    assert_eq!(names(folder), before);
}

#[track_caller]
fn done(folder: &Path, arguments: &[&str]) -> Output {
    let output = run_in(folder, arguments);
    assert!([FOUND, NONE].contains(&output.status.code()), "{arguments:?}: {}", stderr(&output));
    output
}

#[test]
fn no_two_results_share_a_file() {
    let folder = with_meshes("clashes", &["a.off", "a_2.off"]);
    let many = ["detect", "a.off", "a_2.off", "--output-dir", "out", "--symmetries", "4"];
    refused(&folder, &many, &["a_2.map would be both the map of a.off and the map of a_2.off"]);
    done(&folder, &many[..5]);
    refused(
        &folder,
        &["detect", "a.off", "--map", "s", "--json", "./s"],
        &["the map of a.off and the report of a.off"],
    );
    refused(
        &folder,
        &["detect", "a.off", "--map", "x.map", "--json", "x_3.map", "--symmetries", "3"],
        &["x_3.map would be both"],
    );
}

#[cfg(unix)]
#[test]
fn links_to_one_file_are_that_file() {
    let folder = with_meshes("links", &["a.off"]);
    std::os::unix::fs::symlink("a.off", folder.join("link")).unwrap();
    refused(&folder, &["detect", "a.off", "--map", "link", "--force"], &["the input a.off"]);
    let devices = ["detect", "a.off", "--map", "/dev/null", "--json", "/dev/null"];
    done(&folder, &devices);
}

#[test]
fn no_input_is_overwritten_even_by_force() {
    let folder = with_meshes("inputs", &["a.off"]);
    done(&folder, &["detect", "a.off", "-o", "b.ply"]);
    for arguments in [
        &["detect", "b.ply", "--output-dir", ".", "--force"][..],
        &["detect", "b.ply", "-o", "./b.ply", "--force"],
        &["detect", "a.off", "b.ply", "--output-dir", "../inputs", "--force"],
    ] {
        refused(&folder, arguments, &["b.ply would be both the input b.ply and the mesh of"]);
    }
    std::fs::copy(folder.join("a.off"), folder.join("a.npz")).unwrap();
    refused(&folder, &["eigen", "a.npz", "-o", "a.npz", "--force"], &["the input a.npz and the archive"]);
}

#[test]
fn the_buffer_of_a_gltf_is_an_input() {
    let folder = folder("buffer");
    let buffer: Vec<u8> = [[0f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
        .concat()
        .iter()
        .flat_map(|number| number.to_le_bytes())
        .collect();
    std::fs::write(folder.join("b c.bin"), &buffer).unwrap();
    let gltf = r#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],
        "bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"uri":"b%20c.bin","byteLength":36}]}"#;
    std::fs::write(folder.join("a.gltf"), gltf).unwrap();
    let mut glb = [&b"glTF\x02\0\0\0"[..], &(20 + gltf.len() as u32).to_le_bytes()].concat();
    glb.extend([&(gltf.len() as u32).to_le_bytes(), &b"JSON"[..], gltf.as_bytes()].concat());
    std::fs::write(folder.join("a.glb"), glb).unwrap();
    for input in ["a.gltf", "a.glb"] {
        done(&folder, &["info", input]);
        let expected = format!("the input b c.bin of {input}");
        refused(
            &folder,
            &["detect", input, "--map", "b c.bin", "--force"],
            &["b c.bin would be both", &expected],
        );
    }
    refused(&folder, &["detect", "a.gltf", "--json", "./b c.bin", "--force"], &["b c.bin would be both"]);
    assert_eq!(std::fs::read(folder.join("b c.bin")).unwrap(), buffer);
}

#[test]
fn a_strangers_file_is_replaced_only_by_force() {
    let folder = with_meshes("strangers", &["a.off"]);
    for (flag, name) in
        [("-o", "x.ply"), ("-o", "x.glb"), ("--map", "x.map"), ("--json", "x.json"), ("--picture", "x.png")]
    {
        let path = folder.join(name);
        std::fs::write(&path, "1\n0\n").unwrap();
        refused(&folder, &["detect", "a.off", flag, name], &[name, "--force"]);
        assert_eq!(std::fs::read(&path).unwrap(), b"1\n0\n");
        done(&folder, &["detect", "a.off", flag, name, "--force"]);
        assert_ne!(std::fs::read(&path).unwrap(), b"1\n0\n");
    }
    std::fs::write(folder.join("x.npz"), "mine").unwrap();
    refused(&folder, &["eigen", "a.off", "-k", "2", "-o", "x.npz"], &["x.npz", "--force"]);
    let named = ["eigen", "a.off", "-k", "2", "-o", "x.npz", "--force"];
    done(&folder, &named);
    done(&folder, &named[..6]);
    std::fs::create_dir(folder.join("folder")).unwrap();
    refused(&folder, &["detect", "a.off", "--map", "folder", "--force"], &["folder is a folder"]);
}

#[test]
fn results_of_an_earlier_run_are_replaced_and_those_that_stay_are_named() {
    let folder = with_meshes("earlier", &["a.off", "b.off"]);
    let write_all = ["detect", "a.off", "b.off", "--output-dir", "out", "--write", "map,ply,json,png"];
    done(&folder, &[&write_all[..], &["--symmetries", "2"]].concat());
    let listed = std::fs::read_to_string(folder.join("out/a.json")).unwrap();
    assert!(listed.contains("a_2.map"), "two symmetries are needed here: {listed}");
    let output = done(&folder, &["detect", "a.off", "--output-dir", "out"]);
    for expected in ["wrote out/a.map", "left by an earlier run: out/a_2.map", "earlier run: out/a.png"] {
        assert!(stdout(&output).contains(expected), "{expected} is missing in {}", stdout(&output));
    }
    assert!(!stdout(&output).contains("earlier run: out/a.map"), "{}", stdout(&output));
    assert!(stderr(&output).contains("an earlier run on other meshes, as out/b.json"), "{}", stderr(&output));
    std::fs::write(folder.join("b.off"), "OFF\n3 1 0\n").unwrap();
    let output = run_in(&folder, &["detect", "b.off", "--output-dir", "out"]);
    assert_eq!(output.status.code(), FAILED);
    assert!(
        stderr(&output).contains("b.off; left by an earlier run: out/b.ply, out/b.map"),
        "{}",
        stderr(&output)
    );
}

#[test]
fn results_that_two_runs_have_left_are_replaced_by_a_third() {
    let folder = with_meshes("left_twice", &["a.off"]);
    let run = |most: &str| {
        done(&folder, &["detect", "a.off", "--map", "w.map", "--json", "w.json", "--symmetries", most])
    };
    run("3");
    assert!(folder.join("w_3.map").is_file(), "three symmetries are needed here: {:?}", names(&folder));
    run("1");
    let output = run("2");
    assert!(stdout(&output).contains("left by an earlier run: w_3.map"), "{}", stdout(&output));
    run("3");
}

#[test]
fn a_report_that_was_copied_speaks_of_the_files_where_it_was_written() {
    let folder = with_meshes("copied_report", &["a.off"]);
    let both = ["detect", "a.off", "--map", "x.map", "--json", "x.json"];
    done(&folder, &both);
    let other = folder.join("other");
    std::fs::create_dir(&other).unwrap();
    for file in ["a.off", "x.json"] {
        std::fs::copy(folder.join(file), other.join(file)).unwrap();
    }
    std::fs::write(other.join("x.map"), "1\n0\n2\n3\n").unwrap();
    refused(&other, &both, &["x.map exists, and nothing shows that an earlier run wrote it"]);
    done(&folder, &["detect", "a.off", "--map", "./x.map", "--json", "../copied_report/x.json"]);
}

#[test]
fn a_map_that_no_report_lists_is_a_strangers() {
    let folder = with_meshes("lone_map", &["a.off"]);
    done(&folder, &["detect", "a.off", "--map", "a.map"]);
    refused(&folder, &["detect", "a.off", "--map", "a.map"], &["nothing shows that an earlier run wrote it"]);
    let both = ["detect", "a.off", "--map", "a.map", "--json", "a.json"];
    done(&folder, &[&both[..], &["--force"]].concat());
    done(&folder, &both);
}

#[cfg(target_os = "linux")]
#[test]
fn a_report_may_go_into_a_pipe() {
    let folder = with_meshes("report_into_pipe", &["a.off"]);
    let arguments = ["detect", "a.off", "--json", "/dev/stdout", "--quiet"];
    let output = command().current_dir(&folder).args(arguments).output().unwrap();
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(report["outcome"].is_string(), "{report}");
}

#[test]
fn a_full_disk_behind_stdout_is_an_error() {
    let folder = with_meshes("full", &["a.off", "b.off"]);
    for arguments in [
        &["info", "a.off"][..],
        &["detect", "a.off"],
        &["detect", "a.off", "b.off"],
        &["eigen", "a.off", "-k", "2"],
    ] {
        let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        let child = command()
            .current_dir(&folder)
            .args(arguments)
            .stdout(full)
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), FAILED, "{arguments:?}");
        assert!(stderr(&output).contains("standard output cannot be written"), "{}", stderr(&output));
        assert_eq!(stderr(&output).lines().count(), 1, "{}", stderr(&output));
    }
}

#[cfg(unix)]
#[test]
fn a_closed_pipe_ends_a_run_quietly() {
    let folder = with_meshes("closed", &["a.off"]);
    let mut child = command()
        .current_dir(&folder)
        .args(["info", "a.off"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .stdin(Stdio::null())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let mut said = String::new();
    child.stderr.take().unwrap().read_to_string(&mut said).unwrap();
    // The pipe is closed long before a process has started; if not, all was read.
    let status = child.wait().unwrap().code();
    assert!([Some(141), FOUND].contains(&status) && said.is_empty(), "{status:?} {said}");
}

#[cfg(target_os = "linux")]
#[test]
fn names_need_not_be_text() {
    use std::os::unix::ffi::OsStrExt;
    let folder = with_meshes("bytes", &["a.off"]);
    let name = |extension: &str| [b"out\xff.", extension.as_bytes()].concat();
    for (flag, extension) in
        [("-o", "ply"), ("-o", "glb"), ("--map", "map"), ("--json", "json"), ("--picture", "png")]
    {
        let name = name(extension);
        let path = OsStr::from_bytes(&name);
        let output = run_in(&folder, &[OsStr::new("detect"), OsStr::new("a.off"), OsStr::new(flag), path]);
        assert!([FOUND, NONE].contains(&output.status.code()), "{}", stderr(&output));
        assert!(folder.join(path).is_file());
    }
    let wrong = OsStr::from_bytes(b"out\xff.obj");
    let output = run_in(&folder, &[OsStr::new("detect"), OsStr::new("a.off"), OsStr::new("-o"), wrong]);
    assert_eq!(output.status.code(), FAILED);
}

#[test]
fn what_the_reader_skipped_is_said() {
    let folder = folder("skipped");
    let faces = "v 1 1 1\nv 1 -1 -1\nv -1 1 -1\nv -1 -1 1.2\nf 1 3 2\nf 1 2 4\nf 2 3 4\nface 3 1 4\n";
    std::fs::write(folder.join("a.obj"), faces).unwrap();
    let output = done(&folder, &["detect", "a.obj"]);
    assert!(stdout(&output).contains("1 lines begin with a word that is not known"), "{}", stdout(&output));
}

/// [`MESH`] of another size, in another place.
fn moved(scale: f64, [x, y, z]: [f64; 3]) -> String {
    let place = |line: &str| {
        let at: Vec<f64> = line.split(' ').map(|number| number.parse().unwrap()).collect();
        format!("{:e} {:e} {:e}\n", x + scale * at[0], y + scale * at[1], z + scale * at[2])
    };
    let lines: Vec<&str> = MESH.lines().collect();
    let vertices: String = lines[2..6].iter().map(|line| place(line)).collect();
    format!("{}\n{}\n{vertices}{}\n", lines[0], lines[1], lines[6..].join("\n"))
}

#[test]
fn a_glb_holds_the_shape_wherever_it_lies_or_is_refused() {
    let folder = folder("far");
    let extent = |file: &str| -> Vec<f64> {
        let facts: serde_json::Value =
            serde_json::from_slice(&done(&folder, &["info", file, "--json"]).stdout).unwrap();
        facts["extent"].as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect()
    };
    for scale in [0.05, 100.0] {
        std::fs::write(folder.join("a.off"), moved(scale, [500_000.0, 5_400_000.0, 7.0])).unwrap();
        done(&folder, &["detect", "a.off", "-o", "a.glb", "--map", "a.map", "--force"]);
        let (was, is) = (extent("a.off"), extent("a.glb"));
        let worst = was.iter().zip(&is).map(|(was, is)| (was - is).abs()).fold(0.0, f64::max);
        assert!(worst < 1e-6 * scale, "{was:?} {is:?}");
        done(&folder, &["detect", "a.glb", "--map", "b.map", "--force"]);
        assert_eq!(numbers(&folder.join("a.map")), numbers(&folder.join("b.map")));
    }
    for (scale, place) in [(1e39, 0.0), (1e36, 1e39), (1e-100, 0.0)] {
        std::fs::write(folder.join("b.off"), moved(scale, [place; 3])).unwrap();
        let expected = ["single precision", "write a .ply"];
        refused(&folder, &["detect", "b.off", "-o", "b.glb", "--plausibility", "0"], &expected);
    }
}

#[test]
fn a_glb_is_read_written_and_known_again() {
    let folder = with_meshes("glb", &["a.off"]);
    done(&folder, &["detect", "a.off", "-o", "b.glb", "--map", "a.map"]);
    let again = ["detect", "b.glb", "-o", "c.GLB", "--map", "b.map"];
    done(&folder, &again);
    assert_eq!(std::fs::read(folder.join("a.map")).unwrap(), std::fs::read(folder.join("b.map")).unwrap());
    done(&folder, &again[..4]);
    done(&folder, &["detect", "b.glb", "--output-dir", "out", "--write", "glb"]);
    assert_eq!(names(&folder.join("out")), ["b.glb"]);
    done(&folder, &["detect", "b.glb", "--output-dir", "out", "--write", "glb"]);
    refused(&folder, &["detect", "b.glb", "-o", "b.glb", "--force"], &["the input b.glb"]);
    refused(
        &folder,
        &["info", "b.glb", "--animation", "run"],
        &["no animation is named \"run\"; the file has: none"],
    );
    refused(&folder, &["info", "a.off", "--animation", "run", "--time", "1"], &["OFF has no animations"]);
    refused(&folder, &["info", "b.glb", "--time", "1"], &["--animation"]);
}
