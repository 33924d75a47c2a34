//! A whole drag update of the spiral relay, beside other libraries on the augmented system of its shape phase.

use crate::configuration::Configuration;
use crate::measure::{DRAG_STEPS, Posed, Run, median, run_peer, timed};
use crate::peer::Library;
use crate::race::{all_fields, best_first, trials};
use cotillion::constraint::{ConstraintKind, Target};
use cotillion::discrete::editor::{DiscreteEditor, Occasion};
use cotillion::discrete::settings::DiscreteSettings;
use cotillion::edit::{Backend, EditError, Editor};
use cotillion::graph::motion_graph;
use cotillion::graph::scene::{graph_settings, scene_clips};
use cotillion::index::ConstraintId;
use cotillion::relay::{Along, Disturbance, Relay, RelayError, relay};
use cotillion::scene::{ClipFolders, Scene, SceneFaults, load_text};
use cotillion_solvers::{CsMat, LeastSquares, RowMatrix, c64};
use std::path::Path;
use std::sync::Arc;

/// Updates of a drag.
pub const UPDATES: usize = 40;

/// How far the end is dragged, metres.
const FAR: f64 = 10.0;

/// Why there is nothing to measure.
#[derive(Debug)]
pub enum Unmeasured {
    /// There is no such relay.
    Relay(RelayError),
    /// Its scene is not sound.
    Scene(SceneFaults),
    /// It cannot be edited.
    Edit(EditError),
    /// No configuration of a library solves its system.
    Peer(Library),
}

impl std::fmt::Display for Unmeasured {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Relay(error) => write!(f, "{error}"),
            Self::Scene(faults) => write!(f, "{faults}"),
            Self::Edit(error) => write!(f, "{error}"),
            Self::Peer(library) => write!(f, "{} does not solve the system", library.name()),
        }
    }
}

impl std::error::Error for Unmeasured {}

impl From<EditError> for Unmeasured {
    fn from(error: EditError) -> Self {
        Self::Edit(error)
    }
}

/// The relay of `characters` along a spiral, a box for each ten of them: for 78, that of `scenes/relay_78.toml`.
pub fn spiral(characters: usize, discrete: bool) -> Relay {
    Relay {
        characters,
        disturbers: None,
        boxes: characters.div_ceil(10),
        spacing: None,
        heights: (1.64, 1.86),
        phase: 0.3,
        disturbances: Disturbance::ALL.to_vec(),
        discrete,
        drag: Some(FAR),
        seed: 1,
        along: Along::Spiral,
    }
}

/// A relay whose end is dragged outwards.
pub struct Dragged {
    scene: Scene,
    end: ConstraintId,
    from: c64,
    to: c64,
}

impl Dragged {
    /// The relay of `characters`.
    ///
    /// # Errors
    /// [`Unmeasured`] where there is none.
    pub fn new(characters: usize) -> Result<Self, Unmeasured> {
        let text = relay(&spiral(characters, true), "a benchmark").map_err(Unmeasured::Relay)?;
        let loaded = load_text(&text, Path::new("relay.toml"), &ClipFolders::default());
        let mut scene = loaded.map_err(Unmeasured::Scene)?.scene;
        let (end, to) = std::mem::take(&mut scene.drags)[0].targets[0];
        let held = &scene.constraints[end.as_usize()].kind;
        let (ConstraintKind::Pin { position: Some(from), .. }, Target::Position(to)) = (held, to) else {
            unreachable!("the end of a relay is a pin on a point, and is dragged to another");
        };
        Ok(Self { from: *from, to, scene, end })
    }

    /// Where the end is after a share of the drag.
    fn target(&self, step: usize, of: usize) -> Target {
        Target::Position(self.from + (self.to - self.from) * (step as f64 / of as f64))
    }

    /// The shape phase of everybody as one problem, with its targets at rest and in the steps of a drag, and our own
    /// solutions by all frames as reference; and how many of its rows fix free motions.
    ///
    /// # Errors
    /// [`Unmeasured::Edit`].
    pub fn posed(&self) -> Result<(Posed, Size), Unmeasured> {
        let mut editor = Editor::of(self.scene.clone(), Backend::Direct)?;
        editor.solve()?;
        let first = Joined::of(&editor);
        let mut sides = vec![first.sides.clone()];
        let mut last = first.solution.clone();
        for step in 1..=DRAG_STEPS {
            editor.move_target(self.end, self.target(step, DRAG_STEPS))?;
            editor.solve()?;
            let dragged = Joined::of(&editor);
            sides.push(dragged.sides);
            last = dragged.solution;
        }
        let posed = Posed::new(&first.problem, &sides, [first.solution, last]);
        Ok((posed, first.size))
    }

