//! The bones of an ASF file.

use super::error::AsfError;
use super::lines::{Lines, Pieces};
use super::skeleton::{
    BONE_LIMIT, Bone, Dof, FARTHEST, Turns, dof, in_range, once, place, rotation_order, three_numbers,
};
use crate::clip::text::{TextError, Word, quote};
use crate::skeleton::Axis;

/// Fields of a bone that may come in any order.
#[derive(Debug, Default)]
struct Fields<'a> {
    name: Option<Word<'a>>,
    direction: Option<[f64; 3]>,
    length: Option<f64>,
    axis: Option<Turns>,
    dofs: Option<(Word<'a>, Vec<Axis>)>,
    limits: Option<(Word<'a>, usize)>,
}

/// The bones of the section, up to the next one.
pub(super) fn bones<'a>(lines: &mut Lines<'a>) -> Result<Vec<Bone<'a>>, AsfError> {
    let mut bones = Vec::new();
    while let Some(word) = lines.word_in_section() {
        if !word.is("begin") {
            return Err(lines.unexpected(word, "begin, or the next section").into());
        }
        if bones.len() == BONE_LIMIT {
            return Err(AsfError::TooManyBones { at: lines.position(word), limit: BONE_LIMIT });
        }
        bones.push(bone(lines)?);
    }
    Ok(bones)
}

/// What stands between `begin` and `end`, `end` read.
fn bone<'a>(lines: &mut Lines<'a>) -> Result<Bone<'a>, AsfError> {
    let mut fields = Fields::default();
    loop {
        let word = lines.next("end of the bone")?;
        if word.is("end") {
            return whole_bone(lines, word, fields);
        }
        bone_field(lines, word, &mut fields)?;
    }
}

fn bone_field<'a>(lines: &mut Lines<'a>, word: Word<'a>, into: &mut Fields<'a>) -> Result<(), AsfError> {
    if word.is("id") {
        let word = lines.next("a number")?;
        lines.count(word, "bones")?;
    } else if word.is("name") {
        once(lines, word, into.name.is_some())?;
        into.name = Some(lines.next("the name of the bone")?);
    } else if word.is("direction") {
        once(lines, word, into.direction.is_some())?;
        into.direction = Some(place(lines)?);
    } else if word.is("length") {
        once(lines, word, into.length.is_some())?;
        into.length = Some(in_range(lines, 0.0, FARTHEST, "length")?);
    } else if word.is("axis") {
        once(lines, word, into.axis.is_some())?;
        let angles = three_numbers(lines)?;
        into.axis = Some(Turns { angles, order: rotation_order(lines)? });
    } else if word.is("dof") {
        once(lines, word, into.dofs.is_some())?;
        into.dofs = Some((word, bone_dofs(lines, into.name)?));
    } else if word.is("limits") {
        once(lines, word, into.limits.is_some())?;
        into.limits = Some((word, limits(lines)?));
    } else if word.is("bodymass") || word.is("cofmass") {
        lines.next_number()?;
    } else {
        return Err(lines.unexpected(word, "a field of a bone, or its end").into());
    }
    Ok(())
}

/// The words of the line behind `dof`.
fn bone_dofs(lines: &mut Lines<'_>, name: Option<Word<'_>>) -> Result<Vec<Axis>, AsfError> {
    let mut axes = Vec::new();
    while let Some(word) = lines.word_in_line() {
        let found = || quote(word.bytes);
        match dof(word.bytes) {
            Some(Dof::Turn(axis)) => {
                once(lines, word, axes.contains(&axis))?;
                axes.push(axis);
            }
            None if !word.is("l") => {
                let known = "bones have rx, ry and rz";
                return Err(AsfError::UnknownDof { at: lines.position(word), found: found(), known });
            }
            _ => {
                let bone = name.map_or_else(String::new, |name| quote(name.bytes));
                return Err(AsfError::MovingBone { at: lines.position(word), bone, found: found() });
            }
        }
    }
    Ok(axes)
}

/// Counts the pairs in parentheses behind `limits`, each of a lower and an upper limit.
fn limits(lines: &mut Lines<'_>) -> Result<usize, AsfError> {
    let mut pieces = Pieces::new(lines);
    let mut count = 0;
    while pieces.opens() {
        let at = pieces.expect("(", "an opening parenthesis")?;
        let low = limit(&mut pieces)?;
        let high = limit(&mut pieces)?;
        pieces.expect(")", "a closing parenthesis")?;
        if low > high {
            return Err(AsfError::LimitsCross { at: pieces.lines().position(at), low, high });
        }
        count += 1;
    }
    Ok(count)
}

/// A number, or the word `inf` or `-inf`: no limit.
fn limit(pieces: &mut Pieces<'_, '_>) -> Result<f64, TextError> {
    let word = pieces.next("a limit")?;
    if word.is("-inf") {
        Ok(f64::NEG_INFINITY)
    } else if word.is("inf") {
        Ok(f64::INFINITY)
    } else {
        pieces.lines().number(word)
    }
}

/// The bone of `fields`, all of which are there; `end` is where it ends.
fn whole_bone<'a>(lines: &Lines<'a>, end: Word<'_>, fields: Fields<'a>) -> Result<Bone<'a>, AsfError> {
    let shown = fields.name.map_or_else(String::new, |name| quote(name.bytes));
    let lacks = |field| AsfError::BoneLacks { at: lines.position(end), bone: shown.clone(), field };
    let name = fields.name.ok_or_else(|| lacks("name"))?;
    let direction = fields.direction.ok_or_else(|| lacks("direction"))?;
    let length = fields.length.ok_or_else(|| lacks("length"))?;
    let axis = fields.axis.ok_or_else(|| lacks("axis"))?;
    let dofs = fields.dofs.map_or_else(Vec::new, |(_, dofs)| dofs);
    if let Some((word, found)) = fields.limits.filter(|(_, found)| *found != dofs.len()) {
        let dofs = dofs.len();
        return Err(AsfError::LimitCount { at: lines.position(word), bone: shown, dofs, found });
    }
    Ok(Bone { name, reach: direction.map(|part| part * length), axis, dofs, parent: None })
}
