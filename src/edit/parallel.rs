//! Work over paths and groups on all threads, where there is enough to do; the same result on any number of them.

use std::sync::Arc;

use rayon::prelude::*;

use crate::path::RestPath;

/// Fewer frames than this are done with before other threads have woken up.
const WORTH_THREADS: usize = 20_000;
/// A thread takes no fewer than about so many frames at once.
const SHARE: usize = 3_000;

/// How many of `count` pieces of work, together `frames` frames, a thread takes at once; `None`: one thread does all.
pub fn at_once(count: usize, frames: usize) -> Option<usize> {
    (frames > WORTH_THREADS).then(|| (count * SHARE / frames).max(1))
}

/// Calls `work` with the number of every path and what the two lists have of it.
pub fn for_each_path<A: Send, B: Send>(
    rests: &[Arc<RestPath>],
    first: &mut [A],
    second: &mut [B],
    work: impl Fn(usize, &mut A, &mut B) + Sync,
) {
    let frames = rests.iter().map(|rest| rest.len()).sum();
    let own = |(path, (first, second)): (usize, (&mut A, &mut B))| work(path, first, second);
    match at_once(rests.len(), frames) {
        Some(share) => first.par_iter_mut().zip(second).enumerate().with_min_len(share).for_each(own),
        None => first.iter_mut().zip(second).enumerate().for_each(own),
    }
}
