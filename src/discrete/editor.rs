//! The discrete editor: solves, proposes, and takes the one change that lowers the energy most.
//!
//! Source: Kim et al. 2009, §5 and Algorithm 1, with the energy of [`crate::edit::energy`].

use std::sync::Arc;

use crate::clip::working::WorkingClip;
use crate::discrete::candidates::{Candidate, Seen, candidates};
use crate::discrete::choose::{Offer, Weighed, choose};
use crate::discrete::remap::{Protected, bound, protected, spliced};
use crate::discrete::settings::{DiscreteSettings, Kind};
use crate::edit::energy::Energy;
use crate::edit::{Edit, EditError, Editor, Target};
use crate::geometry::wrap;
use crate::graph::MotionGraph;
use crate::index::{CharacterId, ConstraintId};
use crate::scene::Scene;
use crate::track::Track;

/// A change that was made.
#[derive(Clone, Debug, PartialEq)]
pub struct LogEntry {
    /// On whose track.
    pub character: CharacterId,
    /// Of which type.
    pub kind: Kind,
    /// Name of the place: the moment whose frame precedes the change.
    pub frame: usize,
    /// Frames that came, less those that went.
    pub frames: i64,
    /// Update in which it happened, from 0.
    pub update: usize,
    /// Ê before and after.
    pub energy: (f64, f64),
}

/// A scene that is edited with discrete changes.
pub struct DiscreteEditor {
    editor: Editor,
    graph: Arc<MotionGraph>,
    /// Graph clip of each clip that a character's track may show.
    clips: Vec<Vec<usize>>,
    /// Number of entries of each character's own track, and how the rest motion places them, radians.
    rest_angles: Vec<Vec<f64>>,
    settings: DiscreteSettings,
    updates: usize,
    log: Vec<LogEntry>,
}

impl DiscreteEditor {
    /// Takes a scene and the motion graph of `clips`, which are all that its characters may show besides their own.
    ///
    /// # Errors
    /// Those of [`Editor::new`].
    pub fn new(
        scene: Scene,
        (graph, clips): (Arc<MotionGraph>, &[Arc<WorkingClip>]),
        settings: DiscreteSettings,
    ) -> Result<Self, EditError> {
        let mut scene = bound(scene);
        let rest_angles = scene.characters.iter().map(|character| rest_angles(&character.track)).collect();
        let place = |clip: &Arc<WorkingClip>| clips.iter().position(|known| known == clip);
        let mut seen = Vec::new();
        for character in &mut scene.characters {
            let skeleton = Arc::clone(&character.track.clips[0].clip.skeleton);
            let fits = clips.iter().filter(|clip| clip.clip.skeleton.matches(&skeleton));
            character.track.clips.extend(fits.cloned());
            seen.push(character.track.clips.iter().filter_map(place).collect());
        }
        let editor = Editor::new(scene)?;
        Ok(Self { editor, graph, clips: seen, rest_angles, settings, updates: 0, log: Vec::new() })
    }

    /// The scene as it is now: tracks and targets.
    pub fn scene(&self) -> &Scene {
        self.editor.scene()
    }

    /// Result of the last update.
    pub fn edit(&self) -> &Edit {
        self.editor.edit()
    }

    /// Every change so far.
    pub fn log(&self) -> &[LogEntry] {
        &self.log
    }

    /// Moves the target of a constraint, see [`Editor::move_target`].
    ///
    /// # Errors
    /// As there.
    pub fn move_target(&mut self, constraint: ConstraintId, target: Target) -> Result<(), EditError> {
        self.editor.move_target(constraint, target)
    }

    /// Solves for the present targets and makes the change that lowers Ê most, if one is worth it: at most one, of one
    /// track. Whether one was made.
    ///
    /// # Errors
    /// Those of [`Editor::solve`] for the present tracks; candidates that cannot be solved do not happen.
    pub fn update(&mut self) -> Result<bool, EditError> {
        self.editor.solve()?;
        let before = self.energy().total;
        let offers = self.offers();
        let full = |offer: &Offer| self.weigh(&offer.candidate);
        let choice = choose(offers, before, full, &self.settings);
        self.updates += 1;
        let Some(Weighed { offer, energy }) = choice else { return Ok(false) };
        let Candidate { character, splice, keep, kind, interval, .. } = offer.candidate;
        let track = &self.editor.scene().characters[character.as_usize()].track;
        let (count, changed) = (track.frame_count(), splice.new_count(track.frame_count()));
        let scene = spliced(self.editor.scene(), character, &splice, keep)
            .expect("a candidate keeps every moment, which its energy has shown");
        self.editor = Editor::new(scene)?;
        self.editor.solve()?;
        self.log.push(LogEntry {
            character,
            kind,
            frame: interval.0,
            frames: changed as i64 - count as i64,
            update: self.updates - 1,
            energy: (before, energy),
        });
        Ok(true)
    }

