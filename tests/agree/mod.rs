//! The reduced and the direct backend come to the same answer, error or notes.

use cotillion::edit::{Backend, Edit, EditError, Editor};
use cotillion::scene::Scene;

/// Places of the two, metres. Where somebody is sent farther off than [`FAR`], rounding grows with the distance, and so
/// does its lever, as an offset enters the rows in strides: both tolerances grow with the square.
const PLACES: f64 = 1e-8;
/// Farther than any stage, metres.
const FAR: f64 = 100.0;
/// Where nothing but the rest motion says how a scene is turned as a whole, that is known to `ε (r/s)²` at `r` metres from where
/// it was, if people hardly move: `s`, metres, is the extent of a sway. Places turn about the middle with it.
const SWAY: f64 = 0.1;
/// Times of the two, seconds.
const TIMES: f64 = 1e-9;
/// Energies of the two: relative, and in Ê.
const ENERGIES: (f64, f64) = (1e-8, 1e-12);

/// Edits `scene` by both backends and compares.
pub(crate) fn both_backends(scene: &Scene) -> Result<(), String> {
    let [reduced, direct] = [Backend::Reduced, Backend::Direct].map(|backend| edit(scene, backend));
    match (reduced, direct) {
        (Ok(reduced), Ok(direct)) => same_edit(&reduced, &direct),
        (Err(reduced), Err(direct)) => same_error(&reduced, &direct),
        (reduced, direct) => Err(format!("reduced: {:?}, direct: {:?}", reduced.err(), direct.err())),
    }
}

fn edit(scene: &Scene, backend: Backend) -> Result<Edit, EditError> {
    let mut editor = Editor::assemble(scene.clone(), backend);
    editor.solve().cloned()
}

/// Numbers are rounded when they are told: the words must be the same, as those of notes.
fn same_error(reduced: &EditError, direct: &EditError) -> Result<(), String> {
    let (reduced, direct) = (reduced.to_string(), direct.to_string());
    if reduced == direct { Ok(()) } else { Err(format!("reduced: {reduced}\ndirect: {direct}")) }
}

fn same_edit(reduced: &Edit, direct: &Edit) -> Result<(), String> {
    let farthest = direct.characters.iter().flat_map(|c| &c.positions).map(|p| p.norm()).fold(FAR, f64::max);
    let lever = (farthest / FAR).powi(2);
    let turned = f64::EPSILON * farthest * (farthest / SWAY).powi(2);
    for (index, (own, other)) in reduced.characters.iter().zip(&direct.characters).enumerate() {
        for (frame, (p, q)) in own.positions.iter().zip(&other.positions).enumerate() {
            let apart = (p - q).norm();
            if apart.is_nan() || apart > PLACES * lever + turned {
                return Err(format!("character {index} at frame {frame}: {p} or {q}, {apart:e} apart"));
            }
        }
        for (frame, (t, u)) in own.times.iter().zip(&other.times).enumerate() {
            if (t - u).is_nan() || (t - u).abs() > TIMES {
                return Err(format!("character {index} at frame {frame}: {t} s or {u} s"));
            }
        }
    }
    let terms = |edit: &Edit| [edit.energy.shape, edit.energy.scale, edit.energy.time];
    for (a, b) in terms(reduced).into_iter().zip(terms(direct)) {
        if (a - b).is_nan() || (a - b).abs() > (ENERGIES.0 * b).max(ENERGIES.1 * lever) {
            return Err(format!("energies {:?} or {:?}", reduced.energy, direct.energy));
        }
    }
    let notes = |edit: &Edit| edit.notes.iter().map(ToString::to_string).collect::<Vec<_>>();
    if notes(reduced) == notes(direct) {
        Ok(())
    } else {
        Err(format!("notes {:?} or {:?}", reduced.notes, direct.notes))
    }
}
