//! What joints are called in a written file.

use std::collections::{HashMap, HashSet};

use crate::index::JointId;
use crate::skeleton::{JointRole, Skeleton};

/// How joints are named.
///
/// A preset names joints by what they are for. Of the trunk it names every joint from the pelvis up to the chest, and from
/// there every joint below the head, whether it has a role or not:
///
/// | joints between pelvis and chest, the chest included | CMU | Mixamo |
/// |---|---|---|
/// | one | `Spine` | `Spine` |
/// | two | `Spine`, `Spine1` | `Spine`, `Spine1` |
/// | three | `LowerBack`, `Spine`, `Spine1` | `Spine`, `Spine1`, `Spine2` |
/// | more | `LowerBack`, `Spine`, … `Spine3` … | `Spine`, … `Spine3` … |
///
/// and `Neck`, `Neck1`, … below the head. All other joints without a role keep their names. A name that is taken is
/// followed by `_2`, `_3`, …, so that names are unique; presets come first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum JointNames {
    /// As in the clip, repeated names as well.
    #[default]
    AsRead,
    /// Of the BVH conversions of the CMU database with 31 joints: `Hips`, `LeftUpLeg`, `LeftLeg`, …
    Cmu,
    /// Of Mixamo's characters: `mixamorig:Hips`, `mixamorig:LeftUpLeg`, …
    Mixamo,
}

/// Names of all joints of `skeleton`. Cost: linear.
pub(super) fn joint_names(skeleton: &Skeleton, names: JointNames) -> Vec<String> {
    let own = skeleton.joints.iter().map(|joint| joint.name.clone());
    match names {
        JointNames::AsRead => own.collect(),
        JointNames::Cmu => unique(own.zip(bare_names(skeleton, names)).collect()),
        JointNames::Mixamo => {
            let prefixed = bare_names(skeleton, names)
                .into_iter()
                .map(|name| name.map(|name| format!("mixamorig:{name}")));
            unique(own.zip(prefixed).collect())
        }
    }
}

/// The name a preset has for each joint, without prefix.
fn bare_names(skeleton: &Skeleton, names: JointNames) -> Vec<Option<String>> {
    let joint = |role| skeleton.joint_of(role).map(JointId::as_usize);
    let mut found: Vec<Option<String>> = vec![None; skeleton.joints.len()];
    let trunk = between(skeleton, joint(JointRole::Pelvis), joint(JointRole::Chest));
    let has_lower_back = names == JointNames::Cmu && trunk.len() > 2;
    for (place, &index) in trunk.iter().enumerate() {
        found[index] = Some(match (has_lower_back, place) {
            (true, 0) => "LowerBack".to_owned(),
            (true, place) => numbered("Spine", place - 1),
            (false, place) => numbered("Spine", place),
        });
    }
    let neck = between(skeleton, joint(JointRole::Chest), joint(JointRole::Head));
    for (place, &index) in neck.iter().enumerate() {
        found[index] = Some(numbered("Neck", place));
    }
    for (name, joint) in found.iter_mut().zip(&skeleton.joints) {
        let is_trunk = matches!(joint.role, Some(JointRole::Spine | JointRole::Chest | JointRole::Neck));
        match joint.role {
            Some(role) if !(is_trunk && name.is_some()) => *name = Some(role_name(role).to_owned()),
            _ => {}
        }
    }
    found
}

/// Joints on the way down from `above`, itself left out, to `below`; none where there is no such way.
fn between(skeleton: &Skeleton, above: Option<usize>, below: Option<usize>) -> Vec<usize> {
    let (Some(above), Some(below)) = (above, below) else {
        return Vec::new();
    };
    let parent = |joint: &usize| skeleton.joints[*joint].parent.map(JointId::as_usize);
    let mut way: Vec<usize> =
        std::iter::successors(Some(below), parent).take_while(|&joint| joint != above).collect();
    // Past the root: `above` is no ancestor.
    if way.last().is_none_or(|&highest| parent(&highest) != Some(above)) {
        return Vec::new();
    }
    way.reverse();
    way
}

/// `Spine`, `Spine1`, `Spine2`, …
fn numbered(name: &str, place: usize) -> String {
    if place == 0 { name.to_owned() } else { format!("{name}{place}") }
}

