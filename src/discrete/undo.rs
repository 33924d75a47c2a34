//! Taking changes back: the inverse of every change whose frames are still together, exact, whatever the motion graph says.
//!
//! With it, a drag out and back ends with as many frames as it began. Source: ours; the published method can only lengthen
//! what its graph lets it shorten again.

use std::collections::BTreeSet;

use crate::constraint::ChangeKind;
use crate::discrete::candidates::{Candidate, Seen, outcome};
use crate::index::CharacterId;
use crate::track::{Keep, Splice, Stretch, Track};

/// A change of a track, with what it takes to undo it.
#[derive(Clone, Debug, PartialEq)]
pub struct Made {
    /// Of whose track.
    pub character: CharacterId,
    /// What was done.
    pub splice: Splice,
    /// Where moments on copied frames stayed.
    pub keep: Keep,
    /// What it took out.
    pub removed: Vec<Stretch>,
    /// Whether there is nothing to undo any more: it was undone, or undoes another.
    pub settled: bool,
}

/// Adds `candidate`, which is about to happen to `track` or just has, to the changes made so far. Whether it undoes one of
/// them.
pub fn record(made: &mut Vec<Made>, candidate: &Candidate, track: &Track) -> bool {
    let Candidate { character, splice, keep, .. } = candidate;
    let undone = (0..made.len())
        .find(|place| made[*place].character == *character && inverse(made, *place).as_ref() == Some(splice));
    if let Some(place) = undone {
        made[place].settled = true;
    }
    let removed = match splice.resume > splice.after + 1 {
        true => track.stretches(splice.after + 1, splice.resume - 1),
        false => Vec::new(),
    };
    let settled = undone.is_some();
    made.push(Made { character: *character, splice: splice.clone(), keep: *keep, removed, settled });
    settled
}

/// `found`, with what undoes changes of the same track in place of what leads to the same; at their end.
/// Cost: candidates times runs; changes made, squared, times the frames they brought.
pub fn with_undos(seen: &Seen<'_>, mut found: Vec<Candidate>, made: &[Made]) -> Vec<Candidate> {
    let own = (0..made.len()).filter(|place| made[*place].character == seen.character);
    let mut undos: Vec<Candidate> = own
        .filter_map(|place| inverse(made, place))
        .filter(|splice| seen.protected.allow(splice, Keep::First))
        .map(|splice| undo(seen.character, splice))
        .collect();
    if undos.is_empty() {
        return found;
    }
    let mut known = BTreeSet::new();
    undos.retain(|undo| known.insert(outcome(seen, undo)));
    found.retain(|candidate| !known.contains(&outcome(seen, candidate)));
    found.extend(undos);
    found
}

fn undo(character: CharacterId, splice: Splice) -> Candidate {
    let goes = splice.resume > splice.after + 1;
    let (kind, interval) = match (goes, splice.inserted.is_empty()) {
        (true, true) => (ChangeKind::Delete, (splice.after + 1, splice.resume - 1)),
        (true, false) => (ChangeKind::Replace, (splice.after + 1, splice.resume - 1)),
        (false, _) => (ChangeKind::Insert, (splice.after, splice.after)),
    };
    Candidate { character, kind, splice, keep: Keep::First, distance: 0.0, interval }
}

/// What undoes change `place` on the track as it is after all of `made`; `None` where that is done, or its frames or those
/// next to them are no longer together.
fn inverse(made: &[Made], place: usize) -> Option<Splice> {
    let change = &made[place];
    if change.settled {
        return None;
    }
    let (before, after) = around(change);
    let later: Vec<&Made> =
        made[place + 1..].iter().filter(|other| other.character == change.character).collect();
    let now = |frame: usize| later.iter().try_fold(frame, |frame, other| other.splice.map(frame, other.keep));
    let frames = (before..=after).map(now).collect::<Option<Vec<usize>>>()?;
    let together = frames.windows(2).all(|pair| pair[1] == pair[0] + 1);
    together.then(|| Splice {
        after: frames[0],
        inserted: change.removed.clone(),
        resume: frames[frames.len() - 1],
    })
}

