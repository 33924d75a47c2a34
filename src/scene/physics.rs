//! Settings of the physics stage, and what is wrong with a scene's `[physics]` table.

use std::collections::BTreeSet;
use std::sync::Arc;

use crate::index::CharacterId;
use crate::physics::body_model::{BodySettings, MassTable, body_model};
use crate::physics::flight::FlightSettings;
use crate::physics::ground::parts::{Part, link_sets};
use crate::physics::ground::schedule::{Step, five_five_two, level, uphill};
use crate::physics::ground::target::{Source, Target};
use crate::physics::ground::{GroundSettings, MARGIN};
use crate::physics::touch_up::TouchUpSettings;
use crate::scene::checker::Checker;
use crate::scene::clips::within;
use crate::scene::physics_table::{self, ScheduleWord, TableWord, TargetWord};
use crate::scene::report::{At, Place, Report};
use crate::scene::suggest;
use crate::scene::tree::Field;
use crate::scene::values::{self, WordOr};
use crate::skeleton::{JointRole, Skeleton};

/// Settings of the physics stage.
#[derive(Clone, Debug, PartialEq)]
pub struct Physics {
    /// Who is touched up; `None`: everybody.
    pub characters: Option<BTreeSet<CharacterId>>,
    /// What bodies weigh.
    pub body: BodySettings,
    /// How they are touched up on the ground, but for the tolerance.
    pub ground: GroundSettings,
    /// A mean distance that is good enough, metres; `None`: that of the motion before the edit.
    pub tolerance: Option<f64>,
    /// Whether flights are made to fall as bodies do.
    pub flight: bool,
}

/// What is as near as the source but for rounding is good enough, metres.
const ROUNDING: f64 = 1e-9;

impl Physics {
    /// How a motion edited from `source` is touched up.
    pub fn touch_up(&self, source: &Source) -> TouchUpSettings {
        let of_source = || source.distances[0].map_or(0.0, |distance| distance.mean + ROUNDING);
        let tolerance = self.tolerance.unwrap_or_else(of_source);
        TouchUpSettings {
            ground: GroundSettings { tolerance, ..self.ground.clone() },
            flight: self.flight.then(FlightSettings::default),
        }
    }

    /// Whether it is for a character.
    pub fn is_for(&self, who: CharacterId) -> bool {
        self.characters.as_ref().is_none_or(|own| own.contains(&who))
    }
}

/// Polygons are made smaller by no more than this share of the stature.
const WIDEST_MARGIN: f64 = 0.1;
/// No mean distance is farther, metres.
const FARTHEST_TOLERANCE: f64 = 10.0;
const MOST_ROUNDS: u32 = 1000;
/// As many as any schedule needs.
const MOST_STEPS: usize = 100;
const HEAVIEST: f64 = 1e6;

impl Checker<'_> {
    /// Checks the `[physics]` table.
    pub fn physics(&mut self, table: &Field<physics_table::Physics>, mode: &Field<values::Mode>) {
        let Some(At { value: raw, place }) = table.given() else { return };
        if raw.touch_up.value() == Some(&false) {
            return;
        }
        let names = raw.characters.value();
        let characters = names.map(|names| names.iter().filter_map(|name| self.member(name)).collect());
        if let Some(given) = raw.characters.given().filter(|given| given.value.is_empty()) {
            let help = "name one, or write touch_up = false";
            self.report.fault(&given.place, "nobody is left", help);
        }
        let is_paper = mode.value() == Some(&values::Mode::Paper);
        let faults = self.report.fault_count();
        let own_tolerance = amount(&raw.tolerance, FARTHEST_TOLERANCE, "metres", self.report);
        let physics = Physics {
            characters,
            body: body(raw, self.report),
            ground: ground(raw, is_paper, self.report),
            tolerance: own_tolerance.or(is_paper.then_some(0.0)),
            flight: raw.flight.value() != Some(&false),
        };
        // Steps that cannot be read fit nobody.
        if self.report.fault_count() == faults {
            self.check_bodies(&physics, (raw, place));
        }
        self.checked.physics = Some(physics);
    }

    /// Reports whose bodies cannot be touched up so: each skeleton once, with the first who has it.
    fn check_bodies(&mut self, physics: &Physics, table: (&physics_table::Physics, &Place)) {
        let mut known: Vec<Arc<Skeleton>> = Vec::new();
        for (index, member) in self.cast.iter().enumerate() {
            let clip = member.track.first().and_then(|entry| entry.clip.as_ref());
            let Some(skeleton) = clip.map(|clip| &clip.clip.skeleton) else { continue };
            let is_known = known.iter().any(|own| Arc::ptr_eq(own, skeleton) || own.matches(skeleton));
            if !is_known && physics.is_for(CharacterId::from_usize(index)) {
                known.push(Arc::clone(skeleton));
                check_body(physics, (&member.name, skeleton), table, self.report);
            }
        }
    }
}

