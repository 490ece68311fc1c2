//! `info` and `eigen`.

use super::*;

#[test]
fn info_lists_the_shells() {
    let output = run(&["info".into(), example("human_shells.ply")]);
    assert_eq!(output.status.code(), FOUND);
    let text = stdout(&output);
    assert!(text.contains("Ply, 14136 vertices, 14022 faces (28044 triangles)"), "{text}");
    assert!(text.contains("10 shells"), "{text}");
}

#[test]
fn info_shows_a_small_mesh_with_its_digits() {
    let path = folder("small").join("triangle.off");
    std::fs::write(&path, "OFF\n3 1 0\n0 0 0\n2e-9 0 0\n0 3e-9 0\n3 0 1 2\n").unwrap();
    let text = stdout(&run(&["info".as_ref(), path.as_os_str()]));
    assert!(text.contains("3 vertices, 1 face (1 triangle)\n"), "{text}");
    assert!(text.contains("extent 2.000000e-9 x 3.000000e-9 x 0.000000, area 3.000000e-18\n"), "{text}");
    assert!(text.contains("3 points, 1 triangle, area 3.000000e-18, 3 boundary edges"), "{text}");
}

#[test]
fn info_as_json_holds_counts_and_lengths_in_the_files_unit() {
    let folder = folder("info");
    let path = folder.join("quad.off");
    // A rectangle of 2 x 3 with a vertex that nothing uses, far from the origin.
    std::fs::write(&path, "OFF\n5 1 0\n100 0 0\n102 0 0\n102 3 0\n100 3 0\n50 50 50\n4 0 1 2 3\n").unwrap();
    let output = run(&["info".as_ref(), path.as_os_str(), "--json".as_ref()]);
    assert_eq!(output.status.code(), FOUND, "{}", stderr(&output));
    let facts: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(facts["vertices"], 5);
    assert_eq!(facts["faces"], 1);
    assert_eq!(facts["repairs"]["unreferenced_vertices"], 1);
    assert_eq!(facts["shells"][0]["boundary_edges"], 4);
    assert!((facts["area"].as_f64().unwrap() - 6.0).abs() < 1e-9);
    assert!((facts["shells"][0]["area"].as_f64().unwrap() - 6.0).abs() < 1e-9);
    let extent: Vec<f64> = facts["extent"].as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect();
    for (found, expected) in extent.iter().zip([2.0, 3.0, 0.0]) {
        assert!((found - expected).abs() < 1e-9, "{extent:?}");
    }
}

/// A regular grid on the rectangle 2 x 1: its Neumann eigenvalues are pi^2 (m^2 / 4 + n^2), times the area 2.
#[test]
fn eigen_prints_the_eigenvalues_of_a_rectangle() {
    let folder = folder("eigen");
    let path = folder.join("grid.off");
    let (columns, rows) = (60, 30);
    let mut text = format!("OFF\n{} {} 0\n", (columns + 1) * (rows + 1), columns * rows);
    for j in 0..=rows {
        for i in 0..=columns {
            text += &format!(
                "{} {} 0\n",
                2.0 * f64::from(i) / f64::from(columns),
                f64::from(j) / f64::from(rows)
            );
        }
    }
    for j in 0..rows {
        for i in 0..columns {
            let corner = j * (columns + 1) + i;
            text += &format!("4 {corner} {} {} {}\n", corner + 1, corner + columns + 2, corner + columns + 1);
        }
    }
    std::fs::write(&path, text).unwrap();
    let output = run(&["eigen".as_ref(), path.as_os_str(), "-k".as_ref(), "4".as_ref()]);
    assert_eq!(output.status.code(), FOUND, "{}", stderr(&output));
    let found: Vec<f64> = stdout(&output).lines().map(|line| line.parse().unwrap()).collect();
    let expected = [0.25, 1.0, 1.0, 1.25].map(|sum| 2.0 * sum * std::f64::consts::PI.powi(2));
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        assert!((found / expected - 1.0).abs() < 0.01, "{found} is not near {expected}");
    }
}

#[test]
fn eigen_writes_a_numpy_archive_of_the_right_size() {
    let out = folder("archive").join("out.npz");
    let input = example("quadruped.ply");
    let arguments =
        ["eigen".as_ref(), input.as_os_str(), "-k".as_ref(), "7".as_ref(), "-o".as_ref(), out.as_os_str()];
    let output = run(&arguments);
    assert_eq!(output.status.code(), FOUND, "{}", stderr(&output));
    let bytes = std::fs::read(&out).unwrap();
    assert!(bytes.starts_with(b"PK\x03\x04"));
    let holds = |text: &str| bytes.windows(text.len()).any(|window| window == text.as_bytes());
    for (name, shape) in [("eigenvalues", "(7,)"), ("eigenfunctions", "(3398, 7)"), ("mass", "(3398,)")] {
        assert!(holds(&format!("{name}.npy")) && holds(&format!("'shape': {shape}")), "{name} {shape}");
    }
}
