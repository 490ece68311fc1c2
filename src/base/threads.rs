//! Work shared by a few threads of one call: never more than the caller asked for, none kept between calls.

use std::sync::{Mutex, PoisonError};

/// `work(item)` of every item, in the items' order, on at most `threads` threads, the caller's among them.
///
/// Each thread takes the next item that nobody has taken. What is returned does not depend on `threads`, as long as
/// `work` does not. A panic of `work` goes on in the caller. Starting a thread costs some 30 microseconds.
pub fn map<T: Send, R: Send>(threads: usize, items: Vec<T>, work: impl Fn(T) -> R + Sync) -> Vec<R> {
    let helpers = threads.clamp(1, items.len().max(1)) - 1;
    if helpers == 0 {
        return items.into_iter().map(work).collect();
    }
    let waiting = Mutex::new(items.into_iter().enumerate());
    let take_all = || {
        let mut done = Vec::new();
        loop {
            let next = waiting.lock().unwrap_or_else(PoisonError::into_inner).next();
            let Some((index, item)) = next else { return done };
            done.push((index, work(item)));
        }
    };
    let mut done = std::thread::scope(|scope| {
        let started: Vec<_> = (0..helpers).map(|_| scope.spawn(take_all)).collect();
        let mut done = take_all();
        for thread in started {
            done.extend(thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
        }
        done
    });
    done.sort_unstable_by_key(|(index, _)| *index);
    done.into_iter().map(|(_, result)| result).collect()
}

/// Both results; the second on a thread of its own if there may be two.
pub fn join<A: Send, B: Send>(
    threads: usize,
    first: impl FnOnce() -> A,
    second: impl FnOnce() -> B + Send,
) -> (A, B) {
    if threads < 2 {
        return (first(), second());
    }
    std::thread::scope(|scope| {
        let other = scope.spawn(second);
        let own = first();
        (own, other.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
    })
}

/// `0..count` in at most `parts` ranges of nearly equal length.
pub fn ranges(count: usize, parts: usize) -> Vec<std::ops::Range<usize>> {
    let parts = parts.clamp(1, count.max(1));
    (0..parts).map(|part| part * count / parts..(part + 1) * count / parts).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;
    use std::thread::{ThreadId, current};

    #[test]
    fn results_keep_the_order_whatever_the_threads() {
        for threads in [0, 1, 2, 5, 100] {
            let squares = map(threads, (0..50u64).collect(), |i| i * i);
            assert_eq!(squares, (0..50).map(|i| i * i).collect::<Vec<u64>>());
        }
        assert!(map(3, Vec::<u8>::new(), |i| i).is_empty());
    }

    #[test]
    fn two_things_are_done_at_once_if_allowed() {
        for threads in [1, 2] {
            let (own, other) = join(threads, || current().id(), || current().id());
            assert_eq!((own, other != own), (current().id(), threads == 2));
        }
    }

    #[test]
    fn no_more_threads_than_asked_for() {
        let slow = |_| {
            std::thread::sleep(std::time::Duration::from_millis(2));
            current().id()
        };
        let used = |threads| map(threads, vec![(); 40], slow).into_iter().collect::<HashSet<ThreadId>>();
        assert_eq!(used(1), HashSet::from([current().id()]));
        assert!(used(3).len() <= 3 && used(3).contains(&current().id()));
    }

    #[test]
    #[should_panic(expected = "the seventh")]
    fn a_panic_reaches_the_caller() {
        map(2, (0..20).collect(), |i| assert!(i != 7, "the seventh"));
    }

    #[test]
    fn ranges_cover_everything_once() {
        for (count, parts) in [(0, 3), (1, 3), (10, 3), (12, 4)] {
            let all: Vec<usize> = ranges(count, parts).into_iter().flatten().collect();
            assert_eq!(all, (0..count).collect::<Vec<usize>>());
        }
    }
}
