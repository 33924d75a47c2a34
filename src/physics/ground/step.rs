//! One step: how far parts turn in every frame.

use glam::{DMat3, DQuat, DVec2, DVec3};

use crate::clip::Clip;
use crate::geometry::exp;
use crate::physics::body_model::BodyModel;
use crate::physics::derivatives::Kernel;
use crate::physics::ground::closed_form::{Loads, NO_SHIFT, axis_across};
use crate::physics::ground::displacement::Displacement;
use crate::physics::ground::loads::about;
use crate::physics::ground::parts::{LinkSets, PartsError, link_sets};
use crate::physics::ground::schedule::Step;
use crate::physics::ground::target::Sight;
use crate::physics::zmp::Reaction;

/// A step of a schedule for one body.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PreparedStep {
    pub(super) sets: LinkSets,
    pub(super) kernel: Kernel,
    share: f64,
    largest_turn: f64,
}

/// What was the matter with the turns of a step: numbers of frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TurnFaults {
    /// No turn brings the point where it is to be; it was taken as far as it goes.
    pub unreachable: usize,
    /// The turn was larger than allowed.
    pub clamped: usize,
    /// Turning hardly moves the point: nothing was done.
    pub without_lever: usize,
}

impl PreparedStep {
    pub(super) fn of(step: &Step, clip: &Clip, body: &BodyModel) -> Result<Self, PartsError> {
        Ok(Self {
            sets: link_sets(&clip.skeleton, body, &step.turned, &step.carried)?,
            kernel: Kernel::gaussian(step.width, clip.fps),
            share: step.share,
            largest_turn: step.largest_turn,
        })
    }

    /// What is to be done to one frame, before smoothing. `arms`: of [`super::loads::arm_sums`]; `root`: place of the root.
    pub(super) fn displacement(
        &self,
        sight: &Sight,
        (reaction, arms, root): (&Reaction, DMat3, DVec3),
        two_axis: bool,
        faults: &mut TurnFaults,
    ) -> Displacement {
        let shift = sight.target - sight.zmp;
        if shift.length() < NO_SHIFT {
            return Displacement::default();
        }
        let moves_root = self.sets.moves_root();
        let pivot = DVec3::new(sight.target.x, sight.height, sight.target.y);
        let arms = if moves_root { about(arms, pivot, reaction.force) } else { arms };
        let loads = Loads { force: reaction.force, moment: reaction.moment, arms };
        let turn = self.turn(&loads, sight, shift, two_axis, faults) * (self.share * sight.confidence);
        let shift = if moves_root { moved(exp(turn), root - pivot) } else { DVec3::ZERO };
        Displacement { turn, shift }
    }

    fn turn(
        &self,
        loads: &Loads,
        sight: &Sight,
        shift: DVec2,
        two_axis: bool,
        faults: &mut TurnFaults,
    ) -> DVec3 {
        let Some(turn) = loads.turn_for(sight.height, shift) else {
            faults.without_lever += 1;
            return DVec3::ZERO;
        };
        faults.unreachable += usize::from(!turn.reaches);
        let clamped = turn.angle.clamp(-self.largest_turn, self.largest_turn);
        let is_clamped = clamped != turn.angle;
        faults.clamped += usize::from(is_clamped);
        let about_one = clamped * axis_across(shift.normalize());
        if !two_axis || is_clamped || !turn.reaches {
            return about_one;
        }
        let about_both = loads.turn_about_both(sight.height, sight.target, about_one);
        about_both.map_or(about_one, |turn| turn.clamp_length_max(self.largest_turn))
    }
}

fn moved(turn: DQuat, arm: DVec3) -> DVec3 {
    turn * arm - arm
}
