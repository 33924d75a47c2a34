//! The text of an ASF file as it stands: sections, bones, tree; file units, its own angles.

use super::bones::bones;
use super::error::AsfError;
use super::lines::Lines;
use super::tree::in_order;
use crate::clip::text::{TextError, Word, quote};
use crate::skeleton::Axis;

/// Most bones a file may have, the root not counted.
pub(super) const BONE_LIMIT: usize = 65_535;

/// Lengths and coordinates beyond this, file units, belong to no body.
pub(super) const FARTHEST: f64 = 1e9;

/// File units of length per inch outside these are none.
const UNIT_RANGE: std::ops::RangeInclusive<f64> = 1e-6..=1e6;

/// How a file writes angles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum AngleUnit {
    #[default]
    Degrees,
    Radians,
}

impl AngleUnit {
    pub(super) fn to_degrees(self, angle: f64) -> f64 {
        match self {
            Self::Degrees => angle,
            Self::Radians => angle.to_degrees(),
        }
    }
}

/// What one value of a motion moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Dof {
    Place(Axis),
    Turn(Axis),
}

/// Angles about three axes, the first turned first, in the file's unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Turns {
    /// About x, y and z.
    pub(super) angles: [f64; 3],
    pub(super) order: [Axis; 3],
}

/// Where the body stands before any motion, and what a motion says of it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Root {
    /// What the values of a motion are, in their order.
    pub(super) dofs: Vec<Dof>,
    pub(super) position: [f64; 3],
    pub(super) orientation: Turns,
}

/// A bone as the file has it.
#[derive(Clone, Debug)]
pub(super) struct Bone<'a> {
    pub(super) name: Word<'a>,
    /// From its start to its end in the body's axes at rest: direction times length.
    pub(super) reach: [f64; 3],
    pub(super) axis: Turns,
    /// Axes it turns about, in the order of the motion's values; the first is turned first.
    pub(super) dofs: Vec<Axis>,
    /// Position of the parent in the list of bones; `None` below the root.
    pub(super) parent: Option<usize>,
}

/// A whole file.
#[derive(Clone, Debug)]
pub(super) struct RawSkeleton<'a> {
    /// `length` of the units, where the file has it.
    pub(super) units_per_inch: Option<f64>,
    pub(super) angles: AngleUnit,
    pub(super) root: Root,
    /// Parents before children.
    pub(super) bones: Vec<Bone<'a>>,
}

/// What the sections say, each as far as it was read.
#[derive(Debug, Default)]
struct Sections<'a> {
    units: Option<(Option<f64>, AngleUnit)>,
    root: Option<Root>,
    bones: Option<Vec<Bone<'a>>>,
    hangs: Option<Vec<Hang<'a>>>,
}

/// A line of the hierarchy says that `child` hangs on `parent`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hang<'a> {
    pub(super) parent: Word<'a>,
    pub(super) child: Word<'a>,
}

/// Reads the text; cost linear in its length, memory in what the file really holds.
pub(super) fn parse(bytes: &[u8]) -> Result<RawSkeleton<'_>, AsfError> {
    let mut lines = Lines::new(bytes);
    let mut sections = Sections::default();
    let mut is_first = true;
    while let Some(word) = lines.word() {
        if is_first && word.bytes.first() != Some(&b':') {
            let found = format!("`{}`", quote(word.bytes));
            return Err(AsfError::NotAsf { at: lines.position(word), found });
        }
        is_first = false;
        section(&mut lines, word, &mut sections)?;
    }
    if is_first {
        return Err(AsfError::NotAsf { at: lines.here(), found: "nothing".to_owned() });
    }
    let missing = |section| AsfError::NoSection { at: lines.here(), section };
    let (units_per_inch, angles) = sections.units.unwrap_or_default();
    let root = sections.root.ok_or_else(|| missing(":root"))?;
    let bones = sections.bones.ok_or_else(|| missing(":bonedata"))?;
    let hangs = sections.hangs.ok_or_else(|| missing(":hierarchy"))?;
    Ok(RawSkeleton { units_per_inch, angles, root, bones: in_order(&lines, bones, &hangs)? })
}

/// The section that `word` starts; sections that say nothing of bones are skipped.
fn section<'a>(lines: &mut Lines<'a>, word: Word<'a>, into: &mut Sections<'a>) -> Result<(), AsfError> {
    if word.is(":units") {
        once(lines, word, into.units.is_some())?;
        into.units = Some(units(lines)?);
    } else if word.is(":root") {
        once(lines, word, into.root.is_some())?;
        into.root = Some(root(lines)?);
    } else if word.is(":bonedata") {
        once(lines, word, into.bones.is_some())?;
        into.bones = Some(bones(lines)?);
    } else if word.is(":hierarchy") {
        once(lines, word, into.hangs.is_some())?;
        into.hangs = Some(hierarchy(lines)?);
    } else if word.bytes.first() == Some(&b':') {
        lines.skip_section();
    } else {
        return Err(lines.unexpected(word, "a section such as :bonedata").into());
    }
    Ok(())
}

pub(super) fn once(lines: &Lines<'_>, word: Word<'_>, is_there: bool) -> Result<(), AsfError> {
    if is_there {
        return Err(AsfError::Repeated { at: lines.position(word), what: quote(word.bytes) });
    }
    Ok(())
}

