//! Feet that do not slide, and hands that bear: the exact pass over the legs, and over arms whose hands are stated to bear.
//!
//! Source: Kovar, Schreiner & Gleicher, *Footskate Cleanup for Motion Capture Editing*, SCA 2002.

use glam::DVec3;

use crate::clip::contacts::{ContactPoint, Contacts};
use crate::full_body::aim::{Mobility, solve};
use crate::full_body::chain::{Chain, EndPose, Place};
use crate::full_body::fade::{Slopes, Span, fill};
use crate::full_body::knees::soften;
use crate::full_body::limits::MOST_BENT;
use crate::full_body::pins::spans;
use crate::full_body::plants::{Displacement, HANDS, LegTrack, Soles};
use crate::full_body::reach::Demand;
use crate::geometry::{exp, log, smoothstep};
use crate::limb::softened;
use crate::skeleton::{Pose, Skeleton};

/// A displacement below this is none, metres and radians: rounding, which a straight knee would magnify.
pub const NOTHING: f64 = 1e-9;

/// Seconds in which the displacement of a foot vanishes before and after it bears.
pub const FADE: f64 = 10.0 / 30.0;

/// Legs are not stretched flatter than this, share of their length, unless captured so: 20° at the knee.
pub const STRETCH: f64 = 0.985;

/// The body does not come down for a swinging foot that misses its way by less than this, metres: the knee gives way.
const SWING_SLACK: f64 = 0.004;

/// A foot displaced this far takes another stride than the captured one, metres.
const OTHER_STRIDE: f64 = 0.1;

/// Ends nearer than this to where they must be are there, metres.
pub const TOLERATED: f64 = 1e-3;

/// From ankle to toe, metres, where only the order of it matters.
const FOOT: f64 = 0.2;

/// Speed with which a foot leaves its plant for where it must be, m/s: farther than 0.1 m it takes a whole fade and is faster.
const RELEASED: f64 = 0.3;

/// A foot that rolls about its toe lets its ankle down by at most this for its knee, metres.
const ROLLED: f64 = 0.05;

/// A leg this near to level cannot tell how high its foot is by its length, sine.
const NEARLY_LEVEL: f64 = 0.1;

/// What is to become of one leg, or of an arm whose hand bears.
#[derive(Clone, Debug, PartialEq)]
pub struct Leg {
    /// Its joints.
    pub chain: Chain,
    /// What of it can bear.
    pub soles: Soles,
    /// Where it is.
    pub track: LegTrack,
    /// Displacement of the foot at each sample, from where the edit of the path carries it.
    pub displacements: Vec<Displacement>,
    /// What holds the captured foot still, before the edit; `None` where it stands as captured.
    pub corrections: Option<Vec<Displacement>>,
    /// Samples at which the foot must be where it is displaced to.
    pub bound: Vec<bool>,
    /// Those of them at which it does not stand but is brought to a target elsewhere.
    pub aimed: Vec<bool>,
    /// When its heel and its toe are planted: as captured, or held still.
    pub planted: [Vec<bool>; 2],
    /// When its toe is held and its heel is not: the foot may roll about the toe as the knee likes it.
    pub rolls: Vec<bool>,
    /// How far it may stretch at each sample, metres.
    pub reaches: Vec<f64>,
    /// To which side its knee bends, and how far its hip.
    pub mobility: Mobility,
}

/// `foot`, displaced.
fn displaced(foot: &EndPose, [shift, turn]: &Displacement) -> EndPose {
    EndPose { position: foot.position + *shift, rotation: exp(*turn) * foot.rotation }
}

/// How far two displacements of a foot put its ankle or its toe apart, metres.
fn apart([shift, turn]: &Displacement, [other_shift, other_turn]: &Displacement) -> f64 {
    shift.distance(*other_shift) + FOOT * turn.distance(*other_turn)
}

/// What takes `from` to `to`.
pub fn from_to(from: &EndPose, to: &EndPose) -> Displacement {
    [to.position - from.position, log(to.rotation * from.rotation.inverse())]
}

