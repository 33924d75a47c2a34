//! The soles of a performer's feet, measured on a clip.
//!
//! Where heel, ball and tip touch the floor is told by frames in which the foot stands flat: by the direction that is up in the
//! foot's axes then, and by the heights of ankle, ball and tip. Rest poses do not tell: their feet are splayed or pitched. The floor
//! is at height 0.

use glam::DVec3;

use crate::clip::contacts::{BodyPoint, end_of, percentile};
use crate::index::JointId;
use crate::physics::body_model::BodyModel;
use crate::physics::derivatives::{DERIVATIVE_WIDTH, Kernel, Lanes, smooth};
use crate::physics::posed::PosedClip;
use crate::skeleton::{JointRole, Skeleton};

/// Side of the body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[expect(missing_docs, reason = "the names say it")]
pub enum Side {
    Left,
    Right,
}

/// What of a foot touches.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[expect(missing_docs, reason = "the names say it")]
pub enum SolePart {
    Heel,
    Ball,
    Tip,
}

/// Two points of the sole, as far to the left as to the right of the foot's middle, that touch together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolePoint {
    /// Which.
    pub part: SolePart,
    /// On the joint of the foot, or of the toes for the tip.
    pub pair: [BodyPoint; 2],
}

/// The sole of one foot.
#[derive(Clone, Debug, PartialEq)]
pub struct Sole {
    /// Whose.
    pub side: Side,
    /// The ankle.
    pub joint: JointId,
    /// Away from the floor in the foot's axes, unit.
    pub normal: DVec3,
    /// Height of the ankle above the floor when flat, metres.
    pub ankle_clearance: f64,
    /// Height of the ball's joint above the floor when flat, metres.
    pub ball_clearance: f64,
    /// Heel, ball, and tip where the skeleton has toes.
    pub points: Vec<SolePoint>,
    /// Frames it was measured on.
    pub flat_frames: usize,
}

/// A foot is flat below this speed of ankle and ball, m/s …
const FLAT_SPEED: f64 = 0.25;
/// … with them no higher than this above their lowest, metres.
const FLAT_ANKLE: f64 = 0.04;
const FLAT_BALL: f64 = 0.03;
/// What counts as lowest: share of the frames that may be lower.
const LOWEST: f64 = 0.05;
/// Half the width of a foot, and how far its heel reaches behind the ankle: shares of the stature.
const HALF_WIDTH: f64 = 0.025;
const HEEL: f64 = 0.033;
/// Width of heel, ball and tip as shares of the widest.
const HEEL_WIDTH: f64 = 0.75;
const TIP_WIDTH: f64 = 0.7;
/// Heights of flat ankles in the world, mean of both, shares of the stature; outside these the floor is not at 0 …
const USUAL_ANKLE: std::ops::Range<f64> = 0.015..0.1;
/// … but so far below each ankle.
const ANKLE: f64 = 0.047;
/// A toe shorter than this has no tip, metres.
const SHORTEST_TOE: f64 = 0.01;

/// Soles of both feet (left first), by the frames of `posed` in which they stand flat; where they never do, by the lowest ones. Feet
/// without a link of `body` have none. Cost: linear in frames, and a sort of heights.
pub fn soles(skeleton: &Skeleton, body: &BodyModel, posed: &PosedClip) -> Vec<Sole> {
    let feet = [
        (Side::Left, JointRole::LeftFoot, JointRole::LeftToe),
        (Side::Right, JointRole::RightFoot, JointRole::RightToe),
    ];
    let foot = |(side, foot, toe)| {
        let joint = body.foot(skeleton, foot)?;
        let foot = Foot::of(skeleton, body, (joint, skeleton.joint_of(toe)))?;
        Some((side, Flat::of(&foot, posed), foot))
    };
    let found: Vec<(Side, Flat, Foot)> = feet.into_iter().filter_map(foot).collect();
    let mean = found.iter().map(|(_, flat, _)| flat.ankle).sum::<f64>() / found.len().max(1) as f64;
    let is_usual = USUAL_ANKLE.contains(&(mean / body.stature));
    let sole = |(side, flat, foot): &(Side, Flat, Foot)| {
        let floor = if is_usual { 0.0 } else { flat.ankle - ANKLE * body.stature };
        foot.sole(*side, (flat, floor), (body.stature, posed))
    };
    found.iter().map(sole).collect()
}

/// Ankle, ball and tip on their joints.
struct Foot {
    ankle: BodyPoint,
    ball: BodyPoint,
    tip: Option<BodyPoint>,
}

impl Foot {
    fn of(skeleton: &Skeleton, body: &BodyModel, (joint, toe): (JointId, Option<JointId>)) -> Option<Self> {
        // The mass of a foot is in its middle, between ankle and ball.
        let ball = 2.0 * body.links.iter().find(|link| link.joint == joint)?.com;
        let tip = toe.and_then(|toe| end_of(skeleton, toe));
        Some(Self {
            ankle: BodyPoint { joint, local: DVec3::ZERO },
            ball: BodyPoint { joint, local: ball },
            tip: tip.filter(|tip| tip.local.length() > SHORTEST_TOE),
        })
    }

