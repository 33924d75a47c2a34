//! What-ifs in time: one track of a group has other frames, which changes the number of steps of one stretch between its
//! constrained frames at most. Times and energy follow from the present solution, without solving again.

use cotillion_solvers::{Restepped, StepResponse};

use super::{BOUND_TOLERANCE, TemporalComponent};
use crate::clip::working::WORKING_STEP;
use crate::edit::settings::Backend;
use crate::edit::time_row::{TimePoint, TimeRow};
use crate::path::bracket;

/// Moments lie at the same place between their frames if shares differ by no more than this, which is rounding.
const SAME_SHARE: f64 = 1e-12;

/// Times of a group of tracks of which one has other frames.
pub struct Retimed<'a> {
    present: &'a TemporalComponent,
    /// Which track, and how many frames it has.
    track: (usize, usize),
    /// Its constrained frames.
    knots: Vec<usize>,
    /// Times of the constrained frames of all tracks, seconds.
    seconds: Vec<f64>,
    /// `½‖M t − m‖²`, soft constraints included, s².
    pub energy: f64,
}

impl TemporalComponent {
    /// The group with `count` frames in track `track`. `rows`: those of its rows that name the track, as they are and as they
    /// are to be, in the same order. `None` where more would change than one stretch, or steps would be out of bounds. Cost:
    /// linear in rows; a substitution the first time that a stretch changes.
    pub fn retimed<'a>(
        &'a self,
        (track, count): (usize, usize),
        rows: (impl Iterator<Item = &'a TimeRow>, &[TimeRow]),
    ) -> Option<Retimed<'a>> {
        if self.active_steps > 0 || self.settings.backend != Backend::Reduced || self.kept.is_some() {
            return None;
        }
        let (first, before) = self.network.knots(track);
        let knots = moved_knots(before, &pairs(rows, track, [self.counts[track], count])?)?;
        // A group without an absolute time stays where it is by a constrained frame.
        let is_held = self.network.problem.hard.rows() == self.network.kept.len();
        if *knots.last()? >= count || (!is_held && knots[0] != before[0]) {
            return None;
        }
        let mut retimed = Retimed {
            present: self,
            track: (track, count),
            knots,
            seconds: self.knot_times(),
            energy: self.energy.0 + self.energy.1,
        };
        let longer = |at: &usize| retimed.knots[at + 1] - retimed.knots[*at] != before[at + 1] - before[*at];
        let mut changed = (0..before.len() - 1).filter(longer);
        if let Some(at) = changed.next() {
            let steps = retimed.knots[at + 1] - retimed.knots[at];
            let piece = self.network.pieces.partition_point(|piece| piece.from < first + at);
            if changed.next().is_some() || self.network.pieces[piece].weight != 1.0 {
                return None;
            }
            let response = self.step_response(piece)?;
            let Restepped { energy, moved } =
                response.restepped(&self.network, (&self.x, retimed.energy), steps);
            retimed
                .seconds
                .iter_mut()
                .zip(response.answer())
                .for_each(|(time, answer)| *time += moved * answer);
            retimed.energy = energy;
        }
        retimed.keeps_bounds().then_some(retimed)
    }

    fn step_response(&self, piece: usize) -> Option<&StepResponse> {
        let make = || {
            let (factor, _) = self.factor.as_ref()?;
            StepResponse::new(&self.network, factor, piece, &mut factor.workspace()).ok()
        };
        self.responses[piece].get_or_init(make).as_ref()
    }

    /// Present times of all constrained frames, seconds.
    fn knot_times(&self) -> Vec<f64> {
        let mut times = self.x.clone();
        for track in 0..self.counts.len() {
            let (first, knots) = self.network.knots(track);
            for (time, knot) in times[first..].iter_mut().zip(knots) {
                *time += *knot as f64 * WORKING_STEP;
            }
        }
        times
    }
}

impl Retimed<'_> {
    /// Constrained frames of a track, and their times.
    fn knots(&self, track: usize) -> (&[usize], &[f64]) {
        let (first, knots) = self.present.network.knots(track);
        let knots = if track == self.track.0 { &self.knots } else { knots };
        (knots, &self.seconds[first..first + knots.len()])
    }

    fn count(&self, track: usize) -> usize {
        if track == self.track.0 { self.track.1 } else { self.present.counts[track] }
    }

    /// Whether time goes on in all tracks, no slower and no faster than it may.
    fn keeps_bounds(&self) -> bool {
        (0..self.present.counts.len()).all(|track| {
            let (knots, times) = self.knots(track);
            knots.windows(2).zip(times.windows(2)).all(|(knots, times)| {
                let step = (times[1] - times[0]) / ((knots[1] - knots[0]) as f64 * WORKING_STEP);
                let slack = BOUND_TOLERANCE;
                let allowed = self.present.settings.bounds;
                step > 0.0 && allowed.is_none_or(|own| step >= own.min - slack && step <= own.max + slack)
            })
        })
    }

    /// When a frame of a track is shown, seconds; frames may lie between two, and beyond the last.
    pub fn time(&self, track: usize, frame: f64) -> f64 {
        let (low, high, share) = bracket(frame, self.count(track));
        let at_low = self.frame_time(track, low);
        at_low + share * (self.frame_time(track, high) - at_low)
    }

    fn frame_time(&self, track: usize, frame: usize) -> f64 {
        let (knots, times) = self.knots(track);
        let after = knots.partition_point(|knot| *knot <= frame);
        let on_from = |place: usize| times[place] + (frame as f64 - knots[place] as f64) * WORKING_STEP;
        match after {
            0 => on_from(0),
            all if all == knots.len() => on_from(all - 1),
            _ => {
                let share = (frame - knots[after - 1]) as f64 / (knots[after] - knots[after - 1]) as f64;
                times[after - 1] + share * (times[after] - times[after - 1])
            }
        }
    }

    /// Seconds from the first to the last frame of each track.
    pub fn durations(&self) -> Vec<f64> {
        let own = |track: usize| self.frame_time(track, self.count(track) - 1) - self.frame_time(track, 0);
        (0..self.present.counts.len()).map(own).collect()
    }
}

