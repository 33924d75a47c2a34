//! Bodies that pass ten seams of dragged captures: joints are as fast as elsewhere in the clip, feet slide no more than around
//! the frame where they slide most, ankles cross no further. Drawn to be looked at: `ten_seams/` in `target/tmp`.

use std::fs;
use std::path::Path;

use cotillion::clip::Clip;
use cotillion::clip::contacts::Contacts;
use cotillion::discrete::outcome::Outcome;
use cotillion::embody::embody;
use cotillion::export::picture::{Company, StripOptions, StripView, strip_svg};
use cotillion::geometry::{c64, cis, plan_of};
use cotillion::index::{SourceFrame, floor_index};
use cotillion::metrics::foot_slide_at;
use cotillion::resample::{resample, shown_contacts_at};
use cotillion::scene::Scene;
use cotillion::similarity::weighted_joints;
use cotillion::skeleton::{JointRole, Pose};
use glam::DVec3;
use libtest_mimic::Failed;

use crate::pull::{End, pull, read};
use crate::{HALTS, TURNING, WALKS, aside, away, check, later, none, settings, stem};

/// Frames on either side of a seam that are looked at.
const AROUND: usize = 10;
/// First frames of captures that joints leave with a start.
const GLITCH: usize = 2;
/// How much faster joints move at most than ever in the clip.
const SPEED: f64 = 1.1;
/// How much harder they are accelerated. Seams are continuous, speeds at them are not: a foot that one seam brings down a
/// little early stops 2.4 times as hard; the other nine stop less hard than in the clip.
const JERK: f64 = 2.5;

/// A body on output frames.
struct Shown {
    clip: Clip,
    poses: Vec<Pose>,
    contacts: Vec<Contacts>,
    times: Vec<f64>,
    /// Output frames of the seams.
    seams: Vec<usize>,
}

/// What it does around a frame.
#[derive(Clone, Copy, Debug)]
struct Passing {
    /// Largest speed of a joint, m/s.
    speed: f64,
    /// Largest acceleration of one, m/s².
    acceleration: f64,
    /// Mean slide of contact points, m/s.
    slide: f64,
    /// Least distance of the left ankle to the left of the right one, metres.
    apart: f64,
}

pub(crate) fn ten_seams(folder: &Path) -> Result<(), Failed> {
    let out = Path::new(env!("CARGO_TARGET_TMPDIR")).join("ten_seams");
    fs::create_dir_all(&out)?;
    let mut count = 0;
    for (name, scene, to) in drags(folder)? {
        let dragged = shown(&pull(&scene, &to, settings())?.outcome)?;
        let own = shown(&pull(&scene, &to[..1], none())?.outcome)?;
        let usual: Vec<Passing> =
            (AROUND + GLITCH..own.poses.len() - AROUND).map(|at| passing(&own, at)).collect();
        let seam = dragged.seams.get(dragged.seams.len() / 2).copied().ok_or("a seam")?;
        let found = passing(&dragged, seam.clamp(AROUND, dragged.poses.len() - AROUND - 1));
        draw(&out, &format!("{count:02}_{name}"), (&dragged.clip, seam))?;
        let most = |of: fn(&Passing) -> f64| usual.iter().map(of).fold(0.0, f64::max);
        let apart = usual.iter().map(|own| own.apart).fold(f64::MAX, f64::min);
        let told = format!(
            "{name} at {seam}: {found:?}, usual {:.2} {:.2} {:.3} {apart:.3}",
            most(|own| own.speed),
            most(|own| own.acceleration),
            most(|own| own.slide)
        );
        check(found.speed <= SPEED * most(|own| own.speed), || told.clone())?;
        check(found.acceleration <= JERK * most(|own| own.acceleration), || told.clone())?;
        check(found.slide <= most(|own| own.slide), || told.clone())?;
        check(found.apart >= apart, || told.clone())?;
        count += 1;
    }
    check(count == 10, || format!("{count} seams"))
}

