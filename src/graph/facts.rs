//! What a motion graph offers to the edits of one clip, in numbers.

use std::ops::RangeInclusive;

use super::MotionGraph;
use super::reach::largest_loop;
use crate::clip::gait::{feet_apart, gait};
use crate::clip::inspect::TransitionFacts;
use crate::clip::working::{WORKING_STEP, WorkingClip};
use crate::index::GraphFrame;
use crate::similarity::{NEIGHBOURS, moving};

/// Frames that an edit may take out or repeat at once: 0.3 to 2 s.
pub const EDITABLE: RangeInclusive<usize> = NEIGHBOURS..=60;
/// Phases nearer than this are the same, cycles.
const SAME_PHASE: f64 = 0.1;
/// Frames around a pair that it serves.
const SERVED: usize = 10;

/// A pair within one clip.
#[derive(Clone, Copy)]
struct Own {
    i: usize,
    j: usize,
}

/// Facts about the transitions of clip `clip` of `graph`, which is `working`, onto itself.
pub fn transition_facts(graph: &MotionGraph, clip: usize, working: &WorkingClip) -> TransitionFacts {
    let body = graph.bodies[graph.clips[clip].body];
    let all = own_pairs(graph, clip);
    let pairs: Vec<Own> = all.iter().copied().filter(|pair| EDITABLE.contains(&(pair.j - pair.i))).collect();
    let moves = moving(working);
    let (walking, idle): (Vec<&Own>, Vec<&Own>) =
        pairs.iter().partition(|pair| moves[pair.i] && moves[pair.j]);
    let gait = gait(&working.contacts, &moves);
    let phases: Vec<f64> = walking.iter().filter_map(|pair| gait.apart(pair.i, pair.j)).collect();
    let same = phases.iter().filter(|apart| **apart < SAME_PHASE).count();
    let frames = working.frame_count();
    let turns =
        pairs.iter().map(|pair| (working.headings[pair.j] - working.headings[pair.i]).to_degrees().abs());
    TransitionFacts {
        frames,
        median_distance: body.median,
        largest_distance: body.largest,
        all_pairs: all.len(),
        pairs: pairs.len(),
        per_second: pairs.len() as f64 / (frames as f64 * WORKING_STEP),
        idle: idle.len(),
        known_phase: phases.len(),
        whole_cycles: (!phases.is_empty()).then(|| same as f64 / phases.len() as f64),
        cycle: gait.cycle,
        feet_apart: gait.cycle.and_then(|_| largest_disagreement(working, &all)),
        turn_deg: median(turns.collect()),
        without: unserved(frames, &pairs),
        looping: largest_loop(graph, clip),
    }
}

/// The pairs that have both frames in the clip.
fn own_pairs(graph: &MotionGraph, clip: usize) -> Vec<Own> {
    let of = &graph.clips[clip];
    let first = of.first.as_usize();
    let after = |i: usize| {
        let similar = graph.similar_to(GraphFrame::from_usize(first + i)).map(|(j, _)| j.as_usize());
        similar
            .filter(move |j| (first + i + 1..first + of.frames).contains(j))
            .map(move |j| Own { i, j: j - first })
    };
    (0..of.frames).flat_map(after).collect()
}

/// Largest difference of how far the left foot is ahead of the right one, as a share of its range in the clip.
fn largest_disagreement(working: &WorkingClip, pairs: &[Own]) -> Option<f64> {
    let apart = feet_apart(working)?;
    let (low, high) =
        apart.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), s| (low.min(*s), high.max(*s)));
    let largest = pairs.iter().map(|pair| (apart[pair.i] - apart[pair.j]).abs()).reduce(f64::max)?;
    (high > low).then(|| largest / (high - low))
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

/// Frames that have no frame of any pair nearby.
fn unserved(frames: usize, pairs: &[Own]) -> usize {
    let mut served = vec![false; frames];
    for frame in pairs.iter().flat_map(|pair| [pair.i, pair.j]) {
        served[frame.saturating_sub(SERVED)..(frame + SERVED + 1).min(frames)].fill(true);
    }
    served.iter().filter(|served| !**served).count()
}
