//! The discrete editor: solves, proposes, and takes the one change that lowers the energy most.
//!
//! Source: Kim et al. 2009, §5 and Algorithm 1, with the energy of [`crate::edit::energy`].

mod anchored;
mod choice;
mod told;

use std::sync::{Arc, OnceLock};

use rayon::prelude::*;

use crate::clip::working::WorkingClip;
use crate::constraint::{ChangeKind, Evaluator};
use crate::discrete::candidates::{Candidate, Seen, candidates};
use crate::discrete::choose::worth;
use crate::discrete::outcome::Outcome;
use crate::discrete::remap::{Protected, bound, protected, spliced};
use crate::discrete::settings::DiscreteSettings;
use crate::discrete::tracks::{copies, open, rest_angles, sequence, turns};
use crate::discrete::undo::{Made, record, with_undos};
use crate::discrete::weighing::{Proposal, Timings};
use crate::edit::energy::Energy;
use crate::edit::expand::capture;
use crate::edit::{Edit, EditError, Editor, GroupResponse, Target};
use crate::graph::MotionGraph;
use crate::index::{CharacterId, ConstraintId};
use crate::scene::Scene;
use crate::track::Track;

use anchored::AnchoredSearch;

/// When an update happens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Occasion {
    /// Before all drags.
    First,
    /// In a step of a drag.
    Drag {
        /// Which drag, from 0.
        drag: usize,
        /// Which of its steps, from 1.
        step: usize,
    },
    /// After all drags.
    Settling,
}

/// A change that was made.
#[derive(Clone, Debug, PartialEq)]
pub struct LogEntry {
    /// On whose track.
    pub character: CharacterId,
    /// Of which type.
    pub kind: ChangeKind,
    /// The first frame that came or went: clip and file frame, as moments name them.
    pub at: String,
    /// Track frames before the change that came or went, or the one after which others came, twice.
    pub interval: (usize, usize),
    /// Working frames that came, less those that went.
    pub frames: i64,
    /// When.
    pub occasion: Occasion,
    /// Whether it takes an earlier change back.
    pub undo: bool,
    /// Ê before and after the update; infinite where the tracks before it cannot reach the targets.
    pub energy: (f64, f64),
}

/// A scene that is edited with discrete changes.
pub struct DiscreteEditor {
    original: Scene,
    editor: Editor,
    graph: Arc<MotionGraph>,
    /// Graph clip of each clip that a character's track may show.
    clips: Vec<Vec<usize>>,
    /// Number of entries of each character's own track, and how the rest motion places them, radians.
    rest_angles: Vec<Vec<f64>>,
    settings: DiscreteSettings,
    log: Vec<LogEntry>,
    /// Every change so far, to be taken back; none where every update starts at rest.
    made: Vec<Made>,
    /// Where every update starts at rest.
    search: Option<Box<AnchoredSearch>>,
    /// Of each character; `None` where the track has changed since.
    proposals: Vec<Option<Vec<Proposal>>>,
    /// Of each character, since systems were last factored.
    responses: Vec<OnceLock<Option<GroupResponse>>>,
    /// Of candidates, since times were last solved.
    timings: Timings,
}

