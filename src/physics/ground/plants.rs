//! Feet, and hands that bear, brought back to where the input has them.
//!
//! After a step that moves the body, the root is moved so that legs reach, and the legs are bent so that planted feet have the place
//! and the rotation they have in the input, frame by frame. Bones keep their lengths: instead of stretching them by what a smoothed root
//! step leaves, the smoothed steps are repeated, and what they leave (micrometres) is done unsmoothed.
//!
//! Source: Kovar, Schreiner & Gleicher, *Footskate Cleanup for Motion Capture Editing*, SCA 2002; without its stretch.

use glam::{DQuat, DVec3};

use crate::clip::Clip;
use crate::clip::contacts::runs;
use crate::full_body::chain::{arms, is_below};
use crate::full_body::fade::{Slopes, Span, fill};
use crate::geometry::{exp, log};
use crate::index::JointId;
use crate::limb::{Limb, minimal_rotation, softened};
use crate::physics::body_model::BodyModel;
use crate::physics::derivatives::{Kernel, Lanes, smooth_from_rest};
use crate::physics::ground::displacement::replace;
use crate::physics::posed::PosedClip;
use crate::physics::sole::Side;
use crate::physics::stages::{Bearer, Stages};
use crate::skeleton::{JointFrame, JointRole};

/// A leg, or an arm whose hand bears.
#[derive(Clone, Debug, PartialEq)]
struct PlantedLimb {
    upper: JointId,
    middle: JointId,
    lower: JointId,
    /// Whether its end is planted, one a frame.
    is_planted: Vec<bool>,
    spans: Vec<Span>,
    /// Of the lower joint in the input, one a frame.
    ends: Vec<JointFrame>,
    /// Farthest that the lower joint may be from the upper one, metres, one a frame: nearly stretched, or as the input has it.
    reaches: Vec<f64>,
    /// Mean axis of the middle joint, in its axes: where the limb is straight, it bends about it.
    hinge: DVec3,
}

/// Planted limbs of the input.
#[derive(Clone, Debug, PartialEq)]
pub struct Plants {
    limbs: Vec<PlantedLimb>,
    times: Vec<f64>,
    kernel: Kernel,
    /// Joints that planted limbs hang on, and their own: in the order of joints.
    needed: Vec<usize>,
}

/// Legs are not stretched farther than this share of their length, unless the input does: 7° at the knee. Nearer to straight, where
/// the paper's legs grow longer instead, a millimetre at the hip throws the knee about, and the zero moment point with it.
const REACH: f64 = 0.998;
/// Width of the kernel that smooths steps of the root, frames at 30 fps.
const ROOT_WIDTH: f64 = 9.0;
/// Smoothed steps of the root at most, …
const ROOT_STEPS: usize = 24;
/// … and what they may leave to do unsmoothed, metres.
const LEFT_ROUGH: f64 = 5e-6;
/// Alternating projections of one frame.
const SWEEPS: usize = 10;
const LAST_SWEEPS: usize = 200;
/// Feet fade to where the body carries them in so many seconds after a plant, and before it.
const FADE: f64 = 5.0 / 30.0;

impl Plants {
    /// Legs and stated hands of `clip`, planted as `stages` has it. `posed`: frames of `clip`. Cost: linear.
    pub fn of(clip: &Clip, body: &BodyModel, stages: &Stages, posed: &PosedClip) -> Self {
        let limbs: Vec<PlantedLimb> = [Side::Left, Side::Right]
            .into_iter()
            .flat_map(|side| {
                [leg(clip, body, side), arm(clip, side)]
                    .into_iter()
                    .zip([false, true])
                    .map(move |(joints, is_arm)| (side, joints, is_arm))
            })
            .filter_map(|(side, joints, is_arm)| {
                let bears = |bearer: &Bearer| match bearer {
                    Bearer::Sole(own, _) => !is_arm && *own == side,
                    Bearer::Hand(own) => is_arm && *own == side,
                };
                let is_planted = planted(stages, posed.frame_count(), bears);
                let joints = joints.filter(|_| !is_arm || is_planted.contains(&true))?;
                Some(PlantedLimb::of(joints, is_planted, posed))
            })
            .collect();
        let is_needed = |index: &usize| {
            let own = JointId::from_usize(*index);
            limbs.iter().any(|limb| limb.lower == own || is_below(&clip.skeleton, limb.lower, own))
        };
        Self {
            needed: (0..posed.joint_count).filter(is_needed).collect(),
            limbs,
            times: (0..posed.frame_count()).map(|frame| frame as f64 / posed.fps).collect(),
            kernel: Kernel::gaussian(ROOT_WIDTH, posed.fps),
        }
    }