fn units(lines: &mut Lines<'_>) -> Result<(Option<f64>, AngleUnit), AsfError> {
    let mut length = None;
    let mut angles = None;
    while let Some(word) = lines.word_in_section() {
        if word.is("mass") {
            lines.next_number()?;
        } else if word.is("length") {
            once(lines, word, length.is_some())?;
            length = Some(in_range(lines, *UNIT_RANGE.start(), *UNIT_RANGE.end(), "unit of length")?);
        } else if word.is("angle") {
            once(lines, word, angles.is_some())?;
            angles = Some(angle_unit(lines)?);
        } else {
            return Err(lines.unexpected(word, "mass, length or angle").into());
        }
    }
    Ok((length, angles.unwrap_or_default()))
}

fn angle_unit(lines: &mut Lines<'_>) -> Result<AngleUnit, TextError> {
    let expected = "deg or rad";
    let word = lines.next(expected)?;
    if word.is("deg") || word.is("degrees") {
        Ok(AngleUnit::Degrees)
    } else if word.is("rad") || word.is("radians") {
        Ok(AngleUnit::Radians)
    } else {
        Err(lines.unexpected(word, expected))
    }
}

fn root(lines: &mut Lines<'_>) -> Result<Root, AsfError> {
    let mut dofs = None;
    let mut position = None;
    let mut axis = None;
    let mut orientation = None;
    while let Some(word) = lines.word_in_section() {
        if word.is("order") {
            once(lines, word, dofs.is_some())?;
            dofs = Some(root_dofs(lines)?);
        } else if word.is("axis") {
            once(lines, word, axis.is_some())?;
            axis = Some(rotation_order(lines)?);
        } else if word.is("position") {
            once(lines, word, position.is_some())?;
            position = Some(place(lines)?);
        } else if word.is("orientation") {
            once(lines, word, orientation.is_some())?;
            orientation = Some(three_numbers(lines)?);
        } else {
            return Err(lines.unexpected(word, "order, axis, position or orientation").into());
        }
    }
    let usual = || [Dof::Place as fn(Axis) -> Dof, Dof::Turn].map(|dof| XYZ.map(dof)).concat();
    Ok(Root {
        dofs: dofs.unwrap_or_else(usual),
        position: position.unwrap_or_default(),
        orientation: Turns { angles: orientation.unwrap_or_default(), order: axis.unwrap_or(XYZ) },
    })
}

const XYZ: [Axis; 3] = [Axis::X, Axis::Y, Axis::Z];

/// The words of the line behind `order`: what each value of the root is.
fn root_dofs(lines: &mut Lines<'_>) -> Result<Vec<Dof>, AsfError> {
    let known = "the root has TX, TY, TZ, RX, RY and RZ";
    let mut dofs = Vec::new();
    while let Some(word) = lines.word_in_line() {
        let Some(dof) = dof(word.bytes) else {
            return Err(AsfError::UnknownDof { at: lines.position(word), found: quote(word.bytes), known });
        };
        once(lines, word, dofs.contains(&dof))?;
        dofs.push(dof);
    }
    Ok(dofs)
}

pub(super) fn dof(word: &[u8]) -> Option<Dof> {
    let [kind, axis] = word else { return None };
    let axis = axis_of(*axis)?;
    match kind.to_ascii_lowercase() {
        b't' => Some(Dof::Place(axis)),
        b'r' => Some(Dof::Turn(axis)),
        _ => None,
    }
}

fn axis_of(letter: u8) -> Option<Axis> {
    match letter.to_ascii_lowercase() {
        b'x' => Some(Axis::X),
        b'y' => Some(Axis::Y),
        b'z' => Some(Axis::Z),
        _ => None,
    }
}

/// A word like XYZ.
pub(super) fn rotation_order(lines: &mut Lines<'_>) -> Result<[Axis; 3], AsfError> {
    let word = lines.next("an order of rotations such as XYZ")?;
    let axes: Option<Vec<Axis>> = word.bytes.iter().map(|&letter| axis_of(letter)).take(4).collect();
    match axes.as_deref() {
        Some(&[a, b, c]) if a != b && b != c && a != c => Ok([a, b, c]),
        _ => Err(AsfError::RotationOrder { at: lines.position(word), found: quote(word.bytes) }),
    }
}

/// Who hangs on whom; both words read that enclose it.
fn hierarchy<'a>(lines: &mut Lines<'a>) -> Result<Vec<Hang<'a>>, AsfError> {
    lines.expect("begin", "begin")?;
    let mut hangs = Vec::new();
    loop {
        let parent = lines.next("end of the hierarchy")?;
        if parent.is("end") {
            return Ok(hangs);
        }
        while let Some(child) = lines.word_in_line() {
            if hangs.len() == BONE_LIMIT {
                return Err(AsfError::TooManyBones { at: lines.position(child), limit: BONE_LIMIT });
            }
            hangs.push(Hang { parent, child });
        }
    }
}

pub(super) fn three_numbers(lines: &mut Lines<'_>) -> Result<[f64; 3], TextError> {
    Ok([lines.next_number()?, lines.next_number()?, lines.next_number()?])
}

pub(super) fn place(lines: &mut Lines<'_>) -> Result<[f64; 3], AsfError> {
    let mut place = [0.0; 3];
    for coordinate in &mut place {
        *coordinate = in_range(lines, -FARTHEST, FARTHEST, "coordinate")?;
    }
    Ok(place)
}

pub(super) fn in_range(
    lines: &mut Lines<'_>,
    least: f64,
    most: f64,
    what: &'static str,
) -> Result<f64, AsfError> {
    let word = lines.next("a number")?;
    let found = lines.number(word)?;
    if (least..=most).contains(&found) {
        return Ok(found);
    }
    Err(AsfError::OutOfRange { at: lines.position(word), found, what, least, most })
}