/// Track frames right before and after those that a change brought, once it was made. Of frames shown twice, the copy
/// without moments is the new one.
fn around(change: &Made) -> (usize, usize) {
    let Splice { after, resume, .. } = change.splice;
    let copied = (after + 1).saturating_sub(resume);
    let first = if change.keep == Keep::Second && copied > 0 { resume } else { after + 1 };
    (first - 1, first + copied + change.splice.inserted_count())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::index::FrameIndex;

    fn made(splice: Splice, keep: Keep, removed: Vec<Stretch>) -> Made {
        Made { character: CharacterId(0), splice, keep, removed, settled: false }
    }

    fn stretch(first: usize, last: usize) -> Vec<Stretch> {
        vec![Stretch { entry: 0, first: FrameIndex::from_usize(first), last: FrameIndex::from_usize(last) }]
    }

    /// What a track shows after a splice, frames named by what they show.
    fn after(shown: &[usize], splice: &Splice) -> Vec<usize> {
        let inserted = splice.inserted.iter().flat_map(|s| s.first.as_usize()..=s.last.as_usize());
        let kept = shown[..=splice.after].iter().copied();
        kept.chain(inserted).chain(shown[splice.resume..].iter().copied()).collect()
    }

    fn all() -> Vec<Made> {
        vec![
            made(Splice::delete(3, 6), Keep::First, stretch(4, 6)),
            made(Splice::duplicate(3, 6), Keep::First, Vec::new()),
            made(Splice::duplicate(3, 6), Keep::Second, Vec::new()),
            made(Splice::insert(3, stretch(20, 24)), Keep::First, Vec::new()),
            made(Splice::replace(2, 5, stretch(20, 24)), Keep::First, stretch(3, 5)),
        ]
    }

    #[test]
    fn every_change_is_undone_exactly() {
        let frames: Vec<usize> = (0..10).collect();
        for change in all() {
            let changed = after(&frames, &change.splice);
            let undo = inverse(std::slice::from_ref(&change), 0).expect("nothing happened since");
            assert_eq!(after(&changed, &undo), frames, "{change:?}");
        }
    }

    /// `later`, made for the track after `change`, as it would be without that.
    fn without(later: &Splice, change: &Splice, count: usize) -> Splice {
        let back = |frame: usize| match frame > change.after {
            true => frame + count - change.new_count(count),
            false => frame,
        };
        Splice { after: back(later.after), inserted: later.inserted.clone(), resume: back(later.resume) }
    }

    #[test]
    fn changes_are_undone_in_any_order() {
        let frames: Vec<usize> = (0..40).collect();
        for change in all() {
            for later in [Splice::delete(0, 1), Splice::duplicate(20, 25)] {
                let now = after(&after(&frames, &change.splice), &later);
                let both = [change.clone(), made(later.clone(), Keep::First, Vec::new())];
                let undo = inverse(&both, 0).expect("they do not overlap");
                let expected = after(&frames, &without(&later, &change.splice, frames.len()));
                assert_eq!(after(&now, &undo), expected, "{change:?} {later:?}");
            }
        }
    }

    #[test]
    fn changes_whose_frames_are_torn_apart_stay() {
        let within = Splice::delete(3, 4);
        for change in all() {
            let brought_elsewhere = change.splice == Splice::duplicate(3, 6) && change.keep == Keep::First;
            let both = [change, made(within.clone(), Keep::First, Vec::new())];
            assert_eq!(inverse(&both, 0).is_some(), brought_elsewhere, "{both:?}");
        }
    }

    #[test]
    fn what_was_put_in_and_undone_is_not_in_the_way() {
        let mut all = vec![
            made(Splice::duplicate(3, 9), Keep::First, Vec::new()),
            made(Splice::insert(11, stretch(20, 24)), Keep::First, Vec::new()),
        ];
        assert_eq!(inverse(&all, 0), None);
        let undo = inverse(&all, 1).expect("nothing happened since");
        all[1].settled = true;
        all.push(Made { settled: true, ..made(undo, Keep::First, Vec::new()) });
        assert_eq!(inverse(&all, 0), Some(Splice::delete(9, 15)));
    }
}
