//! The part of a clip that is used, as a clip of its own.

use crate::clip::contacts::annotated::AnnotatedContact;
use crate::clip::{Clip, MovingOffset};
use crate::index::SourceFrame;

/// The usable frames of `clip` alone, from 0; events and stated contacts beyond them are gone. Cost: linear.
pub fn usable_part(clip: &Clip) -> Clip {
    let (first, last) = clip.usable;
    let joints = clip.skeleton.joints.len();
    let frames = first.as_usize()..last.as_usize() + 1;
    let own = |frame: SourceFrame| SourceFrame(frame.0 - first.0);
    let is_within = |frame: SourceFrame| first <= frame && frame <= last;
    let moving = |moving: &MovingOffset| MovingOffset {
        joint: moving.joint,
        offsets: moving.offsets[frames.clone()].to_vec(),
    };
    let contact = |stated: &AnnotatedContact| {
        let (from, to) = (stated.from.max(first), stated.to.min(last));
        (from <= to).then(|| AnnotatedContact { point: stated.point, from: own(from), to: own(to) })
    };
    let events = clip.events.iter().filter(|(_, frame)| is_within(**frame));
    Clip {
        name: clip.name.clone(),
        skeleton: clip.skeleton.clone(),
        fps: clip.fps,
        root_positions: clip.root_positions[frames.clone()].to_vec(),
        rotations: clip.rotations[frames.start * joints..frames.end * joints].to_vec(),
        moving_offsets: clip.moving_offsets.iter().map(moving).collect(),
        events: events.map(|(name, frame)| (name.clone(), own(*frame))).collect(),
        contacts: clip.contacts.iter().filter_map(contact).collect(),
        usable: (SourceFrame(0), own(last)),
    }
}
