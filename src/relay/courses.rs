//! Where everybody of a relay is at what time, as clips last: what keeps people out of each other.

use std::collections::{BTreeMap, BTreeSet};

use super::acts::{Act, Place, STATURE};
use crate::clip::builtin::FPS;
use crate::geometry::{c64, cis};
use crate::index::floor_index;

/// Where somebody or something is: straight on from knot to knot, at rest before the first and after the last.
#[derive(Clone, Debug, PartialEq)]
pub struct Course {
    /// Seconds, rising, and where it is then, metres; one at least.
    pub knots: Vec<(f64, c64)>,
    /// Of the circle that it takes up, metres.
    pub radius: f64,
}

/// What a body takes up, metres: shoulders.
pub const BODY: f64 = 0.25;

/// Frames from one knot of a performed course to the next.
const KNOT: usize = 5;

/// The course of one as tall as `stature` who performs these acts one after the other, and is at `place` in `frame` of the act at
/// position `which`, at `time`.
pub fn performed(
    acts: &[&Act],
    (which, frame): (usize, usize),
    (place, time): (Place, f64),
    stature: f64,
) -> Course {
    let mut start = Place { position: c64::new(0.0, 0.0), facing: 0.0 };
    let (mut frames, mut positions) = (0.0, Vec::new());
    let mut anchor = (0.0, start);
    for (index, act) in acts.iter().enumerate() {
        if index == which {
            let turned = act.clip.headings[frame] - act.clip.headings[0];
            anchor = (
                frames + frame as f64,
                Place { position: act.at(start, frame), facing: start.facing + turned },
            );
        }
        let knots = (0..act.last()).step_by(KNOT).chain([act.last()]);
        positions.extend(knots.map(|frame| (frames + frame as f64, act.at(start, frame))));
        start = act.end(start);
        frames += act.last() as f64;
    }
    let turn = cis(place.facing - anchor.1.facing) * (stature / STATURE);
    let placed = |(frame, position): (f64, c64)| {
        (time + (frame - anchor.0) / FPS, place.position + (position - anchor.1.position) * turn)
    };
    Course { knots: positions.into_iter().map(placed).collect(), radius: BODY }
}

impl Course {
    /// What stays where it is.
    pub fn resting(position: c64, radius: f64) -> Self {
        Self { knots: vec![(0.0, position)], radius }
    }

    fn at(&self, time: f64) -> c64 {
        let next = self.knots.partition_point(|(knot, _)| *knot <= time);
        match (next.checked_sub(1).map(|last| self.knots[last]), self.knots.get(next).copied()) {
            (Some((from, a)), Some((to, b))) => a + (b - a) * ((time - from) / (to - from)),
            (Some((_, only)), None) | (None, Some((_, only))) => only,
            (None, None) => c64::new(0.0, 0.0),
        }
    }

    /// Cells of the plan within reach of it.
    fn cells(&self) -> BTreeSet<(usize, usize)> {
        let cell = |metres: f64| floor_index((metres + FAR) / CELL);
        let mut cells = BTreeSet::new();
        let last = self.knots.len() - 1;
        for (index, (_, from)) in self.knots.iter().enumerate() {
            let (_, to) = self.knots[(index + 1).min(last)];
            for x in cell(from.re.min(to.re) - REACH)..=cell(from.re.max(to.re) + REACH) {
                let rows = cell(from.im.min(to.im) - REACH)..=cell(from.im.max(to.im) + REACH);
                cells.extend(rows.map(|y| (x, y)));
            }
        }
        cells
    }
}

/// Courses are sorted into cells so wide, metres, each also into those within [`REACH`] of it.
const CELL: f64 = 4.0;
const REACH: f64 = 0.7;
/// All of the plan is within so many metres of the origin.
const FAR: f64 = 2e5;

/// Metres between what two take up, where they come nearest to each other at any one time, and that time, seconds; below 0 where
/// they are in each other. Cost: linear in knots.
pub fn gap(one: &Course, other: &Course) -> (f64, f64) {
    let mut times: Vec<f64> = one.knots.iter().chain(&other.knots).map(|(time, _)| *time).collect();
    times.sort_by(f64::total_cmp);
    let apart = |time: &f64| (*time, one.at(*time) - other.at(*time));
    let apart: Vec<(f64, c64)> = times.iter().map(apart).collect();
    let between = apart.windows(2).map(|pair| from_origin(pair[0], pair[1]));
    let first = (apart[0].1.norm(), apart[0].0);
    let (nearest, time) = between.fold(first, |least, own| if own.0 < least.0 { own } else { least });
    (nearest - one.radius - other.radius, time)
}

/// Distance of the origin from the line between two points, each with its time, and the time there.
fn from_origin((from, a): (f64, c64), (to, b): (f64, c64)) -> (f64, f64) {
    let way = b - a;
    let share = if way.norm_sqr() > 0.0 { -(a * way.conj()).re / way.norm_sqr() } else { 0.0 };
    let share = share.clamp(0.0, 1.0);
    ((a + way * share).norm(), from + (to - from) * share)
}

