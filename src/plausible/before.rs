//! The motion before the edit, as the physics of the edit needs it: when it stood on what, and where its zero moment points were.
//!
//! It is looked at at its own pace: a walk that the edit slows down was still balanced as it was walked. A track that shows one run of a
//! clip made of others shows that clip before it was bent and tilted; in a track of several runs such a clip counts as captured,
//! since what it was before need not join there.

use std::sync::Arc;

use crate::clip::Clip;
use crate::clip::derived::{Blended, Origin};
use crate::clip::working::WORKING_STEP;
use crate::edit::moved::snap;
use crate::embody::stated_hands;
use crate::index::floor_index;
use crate::physics::blended_source::blended_source;
use crate::physics::body_model::BodyModel;
use crate::physics::ground::target::Source;
use crate::physics::posed::PosedClip;
use crate::physics::stages::{StageSettings, Stages, stages};
use crate::resample::shown_contacts_at;
use crate::skeleton::Pose;
use crate::track::Track;

/// What is known of the motion before the edit, frame by frame of the edited one.
pub struct Shown {
    /// Where its zero moment points were.
    pub source: Source,
    /// When it stood on what.
    pub stages: Stages,
}

/// Of a track that shows the fractional frames `frames`, rising, one an output frame. Cost: linear.
pub fn before(track: &Track, body: &BodyModel, frames: &[f64], fps: f64) -> Shown {
    let origin = origin(track);
    let known = origin
        .map(|origin| Track { clips: vec![Arc::clone(&origin.clip); track.clips.len()], ..track.clone() });
    let rest = Rest::of(known.as_ref().unwrap_or(track), frames, fps);
    let own = stages_of(&rest.clip, body);
    let nearest: Vec<usize> = rest.frames.iter().map(|frame| floor_index(frame.round())).collect();
    let source = match origin.and_then(|origin| origin.blend.as_deref()) {
        Some(blend) => of_blend(track, blend, frames, body),
        None => Source::of(&rest.clip, body, &own).paced(&rest.frames, &own),
    };
    Shown { source, stages: own.at(&nearest) }
}

/// What the only run of a track shows before all edits of its clip.
fn origin(track: &Track) -> Option<&Origin> {
    let [run] = &track.runs[..] else { return None };
    track.clips[run.entry].origin.as_deref()
}

fn stages_of(clip: &Clip, body: &BodyModel) -> Stages {
    stages(clip, body, &PosedClip::of(clip), &StageSettings::default())
}

/// The motion before the edit at its own pace.
struct Rest {
    clip: Clip,
    /// Which of its frames, a fraction, each frame of the edited motion shows.
    frames: Vec<f64>,
}

/// What lies this near to a frame is at it, frames.
const AT_FRAME: f64 = 1e-6;

impl Rest {
    fn of(track: &Track, shown: &[f64], fps: f64) -> Self {
        let (first, last) = (shown[0], shown[shown.len() - 1]);
        let step = 1.0 / (fps * WORKING_STEP);
        let count = floor_index((last - first) / step + AT_FRAME) + 1;
        let own: Vec<f64> = (0..count).map(|frame| snap(first + frame as f64 * step).min(last)).collect();
        let poses: Vec<Pose> = own.iter().map(|frame| track.pose(*frame)).collect();
        let skeleton = Arc::clone(&track.clips[0].clip.skeleton);
        let clip = Clip::from_poses("before", skeleton, fps, &poses);
        let contacts = stated_hands(&shown_contacts_at(track, &own));
        let frame = |frame: &f64| ((frame - first) / step).min((count - 1) as f64);
        Self { clip: Clip { contacts, ..clip }, frames: shown.iter().map(frame).collect() }
    }
}

/// The two clips of a blend, which the only run of `track` shows.
fn of_blend(
    track: &Track,
    (blend, clips): &(Blended, [Clip; 2]),
    frames: &[f64],
    body: &BodyModel,
) -> Source {
    let [from, to] = clips.each_ref().map(|clip| stages_of(clip, body));
    let source = blended_source(blend, [(&clips[0], &from), (&clips[1], &to)], body);
    let run = &track.runs[0];
    let last = (blend.clip.frame_count() - 1) as f64;
    let of_clip =
        |frame: &f64| track.clips[run.entry].source_frame(f64::from(run.first.0) + frame).clamp(0.0, last);
    let own: Vec<f64> = frames.iter().map(of_clip).collect();
    source.paced(&own, &stages_of(&blend.clip, body))
}
