//! Feet stay above the ground they leave and come to.
//!
//! Where the ground is, only plants tell: between two of them it is as low as the lower one, and where a captured foot is lower
//! still, there.

use crate::full_body::aim::solve;
use crate::full_body::chain::EndPose;
use crate::full_body::fade::Span;
use crate::full_body::feet::{Leg, NOTHING, from_to};
use crate::full_body::pins::spans;
use crate::geometry::exp;
use crate::limb::minimal_rotation;
use crate::skeleton::{Pose, Skeleton};

/// Lowest ankle and toe of a leg, metres.
pub type Floor = [f64; 2];

/// A toe that must come up above the ankle by more than this points straight up, share of the foot's length.
const STEEPEST: f64 = 0.95;

fn lower(a: Floor, b: Floor) -> Floor {
    [a[0].min(b[0]), a[1].min(b[1])]
}

impl Leg {
    /// Ankle and toe at sample `at` before the edit, metres.
    pub fn heights(&self, at: usize) -> Floor {
        let (ankle, toe) = (self.track.rest[at].limb.lower, self.track.rest[at].end);
        match &self.corrections {
            None => [ankle.y, toe.y],
            Some(corrections) => {
                let [shift, turn] = corrections[at];
                [ankle.y + shift.y, (ankle + shift + exp(turn) * (toe - ankle)).y]
            }
        }
    }

    /// The lower one of the plants before and after each sample at which nothing `bears`, where there is any.
    fn floors(&self, bears: &[bool]) -> Vec<Option<Floor>> {
        let mut floors = vec![None; bears.len()];
        let mut before: Option<Floor> = None;
        let mut from = 0;
        let end = Span { first: bears.len(), last: bears.len() };
        for span in spans(bears).into_iter().chain([end]) {
            let samples = (span.first..=span.last).take_while(|&at| at < end.first);
            let own = samples.map(|at| self.heights(at)).reduce(lower);
            let floor = match (before, own) {
                (Some(before), Some(own)) => Some(lower(before, own)),
                (before, own) => before.or(own),
            };
            floors[from..span.first].fill(floor);
            before = own;
            from = span.last + 1;
        }
        floors
    }

    /// How far the foot may come down at each sample before it is below the ground it leaves or comes to, metres.
    pub fn clearances(&self) -> Vec<f64> {
        let stands: Vec<bool> =
            (0..self.bound.len()).map(|at| self.bound[at] && !self.is_rolling(at)).collect();
        let clearance = |(at, floor): (usize, &Option<Floor>)| {
            let [ankle, toe] = self.heights(at);
            let of_toe = |floor: f64| if self.is_rolling(at) { f64::INFINITY } else { toe - floor };
            floor.map_or(0.0, |floor| (ankle - floor[0]).min(of_toe(floor[1])).max(0.0))
        };
        self.floors(&stands).iter().enumerate().map(clearance).collect()
    }

    /// How low ankle and toe may come at each sample, metres: `-∞` where the foot stands, and for hands. Cost: linear.
    pub fn grounds(&self) -> Vec<Floor> {
        let stands: Vec<bool> = (0..self.bound.len()).map(|at| self.stands(at)).collect();
        let moved = |at: usize| [self.track.moved[at].limb.lower.y, self.track.moved[at].end.y];
        let ground = |(at, floor): (usize, &Option<Floor>)| match floor {
            Some(floor) if !self.is_arm() => lower(*floor, lower(self.heights(at), moved(at))),
            _ => [f64::NEG_INFINITY; 2],
        };
        self.floors(&stands).iter().enumerate().map(ground).collect()
    }

    /// The foot at sample `at`, raised so that its ankle and its toe are not below `ground`: the toe turns up about the ankle.
    fn raised(&self, at: usize, [ankle, toe]: Floor, foot: &EndPose) -> EndPose {
        let mut raised = *foot;
        if foot.position.y < ankle - NOTHING {
            raised.position.y = ankle;
        }
        let to_toe = self.to_toe(at, foot);
        let height = toe - raised.position.y;
        if to_toe.y < height - NOTHING {
            let length = to_toe.length();
            let up = height.min(STEEPEST * length);
            let level = to_toe.with_y(0.0).normalize_or_zero() * (length * length - up * up).max(0.0).sqrt();
            raised.rotation = (minimal_rotation(to_toe, level.with_y(up)) * foot.rotation).normalize();
        }
        raised
    }

    /// Raises what the foot is to come to where it does not stand, so that it is not below the ground. Cost: linear.
    pub fn keep_above_ground(&mut self) {
        for (at, ground) in self.grounds().into_iter().enumerate() {
            let target = self.target(at);
            let raised = self.raised(at, ground, &target);
            if raised != target {
                self.displacements[at] = from_to(&self.track.moved[at].end_pose(), &raised);
            }
        }
    }

    /// Raises the foot in `poses` where it does not stand, so that it is not below the ground. Cost: linear.
    pub fn clear_ground(&self, skeleton: &Skeleton, poses: &mut [Pose]) {
        for ((at, pose), ground) in poses.iter_mut().enumerate().zip(self.grounds()) {
            let place = self.chain.place(skeleton, pose);
            let foot = place.end_pose();
            let raised = self.raised(at, ground, &foot);
            if raised != foot {
                solve(&self.chain, skeleton, pose, (&place, &raised), &self.mobility);
            }
        }
    }
}