const fn role_name(role: JointRole) -> &'static str {
    match role {
        JointRole::Pelvis => "Hips",
        JointRole::Spine => "Spine",
        JointRole::Chest => "Spine1",
        JointRole::Neck => "Neck",
        JointRole::Head => "Head",
        JointRole::LeftClavicle => "LeftShoulder",
        JointRole::LeftShoulder => "LeftArm",
        JointRole::LeftElbow => "LeftForeArm",
        JointRole::LeftHand => "LeftHand",
        JointRole::RightClavicle => "RightShoulder",
        JointRole::RightShoulder => "RightArm",
        JointRole::RightElbow => "RightForeArm",
        JointRole::RightHand => "RightHand",
        JointRole::LeftHip => "LeftUpLeg",
        JointRole::LeftKnee => "LeftLeg",
        JointRole::LeftFoot => "LeftFoot",
        JointRole::LeftToe => "LeftToeBase",
        JointRole::RightHip => "RightUpLeg",
        JointRole::RightKnee => "RightLeg",
        JointRole::RightFoot => "RightFoot",
        JointRole::RightToe => "RightToeBase",
    }
}

/// The preset's name of each joint, else its own; the first to have a name keeps it, presets first.
fn unique(named: Vec<(String, Option<String>)>) -> Vec<String> {
    let mut taken = HashSet::new();
    let mut next: HashMap<String, usize> = HashMap::new();
    let mut found: Vec<Option<String>> = vec![None; named.len()];
    for by_preset in [true, false] {
        for (index, (own, preset)) in named.iter().enumerate() {
            if preset.is_some() == by_preset {
                found[index] = Some(free_name(preset.as_ref().unwrap_or(own), &mut taken, &mut next));
            }
        }
    }
    found.into_iter().flatten().collect()
}

fn free_name(wish: &str, taken: &mut HashSet<String>, next: &mut HashMap<String, usize>) -> String {
    let mut name = wish.to_owned();
    while !taken.insert(name.clone()) {
        let number = next.entry(wish.to_owned()).or_insert(1);
        *number += 1;
        name = format!("{wish}_{number}");
    }
    name
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::clip::roles::assign_roles;
    use crate::skeleton::{Axis, Joint};

    /// A skeleton of `name parent` pairs, parents by name, with the roles that names tell.
    fn skeleton(lines: &[(&str, &str)]) -> Skeleton {
        let mut joints: Vec<Joint> = Vec::new();
        for (name, parent) in lines {
            let parent = joints.iter().position(|joint| joint.name == *parent).map(JointId::from_usize);
            joints.push(Joint {
                name: (*name).to_owned(),
                parent,
                offset: DVec3::Y,
                end_site: None,
                rotation_order: [Axis::Z, Axis::X, Axis::Y],
                role: None,
            });
        }
        assign_roles(&mut joints);
        Skeleton { joints }
    }

    const DAZ: [(&str, &str); 12] = [
        ("hip", ""),
        ("abdomen", "hip"),
        ("Spine", "abdomen"),
        ("chest", "Spine"),
        ("neck", "chest"),
        ("head", "neck"),
        ("rShldr", "chest"),
        ("rForeArm", "rShldr"),
        ("lShldr", "chest"),
        ("lForeArm", "lShldr"),
        ("lThigh", "hip"),
        ("rThigh", "hip"),
    ];

    #[test]
    fn a_trunk_of_three_is_a_lower_back_and_two_spines() {
        let names = joint_names(&skeleton(&DAZ), JointNames::Cmu);
        assert_eq!(names[..6], ["Hips", "LowerBack", "Spine", "Spine1", "Neck", "Head"]);
        let names = joint_names(&skeleton(&DAZ), JointNames::Mixamo);
        let trunk =
            ["Hips", "Spine", "Spine1", "Spine2", "Neck", "Head"].map(|name| format!("mixamorig:{name}"));
        assert_eq!(names[..6], trunk);
        assert_eq!(names[11], "mixamorig:RightUpLeg");
    }

    #[test]
    fn a_joint_without_a_role_gives_way_to_a_preset() {
        let mut lines = DAZ.to_vec();
        lines.extend([
            ("LeftArm", "lForeArm"),
            ("charm", "lForeArm"),
            ("charm", "rForeArm"),
            ("charm_2", "hip"),
        ]);
        let mut skeleton = skeleton(&lines);
        for joint in &mut skeleton.joints[12..] {
            joint.role = None;
        }
        skeleton.joints[8].role = Some(JointRole::LeftShoulder);
        let names = joint_names(&skeleton, JointNames::Cmu);
        assert_eq!(names[8], "LeftArm");
        assert_eq!(names[12..], ["LeftArm_2", "charm", "charm_2", "charm_2_2"]);
    }

    #[test]
    fn names_as_read_stay_even_where_they_repeat() {
        let mut twice = skeleton(&DAZ);
        twice.joints[3].name = "hip".to_owned();
        assert_eq!(joint_names(&twice, JointNames::AsRead)[3], "hip");
    }
}
