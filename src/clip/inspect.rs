//! Facts of a clip for people and scripts; whoever calls prints them.

use std::fmt::Write as _;
use std::sync::Arc;

use serde::Serialize;

use crate::clip::contacts::{FootPoint, foot_point, runs};
use crate::clip::measure::{doubtful_fall, foot_slide_working, root_path, standing_height};
use crate::clip::note::ReadNote;
use crate::clip::read::ReadClip;
use crate::clip::working::WorkingClip;
use crate::index::{SourceFrame, floor_index};

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
    /// Length of the usable part in seconds.
    pub seconds: f64,
    /// First and last frame worth using.
    pub usable: FrameRange,
    /// When which point of the feet bears.
    pub contacts: Vec<JointRange>,
    /// When nothing touches the ground.
    pub flights: Vec<JointRange>,
    /// When the body stays where it is.
    pub stationary: Vec<FrameRange>,
    /// Mean horizontal speed of the feet in contact, m/s.
    pub foot_slide: Option<f64>,
    /// Joint of each role that was found.
    pub roles: Vec<RoleFact>,
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
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct JointRange {
    /// Name of the joint in the file; a toe that is the end of a foot goes by the foot's name and ` end`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub joint: Option<String>,
    /// First frame.
    pub from: u32,
    /// Last frame.
    pub to: u32,
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
        seconds: f64::from(last.0 - first.0) / clip.fps,
        usable: FrameRange { from: first.0, to: last.0 },
        contacts: contact_ranges(&working),
        flights: runs(&working.flight)
            .into_iter()
            .map(range)
            .map(|FrameRange { from, to }| JointRange { joint: None, from, to })
            .collect(),
        stationary: runs(&working.stationary).into_iter().map(range).collect(),
        foot_slide: foot_slide_working(&working),
        roles: roles(read),
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

fn contact_ranges(working: &WorkingClip) -> Vec<JointRange> {
    let skeleton = &working.clip.skeleton;
    let mut ranges = Vec::new();
    for point in FootPoint::ALL {
        let Some(at) = foot_point(skeleton, point) else {
            continue;
        };
        let name = &skeleton.joints[at.joint.as_usize()].name;
        let is_end = at.local.length_squared() > 0.0;
        let joint = if is_end { format!("{name} end") } else { name.clone() };
        let labels: Vec<bool> = working.contacts.iter().map(|contact| contact.at(point)).collect();
        ranges.extend(runs(&labels).into_iter().map(|run| {
            let FrameRange { from, to } = file_range(working, run);
            JointRange { joint: Some(joint.clone()), from, to }
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
    found.into_iter().map(|(role, joint)| RoleFact { role: format!("{role:?}"), joint }).collect()
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
    let has_feet = FootPoint::ALL.iter().any(|&point| foot_point(&read.clip.skeleton, point).is_some());
    if has_feet && unsupported as f64 > DOUBTFUL_SHARE * working.frame_count() as f64 {
        warnings.push(format!(
            "no foot bears on the floor in {unsupported} of {} working frames, and the body does not fly: a slope, steps, a seat, \
             or sliding feet; contacts there are wrong",
            working.frame_count()
        ));
    }
    warnings
}

/// Ranges a line of [`facts_text`] shows before it says how many more there are.
const RANGES_SHOWN: usize = 8;

/// The facts as a screen of text, lines ended.
pub fn facts_text(facts: &ClipFacts) -> String {
    let mut text = String::new();
    let mut put = |key: &str, value: String| {
        writeln!(text, "  {key:<12}{value}").expect("writing to a string does not fail");
    };
    put("skeleton", format!("{} joints, {:.2} m to the highest joint", facts.joints, facts.height));
    put(
        "frames",
        format!(
            "{} at {} a second, {}–{} usable: {:.2} s",
            facts.frames, facts.fps, facts.usable.from, facts.usable.to, facts.seconds
        ),
    );
    put("units", format!("{:.6} m a file unit, {} up", facts.unit_to_m, facts.up));
    put("root path", format!("{:.2} m on the ground", facts.root_path));
    if let Some(slide) = facts.foot_slide {
        put("foot slide", format!("{slide:.3} m/s in contact"));
    }
    for (joint, ranges) in contacts_by_joint(facts) {
        put("contact", format!("{joint}: {}", range_list(&ranges)));
    }
    let flights: Vec<_> = facts.flights.iter().map(|flight| (flight.from, flight.to)).collect();
    put("flights", range_list(&flights));
    let stays: Vec<_> = facts.stationary.iter().map(|stay| (stay.from, stay.to)).collect();
    put("stationary", range_list(&stays));
    let roles: Vec<String> = facts.roles.iter().map(|fact| format!("{} {}", fact.role, fact.joint)).collect();
    put("roles", roles.join(", "));
    for warning in &facts.warnings {
        put("warning", warning.clone());
    }
    format!("{}\n{text}", facts.file)
}

/// Contacts grouped by joint, in order of appearance.
fn contacts_by_joint(facts: &ClipFacts) -> Vec<(&str, Vec<(u32, u32)>)> {
    let mut grouped: Vec<(&str, Vec<(u32, u32)>)> = Vec::new();
    for contact in &facts.contacts {
        let joint = contact.joint.as_deref().unwrap_or("body");
        let range = (contact.from, contact.to);
        match grouped.iter_mut().find(|(name, _)| *name == joint) {
            Some((_, ranges)) => ranges.push(range),
            None => grouped.push((joint, vec![range])),
        }
    }
    grouped
}

fn range_list(ranges: &[(u32, u32)]) -> String {
    if ranges.is_empty() {
        return "none".to_owned();
    }
    let shown: Vec<String> =
        ranges.iter().take(RANGES_SHOWN).map(|(from, to)| format!("{from}–{to}")).collect();
    let more = ranges.len().saturating_sub(RANGES_SHOWN);
    let tail = if more > 0 { format!(" and {more} more") } else { String::new() };
    shown.join(", ") + &tail
}
