//! Facts of a clip for people and scripts; whoever calls prints them.

mod text;
mod transitions;

use std::f64::consts::TAU;
use std::sync::Arc;

pub use text::facts_text;
pub use transitions::TransitionFacts;

use serde::Serialize;

use crate::clip::contacts::raised::RaisedGround;
use crate::clip::contacts::{ContactPoint, contact_point, runs};
use crate::clip::measure::{doubtful_fall, foot_slide_working, root_path, standing_height};
use crate::clip::note::ReadNote;
use crate::clip::read::ReadClip;
use crate::clip::working::WorkingClip;
use crate::index::{SourceFrame, floor_index};
use crate::skeleton::JointRole;

/// Facts of one clip; frames are the file's, ranges inclusive, lengths metres.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClipFacts {
    /// The file, as the caller calls it.
    pub file: String,
    /// Number of joints.
    pub joints: usize,
    /// Number of frames.
    pub frames: usize,
    /// Frames per second the clip is played at.
    pub fps: f64,
    /// Metres per file unit.
    pub unit_to_m: f64,
    /// Axis that points up in the file: `y` or `z`.
    pub up: String,
    /// Height of the standing body: its highest joint above its lowest, end sites left out.
    pub height: f64,
    /// Ground length of the root's path, sampled every 0.1 s.
    pub root_path: f64,
    /// Ground distance of the root from its first place to its last.
    pub displacement: f64,
    /// By how much the body faces elsewhere at the end than at the start, degrees, left turns positive, whole turns counted.
    pub turn_deg: f64,
    /// Length of the usable part in seconds.
    pub seconds: f64,
    /// First and last frame worth using.
    pub usable: FrameRange,
    /// When which point of the feet bears, and of the hands where that is stated.
    pub contacts: Vec<JointRange>,
    /// When any point of the left and of the right foot bears.
    pub feet: Vec<FootFact>,
    /// When nothing touches the ground.
    pub flights: Vec<JointRange>,
    /// When the body stays where it is.
    pub stationary: Vec<FrameRange>,
    /// Mean horizontal speed of the feet in contact, m/s.
    pub foot_slide: Option<f64>,
    /// Transitions of the clip onto itself, where the motion graph was asked.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub transitions: Option<TransitionFacts>,
    /// Named frames.
    pub events: Vec<EventFact>,
    /// Joint of each role that was found.
    pub roles: Vec<RoleFact>,
    /// Roles no joint was found for.
    pub missing_roles: Vec<String>,
    /// What was guessed or looks odd.
    pub warnings: Vec<String>,
}

/// File frames, both included.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[expect(missing_docs, reason = "the names say it")]
pub struct FrameRange {
    pub from: u32,
    pub to: u32,
}

/// File frames of one joint, or of the whole body.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct JointRange {
    /// Name of the joint in the file; a toe that is the end of a foot goes by the foot's name and ` end`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub joint: Option<String>,
    /// First frame.
    pub from: u32,
    /// Last frame.
    pub to: u32,
    /// Height of the ground above the floor of the clip, metres, where a foot stands on something else.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ground: Option<f64>,
}

/// When a foot bears.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct FootFact {
    /// `left` or `right`.
    pub foot: String,
    /// Longest ranges of frames throughout which some point of it bears.
    pub ranges: Vec<FrameRange>,
}

/// A named frame.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[expect(missing_docs, reason = "the names say it")]
pub struct EventFact {
    pub name: String,
    pub frame: u32,
}

/// What a joint is for.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[expect(missing_docs, reason = "the names say it")]
pub struct RoleFact {
    pub role: String,
    pub joint: String,
}

/// Facts of the clip `read` from `file`; cost linear in the clip.
pub fn inspect(file: &str, read: &ReadClip) -> ClipFacts {
    let clip = &read.clip;
    let (first, last) = clip.usable;
    let working = WorkingClip::new(&clip.name, Arc::new(clip.clone()), first, last);
    let range = |run| file_range(&working, run);
    ClipFacts {
        file: file.to_owned(),
        joints: clip.skeleton.joints.len(),
        frames: clip.frame_count(),
        fps: clip.fps,
        unit_to_m: read.unit_to_m,
        up: read.up.to_string(),
        height: standing_height(clip, first, last),
        root_path: root_path(clip, first, last),
        displacement: displacement(&working),
        turn_deg: turn(&working) * 360.0 / TAU,
        seconds: f64::from(last.0 - first.0) / clip.fps,
        usable: FrameRange { from: first.0, to: last.0 },
        contacts: contact_ranges(&working),
        feet: feet(&working),
        flights: runs(&working.flight)
            .into_iter()
            .map(range)
            .map(|FrameRange { from, to }| JointRange { joint: None, from, to, ground: None })
            .collect(),
        stationary: runs(&working.stationary).into_iter().map(range).collect(),
        foot_slide: foot_slide_working(&working),
        transitions: None,
        events: clip
            .events
            .iter()
            .map(|(name, frame)| EventFact { name: name.clone(), frame: frame.0 })
            .collect(),
        roles: roles(read),
        missing_roles: missing_roles(read),
        warnings: warnings(read, &working),
    }
}

