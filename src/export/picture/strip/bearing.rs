//! What bears in a pose: a dot at each point, a line for ground that is not the floor.

use std::sync::Arc;

use glam::DVec3;

use super::paint::{Painter, Stand};
use crate::clip::Clip;
use crate::clip::contacts::{BodyPoint, ContactPoint, contact_point};
use crate::clip::working::WorkingClip;
use crate::export::palette::colour;
use crate::export::picture::svg::{Point, number, tinted};
use crate::index::{SourceFrame, floor_index};
use crate::skeleton::JointFrame;

/// Contacts of a clip, ready to be looked up.
pub(super) struct Bearings {
    working: WorkingClip,
    points: Vec<(ContactPoint, BodyPoint)>,
}

/// A point that bears in one pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bearing {
    is_left: bool,
    /// In the world, metres.
    place: DVec3,
    /// Height of the ground there where it is not the floor.
    ground: Option<f64>,
}

/// Radius of a dot, metres; half the length of a line.
const DOT: f64 = 0.017;
const GROUND: f64 = 0.16;

impl Bearings {
    /// Cost: linear in the clip.
    pub(super) fn of(clip: &Clip) -> Self {
        let (first, last) = clip.usable;
        let points = ContactPoint::ALL.into_iter();
        Self {
            working: WorkingClip::new(&clip.name, Arc::new(clip.clone()), first, last),
            points: points.filter_map(|point| Some((point, contact_point(&clip.skeleton, point)?))).collect(),
        }
    }

    /// What bears at file frame `frame`, where the joints are at `frames` and the floor at height `floor`.
    pub(super) fn at(&self, frame: SourceFrame, frames: &[JointFrame], floor: f64) -> Vec<Bearing> {
        let nearest = floor_index((self.working.working_frame(f64::from(frame.0)) + 0.5).max(0.0));
        let at = nearest.min(self.working.frame_count() - 1);
        let bears = self.points.iter().filter(|(point, _)| self.working.contacts[at].at(*point));
        let bearing = |(point, joint): &(ContactPoint, BodyPoint)| {
            let grounds = self.working.grounds.iter();
            let mut own =
                grounds.filter(|ground| ground.point == *point && (ground.first..=ground.last).contains(&at));
            Bearing {
                is_left: matches!(
                    point,
                    ContactPoint::LeftHeel | ContactPoint::LeftToe | ContactPoint::LeftHand
                ),
                place: joint.place(frames),
                ground: own.next().map(|ground| floor + ground.height),
            }
        };
        bears.map(bearing).collect()
    }
}

impl Painter<'_> {
    /// Draws the ground under what bears, where it is not the floor.
    pub(super) fn grounds(&mut self, bearing: &[Bearing], stand: &Stand) {
        for (height, place) in bearing.iter().filter_map(|own| Some((own.ground?, own.place))) {
            let [x, y] = self.on_sheet(place.with_y(height), stand);
            let half = GROUND * stand.scale;
            let pen = r##"stroke="#8f7a56" stroke-width="2.2" stroke-linecap="round""##;
            self.sheet.line([x - half, y], [x + half, y], pen);
        }
    }

    /// Draws a dot at each point that bears.
    pub(super) fn bearing(&mut self, bearing: &[Bearing], stand: &Stand) {
        for own in bearing {
            let fill = tinted(colour(usize::from(!own.is_left)), 0.0);
            let pen = format!(r##"fill="{fill}" stroke="#ffffff" stroke-width="{}""##, number(0.8));
            self.sheet.circle(self.on_sheet(own.place, stand), (DOT * stand.scale).max(1.8), &pen);
        }
    }

    fn on_sheet(&self, place: DVec3, stand: &Stand) -> Point {
        let [x, y] = self.camera.place(place - stand.origin);
        [stand.at[0] + x * stand.scale, stand.at[1] - y * stand.scale]
    }
}
