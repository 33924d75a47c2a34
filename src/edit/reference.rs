//! Where paths would lie if nothing bent them: what constraints do not decide stays as there.

use std::collections::VecDeque;

use crate::constraint::Strength;
use crate::edit::hold::{Hold, Place, Prepared, Rotations};
use crate::geometry::{c64, cis};
use crate::path;

/// Displacement of each path that its constraints ask for: the mean of its pinned places, hard ones alone where there are
/// any; without pins, what an offset from a displaced partner asks for; else `None`.
///
/// `path`: points of the paths to be displaced, `paths` in number; `rotations`: of the places of a held row against rest. Cost:
/// linear in rows and paths.
pub fn reference_translations<'a>(
    paths: usize,
    path: impl Fn(usize) -> &'a [c64],
    held: &[Prepared],
    rotations: impl Fn(usize) -> Rotations,
) -> Vec<Option<c64>> {
    let mut sums = vec![[(c64::default(), 0.0); 2]; paths];
    let point =
        |place: Place, rotation: c64| path::at(path(place.path), place.frame) + rotation * place.detail;
    for (row, prepared) in held.iter().enumerate() {
        let rotations = rotations(row);
        match prepared.row.hold {
            Hold::Position { at, .. } | Hold::Beside { at, .. } => {
                let target = match prepared.row.hold {
                    Hold::Position { target, .. } => target,
                    Hold::Beside { to, from, target, .. } => {
                        let on_path = |place: Place| path::at(path(place.path), place.frame);
                        target + on_path(to) - on_path(from)
                    }
                    _ => continue,
                };
                let (rank, weight) = match prepared.row.strength {
                    Strength::Hard => (0, 1.0),
                    Strength::Soft(weight) => (1, weight),
                };
                let (sum, total) = &mut sums[at.path][rank];
                *sum += (target - point(at, rotations.at)) * weight;
                *total += weight;
            }
            Hold::Offset { .. } | Hold::Facing { .. } | Hold::RelativeFacing { .. } => {}
        }
    }
    let mean =
        |sums: &[(c64, f64); 2]| sums.iter().find(|(_, total)| *total > 0.0).map(|(sum, total)| sum / total);
    let mut known: Vec<Option<c64>> = sums.iter().map(mean).collect();
    if known.contains(&None) {
        let mut ties: Vec<Vec<(usize, c64)>> = vec![Vec::new(); paths];
        for (row, prepared) in held.iter().enumerate() {
            let Hold::Offset { at, to, offset } = prepared.row.hold else { continue };
            let rotations = rotations(row);
            let wanted = cis(to.heading) * rotations.to * offset;
            let apart = wanted - (point(at, rotations.at) - point(to, rotations.to));
            ties[to.path].push((at.path, apart));
            ties[at.path].push((to.path, -apart));
        }
        spread(&ties, &mut known);
    }
    known
}

/// Gives paths without pins the displacement that keeps them at their offsets from displaced partners, nearest first.
fn spread(ties: &[Vec<(usize, c64)>], known: &mut [Option<c64>]) {
    let mut queue: VecDeque<usize> = (0..known.len()).filter(|path| known[*path].is_some()).collect();
    while let Some(path) = queue.pop_front() {
        let own = known[path].unwrap_or_default();
        for (partner, apart) in &ties[path] {
            if known[*partner].is_none() {
                known[*partner] = Some(own + apart);
                queue.push_back(*partner);
            }
        }
    }
}
