//! Discrete editing in the published mode: which change wins, and its energy, on a path that walks, stands and walks on; and
//! how many steps a straight walk gains as it is stretched.

mod paths;

use std::f64::consts::TAU;
use std::sync::Arc;

use cotillion::clip::working::WORKING_STEP;
use cotillion::constraint::{ChangeKind, Constraint, Instant};
use cotillion::discrete::candidates::Candidate;
use cotillion::discrete::editor::{DiscreteEditor, Occasion};
use cotillion::discrete::settings::DiscreteSettings;
use cotillion::edit::Target;
use cotillion::geometry::c64;
use cotillion::index::{CharacterId, ConstraintId};
use cotillion::scene::Mode;
use cotillion::track::{Keep, Splice};
use paths::{graph, path_clip, pin, scene, time};

/// Printed energies have eight decimals.
const PRINTED: f64 = 1e-6;
/// A printed length has nine decimals, metres.
const SWAY: f64 = 1e-9;
/// Energy of what does not bend, m².
const UNBENT: f64 = 1e-20;

/// Walks, stands from frame 111 to 170, walks on.
fn walk_idle_walk() -> Vec<c64> {
    let ramp = |k: f64| 0.04 * k / 21.0;
    let mut speeds = vec![0.04; 90];
    speeds.extend((1..=20).map(|k| 0.04 - ramp(f64::from(k))));
    speeds.extend([0.0; 60]);
    speeds.extend((1..=20).map(|k| ramp(f64::from(k))));
    speeds.extend([0.04; 91]);
    let mut points = Vec::new();
    let mut x = 0.0;
    for frame in 0..=speeds.len() {
        let at = frame as f64;
        let speed = if frame == 0 { 0.04 } else { speeds[frame - 1] };
        points.push(c64::new(x, 0.03 * (speed / 0.04) * (TAU * at / 30.0).sin()));
        if frame < speeds.len() {
            x += speeds[frame] * (1.0 + 0.2 * (TAU * at / 15.0).cos());
        }
    }
    for (m, point) in points[111..=170].iter_mut().enumerate() {
        let angle = TAU * m as f64 / 30.0;
        *point += c64::new(0.002 * angle.sin(), 0.002 * angle.cos() - 0.002);
    }
    points
}

struct Row {
    stretch: f64,
    slow: Option<f64>,
    identity: f64,
    duplicate_walk: f64,
    duplicate_idle: f64,
    delete_walk: f64,
    delete_idle: f64,
    winner: (ChangeKind, (usize, usize)),
}

fn constraints(points: &[c64], stretch: f64, slow: Option<f64>) -> Vec<Constraint> {
    let (first, last) = (points[0], points[points.len() - 1]);
    let mut all = vec![
        pin(Instant::TrackStart, first),
        pin(Instant::TrackEnd, first + stretch * (last - first)),
        time(Instant::TrackStart, 0.0),
    ];
    let seconds = |ratio: f64| ratio * (points.len() - 1) as f64 * WORKING_STEP;
    all.extend(slow.map(|ratio| time(Instant::TrackEnd, seconds(ratio))));
    all
}

fn candidate(kind: ChangeKind, (i, j): (usize, usize)) -> Candidate {
    let splice = if kind == ChangeKind::Delete { Splice::delete(i, j) } else { Splice::duplicate(i, j) };
    Candidate {
        character: CharacterId(0),
        kind,
        splice,
        keep: Keep::First,
        distance: 0.0,
        interval: (i + 1, j),
    }
}

const WALK: (usize, usize) = (20, 50);
const IDLE: (usize, usize) = (120, 150);

#[test]
fn stretching_space_adds_steps_and_stretching_time_adds_standing() {
    let points = walk_idle_walk();
    assert!((points[281] - c64::new(8.027945698317229, 0.022294344764322)).norm() < 1e-12);
    let clip = path_clip(&points, Some((111, 170)));
    let graph = Arc::new(graph(&[points.len()], &[(WALK.0, WALK.1, 0.0), (IDLE.0, IDLE.1, 0.0)]));
    let rows = [
        Row {
            stretch: 1.2,
            slow: None,
            identity: 0.83684983,
            duplicate_walk: 0.20334290,
            duplicate_idle: 0.83684983,
            delete_walk: 1.56283857,
            delete_idle: 0.83684983,
            winner: (ChangeKind::Duplicate, WALK),
        },
        Row {
            stretch: 1.0,
            slow: Some(1.2),
            identity: 1.124,
            duplicate_walk: 1.08354538,
            duplicate_idle: 0.47345338,
            delete_walk: 2.55757476,
            delete_idle: 1.93005578,
            winner: (ChangeKind::Duplicate, IDLE),
        },
        Row {
            stretch: 0.85,
            slow: None,
            identity: 0.61947603,
            duplicate_walk: 1.24854764,
            duplicate_idle: 0.61947603,
            delete_walk: 0.00209004,
            delete_idle: 0.61947603,
            winner: (ChangeKind::Delete, WALK),
        },
        Row {
            stretch: 1.0,
            slow: Some(0.85),
            identity: 0.807875,
            duplicate_walk: 2.09156427,
            duplicate_idle: 1.48147227,
            delete_walk: 0.83982128,
            delete_idle: 0.21230229,
            winner: (ChangeKind::Delete, IDLE),
        },
    ];
    for row in rows {
        let clips = [Arc::clone(&clip)];
        let scene = scene(&clips, constraints(&points, row.stretch, row.slow));
        let settings = DiscreteSettings::of(Mode::Paper);
        let mut editor = DiscreteEditor::new(scene, (Arc::clone(&graph), &clips), settings).expect("regular");
        let name = format!("space x{} time x{:?}", row.stretch, row.slow);
        let weighed = [
            (ChangeKind::Duplicate, WALK, row.duplicate_walk),
            (ChangeKind::Duplicate, IDLE, row.duplicate_idle),
            (ChangeKind::Delete, WALK, row.delete_walk),
            (ChangeKind::Delete, IDLE, row.delete_idle),
        ];
        for (kind, interval, printed) in weighed {
            let energy = editor.weigh(&candidate(kind, interval)).expect("solvable");
            assert!(
                (energy - printed).abs() < PRINTED,
                "{name}: {kind:?} {interval:?}: {energy} for {printed}"
            );
        }
        assert!(editor.update(Occasion::First).expect("solvable"), "{name}");
        let entry = &editor.log()[0];
        assert!((entry.energy.0 - row.identity).abs() < PRINTED, "{name}: {}", entry.energy.0);
        assert_eq!(
            (entry.kind, entry.interval),
            (row.winner.0, (row.winner.1.0 + 1, row.winner.1.1)),
            "{name}"
        );
    }
}

