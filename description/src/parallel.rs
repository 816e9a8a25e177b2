//! Work at the same time: the same for many items, or two works. Results have the order of the items, so that nothing depends on threads.

use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::sync::OnceLock;

/// As much stack as the main thread of a program has.
const STACK: usize = 8 << 20;

/// The result of `of` for each item, on as many threads as there are processors; the last items, which take longest, first.
pub fn parallel_map<T: Sync, R: Send + Sync>(items: &[T], of: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let results: Vec<OnceLock<R>> = items.iter().map(|_| OnceLock::new()).collect();
    for_each_index(items.len(), &|i| {
        results[i].get_or_init(|| of(&items[i]));
    });
    results.into_iter().map(|result| result.into_inner().expect("every item is taken")).collect()
}

/// Compiled once, whatever the items are.
fn for_each_index(count: usize, of: &(dyn Fn(usize) + Sync)) {
    let left = AtomicUsize::new(count);
    let work = || {
        let next = || left.fetch_update(Relaxed, Relaxed, |left| left.checked_sub(1)).ok();
        while let Some(before) = next() {
            of(before - 1);
        }
    };
    std::thread::scope(|scope| {
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        // Where there are no more threads, those that there are do the work.
        let spawned = |_| std::thread::Builder::new().stack_size(STACK).spawn_scoped(scope, work).ok();
        let beside: Vec<_> = (1..threads.min(count)).filter_map(spawned).collect();
        work();
        beside.into_iter().for_each(joined);
    });
}

/// The result of a thread; its panic continues here, with its message.
fn joined<R>(thread: std::thread::ScopedJoinHandle<'_, R>) -> R {
    thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
}

/// The results of both, found at the same time where there is a second thread.
pub fn both<A: Send, B>(first: impl Fn() -> A + Sync, second: impl FnOnce() -> B) -> (A, B) {
    std::thread::scope(|scope| {
        let beside = std::thread::Builder::new().stack_size(STACK).spawn_scoped(scope, &first).ok();
        let second = second();
        let first = beside.map_or_else(&first, joined);
        (first, second)
    })
}