    /// Seconds of each update of a drag: everything that moves with the end, all three systems.
    ///
    /// # Errors
    /// [`Unmeasured::Edit`].
    pub fn plain(&self) -> Result<Plain<'_>, Unmeasured> {
        let mut editor = Editor::new(self.scene.clone())?;
        editor.solve()?;
        Ok(Plain { dragged: self, editor })
    }

    /// The same with discrete changes.
    ///
    /// # Errors
    /// [`Unmeasured::Edit`].
    pub fn discrete(&self) -> Result<Discrete<'_>, Unmeasured> {
        let clips = scene_clips(&self.scene);
        let graph = Arc::new(motion_graph(&clips, &graph_settings(self.scene.mode)));
        let settings = DiscreteSettings::of_scene(&self.scene);
        let mut editor = DiscreteEditor::new(self.scene.clone(), (graph, &clips), settings)?;
        editor.update(Occasion::First)?;
        Ok(Discrete { dragged: self, editor })
    }
}

/// How large the problem is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Size {
    /// Complex unknowns.
    pub unknowns: usize,
    /// Rows that hold exactly.
    pub hard: usize,
    /// Of these, rows that fix motions which nothing else holds.
    pub gauges: usize,
}

/// The problems of all groups of characters as one.
struct Joined {
    problem: LeastSquares<c64>,
    sides: (Vec<c64>, Vec<c64>),
    solution: Vec<c64>,
    size: Size,
}

impl Joined {
    fn of(editor: &Editor) -> Self {
        let columns = editor.shape_problems().map(|own| own.problem.columns).sum();
        let (mut soft, mut hard) = (RowMatrix::new(columns), RowMatrix::new(columns));
        let (mut sides, mut solution, mut gauges) = ((Vec::new(), Vec::new()), Vec::new(), 0);
        for own in editor.shape_problems() {
            let shift = solution.len();
            push_rows(&mut soft, &own.problem.soft, shift);
            push_rows(&mut hard, &own.problem.hard, shift);
            sides.0.extend(own.soft_targets);
            sides.1.extend(own.hard_targets);
            solution.extend(own.solution);
            gauges += own.gauges;
        }
        let size = Size { unknowns: columns, hard: hard.rows(), gauges };
        let problem = LeastSquares { columns, soft: soft.to_csr(), hard: hard.to_csr() };
        Self { problem, sides, solution, size }
    }
}

fn push_rows(all: &mut RowMatrix<c64>, own: &CsMat<c64>, shift: usize) {
    for row in own.outer_iterator() {
        let row: Vec<_> = row.iter().map(|(column, value)| (column + shift, *value)).collect();
        all.push_row(&row);
    }
}

/// A drag without changes.
pub struct Plain<'a> {
    dragged: &'a Dragged,
    editor: Editor,
}

impl Plain<'_> {
    /// Seconds of one update.
    ///
    /// # Errors
    /// [`Unmeasured::Edit`].
    pub fn update(&mut self, step: usize) -> Result<f64, Unmeasured> {
        let target = self.dragged.target(step, UPDATES);
        Ok(timed(|| self.editor.move_target(self.dragged.end, target).and_then(|()| self.editor.solve().map(|_| ())))?)
    }
}

/// A drag with changes.
pub struct Discrete<'a> {
    dragged: &'a Dragged,
    editor: DiscreteEditor,
}

impl Discrete<'_> {
    /// Seconds of one update, how many candidates it had, and whether one of them happened.
    ///
    /// # Errors
    /// [`Unmeasured::Edit`].
    pub fn update(&mut self, step: usize) -> Result<(f64, usize, bool), Unmeasured> {
        let target = self.dragged.target(step, UPDATES);
        let occasion = Occasion::Drag { drag: 0, step };
        let mut changed = false;
        let seconds = timed(|| {
            self.editor.move_target(self.dragged.end, target)?;
            changed = self.editor.update(occasion)?;
            Ok::<(), EditError>(())
        })?;
        Ok((seconds, self.editor.candidates(), changed))
    }
}

/// What was measured of one relay.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Everybody.
    pub characters: usize,
    /// Of the problem that other libraries solve.
    pub size: Size,
    /// The best of each library, and medians of its runs.
    pub peers: Vec<(Configuration, Run)>,
    /// Seconds of each update without changes.
    pub plain: Vec<f64>,
    /// Seconds, candidates and whether one happened, of each update with changes.
    pub discrete: Vec<(f64, usize, bool)>,
}

