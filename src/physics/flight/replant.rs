//! Feet that stand beside a flight, brought back to where they stood.

use glam::DVec3;

use crate::clip::Clip;
use crate::clip::contacts::runs;
use crate::full_body::chain::{Chain, EndPose, Place, legs};
use crate::full_body::fade::{Slopes, Span, fill};
use crate::geometry::{exp, log};
use crate::index::SourceFrame;
use crate::physics::flight::neighbours::Zone;
use crate::physics::sole::Side;
use crate::physics::stages::{Bearer, Stages};

/// Legs of a clip, and where its feet stand.
pub(super) struct Legs<'a> {
    legs: Vec<Leg<'a>>,
}

struct Leg<'a> {
    chain: Chain,
    /// One a frame.
    stands: Vec<bool>,
    /// Where feet are as they should.
    input: &'a Clip,
}

/// A leg reaches no farther than this share of its length.
const REACH: f64 = 0.9995;
/// Seconds over which a foot that stands takes along those frames before and after in which it does not.
const FADE: f64 = 5.0 / 30.0;

impl<'a> Legs<'a> {
    /// Legs of `clip` as they are. Skeletons without the names of legs have none.
    pub(super) fn of(clip: &'a Clip, stages: &Stages) -> Self {
        let leg = |(chain, side): (Option<Chain>, Side)| {
            let chain = chain?;
            let mut stands = vec![false; clip.frame_count()];
            let own =
                stages.supports.iter().filter(|own| matches!(own.bearer, Bearer::Sole(of, _) if of == side));
            for support in own {
                stands.iter_mut().zip(&support.bears).for_each(|(stands, bears)| *stands |= bears);
            }
            Some(Leg { chain, stands, input: clip })
        };
        let both = legs(&clip.skeleton).into_iter().zip([Side::Left, Side::Right]);
        Self { legs: both.filter_map(leg).collect() }
    }

    /// Whether legs that stand reach their feet in one frame of `clip`.
    pub(super) fn reach(&self, clip: &Clip, frame: usize) -> bool {
        let pose = clip.pose(SourceFrame::from_usize(frame));
        self.legs.iter().filter(|leg| leg.stands[frame]).all(|leg| {
            let limb = leg.chain.place(&clip.skeleton, &pose).limb;
            let length: f64 = limb.lengths().iter().sum();
            let asked = limb.upper.distance(leg.foot(frame).position);
            // As far as captured it reaches anyway.
            asked <= (REACH * length).max(limb.upper.distance(limb.lower))
        })
    }

    /// Brings feet back in the frames of `zone`, the border left out: to where they stood, and between less and less.
    pub(super) fn replant(&self, clip: &mut Clip, zone: Zone) {
        for leg in &self.legs {
            leg.replant(clip, zone);
        }
    }
}

impl Leg<'_> {
    /// Of the input.
    fn foot(&self, frame: usize) -> EndPose {
        let pose = self.input.pose(SourceFrame::from_usize(frame));
        self.chain.place(&self.input.skeleton, &pose).end_pose()
    }

    fn replant(&self, clip: &mut Clip, zone: Zone) {
        let frames: Vec<usize> = zone.frames().collect();
        let stands: Vec<bool> = frames.iter().map(|frame| self.stands[*frame]).collect();
        let spans: Vec<Span> = runs(&stands).into_iter().map(|(first, last)| Span { first, last }).collect();
        let times: Vec<f64> = frames.iter().map(|frame| *frame as f64 / clip.fps).collect();
        let skeleton = clip.skeleton.clone();
        let mut poses: Vec<_> =
            frames.iter().map(|frame| clip.pose(SourceFrame::from_usize(*frame))).collect();
        let places: Vec<_> = poses.iter().map(|pose| self.chain.place(&skeleton, pose)).collect();
        let moved = |(place, frame): (&Place, &usize)| {
            let foot = self.foot(*frame);
            [foot.position - place.limb.lower, log(foot.rotation * place.lower_rotation.inverse())]
        };
        let mut moves: Vec<[DVec3; 2]> = places.iter().zip(&frames).map(moved).collect();
        fill(&times, &spans, (FADE, Slopes::Level), &mut moves);
        let joints = skeleton.joints.len();
        for (index, [shift, turn]) in moves.into_iter().enumerate() {
            let place = &places[index];
            let reach = place.limb.reach(place.limb.lower + shift, place.limb.bow());
            let foot = EndPose { position: reach.lower, rotation: exp(turn) * place.lower_rotation };
            self.chain.turn(&skeleton, &mut poses[index], place, (reach.middle, &foot));
            let start = frames[index] * joints;
            clip.rotations[start..start + joints].copy_from_slice(&poses[index].rotations);
        }
    }
}
