//! Where a path laid onto an arc cannot be walked any more.
//!
//! The point `a` along and `l` to the left of a chord of length `c`, stretched by `s` and laid onto an arc that turns by `φ`,
//! comes to lie at the angle `θ = a/R′` on the circle of radius `R − l` about the centre of the arc, where `R = s·c/φ` and
//! `R′ = R/s`. Along the chord lengths change by
//!
//! ```text
//!     k = (R − l)·dθ/da = s·(1 − l/R),
//! ```
//!
//! to the left they stay, and both directions stay perpendicular: `k` is the Jacobian. It is 0 at the centre, `l = R`: the
//! plane is folded there, and who is beyond walks backwards on the mirrored side. On the outer side it grows
//! without bound as `R` becomes small against `|l|`: a winding path ends near where it began, its chord and with it `R` are
//! short, and `l` is as wide as ever (laps of 4 m whose ends are 0.2 m apart are stretched by 14 and more). Then feet would
//! stand farther from the hips than legs are long, at whatever height the hips are.
//!
//! So a clip has to be walked as a whole where `0 < k ≤ 2.2` for the body and for every foot that bears; each plant that is
//! within the legs' reach has to stand wherever it is; and what is torn is cut into stretches that have a direction.

use cotillion::clip::contacts::{ContactPoint, contact_point};
use cotillion::full_body::chain::legs;
use cotillion::full_body::plants::{FEET, LegTrack, bearing, plants};
use cotillion::full_body::report::PlantedPoint;
use cotillion::geometry::plan_of;
use cotillion::skeleton::Pose;

use crate::bend::Bend;
use crate::clips::Stretch;

/// Steps of 0.7 m, so many times as long, spread two legs of 0.88 m until the hips are at half their height.
const LONGEST_STEP: f64 = 2.2;

/// Share of its length by which a leg reaches ahead from the lowest place that the body comes down to, half its length above
/// the foot, nearly straight (0.985).
const LEGS_REACH: f64 = 0.85;

/// A plant farther than a leg's length from under its hip joint is beyond reach at any height.
const BEYOND_REACH: f64 = 1.0;

/// Smallest and largest factor along the chord at the body and at each foot that bears.
pub(crate) fn factors(stretch: &Stretch, edit: Bend) -> (f64, f64) {
    let skeleton = stretch.walk.skeleton();
    let chord = edit.chord(stretch.rest);
    let points: Vec<_> = ContactPoint::FEET
        .into_iter()
        .filter_map(|point| Some((point, contact_point(skeleton, point)?)))
        .collect();
    let mut range = (f64::INFINITY, f64::NEG_INFINITY);
    for (pose, contact) in stretch.rest.iter().zip(stretch.contacts) {
        let frames = skeleton.forward_kinematics(pose);
        let feet = points.iter().filter(|(point, _)| contact.at(*point)).map(|(_, at)| at.place(&frames));
        for place in feet.chain([pose.root]) {
            let factor = chord.factor(plan_of(place));
            range = (range.0.min(factor), range.1.max(factor));
        }
    }
    range
}

/// Whether a clip cannot be walked as a whole.
pub(crate) fn is_torn(stretch: &Stretch, edit: Bend) -> bool {
    let (least, most) = factors(stretch, edit);
    least <= 0.0 || most > LONGEST_STEP
}

/// How far each foot would stand from under its hip joint, share of the leg's length; 0 where it does not bear.
pub(crate) struct Strides([Vec<f64>; 2]);

impl Strides {
    pub(crate) fn of(stretch: &Stretch, moved: &[Pose]) -> Self {
        let skeleton = stretch.walk.skeleton();
        let mut strides = [vec![0.0; moved.len()], vec![0.0; moved.len()]];
        for (side, chain) in legs(skeleton).into_iter().enumerate() {
            let Some(chain) = chain else { continue };
            let places = |poses: &[Pose]| poses.iter().map(|pose| chain.place(skeleton, pose)).collect();
            let [heel, toe] = bearing(stretch.contacts, FEET[side]);
            let track = LegTrack { rest: places(stretch.rest), moved: places(moved), heel, toe };
            for plant in plants(&stretch.times, &track) {
                let span = plant.span.first..=plant.span.last;
                for (at, own) in span.clone().zip(&mut strides[side][span]) {
                    let limb = track.moved[at].limb;
                    let length: f64 = limb.lengths().iter().sum();
                    let foot = plant.carry(&track.rest[at].end_pose()).position;
                    *own = (plan_of(foot) - plan_of(limb.upper)).norm() / length;
                }
            }
        }
        Self(strides)
    }

    /// Whether the leg reaches a plant all along.
    pub(crate) fn reach(&self, plant: &PlantedPoint) -> bool {
        let side = usize::from(matches!(plant.point, ContactPoint::RightHeel | ContactPoint::RightToe));
        self.0[side][plant.first..=plant.last].iter().all(|stride| *stride < LEGS_REACH)
    }

    /// Whether some foot would have to stand where no leg reaches from the path.
    pub(crate) fn are_too_long(&self) -> bool {
        self.0.iter().flatten().any(|stride| *stride > BEYOND_REACH)
    }
}
