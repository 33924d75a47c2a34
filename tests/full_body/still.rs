//! Walks whose feet are pinned and that are not edited: how far joints turn for it, and how much is held.

use std::path::Path;

use cotillion::clip::contacts::{ContactPoint, Contacts, contact_point, runs};
use cotillion::full_body::plants::{FEET, bearing};
use cotillion::full_body::{PlantMode, WholeContact};
use cotillion::skeleton::{Pose, Skeleton};
use libtest_mimic::Failed;

use crate::clips::{Walk, load};
use crate::measure::{knee_acceleration, largest_change};
use crate::{DRIFT, KNEES, OWN_RATE, PINNED_CHANGE, refined, tell};

pub(crate) fn hardly_changes(folder: &Path, file: &str) -> Result<(), Failed> {
    holds_still(&load(folder, file)?, file)
}

pub(crate) fn hardly_changes_at_own_rate(folder: &Path, file: &str) -> Result<(), Failed> {
    holds_still(&load(folder, file)?.at_rate(OWN_RATE), file)
}

fn holds_still(walk: &Walk, file: &str) -> Result<(), Failed> {
    let stretch = walk.stretch((0, walk.poses.len() - 1));
    let result = refined(&stretch, stretch.rest, PlantMode::Pinned);
    let change = largest_change(stretch.rest, &result.poses);
    let reported = result.report.largest_change.map_or(0.0, |change| change.angle);
    let share = held_points(&result.planted) as f64 / held_points(stretch.contacts) as f64;
    let on_a_point = bearing_frames(&result.planted) as f64 / bearing_frames(stretch.contacts) as f64;
    let whole = &result.report.contacts;
    let drift = whole.iter().map(|contact| contact.drift - contact.captured_drift).fold(0.0, f64::max);
    tell(&format!(
        "{file} pinned: {:.2} degrees, {share:.2} of the contacts held, on a point that stands {on_a_point:.2} of the \
         time, whole contacts drift {drift:.4} m more than captured",
        change.to_degrees()
    ));
    let frames = |contact: &WholeContact| (contact.last + 1 - contact.first) as f64;
    let told: f64 = whole.iter().map(|contact| contact.held * frames(contact)).sum();
    if (told - held_points(&result.planted) as f64).abs() > 1e-6 {
        return Err(format!("{told} frames told as held").into());
    }
    if share < HELD_OF_CONTACTS || on_a_point < HELD_BY_A_POINT || drift > WHOLE_DRIFT {
        return Err(format!("{share} of the contacts, {on_a_point} of the time, drift {drift} m").into());
    }
    let unheld = unheld_steps(stretch.contacts, &result.planted);
    if unheld > 0 {
        return Err(format!("{unheld} steps hold no point of the foot").into());
    }
    if (change - reported).abs() < 1e-9 && change < PINNED_CHANGE {
        return Ok(());
    }
    Err(format!("{:.2}°, reported {:.2}°", change.to_degrees(), reported.to_degrees()).into())
}

/// Held from end to end, feet turn joints by what is told, and jerk no knee.
pub(crate) fn stands_all_along(folder: &Path, file: &str) -> Result<(), Failed> {
    let walk = load(folder, file)?;
    let stretch = walk.stretch((0, walk.poses.len() - 1));
    let result = refined(&stretch, stretch.rest, PlantMode::Whole);
    let change = largest_change(stretch.rest, &result.poses);
    let told = result.report.largest_change.map_or(0.0, |change| change.angle);
    let drift = result.report.contacts.iter().map(|contact| contact.drift).fold(0.0, f64::max);
    let unheld = result.report.contacts.iter().filter(|contact| contact.held < 1.0).count();
    let knees = knee_acceleration(walk.skeleton(), &walk.times, &result.poses)
        / knee_acceleration(walk.skeleton(), &walk.times, &walk.poses);
    let found = format!(
        "{:.1} degrees, down by {:.3} m, drift {drift:e} m, knees {knees:.2}",
        change.to_degrees(),
        result.report.root_drop
    );
    tell(&format!("{file} held all along: {found}"));
    let is_told = (change - told).abs() < 1e-9 && change > 0.0;
    if is_told && unheld == 0 && drift < DRIFT && knees < KNEES { Ok(()) } else { Err(found.into()) }
}

