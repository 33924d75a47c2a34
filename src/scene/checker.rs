//! What all constraints share: names, strengths, moments and intervals.

use std::collections::{BTreeMap, HashMap};

use crate::constraint::{Constraint, ConstraintKind, Discrete, Instant, Moment, Strength, When};
use crate::effector::EndEffector;
use crate::geometry::c64;
use crate::object::Carry;
use crate::scene::clips::check_name;
use crate::scene::drags::DraftDrag;
use crate::scene::moment::{self, Member, Unresolved};
use crate::scene::physics::Physics;
use crate::scene::report::{At, Lines, Place, Report};
use crate::scene::tree::Field;
use crate::scene::values::{self, Pair, WordOr};
use crate::track::Track;

/// Weaker than this nothing is felt, and its inverse is no number to reckon with.
const SMALLEST_WEIGHT: f64 = 1e-9;

/// Longest time, seconds, that a scene may speak of.
const LONGEST: f64 = 1e6;

/// Farthest from the origin that anything stands, metres.
pub const FARTHEST: f64 = 1e5;

/// Constraints that are sound, and where their parts stand.
#[derive(Debug, Default)]
pub struct Checked {
    /// Pins, relatives, times, durations, syncs, each kind in the order of the file.
    pub constraints: Vec<Constraint>,
    /// Where each constraint stands.
    pub places: Vec<Place>,
    /// Every interval, beginning and end, of one character each.
    pub intervals: Vec<(Moment, Moment, Place)>,
    /// In the order of the file.
    pub carries: Vec<Carry>,
    /// Where each carry says when.
    pub carry_places: Vec<Place>,
    /// In the order of the file.
    pub end_effectors: Vec<EndEffector>,
    /// Where each of these stands.
    pub effector_places: Vec<Place>,
    /// In the order of the file.
    pub drags: Vec<DraftDrag>,
    /// What discrete editing may do.
    pub discrete: Option<Discrete>,
    /// How everybody is touched up.
    pub physics: Option<Physics>,
}

impl Checked {
    /// Every moment that something names.
    pub fn moments(&self) -> impl Iterator<Item = &Moment> {
        let constraints = self.constraints.iter().flat_map(|constraint| constraint.kind.moments());
        let carries = self.carries.iter().flat_map(|carry| [&carry.during.0, &carry.during.1]);
        let manipulated = self.drags.iter().filter_map(DraftDrag::moment);
        let times = self.discrete.iter().flat_map(|discrete| discrete.times.iter().flatten());
        constraints
            .chain(carries)
            .chain(self.end_effectors.iter().flat_map(EndEffector::moments))
            .chain(manipulated)
            .chain(times.flat_map(|(from, to)| [from, to]))
    }
}

/// The plan point `[x, −z]`, reported where it is out of this world.
pub fn plan_point(pair: &At<Pair<f64>>, report: &mut Report) -> c64 {
    let [x, y] = &pair.value;
    for value in [x, y].into_iter().filter(|value| value.value.abs() > FARTHEST) {
        let message = format!("{} metres is too far away", value.value);
        report.fault(&value.place, message, format!("stay within {FARTHEST} metres"));
    }
    c64::new(x.value, y.value)
}

/// What every table of a constraint has.
#[derive(Clone, Copy)]
pub struct Head<'a> {
    /// Name of the kind.
    pub keyword: &'static str,
    /// Position among its kind.
    pub index: usize,
    /// Of the table.
    pub place: &'a Place,
    /// Its author's name for it.
    pub name: &'a Field<String>,
}

/// Checks constraints one by one, against a cast and its objects.
pub struct Checker<'a> {
    /// Who performs.
    pub cast: &'a [Member],
    /// Where in the cast each name comes first.
    pub cast_places: HashMap<&'a str, usize>,
    /// Where among the objects each name comes first.
    pub object_places: HashMap<&'a str, usize>,
    /// Names of the objects, in the order of the file; empty where a name is at fault.
    pub objects: Vec<&'a str>,
    /// Which of them move by keys.
    pub keyed: Vec<bool>,
    /// Of the file.
    pub lines: &'a Lines<'a>,
    /// What is wrong so far.
    pub report: &'a mut Report,
    /// Names of constraints so far, with the places they stand for.
    pub names: BTreeMap<String, String>,
    /// What is sound so far.
    pub checked: Checked,
}