impl Leg {
    /// Where a point that it bears on is before the edit, at each sample; `None` for points of other limbs.
    pub fn captured(&self, point: ContactPoint) -> Option<Vec<DVec3>> {
        let [lower, end] = self.soles.map(|sole| sole == Some(point));
        let place = |place: &Place| if lower { place.limb.lower } else { place.end };
        (lower || end).then(|| self.track.rest.iter().map(place).collect())
    }

    /// Whether it is an arm.
    pub fn is_arm(&self) -> bool {
        HANDS.contains(&self.soles)
    }

    /// Has the foot at each of `targets`, sample and place, whatever its plants ask for; these let go about it: a plant that
    /// is displaced otherwise than the target by `d` metres as long before and after as the foot takes for `d` at
    /// `RELEASED`, at most `FADE`. Cost: linear in targets times the samples in two fades.
    pub fn bind(&mut self, times: &[f64], targets: &[(usize, EndPose)]) {
        let displacement =
            |(at, target): &(usize, EndPose)| from_to(&self.track.moved[*at].end_pose(), target);
        let bound: Vec<(usize, Displacement)> =
            targets.iter().map(|target| (target.0, displacement(target))).collect();
        let mut free = vec![false; times.len()];
        for (at, displacement) in &bound {
            let first = times.partition_point(|time| *time <= times[*at] - FADE);
            let end = times.partition_point(|time| *time < times[*at] + FADE);
            for other in first..end {
                let apart = apart(displacement, &self.displacements[other]);
                let is_beside = (times[other] - times[*at]).abs() < apart / RELEASED;
                free[other] |= is_beside && apart > TOLERATED;
            }
        }
        for other in (0..free.len()).filter(|&other| free[other]) {
            self.bound[other] = false;
            self.planted.iter_mut().for_each(|labels| labels[other] = false);
        }
        for (at, displacement) in &bound {
            self.aimed[*at] |= !self.bound[*at] || free[*at];
            (self.displacements[*at], self.bound[*at]) = (*displacement, true);
        }
        if let Some(corrections) = self.corrections.as_mut().filter(|_| !bound.is_empty()) {
            bound.iter().for_each(|(at, _)| corrections[*at] = [DVec3::ZERO; 2]);
            fill(times, &spans(&self.bound), (FADE, Slopes::Level), corrections);
        }
    }

    /// Lets plants go about `samples`, at which bones above the foot must be somewhere: by a fade before and after. Cost: linear in
    /// samples times those in two fades.
    pub fn let_go(&mut self, times: &[f64], samples: impl Iterator<Item = usize>) {
        let mut any = false;
        for at in samples {
            any = true;
            let first = times.partition_point(|time| *time <= times[at] - FADE);
            let end = times.partition_point(|time| *time < times[at] + FADE);
            self.bound[first..end].fill(false);
            self.planted.iter_mut().for_each(|labels| labels[first..end].fill(false));
        }
        if let Some(corrections) = self.corrections.as_mut().filter(|_| any) {
            fill(times, &spans(&self.bound), (FADE, Slopes::Level), corrections);
        }
    }

    /// Carries the displacements of bound samples on into those between, and holds the foot still.
    pub fn fill(&mut self, times: &[f64]) {
        fill(times, &spans(&self.bound), (FADE, Slopes::Kept), &mut self.displacements);
        let Some(corrections) = &self.corrections else { return };
        for (at, [shift, turn]) in corrections.iter().enumerate() {
            let [edit_shift, edit_turn] = self.displacements[at];
            let edited = self.target(at).rotation * self.track.rest[at].lower_rotation.inverse();
            let turn = log(exp(edited * *turn) * exp(edit_turn));
            self.displacements[at] = [edit_shift + edited * *shift, turn];
        }
    }

    /// Where the foot is to be at sample `at`.
    pub fn target(&self, at: usize) -> EndPose {
        displaced(&self.track.moved[at].end_pose(), &self.displacements[at])
    }