    fn sole(&self, side: Side, (flat, floor): (&Flat, f64), (stature, posed): (f64, &PosedClip)) -> Sole {
        let normal = flat.normal;
        let (ankle_clearance, ball_clearance) = (flat.ankle - floor, flat.ball - floor);
        let half = HALF_WIDTH * stature;
        let ahead = flattened(self.ball.local, normal);
        let heel = -ankle_clearance * normal - HEEL * stature * ahead;
        let under_ball = self.ball.local - ball_clearance * normal;
        let joint = self.ankle.joint;
        let mut points = vec![
            pair(SolePart::Heel, joint, heel, normal.cross(ahead) * (HEEL_WIDTH * half)),
            pair(SolePart::Ball, joint, under_ball, normal.cross(ahead) * half),
        ];
        if let Some(tip) = &self.tip {
            let normal = median_up(posed, tip.joint, &flat.frames);
            let under = tip.local - (Along::of(tip, posed).median(&flat.frames) - floor) * normal;
            let aside = normal.cross(flattened(tip.local, normal)) * (TIP_WIDTH * half);
            points.push(pair(SolePart::Tip, tip.joint, under, aside));
        }
        let flat_frames = flat.frames.len();
        Sole { side, joint, normal, ankle_clearance, ball_clearance, points, flat_frames }
    }
}

/// A foot that stands flat.
struct Flat {
    frames: Vec<usize>,
    /// Up in the axes of the foot, unit.
    normal: DVec3,
    /// World heights of ankle and ball, metres.
    ankle: f64,
    ball: f64,
}

impl Flat {
    fn of(foot: &Foot, posed: &PosedClip) -> Self {
        let [ankle, ball] = [&foot.ankle, &foot.ball].map(|point| Along::of(point, posed));
        let frames = flat_frames(&ankle, &ball);
        let normal = median_up(posed, foot.ankle.joint, &frames);
        Self { normal, ankle: ankle.median(&frames), ball: ball.median(&frames), frames }
    }
}

fn pair(part: SolePart, joint: JointId, middle: DVec3, aside: DVec3) -> SolePoint {
    let at = |local| BodyPoint { joint, local };
    SolePoint { part, pair: [at(middle + aside), at(middle - aside)] }
}

/// Unit vector along `bone` in the plane across `normal`.
fn flattened(bone: DVec3, normal: DVec3) -> DVec3 {
    (bone - bone.dot(normal) * normal).try_normalize().unwrap_or_else(|| normal.any_orthonormal_vector())
}

/// Heights and speeds of a point in all frames.
pub(super) struct Along {
    /// World y, metres.
    pub(super) heights: Vec<f64>,
    /// Of the smoothed places, m/s.
    pub(super) speeds: Vec<f64>,
}

impl Along {
    pub(super) fn of(point: &BodyPoint, posed: &PosedClip) -> Self {
        let places: Vec<DVec3> =
            (0..posed.frame_count()).map(|frame| point.place(posed.frame(frame))).collect();
        Self::of_places(&places, posed.fps)
    }

    pub(super) fn of_places(places: &[DVec3], fps: f64) -> Self {
        let smoothed = smooth(&Lanes::of_vectors(places), &Kernel::gaussian(DERIVATIVE_WIDTH, fps));
        let speeds = crate::clip::contacts::speeds(&smoothed.vectors(0), 1.0 / fps);
        Self { heights: places.iter().map(|place| place.y).collect(), speeds }
    }

    /// Height that a twentieth of the frames are below.
    pub(super) fn lowest(&self) -> f64 {
        percentile(self.heights.clone(), LOWEST)
    }

    fn median(&self, frames: &[usize]) -> f64 {
        percentile(frames.iter().map(|frame| self.heights[*frame]).collect(), 0.5)
    }
}

fn flat_frames(ankle: &Along, ball: &Along) -> Vec<usize> {
    let (lowest_ankle, lowest_ball) = (ankle.lowest(), ball.lowest());
    let over = |k: usize| (ankle.heights[k] - lowest_ankle).max(ball.heights[k] - lowest_ball);
    let all = 0..ankle.heights.len();
    let is_flat = |k: &usize| {
        ankle.speeds[*k] < FLAT_SPEED
            && ball.speeds[*k] < FLAT_SPEED
            && ankle.heights[*k] < lowest_ankle + FLAT_ANKLE
            && ball.heights[*k] < lowest_ball + FLAT_BALL
    };
    let flat: Vec<usize> = all.clone().filter(is_flat).collect();
    if !flat.is_empty() {
        return flat;
    }
    let limit = percentile(all.clone().map(over).collect(), LOWEST);
    all.filter(|&k| over(k) <= limit).collect()
}

/// Median over `frames` of the direction that is up in the axes of `joint`, each component by itself.
fn median_up(posed: &PosedClip, joint: JointId, frames: &[usize]) -> DVec3 {
    let ups: Vec<DVec3> =
        frames.iter().map(|frame| posed.at(*frame, joint).rotation.inverse() * DVec3::Y).collect();
    let median = |component: fn(&DVec3) -> f64| percentile(ups.iter().map(component).collect(), 0.5);
    DVec3::new(median(|up| up.x), median(|up| up.y), median(|up| up.z)).normalize_or(DVec3::Y)
}
