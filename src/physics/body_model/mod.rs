//! Links with masses for any skeleton.
//!
//! Segments go by the roles of joints, and by the tree where names tell nothing. The distal end of a segment is the next joint of
//! its chain, else the end site, else a share of the stature. Extra joints within a limb share its mass by length, and so do
//! extra joints of the spine the mass of the abdomen (those whose middle is in its share of the trunk) and of the thorax. Collars, toes, fingers and helpers have no mass.
//!
//! The pelvis' link reaches from its joint to the first joint of the spine; where these are one place, so is its mass. A last joint of the
//! spine at shoulder height has no length and no mass: what lies below it has all of the upper trunk's.

mod build;
mod parts;
pub mod shape;
pub mod table;

use glam::{DMat3, DVec3};

use crate::index::JointId;
use crate::skeleton::{JointRole, Skeleton};
pub use table::{REFERENCE_MASS, Segment};

/// A rigid piece of the body. A joint may turn several (the trunk's last also the head, where that has no joint).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link {
    /// The joint that turns it.
    pub joint: JointId,
    /// What it is, or is a piece of.
    pub segment: Segment,
    /// kg.
    pub mass: f64,
    /// Centre of mass in the joint's axes, metres.
    pub com: DVec3,
    /// About the centre of mass in the joint's axes, kg m².
    pub inertia: DMat3,
}

/// Masses of a skeleton.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyModel {
    /// Pieces with mass, in the order of joints.
    pub links: Vec<Link>,
    /// Sum of the links' masses, kg.
    pub mass: f64,
    /// Height of the person, metres, by the length of the legs.
    pub stature: f64,
}

/// Whose table of masses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MassTable {
    /// Winter's fractions: the links weigh what the body does.
    #[default]
    Winter75,
    /// The masses of Xiao et al. as printed: a body of 75 kg weighs 76.423 kg, as its thorax is too heavy.
    Xiao2005,
}

/// How heavy a body is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodySettings {
    /// Whose table.
    pub table: MassTable,
    /// Of the whole body, kg. Positions do not depend on it.
    pub mass: f64,
}

impl Default for BodySettings {
    fn default() -> Self {
        Self { table: MassTable::Winter75, mass: REFERENCE_MASS }
    }
}

/// Why a skeleton has no body model. `joints`: names of all its joints.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages say it")]
pub enum BodyError {
    #[error("no {side} leg (hip, knee and foot) among the joints {}", .joints.join(", "))]
    NoLeg { side: &'static str, joints: Vec<String> },
    #[error("no trunk above the hips among the joints {}", .joints.join(", "))]
    NoTrunk { joints: Vec<String> },
    #[error("the legs are {length} m long, which tells no stature")]
    NoStature { length: f64 },
    #[error("a body cannot weigh {mass} kg")]
    NoMass { mass: f64 },
}

/// Masses of `skeleton` by a table. Where arms or head are missing, the other segments keep their proportions and weigh
/// `settings.mass` together. Cost: quadratic in joints.
///
/// # Errors
/// [`BodyError`] for a skeleton without trunk or with fewer than two legs, with the names of its joints.
pub fn body_model(skeleton: &Skeleton, settings: &BodySettings) -> Result<BodyModel, BodyError> {
    build::build(skeleton, settings)
}

impl BodyModel {
    /// Mass of all links of each segment, left and right together, kg, in the order of [`Segment::ALL`].
    pub fn segment_masses(&self) -> [f64; 10] {
        Segment::ALL.map(|segment| {
            self.links.iter().filter(|link| link.segment == segment).map(|link| link.mass).sum()
        })
    }

    /// The same body with other masses, kg, one a link; inertia grows with them. What weighs nothing stays without inertia.
    pub fn with_link_masses(&self, masses: &[f64]) -> Self {
        let mut body = self.clone();
        for (link, mass) in body.links.iter_mut().zip(masses) {
            link.inertia *= if link.mass > 0.0 { mass / link.mass } else { 0.0 };
            link.mass = *mass;
        }
        body.mass = body.links.iter().map(|link| link.mass).sum();
        body
    }
}

impl BodyModel {
    /// The joint of a foot: that of `role`, where it has a link; else (names that tell nothing) of the foot's link on the side of
    /// `role`.
    pub fn foot(&self, skeleton: &Skeleton, role: JointRole) -> Option<JointId> {
        let has_link = |joint: &JointId| self.links.iter().any(|link| link.joint == *joint);
        skeleton.joint_of(role).filter(has_link).or_else(|| parts::Parts::of(skeleton).joint(role))
    }
}
