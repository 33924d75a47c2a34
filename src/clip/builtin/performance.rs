//! Performances on two feet: curves for what an animator would key, and a pelvis that puts the centre of mass where it
//! has to be.

use glam::{DQuat, DVec3};

use super::arms::{self, Reach};
use super::body::{
    ANKLE_HEIGHT, Body, CHEST, HEAD, HEEL_OFFSET, NECK, PELVIS, SPINE, Side, TOE_OFFSET, leg_joints,
};
use super::flight::Flight;
use super::keyed::Curve;
use super::limbs::{ArmAngles, Foot};
use super::mass::center_of_mass;
use super::{FPS, Made, stand};
use crate::skeleton::Pose;

/// Everything that changes in time, seconds from the first frame.
#[derive(Clone, Debug)]
pub(super) struct Performance {
    pub(super) body: Body,
    /// Centre of mass on the ground: aside (left positive) and ahead, metres.
    pub(super) over: [Curve; 2],
    pub(super) height: Height,
    pub(super) trunk: Trunk,
    pub(super) arms: [Arm; 2],
    pub(super) feet: [Track; 2],
    pub(super) flight: Option<Flight>,
    /// The pelvis rests there from this instant on (seconds, metres ahead), whatever the centre of mass does.
    pub(super) seat: Option<(f64, f64)>,
}

/// Heights above the ground, metres, of which one counts, or a mixture of both.
#[derive(Clone, Debug)]
pub(super) struct Height {
    pub(super) pelvis: Curve,
    pub(super) center: Curve,
    /// How much the height of the centre of mass counts: 1 in flights, 0 where legs must not be stretched by a trunk that bends.
    pub(super) share: Curve,
}

/// Attitude of the trunk, radians.
#[derive(Clone, Debug)]
pub(super) struct Trunk {
    /// Pelvis forward.
    pub(super) pitch: Curve,
    /// Pelvis, left side up.
    pub(super) list: Curve,
    /// Spine and chest forward, together.
    pub(super) bend: Curve,
    /// Spine and chest to the right, left side up, together.
    pub(super) aside: Curve,
    /// Chest to the left against the pelvis.
    pub(super) twist: Curve,
    /// Eyes below the horizon.
    pub(super) gaze: Curve,
    /// 1: the neck makes the gaze what it says; 0: the gaze counts from straight ahead of the chest.
    pub(super) level: Curve,
}

/// One arm: how it hangs, and what it reaches for with a weight from 0 to 1.
#[derive(Clone, Debug)]
pub(super) struct Arm {
    /// Backwards about the shoulder, radians.
    pub(super) swing: Curve,
    /// Of the elbow, radians.
    pub(super) bend: Curve,
    /// From the vertical sideways, radians.
    pub(super) away: Curve,
    /// Of the upper arm about itself, radians: a bent forearm points inwards.
    pub(super) inwards: Curve,
    pub(super) reach: Option<ReachTrack>,
}

/// A palm's way.
#[derive(Clone, Debug)]
pub(super) struct ReachTrack {
    pub(super) weight: Curve,
    /// Middle of the palm in the world, metres.
    pub(super) palm: [Curve; 3],
    /// Fingers below the horizon, radians; palms face each other.
    pub(super) fingers: Curve,
}

/// A foot by its toe joint, which stays put while the heel rises.
#[derive(Clone, Debug)]
pub(super) struct Track {
    /// In the world, metres.
    pub(super) toe: [Curve; 3],
    /// Of the toes outwards to the left, radians.
    pub(super) turn: f64,
    /// Heel above the toe joint, radians; the toes stay level.
    pub(super) pitch: Curve,
}