#[test]
fn a_straight_walk_gains_a_cycle_where_that_is_nearer_to_its_length() {
    let points: Vec<c64> = (0..181).map(|frame| c64::new(0.04 * f64::from(frame), 0.0)).collect();
    let clip = path_clip(&points, None);
    let pairs: Vec<(usize, usize, f64)> = (0..151).map(|i| (i, i + 30, 0.0)).collect();
    let graph = Arc::new(graph(&[points.len()], &pairs));
    let clips = [Arc::clone(&clip)];
    let scene = scene(&clips, vec![pin(Instant::TrackStart, points[0]), pin(Instant::TrackEnd, points[180])]);
    let mut editor =
        DiscreteEditor::new(scene, (graph, &clips), DiscreteSettings::of(Mode::Paper)).expect("regular");
    let expected = [
        (1.05, 181),
        (1.10, 211),
        (1.20, 211),
        (1.30, 241),
        (1.50, 271),
        (1.60, 301),
        (1.80, 331),
        (2.00, 361),
    ];
    for step in 1..=20 {
        let stretch = 1.0 + 0.05 * f64::from(step);
        let target = Target::Position(stretch * points[180]);
        editor.move_target(ConstraintId(1), target).expect("a pin");
        editor.update(Occasion::First).expect("solvable");
        let count = editor.scene().characters[0].track.frame_count();
        if let Some((_, frames)) = expected.iter().find(|(s, _)| (s - stretch).abs() < 1e-9) {
            assert_eq!(count, *frames, "at x{stretch}");
            let cycles = (count - 181) as f64 / 30.0;
            let energy = 0.5 * (7.2 * stretch - 7.2 - 1.2 * cycles).abs();
            assert!((editor.energy().total - energy).abs() < 1e-9, "at x{stretch}");
        }
    }
}

/// Frame interval, seconds; energies of shape and scale are over its cube, those of time over it.
const H: f64 = WORKING_STEP;

/// The walk that stands in between, after one update in which changes of `kinds` may happen.
fn updated(stretch: f64, slow: Option<f64>, kinds: &[ChangeKind]) -> DiscreteEditor {
    let points = walk_idle_walk();
    let clip = path_clip(&points, Some((111, 170)));
    let graph = Arc::new(graph(&[points.len()], &[(WALK.0, WALK.1, 0.0), (IDLE.0, IDLE.1, 0.0)]));
    let clips = [Arc::clone(&clip)];
    let scene = scene(&clips, constraints(&points, stretch, slow));
    let settings = DiscreteSettings { kinds: kinds.to_vec(), ..DiscreteSettings::of(Mode::Paper) };
    let mut editor = DiscreteEditor::new(scene, (graph, &clips), settings).expect("regular");
    editor.update(Occasion::First).expect("solvable");
    editor
}

#[test]
fn terms_of_the_energy_are_those_published() {
    let near = |own: f64, printed: f64| assert!((own / printed - 1.0).abs() < PRINTED, "{own} for {printed}");
    let identity = updated(1.2, None, &[]).energy();
    near(identity.scale * H.powi(3), 1.394818143e-6);
    near(identity.length, 0.5 * 1.598379477);
    let walks = updated(1.2, None, &[ChangeKind::Duplicate]).energy();
    near(walks.scale * H.powi(3), 5.848538106e-8);
    near(walks.length, 0.5 * 0.403527587);
    near(updated(1.0, Some(1.2), &[]).energy().time * H, 6.244444444e-3);
}

#[test]
fn standing_longer_leaves_the_path_as_it_is() {
    let length = |editor: &DiscreteEditor| -> f64 {
        let path = editor.scene().characters[0].track.rest_path().positions;
        path.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum()
    };
    let (before, after) = (updated(1.0, Some(1.2), &[]), updated(1.0, Some(1.2), &[ChangeKind::Duplicate]));
    let sway = length(&after) - length(&before);
    assert!((sway - 0.012543416).abs() < SWAY, "{sway}");
    let energy = after.energy();
    assert!(energy.shape * H.powi(3) < UNBENT && energy.scale * H.powi(3) < UNBENT, "{energy:?}");
}