impl Checker<'_> {
    /// Adds the constraint with the head `head`, where `kind` is sound.
    pub fn keep(&mut self, head: Head<'_>, strength: &Field<values::Strength>, kind: Option<ConstraintKind>) {
        let strength = self.strength(strength);
        let (name, line) = self.called(&head);
        let Some(kind) = kind else {
            return;
        };
        if matches!(strength, Strength::Hard) && holds_interval(&kind) {
            let message = "a hard constraint over an interval holds at every sample and is easily too much";
            let help =
                "leave \"strength\" out or give it a weight, unless nothing else bears on the interval";
            self.report.warn(head.place, message, help);
        }
        self.checked.constraints.push(Constraint { name, line, strength, kind });
        self.checked.places.push(head.place.clone());
    }

    /// What a table is called, and the line of the file where it stands, from 1.
    pub fn called(&mut self, head: &Head<'_>) -> (String, u32) {
        let Head { keyword, index, place, name } = *head;
        let own = format!("{keyword}[{index}]");
        if let Some(name) = name.given() {
            check_name(name, "constraint", self.report);
        }
        let called = name.value().cloned().unwrap_or_else(|| own.clone());
        if let Some(other) = self.names.insert(called.clone(), own) {
            let message = format!("{other} is already called \"{called}\"");
            let place = name.given().map_or(place, |name| &name.place);
            self.report.fault(place, message, "give each constraint a name of its own, or none");
        }
        let line = u32::try_from(self.lines.position(place.span.start).0).unwrap_or(u32::MAX);
        (called, line)
    }

    fn strength(&mut self, strength: &Field<values::Strength>) -> Strength {
        match strength.given() {
            None => Strength::default(),
            Some(At { value: WordOr::Word(_), .. }) => Strength::Hard,
            Some(At { value: WordOr::Other(weight), place }) => {
                if *weight < SMALLEST_WEIGHT {
                    let message = if *weight > 0.0 {
                        format!("{weight:e} is too weak")
                    } else {
                        format!("{weight} is no weight")
                    };
                    let help = "write a number above 0 or \"hard\", no less than 1e-9; \
                                remove the constraint if it is not to hold";
                    self.report.fault(place, message, help);
                }
                Strength::Soft(*weight)
            }
        }
    }

    /// When a constraint holds, by its `at` or `during`; `table`: of the constraint.
    pub fn when(&mut self, table: &Place, at: &Field<String>, during: &Field<Pair<String>>) -> Option<When> {
        match (at, during) {
            (Field::Absent, Field::Absent) => {
                let help = "add at = \"CHARACTER:start\", or during with two moments";
                self.report.fault(table, "neither \"at\" nor \"during\" says when", help);
                None
            }
            (Field::Given(_), Field::Given(during)) => {
                let help = "keep \"at\" for an instant, or \"during\" for an interval";
                self.report.fault(&during.place, "\"at\" and \"during\" exclude each other", help);
                None
            }
            (Field::Given(at), _) => self.moment(&at.value, &at.place).map(When::At),
            (_, Field::Given(during)) => {
                let (from, to) = self.interval(&during.value, &during.place)?;
                Some(When::During(from, to))
            }
            _ => None,
        }
    }

    /// The two moments that bound an interval.
    pub fn interval(&mut self, pair: &Pair<String>, place: &Place) -> Option<(Moment, Moment)> {
        let [from, to] = pair.each_ref().map(|at| self.moment(&at.value, &at.place));
        self.of_one_character(from?, to?, place)
    }

    /// The interval between two moments, where both are of one character.
    pub fn of_one_character(&mut self, from: Moment, to: Moment, place: &Place) -> Option<(Moment, Moment)> {
        if from.character != to.character {
            let message = format!("\"{}\" and \"{}\" are of two characters", from.name, to.name);
            self.report.fault(place, message, "name two moments of one character");
            return None;
        }
        self.checked.intervals.push((from.clone(), to.clone(), place.clone()));
        Some((from, to))
    }

    /// The moment that `text` names.
    pub fn moment(&mut self, text: &str, place: &Place) -> Option<Moment> {
        match moment::resolve(text, (self.cast, &self.cast_places)) {
            Ok(moment) => Some(moment),
            Err(Unresolved::Spoiled) => None,
            Err(Unresolved::Wrong { message, help }) => {
                self.report.fault(place, message, help);
                None
            }
        }
    }
}

/// Where each name comes first.
pub fn first_places<'a>(names: impl Iterator<Item = &'a str>) -> HashMap<&'a str, usize> {
    let mut places = HashMap::new();
    for (place, name) in names.enumerate() {
        places.entry(name).or_insert(place);
    }
    places
}

/// A time within reason.
pub fn seconds_within(seconds: &Field<f64>, report: &mut Report) -> Option<f64> {
    let At { value, place } = seconds.given()?;
    if value.abs() > LONGEST {
        let message = format!("{value} seconds is too far away");
        report.fault(place, message, format!("stay within {LONGEST} seconds"));
    }
    Some(*value)
}

fn holds_interval(kind: &ConstraintKind) -> bool {
    match kind {
        ConstraintKind::Pin { when, .. } | ConstraintKind::Relative { when, .. } => {
            matches!(when, When::During(..))
        }
        _ => false,
    }
}

/// Reports intervals that do not run forwards. `tracks`: of the cast, as far as they could be strung.
pub fn check_intervals(checked: &Checked, cast: &[Member], tracks: &[Option<Track>], report: &mut Report) {
    for (from, to, place) in &checked.intervals {
        let who = from.character.as_usize();
        let located = tracks.get(who).and_then(Option::as_ref).and_then(|track| {
            let (from, to) = (track.locate(from.instant)?, track.locate(to.instant)?);
            Some(from < to)
        });
        let forwards = order(from.instant, &cast[who]) < order(to.instant, &cast[who]);
        if !forwards || located == Some(false) {
            let message = format!("\"{}\" does not come before \"{}\"", from.name, to.name);
            report.fault(place, message, "write the earlier moment first, the later one second");
        }
    }
}

/// Place of an instant in the order of the unedited track: clip, then working frame.
pub fn order(instant: Instant, member: &Member) -> (usize, f64) {
    match instant {
        Instant::TrackStart => (0, f64::NEG_INFINITY),
        Instant::TrackEnd => (member.track.len().saturating_sub(1), f64::INFINITY),
        Instant::ClipStart(entry) => (entry, f64::NEG_INFINITY),
        Instant::ClipEnd(entry) => (entry, f64::INFINITY),
        Instant::Frame { entry, working } => (entry, working),
        // Discrete edits make these; no scene file does.
        Instant::Shown(frame) => (0, frame),
    }
}
