//! Facings of people who stand: one turns the whole stationary stretch, the others turn the body on the spot.

use std::borrow::Borrow;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use crate::constraint::Strength;
use crate::edit::hold::{Prepared, Rotations};
use crate::geometry::c64;
use crate::path::RestPath;

/// Facings agree if they differ by no more than this, radians.
const AGREEMENT: f64 = 1e-9;
/// Moments nearer than this are one, frames.
const SAME_MOMENT: f64 = 1e-9;

/// Lets one facing turn each stationary stretch; the body alone turns for the others, which may differ, where facings are
/// corrected. Hard ones decide before soft ones, earlier ones before later ones. Cost: `n log n` in rows.
pub fn leave_to_the_body(held: &mut [Prepared], rests: &[impl Borrow<RestPath>]) {
    // Frames by path and first frame of the stretch.
    let mut decided: BTreeMap<(usize, usize), f64> = BTreeMap::new();
    let mut order: Vec<usize> = (0..held.len()).collect();
    order.sort_by_key(|row| held[*row].row.strength != Strength::Hard);
    // Frames and rows by path.
    let mut turned: BTreeMap<usize, Vec<(f64, usize)>> = BTreeMap::new();
    for row in order {
        let hold = held[row].row.hold;
        let (path, frame) = (hold.at().path, hold.at().frame);
        let in_run = hold.is_direction() && held[row].at.is_some_and(|direction| direction.in_run);
        let rest = rests[path].borrow();
        let Some(run) = rest.rigid_at(frame).filter(|_| in_run) else { continue };
        match decided.entry((path, run.0)) {
            Entry::Vacant(vacant) => {
                vacant.insert(frame);
            }
            // Two facings at one moment must agree, which the rows find out.
            Entry::Occupied(decider) if (decider.get() - frame).abs() < SAME_MOMENT => {}
            Entry::Occupied(_) => {
                held[row].body_only = true;
                turned.entry(path).or_default().push((frame, row));
            }
        }
    }
    for prepared in held.iter_mut() {
        let Some(to) = prepared.row.hold.to() else { continue };
        let own = turned.get(&to.path).into_iter().flatten();
        let last = own.rev().find(|(frame, _)| (to.frame - frame).abs() < SAME_MOMENT);
        prepared.partner_row = last.map(|(_, row)| *row).or(prepared.partner_row);
    }
}

/// The first two hard rows, left to one body at one moment, that ask for different facings, and by how many radians.
pub fn first_disagreement(held: &[Prepared], rotations: &[Rotations]) -> Option<([usize; 2], f64)> {
    let hard = |row: &usize| held[*row].body_only && held[*row].row.strength == Strength::Hard;
    let mut rows: Vec<usize> = (0..held.len()).filter(hard).collect();
    let moment = |row: usize| (held[row].row.hold.at().path, held[row].row.hold.at().frame);
    rows.sort_by(|a, b| moment(*a).0.cmp(&moment(*b).0).then(moment(*a).1.total_cmp(&moment(*b).1)));
    rows.windows(2).find_map(|pair| {
        let (a, b) = (moment(pair[0]), moment(pair[1]));
        let apart = (rotations[pair[0]].at / rotations[pair[1]].at).arg().abs();
        let clash = a.0 == b.0 && (a.1 - b.1).abs() < SAME_MOMENT && apart > AGREEMENT;
        clash.then_some(([pair[0], pair[1]], apart))
    })
}

/// Gives partners without direction the rotation that a relative facing of their own decided, and tells whether one
/// changed. `paths`: how many there are.
pub fn spread_still_rotations(held: &[Prepared], all: &mut [Rotations], paths: usize) -> bool {
    let mut decided: Vec<Option<c64>> = vec![None; paths];
    for (prepared, rotations) in held.iter().zip(&*all).rev() {
        if prepared.at.is_none() && prepared.row.hold.is_direction() {
            decided[prepared.row.hold.at().path] = Some(rotations.at);
        }
    }
    let mut changed = false;
    for (rotations, prepared) in all.iter_mut().zip(held) {
        if let (None, Some(rotation)) = (prepared.at, decided[prepared.row.hold.at().path]) {
            changed |= rotations.at != rotation;
            rotations.at = rotation;
        }
        let partner = prepared.row.hold.to().filter(|_| prepared.to.is_none());
        if let Some(rotation) = partner.and_then(|to| decided[to.path]) {
            changed |= rotations.to != rotation;
            rotations.to = rotation;
        }
    }
    changed
}
