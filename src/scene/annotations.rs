//! Contacts that a clip's table states.

use crate::clip::Clip;
use crate::clip::contacts::ContactPoint;
use crate::clip::contacts::annotated::{AnnotatedContact, NoPoint, overlap, point_named};
use crate::index::SourceFrame;
use crate::scene::raw;
use crate::scene::report::{At, Place, Report};
use crate::scene::suggest;
use crate::scene::tree::Field;
use crate::scene::values::Tables;
use crate::skeleton::Skeleton;

/// The sound ones of the stated contacts of a clip that uses the frames of `range`.
pub fn annotations(
    stated: &Field<Tables<raw::Contact>>,
    clip: &Clip,
    range: (SourceFrame, SourceFrame),
    report: &mut Report,
) -> Vec<AnnotatedContact> {
    let tables = stated.tables().iter();
    let found: Vec<(AnnotatedContact, &Place)> = tables
        .filter_map(|table| Some((contact(table, &clip.skeleton, range, report)?, &table.place)))
        .collect();
    let contacts: Vec<AnnotatedContact> = found.iter().map(|(contact, _)| *contact).collect();
    if let Some((earlier, later)) = overlap(&contacts) {
        let AnnotatedContact { from, to, .. } = contacts[earlier];
        let message = format!("this joint already bears from frame {} to {}", from.0, to.0);
        report.fault(found[later].1, message, "make one contact of both, or leave a frame between them");
    }
    contacts
}

fn contact(
    table: &At<raw::Contact>,
    skeleton: &Skeleton,
    range: (SourceFrame, SourceFrame),
    report: &mut Report,
) -> Option<AnnotatedContact> {
    let raw::Contact { joint, from, to } = &table.value;
    let point = joint.given().and_then(|name| point(name, skeleton, report));
    let from = from.given().and_then(|frame| frame_within(frame, range, report));
    let to = to.given().and_then(|frame| frame_within(frame, range, report));
    let (point, from, to) = (point?, from?, to?);
    if from > to {
        let message = format!("the first frame, {}, comes after the last, {}", from.0, to.0);
        report.fault(&table.place, message, format!("write from = {}, to = {}", to.0, from.0));
        return None;
    }
    Some(AnnotatedContact { point, from, to })
}

fn point(name: &At<String>, skeleton: &Skeleton, report: &mut Report) -> Option<ContactPoint> {
    let roles = ContactPoint::ALL.map(|point| point.role().name());
    match point_named(skeleton, &name.value) {
        Ok(point) => return Some(point),
        Err(error @ NoPoint::Unknown { .. }) => {
            let joints = skeleton.joints.iter().map(|joint| joint.name.as_str());
            let known: Vec<&str> = roles.into_iter().chain(joints).collect();
            let help = suggest::remedy(&name.value, "joints", &known);
            report.fault(&name.place, error.to_string(), help);
        }
        Err(error) => {
            let help = format!(
                "contacts are of {}, or of these joints by their names in the file",
                suggest::list(&roles)
            );
            report.fault(&name.place, error.to_string(), help);
        }
    }
    None
}

fn frame_within(
    frame: &At<u32>,
    (first, last): (SourceFrame, SourceFrame),
    report: &mut Report,
) -> Option<SourceFrame> {
    if (first.0..=last.0).contains(&frame.value) {
        return Some(SourceFrame(frame.value));
    }
    let message = format!("a contact at frame {} is outside the clip", frame.value);
    report.fault(
        &frame.place,
        message,
        format!("the clip uses frames {} to {} of its file", first.0, last.0),
    );
    None
}
