//! Everybody of a scene made physically plausible, after their bodies are where they must be.
//!
//! One by one bodies are touched up against the motion before the edit, as their tracks show it: at its own pace, and before bends,
//! tilts and blends where the clip is made of others ([`mod@before`]). Then feet stand again, and hands are brought back to boxes, places and
//! each other: what is carried goes where it went before, and the body moves between its hands and its feet.

pub mod before;

use std::collections::BTreeMap;

use rayon::prelude::*;

use crate::clip::Clip;
use crate::clip::derived::usable_part;
use crate::clip::working::WORKING_STEP;
use crate::edit::{Edit, Moved};
use crate::embody::{Body, Embodied, embody_again, embody_some, unembodied};
use crate::index::{CharacterId, SourceFrame};
use crate::object_motion::{Performance, object_motions};
use crate::physics::body_model::{BodyError, BodyModel, body_model};
use crate::physics::stages::Stages;
use crate::physics::touch_up::{TouchUpError, TouchedUp, touch_up};
use crate::plausible::before::{Shown, before};
use crate::reach::Stage;
use crate::resample::Resampled;
use crate::scene::Scene;
use crate::scene::physics::Physics;
use crate::skeleton::Pose;
use crate::ties::Ties;

/// Somebody who was touched up. All frames count from the first output frame that shows the track.
#[derive(Clone, Debug, PartialEq)]
pub struct Touched {
    /// Output frame that is frame 0 here: before it the character holds still.
    pub first_frame: usize,
    /// The motion as it came from the full body.
    pub before: Clip,
    /// The body that was reckoned with.
    pub body: BodyModel,
    /// When it stands on what: of the motion before the edit.
    pub stages: Stages,
    /// What was done, before hands were brought back.
    pub done: TouchedUp,
}

/// Why somebody is not touched up.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NotTouched {
    /// A skeleton that is no body.
    #[error(transparent)]
    Body(#[from] BodyError),
    /// A schedule that the body cannot do, most likely.
    #[error(transparent)]
    TouchUp(#[from] TouchUpError),
    /// A motion without accelerations.
    #[error("{frames} frames have no accelerations")]
    TooShort {
        /// Output frames that show the track.
        frames: usize,
    },
}

/// What became of those who were to be touched up.
pub type TouchUps = BTreeMap<CharacterId, Result<Touched, NotTouched>>;

/// Everybody with their bodies, made plausible where the scene wants it. `resampled`: the edit on the clock, whose clips are replaced.
/// Cost: linear in output frames, joints, steps and constrained moments.
pub fn embody_plausibly<'a>(
    scene: &'a Scene,
    edit: &'a Edit,
    resampled: &mut Resampled,
) -> (Embodied<'a>, TouchUps) {
    let moved = Moved { scene, characters: &edit.characters };
    let (objects, ties) = (object_motions(scene, &moved), Ties::of(scene));
    let stage = Stage { scene, performance: &moved, objects: &objects, ties: &ties };
    let mut embodied = embody_some(&stage, resampled);
    let touch_ups = make_plausible(&stage, &mut embodied, resampled);
    (embodied, touch_ups)
}

/// Touches up those who are in `resampled`, whose full bodies are `embodied`; all that one of them reaches must be
/// ([`crate::embody::closed_groups`]). Nothing happens where the stage is off.
pub fn make_plausible(
    stage: &Stage<'_, Moved<'_>>,
    embodied: &mut Embodied<'_>,
    resampled: &mut Resampled,
) -> TouchUps {
    let Some(physics) = &stage.scene.physics else { return TouchUps::new() };
    let is_meant = |who: &CharacterId| physics.is_for(*who);
    if !stage.scene.full_body.enabled {
        embodied.bodies = unembodied(stage, resampled);
    }
    let start = resampled.start_time;
    let members: Vec<(&CharacterId, &Clip)> =
        resampled.members.iter().zip(&resampled.clips).filter(|(who, _)| is_meant(who)).collect();
    let touch = |(who, clip): (&CharacterId, &Clip)| (*who, touched((stage, physics), (*who, clip), start));
    let touch_ups: TouchUps = members.into_par_iter().map(touch).collect();
    let sound = touch_ups.iter().filter_map(|(who, touched)| Some((*who, touched.as_ref().ok()?)));
    let changed: BTreeMap<CharacterId, Vec<Pose>> = sound
        .filter(|(_, touched)| touched.is_changed())
        .filter_map(|(who, touched)| Some((who, touched.poses(embodied.body(who)?, start))))
        .collect();
    if !changed.is_empty() {
        embody_again(stage, embodied, changed, resampled);
    }
    touch_ups
}

/// Fewer frames have no accelerations.
const FEWEST_FRAMES: usize = 3;

/// Touches up `clip`, the finished body of somebody on the clock from scene time `start` on.
fn touched(
    (stage, physics): (&Stage<'_, Moved<'_>>, &Physics),
    (who, clip): (CharacterId, &Clip),
    start: f64,
) -> Result<Touched, NotTouched> {
    let Moved { scene, characters } = *stage.performance;
    let begins = characters[who.as_usize()].times[0];
    let time = |frame: usize| start + frame as f64 / clip.fps;
    let first_frame = (0..clip.frame_count()).take_while(|frame| time(*frame) < begins - HELD).count();
    let frames: Vec<f64> =
        (first_frame..clip.frame_count()).map(|frame| stage.performance.frame(who, time(frame))).collect();
    if frames.len() < FEWEST_FRAMES {
        return Err(NotTouched::TooShort { frames: frames.len() });
    }
    let body = body_model(&clip.skeleton, &physics.body)?;
    let track = &scene.characters[who.as_usize()].track;
    let Shown { source, stages } = before(track, &body, &frames, clip.fps);
    let own = shown_part(clip, first_frame);
    let settings = physics.touch_up(&source);
    let done = touch_up(&own, &body, &stages, Some(&source), &settings)?;
    Ok(Touched { first_frame, before: own, body, stages, done })
}

/// Frames this much before the first of a track show it still held, seconds.
const HELD: f64 = 1e-6 * WORKING_STEP;

/// `clip` from an output frame on.
pub fn shown_part(clip: &Clip, first_frame: usize) -> Clip {
    let usable = (SourceFrame::from_usize(first_frame), SourceFrame::from_usize(clip.frame_count() - 1));
    usable_part(&Clip { usable, ..clip.clone() })
}

impl Touched {
    /// Whether anything was done.
    fn is_changed(&self) -> bool {
        self.done.clip.rotations != self.before.rotations
            || self.done.clip.root_positions != self.before.root_positions
    }

    /// Poses of `body` after the touch-up; between output frames it goes over from one to the next. `start`: scene time of output
    /// frame 0.
    fn poses(&self, body: &Body, start: f64) -> Vec<Pose> {
        let count = self.before.frame_count();
        let time = |frame: usize| start + (self.first_frame + frame) as f64 / self.before.fps;
        let poses = |clip: &Clip| (0..count).map(|frame| clip.pose(SourceFrame::from_usize(frame))).collect();
        let on_clock = Body {
            times: (0..count).map(time).collect(),
            moved: poses(&self.before),
            poses: poses(&self.done.clip),
            planted: Vec::new(),
            report: crate::full_body::BodyReport::default(),
        };
        let samples = body.poses.iter().zip(&body.times);
        samples.map(|(pose, time)| on_clock.corrected(pose.clone(), *time)).collect()
    }
}
