//! What a touch-up leaves alone, and what does not matter to it.

use std::collections::BTreeMap;

use cotillion::clip::Clip;
use cotillion::clip::builtin::generate;
use cotillion::clip::derived::bent;
use cotillion::geometry::yaw;
use cotillion::index::{JointId, SourceFrame};
use cotillion::physics::body_model::{BodyModel, BodySettings, body_model};
use cotillion::physics::ground::parts::{JointMotion, Part, link_sets};
use cotillion::physics::ground::schedule::{Step, level};
use cotillion::physics::ground::target::{Source, Target};
use cotillion::physics::ground::{GroundError, GroundSettings, ground_pass};
use cotillion::physics::input::InputError;
use cotillion::physics::posed::PosedClip;
use cotillion::physics::stages::{StageSettings, Stages, stages};
use glam::{DQuat, DVec3};
use proptest::prelude::*;

use crate::figure::on_a_circle;

/// Rounding, through filters and a dozen turns, metres: iterations end where less than 5 µm is left, which rounding may tip.
const TIPPED: f64 = 2e-5;

struct Act {
    clip: Clip,
    body: BodyModel,
    stages: Stages,
}

impl Act {
    fn of(clip: Clip, labels: Option<&Stages>) -> Self {
        let body = body_model(&clip.skeleton, &BodySettings::default()).expect("generated bodies are whole");
        let found = || stages(&clip, &body, &PosedClip::of(&clip), &StageSettings::default());
        let stages = labels.cloned().unwrap_or_else(found);
        Self { clip, body, stages }
    }

    /// A generated walk on an arc, with the labels of the straight one.
    fn on_an_arc(radius: f64) -> Self {
        let straight = Self::of(generate("walk", &BTreeMap::new()).expect("a generated clip"), None);
        Self::of(bent(&straight.clip, radius).expect("a walk has a chord"), Some(&straight.stages))
    }

    fn touched_up(&self, settings: &GroundSettings) -> Clip {
        ground_pass(&self.clip, &self.body, &self.stages, None, settings).expect("a sound walk").0
    }
}

fn farthest(a: &Clip, b: &Clip) -> f64 {
    let [a, b] = [a, b].map(PosedClip::of);
    a.joints.iter().zip(&b.joints).map(|(a, b)| a.position.distance(b.position)).fold(0.0, f64::max)
}

/// `clip` turned about the vertical, then moved along the ground.
fn moved(clip: &Clip, angle: f64, shift: DVec3) -> Clip {
    let mut clip = clip.clone();
    let joints = clip.skeleton.joints.len();
    for (frame, root) in clip.root_positions.iter_mut().enumerate() {
        *root = yaw(angle) * *root + shift;
        clip.rotations[frame * joints] = yaw(angle) * clip.rotations[frame * joints];
    }
    clip
}

fn reversed(act: &Act) -> Act {
    let poses: Vec<_> = (0..act.clip.frame_count())
        .rev()
        .map(|frame| act.clip.pose(SourceFrame::from_usize(frame)))
        .collect();
    let clip = Clip::from_poses(&act.clip.name, act.clip.skeleton.clone(), act.clip.fps, &poses);
    let mut stages = act.stages.clone();
    stages.phases.reverse();
    stages.supports.iter_mut().for_each(|support| support.bears.reverse());
    Act { clip, body: act.body.clone(), stages }
}

#[test]
fn steps_of_no_share_change_nothing() {
    let act = Act::on_an_arc(2.0);
    let schedule = level().into_iter().map(|step| Step { share: 0.0, ..step }).collect();
    assert_eq!(act.touched_up(&GroundSettings { schedule, ..GroundSettings::default() }), act.clip);
}

#[test]
fn who_stands_balanced_is_left_alone() {
    let walk = generate("walk", &BTreeMap::new()).expect("a generated clip");
    let standing = generate("idle", &BTreeMap::new()).expect("a generated clip");
    let poses = vec![standing.pose(SourceFrame(0)); 60];
    let act = Act::of(Clip::from_poses("still", standing.skeleton.clone(), walk.fps, &poses), None);
    for margin in [0.0, 0.005] {
        let target = Target::Hull { margin };
        let (clip, report) = ground_pass(
            &act.clip,
            &act.body,
            &act.stages,
            None,
            &GroundSettings { target, ..GroundSettings::default() },
        )
        .expect("a sound clip");
        assert!(report.before.distance[0].expect("it stands").mean == 0.0);
        assert_eq!(clip, act.clip);
    }
}

#[test]
fn the_untouched_comes_out_as_it_went_in_when_carried() {
    for name in ["walk", "run", "turn_left"] {
        let Ok(clip) = generate(name, &BTreeMap::new()) else { continue };
        let act = Act::of(clip, None);
        let source = Source::of(&act.clip, &act.body, &act.stages);
        let settings = GroundSettings { target: Target::Carried, ..GroundSettings::default() };
        let (clip, report) =
            ground_pass(&act.clip, &act.body, &act.stages, Some(&source), &settings).expect("a sound clip");
        assert_eq!(clip, act.clip);
        assert_eq!(report.kept, 0);
    }
}

