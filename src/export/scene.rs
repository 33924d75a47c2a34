//! The files of a whole scene: BVH per character, one GLB, a picture. `report.json` comes last, as it names them.

use crate::clip::Clip;
use crate::clip::working::WORKING_STEP;
use crate::constraint::{Constraint, ConstraintKind, Partner, Relation, Strength, When};
use crate::edit::{Edit, EditedCharacter, Moved};
use crate::export::bvh::{BvhOptions, to_bvh_with};
use crate::export::files::{OutputFile, file_names};
use crate::export::gltf::{GlbObject, GlbScene, Performer, to_glb};
use crate::export::picture::{
    Actor, Company, Handle, Picture, PictureObject, StripOptions, StripThing, StripView, Tie, strip_svg,
    to_svg,
};
use crate::geometry::c64;
use crate::index::{SourceFrame, floor_index};
use crate::object::{Object, ObjectPose};
use crate::object_motion::{ObjectMotion, Owner, Performance, object_motions};
use crate::path;
use crate::resample::{Resampled, time_of};
use crate::scene::{Character, Scene};

/// Poses of an object's way in a picture, at most.
const MOST_DRAWN: usize = 20_000;

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
    files.push(OutputFile { name: "scene.glb".to_owned(), bytes: glb(scene, edit, resampled) });
    let svg = picture_svg(scene, edit);
    files.push(OutputFile { name: "scene.svg".to_owned(), bytes: svg.into_bytes() });
    files
}

/// Poses of every character side by side, seen from the side and from above, the moments that the scene names among them;
/// with each pose the objects and partners near it.
pub fn strip_files(scene: &Scene, edit: &Edit, resampled: &Resampled) -> Vec<OutputFile> {
    let names: Vec<&str> = scene.characters.iter().map(|character| character.name.as_str()).collect();
    let mut clips = resampled.clips.clone();
    for moment in scene.moments() {
        let who = moment.character.as_usize();
        let time = time_of(&edit.characters[who].times, scene.frame_of(moment));
        let frame = floor_index(((time - resampled.start_time) * scene.fps).max(0.0) + 0.5);
        let shown = frame.min(clips[who].frame_count() - 1);
        let name = moment.name.rsplit(['/', ':']).next().unwrap_or(&moment.name);
        clips[who].events.insert(name.to_owned(), SourceFrame::from_usize(shown));
    }
    let moved = Moved { scene, characters: &edit.characters };
    let frames = clips.iter().map(Clip::frame_count).max().unwrap_or(1);
    let clock = || (0..frames).map(|k| resampled.start_time + k as f64 / scene.fps);
    let thing = |(object, motion): (&Object, &ObjectMotion)| StripThing {
        size: object.size,
        poses: poses(&moved, motion, clock()),
    };
    let motions = object_motions(scene, &moved);
    let things: Vec<StripThing> = scene.objects.iter().zip(&motions).map(thing).collect();
    let views = [("side", StripView::Side), ("above", StripView::Above)];
    let strips = views.into_iter().flat_map(|(word, view)| {
        let options = StripOptions { view, ..StripOptions::default() };
        let svg = |(who, clip): (usize, &Clip)| {
            let others = resampled.clips.iter().enumerate().filter(|(other, _)| *other != who);
            let partners: Vec<&Clip> = others.map(|(_, clip)| clip).collect();
            strip_svg(clip, &Company { things: &things, partners: &partners }, &options)
        };
        file_names(&names).into_iter().zip(clips.iter().enumerate().map(svg).collect::<Vec<_>>()).map(
            move |(name, svg)| OutputFile { name: format!("{name}.{word}.svg"), bytes: svg.into_bytes() },
        )
    });
    strips.collect()
}

fn glb(scene: &Scene, edit: &Edit, resampled: &Resampled) -> Vec<u8> {
    let performers = scene.characters.iter().zip(&resampled.clips);
    let frames = resampled.clips.iter().map(Clip::frame_count).max().unwrap_or(1);
    let moved = Moved { scene, characters: &edit.characters };
    let motions = object_motions(scene, &moved);
    let objects = scene.objects.iter().zip(&motions).map(|(object, motion)| GlbObject {
        name: &object.name,
        size: object.size,
        poses: poses(&moved, motion, (0..frames).map(|k| resampled.start_time + k as f64 / scene.fps)),
        fps: scene.fps,
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
    let moved = Moved { scene, characters: &edit.characters };
    let motions = object_motions(scene, &moved);
    let objects = motions.iter().map(|motion| picture_object(&moved, motion));
    to_svg(&Picture {
        title: &scene.title,
        actors: actors.map(|((character, edited), headings)| actor(character, edited, headings)).collect(),
        objects: objects.collect(),
        handles: scene
            .constraints
            .iter()
            .flat_map(|constraint| handles((scene, edit), &motions, constraint))
            .collect(),
        ties: scene.constraints.iter().flat_map(|constraint| ties(scene, edit, constraint)).collect(),
    })
}

/// Poses of an object at some times; one, where it stands still.
fn poses(moved: &Moved<'_>, motion: &ObjectMotion, times: impl Iterator<Item = f64>) -> Vec<ObjectPose> {
    let pose = |time: f64| motion.pose_at(moved.scene, moved, time);
    if moved.scene.moves(motion.object) { times.map(pose).collect() } else { vec![pose(0.0)] }
}

fn picture_object<'a>(moved: &Moved<'a>, motion: &ObjectMotion) -> PictureObject<'a> {
    let object = &moved.scene.objects[motion.object.as_usize()];
    let (mut grasped, mut released) = (Vec::new(), Vec::new());
    for span in motion.spans.iter().filter(|span| matches!(span.owner, Owner::Carried(_))) {
        grasped.push(motion.pose_at(moved.scene, moved, span.from).plan());
        released.push(motion.pose_at(moved.scene, moved, span.to).plan());
    }
    let poses = poses(moved, motion, drawn_times(moved));
    PictureObject { name: &object.name, size: object.size, poses, grasped, released }
}

/// From the first to the last frame of anybody, a working step apart.
fn drawn_times(moved: &Moved<'_>) -> impl Iterator<Item = f64> {
    let ends = moved.scene.characters.iter().zip(moved.characters);
    let (first, last) = ends.fold((0.0_f64, 0.0_f64), |(first, last), (character, edited)| {
        (first.min(edited.times[0]), last.max(edited.end_time(&character.track)))
    });
    let steps = floor_index((last - first) / WORKING_STEP).min(MOST_DRAWN);
    let step = (last - first) / steps.max(1) as f64;
    (0..=steps).map(move |k| first + k as f64 * step)
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