/// Heels and toes that bear, summed over frames.
pub(crate) fn held_points(contacts: &[Contacts]) -> usize {
    let bears = |contact: &Contacts| ContactPoint::FEET.iter().filter(|point| contact.at(**point)).count();
    contacts.iter().map(bears).sum()
}

/// Frames of either foot at which its heel or its toe bears.
pub(crate) fn bearing_frames(contacts: &[Contacts]) -> usize {
    let of_foot = |soles| {
        let [heel, toe] = bearing(contacts, soles);
        heel.into_iter().zip(toe).filter(|(heel, toe)| *heel || *toe).count()
    };
    FEET.into_iter().map(of_foot).sum()
}

/// Of the frames of heels' and toes' contacts at least so many are held. A heel's contact lasts until the ankle is a hand's
/// breadth up: most of the rest is a heel that rises while the toe stands.
const HELD_OF_CONTACTS: f64 = 0.55;
/// Of the frames at which a foot bears, heel or toe is held in at least so many: 0.71 to 0.88 in the walks of CMU 16, 0.80 to 0.94
/// in those of SNU.
const HELD_BY_A_POINT: f64 = 0.7;
/// Over whole contacts, held or not, points go no farther from their mean place than captured but for this, metres: where one
/// point is held the other turns about it.
const WHOLE_DRIFT: f64 = 0.015;
/// Steps shorter than this may be the rest of one before the clip begins, frames.
const STEP: usize = 8;
/// Stretches in which a foot bears and neither its heel nor its toe is held at any time.
fn unheld_steps(contacts: &[Contacts], planted: &[Contacts]) -> usize {
    let any = |contacts: &[Contacts], side: usize| -> Vec<bool> {
        let [heel, toe] = bearing(contacts, FEET[side]);
        heel.into_iter().zip(toe).map(|(heel, toe)| heel || toe).collect()
    };
    let unheld = |side: usize| {
        let held = any(planted, side);
        let steps = runs(&any(contacts, side)).into_iter().filter(|(first, last)| last + 1 - first >= STEP);
        steps.filter(|(first, last)| !held[*first..=*last].contains(&true)).count()
    };
    unheld(0) + unheld(1)
}

/// Feet held all along land and leave without a jump, also where frames are close: heels and toes speed up hardly harder than
/// captured.
pub(crate) fn lands_softly(folder: &Path, file: &str) -> Result<(), Failed> {
    let walk = load(folder, file)?.at_rate(OWN_RATE);
    let stretch = walk.stretch((0, walk.poses.len() - 1));
    let result = refined(&stretch, stretch.rest, PlantMode::Whole);
    for point in ContactPoint::FEET {
        let hardest = |poses| hardest(walk.skeleton(), poses, point);
        let (captured, found) = (hardest(stretch.rest), hardest(&result.poses));
        if found > JOLT * captured {
            return Err(format!("{point:?}: {found:.0} m/s² instead of {captured:.0}").into());
        }
    }
    Ok(())
}

/// Heels and toes may speed up so many times harder than captured: they stand and set off later.
const JOLT: f64 = 1.5;

/// Largest acceleration of a point of a foot by second differences, m/s².
fn hardest(skeleton: &Skeleton, poses: &[Pose], point: ContactPoint) -> f64 {
    let at = contact_point(skeleton, point).expect("captured feet have heels and toes");
    let places: Vec<_> = poses.iter().map(|pose| at.place(&skeleton.forward_kinematics(pose))).collect();
    let second = places.windows(3).map(|near| (near[2] - near[1] * 2.0 + near[0]).length());
    second.fold(0.0, f64::max) * OWN_RATE * OWN_RATE
}