#[test]
fn what_is_carried_keeps_its_rotation_in_the_world_and_planted_feet_stay() {
    let figure = on_a_circle();
    let settings = GroundSettings { schedule: vec![Step::lower()], rounds: 2, ..GroundSettings::default() };
    let (clip, report) =
        ground_pass(&figure.clip, &figure.body, &figure.stages, None, &settings).expect("a sound walk");
    assert!(report.kept > 0 && report.largest_change.is_some());
    let sets = link_sets(&clip.skeleton, &figure.body, &[Part::Lower], &[Part::Upper]).expect("a step");
    let [before, after] = [&figure.clip, &clip].map(PosedClip::of);
    for frame in 0..clip.frame_count() {
        for joint in (0..clip.skeleton.joints.len()).map(JointId::from_usize) {
            if matches!(sets.motions[joint.as_usize()], JointMotion::Carried(_)) {
                let [from, to] = [&before, &after].map(|posed| posed.at(frame, joint).rotation);
                assert!(
                    from.dot(to).abs() > 1.0 - 1e-12 && (from - to * from.dot(to).signum()).length() < 1e-12
                );
            }
        }
        for support in figure.stages.supports.iter().filter(|support| support.bears[frame]) {
            for point in &support.points {
                let [from, to] = [&before, &after].map(|posed| point.place(posed.frame(frame)));
                assert!(from.distance(to) < 1e-4, "{frame}: {}", from.distance(to));
            }
        }
    }
}

#[test]
fn what_does_not_fit_together_is_told() {
    let act = Act::on_an_arc(2.0);
    let run = |act: &Act, source: Option<&Source>, settings: &GroundSettings| {
        ground_pass(&act.clip, &act.body, &act.stages, source, settings).map(|_| ())
    };
    let carried = GroundSettings { target: Target::Carried, ..GroundSettings::default() };
    assert_eq!(run(&act, None, &carried), Err(GroundError::NoSource));
    let mut source = Source::of(&act.clip, &act.body, &act.stages);
    source.roots.pop();
    assert!(matches!(run(&act, Some(&source), &carried), Err(GroundError::OtherLength { .. })));
    let torn = Step { carried: Vec::new(), ..Step::lower() };
    let settings = GroundSettings { schedule: vec![Step::upper(), torn], ..GroundSettings::default() };
    assert!(matches!(run(&act, None, &settings), Err(GroundError::Step { step: 2, .. })));
    let endless = Step { width: f64::INFINITY, ..Step::lower() };
    let settings = GroundSettings { schedule: vec![endless], ..GroundSettings::default() };
    assert!(matches!(run(&act, None, &settings), Err(GroundError::Input(InputError::NotFinite { .. }))));
    let mut broken = Act::on_an_arc(2.0);
    broken.clip.rotations[5] = DQuat::from_xyzw(f64::NAN, 0.0, 0.0, 1.0);
    assert!(matches!(
        run(&broken, None, &GroundSettings::default()),
        Err(GroundError::Input(InputError::NotFinite { .. }))
    ));
    broken.stages.phases.pop();
    assert!(matches!(
        run(&broken, None, &GroundSettings::default()),
        Err(GroundError::Input(InputError::OtherStages { .. }))
    ));
}

#[test]
fn clips_of_few_frames_do_no_harm() {
    let walk = generate("walk", &BTreeMap::new()).expect("a generated clip");
    for count in 1..12 {
        let poses: Vec<_> = (0..count).map(|k| walk.pose(SourceFrame(k))).collect();
        let act = Act::of(Clip::from_poses("short", walk.skeleton.clone(), 30.0, &poses), None);
        assert_eq!(act.touched_up(&GroundSettings::default()), act.clip);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]

    #[test]
    fn where_somebody_walks_and_which_way_does_not_matter(
        radius in 2.0..5.0_f64, angle in -3.0..3.0_f64, x in -5.0..5.0_f64, z in -5.0..5.0_f64,
    ) {
        let (here, shift) = (Act::on_an_arc(radius), DVec3::new(x, 0.0, z));
        let there = Act { clip: moved(&here.clip, angle, shift), body: here.body.clone(), stages: here.stages.clone() };
        let settings = GroundSettings { rounds: 1, ..GroundSettings::default() };
        let expected = moved(&here.touched_up(&settings), angle, shift);
        prop_assert!(farthest(&expected, &here.clip) > 0.0);
        prop_assert!(farthest(&there.touched_up(&settings), &expected) < TIPPED);
    }

    #[test]
    fn how_heavy_somebody_is_does_not_matter(mass in 1.0..500.0_f64) {
        let act = Act::on_an_arc(2.5);
        let body = body_model(&act.clip.skeleton, &BodySettings { mass, ..BodySettings::default() }).expect("a body");
        let heavy = Act { clip: act.clip.clone(), body, stages: act.stages.clone() };
        let settings = GroundSettings { rounds: 1, ..GroundSettings::default() };
        prop_assert!(farthest(&heavy.touched_up(&settings), &act.touched_up(&settings)) < TIPPED);
    }

    #[test]
    fn time_may_run_backwards(radius in 2.0..5.0_f64) {
        let act = Act::on_an_arc(radius);
        let settings = GroundSettings { rounds: 1, ..GroundSettings::default() };
        let forwards = Act { clip: act.touched_up(&settings), body: act.body.clone(), stages: act.stages.clone() };
        let backwards = reversed(&act).touched_up(&settings);
        prop_assert!(farthest(&reversed(&forwards).clip, &backwards) < TIPPED);
    }
}
