//! Scenes of roots that go along given paths, with motion graphs made by hand.

use std::sync::Arc;

use cotillion::clip::Clip;
use cotillion::clip::facing::REST_HEADING;
use cotillion::clip::working::WorkingClip;
use cotillion::constraint::{Constraint, ConstraintKind, Instant, Moment, Strength, When};
use cotillion::geometry::{c64, world_of, yaw};
use cotillion::graph::{GraphClip, MotionGraph};
use cotillion::index::{CharacterId, GraphFrame, JointId, SourceFrame};
use cotillion::path::raw_tangents;
use cotillion::scene::{Character, FullBody, Mode, Scene, Warp};
use cotillion::skeleton::{Axis, Joint, JointRole, Pose, Skeleton};
use cotillion::track::{SeamRule, Track};
use glam::{DQuat, DVec3};

/// A root with two hands, half a metre ahead of it.
fn skeleton() -> Arc<Skeleton> {
    let joint = |name: &str, offset: DVec3, role: Option<JointRole>| Joint {
        name: name.to_owned(),
        parent: role.map(|_| JointId::from_usize(0)),
        offset,
        end_site: None,
        rotation_order: [Axis::Z, Axis::X, Axis::Y],
        role,
    };
    let hand = |side: f64| DVec3::new(side, 0.1, 0.5);
    let joints = vec![
        joint("Hips", DVec3::ZERO, None),
        joint("LeftHand", hand(0.2), Some(JointRole::LeftHand)),
        joint("RightHand", hand(-0.2), Some(JointRole::RightHand)),
    ];
    Arc::new(Skeleton { joints })
}

/// A root that goes along `points`, facing along its tangents; along that of its first frame in the stand.
pub(crate) fn path_clip(points: &[c64], stand: Option<(usize, usize)>) -> Arc<WorkingClip> {
    let tangents = raw_tangents(points);
    let facing = |frame: usize| match stand {
        Some((first, last)) if (first..=last).contains(&frame) => tangents[first].arg(),
        _ => tangents[frame].arg(),
    };
    let pose = |(frame, point): (usize, &c64)| Pose {
        root: world_of(*point, 1.0),
        rotations: vec![yaw(facing(frame) - REST_HEADING), DQuat::IDENTITY, DQuat::IDENTITY],
        offsets: Vec::new(),
    };
    let poses: Vec<Pose> = points.iter().enumerate().map(pose).collect();
    let clip = Arc::new(Clip::from_poses("path", skeleton(), 30.0, &poses));
    let last = SourceFrame::from_usize(points.len() - 1);
    let mut working = WorkingClip::new("path", clip, SourceFrame(0), last);
    working.stationary = (0..points.len())
        .map(|frame| stand.is_some_and(|(first, last)| (first..=last).contains(&frame)))
        .collect();
    Arc::new(working)
}

/// Graph of clips of so many frames with these similar pairs, counted through all clips, each with its distance.
pub(crate) fn graph(frames: &[usize], pairs: &[(usize, usize, f64)]) -> MotionGraph {
    let all = frames.iter().sum();
    let mut similar: Vec<Vec<(GraphFrame, f64)>> = vec![Vec::new(); all];
    for (i, j, distance) in pairs {
        similar[*i].push((GraphFrame::from_usize(*j), *distance));
        similar[*j].push((GraphFrame::from_usize(*i), *distance));
    }
    let mut starts = vec![0];
    for list in &mut similar {
        list.sort_by_key(|(frame, _)| *frame);
        starts.push(starts[starts.len() - 1] + list.len());
    }
    let (similar, distances) = similar.concat().into_iter().unzip();
    let mut first = 0;
    let clip = |frames: &usize| {
        first += frames;
        GraphClip { first: GraphFrame::from_usize(first - frames), frames: *frames, body: 0 }
    };
    MotionGraph { clips: frames.iter().map(clip).collect(), bodies: Vec::new(), starts, distances, similar }
}

pub(crate) fn moment(who: usize, instant: Instant) -> Moment {
    Moment { character: CharacterId::from_usize(who), instant, name: format!("{who}:{instant:?}") }
}

pub(crate) fn hard(name: &str, kind: ConstraintKind) -> Constraint {
    Constraint { name: name.to_owned(), line: 0, strength: Strength::Hard, kind }
}

pub(crate) fn pin(instant: Instant, position: c64) -> Constraint {
    let when = When::At(moment(0, instant));
    hard("pin", ConstraintKind::Pin { when, position: Some(position), facing: None })
}

pub(crate) fn time(instant: Instant, seconds: f64) -> Constraint {
    hard("time", ConstraintKind::Time { at: moment(0, instant), seconds })
}

/// Scene of characters who each perform one clip.
pub(crate) fn scene(clips: &[Arc<WorkingClip>], constraints: Vec<Constraint>) -> Scene {
    let character = |(who, clip): (usize, &Arc<WorkingClip>)| Character {
        name: format!("c{who}"),
        track: Track::string(vec![Arc::clone(clip)], &[], (None, None), SeamRule::Root).0,
        performed: Vec::new(),
    };
    Scene {
        title: "paths".to_owned(),
        fps: 30.0,
        mode: Mode::Paper,
        characters: clips.iter().enumerate().map(character).collect(),
        objects: Vec::new(),
        constraints,
        carries: Vec::new(),
        end_effectors: Vec::new(),
        drags: Vec::new(),
        discrete: None,
        physics: None,
        captured: std::collections::BTreeMap::new(),
        warp: Warp::default(),
        full_body: FullBody::default(),
    }
}
