//! What a scene's settings mean to the touch-up.

use crate::physics::body_model::{BodySettings, MassTable, REFERENCE_MASS};
use crate::physics::flight::FlightSettings;
use crate::physics::ground::parts::Part;
use crate::physics::ground::schedule::{Step, five_five_two, level, uphill};
use crate::physics::ground::target::{Source, Target};
use crate::physics::ground::{GroundSettings, MARGIN};
use crate::physics::touch_up::TouchUpSettings;
use crate::scene::physics::{self, Physics, Schedule, TurnStep, TurnedPart};
use crate::scene::physics_table::{ScheduleWord, TableWord};

/// What is as near as the source but for rounding is good enough, metres.
const ROUNDING: f64 = 1e-9;

/// How a motion edited from `source` is touched up.
pub fn touch_up(physics: &Physics, source: &Source) -> TouchUpSettings {
    let of_source = || source.distances[0].map_or(0.0, |distance| distance.mean + ROUNDING);
    let ground = GroundSettings {
        schedule: schedule(&physics.schedule),
        rounds: physics.rounds,
        tolerance: physics.tolerance.unwrap_or_else(of_source),
        target: match physics.target {
            physics::Target::Carried => Target::Carried,
            physics::Target::Hull(margin) => Target::Hull { margin: margin.unwrap_or(MARGIN) },
        },
        two_axis: physics.two_axis,
        ..GroundSettings::default()
    };
    TouchUpSettings { ground, flight: physics.flight.then(FlightSettings::default) }
}

/// What bodies weigh.
pub fn body(physics: &Physics) -> BodySettings {
    let table = match physics.table {
        TableWord::Winter75 => MassTable::Winter75,
        TableWord::Xiao2005 => MassTable::Xiao2005,
    };
    BodySettings { table, mass: physics.mass.unwrap_or(REFERENCE_MASS) }
}

fn schedule(schedule: &Schedule) -> Vec<Step> {
    match schedule {
        Schedule::Named(ScheduleWord::Level) => level(),
        Schedule::Named(ScheduleWord::Uphill) => uphill(),
        Schedule::Named(ScheduleWord::Published) => five_five_two(),
        Schedule::Own(steps) => steps.iter().map(step).collect(),
    }
}

fn step(step: &TurnStep) -> Step {
    let parts = |parts: &[TurnedPart]| parts.iter().map(|own| part(*own)).collect();
    Step {
        turned: parts(&step.turns),
        carried: parts(&step.keeps),
        width: step.width,
        share: step.share,
        largest_turn: step.largest_turn,
    }
}

fn part(part: TurnedPart) -> Part {
    match part {
        TurnedPart::Lower => Part::Lower,
        TurnedPart::Upper => Part::Upper,
        TurnedPart::Arms => Part::Arms,
        TurnedPart::Below(role) => Part::Below(role),
    }
}