impl Performance {
    /// Stands as an idle clip begins and ends.
    pub(super) fn standing(body: &Body) -> Self {
        let stance = stand::idle(body, 1.0, 0.0);
        let center = center_of_mass(body, &stance);
        let still = || Curve::constant(0.0);
        Self {
            body: body.clone(),
            over: [center.x, center.z].map(Curve::constant),
            height: Height {
                pelvis: Curve::constant(stance.root.y),
                center: Curve::constant(center.y),
                share: still(),
            },
            trunk: Trunk {
                pitch: still(),
                list: still(),
                bend: Curve::constant(stand::LEAN),
                aside: still(),
                twist: still(),
                gaze: still(),
                level: Curve::constant(1.0),
            },
            arms: Side::BOTH.map(|_| Arm {
                swing: Curve::constant(stand::HANGING_ARM.0),
                bend: Curve::constant(stand::HANGING_ARM.1),
                away: Curve::constant(arms::AWAY),
                inwards: still(),
                reach: None,
            }),
            feet: Side::BOTH.map(|side| Track::planted(body, side)),
            flight: None,
            seat: None,
        }
    }

    /// Centre of mass of the stance in which it begins, metres.
    pub(super) fn standing_center(body: &Body) -> DVec3 {
        center_of_mass(body, &stand::idle(body, 1.0, 0.0))
    }

    /// All frames up to `seconds`, with these events.
    pub(super) fn made(&self, last_frame: usize, events: Vec<usize>) -> Made {
        let poses = (0..=last_frame).map(|frame| self.pose(frame as f64 / FPS)).collect();
        Made { poses, events }
    }

    /// Pose at an instant.
    ///
    /// Moving the pelvis moves the trunk as far and the legs, whose feet stay, about half as far: what the centre of mass
    /// misses shrinks to about a fifth each time it is added to the pelvis.
    pub(super) fn pose(&self, time: f64) -> Pose {
        const ROUNDS: usize = 60;
        /// Metres.
        const CLOSE: f64 = 1e-13;
        let mut root = self.first_guess(time);
        let mut pose = self.pose_at(root, time);
        for _ in 0..ROUNDS {
            let missed = self.missed(&pose, time);
            if missed.length() < CLOSE {
                break;
            }
            root += missed;
            pose = self.pose_at(root, time);
        }
        pose
    }

    /// Distance of the left ankle's place from the left hip, metres; more than the leg's length where it cannot reach.
    pub(super) fn leg_span(&self, time: f64) -> f64 {
        let hip = leg_joints(Side::Left)[0];
        let frames = self.body.skeleton.forward_kinematics(&self.pose(time));
        self.feet[0].foot(&self.body, time).ankle.distance(frames[hip].position)
    }

    /// Heel and tip of both soles, metres.
    pub(super) fn soles(&self, time: f64) -> [[DVec3; 2]; 2] {
        /// From the toe joint, metres at 1.75 m.
        const TIP: DVec3 = DVec3::new(0.0, -ANKLE_HEIGHT - TOE_OFFSET.y, 0.07);
        let frames = self.body.skeleton.forward_kinematics(&self.pose(time));
        Side::BOTH.map(|side| {
            let [_, _, ankle, toe] = leg_joints(side);
            [(ankle, HEEL_OFFSET), (toe, TIP)].map(|(joint, sole)| {
                frames[joint].position + frames[joint].rotation * (sole * self.body.scale)
            })
        })
    }

    fn first_guess(&self, time: f64) -> DVec3 {
        let Height { pelvis, center, share } = &self.height;
        let (pelvis, center, share) = (pelvis.at(time), center.at(time), share.at(time));
        let height = pelvis + share * (center - pelvis);
        DVec3::new(self.over[0].at(time), height, self.over[1].at(time))
    }

    /// From where the centre of mass (or the pelvis on a seat) is to where it should be.
    fn missed(&self, pose: &Pose, time: f64) -> DVec3 {
        let center = center_of_mass(&self.body, pose);
        let aside = self.over[0].at(time) - center.x;
        let ahead = match self.seat {
            Some((since, place)) if time >= since => place - pose.root.z,
            _ => self.over[1].at(time) - center.z,
        };
        let share = self.height.share.at(time);
        let up = share * (self.height.center.at(time) - center.y)
            + (1.0 - share) * (self.height.pelvis.at(time) - pose.root.y);
        DVec3::new(aside, up, ahead)
    }

