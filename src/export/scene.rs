//! The files of a whole scene: BVH per character, one GLB, a picture. `report.json` comes last, as it names them.

use crate::constraint::{Constraint, ConstraintKind, Partner, Relation, Strength, When};
use crate::edit::expand::frame_of;
use crate::edit::{Edit, EditedCharacter};
use crate::export::bvh::{BvhOptions, to_bvh_with};
use crate::export::files::{OutputFile, file_names};
use crate::export::gltf::{GlbObject, GlbScene, Performer, to_glb};
use crate::export::picture::{Actor, Handle, Picture, PictureObject, Tie, to_svg};
use crate::geometry::{c64, cis};
use crate::path;
use crate::resample::{Resampled, time_of};
use crate::scene::{Character, Scene};

/// BVH files, GLB and picture of an edited scene, in this order.
pub fn scene_files(scene: &Scene, edit: &Edit, resampled: &Resampled, bvh: &BvhOptions) -> Vec<OutputFile> {
    let names: Vec<&str> = scene.characters.iter().map(|character| character.name.as_str()).collect();
    let mut files: Vec<OutputFile> = file_names(&names)
        .into_iter()
        .zip(&resampled.clips)
        .map(|(name, clip)| OutputFile {
            name: format!("{name}.bvh"),
            bytes: to_bvh_with(clip, bvh).into_bytes(),
        })
        .collect();
    files.push(OutputFile { name: "scene.glb".to_owned(), bytes: glb(scene, resampled) });
    let svg = picture_svg(scene, edit);
    files.push(OutputFile { name: "scene.svg".to_owned(), bytes: svg.into_bytes() });
    files
}

fn glb(scene: &Scene, resampled: &Resampled) -> Vec<u8> {
    let performers = scene.characters.iter().zip(&resampled.clips);
    let objects = scene.objects.iter().map(|object| GlbObject {
        name: &object.name,
        size: object.size,
        position: object.position,
        facing: object.facing,
    });
    to_glb(&GlbScene {
        title: &scene.title,
        performers: performers.map(|(character, clip)| Performer { name: &character.name, clip }).collect(),
        objects: objects.collect(),
    })
}

/// Picture of an edited scene: paths from above, and time tracks.
pub fn picture_svg(scene: &Scene, edit: &Edit) -> String {
    let headings: Vec<Vec<f64>> = edit.characters.iter().map(headings).collect();
    let actors = scene.characters.iter().zip(&edit.characters).zip(&headings);
    let objects = scene.objects.iter().map(|object| PictureObject {
        name: &object.name,
        size: object.size,
        position: object.position,
        facing: object.facing,
    });
    to_svg(&Picture {
        title: &scene.title,
        actors: actors.map(|((character, edited), headings)| actor(character, edited, headings)).collect(),
        objects: objects.collect(),
        handles: scene.constraints.iter().flat_map(|constraint| handles(scene, edit, constraint)).collect(),
        ties: scene.constraints.iter().flat_map(|constraint| ties(scene, edit, constraint)).collect(),
    })
}

/// Facing at each working frame after the edit.
fn headings(edited: &EditedCharacter) -> Vec<f64> {
    let rest = edited.rest.headings.iter().enumerate();
    rest.map(|(frame, heading)| heading + edited.turns.at(frame as f64)).collect()
}

fn actor<'a>(character: &'a Character, edited: &'a EditedCharacter, headings: &'a [f64]) -> Actor<'a> {
    let track = &character.track;
    let runs = track.placed_runs();
    let clips =
        runs.map(|(run, start)| (track.clips[run.entry].name.clone(), start, start + run.frame_count() - 1));
    Actor {
        name: &character.name,
        rest: &edited.rest.positions,
        edited: &edited.positions,
        headings,
        times: &edited.times,
        clips: clips.collect(),
        stationary: edited.rest.rigid.clone(),
    }
}

/// Frames of a constraint's handles: its moment, or both ends of its interval.
fn ends(scene: &Scene, when: &When) -> Vec<f64> {
    when.moments().into_iter().map(|moment| frame_of(scene, moment)).collect()
}

fn handles(scene: &Scene, edit: &Edit, constraint: &Constraint) -> Vec<Handle> {
    let hard = constraint.strength == Strength::Hard;
    let handle = |when: &When, frame: f64, target: Option<c64>, facing: Option<f64>, partner| Handle {
        actor: when.character().as_usize(),
        frame,
        target,
        facing,
        hard,
        name: constraint.name.clone(),
        partner,
    };
    match &constraint.kind {
        ConstraintKind::Pin { when, position, facing } => {
            ends(scene, when).into_iter().map(|frame| handle(when, frame, *position, *facing, None)).collect()
        }
        ConstraintKind::Relative { when, partner: Partner::Character(other), .. } => {
            let partners = ends(scene, other);
            let pairs = ends(scene, when).into_iter().zip(partners);
            let other = other.character().as_usize();
            pairs.map(|(frame, partner)| handle(when, frame, None, None, Some((other, partner)))).collect()
        }
        ConstraintKind::Relative { when, partner: Partner::Object(object), offset, facing } => {
            let object = &scene.objects[object.as_usize()];
            let angle = match facing {
                Relation::Given(angle) => Some(object.facing + angle),
                Relation::AsBefore | Relation::Free => None,
            };
            let place = |frame: f64| match offset {
                Relation::Given(offset) => Some(object.position + cis(object.facing) * offset),
                Relation::AsBefore => {
                    Some(path::at(&edit.characters[when.character().as_usize()].rest.positions, frame))
                }
                Relation::Free => None,
            };
            ends(scene, when)
                .into_iter()
                .map(|frame| handle(when, frame, place(frame), angle, None))
                .collect()
        }
        ConstraintKind::Time { .. } | ConstraintKind::Duration { .. } | ConstraintKind::Sync { .. } => {
            Vec::new()
        }
    }
}

fn ties(scene: &Scene, edit: &Edit, constraint: &Constraint) -> Vec<Tie> {
    let point = |actor: usize, frame: f64| (actor, time_of(&edit.characters[actor].times, frame));
    let tie = |points, pinned| Tie { points, name: constraint.name.clone(), pinned };
    match &constraint.kind {
        ConstraintKind::Time { at, .. } => {
            vec![tie(vec![point(at.character.as_usize(), frame_of(scene, at))], true)]
        }
        ConstraintKind::Sync { moments, .. } => {
            let frames: Vec<(usize, Vec<f64>)> =
                moments.iter().map(|when| (when.character().as_usize(), ends(scene, when))).collect();
            let sides = frames.iter().map(|(_, frames)| frames.len()).min().unwrap_or(0);
            (0..sides)
                .map(|side| {
                    tie(frames.iter().map(|(actor, frames)| point(*actor, frames[side])).collect(), false)
                })
                .collect()
        }
        _ => Vec::new(),
    }
}
