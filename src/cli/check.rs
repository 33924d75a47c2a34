//! `cotillion check`: every fault of every scene, and nothing solved.

use cotillion::constraint::{Drag, Target};
use cotillion::index::ConstraintId;
use cotillion::scene::{ClipFolders, Diagnostic, Loaded, Scene, load};
use serde::Serialize;

use super::output::Output;
use super::{CheckArgs, Failure};

/// What is known of a sound scene.
#[derive(Debug, Serialize)]
struct Sound {
    file: String,
    characters: usize,
    frames: usize,
    constraints: usize,
    drags: Vec<Dragged>,
    /// Whether what comes of the drags depends on where they end only.
    reversible: bool,
    warnings: Vec<Diagnostic>,
}

/// What a drag moves.
#[derive(Debug, Serialize)]
struct Dragged {
    handle: String,
    /// Names of constraints, each with what of it moves.
    moves: Vec<(String, &'static str)>,
    steps: usize,
}

pub(crate) fn check(args: &CheckArgs) -> Result<(), Failure> {
    let output = Output::new(args.manner);
    let folders = ClipFolders::from_environment();
    let (mut sound, mut faults) = (Vec::new(), Vec::new());
    for path in &args.scenes {
        match load(path, &folders) {
            Ok(Loaded { scene, warnings, text }) => {
                output.warnings(&warnings, &text);
                sound.push(Sound {
                    file: path.display().to_string(),
                    characters: scene.characters.len(),
                    frames: scene.characters.iter().map(|character| character.track.frame_count()).sum(),
                    constraints: scene.constraints.len(),
                    drags: dragged(&scene),
                    reversible: scene.discrete.as_ref().is_some_and(|discrete| discrete.reversible),
                    warnings,
                });
            }
            Err(found) => faults.push(found),
        }
    }
    for Sound { file, characters, frames, constraints, drags, reversible, .. } in &sound {
        output.say(&format!(
            "{file}: sound ({characters} characters, {frames} working frames, {constraints} constraints)\n"
        ));
        for Dragged { handle, moves, steps } in drags {
            let moves: Vec<String> =
                moves.iter().map(|(name, what)| format!("the {what} of {name}")).collect();
            output.say(&format!("  {handle} drags {} in {steps} steps\n", moves.join(" and ")));
        }
        if *reversible {
            output.say("  steps come and go by where the handles are, whatever way they took\n");
        }
    }
    output.print_json(&sound);
    if faults.is_empty() {
        return Ok(());
    }
    output.faults(&faults);
    Err(Failure::BadInput)
}

fn dragged(scene: &Scene) -> Vec<Dragged> {
    let moves = |drag: &Drag| {
        let named = |(id, target): &(ConstraintId, Target)| {
            (scene.constraints[id.as_usize()].name.clone(), target.name())
        };
        drag.targets.iter().map(named).collect()
    };
    let all = scene.drags.iter();
    all.map(|drag| Dragged { handle: drag.handle.clone(), moves: moves(drag), steps: drag.steps }).collect()
}
