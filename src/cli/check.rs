//! `cotillion check`: every fault of every scene, and nothing solved.

use cotillion::scene::{ClipFolders, Diagnostic, Loaded, load};
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
    warnings: Vec<Diagnostic>,
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
                    warnings,
                });
            }
            Err(found) => faults.push(found),
        }
    }
    for Sound { file, characters, frames, constraints, .. } in &sound {
        output.say(&format!(
            "{file}: sound ({characters} characters, {frames} working frames, {constraints} constraints)\n"
        ));
    }
    output.print_json(&sound);
    if faults.is_empty() {
        return Ok(());
    }
    output.faults(&faults);
    Err(Failure::BadInput)
}