/// Frames that rows touch on a track, before and after; `None` where rows are not the same but for that. `counts`: how many
/// frames the track has, before and after.
fn pairs<'a>(
    (before, after): (impl Iterator<Item = &'a TimeRow>, &[TimeRow]),
    track: usize,
    counts: [usize; 2],
) -> Option<Vec<(usize, usize)>> {
    let mut pairs = Vec::with_capacity(2 * after.len());
    let mut rest = after.iter();
    for old in before {
        let new = rest.next()?;
        let alike = (old.constraint, old.strength) == (new.constraint, new.strength)
            && old.seconds == new.seconds
            && old.minus.is_some() == new.minus.is_some();
        if !alike {
            return None;
        }
        for (old, new) in [(Some(old.at), Some(new.at)), (old.minus, new.minus)] {
            let (Some(old), Some(new)) = (old, new) else { continue };
            if old.track == track && new.track == track {
                pairs.extend(touched(old, new, counts)?.into_iter().flatten());
            } else if old != new {
                return None;
            }
        }
    }
    rest.next().is_none().then_some(pairs)
}

/// Frames that a moment lies on or between, before and after.
fn touched(old: TimePoint, new: TimePoint, counts: [usize; 2]) -> Option<[Option<(usize, usize)>; 2]> {
    let on_frame = |point: TimePoint, count: usize| match bracket(point.frame, count) {
        (_, high, 1.0) => (high, high, 0.0),
        bracket => bracket,
    };
    let (old, new) = (on_frame(old, counts[0]), on_frame(new, counts[1]));
    // Beyond the last frame a track goes on with a step of another weight.
    let inside = old.2 <= 1.0 && new.2 <= 1.0;
    let alike = inside && (old.2 - new.2).abs() <= SAME_SHARE && (old.2 == 0.0) == (new.2 == 0.0);
    alike.then_some([Some((old.0, new.0)), (old.2 != 0.0).then_some((old.1, new.1))])
}