    /// Hangs the leg on a body that is turned: its foot stays where it is to be. Cost: linear.
    pub fn hang(&mut self, skeleton: &Skeleton, turned: &[Pose]) {
        for (at, pose) in turned.iter().enumerate() {
            let place = self.chain.place(skeleton, pose);
            if place != self.track.moved[at] {
                let target = self.target(at);
                self.displacements[at] = from_to(&place.end_pose(), &target);
                self.track.moved[at] = place;
            }
        }
    }

    /// Whether the foot stands at sample `at`.
    pub fn stands(&self, at: usize) -> bool {
        self.bound[at] && !self.aimed[at]
    }

    /// The sample nearest to `at` at which the foot stands, at most half a fade away: what the body does at one sample it
    /// nearly does at those beside it, too.
    pub fn standing_near(&self, times: &[f64], at: usize) -> Option<usize> {
        let away = |other: &usize| (times[*other] - times[at]).abs();
        let is_near = |other: &usize| away(other) < 0.5 * FADE;
        let before = (0..=at).rev().take_while(is_near).find(|&other| self.stands(other));
        let after = (at..times.len()).take_while(is_near).find(|&other| self.stands(other));
        before.into_iter().chain(after).min_by(|a, b| away(a).total_cmp(&away(b)))
    }

    /// What the leg asks of the place of its hip at sample `at`.
    pub fn demand(&self, at: usize) -> Demand {
        let reach = if self.bound[at] { self.reaches[at] } else { self.swing_reach(at) };
        let limb = self.track.moved[at].limb;
        let fold = limb.span_at(MOST_BENT).min(limb.upper.distance(limb.lower)).min(reach);
        Demand { hip: limb.upper, ankle: self.target(at).position, reach, fold }
    }

    /// Of what it asks for (`demands`), what it would without targets for its foot: within a fade of these, nothing where it
    /// does not stand. Cost: linear in targets times the samples in two fades.
    pub fn own_demands(&self, times: &[f64], demands: &[Demand]) -> Vec<Demand> {
        let mut own = demands.to_vec();
        for at in (0..times.len()).filter(|&at| self.aimed[at]) {
            let first = times.partition_point(|time| *time <= times[at] - FADE);
            let end = times.partition_point(|time| *time < times[at] + FADE);
            for led in (first..end).filter(|&led| !self.stands(led)) {
                own[led] = Demand { reach: f64::INFINITY, fold: 0.0, ..own[led] };
            }
        }
        own
    }

    /// The lowest shift of the body at each sample, metres, at most 0: the hip stays a thigh's length above the lower ankle
    /// of the plants before and after, so that the knee is never below it wherever it points; or it comes down no farther.
    /// Infinite for hands, and where the foot never bears.
    pub fn lowest_shifts(&self) -> Vec<f64> {
        let height = |at: usize| if self.is_planted(at) { self.target(at).position.y } else { f64::INFINITY };
        let mut lowest: Vec<f64> = (0..self.bound.len()).map(height).collect();
        let free = if self.is_arm() { Vec::new() } else { self.free_spans() };
        for Span { first, last } in free {
            let before = first.checked_sub(1).map_or(f64::INFINITY, height);
            let after = if last + 1 < lowest.len() { height(last + 1) } else { f64::INFINITY };
            lowest[first..=last].fill(before.min(after));
        }
        let shift = |(ankle, place): (f64, &Place)| {
            let floor = ankle + place.limb.lengths()[0];
            if ankle.is_finite() && !self.is_arm() {
                (floor - place.limb.upper.y).min(0.0)
            } else {
                f64::INFINITY
            }
        };
        lowest.into_iter().zip(&self.track.moved).map(shift).collect()
    }

    fn is_planted(&self, at: usize) -> bool {
        self.planted.iter().any(|labels| labels[at])
    }

    fn free_spans(&self) -> Vec<Span> {
        let free: Vec<bool> = (0..self.bound.len()).map(|at| !self.is_planted(at)).collect();
        spans(&free)
    }

    /// How far the leg may stretch while its foot is free, metres: as captured as long as the foot is not displaced far, but
    /// not quite straight in a stride of another length. No body comes down for a free hand.
    fn swing_reach(&self, at: usize) -> f64 {
        if self.is_arm() {
            return f64::INFINITY;
        }
        let length: f64 = self.track.rest[at].limb.lengths().iter().sum();
        let bent = STRETCH * length;
        let far = smoothstep(self.displacements[at][0].length() / OTHER_STRIDE);
        bent + (self.reaches[at] - bent) * (1.0 - far) + SWING_SLACK
    }

