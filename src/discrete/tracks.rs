//! What discrete editing asks about a track: which frames may change, how far it was turned, how often it repeats itself.

use crate::geometry::{c64, wrap};
use crate::index::CharacterId;
use crate::scene::Scene;
use crate::track::Track;

/// Which frames of a character's track the scene lets change.
pub fn open(scene: &Scene, who: CharacterId) -> Vec<bool> {
    let track = &scene.characters[who.as_usize()].track;
    let count = track.frame_count();
    let Some(discrete) = &scene.discrete else { return vec![true; count] };
    if discrete.characters.as_ref().is_some_and(|named| !named.contains(&who)) {
        return vec![false; count];
    }
    let mut open = vec![true; count];
    if let Some(times) = &discrete.times {
        let own = times.iter().filter(|(from, _)| from.character == who);
        let spans: Vec<(f64, f64)> =
            own.map(|(from, to)| (scene.frame_of(from), scene.frame_of(to))).collect();
        for (frame, open) in open.iter_mut().enumerate() {
            *open = spans.iter().any(|(from, to)| (*from..=*to).contains(&(frame as f64)));
        }
    }
    if let Some(regions) = &discrete.regions {
        let places = track.collect(|clip, frame, placement| placement.apply(clip.positions[frame]));
        for (place, open) in places.iter().zip(&mut open) {
            let inside = |(low, high): &(c64, c64)| {
                (low.re..=high.re).contains(&place.re) && (low.im..=high.im).contains(&place.im)
            };
            *open &= regions.iter().any(inside);
        }
    }
    open
}

/// How the rest motion turns each entry of a track; entries that it does not show follow none.
pub fn rest_angles(track: &Track) -> Vec<f64> {
    track.runs.iter().map(|run| run.placement.angle()).collect()
}

/// Sum of the turns of what follows at every seam that discrete changes made, radians: by how much the run after it lies
/// turned to the one before it, more than they did before all changes.
pub fn turns(track: &Track, rest: &[f64]) -> f64 {
    let mut before = 0.0;
    let mut sum = 0.0;
    for run in track.runs.iter().filter(|run| run.entry < rest.len()) {
        let turned = run.placement.angle() - rest[run.entry];
        sum += wrap(turned - before).abs();
        before = turned;
    }
    sum
}

/// Graph clip, first and last frame of each stretch of frames of the track that follow each other in one clip; `clips`: graph
/// clip of each entry.
pub fn sequence(track: &Track, clips: &[usize]) -> Vec<(usize, u32, u32)> {
    let mut stretches: Vec<(usize, u32, u32)> = Vec::with_capacity(track.runs.len());
    for run in &track.runs {
        let own = (clips[run.entry], run.first.0, run.last.0);
        match stretches.last_mut() {
            Some(before) if before.0 == own.0 && before.2 + 1 == own.1 => before.2 = own.2,
            _ => stretches.push(own),
        }
    }
    stretches
}

/// How often one source frame is shown at most; `clips`: graph clip of each entry.
pub fn copies(track: &Track, clips: &[usize]) -> usize {
    let mut ends: Vec<(usize, u32, i32)> = Vec::new();
    for run in &track.runs {
        ends.push((clips[run.entry], run.first.0, 1));
        ends.push((clips[run.entry], run.last.0 + 1, -1));
    }
    ends.sort_unstable_by_key(|(clip, frame, change)| (*clip, *frame, *change));
    let mut shown = 0;
    let most = ends.iter().map(|(_, _, change)| {
        shown += change;
        shown
    });
    usize::try_from(most.max().unwrap_or(0)).unwrap_or(0)
}