    /// Updates with unchanged targets until nothing is worth it; how many changes were made. It ends: each lowers Ê.
    ///
    /// # Errors
    /// As [`DiscreteEditor::update`].
    pub fn settle(&mut self) -> Result<usize, EditError> {
        let mut changes = 0;
        while self.update()? {
            changes += 1;
        }
        Ok(changes)
    }

    /// Terms of Ê of the present result, turns at seams included.
    pub fn energy(&self) -> Energy {
        let scene = self.editor.scene();
        let tracks = scene.characters.iter().map(|character| &character.track);
        let turns = tracks.zip(&self.rest_angles).map(|(track, angles)| turns(track, angles)).sum::<f64>();
        self.editor.edit().energy.with_turns(self.settings.turn_weight * turns)
    }

    /// All candidates with what is known of their energy before any solve: the turns at seams.
    fn offers(&self) -> Vec<Offer> {
        let scene = self.editor.scene();
        let mut offers = Vec::new();
        let angles = |who: usize, track: &Track| turns(track, &self.rest_angles[who]);
        let all: f64 = scene.characters.iter().enumerate().map(|(who, c)| angles(who, &c.track)).sum();
        for (who, character) in scene.characters.iter().enumerate() {
            let id = CharacterId::from_usize(who);
            let protected = protected(scene, id);
            let found = self.candidates_of(id, &character.track, &protected);
            let own = angles(who, &character.track);
            offers.extend(found.into_iter().map(|candidate| {
                let track = character.track.spliced(&candidate.splice);
                let turned = all - own + angles(who, &track);
                Offer {
                    bound: self.settings.turn_weight * turned,
                    copies: copies(&track, &self.clips[who]),
                    candidate,
                }
            }));
        }
        offers
    }

    fn candidates_of(&self, character: CharacterId, track: &Track, protected: &Protected) -> Vec<Candidate> {
        let still = track.collect(|clip, frame, _| clip.stationary[frame]);
        let clips = &self.clips[character.as_usize()];
        candidates(&self.graph, &Seen { character, track, clips, protected, still: &still }, &self.settings)
    }

    /// Ê if `candidate` happened, for the present targets; `None` where that cannot be solved.
    pub fn weigh(&self, candidate: &Candidate) -> Option<f64> {
        let scene = spliced(self.editor.scene(), candidate.character, &candidate.splice, candidate.keep)?;
        let turned: f64 =
            scene.characters.iter().zip(&self.rest_angles).map(|(c, angles)| turns(&c.track, angles)).sum();
        let mut editor = Editor::new(scene).ok()?;
        let energy = editor.solve().ok()?.energy;
        Some(energy.with_turns(self.settings.turn_weight * turned).total)
    }
}

/// How the rest motion turns each entry of a track; entries that it does not show follow none.
fn rest_angles(track: &Track) -> Vec<f64> {
    track.runs.iter().map(|run| run.placement.angle()).collect()
}

/// Sum of the turns of what follows at every seam that discrete changes made, radians: by how much the run after it lies
/// turned to the one before it, more than they did before all changes.
fn turns(track: &Track, rest: &[f64]) -> f64 {
    let mut before = 0.0;
    let mut sum = 0.0;
    for run in track.runs.iter().filter(|run| run.entry < rest.len()) {
        let turned = run.placement.angle() - rest[run.entry];
        sum += wrap(turned - before).abs();
        before = turned;
    }
    sum
}

/// How often one source frame is shown at most; `clips`: graph clip of each entry.
fn copies(track: &Track, clips: &[usize]) -> usize {
    let mut ends: Vec<(usize, u32, i32)> = Vec::new();
    for run in &track.runs {
        ends.push((clips[run.entry], run.first.0, 1));
        ends.push((clips[run.entry], run.last.0 + 1, -1));
    }
    ends.sort_unstable_by_key(|(clip, frame, change)| (*clip, *frame, *change));
    let mut shown = 0;
    let most = ends.iter().map(|(_, _, change)| {
        shown += change;
        shown
    });
    usize::try_from(most.max().unwrap_or(0)).unwrap_or(0)
}
