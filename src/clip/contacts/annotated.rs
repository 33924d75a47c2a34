//! Contacts that somebody states, over those that are found: of hands, which cannot be found, and of feet where it went wrong.

use crate::clip::contacts::{ContactPoint, Contacts, contact_point};
use crate::index::{JointId, SourceFrame};
use crate::skeleton::{JointRole, Skeleton};

/// A stated contact of one point. The contacts stated of a point replace those that are found of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AnnotatedContact {
    /// What bears.
    pub point: ContactPoint,
    /// First frame.
    pub from: SourceFrame,
    /// Last frame, included.
    pub to: SourceFrame,
}

/// Why a name names no point that can bear.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NoPoint {
    /// Neither a role nor a joint.
    #[error("the skeleton has no joint \"{name}\"")]
    Unknown {
        /// What was asked for.
        name: String,
    },
    /// A joint, but none of a foot or hand.
    #[error("\"{name}\" is no hand, foot or toe")]
    NeitherHandNorFoot {
        /// What was asked for.
        name: String,
    },
}

/// The point of a role, or of a joint by its name in the file; joints that hang on a hand mean the hand.
///
/// # Errors
/// [`NoPoint`] says what the name is instead.
pub fn point_named(skeleton: &Skeleton, name: &str) -> Result<ContactPoint, NoPoint> {
    let joint = || skeleton.joints.iter().position(|joint| joint.name == name).map(JointId::from_usize);
    let unknown = || NoPoint::Unknown { name: name.to_owned() };
    let point = match JointRole::named(name) {
        Some(role) => of_role(role),
        None => of_joint(skeleton, joint().ok_or_else(unknown)?),
    };
    let point = point.ok_or_else(|| NoPoint::NeitherHandNorFoot { name: name.to_owned() })?;
    contact_point(skeleton, point).map(|_| point).ok_or_else(unknown)
}

fn of_role(role: JointRole) -> Option<ContactPoint> {
    ContactPoint::ALL.into_iter().find(|point| point.role() == role)
}

/// The point of the first joint from `joint` towards the root that has one.
fn of_joint(skeleton: &Skeleton, joint: JointId) -> Option<ContactPoint> {
    let mut at = Some(joint);
    while let Some(joint) = at {
        let joint = &skeleton.joints[joint.as_usize()];
        if let Some(point) = joint.role.and_then(of_role) {
            return Some(point);
        }
        at = joint.parent;
    }
    None
}

/// Two stated contacts of one point that share a frame: their places in `annotated`, the earlier one first.
pub fn overlap(annotated: &[AnnotatedContact]) -> Option<(usize, usize)> {
    let shares =
        |a: &AnnotatedContact, b: &AnnotatedContact| a.point == b.point && a.from <= b.to && b.from <= a.to;
    let pairs = (1..annotated.len()).flat_map(|later| (0..later).map(move |earlier| (earlier, later)));
    pairs.into_iter().find(|(earlier, later)| shares(&annotated[*earlier], &annotated[*later]))
}

/// Replaces the contacts of every point that `annotated` speaks of. `spans`: the working frames of each, `None` for one
/// outside the range.
pub fn apply(annotated: &[AnnotatedContact], spans: &[Option<(usize, usize)>], contacts: &mut [Contacts]) {
    for contact in contacts.iter_mut() {
        annotated.iter().for_each(|own| contact.set(own.point, false));
    }
    for (own, (first, last)) in annotated.iter().zip(spans).filter_map(|(own, span)| Some((own, (*span)?))) {
        contacts[first..=last].iter_mut().for_each(|contact| contact.set(own.point, true));
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::clip::builtin::generate;

    fn contact(point: ContactPoint, from: u32, to: u32) -> AnnotatedContact {
        AnnotatedContact { point, from: SourceFrame(from), to: SourceFrame(to) }
    }

    #[test]
    fn points_go_by_role_and_by_joint() {
        let clip = generate("idle", &BTreeMap::new()).expect("a generated clip");
        let skeleton = &clip.skeleton;
        for point in ContactPoint::ALL {
            assert_eq!(point_named(skeleton, point.role().name()), Ok(point));
            let joint = skeleton.joint_of(point.role()).expect("the generated body has all");
            assert_eq!(point_named(skeleton, &skeleton.joints[joint.as_usize()].name), Ok(point));
        }
        assert!(matches!(point_named(skeleton, "Fist"), Err(NoPoint::Unknown { .. })));
        assert!(matches!(point_named(skeleton, "head"), Err(NoPoint::NeitherHandNorFoot { .. })));
    }

    #[test]
    fn what_is_stated_of_a_point_replaces_what_is_found_of_it() {
        let found = Contacts { left_heel: true, left_toe: true, ..Contacts::default() };
        let mut contacts = vec![found; 6];
        let stated = [contact(ContactPoint::LeftHeel, 2, 3), contact(ContactPoint::RightHand, 90, 99)];
        apply(&stated, &[Some((2, 3)), None], &mut contacts);
        let heels: Vec<bool> = contacts.iter().map(|contact| contact.left_heel).collect();
        assert_eq!(heels, [false, false, true, true, false, false]);
        assert!(contacts.iter().all(|contact| contact.left_toe && !contact.right_hand));
    }

    #[test]
    fn contacts_overlap_only_where_one_point_shares_a_frame() {
        use ContactPoint::{LeftHand, RightHand};
        let apart = [contact(LeftHand, 3, 9), contact(RightHand, 3, 9), contact(LeftHand, 10, 12)];
        assert_eq!(overlap(&apart), None);
        assert_eq!(overlap(&[apart[0], apart[1], contact(LeftHand, 9, 12)]), Some((0, 2)));
    }
}
