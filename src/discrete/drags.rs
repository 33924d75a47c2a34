//! Scripted manipulation: every drag of a scene in equal steps, one update each, then settling.

use std::sync::Arc;

use crate::clip::working::WorkingClip;
use crate::constraint::{Constraint, ConstraintKind, Relation, Target};
use crate::discrete::editor::{DiscreteEditor, Occasion};
use crate::discrete::settings::DiscreteSettings;
use crate::edit::EditError;
use crate::geometry::wrap;
use crate::graph::MotionGraph;
use crate::scene::Scene;

/// Takes the scene through its first solve and all drags, and lets it settle. `graph`: of `clips`, those of the scene ([`crate::graph::scene`]); without
/// discrete editing it is not looked at. `told`: after each update, how many there were and of how many, settling left out.
///
/// # Errors
/// Those of [`DiscreteEditor::update`].
pub fn perform(
    scene: Scene,
    graph: Arc<MotionGraph>,
    clips: &[Arc<WorkingClip>],
    mut told: impl FnMut(usize, usize),
) -> Result<DiscreteEditor, EditError> {
    let drags = scene.drags.clone();
    let settles = scene.discrete.as_ref().is_some_and(|discrete| discrete.settle);
    let settings = DiscreteSettings::of_scene(&scene);
    let mut editor = DiscreteEditor::new(scene, (graph, clips), settings)?;
    let all = 1 + drags.iter().map(|drag| drag.steps).sum::<usize>();
    editor.update(Occasion::First)?;
    told(1, all);
    let mut updates = 1;
    for (index, drag) in drags.iter().enumerate() {
        let from: Vec<Option<Target>> = drag
            .targets
            .iter()
            .map(|(id, to)| present(&editor.scene().constraints[id.as_usize()], *to))
            .collect();
        for step in 1..=drag.steps {
            let share = step as f64 / drag.steps as f64;
            for ((constraint, to), from) in drag.targets.iter().zip(&from) {
                let target = from.map_or(*to, |from| between(from, *to, share));
                editor.move_target(*constraint, target)?;
            }
            editor.update(Occasion::Drag { drag: index, step })?;
            updates += 1;
            told(updates, all);
        }
    }
    if settles {
        editor.settle()?;
    }
    Ok(editor)
}

/// Where the number that `to` moves is now.
fn present(constraint: &Constraint, to: Target) -> Option<Target> {
    match (&constraint.kind, to) {
        (ConstraintKind::Pin { position, .. }, Target::Position(_)) => position.map(Target::Position),
        (ConstraintKind::Pin { facing, .. }, Target::Facing(_)) => facing.map(Target::Facing),
        (ConstraintKind::Relative { offset: Relation::Given(offset), .. }, Target::Offset(_)) => {
            Some(Target::Offset(*offset))
        }
        (ConstraintKind::Relative { facing: Relation::Given(facing), .. }, Target::Facing(_)) => {
            Some(Target::Facing(*facing))
        }
        (
            ConstraintKind::Time { seconds, .. }
            | ConstraintKind::Duration { seconds, .. }
            | ConstraintKind::Sync { offset: seconds, .. },
            Target::Seconds(_),
        ) => Some(Target::Seconds(*seconds)),
        _ => None,
    }
}

/// A share of the way from one target to another of its kind; facings turn the shorter way.
fn between(from: Target, to: Target, share: f64) -> Target {
    match (from, to) {
        _ if share >= 1.0 => to,
        (Target::Position(a), Target::Position(b)) => Target::Position(a + share * (b - a)),
        (Target::Offset(a), Target::Offset(b)) => Target::Offset(a + share * (b - a)),
        (Target::Facing(a), Target::Facing(b)) => Target::Facing(a + share * wrap(b - a)),
        (Target::Seconds(a), Target::Seconds(b)) => Target::Seconds(a + share * (b - a)),
        (_, to) => to,
    }
}
