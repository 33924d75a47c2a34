//! What a joint's name tells: a side of the body and a part of it.

/// Side of the body a name tells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    Left,
    Right,
}

/// What a name can mean, side aside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Part {
    Hip,
    Thigh,
    Leg,
    Shank,
    Foot,
    Toe,
    Collar,
    Shoulder,
    UpperArm,
    Forearm,
    Hand,
    Neck,
    Head,
    Chest,
    Trunk,
    Pelvis,
}

/// A joint that carries no flesh, only stray offsets: it counts for no height and no contact.
pub fn is_helper(name: &str) -> bool {
    name.to_ascii_uppercase().ends_with("_RIGMESH")
}

/// Side and part that a joint's name tells; `None` for helpers and names that mean nothing here.
pub(super) fn read_name(name: &str) -> Option<(Option<Side>, Part)> {
    let lower = name.to_ascii_lowercase();
    if is_helper(name) || lower.starts_with("__") {
        return None;
    }
    let bare = without_prefix(&lower);
    let plain: String = bare.chars().filter(char::is_ascii_alphabetic).collect();
    let (side, stem) = split_side(bare, &plain);
    let part = part_of(stem)?;
    let sided_part = !matches!(part, Part::Neck | Part::Head | Part::Chest | Part::Trunk | Part::Pelvis);
    match (side, part) {
        (None, Part::Hip) => Some((None, Part::Pelvis)),
        (None, _) if sided_part => None,
        (Some(_), _) if !sided_part => None,
        found => Some(found),
    }
}

/// `name` without `mixamorig:`, `character1_` and the like.
fn without_prefix(name: &str) -> &str {
    let name = name.rsplit(':').next().unwrap_or(name);
    for prefix in ["character", "mixamorig", "bip"] {
        if let Some(rest) = name.strip_prefix(prefix) {
            return rest.trim_start_matches(|c: char| !c.is_ascii_alphabetic());
        }
    }
    name
}

/// Side told at the start (`left…`, `l…`) or at the end (`….l`, `…_l`, `…left`), and what is left of the name.
fn split_side<'a>(bare: &str, plain: &'a str) -> (Option<Side>, &'a str) {
    for (word, letter, side) in [("left", 'l', Side::Left), ("right", 'r', Side::Right)] {
        if let Some(stem) = plain.strip_prefix(word).or_else(|| plain.strip_suffix(word)) {
            return (Some(side), stem);
        }
        let ends_so = bare.strip_suffix(letter).is_some_and(|rest| rest.ends_with(['.', '_', '-', ' ']));
        if ends_so {
            return (Some(side), &plain[..plain.len() - 1]);
        }
        match plain.strip_prefix(letter) {
            Some(stem) if part_of(stem).is_some() => return (Some(side), stem),
            _ => {}
        }
    }
    (None, plain)
}

/// Part that a lower-case word without side, digits and separators means.
fn part_of(stem: &str) -> Option<Part> {
    Some(match stem {
        "hip" | "hips" => Part::Hip,
        "pelvis" | "root" => Part::Pelvis,
        "upleg" | "upperleg" | "thigh" | "femur" => Part::Thigh,
        "leg" => Part::Leg,
        "lowleg" | "lowerleg" | "loleg" | "shin" | "knee" | "tibia" | "calf" => Part::Shank,
        "foot" | "ankle" => Part::Foot,
        "toe" | "toes" | "toebase" | "ball" => Part::Toe,
        "collar" | "clavicle" => Part::Collar,
        "shoulder" | "shldr" => Part::Shoulder,
        "arm" | "uparm" | "upperarm" | "humerus" => Part::UpperArm,
        "forearm" | "lowarm" | "lowerarm" | "loarm" | "elbow" | "radius" => Part::Forearm,
        "hand" | "wrist" => Part::Hand,
        "neck" | "lowerneck" | "upperneck" => Part::Neck,
        "head" => Part::Head,
        "chest" | "upperchest" | "thorax" => Part::Chest,
        "spine" | "lowerback" | "upperback" | "abdomen" => Part::Trunk,
        _ => return None,
    })
}