/// A candidate, and what is known of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Appraisal {
    /// What would happen.
    pub candidate: Candidate,
    /// Ê is at least this.
    pub bound: f64,
    /// Its Ê as the present factorisations tell it; `None` where they do not.
    pub estimate: Option<f64>,
    /// Its Ê; `None` where it cannot be solved.
    pub energy: Option<f64>,
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
        let original = scene.clone();
        let mut scene = bound(scene);
        let rests: Vec<_> = scene.characters.iter().map(|character| character.track.rest_path()).collect();
        scene.captured = capture(&scene, &rests);
        let rest_angles = scene.characters.iter().map(|character| rest_angles(&character.track)).collect();
        let place = |clip: &Arc<WorkingClip>| clips.iter().position(|known| known == clip);
        let mut seen = Vec::new();
        for character in &mut scene.characters {
            let skeleton = Arc::clone(&character.track.clips[0].clip.skeleton);
            let fits = clips.iter().filter(|clip| clip.clip.skeleton.matches(&skeleton));
            character.track.clips.extend(fits.cloned());
            seen.push(character.track.clips.iter().filter_map(place).collect());
        }
        let proposals = scene.characters.iter().map(|_| None).collect();
        let responses = scene.characters.iter().map(|_| OnceLock::new()).collect();
        let editor = Editor::of(scene, settings.backend)?;
        let search = settings.reversible.then(|| Box::new(AnchoredSearch::new(&editor)));
        let (log, made, clips) = (Vec::new(), Vec::new(), seen);
        Ok(Self {
            original,
            editor,
            graph,
            clips,
            rest_angles,
            settings,
            log,
            made,
            search,
            proposals,
            responses,
            timings: Timings::default(),
        })
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
        if !matches!(target, Target::Position(_) | Target::Seconds(_)) {
            // An offset between characters is a coefficient of its row.
            self.forget_systems();
        }
        self.editor.move_target(constraint, target)?;
        if let Some(search) = &mut self.search {
            search.move_target(constraint, target);
        }
        Ok(())
    }

    /// See [`Editor::reassemble`].
    pub fn reassemble(&mut self) {
        self.forget_systems();
        self.editor.reassemble();
    }

    /// Solves for the present targets and makes the change that lowers Ê most, if one is worth it: at most one, of one
    /// track. Whether one was made. Reversible settings: takes the tracks to those that a search from rest finds for the
    /// present targets, by as many changes as that takes.
    ///
    /// # Errors
    /// Those of [`Editor::solve`] for the present tracks; candidates that cannot be solved do not happen.
    pub fn update(&mut self, occasion: Occasion) -> Result<bool, EditError> {
        if let Some(mut search) = self.search.take() {
            let changed = self.update_from_rest(&mut search, occasion);
            self.search = Some(search);
            return changed;
        }
        self.solve()?;
        let before = self.energy().total;
        self.propose();
        let Some(candidate) = self.choose(before) else { return Ok(false) };
        let taken = self.take(&candidate, (before, occasion));
        if taken || self.settings.evaluator == Evaluator::Subsampled {
            return Ok(taken);
        }
        // What the present factorisations told did not come true.
        let Some(candidate) = self.choose_weighed(before) else { return Ok(false) };
        Ok(self.take(&candidate, (before, occasion)))
    }

    /// Solves for the present targets.
    fn solve(&mut self) -> Result<(), EditError> {
        let (regrouped, timed) = (self.editor.regrouped(), self.editor.timed());
        let solved = self.editor.solve().map(|_| ());
        if self.editor.regrouped() != regrouped {
            self.forget_systems();
        }
        if self.editor.timed() != timed {
            self.timings = Timings::default();
        }
        solved
    }

    /// Makes a change if it is worth it; whether it was made.
    fn take(&mut self, candidate: &Candidate, (before, occasion): (f64, Occasion)) -> bool {
        let Candidate { character, splice, keep, .. } = candidate;
        let mut entry = self.entry(candidate, occasion, (before, before));
        let track = self.editor.scene().characters[character.as_usize()].track.clone();
        let Some(scene) = spliced(self.editor.scene(), *character, splice, *keep) else { return false };
        let mut next = Editor::assemble(scene, self.settings.backend);
        next.adopt(&self.editor, *character);
        if next.factor().is_err() || next.solve().is_err() {
            return false;
        }
        let before_it = std::mem::replace(&mut self.editor, next);
        let energy = self.energy().total;
        if energy >= worth(before, &self.settings) {
            self.editor = before_it;
            return false;
        }
        self.forget(*character);
        entry.energy = (before, energy);
        entry.undo = self.settings.undo && record(&mut self.made, candidate, &track);
        self.log.push(entry);
        true
    }

    /// What to log of a candidate if it happens to the present tracks.
    fn entry(&self, candidate: &Candidate, occasion: Occasion, energy: (f64, f64)) -> LogEntry {
        let Candidate { character, splice, kind, interval, .. } = candidate;
        let count = self.editor.scene().characters[character.as_usize()].track.frame_count();
        LogEntry {
            character: *character,
            kind: *kind,
            at: self.place(*character, interval.0),
            interval: *interval,
            frames: gained(count, splice.new_count(count)),
            occasion,
            undo: false,
            energy,
        }
    }

    /// Updates with unchanged targets until nothing is worth it; how many changes were made. It ends: each lowers Ê.
    ///
    /// # Errors
    /// As [`DiscreteEditor::update`].
    pub fn settle(&mut self) -> Result<usize, EditError> {
        let mut changes = 0;
        while self.update(Occasion::Settling)? {
            changes += 1;
        }
        Ok(changes)
    }

    /// What came of the scene.
    pub fn into_outcome(self) -> Outcome {
        let changeable = if self.settings.kinds.is_empty() { 0 } else { self.scene().characters.len() };
        let tracks = (0..changeable).map(|who| self.changes(who)).collect();
        let energy = self.energy();
        let Self { original, editor, log, .. } = self;
        let (scene, mut edit) = editor.into_parts();
        edit.energy = energy;
        Outcome { original, scene, edit, log, tracks }.noted()
    }

    /// Terms of Ê of the present result, turns at seams included.
    pub fn energy(&self) -> Energy {
        let scene = self.editor.scene();
        let tracks = scene.characters.iter().map(|character| &character.track);
        let turns = tracks.zip(&self.rest_angles).map(|(track, angles)| turns(track, angles)).sum::<f64>();
        self.editor.edit().energy.with_turns(self.settings.turn_weight * turns)
    }

    fn candidates_of(&self, character: CharacterId, track: &Track, protected: &Protected) -> Vec<Candidate> {
        let open = open(self.editor.scene(), character);
        if self.settings.kinds.is_empty() || !open.contains(&true) {
            return Vec::new();
        }
        let still = track.collect(|clip, frame, _| clip.stationary[frame]);
        let clips = &self.clips[character.as_usize()];
        let seen = Seen { character, track, clips, protected, still: &still, open: &open };
        let found = candidates(&self.graph, &seen, &self.settings);
        if self.settings.undo { with_undos(&seen, found, &self.made) } else { found }
    }

    /// Ê if `candidate` happened, for the present targets; `None` where that cannot be solved. Solves everything anew.
    pub fn weigh(&self, candidate: &Candidate) -> Option<f64> {
        let scene = spliced(self.editor.scene(), candidate.character, &candidate.splice, candidate.keep)?;
        let turned: f64 =
            scene.characters.iter().zip(&self.rest_angles).map(|(c, angles)| turns(&c.track, angles)).sum();
        let mut editor = Editor::of(scene, self.settings.backend).ok()?;
        let energy = editor.solve().ok()?.energy;
        Some(energy.with_turns(self.settings.turn_weight * turned).total)
    }

    /// How many candidates there are. Cost: that of finding those of tracks that have changed.
    pub fn candidates(&mut self) -> usize {
        self.propose();
        self.known().len()
    }

    /// All candidates for the targets of the last solve, each with its lower bound and its Ê, in the order of their
    /// characters. Cost: that of weighing all.
    pub fn appraise(&mut self) -> Vec<Appraisal> {
        self.propose();
        let (weighing, all) = (self.weighing(), self.known());
        let appraisal = |proposal: &&Proposal| Appraisal {
            candidate: proposal.candidate.clone(),
            bound: weighing.bound(proposal),
            estimate: weighing.estimate(proposal, 0.0, f64::INFINITY),
            energy: weighing.energy(proposal),
        };
        all.par_iter().map(appraisal).collect()
    }

    /// Finds the candidates of tracks that changed since they were last asked for.
    fn propose(&mut self) {
        let scene = self.editor.scene();
        let stale: Vec<usize> =
            (0..scene.characters.len()).filter(|who| self.proposals[*who].is_none()).collect();
        let find = |who: usize| {
            let id = CharacterId::from_usize(who);
            let track = &scene.characters[who].track;
            let found = self.candidates_of(id, track, &protected(scene, id));
            let proposal = |candidate: Candidate| {
                let after = track.spliced(&candidate.splice);
                let (turned, copies) =
                    (turns(&after, &self.rest_angles[who]), copies(&after, &self.clips[who]));
                let repeats = sequence(&after, &self.clips[who]) == sequence(track, &self.clips[who]);
                Proposal::new(candidate, (turned, copies), repeats)
            };
            found.into_iter().map(proposal).collect()
        };
        let found: Vec<Vec<Proposal>> = stale.par_iter().map(|who| find(*who)).collect();
        for (who, found) in stale.into_iter().zip(found) {
            self.proposals[who] = Some(found);
        }
    }

    /// Forgets what holds for the systems as they were factored only.
    fn forget_systems(&mut self) {
        self.responses.iter_mut().for_each(|known| *known = OnceLock::new());
        self.timings = Timings::default();
        for proposal in self.proposals.iter_mut().flatten().flatten() {
            proposal.forget_exchange();
        }
    }

    /// Forgets what was found for the track of `character`, and what its partners' candidates read of it.
    fn forget(&mut self, character: CharacterId) {
        self.forget_systems();
        self.proposals[character.as_usize()] = None;
        let constraints = self.editor.scene().constraints.iter();
        let tied = constraints.filter(|constraint| constraint.kind.names(character));
        let partners = tied.flat_map(|constraint| constraint.kind.moments()).map(|moment| moment.character);
        for partner in partners {
            for proposal in self.proposals[partner.as_usize()].iter_mut().flatten() {
                proposal.variant = OnceLock::new();
            }
        }
    }
}

/// Frames that came, less those that went.
fn gained(count: usize, changed: usize) -> i64 {
    let difference = i64::try_from(changed.abs_diff(count)).expect("tracks have fewer than 2^63 frames");
    if changed < count { -difference } else { difference }
}