/// Walks stretched and shortened, stands prolonged, a turn pulled sideways.
fn drags(folder: &Path) -> Result<Vec<(String, Scene, Vec<End>)>, Failed> {
    let mut drags = Vec::new();
    for (name, factor) in WALKS.iter().map(|walk| (walk.0, 2.0)).chain([(WALKS[0].0, 0.6), (WALKS[3].0, 0.6)])
    {
        let scene = read(folder, name, None, false)?;
        let to = away(&scene, factor);
        drags.push((format!("{}_x{factor}", stem(name)), scene, to));
    }
    for (name, range) in HALTS {
        let scene = read(folder, name, range, true)?;
        let to = later(&scene, 1.5);
        drags.push((format!("{}_later", stem(name)), scene, to));
    }
    let scene = read(folder, TURNING, None, false)?;
    let to = aside(&scene);
    drags.push((stem(TURNING).to_owned(), scene, to));
    Ok(drags)
}

fn shown(outcome: &Outcome) -> Result<Shown, Failed> {
    let Outcome { scene, edit, .. } = outcome;
    let mut resampled = resample(scene, edit).map_err(|error| error.to_string())?;
    embody(scene, edit, &mut resampled);
    let (track, edited) = (&scene.characters[0].track, &edit.characters[0]);
    let clip = resampled.clips.remove(0);
    let times: Vec<f64> =
        (0..clip.frame_count()).map(|frame| resampled.start_time + frame as f64 / scene.fps).collect();
    let frames: Vec<f64> = times.iter().map(|time| edited.frame_at(track, *time)).collect();
    let at = |start: usize| floor_index((edited.times[start] - resampled.start_time) * scene.fps + 0.5);
    Ok(Shown {
        poses: (0..clip.frame_count()).map(|frame| clip.pose(SourceFrame::from_usize(frame))).collect(),
        contacts: shown_contacts_at(track, &frames),
        seams: track.placed_runs().skip(1).map(|(_, start)| at(start)).collect(),
        clip,
        times,
    })
}

fn passing(shown: &Shown, at: usize) -> Passing {
    let window = at - AROUND..at + AROUND + 1;
    let skeleton = &shown.clip.skeleton;
    let frames: Vec<_> =
        shown.poses[window.clone()].iter().map(|pose| skeleton.forward_kinematics(pose)).collect();
    let place = |frame: usize, joint: usize| -> DVec3 {
        frames[frame].get(joint).map_or(DVec3::ZERO, |f| f.position)
    };
    let pull = |joint: usize| {
        let bend = |k: usize| place(k - 1, joint) - 2.0 * place(k, joint) + place(k + 1, joint);
        (1..frames.len() - 1).map(|k| bend(k).length() * shown.clip.fps.powi(2)).fold(0.0, f64::max)
    };
    let speed = |joint: usize| {
        let step = |k: usize| (place(k, joint) - place(k - 1, joint)).length();
        (1..frames.len()).map(|k| step(k) * shown.clip.fps).fold(0.0, f64::max)
    };
    let joints = weighted_joints(skeleton);
    let slide = foot_slide_at(
        skeleton,
        (&shown.times[window.clone()], &shown.poses[window.clone()]),
        &shown.contacts[window],
    );
    let joint = |role: JointRole| skeleton.joint_of(role).map_or(0, |joint| joint.as_usize());
    let side = |k: usize| {
        let of = |role: JointRole| plan_of(place(k, joint(role)));
        let left = of(JointRole::LeftHip) - of(JointRole::RightHip);
        let ankles: c64 = of(JointRole::LeftFoot) - of(JointRole::RightFoot);
        (cis(-left.arg()) * ankles).re
    };
    let most = |of: &dyn Fn(usize) -> f64| joints.iter().map(|(joint, _)| of(*joint)).fold(0.0, f64::max);
    Passing {
        speed: most(&speed),
        acceleration: most(&pull),
        slide: slide.unwrap_or(0.0),
        apart: (0..frames.len()).map(side).fold(f64::MAX, f64::min),
    }
}

/// Poses around a frame, from the side and from ahead.
fn draw(out: &Path, name: &str, (clip, seam): (&Clip, usize)) -> Result<(), Failed> {
    let mut clip = clip.clone();
    let last = clip.frame_count() - 1;
    let frame = |at: usize| SourceFrame::from_usize(at.min(last));
    clip.usable = (frame(seam.saturating_sub(AROUND)), frame(seam + AROUND));
    clip.events = [("seam".to_owned(), frame(seam))].into();
    clip.name = name.to_owned();
    for (word, view) in [("side", StripView::Side), ("front", StripView::Front)] {
        let svg = strip_svg(&clip, &Company::default(), &StripOptions { poses: 11, view });
        fs::write(out.join(format!("{name}.{word}.svg")), svg)?;
    }
    Ok(())
}