    /// Whether any joint for which `moves` holds turns a planted limb.
    pub fn are_moved(&self, moves: impl Fn(JointId) -> bool) -> bool {
        self.limbs.iter().any(|limb| moves(limb.lower))
    }

    /// Brings what is planted back in all frames of `clip`; `posed` is posed anew on the way, as far as that needs. Cost: linear.
    pub fn replant(&self, clip: &mut Clip, posed: &mut PosedClip) {
        self.pose(clip, posed);
        let shifts = self.root_shifts(posed);
        for (root, frame) in clip.root_positions.iter_mut().zip(0..) {
            *root += shifts.vector(0, frame);
        }
        let mut moves = Vec::new();
        for limb in &self.limbs {
            limb.moves(&self.times, posed, &shifts, &mut moves);
            limb.bend(&moves, &shifts, posed, clip);
        }
    }

    /// World frames of the joints above and of planted limbs.
    fn pose(&self, clip: &Clip, posed: &mut PosedClip) {
        let joints = &clip.skeleton.joints;
        if !clip.moving_offsets.is_empty() {
            posed.pose_again(clip);
            return;
        }
        for (frame, world) in posed.joints.chunks_exact_mut(joints.len()).enumerate() {
            let locals = &clip.rotations[frame * joints.len()..];
            for &index in &self.needed {
                world[index] = match joints[index].parent {
                    None => JointFrame { position: clip.root_positions[frame], rotation: locals[index] },
                    Some(parent) => {
                        let above = world[parent.as_usize()];
                        JointFrame {
                            position: above.position + above.rotation * joints[index].offset,
                            rotation: above.rotation * locals[index],
                        }
                    }
                };
            }
        }
    }

    /// How far the root must move in each frame for planted limbs to reach, one vector a frame, metres.
    fn root_shifts(&self, posed: &PosedClip) -> Lanes {
        let count = posed.frame_count();
        let mut shifts = Lanes::zeros(3, count);
        let mut steps = Lanes::zeros(3, count);
        for _ in 0..ROOT_STEPS {
            if self.project(posed, &shifts, SWEEPS, &mut steps) < LEFT_ROUGH {
                break;
            }
            let smoothed = smooth_from_rest(&steps, &self.kernel);
            add(&mut shifts, &smoothed);
        }
        if self.project(posed, &shifts, LAST_SWEEPS, &mut steps) > 0.0 {
            add(&mut shifts, &steps);
        }
        shifts
    }

    /// What is missing of `shifts` in each frame, by alternating projections; the largest of it, metres.
    fn project(&self, posed: &PosedClip, shifts: &Lanes, sweeps: usize, steps: &mut Lanes) -> f64 {
        steps.values.fill(0.0);
        let mut largest = 0.0_f64;
        for frame in 0..posed.frame_count() {
            let start = shifts.vector(0, frame);
            let mut shift = start;
            for _ in 0..sweeps {
                let before = shift;
                for limb in self.limbs.iter().filter(|limb| limb.is_planted[frame]) {
                    shift = limb.within_reach(posed, frame, shift);
                }
                if shift == before {
                    break;
                }
            }
            if shift != start {
                let step = shift - start;
                largest = largest.max(step.length());
                for (lane, component) in steps.vector_mut(0).into_iter().zip(step.to_array()) {
                    lane[frame] = component;
                }
            }
        }
        largest
    }

