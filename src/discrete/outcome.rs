//! What came of a scene: the motion as it was, the tracks as they are now, and every change in between.

use crate::discrete::editor::LogEntry;
use crate::edit::{Edit, EditNote};
use crate::scene::Scene;

/// A scene after its edit, drags and discrete changes included.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// As it was before all drags and changes.
    pub original: Scene,
    /// With the tracks and targets of the end.
    pub scene: Scene,
    /// Its edit.
    pub edit: Edit,
    /// Every change, in order.
    pub log: Vec<LogEntry>,
    /// What became of each track; empty where no track could change.
    pub tracks: Vec<TrackChanges>,
}

/// What became of a track.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackChanges {
    /// Ground length of the edited path over that of the changed track before bending.
    pub length: f64,
    /// Duration of the edited track over that of the changed track before warping.
    pub time: f64,
    /// Sum of the turns at the seams of changes, radians.
    pub turns: f64,
    /// How often one source frame is shown at most.
    pub copies: usize,
    /// Whether any change is left that would have its path stretched less.
    pub open: bool,
}

/// A path is noticeably stretched beyond this.
const NOTICEABLE: f64 = 0.1;

impl Outcome {
    /// That of a scene without drags and changes.
    pub fn plain((scene, edit): (Scene, Edit)) -> Self {
        Self { original: scene.clone(), scene, edit, log: Vec::new(), tracks: Vec::new() }
    }

    /// Adds a note for everybody whose path is stretched and whose track has nothing to offer against it.
    pub(super) fn noted(mut self) -> Self {
        for (track, character) in self.tracks.iter().zip(&self.scene.characters) {
            if !track.open && (track.length - 1.0).abs() > NOTICEABLE {
                let character = character.name.clone();
                self.edit.notes.push(EditNote::NothingFits { character, ratio: track.length });
            }
        }
        self
    }
}