/// Reports what keeps one body from being touched up.
fn check_body(
    physics: &Physics,
    (name, skeleton): (&str, &Skeleton),
    (raw, place): (&physics_table::Physics, &Place),
    report: &mut Report,
) {
    let model = match body_model(skeleton, &physics.body) {
        Ok(model) => model,
        Err(error) => {
            let help =
                "name its joints by `roles` in the clip's table, or name all others in characters = [...]";
            report.fault(place, format!("\"{name}\" cannot be touched up: {error}"), help);
            return;
        }
    };
    for (index, step) in physics.ground.schedule.iter().enumerate() {
        let Err(error) = link_sets(skeleton, &model, &step.turned, &step.carried) else { continue };
        let own = match raw.schedule.value() {
            Some(WordOr::Other(steps)) => steps.get(index).map(|step| &step.place),
            _ => None,
        };
        let help = "what turns hangs on what turns or stays, what is kept on what turns or is kept, what stays on what stays: \
                    write { turns = [\"lower\"], keeps = [\"upper\"] }, { turns = [\"upper\"] } or { turns = [\"arms\"] }";
        report.fault(own.unwrap_or(place), format!("\"{name}\" cannot do this step: {error}"), help);
    }
}

fn body(raw: &physics_table::Physics, report: &mut Report) -> BodySettings {
    let default = BodySettings::default();
    BodySettings {
        table: match raw.table.value() {
            Some(TableWord::Xiao2005) => MassTable::Xiao2005,
            Some(TableWord::Winter75) | None => MassTable::Winter75,
        },
        mass: within(&raw.mass, HEAVIEST, "kilograms of a body", report).unwrap_or(default.mass),
    }
}

fn ground(raw: &physics_table::Physics, is_paper: bool, report: &mut Report) -> GroundSettings {
    let is_single = matches!(raw.schedule.value(), Some(WordOr::Word(ScheduleWord::Published))) || is_paper;
    GroundSettings {
        target: target(raw, is_paper, report),
        schedule: schedule(&raw.schedule, report),
        rounds: rounds(&raw.rounds, report).unwrap_or(if is_single { 1 } else { 3 }),
        two_axis: raw.two_axis.value() == Some(&true),
        ..GroundSettings::default()
    }
}

fn target(raw: &physics_table::Physics, is_paper: bool, report: &mut Report) -> Target {
    let margin = amount(&raw.margin, WIDEST_MARGIN, "a share of the stature", report);
    let is_hull = raw.target.value().map_or(is_paper, |word| *word == TargetWord::Hull);
    if is_hull {
        return Target::Hull { margin: margin.unwrap_or(if is_paper { 0.0 } else { MARGIN }) };
    }
    // A target that cannot be read may have been meant to have one.
    if let Some(given) = raw.margin.given().filter(|_| !matches!(raw.target, Field::Spoiled)) {
        let help = "leave it out, or write target = \"hull\"";
        report.fault(&given.place, "places that are carried over have no margin", help);
    }
    Target::Carried
}

