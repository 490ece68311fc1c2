//! Hubs, fans, combs, slivers and soups are answered as any mesh is. Work that grows with the square of a degree shows here as a test
//! that does not end; how much there is of it is counted where it is done.

#[path = "support/hostile.rs"]
mod hostile;
mod support;

use hostile::SHAPES;
use intrinsym::{Options, Outcome, Progress, detect};
use support::{assert_keeps_its_contract, validated};

#[test]
fn every_shape_is_answered_at_any_size() {
    let options = Options { samples: 100, ..Options::default() };
    for (name, make) in SHAPES {
        for vertices in [1, 10, 100, 3000] {
            println!("{name}, {vertices} vertices");
            let mesh = validated(&make(vertices));
            let found = detect(&mesh, &options, &Progress::default()).expect("an answer");
            assert_keeps_its_contract(&mesh, &options, &found);
        }
    }
}

/// The largest part has a symmetry, which says nothing of the others.
#[test]
fn loose_parts_have_no_symmetry() {
    for (name, parts, make) in [
        ("tetrahedra", 4, hostile::tetrahedra as fn(usize) -> _),
        ("quads", 4, hostile::loose_quads),
        ("a soup", 3, hostile::soup),
    ] {
        let mesh = validated(&make(parts * 3000));
        assert_eq!(mesh.shell_count, 3000);
        let found = detect(&mesh, &Options::default(), &Progress::default()).expect("an answer");
        assert_eq!(found.outcome, Outcome::None, "{name}: {}", found.report.evidence());
        let any = Options { plausibility: 0, ..Options::default() };
        let found = detect(&mesh, &any, &Progress::default()).expect("an answer");
        assert_eq!(
            found.outcome,
            Outcome::Doubtful,
            "{name}: any map was asked for, and it has hardly any confidence"
        );
    }
}
