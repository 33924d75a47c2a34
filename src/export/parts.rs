//! Results of many characters in parts: each is sampled, corrected and written before the next, so that memory holds one.

use std::collections::BTreeMap;

use crate::embody::closed_groups;
use crate::index::{CharacterId, ObjectId};
use crate::scene::Scene;
use crate::ties::Ties;

/// Scenes of more characters are written in parts, and their BVH files only on request.
pub const MANY: usize = 200;
/// Characters of a part; more where those reach others.
const OF_A_PART: usize = 100;

/// Characters and objects that are written together.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    /// Rising; all that any of them reaches is among them.
    pub members: Vec<CharacterId>,
    /// Those that one of the members is the first to carry; in the first part also all that nobody carries.
    pub objects: Vec<ObjectId>,
    /// Name of its GLB file.
    pub glb: String,
}

impl Part {
    /// A whole scene as one part.
    pub fn everything(scene: &Scene) -> Self {
        Self {
            members: (0..scene.characters.len()).map(CharacterId::from_usize).collect(),
            objects: (0..scene.objects.len()).map(ObjectId::from_usize).collect(),
            glb: "scene.glb".to_owned(),
        }
    }
}

/// The parts of a scene: one of up to [`MANY`] characters; else of a hundred each or a little more, those who reach each other
/// together. Cost: linear.
pub fn parts(scene: &Scene, ties: &Ties) -> Vec<Part> {
    if scene.characters.len() <= MANY {
        return vec![Part::everything(scene)];
    }
    let mut members: Vec<Vec<CharacterId>> = vec![Vec::new()];
    for mut group in closed_groups(scene, ties) {
        if members.last().is_some_and(|last| last.len() >= OF_A_PART) {
            members.push(Vec::new());
        }
        members.last_mut().expect("there is a first part").append(&mut group);
    }
    let digits = members.len().to_string().len();
    let named = members.into_iter().enumerate().map(|(index, mut members)| {
        members.sort_unstable();
        Part { members, objects: Vec::new(), glb: format!("scene-{:0digits$}.glb", index + 1) }
    });
    let mut parts: Vec<Part> = named.collect();
    let part_of: BTreeMap<CharacterId, usize> = parts
        .iter()
        .enumerate()
        .flat_map(|(index, part)| part.members.iter().map(move |who| (*who, index)))
        .collect();
    let mut carriers: BTreeMap<ObjectId, CharacterId> = BTreeMap::new();
    for carry in &scene.carries {
        carry.by.first().inspect(|who| {
            carriers.entry(carry.object).or_insert(**who);
        });
    }
    for object in (0..scene.objects.len()).map(ObjectId::from_usize) {
        let part = carriers.get(&object).map_or(0, |who| part_of[who]);
        parts[part].objects.push(object);
    }
    parts
}