/// Many courses, found by where they are.
#[derive(Clone, Debug, Default)]
pub struct Crowd {
    /// With whom each belongs: nobody is kept apart from their own.
    courses: Vec<(usize, Course)>,
    cells: BTreeMap<(usize, usize), Vec<usize>>,
}

impl Crowd {
    /// Adds the course of one who belongs to `whom`.
    pub fn add(&mut self, whom: usize, course: Course) {
        for cell in course.cells() {
            self.cells.entry(cell).or_default().push(self.courses.len());
        }
        self.courses.push((whom, course));
    }

    /// The least [`gap`] of `course` to anybody but those of `but`, as far as it is below twice the reach of a cell. Cost: linear in
    /// those about it.
    pub fn gap(&self, course: &Course, but: Option<usize>) -> f64 {
        let near: BTreeSet<usize> =
            course.cells().iter().filter_map(|cell| self.cells.get(cell)).flatten().copied().collect();
        let others =
            near.into_iter().map(|index| &self.courses[index]).filter(|(whom, _)| Some(*whom) != but);
        others.map(|(_, other)| gap(course, other).0).fold(f64::INFINITY, f64::min)
    }

    /// Who are ever in each other, the two numbers rising, with the [`gap`]; each two once, where they are deepest. Cost: linear in
    /// all, times those about each.
    pub fn clashes(&self) -> BTreeMap<(usize, usize), (f64, f64)> {
        let mut clashes = BTreeMap::new();
        let mut seen = BTreeSet::new();
        let pairs = self.cells.values().flat_map(|cell| {
            cell.iter()
                .enumerate()
                .flat_map(|(place, one)| cell[place + 1..].iter().map(|other| (*one, *other)))
        });
        for (one, other) in pairs {
            let [(whom, course), (who, beside)] = [one, other].map(|index| &self.courses[index]);
            if whom == who || !seen.insert((one, other)) {
                continue;
            }
            let found = gap(course, beside);
            let known = clashes.entry((*whom.min(who), *whom.max(who))).or_insert((0.0, 0.0));
            if found.0 < known.0 {
                *known = found;
            }
        }
        clashes.retain(|_, (gap, _)| *gap < 0.0);
        clashes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn walking(from: (f64, f64), to: (f64, f64), times: (f64, f64)) -> Course {
        let knots = vec![(times.0, c64::new(from.0, from.1)), (times.1, c64::new(to.0, to.1))];
        Course { knots, radius: BODY }
    }

    #[test]
    fn who_crosses_the_same_place_at_another_time_is_not_met() {
        let one = walking((-5.0, 0.0), (5.0, 0.0), (0.0, 10.0));
        // Both at the origin at 5 s; four seconds, that is four metres, later it is 4 / √2 m away.
        let crossing = |late: f64| walking((0.0, -5.0), (0.0, 5.0), (late, 10.0 + late));
        let (deep, when) = gap(&one, &crossing(0.0));
        assert!((deep + 2.0 * BODY).abs() < 1e-12 && (when - 5.0).abs() < 1e-12);
        assert!((gap(&one, &crossing(4.0)).0 - (8.0_f64.sqrt() - 2.0 * BODY)).abs() < 1e-12);
        let standing = Course::resting(c64::new(2.0, 1.0), BODY);
        assert!((gap(&one, &standing).0 - 0.5).abs() < 1e-12);
    }

    #[test]
    fn those_about_are_found_wherever_they_are() {
        let mut crowd = Crowd::default();
        crowd.add(0, walking((-50.0, 3.9), (50.0, 3.9), (0.0, 50.0)));
        crowd.add(1, Course::resting(c64::new(20.0, 4.6), 0.0));
        let here = Course::resting(c64::new(20.0, 4.5), 0.0);
        assert!((crowd.gap(&here, None) - 0.1).abs() < 1e-9);
        assert!((crowd.gap(&here, Some(1)) - (0.6 - BODY)).abs() < 1e-9);
        assert!(crowd.gap(&Course::resting(c64::new(20.0, -60.0), 0.0), None).is_infinite());
    }

    #[test]
    fn who_are_in_each_other_are_told_once_but_their_own_things_are_not() {
        let mut crowd = Crowd::default();
        crowd.add(0, walking((-50.0, 0.0), (50.0, 0.0), (0.0, 100.0)));
        crowd.add(1, walking((0.0, -50.0), (0.0, 50.0), (0.0, 100.0)));
        crowd.add(2, Course::resting(c64::new(30.0, 0.4), BODY));
        crowd.add(2, Course::resting(c64::new(30.0, 0.5), BODY));
        crowd.add(3, Course::resting(c64::new(-30.0, 0.6), BODY));
        let clashes: Vec<_> = crowd.clashes().into_iter().collect();
        assert_eq!(clashes.iter().map(|own| own.0).collect::<Vec<_>>(), [(0, 1), (0, 2)]);
        assert!((clashes[0].1.0 + 2.0 * BODY).abs() < 1e-9 && (clashes[0].1.1 - 50.0).abs() < 1e-9);
        assert!((clashes[1].1.0 - (0.4 - 2.0 * BODY)).abs() < 1e-9 && (clashes[1].1.1 - 80.0).abs() < 1e-9);
    }
}
