//! What became of one body, for a report: which joints were turned most, which contacts hold, what is out of reach.

use serde::Serialize;

use crate::clip::contacts::ContactPoint;
use crate::embody::{Body, Embodied};
use crate::full_body::report::TOLERATED;
use crate::full_body::{PlantedPoint, WholeContact};
use crate::index::{CharacterId, JointId};
use crate::object_motion::{Performance, skeleton_of};
use crate::resample::shown_contacts_at;

/// One character's full body. Lengths in metres, times in scene seconds, angles in degrees.
#[derive(Clone, Debug, Serialize)]
pub struct FullBodyReport {
    /// Largest change of a joint's angle; `null` where none changed.
    pub largest_change: Option<ChangeReport>,
    /// Share of the contacts of the capture, by shown frames, that hold: planted, and no farther from their mean place than
    /// captured, to a millimetre. `null` without contacts.
    pub contacts_held: Option<f64>,
    /// The plant that drifts farthest beyond what is captured; `null` without plants.
    pub largest_drift: Option<DriftReport>,
    /// The whole contact that drifts farthest beyond what is captured, whether or not it is held all along (where feet are
    /// pinned it is not); `null` without contacts.
    pub contact_drift: Option<DriftReport>,
    /// Largest shift of the root …
    pub root_shift: f64,
    /// … and the largest one downwards.
    pub root_drop: f64,
    /// Feet, hands and other ends out of reach: the worst of each stretch of time.
    pub shortfalls: Vec<ShortfallReport>,
}

/// How far a joint was turned.
#[derive(Clone, Debug, Serialize)]
#[expect(missing_docs, reason = "the names say it")]
pub struct ChangeReport {
    pub joint: String,
    pub time: f64,
    pub degrees: f64,
}

/// A plant of a point of a foot, or of a hand.
#[derive(Clone, Debug, Serialize)]
pub struct DriftReport {
    /// `left_heel`, …, `right_hand`.
    pub point: &'static str,
    /// First frame of the plant.
    pub from: f64,
    /// Last frame of the plant.
    pub to: f64,
    /// Largest distance from the mean place as captured.
    pub captured: f64,
    /// The same in the result.
    pub result: f64,
}

/// A joint that does not get where it must be.
#[derive(Clone, Debug, Serialize)]
#[expect(missing_docs, reason = "the names say it")]
pub struct ShortfallReport {
    pub joint: String,
    pub time: f64,
    pub metres: f64,
}

/// One character's share; `None` where the full body is off. Cost: linear in samples.
pub fn full_body_report(embodied: &Embodied<'_>, who: CharacterId) -> Option<FullBodyReport> {
    let body = embodied.body(who).filter(|_| embodied.moved.scene.full_body.enabled)?;
    let skeleton = skeleton_of(embodied.moved.scene, who);
    let joint = |joint: JointId| skeleton.joints[joint.as_usize()].name.clone();
    let change = body.report.largest_change.map(|change| ChangeReport {
        joint: joint(change.joint),
        time: body.times[change.sample],
        degrees: change.angle.to_degrees(),
    });
    let shortfalls = body.report.shortfalls.iter().map(|shortfall| ShortfallReport {
        joint: joint(shortfall.joint),
        time: body.times[shortfall.sample],
        metres: shortfall.metres,
    });
    Some(FullBodyReport {
        largest_change: change,
        contacts_held: contacts_held(embodied, who, body),
        largest_drift: farthest(body, body.report.plants.iter().copied()),
        contact_drift: farthest(body, body.report.contacts.iter().map(WholeContact::as_plant)),
        root_shift: body.report.root_shift,
        root_drop: body.report.root_drop,
        shortfalls: shortfalls.collect(),
    })
}

fn contacts_held(embodied: &Embodied<'_>, who: CharacterId, body: &Body) -> Option<f64> {
    let track = &embodied.moved.scene.characters[who.as_usize()].track;
    let frames: Vec<f64> = body.times.iter().map(|time| embodied.frame(who, *time)).collect();
    let captured = shown_contacts_at(track, &frames);
    let bears = |point: ContactPoint| captured.iter().filter(|contact| contact.at(point)).count();
    let known: usize = ContactPoint::ALL.into_iter().map(bears).sum();
    let holds = |plant: &&PlantedPoint| excess(plant) <= TOLERATED;
    let held: usize = body.report.plants.iter().filter(holds).map(|plant| plant.last - plant.first + 1).sum();
    (known > 0).then(|| held as f64 / known as f64)
}

/// How much farther a plant drifts than captured.
fn excess(plant: &PlantedPoint) -> f64 {
    plant.drift - plant.captured_drift
}

/// Of `plants`, the one that drifts farthest beyond what is captured.
fn farthest(body: &Body, plants: impl Iterator<Item = PlantedPoint>) -> Option<DriftReport> {
    let worst = plants.max_by(|a, b| excess(a).total_cmp(&excess(b)))?;
    Some(DriftReport {
        point: worst.point.keyword(),
        from: body.times[worst.first],
        to: body.times[worst.last],
        captured: worst.captured_drift,
        result: worst.drift,
    })
}