/// File frames nearest to a run of working frames.
fn file_range(working: &WorkingClip, run: (usize, usize)) -> FrameRange {
    let frame = |index: usize| {
        let rounded = floor_index(working.source_frame(index as f64) + 0.5);
        SourceFrame::from_usize(rounded).min(working.last).0
    };
    FrameRange { from: frame(run.0), to: frame(run.1) }
}

fn displacement(working: &WorkingClip) -> f64 {
    let ends = working.positions.first().zip(working.positions.last());
    ends.map_or(0.0, |(first, last)| (last - first).norm())
}

fn turn(working: &WorkingClip) -> f64 {
    let ends = working.headings.first().zip(working.headings.last());
    ends.map_or(0.0, |(first, last)| last - first)
}

fn feet(working: &WorkingClip) -> Vec<FootFact> {
    let fact = |foot: &str, bears: Vec<bool>| FootFact {
        foot: foot.to_owned(),
        ranges: runs(&bears).into_iter().map(|run| file_range(working, run)).collect(),
    };
    vec![
        fact("left", working.contacts.iter().map(|contact| contact.left_foot()).collect()),
        fact("right", working.contacts.iter().map(|contact| contact.right_foot()).collect()),
    ]
}

fn contact_ranges(working: &WorkingClip) -> Vec<JointRange> {
    let skeleton = &working.clip.skeleton;
    let mut ranges = Vec::new();
    for point in ContactPoint::ALL {
        let Some(at) = contact_point(skeleton, point) else {
            continue;
        };
        let name = &skeleton.joints[at.joint.as_usize()].name;
        let is_end = at.local.length_squared() > 0.0;
        let joint = if is_end { format!("{name} end") } else { name.clone() };
        let labels: Vec<bool> = working.contacts.iter().map(|contact| contact.at(point)).collect();
        ranges.extend(runs(&labels).into_iter().map(|run| {
            let FrameRange { from, to } = file_range(working, run);
            let under =
                |ground: &&RaisedGround| ground.point == point && (run.0..=run.1).contains(&ground.first);
            let ground = working.grounds.iter().find(under).map(|ground| ground.height);
            JointRange { joint: Some(joint.clone()), from, to, ground }
        }));
    }
    ranges
}

fn roles(read: &ReadClip) -> Vec<RoleFact> {
    let mut found: Vec<_> = read
        .clip
        .skeleton
        .joints
        .iter()
        .filter_map(|joint| Some((joint.role?, joint.name.clone())))
        .collect();
    found.sort();
    found.into_iter().map(|(role, joint)| RoleFact { role: role.to_string(), joint }).collect()
}

fn missing_roles(read: &ReadClip) -> Vec<String> {
    let lacks = |role: &JointRole| read.clip.skeleton.joint_of(*role).is_none();
    JointRole::ALL.into_iter().filter(lacks).map(|role| role.to_string()).collect()
}

/// Share of the frames without any contact beyond which the floor is doubtful, when the body does not fly.
const DOUBTFUL_SHARE: f64 = 0.4;

fn warnings(read: &ReadClip, working: &WorkingClip) -> Vec<String> {
    let fall = doubtful_fall(working);
    let mut warnings: Vec<String> = read.notes.iter().chain(&fall).map(ReadNote::to_string).collect();
    let unsupported = working
        .contacts
        .iter()
        .zip(&working.flight)
        .filter(|(contact, flies)| !**flies && !contact.any())
        .count();
    let has_feet =
        ContactPoint::FEET.iter().any(|&point| contact_point(&read.clip.skeleton, point).is_some());
    if has_feet && unsupported as f64 > DOUBTFUL_SHARE * working.frame_count() as f64 {
        warnings.push(format!(
            "no foot bears in {unsupported} of {} working frames, and the body does not fly: a seat, sliding feet, or hands \
             that are not stated to bear",
            working.frame_count()
        ));
    }
    warnings
}