    /// Whether nothing is asked of the leg at sample `at`, with the body shifted by `shift`.
    fn is_idle(&self, at: usize, shift: DVec3) -> bool {
        let [foot, turn] = self.displacements[at];
        shift.length() < NOTHING && foot.length() < NOTHING && turn.length() < NOTHING
    }

    /// Brings the foot to its targets in all `poses`, whose roots are shifted by `shifts`. Cost: linear.
    pub fn solve(&self, skeleton: &Skeleton, times: &[f64], shifts: &[DVec3], poses: &mut [Pose]) {
        for ((at, pose), goal) in poses.iter_mut().enumerate().zip(self.goals(times, shifts)) {
            let Some(goal) = goal else { continue };
            let place = self.track.moved[at].shifted(shifts[at]);
            solve(&self.chain, skeleton, pose, (&place, &goal), &self.mobility);
        }
    }

    /// Where the foot goes at each sample with the body shifted by `shifts`; `None` where nothing is asked of it.
    pub fn goals(&self, times: &[f64], shifts: &[DVec3]) -> Vec<Option<EndPose>> {
        let (changes, free) = self.knee_changes(times, shifts);
        let goal = |at: usize| {
            if self.is_idle(at, shifts[at]) {
                return None;
            }
            let mut target = self.target(at);
            if free[at] {
                let limb = self.track.moved[at].shifted(shifts[at]).limb;
                let span = limb.span_at((limb.bend() + changes[at]).max(0.0));
                if self.is_rolling(at) {
                    return Some(self.rolled(at, limb.upper, span));
                }
                let towards = (target.position - limb.upper).normalize_or_zero();
                target.position = limb.upper + towards * span;
            }
            Some(target)
        };
        (0..times.len()).map(goal).collect()
    }

    /// By how much the knee is to bend more at each sample, and where the foot is free to follow it.
    fn knee_changes(&self, times: &[f64], shifts: &[DVec3]) -> (Vec<f64>, Vec<bool>) {
        let captured: Vec<f64> = self.track.moved.iter().map(|place| place.limb.bend()).collect();
        let clearances = self.clearances();
        let mut free = vec![false; times.len()];
        let mut changes = vec![0.0; times.len()];
        let mut least = vec![f64::NEG_INFINITY; times.len()];
        for at in (0..times.len()).filter(|&at| !self.is_idle(at, shifts[at])) {
            let limb = self.track.moved[at].limb;
            let hip = limb.upper + shifts[at];
            free[at] = !self.bound[at] || self.is_rolling(at);
            let distance = hip.distance(self.target(at).position);
            let spanned = limb.upper.distance(limb.lower);
            let length: f64 = limb.lengths().iter().sum();
            let goal = if distance <= spanned || self.bound[at] {
                distance
            } else {
                softened(distance, length).max(spanned)
            };
            changes[at] = limb.bend_at(goal) - captured[at];
            let steep = (hip.y - self.target(at).position.y) / distance.max(f64::MIN_POSITIVE);
            if self.is_rolling(at) {
                least[at] = limb.bend_at(goal + clearances[at].min(ROLLED)) - captured[at];
            } else if steep > NEARLY_LEVEL {
                least[at] = limb.bend_at(goal + clearances[at] / steep) - captured[at];
            }
        }
        soften(times, &captured, (&free, &least), &mut changes);
        (changes, free)
    }
}

/// Which points of the feet and hands are planted, by the plans of their limbs.
pub fn planted(legs: &[Leg], contacts: &[Contacts]) -> Vec<Contacts> {
    let mut planted = contacts.to_vec();
    for leg in legs {
        for (sole, labels) in leg.soles.into_iter().zip(&leg.planted) {
            let Some(point) = sole else { continue };
            planted.iter_mut().zip(labels).for_each(|(contact, label)| contact.set(point, *label));
        }
    }
    planted
}
