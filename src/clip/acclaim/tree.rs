//! The tree of bones that a hierarchy describes.

use std::collections::{HashMap, HashSet};

use super::error::AsfError;
use super::lines::Lines;
use super::skeleton::{Bone, Hang};
use crate::clip::text::{Word, quote};

/// `bones` with their parents, parents before children, children in the order of `hangs`. Cost: linear.
///
/// # Errors
/// Names that repeat or are unknown, bones with two parents or none.
pub(super) fn in_order<'a>(
    lines: &Lines<'_>,
    bones: Vec<Bone<'a>>,
    hangs: &[Hang<'a>],
) -> Result<Vec<Bone<'a>>, AsfError> {
    let children = children(lines, &bones, hangs)?;
    let mut bones: Vec<Option<Bone<'a>>> = bones.into_iter().map(Some).collect();
    let mut ordered = Vec::with_capacity(bones.len());
    // Bones to place, the next one last, with where their parent was placed. No recursion: trees may be deep.
    let mut open: Vec<(usize, Option<usize>)> = Vec::new();
    open.extend(children[0].iter().rev().map(|&child| (child, None)));
    while let Some((index, parent)) = open.pop() {
        let bone = bones[index].take().expect("a bone hangs on one other only");
        let place = Some(ordered.len());
        ordered.push(Bone { parent, ..bone });
        open.extend(children[index + 1].iter().rev().map(|&child| (child, place)));
    }
    match bones.into_iter().flatten().next() {
        None => Ok(ordered),
        Some(Bone { name, .. }) => {
            Err(AsfError::NotConnected { at: lines.position(name), bone: quote(name.bytes) })
        }
    }
}

/// Positions of the bones that hang on the root, then on each bone.
fn children(lines: &Lines<'_>, bones: &[Bone<'_>], hangs: &[Hang<'_>]) -> Result<Vec<Vec<usize>>, AsfError> {
    let index = by_name(lines, bones)?;
    let find = |word: Word<'_>| {
        let unknown = || AsfError::UnknownBone { at: lines.position(word), name: quote(word.bytes) };
        index.get(word.bytes).copied().ok_or_else(unknown)
    };
    let mut children = vec![Vec::new(); bones.len() + 1];
    let mut hung = HashSet::new();
    for hang in hangs {
        let parent = if hang.parent.is("root") { 0 } else { find(hang.parent)? + 1 };
        let child = find(hang.child)?;
        if !hung.insert(child) {
            let at = lines.position(hang.child);
            return Err(AsfError::SecondParent { at, bone: quote(hang.child.bytes) });
        }
        children[parent].push(child);
    }
    Ok(children)
}

/// Position of each bone by its name.
fn by_name<'a>(lines: &Lines<'_>, bones: &[Bone<'a>]) -> Result<HashMap<&'a [u8], usize>, AsfError> {
    let mut index = HashMap::with_capacity(bones.len());
    for (position, bone) in bones.iter().enumerate() {
        let name = bone.name;
        if name.is("root") || index.insert(name.bytes, position).is_some() {
            return Err(AsfError::NameTaken { at: lines.position(name), name: quote(name.bytes) });
        }
    }
    Ok(index)
}
