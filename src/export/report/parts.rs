//! Reports in parts: what needs bodies, of some characters at a time, and what does not.

use std::collections::BTreeSet;

use rayon::prelude::*;

use super::{
    CharacterReport, ConstraintReport, MomentReport, Report, Timing, character_report, constraint_report,
    hands_report, object_report, strength,
};
use crate::clip::Clip;
use crate::constraint::{Constraint, Moment};
use crate::discrete::outcome::Outcome;
use crate::edit::Moved;
use crate::embody::Embodied;
use crate::export::physics_report::physics_report;
use crate::index::CharacterId;
use crate::object_motion::object_motions;
use crate::plausible::TouchUps;
use crate::reach::{Miss, Stage, carry_residuals_of, effector_residual};
use crate::resample::Resampled;
use crate::residual::{Demands, MomentTime, Residual, Stances, moment_times};
use crate::scene::Scene;
use crate::ties::Ties;

/// What a report tells of some characters: all that needs their bodies.
#[derive(Clone, Debug, Default)]
pub struct PartReport {
    /// Of each of them.
    pub characters: Vec<(CharacterId, CharacterReport)>,
    /// Where they are wherever something is held of them.
    pub stances: Stances,
    /// By how much their hands miss what they carry, by position in [`Scene::carries`](crate::scene::Scene::carries); some more
    /// than once, metres.
    pub carries: Vec<(usize, f64)>,
    /// By how much their end effectors miss, by position in [`Scene::end_effectors`](crate::scene::Scene::end_effectors).
    pub effectors: Vec<(usize, Miss)>,
}

/// What reports are made of, but for bodies.
pub struct Setting<'a> {
    /// The scene as performed before the full body.
    pub stage: Stage<'a, Moved<'a>>,
    /// What its constraints hold.
    pub demands: &'a Demands,
    /// What became of it.
    pub outcome: &'a Outcome,
    /// Scene time of output frame 0, and output frames of the scene.
    pub clock: (f64, usize),
}

/// Reports on those who are in `resampled`. Cost: linear in their output frames and joints.
pub fn part_report(setting: &Setting<'_>, embodied: &Embodied<'_>, resampled: &Resampled) -> PartReport {
    let Setting { stage, demands, outcome, .. } = setting;
    let about = |(who, clip): (&CharacterId, &Clip)| {
        let clock = (resampled.start_time, clip.frame_count());
        let effectors = stage.ties.effectors[who.as_usize()].iter().copied();
        let own = effectors.filter(|index| stage.scene.end_effectors[*index].when.character() == *who);
        PartReport {
            characters: vec![(*who, character_report((embodied, stage.ties), outcome, clock, *who))],
            stances: demands.stances((stage.scene, &outcome.edit), embodied, *who),
            carries: carry_residuals_of(stage, embodied, *who),
            effectors: own.map(|index| (index, effector_residual(stage, embodied, index))).collect(),
        }
    };
    let members: Vec<(&CharacterId, &Clip)> = resampled.members.iter().zip(&resampled.clips).collect();
    let all: Vec<PartReport> = members.into_par_iter().map(about).collect();
    all.into_iter().fold(PartReport::default(), PartReport::and)
}

impl PartReport {
    /// Whom it tells of.
    pub fn members(&self) -> BTreeSet<CharacterId> {
        self.characters.iter().map(|(who, _)| *who).collect()
    }

    /// With what became of those who were to be touched up, whose motion is written as in `resampled`. Cost: linear in its frames.
    #[must_use]
    pub fn with_physics(mut self, touch_ups: &TouchUps, resampled: &Resampled) -> Self {
        self.characters.par_iter_mut().for_each(|(who, own)| {
            let told = touch_ups.get(who).zip(resampled.clip(*who));
            own.physics = told.map(|(touched, written)| physics_report(touched, written));
        });
        self
    }

    /// This and another.
    #[must_use]
    pub fn and(mut self, mut other: Self) -> Self {
        self.characters.append(&mut other.characters);
        self.stances.append(&mut other.stances);
        self.carries.append(&mut other.carries);
        self.effectors.append(&mut other.effectors);
        self
    }
}

