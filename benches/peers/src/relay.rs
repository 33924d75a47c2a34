//! A whole drag update of the spiral relay, beside other libraries on the augmented system of its shape phase.

use crate::configuration::Configuration;
use crate::measure::{DRAG_STEPS, Posed, Run, Statistic, median, run_peer, summary, timed};
use crate::peer::Library;
use crate::race::{Field, all_fields, best_first, trials};
use cotillion::constraint::{ConstraintKind, Target};
use cotillion::discrete::editor::{DiscreteEditor, Occasion};
use cotillion::discrete::settings::DiscreteSettings;
use cotillion::edit::{Backend, EditError, Editor};
use cotillion::graph::motion_graph;
use cotillion::graph::scene::{graph_settings, scene_clips};
use cotillion::index::ConstraintId;
use cotillion::relay::{Along, Relay, RelayError, relay};
use cotillion::scene::{ClipFolders, Scene, SceneFaults, load_text};
use cotillion_solvers::{CsMat, KktError, KktForm, LeastSquares, RowMatrix, analyse, c64};
use std::path::Path;
use std::sync::Arc;

/// Updates of a drag.
pub const UPDATES: usize = 40;

/// So often the drag is repeated: of each update the median counts, which interruptions leave alone.
const DRAGS: usize = 3;

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
    /// Its system has no solution to compare with.
    Reference(KktError),
}

impl std::fmt::Display for Unmeasured {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Relay(error) => write!(f, "{error}"),
            Self::Scene(faults) => write!(f, "{faults}"),
            Self::Edit(error) => write!(f, "{error}"),
            Self::Reference(error) => write!(f, "{error}"),
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
        boxes: characters.div_ceil(10),
        discrete,
        drag: Some(FAR),
        along: Along::Spiral,
        ..Relay::of(characters)
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

    /// The shape phase of everybody as one problem, with its targets at rest and in the steps of a drag.
    ///
    /// # Errors
    /// [`Unmeasured`].
    pub fn posed(&self, system: FrameSystem) -> Result<(Posed, Size), Unmeasured> {
        let mut editor = Editor::of(self.scene.clone(), system.backend())?;
        editor.solve()?;
        let Joined { problem, side, size } = Joined::of(&editor);
        let mut sides = vec![side];
        for step in 1..=DRAG_STEPS {
            editor.move_target(self.end, self.target(step, DRAG_STEPS))?;
            editor.solve()?;
            sides.push(Joined::of(&editor).side);
        }
        let compared = [sides[0].clone(), sides[DRAG_STEPS].clone()];
        let [first, last] = refined(&problem, &compared).map_err(Unmeasured::Reference)?;
        Ok((Posed::new(&problem, &sides, [first, last]), size))
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

/// Ways to write the shape phase down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameSystem {
    /// As published: an unknown for every frame, rows that keep the shape of stationary stretches.
    Published,
    /// Two unknowns for each stationary stretch, one for a point that is repeated.
    Condensed,
}

impl FrameSystem {
    const fn backend(self) -> Backend {
        match self {
            Self::Published => Backend::Published,
            Self::Condensed => Backend::Direct,
        }
    }

    const fn name(self) -> &'static str {
        match self {
            Self::Published => "all frames",
            Self::Condensed => "stands condensed",
        }
    }
}

/// Solutions that others are compared with: the Hachtel form, refined until corrections stop shrinking.
fn refined(problem: &LeastSquares<c64>, sides: &[Side; 2]) -> Result<[Vec<c64>; 2], KktError> {
    let factor = analyse(problem, KktForm::Hachtel)?.factor(problem)?;
    let [first, last] = sides;
    Ok([factor.solve(&first.0, &first.1)?.x, factor.solve(&last.0, &last.1)?.x])
}

/// m and h of a problem.
type Side = (Vec<c64>, Vec<c64>);

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
    side: Side,
    size: Size,
}