    /// Largest distance of planted lower joints from where the input has them, and largest turn (radians) against it.
    pub fn errors(&self, posed: &PosedClip) -> (f64, f64) {
        let mut largest = (0.0_f64, 0.0_f64);
        for limb in &self.limbs {
            for (frame, end) in limb.ends.iter().enumerate().filter(|(frame, _)| limb.is_planted[*frame]) {
                let now = posed.at(frame, limb.lower);
                largest.0 = largest.0.max(now.position.distance(end.position));
                largest.1 = largest.1.max(log(now.rotation * end.rotation.inverse()).length());
            }
        }
        largest
    }
}

fn add(lanes: &mut Lanes, more: &Lanes) {
    lanes.values.iter_mut().zip(&more.values).for_each(|(value, more)| *value += more);
}

fn leg(clip: &Clip, body: &BodyModel, side: Side) -> Option<[JointId; 3]> {
    let roles = match side {
        Side::Left => [JointRole::LeftHip, JointRole::LeftKnee, JointRole::LeftFoot],
        Side::Right => [JointRole::RightHip, JointRole::RightKnee, JointRole::RightFoot],
    };
    let [upper, middle, lower] = roles.map(|role| body.foot(&clip.skeleton, role));
    Some([upper?, middle?, lower?])
}

fn arm(clip: &Clip, side: Side) -> Option<[JointId; 3]> {
    let [left, right] = arms(&clip.skeleton);
    let chain = if side == Side::Left { left } else { right }?;
    Some([chain.upper, chain.middle, chain.lower])
}

fn planted(stages: &Stages, frame_count: usize, bears: impl Fn(&Bearer) -> bool) -> Vec<bool> {
    let mut planted = vec![false; frame_count];
    for support in stages.supports.iter().filter(|support| bears(&support.bearer)) {
        planted.iter_mut().zip(&support.bears).for_each(|(planted, bears)| *planted |= bears);
    }
    planted
}

impl PlantedLimb {
    fn of([upper, middle, lower]: [JointId; 3], is_planted: Vec<bool>, posed: &PosedClip) -> Self {
        let spans = runs(&is_planted).into_iter().map(|(first, last)| Span { first, last }).collect();
        let mut limb = Self {
            upper,
            middle,
            lower,
            is_planted,
            spans,
            ends: Vec::new(),
            reaches: Vec::new(),
            hinge: DVec3::ZERO,
        };
        for frame in 0..posed.frame_count() {
            let place = limb.place(posed, frame);
            let [above, below] = [place.middle - place.upper, place.lower - place.middle];
            limb.ends.push(*posed.at(frame, lower));
            limb.reaches
                .push((REACH * (above.length() + below.length())).max(place.upper.distance(place.lower)));
            limb.hinge += posed.at(frame, middle).rotation.inverse() * above.cross(below);
        }
        limb.hinge = limb.hinge.normalize_or(DVec3::X);
        limb
    }

    fn place(&self, posed: &PosedClip, frame: usize) -> Limb {
        let [upper, middle, lower] =
            [self.upper, self.middle, self.lower].map(|joint| posed.at(frame, joint).position);
        Limb { upper, middle, lower }
    }

    /// `shift` of the root, moved no farther than needed for the limb to reach.
    fn within_reach(&self, posed: &PosedClip, frame: usize, shift: DVec3) -> DVec3 {
        let away = posed.at(frame, self.upper).position + shift - self.ends[frame].position;
        let (distance_sq, reach) = (away.length_squared(), self.reaches[frame]);
        if distance_sq <= reach * reach {
            return shift;
        }
        let distance = distance_sq.sqrt();
        // Rounding must not leave it out of reach again.
        shift - away * ((distance - reach) / distance * (1.0 + 1e-12))
    }

