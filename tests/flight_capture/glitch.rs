//! One flight of 49_02 turns farther than all others. The body in flight is turned as its capture asks, and in no other way: whoever turns as a
//! whole, holds one momentum and lands as captured has no choice left. So the capture is looked at.

use std::path::Path;

use cotillion::geometry::{exp, log};
use cotillion::physics::flight::report::FlightFacts;
use cotillion::physics::flight::{FlightSettings, fly};
use cotillion::physics::posed::PosedClip;
use glam::DVec3;
use libtest_mimic::Failed;

use crate::performance::{Performance, load};
use crate::{GLITCH, is_exact};

/// The frame at which its momentum breaks.
const BREAK: usize = 781;
/// Frames between which the left thigh goes out and comes back.
const THIGH: (usize, usize) = (774, 790);

fn flight(jump: &Performance) -> Result<FlightFacts, Failed> {
    let flights = fly(&jump.clip, &jump.body, &jump.stages, &FlightSettings::default())?.report.flights;
    flights.into_iter().find(|facts| facts.first == GLITCH).ok_or_else(|| "no such flight".into())
}

/// Its momentum breaks at the top of the jump, where no label can end the flight.
pub(crate) fn is_captured(folder: &Path, file: &str) -> Result<(), Failed> {
    let jump = load(folder, file)?;
    let facts = flight(&jump)?;
    let found = facts.momentum_break.ok_or("no break")?;
    let lowest = |frame: usize| {
        let soles = jump.stages.supports.iter().map(|own| own.points[0].place(jump.posed.frame(frame)).y);
        soles.fold(f64::INFINITY, f64::min)
    };
    let floor = (0..jump.clip.frame_count()).map(lowest).fold(f64::INFINITY, f64::min);
    let is_at_top = lowest(BREAK) - floor > 0.8;
    let is_told = facts.to_string().contains("momentum breaks at frame 781");
    // 12.4; that of all other flights of captured jumps changes by 5.3 at most.
    let is_found = found.frame == BREAK && (12.0..13.0).contains(&found.change);
    if is_found && is_told && is_at_top { Ok(()) } else { Err(facts.to_string().into()) }
}

/// With its left thigh laid on a smooth way from before to after, the flight turns no farther than others.
pub(crate) fn is_of_one_thigh(folder: &Path, file: &str) -> Result<(), Failed> {
    let mut jump = load(folder, file)?;
    let farthest = bridge(&mut jump, "lfemur", THIGH)?;
    let facts = flight(&jump)?;
    let is_small = facts.largest_turn.to_degrees() < 3.0 && facts.momentum_break.is_none();
    let told = format!("{facts}; {farthest}°");
    if is_exact(&facts) && is_small && (36.0..38.0).contains(&farthest) { Ok(()) } else { Err(told.into()) }
}

/// Lays a joint on a cubic of its turns, with the velocities that it has at both ends; how far it was from there, degrees.
fn bridge(jump: &mut Performance, name: &str, (first, last): (usize, usize)) -> Result<f64, Failed> {
    let joints = jump.clip.skeleton.joints.len();
    let found = jump.clip.skeleton.joints.iter().position(|joint| joint.name == name);
    let at = |frame: usize| frame * joints + found.unwrap_or(0);
    let start = jump.clip.rotations[at(first)];
    let turn = |frame: usize| log(start.inverse() * jump.clip.rotations[at(frame)]);
    let count = (last - first) as f64;
    // Over two frames.
    let velocities = [turn(first) - turn(first - 2), turn(last + 2) - turn(last)].map(|change| 0.5 * change);
    let end = turn(last);
    let way = |frame: usize| -> DVec3 {
        let s = (frame - first) as f64 / count;
        let leaving = velocities[0] * count * s * (1.0 - s).powi(2);
        let arriving = velocities[1] * count * s * s * (s - 1.0);
        leaving + end * (s * s * (3.0 - 2.0 * s)) + arriving
    };
    let bridged: Vec<(usize, DVec3, f64)> =
        (first + 1..last).map(|frame| (frame, way(frame), way(frame).distance(turn(frame)))).collect();
    for (frame, turn, _) in &bridged {
        jump.clip.rotations[at(*frame)] = start * exp(*turn);
    }
    jump.posed = PosedClip::of(&jump.clip);
    found.ok_or("no such joint")?;
    Ok(bridged.iter().map(|(.., off)| off.to_degrees()).fold(0.0, f64::max))
}
