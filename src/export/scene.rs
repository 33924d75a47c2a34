//! The files of a whole scene: BVH per character, GLB, pictures. `report.json` comes last, as it names them.

use rayon::prelude::*;

use crate::clip::Clip;
use crate::clip::working::WORKING_STEP;
use crate::constraint::{Constraint, ConstraintKind, Partner, Relation, Strength, When};
use crate::edit::{Edit, EditedCharacter, Moved};
use crate::export::bvh::{BvhOptions, to_bvh_with};
use crate::export::files::{OutputFile, file_names};
use crate::export::gltf::{GlbObject, GlbScene, Performer, to_glb};
use crate::export::parts::Part;
use crate::export::picture::{
    Actor, Handle, Picture, PictureObject, Tie, animated_svg, extent_of, to_svg, to_svg_covering,
};
use crate::geometry::c64;
use crate::index::{CharacterId, ObjectId, floor_index};
use crate::object::ObjectPose;
use crate::object_motion::{ObjectMotion, Owner, Performance, object_motions};
use crate::path;
use crate::resample::{Resampled, time_of};
use crate::scene::{Character, Scene};

/// Poses of an object's way in a picture, at most, and of all objects together.
const MOST_DRAWN: (usize, usize) = (20_000, 4_000_000);

/// A scene and its edit.
pub type Edited<'a> = (&'a Scene, &'a Edit);

/// BVH files, GLB and picture of an edited scene, in this order; then, of one that was dragged, the picture of how it was
/// `before`, with the same constraints but for their targets. Both pictures have one plan and one time axis.
pub fn scene_files(
    (scene, edit): Edited<'_>,
    before: Option<Edited<'_>>,
    resampled: &Resampled,
    bvh: &BvhOptions,
) -> Vec<OutputFile> {
    let moved = Moved { scene, characters: &edit.characters };
    let objects = object_motions(scene, &moved);
    let everything = Part::everything(scene);
    let mut files = part_files((&moved, &objects), (&everything, resampled), &names(scene), Some(bvh));
    files.extend(pictures((scene, edit), before));
    files
}

/// Names of the files of all characters, without endings.
pub fn names(scene: &Scene) -> Vec<String> {
    let names: Vec<&str> = scene.characters.iter().map(|character| character.name.as_str()).collect();
    file_names(&names)
}

/// BVH files of those who are in a part, where asked for, and its GLB. `names`: of the files of all characters.
pub fn part_files<'a>(
    (moved, objects): (&'a Moved<'_>, &[ObjectMotion]),
    (part, resampled): (&Part, &'a Resampled),
    names: &[String],
    bvh: Option<&BvhOptions>,
) -> Vec<OutputFile> {
    let clips: Vec<(&CharacterId, &Clip)> = resampled.members.iter().zip(&resampled.clips).collect();
    let written = bvh.map_or(Vec::new(), |options| {
        let file = |(who, clip): &(&CharacterId, &Clip)| OutputFile {
            name: format!("{}.bvh", names[who.as_usize()]),
            bytes: to_bvh_with(clip, options).into_bytes(),
        };
        clips.par_iter().map(file).collect()
    });
    let clock = (0..resampled.frames).map(|k| resampled.start_time + k as f64 / moved.scene.fps);
    let object = |id: &ObjectId| {
        let object = &moved.scene.objects[id.as_usize()];
        let poses = object_poses(moved, &objects[id.as_usize()], clock.clone());
        GlbObject { name: &object.name, size: object.size, poses, fps: moved.scene.fps }
    };
    let performer = |(who, clip): (&CharacterId, &'a Clip)| {
        let name = &moved.scene.characters[who.as_usize()].name;
        Performer { name, number: who.as_usize(), clip }
    };
    let glb = to_glb(&GlbScene {
        title: &moved.scene.title,
        performers: clips.iter().copied().map(performer).collect(),
        objects: part.objects.par_iter().map(object).collect(),
    });
    written.into_iter().chain([OutputFile { name: part.glb.clone(), bytes: glb }]).collect()
}

/// `scene.svg`, and `before.svg` if it was dragged.
pub fn pictures(after: Edited<'_>, before: Option<Edited<'_>>) -> Vec<OutputFile> {
    let file = |name: &str, svg: String| OutputFile { name: name.to_owned(), bytes: svg.into_bytes() };
    let after_headings = headings(after.1);
    let shown = picture(after, before.map(|before| before.0), &after_headings);
    let Some(before) = before else { return vec![file("scene.svg", to_svg(&shown))] };
    let before_headings = headings(before.1);
    let undragged = picture(before, None, &before_headings);
    let extent = extent_of(&shown).and(&extent_of(&undragged));
    vec![
        file("scene.svg", to_svg_covering(&shown, &extent)),
        file("before.svg", to_svg_covering(&undragged, &extent)),
    ]
}

/// Name of the picture in motion.
pub const ANIMATED: &str = "scene_animated.svg";

/// The picture in motion.
pub fn animation(after: Edited<'_>) -> OutputFile {
    let headings = headings(after.1);
    let svg = animated_svg(&picture(after, None, &headings));
    OutputFile { name: ANIMATED.to_owned(), bytes: svg.into_bytes() }
}