    /// What the end is moved and turned by against where the body carries it, of all frames.
    fn moves(&self, times: &[f64], posed: &PosedClip, shifts: &Lanes, moves: &mut Vec<[DVec3; 2]>) {
        moves.clear();
        moves.resize(times.len(), [DVec3::ZERO; 2]);
        for (frame, end) in self.ends.iter().enumerate().filter(|(frame, _)| self.is_planted[*frame]) {
            let now = posed.at(frame, self.lower);
            let turn = if now.rotation == end.rotation {
                DVec3::ZERO
            } else {
                log(end.rotation * now.rotation.inverse())
            };
            moves[frame] = [end.position - (now.position + shifts.vector(0, frame)), turn];
        }
        fill(times, &self.spans, (FADE, Slopes::Level), moves);
    }

    /// Bends the limb in all frames that are moved at all.
    fn bend(&self, moves: &[[DVec3; 2]], shifts: &Lanes, posed: &PosedClip, clip: &mut Clip) {
        let joint_count = posed.joint_count;
        for (frame, [shift, turn]) in moves.iter().enumerate() {
            if *shift == DVec3::ZERO && *turn == DVec3::ZERO {
                continue;
            }
            let locals = &mut clip.rotations[frame * joint_count..(frame + 1) * joint_count];
            let carried = self.place(posed, frame);
            let target = if self.is_planted[frame] {
                // From the root's place in the frame, to which the limb is posed.
                self.ends[frame].position - shifts.vector(0, frame)
            } else {
                swung(&carried, carried.lower + *shift)
            };
            let rotation = exp(*turn) * posed.at(frame, self.lower).rotation;
            let rotation = if self.is_planted[frame] { self.ends[frame].rotation } else { rotation };
            let above = |joint: JointId| {
                let parent = clip.skeleton.joints[joint.as_usize()].parent;
                parent.map_or(DQuat::IDENTITY, |parent| posed.at(frame, parent).rotation)
            };
            let reach =
                carried.reach(target, self.pole(&carried, target, posed.at(frame, self.middle).rotation));
            let upper_turn = minimal_rotation(carried.middle - carried.upper, reach.middle - carried.upper);
            let lower_turn =
                minimal_rotation(upper_turn * (carried.lower - carried.middle), reach.lower - reach.middle)
                    * upper_turn;
            let at = |joint: JointId| posed.at(frame, joint).rotation;
            replace(
                &mut locals[self.upper.as_usize()],
                above(self.upper).inverse() * (upper_turn * at(self.upper)),
            );
            replace(
                &mut locals[self.middle.as_usize()],
                (upper_turn * above(self.middle)).inverse() * (lower_turn * at(self.middle)),
            );
            replace(
                &mut locals[self.lower.as_usize()],
                (lower_turn * above(self.lower)).inverse() * rotation,
            );
        }
    }

    /// Where the middle joint is to point: where it does; what it bends more, about its hinge, as the plane of a straight limb is noise.
    fn pole(&self, carried: &Limb, target: DVec3, middle: DQuat) -> DVec3 {
        let along = (carried.lower - carried.upper).normalize_or_zero();
        let bow = carried.bow();
        let more = (carried.bow_at(carried.upper.distance(target)) - bow.length()).max(0.0);
        let by_hinge = along.cross(middle * self.hinge).normalize_or_zero();
        minimal_rotation(carried.lower - carried.upper, target - carried.upper) * (bow + more * by_hinge)
    }
}

/// Where a free end goes: towards `target`, but slower and slower where that would straighten the limb.
fn swung(carried: &Limb, target: DVec3) -> DVec3 {
    let away = target - carried.upper;
    let (distance, spanned) = (away.length(), carried.upper.distance(carried.lower));
    if distance <= spanned {
        return target;
    }
    let length: f64 = carried.lengths().iter().sum();
    carried.upper + away * (softened(distance, length).max(spanned) / distance)
}