    /// Pose of a flight (its ends included) with the root at the origin and the pelvis upright.
    pub(super) fn shape(&self, flight: &Flight, time: f64) -> Pose {
        let mut pose = self.upper_body(DVec3::ZERO, 0.0, time);
        flight.place_legs(&mut pose, time);
        pose
    }

    fn pose_at(&self, root: DVec3, time: f64) -> Pose {
        match self.flight.as_ref().filter(|flight| flight.holds(time)) {
            Some(flight) => {
                let mut pose = self.upper_body(root, flight.pitch.at(time), time);
                flight.place_legs(&mut pose, time);
                pose
            }
            None => {
                let mut pose = self.upper_body(root, self.trunk.pitch.at(time), time);
                self.place_feet(&mut pose, time);
                pose
            }
        }
    }

    fn upper_body(&self, root: DVec3, pitch: f64, time: f64) -> Pose {
        let mut pose = self.body.skeleton.rest_pose();
        pose.root = root;
        self.place_trunk(&mut pose, pitch, time);
        for (side, arm) in Side::BOTH.into_iter().zip(&self.arms) {
            arm.place(&self.body, &mut pose, (side, time));
        }
        pose
    }

    fn place_feet(&self, pose: &mut Pose, time: f64) {
        for (side, track) in Side::BOTH.into_iter().zip(&self.feet) {
            self.body.place_foot(pose, side, track.foot(&self.body, time));
        }
    }

    fn place_trunk(&self, pose: &mut Pose, pitch: f64, time: f64) {
        let trunk = &self.trunk;
        let [list, bend, aside, twist] =
            [&trunk.list, &trunk.bend, &trunk.aside, &trunk.twist].map(|curve| curve.at(time));
        let half = DQuat::from_rotation_z(aside / 2.0)
            * DQuat::from_rotation_y(twist / 2.0)
            * DQuat::from_rotation_x(bend / 2.0);
        let nod = trunk.gaze.at(time) - trunk.level.at(time) * (pitch + bend);
        let look = DQuat::from_rotation_x(nod / 2.0)
            * DQuat::from_rotation_y(-twist / 2.0)
            * DQuat::from_rotation_z(-(list + aside) / 2.0);
        pose.rotations[PELVIS] = DQuat::from_rotation_z(list) * DQuat::from_rotation_x(pitch);
        pose.rotations[SPINE] = half;
        pose.rotations[CHEST] = half;
        pose.rotations[NECK] = look;
        pose.rotations[HEAD] = look;
        for side in Side::BOTH {
            stand::lift_collar(pose, side, 1.0);
        }
    }
}

impl Arm {
    fn place(&self, body: &Body, pose: &mut Pose, (side, time): (Side, f64)) {
        let [swing, away, inwards, bend] =
            [&self.swing, &self.away, &self.inwards, &self.bend].map(|curve| curve.at(time));
        let reach = self.reach.as_ref().map(|track| Reach {
            palm: vector(&track.palm, time),
            fingers: track.fingers.at(time),
            weight: track.weight.at(time),
        });
        arms::place(body, pose, side, (ArmAngles { swing, away, inwards, bend }, reach));
    }
}

impl Track {
    /// Flat where it always stands.
    pub(super) fn planted(body: &Body, side: Side) -> Self {
        let (ankle, turn) = stand::planted(body, side);
        let toe = ankle + DQuat::from_rotation_y(turn) * TOE_OFFSET * body.scale;
        Self { toe: toe.to_array().map(Curve::constant), turn, pitch: Curve::constant(0.0) }
    }

    fn foot(&self, body: &Body, time: f64) -> Foot {
        let pitch = self.pitch.at(time);
        let upright = DQuat::from_rotation_y(self.turn);
        let to_ankle = upright * DQuat::from_rotation_x(pitch) * -TOE_OFFSET * body.scale;
        Foot { ankle: vector(&self.toe, time) + to_ankle, turn: self.turn, pitch, toe: -pitch }
    }
}

pub(super) fn vector(curves: &[Curve; 3], time: f64) -> DVec3 {
    DVec3::from_array([0, 1, 2].map(|k| curves[k].at(time)))
}