/// A number from 0 to `largest`; `None` where it is left out, or reported if it is not.
fn amount(field: &Field<f64>, largest: f64, what: &str, report: &mut Report) -> Option<f64> {
    let At { value, place } = field.given()?;
    if (0.0..=largest).contains(value) {
        return Some(*value);
    }
    report.fault(place, format!("{value} is not {what}"), format!("write a number from 0 to {largest}"));
    None
}

fn rounds(field: &Field<u32>, report: &mut Report) -> Option<usize> {
    let At { value, place } = field.given()?;
    if !(1..=MOST_ROUNDS).contains(value) {
        let help = format!("write a whole number from 1 to {MOST_ROUNDS}, or touch_up = false");
        report.fault(place, format!("a schedule cannot be gone through {value} times"), help);
        return None;
    }
    usize::try_from(*value).ok()
}

fn schedule(
    field: &Field<WordOr<ScheduleWord, Vec<At<physics_table::Step>>>>,
    report: &mut Report,
) -> Vec<Step> {
    let Some(At { value, place }) = field.given() else { return level() };
    let steps = match value {
        WordOr::Word(ScheduleWord::Level) => return level(),
        WordOr::Word(ScheduleWord::Uphill) => return uphill(),
        WordOr::Word(ScheduleWord::Published) => return five_five_two(),
        WordOr::Other(steps) => steps,
    };
    if steps.is_empty() || steps.len() > MOST_STEPS {
        let message = format!("a schedule of {} steps", steps.len());
        report.fault(place, message, format!("write 1 to {MOST_STEPS} steps, or touch_up = false"));
    }
    steps.iter().map(|own| step(&own.value, &own.place, report)).collect()
}

/// Of a step that says nothing else.
const SHARE: f64 = 0.5;
/// Likewise, frames at 30 a second.
const WIDTH: f64 = 20.0;
/// Likewise, degrees.
const LARGEST_TURN: f64 = 28.0;

fn step(raw: &physics_table::Step, place: &Place, report: &mut Report) -> Step {
    let turns = parts(&raw.turns, report);
    let keeps = parts(&raw.keeps, report);
    if raw.turns.value().is_some_and(Vec::is_empty) {
        report.fault(place, "nothing turns in this step", "name \"lower\", \"upper\", \"arms\", or a role");
    }
    if let Some(both) = raw.keeps.value().into_iter().flatten().find(|name| turns_too(&raw.turns, name)) {
        let message = format!("{} is both to turn and to be kept from turning", both.value);
        report.fault(place, message, "name it once");
    }
    let share = within(&raw.share, 1.0, "a share of a turn", report).unwrap_or(SHARE);
    let width = within(&raw.width, 300.0, "frames of a kernel", report).unwrap_or(WIDTH);
    let degrees = within(&raw.largest_turn, 90.0, "degrees of a turn", report).unwrap_or(LARGEST_TURN);
    Step { turned: turns, carried: keeps, share, width, largest_turn: degrees.to_radians() }
}

fn turns_too(turns: &Field<Vec<At<String>>>, name: &At<String>) -> bool {
    turns.value().into_iter().flatten().any(|own| own.value == name.value)
}

fn parts(names: &Field<Vec<At<String>>>, report: &mut Report) -> Vec<Part> {
    let mut known = |name: &At<String>| {
        let part = part(&name.value);
        if part.is_none() {
            let mut names = vec!["lower", "upper", "arms"];
            names.extend(JointRole::ALL.iter().map(|role| role.name()));
            let message = format!("a body has no part \"{}\"", name.value);
            report.fault(&name.place, message, suggest::remedy(&name.value, "parts", &names));
        }
        part
    };
    names.value().into_iter().flatten().filter_map(&mut known).collect()
}

fn part(name: &str) -> Option<Part> {
    match name {
        "lower" => Some(Part::Lower),
        "upper" => Some(Part::Upper),
        "arms" => Some(Part::Arms),
        _ => JointRole::named(name).map(Part::Below),
    }
}