/// Reports on an edit at once; files and times are filled in where files are written and clocks are read.
pub fn report(embodied: &Embodied<'_>, outcome: &Outcome, resampled: &Resampled) -> Report {
    let moved = embodied.moved;
    let (objects, ties) = (object_motions(moved.scene, &moved), Ties::of(moved.scene));
    let stage = Stage { scene: moved.scene, performance: &moved, objects: &objects, ties: &ties };
    let demands = Demands::of((moved.scene, &outcome.edit), &objects);
    let clock = (resampled.start_time, resampled.frames);
    let setting = Setting { stage, demands: &demands, outcome, clock };
    let part = part_report(&setting, embodied, resampled);
    whole_report(&setting, part)
}

/// The report of a scene from that of all its characters, or of some: then constraints that hold others are missed by nothing in
/// it ([`is_told`]). `part`: with the stances of those to whom the characters are held.
pub fn whole_report(setting: &Setting<'_>, mut part: PartReport) -> Report {
    let scene = setting.stage.scene;
    part.characters.sort_by_key(|(who, _)| *who);
    let own = part.members();
    let edited = (scene, &setting.outcome.edit);
    let residuals = setting.demands.residuals_of(edited, &part.stances, |who| own.contains(&who));
    let misses = Misses::of(scene.carries.len(), scene.end_effectors.len(), &part);
    Report {
        characters: part.characters.into_iter().map(|(_, own)| own).collect(),
        constraints: constraints(setting, &residuals, &misses),
        ..head(setting)
    }
}

/// Which entries of a report's constraints a report of some characters can tell of.
pub fn is_told(scene: &Scene, own: &BTreeSet<CharacterId>) -> Vec<bool> {
    let first = |moments: Vec<&Moment>| moments.first().is_none_or(|moment| own.contains(&moment.character));
    let constraints = scene.constraints.iter().map(|constraint| first(constraint.kind.moments()));
    let carries = scene.carries.iter().map(|carry| carry.by.iter().any(|who| own.contains(who)));
    let effectors = scene.end_effectors.iter().map(|effector| own.contains(&effector.when.character()));
    constraints.chain(carries).chain(effectors).collect()
}

/// By how much hands and other ends miss.
struct Misses {
    carries: Vec<Miss>,
    effectors: Vec<Miss>,
}

impl Misses {
    fn of(carries: usize, effectors: usize, part: &PartReport) -> Self {
        let mut own =
            Self { carries: vec![Miss::default(); carries], effectors: vec![Miss::default(); effectors] };
        for (index, metres) in &part.carries {
            own.carries[*index].metres = own.carries[*index].metres.max(*metres);
        }
        part.effectors.iter().for_each(|(index, miss)| own.effectors[*index] = *miss);
        own
    }
}

fn constraints(setting: &Setting<'_>, residuals: &[Residual], misses: &Misses) -> Vec<ConstraintReport> {
    let scene = setting.stage.scene;
    let about = |(constraint, residual): (&Constraint, &Residual)| {
        constraint_report(
            (&constraint.name, constraint.kind.keyword().into(), strength(constraint)),
            residual,
        )
    };
    let carries = scene.carries.iter().map(|carry| &carry.name).zip(&misses.carries);
    let effectors = scene.end_effectors.iter().map(|reach| &reach.name).zip(&misses.effectors);
    (scene.constraints.iter().zip(residuals).map(about))
        .chain(carries.map(|(name, miss)| hands_report(name, "carry".into(), miss)))
        .chain(effectors.map(|(name, miss)| hands_report(name, "end_effector".into(), miss)))
        .collect()
}

/// What a report tells without any body: no characters, no constraints.
fn head(setting: &Setting<'_>) -> Report {
    let Setting { stage, outcome, clock, .. } = setting;
    let (scene, edit) = (stage.scene, &outcome.edit);
    Report {
        scene: scene.title.clone(),
        cotillion: env!("CARGO_PKG_VERSION"),
        fps: scene.fps,
        start_time: clock.0,
        characters: Vec::new(),
        objects: stage
            .objects
            .iter()
            .map(|motion| object_report(stage.performance, motion, *clock))
            .collect(),
        constraints: Vec::new(),
        moments: moment_times(scene, edit)
            .into_iter()
            .map(|MomentTime { name, time }| MomentReport { name, time })
            .collect(),
        energy: edit.energy,
        notes: edit.notes.iter().map(ToString::to_string).collect(),
        files: Vec::new(),
        timing_ms: Timing::default(),
    }
}