/// Where constrained frames are, rising as before; `None` where they are not as many. `pairs`: frames before and after.
fn moved_knots(before: &[usize], pairs: &[(usize, usize)]) -> Option<Vec<usize>> {
    let mut moved: Vec<Option<usize>> = vec![None; before.len()];
    for (old, new) in pairs {
        let own = &mut moved[before.binary_search(old).ok()?];
        if own.is_some_and(|known| known != *new) {
            return None;
        }
        *own = Some(*new);
    }
    // A track that no row touches has its first frame.
    let untouched = pairs.is_empty() && before == [0];
    let moved: Vec<usize> = if untouched { vec![0] } else { moved.into_iter().collect::<Option<_>>()? };
    moved.is_sorted_by(|a, b| a < b).then_some(moved)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::constraint::Strength;
    use crate::edit::moved::time_of;
    use crate::edit::temporal::TemporalSettings;
    use crate::edit::time_row::StepBounds;
    use crate::index::{ConstraintId, floor_index};

    const COUNTS: [usize; 2] = [60, 45];

    /// Moments of a row as shares of their tracks, how late they are wanted, and the weight of a soft one.
    type Given = (usize, f64, Option<f64>, f64, Option<f64>);

    fn given() -> impl Strategy<Value = Vec<Given>> {
        let own = (
            0..2_usize,
            0.0..1.0_f64,
            prop::option::of(0.0..1.0_f64),
            -0.1..0.1_f64,
            prop::option::of(0.1..20.0_f64),
        );
        prop::collection::vec(own, 1..6)
    }

    /// Rows on whole frames and on frames between; `at_rest`: one holds the first frame of the first track.
    fn rows(given: &[Given], at_rest: bool) -> Vec<TimeRow> {
        let point = |track: usize, share: f64| {
            let frame = share * (COUNTS[track] - 1) as f64;
            TimePoint { track, frame: if track == 0 { frame.round() } else { frame } }
        };
        let row = |(index, own): (usize, &Given)| {
            let (track, share, minus, late, weight) = *own;
            let (at, minus) = (point(track, share), minus.map(|share| point(1 - track, share)));
            let apart = at.frame - minus.map_or(0.0, |minus| minus.frame);
            TimeRow {
                constraint: ConstraintId::from_usize(index),
                strength: weight.map_or(Strength::Hard, Strength::Soft),
                at,
                minus,
                seconds: apart * WORKING_STEP + late,
            }
        };
        let mut rows: Vec<TimeRow> = given.iter().enumerate().map(row).collect();
        rows.extend(at_rest.then(|| TimeRow {
            constraint: ConstraintId::from_usize(given.len()),
            strength: Strength::Hard,
            at: TimePoint { track: 0, frame: 0.0 },
            minus: None,
            seconds: 0.0,
        }));
        rows
    }

    fn solved(counts: [usize; 2], rows: &[TimeRow], bounds: Option<StepBounds>) -> Option<TemporalComponent> {
        let settings = TemporalSettings { bounds, ..TemporalSettings::default() };
        let mut component = TemporalComponent::new(counts.to_vec(), rows.to_vec(), settings);
        component.solve().ok().map(|()| component)
    }

    /// The rows after frames came (or went) after frame `after` of a track.
    fn spliced(rows: &[TimeRow], track: usize, (after, came): (usize, isize)) -> Vec<TimeRow> {
        let moved = |point: TimePoint| {
            let later = point.track == track && point.frame > after as f64;
            TimePoint { frame: point.frame + if later { came as f64 } else { 0.0 }, ..point }
        };
        rows.iter().map(|row| TimeRow { at: moved(row.at), minus: row.minus.map(moved), ..*row }).collect()
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 1000, max_global_rejects: 20_000, ..ProptestConfig::default() })]

        #[test]
        fn what_is_told_is_what_is_solved(
            (given, at_rest) in (given(), any::<bool>()),
            (track, after, came) in (0..2_usize, 0.0..1.0_f64, -12..30_isize),
            bounded in any::<bool>(),
        ) {
            let bounds = bounded.then_some(StepBounds { min: 0.5, max: 2.0 });
            let rows = rows(&given, at_rest);
            let Some(present) = solved(COUNTS, &rows, bounds) else { return Ok(()) };
            let after = floor_index(after * COUNTS[track] as f64);
            let touches = |point: &TimePoint| point.track == track && point.frame > after as f64 - 1.0 && point.frame < after as f64 + 13.0;
            let points = |row: &TimeRow| std::iter::once(row.at).chain(row.minus).collect::<Vec<_>>();
            prop_assume!(!rows.iter().flat_map(points).any(|point| touches(&point)) && after + 13 < COUNTS[track]);
            let after_it = spliced(&rows, track, (after, came));
            let mut counts = COUNTS;
            counts[track] = counts[track].checked_add_signed(came).expect("frames");
            let own = rows.iter().filter(|row| points(row).iter().any(|point| point.track == track));
            let own_after: Vec<TimeRow> = after_it.iter().filter(|row| points(row).iter().any(|point| point.track == track)).copied().collect();
            let told = present.retimed((track, counts[track]), (own, &own_after));
            let Some(full) = solved(counts, &after_it, bounds) else {
                prop_assert!(told.is_none(), "there is no solution");
                return Ok(());
            };
            let Some(told) = told else {
                let held = present.network.problem.hard.rows() == present.network.kept.len();
                let forward = full.times.iter().all(|own| own.windows(2).all(|pair| pair[0] < pair[1]));
                prop_assert!(!held || !forward || present.active_steps + full.active_steps > 0, "nothing forbids to tell");
                return Ok(());
            };
            let energy = full.energy.0 + full.energy.1;
            prop_assert!((told.energy - energy).abs() < 1e-10 * (1.0 + energy), "{} for {energy}", told.energy);
            for (track, times) in full.times.iter().enumerate() {
                prop_assert!((told.durations()[track] - (times[times.len() - 1] - times[0])).abs() < 1e-10);
                for frame in (0..=4 * times.len() + 4).map(|quarter| quarter as f64 * 0.25) {
                    let (own, expected) = (told.time(track, frame), time_of(times, frame));
                    prop_assert!((own - expected).abs() < 1e-10, "track {track}, frame {frame}: {own} is not {expected}");
                }
            }
        }
    }

    #[test]
    fn two_stretches_that_change_are_not_told() {
        let rows = rows(&[(0, 0.5, None, 0.1, None), (0, 1.0, None, 0.2, Some(1.0))], true);
        let present = solved(COUNTS, &rows, None).expect("times");
        let both = spliced(&spliced(&rows, 0, (40, 3)), 0, (10, 2));
        assert!(present.retimed((0, COUNTS[0] + 5), (rows.iter(), &both)).is_none());
        let one = spliced(&rows, 0, (40, 3));
        assert!(present.retimed((0, COUNTS[0] + 3), (rows.iter(), &one)).is_some());
        assert!(present.retimed((0, COUNTS[0] + 3), (rows.iter(), &one[1..])).is_none(), "a row is gone");
    }
}