impl Joined {
    fn of(editor: &Editor) -> Self {
        let columns = editor.shape_problems().map(|own| own.problem.columns).sum();
        let (mut soft, mut hard) = (RowMatrix::new(columns), RowMatrix::new(columns));
        let (mut side, mut shift, mut gauges) = ((Vec::new(), Vec::new()), 0, 0);
        for own in editor.shape_problems() {
            push_rows(&mut soft, &own.problem.soft, shift);
            push_rows(&mut hard, &own.problem.hard, shift);
            side.0.extend(own.soft_targets);
            side.1.extend(own.hard_targets);
            shift += own.problem.columns;
            gauges += own.gauges;
        }
        let size = Size { unknowns: columns, hard: hard.rows(), gauges };
        let problem = LeastSquares { columns, soft: soft.to_csr(), hard: hard.to_csr() };
        Self { problem, side, size }
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
        Ok(timed(|| {
            self.editor.move_target(self.dragged.end, target).and_then(|()| self.editor.solve().map(|_| ()))
        })?)
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

/// What was measured of a library on a system.
#[derive(Clone, Debug, PartialEq)]
pub struct Raced {
    /// Which system.
    pub system: FrameSystem,
    /// Its size.
    pub size: Size,
    /// How the library was used.
    pub configuration: Configuration,
    /// Medians.
    pub run: Run,
}

/// What was measured of one relay.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Everybody.
    pub characters: usize,
    /// The best of each library on each system, and medians of its runs.
    pub peers: Vec<Raced>,
    /// Seconds of each update without changes, medians of all drags.
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
    let (mut entrants, mut problems) = (Vec::new(), Vec::new());
    for system in [FrameSystem::Published, FrameSystem::Condensed] {
        let (posed, size) = dragged.posed(system)?;
        for library in libraries {
            let best = best(&posed, *library, budget).into_iter();
            entrants.extend(
                best.map(|configuration| (problems.len(), (system, size), configuration, Vec::new())),
            );
        }
        problems.push(posed);
    }
    let mut updates = (vec![Vec::new(); UPDATES], vec![Vec::new(); UPDATES]);
    for _ in 0..DRAGS {
        let (mut plain, mut discrete) = (dragged.plain()?, dragged.discrete()?);
        for step in 1..=UPDATES {
            for (problem, _, configuration, runs) in &mut entrants {
                runs.extend(run_peer(&problems[*problem], configuration));
            }
            updates.0[step - 1].push(plain.update(step)?);
            updates.1[step - 1].push(discrete.update(step)?);
        }
    }
    let raced = entrants.into_iter().map(|(_, (system, size), configuration, runs)| {
        let run = summary(&runs, Statistic::Median);
        Raced { system, size, configuration, run }
    });
    let plain = updates.0.iter_mut().map(|same| median(same)).collect();
    let typical = |same: &Vec<(f64, usize, bool)>| {
        (median(&mut same.iter().map(|update| update.0).collect::<Vec<_>>()), same[0].1, same[0].2)
    };
    let discrete = updates.1.iter().map(typical).collect();
    Ok(Measured { characters, peers: raced.collect(), plain, discrete })
}

/// The quickest configuration of each field of a library from nothing to a solution, among the accurate ones.
fn best(posed: &Posed, library: Library, budget: f64) -> Vec<Configuration> {
    let fields = all_fields().into_iter().filter(|field| field.library() == Some(library));
    let quickest = |mut field: Field| {
        let tried = trials(posed, &mut field, budget);
        // Only from nothing counts here.
        let runs: Vec<_> = tried.iter().map(|(_, run)| run.map(|run| Run { drag: 1.0, ..run })).collect();
        let first = best_first(&runs).first().copied().filter(|first| runs[*first].is_some());
        first.map(|first| tried[first].0.clone())
    };
    fields.filter_map(quickest).collect()
}

/// The table: what each takes, and what an update of ours is of it.
pub fn relay_table(measured: &Measured) -> String {
    let Measured { characters, peers, plain, discrete } = measured;
    let all: Vec<f64> = discrete.iter().map(|update| update.0).collect();
    let (own, scored) = (median(&mut plain.clone()), median(&mut all.clone()));
    let mut text =
        format!("relay of {characters}, its end dragged by {FAR} m in {UPDATES} updates; CPU time\n\n");
    text += &format!(
        "{:56}{:>9}{:>9}{:>9}{:>9}\n",
        "shape phase: analyse, factor, solve", "ms", "error, m", "update", "scored"
    );
    for Raced { system, configuration, run, .. } in peers {
        let Configuration { library, numbers, form, .. } = configuration;
        let name = format!("{}, {}, {numbers:?} {form:?}", library.name(), system.name());
        let (ms, error) = (1e3 * run.cold, run.error);
        text +=
            &format!("{name:56}{ms:>9.2}{error:>9.0e}{:>9.3}{:>9.3}\n", own / run.cold, scored / run.cold);
    }
    let of = |changed: bool| discrete.iter().filter(move |update| update.2 == changed).map(|update| update.0);
    let candidates = discrete.iter().map(|update| update.1);
    let (least, most) = (candidates.clone().min().unwrap_or(0), candidates.max().unwrap_or(0));
    text += "\nours\n";
    let mut line = |name: String, mut seconds: Vec<f64>| {
        if !seconds.is_empty() {
            let longest = 1e3 * seconds.iter().copied().fold(0.0, f64::max);
            text += &format!("{name:56}{:>9.2}  longest {longest:.2}\n", 1e3 * median(&mut seconds));
        }
    };
    line("update: all three systems".to_owned(), plain.clone());
    line(format!("scored: with all of {least} to {most} candidates, {UPDATES} updates"), all);
    line(format!("  {} in which nothing changed", of(false).count()), of(false).collect());
    line(format!("  {} with a change", of(true).count()), of(true).collect());
    text.push('\n');
    for Raced { system, size, configuration, .. } in peers {
        let Configuration { library, numbers, form, label, .. } = configuration;
        let Size { unknowns, hard, gauges } = size;
        text += &format!(
            "{}, {}, {numbers:?} {form:?}: {unknowns} unknowns, {hard} hard rows, {gauges} for free motions; {label}\n",
            library.name(),
            system.name()
        );
    }
    text
}
