//! Constraints of a scene: each table checked, its moments found.

use std::collections::BTreeMap;

use crate::constraint::{ConstraintKind, Partner, Relation, When};
use crate::geometry::c64;
use crate::index::ObjectId;
use crate::scene::checker::{Checked, Checker, Head, first_places, plan_point, seconds_within};
use crate::scene::moment::Member;
use crate::scene::raw;
use crate::scene::report::{At, Lines, Place, Report};
use crate::scene::suggest;
use crate::scene::tree::Field;
use crate::scene::values::{OneOrPair, WordOr};

/// Checks every constraint of `raw`. `lines`: of the file.
pub fn check(raw: &raw::Scene, cast: &[Member], lines: &Lines<'_>, report: &mut Report) -> Checked {
    let objects = raw.object.tables().iter();
    let objects = objects.map(|object| object.value.name.value().map_or("", String::as_str));
    let objects: Vec<&str> = objects.collect();
    let mut checker = Checker {
        cast,
        cast_places: first_places(cast.iter().map(|member| member.name.as_str())),
        object_places: first_places(objects.iter().copied()),
        objects,
        keyed: raw.object.tables().iter().map(|object| !object.value.keys.is_absent()).collect(),
        lines,
        report,
        names: BTreeMap::new(),
        checked: Checked::default(),
    };
    // The tables differ in type, but share these keys.
    macro_rules! keep_each {
        ($($kind:ident)*) => { $(
            for (index, table) in raw.$kind.tables().iter().enumerate() {
                let kind = checker.$kind(table);
                let (keyword, place) = (stringify!($kind), &table.place);
                let name = &table.value.name;
                checker.keep(Head { keyword, index, place, name }, &table.value.strength, kind);
            }
        )* };
    }
    keep_each!(pin relative time duration sync);
    raw.carry.tables().iter().enumerate().for_each(|(index, table)| checker.carry(table, index));
    raw.end_effector
        .tables()
        .iter()
        .enumerate()
        .for_each(|(index, table)| checker.end_effector(table, index));
    raw.drag.tables().iter().for_each(|table| checker.drag(table));
    checker.discrete(&raw.discrete);
    checker.physics(&raw.physics, &raw.mode);
    checker.checked
}

