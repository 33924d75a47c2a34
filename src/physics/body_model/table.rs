//! Segments of the body: shares of the mass, places of the centres of mass, densities, shapes.
//!
//! Sources: Dempster's fractions in Winter, *Biomechanics and Motor Control of Human Movement*, 4th ed., table 4.1; lengths by
//! Drillis and Contini, there figure 4.1; the links of Xiao, Yang, Zhang, *Motion correction*, 2005, table 1.

use crate::physics::body_model::shape::{Shape, depth_of_box};

/// A segment of the body; left and right ones share one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[expect(missing_docs, reason = "the names say it")]
pub enum Segment {
    Pelvis,
    Abdomen,
    Thorax,
    Head,
    UpperArm,
    Forearm,
    Hand,
    Thigh,
    Shank,
    Foot,
}

impl Segment {
    /// All ten.
    pub const ALL: [Self; 10] = [
        Self::Pelvis,
        Self::Abdomen,
        Self::Thorax,
        Self::Head,
        Self::UpperArm,
        Self::Forearm,
        Self::Hand,
        Self::Thigh,
        Self::Shank,
        Self::Foot,
    ];

    /// How many a body has.
    pub const fn count(self) -> usize {
        if self.is_paired() { 2 } else { 1 }
    }

    /// Whether there is a left and a right one.
    pub const fn is_paired(self) -> bool {
        !matches!(self, Self::Pelvis | Self::Abdomen | Self::Thorax | Self::Head)
    }

    /// Its name in reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Pelvis => "pelvis",
            Self::Abdomen => "abdomen",
            Self::Thorax => "thorax",
            Self::Head => "head and neck",
            Self::UpperArm => "upper arm",
            Self::Forearm => "forearm",
            Self::Hand => "hand",
            Self::Thigh => "thigh",
            Self::Shank => "shank",
            Self::Foot => "foot",
        }
    }

    /// Centre of mass from the proximal end, share of the length; of the trunk from below; of the head from the neck's base to
    /// the ear canal.
    pub const fn center(self) -> f64 {
        match self {
            Self::Pelvis | Self::Thorax | Self::Foot => 0.5,
            Self::Abdomen => 0.56,
            Self::Head => 1.0,
            Self::UpperArm => 0.436,
            Self::Forearm => 0.430,
            Self::Hand => 0.506,
            Self::Thigh | Self::Shank => 0.433,
        }
    }

    /// kg/m³.
    pub const fn density(self) -> f64 {
        match self {
            Self::Pelvis | Self::Abdomen => 1010.0,
            Self::Thorax => 920.0,
            Self::Head => 1110.0,
            Self::UpperArm => 1070.0,
            Self::Forearm => 1130.0,
            Self::Hand => 1160.0,
            Self::Thigh => 1050.0,
            Self::Shank => 1090.0,
            Self::Foot => 1100.0,
        }
    }

    /// Share of the body's mass of one such segment, by Winter; all of them together are 1.
    pub const fn fraction(self) -> f64 {
        match self {
            Self::Pelvis => 0.142,
            Self::Abdomen => 0.139,
            Self::Thorax => 0.216,
            Self::Head => 0.081,
            Self::UpperArm => 0.028,
            Self::Forearm => 0.016,
            Self::Hand => 0.006,
            Self::Thigh => 0.100,
            Self::Shank => 0.0465,
            Self::Foot => 0.0145,
        }
    }

    /// Mass of one such segment of a body of [`REFERENCE_MASS`], kg, as Xiao et al. print it. Theirs are Winter's but for the
    /// thorax, so that they sum to 76.423 kg.
    pub const fn xiao_mass(self) -> f64 {
        match self {
            Self::Pelvis => 10.65,
            Self::Abdomen => 10.425,
            Self::Thorax => 17.625,
            Self::Head => 6.075,
            Self::UpperArm => 2.1,
            Self::Forearm => 1.2,
            Self::Hand => 0.45,
            Self::Thigh => 7.5,
            Self::Shank => 3.487,
            Self::Foot => 1.087,
        }
    }

    /// Length of Xiao's link, metres; the pelvis' is read as its width.
    pub const fn xiao_length(self) -> f64 {
        match self {
            Self::Pelvis | Self::UpperArm => 0.335,
            Self::Abdomen | Self::Hand => 0.18,
            Self::Thorax => 0.338,
            Self::Head => 0.32,
            Self::Forearm => 0.263,
            Self::Thigh => 0.441,
            Self::Shank => 0.42,
            Self::Foot => 0.26,
        }
    }

    /// Shape of the link in a body of [`REFERENCE_MASS`]: lengths by Xiao, widths of boxes chosen, the third side by Winter's mass
    /// and the density.
    pub fn reference_shape(self) -> Shape {
        let length = self.xiao_length();
        let sides = match self {
            Self::Pelvis => (length, 0.18),
            Self::Abdomen => (0.30, length),
            Self::Thorax => (0.34, length),
            Self::Foot => (0.09, length),
            Self::Hand => (0.08, length),
            _ => return Shape::Cylinder { length },
        };
        let mass = self.fraction() * REFERENCE_MASS;
        Shape::Box { lateral: sides.0, along: sides.1, depth: depth_of_box(mass, self.density(), sides) }
    }
}

/// Body for which the lengths of [`Segment::reference_shape`] hold, kg.
pub const REFERENCE_MASS: f64 = 75.0;

/// Share of the mass of abdomen and thorax.
pub(super) const UPPER_TRUNK: f64 = 0.355;
/// Their centre from below, share of the length, where one link is both.
pub(super) const UPPER_TRUNK_CENTER: f64 = 0.37;
/// Share of the mass of the whole trunk, where one link is all of it; its centre is in the middle.
pub(super) const TRUNK: f64 = 0.497;

/// Lengths as shares of the stature.
pub(super) mod length {
    pub(in super::super) const LEG: f64 = 0.245 + 0.246;
    pub(in super::super) const ANKLE_HEIGHT: f64 = 0.039;
    pub(in super::super) const FOREARM: f64 = 0.146;
    pub(in super::super) const HAND: f64 = 0.108;
    /// From shoulder height (0.818) to eye and ear height (0.936).
    pub(in super::super) const EAR_ABOVE_SHOULDER: f64 = 0.936 - 0.818;
    /// From the neck's base (the seventh cervical vertebra, between shoulder and chin height) to the ear canal.
    pub(in super::super) const EAR_ABOVE_NECK: f64 = 0.085;
    /// From the ankle ahead to the heads of the metatarsals: of the foot's 0.152, less heel and toes.
    pub(in super::super) const ANKLE_TO_BALL: f64 = 0.08;
}
