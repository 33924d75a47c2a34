//! Settings of the physics stage, and what is wrong with a scene's `[physics]` table.

use std::collections::BTreeSet;

use crate::index::CharacterId;
use crate::scene::checker::Checker;
use crate::scene::clips::within;
use crate::scene::physics_table::{self, ScheduleWord, Step, TableWord, TargetWord};
use crate::scene::report::{At, Place, Report};
use crate::scene::suggest;
use crate::scene::tree::Field;
use crate::scene::values::{self, WordOr};
use crate::skeleton::JointRole;

/// Settings of the physics stage.
#[derive(Clone, Debug, PartialEq)]
pub struct Physics {
    /// Who is touched up; `None`: everybody.
    pub characters: Option<BTreeSet<CharacterId>>,
    /// Where zero moment points are to be.
    pub target: Target,
    /// What turns in which order.
    pub schedule: Schedule,
    /// How often the schedule is gone through at most.
    pub rounds: usize,
    /// A mean distance that is good enough, metres; `None`: that of the motion before the edit.
    pub tolerance: Option<f64>,
    /// Whether turns are exact along both axes.
    pub two_axis: bool,
    /// Whether flights are made to fall as bodies do.
    pub flight: bool,
    /// Whether the masses are those printed by Xiao et al. instead of Winter's.
    pub table: TableWord,
    /// kg; `None`: a reference body's.
    pub mass: Option<f64>,
}

/// Where zero moment points are to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target {
    /// Where the motion before the edit had them, as seen from what bears.
    Carried,
    /// In the polygon of support, made smaller by this share of the stature; `None`: by the usual one.
    Hull(Option<f64>),
}

/// What turns in which order.
#[derive(Clone, Debug, PartialEq)]
pub enum Schedule {
    /// One that is known by name.
    Named(ScheduleWord),
    /// The author's own.
    Own(Vec<TurnStep>),
}

/// One step of an author's schedule.
#[derive(Clone, Debug, PartialEq)]
pub struct TurnStep {
    /// Turn, all by one angle.
    pub turns: Vec<TurnedPart>,
    /// Are carried without being turned.
    pub keeps: Vec<TurnedPart>,
    /// Share of the turn that is done.
    pub share: f64,
    /// Width of the smoothing kernel, frames at 30 fps.
    pub width: f64,
    /// Radians.
    pub largest_turn: f64,
}

/// A part of the body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TurnedPart {
    /// Legs and pelvis.
    Lower,
    /// All else.
    Upper,
    /// Both arms.
    Arms,
    /// The joint of a role and what hangs on it.
    Below(JointRole),
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
        let Some(raw) = table.value().filter(|raw| raw.touch_up.value() != Some(&false)) else { return };
        let names = raw.characters.value();
        let characters = names.map(|names| names.iter().filter_map(|name| self.member(name)).collect());
        if let Some(given) = raw.characters.given().filter(|given| given.value.is_empty()) {
            let help = "name one, or write touch_up = false";
            self.report.fault(&given.place, "nobody is left", help);
        }
        let report = &mut *self.report;
        let is_paper = mode.value() == Some(&values::Mode::Paper);
        let is_single =
            matches!(raw.schedule.value(), Some(WordOr::Word(ScheduleWord::Published))) || is_paper;
        let own_tolerance = amount(&raw.tolerance, FARTHEST_TOLERANCE, "metres", report);
        self.checked.physics = Some(Physics {
            characters,
            target: target(raw, is_paper, report),
            schedule: schedule(&raw.schedule, report),
            rounds: rounds(&raw.rounds, report).unwrap_or(if is_single { 1 } else { 3 }),
            tolerance: own_tolerance.or(is_paper.then_some(0.0)),
            two_axis: raw.two_axis.value() == Some(&true),
            flight: raw.flight.value() != Some(&false),
            table: raw.table.value().copied().unwrap_or(TableWord::Winter75),
            mass: within(&raw.mass, HEAVIEST, "kilograms of a body", report),
        });
    }
}

fn target(raw: &physics_table::Physics, is_paper: bool, report: &mut Report) -> Target {
    let margin = amount(&raw.margin, WIDEST_MARGIN, "a share of the stature", report);
    let is_hull = raw.target.value().map_or(is_paper, |word| *word == TargetWord::Hull);
    if is_hull {
        return Target::Hull(margin.or(is_paper.then_some(0.0)));
    }
    if let Some(given) = raw.margin.given() {
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

fn schedule(field: &Field<WordOr<ScheduleWord, Vec<At<Step>>>>, report: &mut Report) -> Schedule {
    let Some(At { value, place }) = field.given() else { return Schedule::Named(ScheduleWord::Level) };
    let steps = match value {
        WordOr::Word(word) => return Schedule::Named(*word),
        WordOr::Other(steps) => steps,
    };
    if steps.is_empty() || steps.len() > MOST_STEPS {
        let message = format!("a schedule of {} steps", steps.len());
        report.fault(place, message, format!("write 1 to {MOST_STEPS} steps, or touch_up = false"));
    }
    Schedule::Own(steps.iter().map(|own| step(&own.value, &own.place, report)).collect())
}

/// Of a step that says nothing else.
const SHARE: f64 = 0.5;
/// Likewise, frames at 30 a second.
const WIDTH: f64 = 20.0;
/// Likewise, degrees.
const LARGEST_TURN: f64 = 28.0;

fn step(raw: &Step, place: &Place, report: &mut Report) -> TurnStep {
    let turns = parts(&raw.turns, report);
    let keeps = parts(&raw.keeps, report);
    if raw.turns.value().is_some_and(Vec::is_empty) {
        report.fault(place, "nothing turns in this step", "name \"lower\", \"upper\", \"arms\", or a role");
    }
    if let Some(both) = keeps.iter().find(|part| turns.contains(part)) {
        let message = format!("{} is both to turn and to be kept from turning", both.name());
        report.fault(place, message, "name it once");
    }
    let share = within(&raw.share, 1.0, "a share of a turn", report).unwrap_or(SHARE);
    let width = within(&raw.width, 300.0, "frames of a kernel", report).unwrap_or(WIDTH);
    let degrees = within(&raw.largest_turn, 90.0, "degrees of a turn", report).unwrap_or(LARGEST_TURN);
    TurnStep { turns, keeps, share, width, largest_turn: degrees.to_radians() }
}

fn parts(names: &Field<Vec<At<String>>>, report: &mut Report) -> Vec<TurnedPart> {
    let mut known = |name: &At<String>| {
        let part = TurnedPart::named(&name.value);
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

impl TurnedPart {
    fn named(name: &str) -> Option<Self> {
        match name {
            "lower" => Some(Self::Lower),
            "upper" => Some(Self::Upper),
            "arms" => Some(Self::Arms),
            _ => JointRole::named(name).map(Self::Below),
        }
    }

    /// As in a scene file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Lower => "lower",
            Self::Upper => "upper",
            Self::Arms => "arms",
            Self::Below(role) => role.name(),
        }
    }
}