/// Measures in rounds, each of which runs everybody once.
///
/// # Errors
/// [`Unmeasured`].
pub fn measure(characters: usize, libraries: &[Library], budget: f64) -> Result<Measured, Unmeasured> {
    let dragged = Dragged::new(characters)?;
    let (posed, size) = dragged.posed()?;
    let best = libraries.iter().map(|library| best(&posed, *library, budget));
    let best = best.collect::<Result<Vec<_>, _>>()?;
    let (mut plain, mut discrete) = (dragged.plain()?, dragged.discrete()?);
    let mut runs: Vec<Vec<Run>> = vec![Vec::new(); best.len()];
    let mut updates = (Vec::new(), Vec::new());
    for step in 1..=UPDATES {
        for (runs, configuration) in runs.iter_mut().zip(&best) {
            runs.extend(run_peer(&posed, configuration));
        }
        updates.0.push(plain.update(step)?);
        updates.1.push(discrete.update(step)?);
    }
    let runs = runs.iter().map(|runs| crate::measure::summary(runs, crate::measure::Statistic::Median));
    Ok(Measured { characters, size, peers: best.into_iter().zip(runs).collect(), plain: updates.0, discrete: updates.1 })
}

/// The quickest configuration of a library from nothing to a solution, among the accurate ones.
fn best(posed: &Posed, library: Library, budget: f64) -> Result<Configuration, Unmeasured> {
    let fields = all_fields().into_iter().filter(|field| field.library() == Some(library));
    let tried: Vec<_> = fields.flat_map(|mut field| trials(posed, &mut field, budget)).collect();
    // Only from nothing counts here.
    let runs: Vec<_> = tried.iter().map(|(_, run)| run.map(|run| Run { drag: 1.0, ..run })).collect();
    let first = best_first(&runs).first().copied().filter(|first| runs[*first].is_some());
    first.map(|first| tried[first].0.clone()).ok_or(Unmeasured::Peer(library))
}

/// The table: what each takes, and as a share of the first library.
pub fn relay_table(measured: &Measured) -> String {
    let Measured { characters, size, peers, plain, discrete } = measured;
    let Size { unknowns, hard, gauges } = size;
    let mut text = format!(
        "relay of {characters}, its end dragged by {FAR} m in {UPDATES} updates; shape phase: {unknowns} unknowns, {hard} hard rows \
         ({gauges} for free motions)\n{:58}{:>9}{:>10}{:>9}\n",
        "", "ms", "of first", "error"
    );
    let whole = peers.first().map_or(f64::NAN, |(_, run)| run.cold);
    let mut line = |name: String, seconds: f64, error: String| {
        text += &format!("{name:58}{:>9.2}{:>10.3}{error:>9}\n", 1e3 * seconds, seconds / whole);
    };
    for (configuration, run) in peers {
        let name = format!("{}: analyse, factor, solve; shape phase", configuration.library.name());
        line(name, run.cold, format!("{:.0e}", run.error));
    }
    let none = String::new;
    let kept: Vec<f64> = discrete.iter().filter(|update| !update.2).map(|update| update.0).collect();
    let changed: Vec<f64> = discrete.iter().filter(|update| update.2).map(|update| update.0).collect();
    let all: Vec<f64> = discrete.iter().map(|update| update.0).collect();
    line("ours: an update, all three systems, median".to_owned(), median(&mut plain.clone()), none());
    line("  … the longest".to_owned(), largest(plain), none());
    let candidates = discrete.iter().map(|update| update.1);
    let (least, most) = (candidates.clone().min().unwrap_or(0), candidates.max().unwrap_or(0));
    line(format!("ours: with all of {least} to {most} candidates scored, median"), median(&mut all.clone()), none());
    line("  … mean".to_owned(), all.iter().sum::<f64>() / all.len() as f64, none());
    line("  … the longest".to_owned(), largest(&all), none());
    if !kept.is_empty() && !changed.is_empty() {
        line(format!("  … median of {} in which nothing was changed", kept.len()), median(&mut kept.clone()), none());
        line(format!("  … median of {} with a change", changed.len()), median(&mut changed.clone()), none());
    }
    for (configuration, _) in peers {
        text += &format!("{}: {:?} {:?}, {}\n", configuration.library.name(), configuration.numbers, configuration.form, configuration.label);
    }
    text
}

fn largest(seconds: &[f64]) -> f64 {
    seconds.iter().copied().fold(0.0, f64::max)
}
