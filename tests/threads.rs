//! Never more threads than the caller asked for: those of a detection are counted while it runs.
#![cfg(target_os = "linux")]

mod support;

use intrinsym::{Options, Outcome, Progress, detect};
use std::fs;
use std::thread;
use std::time::Duration;
use support::*;

/// Threads have the name of the one that started them, unless they are given another.
const NAME: &str = "detecting";

/// The flag of a thread that is ending (`PF_EXITING` of Linux's `include/linux/sched.h`). It is set before whoever waits
/// for the thread goes on, while the thread itself may be listed for a while yet.
const ENDING: u32 = 0x4;

/// How many threads there are now that a detection runs on.
///
/// All are listed before the first is read, so that those counted were there at the same time.
fn running() -> usize {
    let tasks = fs::read_dir("/proc/self/task").expect("the process's threads");
    let tasks: Vec<_> = tasks.flatten().map(|task| task.path().join("stat")).collect();
    // A thread that ended meanwhile has no state any more.
    tasks
        .iter()
        .filter_map(|stat| fs::read_to_string(stat).ok())
        .filter(|stat| runs_a_detection(stat))
        .count()
}

/// Whether a line of `/proc/self/task/ID/stat` (proc(5)) is that of a thread of a detection, and one not ending.
fn runs_a_detection(stat: &str) -> bool {
    let (id_and_name, fields) = stat.rsplit_once(')').expect("a name in parentheses");
    let flags = fields.split_whitespace().nth(6).expect("flags").parse::<u32>().expect("a number");
    id_and_name.ends_with(&format!("({NAME}")) && flags & ENDING == 0
}

#[test]
fn a_detection_runs_on_as_many_threads_as_asked_for_and_on_no_more() {
    let mesh = validated(&twisted_creature(30));
    // On the mesh itself and on a proxy. No plane mirrors it: that needs no threads.
    for proxy_vertices in [15_000, 2_000] {
        for threads in 1..=3 {
            let options = Options { threads, proxy_vertices, eigenfunctions: 50, ..Options::default() };
            let most = thread::scope(|scope| {
                let work = || detect(&mesh, &options, &Progress::default()).unwrap().outcome;
                let detection = thread::Builder::new().name(NAME.into()).spawn_scoped(scope, work).unwrap();
                let mut most = 0;
                while !detection.is_finished() {
                    most = most.max(running());
                    thread::sleep(Duration::from_micros(200));
                }
                assert_eq!(detection.join().unwrap(), Outcome::Found);
                most
            });
            assert_eq!(most, threads, "proxy of {proxy_vertices}");
        }
    }
}