impl Checker<'_> {
    fn pin(&mut self, table: &At<raw::Pin>) -> Option<ConstraintKind> {
        let pin = &table.value;
        if pin.position.is_absent() && pin.facing.is_absent() {
            let help = "add position = [x, -z], or facing in degrees, or both";
            self.report.fault(&table.place, "the pin holds nothing", help);
        }
        let position = pin.position.given().map(|pair| plan_point(pair, self.report));
        let when = self.when(&table.place, &pin.at, &pin.during);
        let facing = pin.facing.value().map(|degrees| degrees.to_radians());
        Some(ConstraintKind::Pin { when: when?, position, facing })
    }

    fn relative(&mut self, table: &At<raw::Relative>) -> Option<ConstraintKind> {
        let relative = &table.value;
        let offset = match relative.offset.given() {
            None => Relation::AsBefore,
            Some(At { value: WordOr::Word(_), .. }) => Relation::Free,
            Some(At { value: WordOr::Other(pair), place }) => {
                let pair = At { value: pair.clone(), place: place.clone() };
                Relation::Given(plan_point(&pair, self.report))
            }
        };
        let facing = match relative.facing.value() {
            None => Relation::Free,
            Some(WordOr::Word(_)) => Relation::AsBefore,
            Some(WordOr::Other(degrees)) => Relation::Given(degrees.to_radians()),
        };
        if offset == Relation::<c64>::Free && relative.facing.is_absent() {
            let help = "give an offset or a facing, or leave \"offset\" out to keep it as before the edit";
            self.report.fault(&table.place, "neither offset nor facing is held", help);
        }
        let when = self.when(&table.place, &relative.at, &relative.during);
        let partner = relative.to.given().and_then(|to| self.partner(to, when.as_ref()));
        let (when, partner) = (when?, partner?);
        if let Partner::Character(other) = &partner
            && other.character() == when.character()
        {
            let name = &self.cast[when.character().as_usize()].name;
            let message = format!("\"{name}\" cannot be held relative to \"{name}\"");
            let place = relative.to.given().map_or(&table.place, |to| &to.place);
            self.report.fault(place, message, "name a moment of somebody else, or an object");
        }
        Some(ConstraintKind::Relative { when, partner, offset, facing })
    }

    fn partner(&mut self, to: &At<OneOrPair>, when: Option<&When>) -> Option<Partner> {
        match self.partner_when(to, when)? {
            Ok(when) => Some(Partner::Character(when)),
            Err(name) => self.object(name, &to.place).map(Partner::Object),
        }
    }

    /// The moment of a partner, or with an interval the interval; `Err` with a name that is no moment.
    pub fn partner_when<'t>(
        &mut self,
        to: &'t At<OneOrPair>,
        when: Option<&When>,
    ) -> Option<Result<When, &'t str>> {
        match (&to.value, when) {
            (OneOrPair::One(name), _) if !name.contains(':') => Some(Err(name)),
            (OneOrPair::One(text), Some(When::During(..))) => {
                let key = to.place.field.rsplit('.').next().unwrap_or_default();
                let bounds = "with the two moments that bound the partner's interval";
                let help = format!("write {key} = [\"{text}\", …] {bounds}");
                self.report.fault(&to.place, "an interval needs an interval of the partner", help);
                None
            }
            (OneOrPair::One(text), _) => self.moment(text, &to.place).map(|moment| Ok(When::At(moment))),
            (OneOrPair::Pair(_), Some(When::At(_))) => {
                let help = "name one moment, or use \"during\" with two moments in place of \"at\"";
                self.report.fault(&to.place, "an instant needs one moment of the partner", help);
                None
            }
            (OneOrPair::Pair(pair), _) => {
                let (from, to) = self.interval(pair, &to.place)?;
                Some(Ok(When::During(from, to)))
            }
        }
    }

    /// The object called `name`.
    pub fn object(&mut self, name: &str, place: &Place) -> Option<ObjectId> {
        if let Some(object) = self.object_places.get(name) {
            return Some(ObjectId::from_usize(*object));
        }
        if self.cast_places.contains_key(name) {
            let message = format!("\"{name}\" is a character: say at which moment");
            self.report.fault(place, message, format!("write a moment such as \"{name}:start\""));
        } else if self.objects.iter().all(|known| !known.is_empty()) {
            let help = suggest::remedy(name, "objects", &self.objects);
            let message = format!("no object \"{name}\"");
            self.report.fault(place, message, format!("{help}; a moment of a character needs ':'"));
        }
        None
    }

    fn time(&mut self, table: &At<raw::Time>) -> Option<ConstraintKind> {
        let time = &table.value;
        let seconds = seconds_within(&time.seconds, self.report);
        let at = time.at.given().and_then(|at| self.moment(&at.value, &at.place));
        Some(ConstraintKind::Time { at: at?, seconds: seconds? })
    }

    fn duration(&mut self, table: &At<raw::Duration>) -> Option<ConstraintKind> {
        let duration = &table.value;
        let seconds = seconds_within(&duration.seconds, self.report);
        if let Some(given) = duration.seconds.given()
            && given.value <= 0.0
        {
            let message = format!("{} seconds is no duration", given.value);
            self.report.fault(&given.place, message, "write a number above 0");
        }
        let from = duration.from.given().and_then(|at| self.moment(&at.value, &at.place));
        let to = duration.to.given().and_then(|at| self.moment(&at.value, &at.place));
        let place = duration.to.given().map_or(&table.place, |to| &to.place);
        let (from, to) = self.of_one_character(from?, to?, place)?;
        Some(ConstraintKind::Duration { from, to, seconds: seconds? })
    }

    fn sync(&mut self, table: &At<raw::Sync>) -> Option<ConstraintKind> {
        let sync = &table.value;
        let (place, count) = match (&sync.moments, &sync.intervals) {
            (Field::Absent, Field::Absent) => {
                let help = "add moments = [\"ann:start\", \"bob:start\"]";
                self.report.fault(&table.place, "the sync has neither moments nor intervals", help);
                return None;
            }
            (Field::Given(_), Field::Given(intervals)) => {
                let help = "keep one of them, and make a second [[sync]] of the other";
                self.report.fault(&intervals.place, "a sync has either moments or intervals", help);
                return None;
            }
            (Field::Given(moments), _) => (&moments.place, moments.value.len()),
            (_, Field::Given(intervals)) => (&intervals.place, intervals.value.len()),
            _ => return None,
        };
        if count < 2 {
            let message = format!("{count} of two or more");
            self.report.fault(place, message, "name at least two that happen together");
        }
        if let Some(offset) = sync.offset.given()
            && count > 2
        {
            let message = format!("an offset is between two, but this sync has {count}");
            self.report.fault(&offset.place, message, "make a [[sync]] of two for each offset");
        }
        let offset =
            if sync.offset.is_absent() { Some(0.0) } else { seconds_within(&sync.offset, self.report) };
        let moments = self.synchronized(sync);
        Some(ConstraintKind::Sync { moments: moments?, offset: offset? })
    }

    /// Moments or intervals of `sync`, of different characters.
    fn synchronized(&mut self, sync: &raw::Sync) -> Option<Vec<When>> {
        let moments = sync.moments.value().into_iter().flatten().map(|at| {
            let moment = self.moment(&at.value, &at.place);
            (moment.map(When::At), at.place.clone())
        });
        let mut all: Vec<_> = moments.collect();
        let intervals = sync.intervals.value().into_iter().flatten().map(|at| {
            let interval = self.interval(&at.value, &at.place);
            (interval.map(|(from, to)| When::During(from, to)), at.place.clone())
        });
        all.extend(intervals);
        let mut seen = Vec::new();
        for (when, place) in &all {
            let Some(when) = when else {
                continue;
            };
            let who = when.character();
            if seen.contains(&who) {
                let message =
                    format!("\"{}\" cannot be at two moments at once", self.cast[who.as_usize()].name);
                self.report.fault(
                    place,
                    message,
                    "name each character once; a [[duration]] ties moments of one",
                );
            }
            seen.push(who);
        }
        all.into_iter().map(|(when, _)| when).collect()
    }
}
