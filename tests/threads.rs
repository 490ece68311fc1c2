//! Never more threads than the caller asked for: those of a detection are counted while it runs.
#![cfg(target_os = "linux")]

mod support;

use intrinsym::options::Options;
use intrinsym::pipeline::{Outcome, detect};
use intrinsym::progress::Progress;
use std::fs;
use std::thread;
use std::time::Duration;
use support::*;

/// Threads have the name of the one that started them, unless they are given another.
const NAME: &str = "detecting";

/// How many threads there are now that a detection runs on.
fn running() -> usize {
    let tasks = fs::read_dir("/proc/self/task").expect("the process's threads");
    // A thread that ends meanwhile has no name any more.
    let names = tasks.filter_map(|task| fs::read_to_string(task.ok()?.path().join("comm")).ok());
    names.filter(|name| name.trim_end() == NAME).count()
}

#[test]
fn a_detection_runs_on_as_many_threads_as_asked_for_and_on_no_more() {
    let mesh = validated(&creature_from(geodesic_sphere(30), 0.4));
    // On the mesh itself and on a proxy.
    for proxy_vertices in [15_000, 2_000] {
        for threads in 1..=3 {
            let options = Options { threads, proxy_vertices, eigenfunctions: 50, ..Options::default() };
            let most = thread::scope(|scope| {
                let work = || detect(&mesh, &options, &Progress::default()).unwrap().outcome;
                let detection = thread::Builder::new().name(NAME.into()).spawn_scoped(scope, work).unwrap();
                let (mut most, mut before) = (0, 0);
                while !detection.is_finished() {
                    // One that has just ended may be listed for a moment, but not twice.
                    let now = running();
                    most = most.max(now.min(before));
                    before = now;
                    thread::sleep(Duration::from_micros(200));
                }
                assert_eq!(detection.join().unwrap(), Outcome::Found);
                most
            });
            assert_eq!(most, threads, "proxy of {proxy_vertices}");
        }
    }
}
