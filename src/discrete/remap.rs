//! What a scene names follows every discrete change of a track, or the change may not happen.
//!
//! Source: Kim et al. 2009, §5.2; rules of protection as in its §5.3, made precise.

use crate::constraint::{Constraint, ConstraintKind, Instant, Moment, When};
use crate::index::{CharacterId, floor_index};
use crate::scene::Scene;
use crate::track::{Keep, Splice};

/// The scene with every moment bound to the track frame that shows it now, so that it stays with that frame where copies
/// of it come and go.
pub fn bound(mut scene: Scene) -> Scene {
    let tracks: Vec<_> = scene.characters.iter().map(|character| character.track.clone()).collect();
    for moment in scene.moments_mut() {
        let track = &tracks[moment.character.as_usize()];
        moment.instant = track.locate(moment.instant).map_or(moment.instant, Instant::Shown);
    }
    scene
}

/// Frames of a character's track that a splice must keep, each with its neighbours in place: they are parts of rows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Protected {
    /// First and last frame of each stretch that must stay together, rising.
    pub stretches: Vec<(usize, usize)>,
    /// Frames that moments name, fractions.
    pub moments: Vec<f64>,
}

/// What `scene`, whose moments are bound, protects on the track of `character`: the first and the last frame; frames of
/// instants, with one on either side where a row reads the direction there; the ends of intervals, with one on either side; the
/// ends of the times in which changes may happen.
/// Cost: linear in moments.
pub fn protected(scene: &Scene, character: CharacterId) -> Protected {
    let last = scene.characters[character.as_usize()].track.frame_count() - 1;
    let mut stretches = vec![(0, 0), (last, last)];
    let mut moments = Vec::new();
    let mut protect = |moment: &Moment, reach: usize| {
        if let (true, Instant::Shown(frame)) = (moment.character == character, moment.instant) {
            let (low, high) = (floor_index(frame), floor_index(frame.ceil()));
            stretches.push((low.saturating_sub(reach), (high + reach).min(last)));
            moments.push(frame);
        }
    };
    for constraint in &scene.constraints {
        constraint.kind.moments().into_iter().for_each(|moment| protect(moment, reach_of(constraint)));
    }
    let carried = scene.carries.iter().flat_map(|carry| [&carry.during.0, &carry.during.1]);
    carried.for_each(|moment| protect(moment, 1));
    scene.end_effectors.iter().flat_map(|effector| effector.moments()).for_each(|moment| protect(moment, 1));
    let windows = scene.discrete.iter().flat_map(|discrete| discrete.times.iter().flatten());
    windows.flat_map(|(from, to)| [from, to]).for_each(|moment| protect(moment, 0));
    stretches.sort_unstable();
    stretches.dedup();
    moments.sort_unstable_by(f64::total_cmp);
    Protected { stretches, moments }
}

/// How many frames on either side of a constraint's moments belong to its rows.
fn reach_of(constraint: &Constraint) -> usize {
    let interval = |when: &When| matches!(when, When::During(..));
    let wide = match &constraint.kind {
        ConstraintKind::Pin { when, facing, .. } => facing.is_some() || interval(when),
        ConstraintKind::Relative { .. } => true,
        ConstraintKind::Sync { moments, .. } => moments.iter().any(interval),
        ConstraintKind::Time { .. } | ConstraintKind::Duration { .. } => false,
    };
    usize::from(wide)
}

impl Protected {
    /// Whether every protected stretch stays together under `splice`.
    pub fn allow(&self, splice: &Splice, keep: Keep) -> bool {
        self.stretches.iter().all(|(first, last)| match (splice.map(*first, keep), splice.map(*last, keep)) {
            (Some(a), Some(b)) => b - a == last - first,
            _ => false,
        })
    }

    /// How many ends of protected stretches lie up to each of `count` frames: none of those may go.
    pub fn ends_up_to(&self, count: usize) -> Vec<usize> {
        let mut ends = vec![0; count];
        let all = self.stretches.iter().flat_map(|(first, last)| [*first, *last]);
        all.filter(|end| *end < count).for_each(|end| ends[end] += 1);
        for frame in 1..count {
            ends[frame] += ends[frame - 1];
        }
        ends
    }

    /// Whether the two copies of frames that `splice` shows twice differ in what is named on them.
    pub fn tell_copies_apart(&self, splice: &Splice) -> bool {
        splice.resume <= splice.after
            && self
                .moments
                .iter()
                .any(|frame| (splice.resume as f64 - 1.0..=splice.after as f64 + 1.0).contains(frame))
    }
}

/// The scene with `splice` on the track of `character`, and all moments of that track where their frames went; `None` where
/// one is torn apart or taken out. What constraints ask 'as before' stays what it was before all discrete edits.
pub fn spliced(scene: &Scene, character: CharacterId, splice: &Splice, keep: Keep) -> Option<Scene> {
    let mut next = scene.clone();
    let moved = moved(&mut next, character, (splice, keep))?.1;
    take(&mut next, character, &moved);
    let track = &mut next.characters[character.as_usize()].track;
    *track = track.spliced(splice);
    Some(next)
}

/// What `work` makes of the scene as [`spliced`] would have it, without a copy of all else: afterwards it is as it was.
/// Cost: that of the track, its moments, and one look at each constraint.
pub fn while_spliced<T>(
    scene: &mut Scene,
    character: CharacterId,
    (splice, keep): (&Splice, Keep),
    work: impl FnOnce(&Scene) -> T,
) -> Option<T> {
    let (before, moved) = moved(scene, character, (splice, keep))?;
    let track = scene.characters[character.as_usize()].track.clone();
    scene.characters[character.as_usize()].track = track.spliced(splice);
    take(scene, character, &moved);
    let done = work(scene);
    take(scene, character, &before);
    scene.characters[character.as_usize()].track = track;
    Some(done)
}

/// Instants of a character's moments, before and after a splice; `None` where one goes nowhere.
fn moved(
    scene: &mut Scene,
    character: CharacterId,
    (splice, keep): (&Splice, Keep),
) -> Option<(Vec<Instant>, Vec<Instant>)> {
    let before: Vec<Instant> = scene.moments_of_mut(character).map(|moment| moment.instant).collect();
    let moved = |instant: &Instant| match instant {
        Instant::Shown(frame) => splice.map_instant(*frame, keep).map(Instant::Shown),
        other => Some(*other),
    };
    let after = before.iter().map(moved).collect::<Option<_>>()?;
    Some((before, after))
}

fn take(scene: &mut Scene, character: CharacterId, instants: &[Instant]) {
    scene.moments_of_mut(character).zip(instants).for_each(|(moment, instant)| moment.instant = *instant);
}
