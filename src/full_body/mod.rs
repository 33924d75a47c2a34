//! Hands and feet where they must be: the poses of an edited track corrected frame by frame.

pub mod displacement;
pub mod limb;
pub mod smooth;
pub mod chain;
pub mod plants;
pub mod fade;
pub mod reach;
pub mod feet;

use glam::DVec3;

use crate::clip::contacts::FootContacts;
use crate::skeleton::{Pose, Skeleton};
use chain::Place;
use plants::LegTrack;
use reach::Demand;

/// Samples of one character.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyInput {
    /// Seconds, rising.
    pub times: Vec<f64>,
    /// As captured, placed, before the edit of the path.
    pub rest: Vec<Pose>,
    /// With the root on the edited path.
    pub moved: Vec<Pose>,
    /// Which points of the feet bear.
    pub contacts: Vec<FootContacts>,
}

/// Report.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// Largest.
    pub shortfall: f64,
    /// Largest.
    pub drop: f64,
}

const FADE: f64 = 10.0 / 30.0;

/// Refines.
pub fn refine(skeleton: &Skeleton, input: &BodyInput) -> (Vec<Pose>, Report) {
    let mut poses = input.moved.clone();
    let mut report = Report::default();
    let env = |name: &str, default: f64| std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(default);
    let soft = env("SOFT", 0.985);
    let window = env("WINDOW", FADE);
    let mut legs = Vec::new();
    for (side, chain) in chain::legs(skeleton).into_iter().enumerate() {
        let Some(chain) = chain else { continue };
        let places = |poses: &[Pose]| -> Vec<Place> { poses.iter().map(|pose| chain.place(skeleton, pose)).collect() };
        let [heel, toe] = plants::bearing(&input.contacts, side);
        let track = LegTrack { rest: places(&input.rest), moved: places(&input.moved), heel, toe };
        let plants = plants::plants(&track);
        let mut displacements = feet::planted(&track, &plants);
        fade::fill(&input.times, &plants, FADE, &mut displacements);
        legs.push((chain, track, displacements));
    }
    let demands: Vec<Vec<Demand>> = legs.iter().map(|(_, track, displacements)| {
        (0..input.times.len()).map(|at| {
            let rest = &track.rest[at].limb;
            let moved = &track.moved[at];
            let length: f64 = rest.lengths().iter().sum();
            Demand { hip: moved.limb.upper, ankle: feet::displaced(moved, &displacements[at]).position, reach: rest.upper.distance(rest.lower).max(soft * length) }
        }).collect()
    }).collect();
    let drops = reach::drops(&input.times, &demands, window);
    for (at, drop) in drops.iter().enumerate() {
        poses[at].root.y -= drop;
        report.drop = report.drop.max(*drop);
    }
    let tau = env("TAU", 2.0 / 30.0);
    for (chain, track, displacements) in &legs {
        let hint = feet::bend_hint(track.rest.iter());
        let mut free = vec![false; poses.len()];
        let mut bends = vec![0.0; poses.len()];
        for at in 0..poses.len() {
            let displacement = &displacements[at];
            if drops[at] < feet::NOTHING && displacement.shift.length() < feet::NOTHING && displacement.turn.length() < feet::NOTHING {
                continue;
            }
            let target = feet::displaced(&track.moved[at], displacement);
            let limb = track.moved[at].limb;
            let hip = limb.upper - DVec3::Y * drops[at];
            free[at] = !(track.heel[at] || track.toe[at]);
            bends[at] = limb.bend_at(hip.distance(target.position)) - limb.bend();
        }
        let bends = smooth::relax(&input.times, &bends, &free, tau);
        for at in 0..poses.len() {
            let displacement = &displacements[at];
            if drops[at] < feet::NOTHING && displacement.shift.length() < feet::NOTHING && displacement.turn.length() < feet::NOTHING {
                continue;
            }
            let mut target = feet::displaced(&track.moved[at], displacement);
            let mut place = track.moved[at];
            let down = DVec3::Y * drops[at];
            let goal = place.limb.span_at((place.limb.bend() + bends[at]).max(0.0));
            place.limb.upper -= down;
            place.limb.middle -= down;
            place.limb.lower -= down;
            if free[at] {
                target.position = place.limb.upper + (target.position - place.limb.upper).normalize() * goal;
            }
            let shortfall = feet::solve(chain, skeleton, &mut poses[at], &place, &target, hint);
            if track.heel[at] || track.toe[at] {
                report.shortfall = report.shortfall.max(shortfall);
            }
        }
    }
    (poses, report)
}