/// Picture of an edited scene: paths from above, and time tracks; from where pins were dragged, if it was so in `before`.
fn picture<'a>((scene, edit): Edited<'a>, before: Option<&Scene>, headings: &'a [Vec<f64>]) -> Picture<'a> {
    let actors = scene.characters.iter().zip(&edit.characters).zip(headings);
    let moved = Moved { scene, characters: &edit.characters };
    let motions = object_motions(scene, &moved);
    let objects = motions.iter().map(|motion| picture_object(&moved, motion));
    let held = |(index, constraint): (usize, &Constraint)| {
        let from = before.and_then(|before| dragged_from(&before.constraints[index], constraint));
        let handles = handles((scene, edit), &motions, constraint).into_iter();
        handles.map(move |handle| Handle { dragged_from: from, ..handle }).collect::<Vec<_>>()
    };
    Picture {
        title: &scene.title,
        actors: actors.map(|((character, edited), headings)| actor(character, edited, headings)).collect(),
        objects: objects.collect(),
        handles: scene.constraints.iter().enumerate().flat_map(held).collect(),
        ties: scene.constraints.iter().flat_map(|constraint| ties(scene, edit, constraint)).collect(),
        clock: clock(&moved),
    }
}

/// Where a pin was, if it is elsewhere now.
fn dragged_from(before: &Constraint, now: &Constraint) -> Option<c64> {
    match (&before.kind, &now.kind) {
        (ConstraintKind::Pin { position: from, .. }, ConstraintKind::Pin { position: to, .. })
            if from != to =>
        {
            *from
        }
        _ => None,
    }
}

/// Poses of an object at some times; one, where it stands still.
pub(super) fn object_poses(
    moved: &Moved<'_>,
    motion: &ObjectMotion,
    times: impl Iterator<Item = f64>,
) -> Vec<ObjectPose> {
    let pose = |time: f64| motion.pose_at(moved.scene, moved, time);
    if motion.moves(moved.scene) { times.map(pose).collect() } else { vec![pose(0.0)] }
}

fn picture_object<'a>(moved: &Moved<'a>, motion: &ObjectMotion) -> PictureObject<'a> {
    let object = &moved.scene.objects[motion.object.as_usize()];
    let (mut grasped, mut released) = (Vec::new(), Vec::new());
    for span in motion.spans.iter().filter(|span| matches!(span.owner, Owner::Carried(_))) {
        grasped.push(motion.pose_at(moved.scene, moved, span.from).plan());
        released.push(motion.pose_at(moved.scene, moved, span.to).plan());
    }
    let poses = object_poses(moved, motion, drawn_times(moved));
    PictureObject { name: &object.name, size: object.size, poses, grasped, released }
}

/// First and last time of anybody, and of the clock.
fn clock(moved: &Moved<'_>) -> (f64, f64) {
    let ends = moved.scene.characters.iter().zip(moved.characters);
    ends.fold((0.0_f64, 0.0_f64), |(first, last), (character, edited)| {
        (first.min(edited.times[0]), last.max(edited.end_time(&character.track)))
    })
}

/// From the first to the last frame of anybody, a working step apart, or as many as there is room for.
fn drawn_times(moved: &Moved<'_>) -> impl Iterator<Item = f64> {
    let (first, last) = clock(moved);
    let most = MOST_DRAWN.0.min(MOST_DRAWN.1 / moved.scene.objects.len().max(1));
    let steps = floor_index((last - first) / WORKING_STEP).min(most);
    let step = (last - first) / steps.max(1) as f64;
    (0..=steps).map(move |k| first + k as f64 * step)
}

/// Everybody's facing at each working frame after the edit.
fn headings(edit: &Edit) -> Vec<Vec<f64>> {
    let of = |edited: &EditedCharacter| {
        let rest = edited.rest.headings.iter().enumerate();
        rest.map(|(frame, heading)| heading + edited.turns.at(frame as f64)).collect()
    };
    edit.characters.iter().map(of).collect()
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
    when.moments().into_iter().map(|moment| scene.frame_of(moment)).collect()
}

fn handles((scene, edit): (&Scene, &Edit), motions: &[ObjectMotion], constraint: &Constraint) -> Vec<Handle> {
    let hard = constraint.strength == Strength::Hard;
    let handle = |when: &When, frame: f64, target: Option<c64>, facing: Option<f64>, partner| Handle {
        actor: when.character().as_usize(),
        frame,
        target,
        facing,
        hard,
        name: constraint.name.clone(),
        partner,
        dragged_from: None,
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
            let moved = Moved { scene, characters: &edit.characters };
            let who = when.character();
            let angle = |pose: ObjectPose| match facing {
                Relation::Given(angle) => Some(pose.facing + angle),
                Relation::AsBefore | Relation::Free => None,
            };
            let place = |pose: ObjectPose, frame: f64| match offset {
                Relation::Given(offset) => Some(pose.beside(*offset)),
                Relation::AsBefore => Some(path::at(&edit.characters[who.as_usize()].rest.positions, frame)),
                Relation::Free => None,
            };
            let frames = ends(scene, when).into_iter();
            let drawn = frames.map(|frame| {
                let pose = motions[object.as_usize()].pose_at(scene, &moved, moved.time(who, frame));
                let target = if scene.moves(*object) && *offset == Relation::AsBefore {
                    None
                } else {
                    place(pose, frame)
                };
                handle(when, frame, target, angle(pose), None)
            });
            drawn.collect()
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
            vec![tie(vec![point(at.character.as_usize(), scene.frame_of(at))], true)]
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
