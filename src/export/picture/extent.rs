//! What a picture covers, on the ground and in time.

use super::Picture;
use super::flags;
use super::view::{base, is_drawable};
use crate::geometry::c64;

/// Times beyond are left out, seconds.
const LAST: f64 = 1e12;

/// Ground and time that a picture covers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// Lower left and upper right corner, plan metres.
    pub plan: (c64, c64),
    /// First and last time, seconds.
    pub times: (f64, f64),
    /// Space right of the last time for names of what happens there, px.
    pub names: f64,
}

impl Extent {
    /// The least extent that covers both.
    pub fn and(&self, other: &Extent) -> Extent {
        let corners = [self.plan.0, self.plan.1, other.plan.0, other.plan.1];
        let times = (self.times.0.min(other.times.0), self.times.1.max(other.times.1));
        Extent { plan: bounds(corners.into_iter()), times, names: self.names.max(other.names) }
    }
}

/// What a picture needs to show all of its paths, handles, objects and times.
pub fn extent_of(picture: &Picture) -> Extent {
    Extent { plan: ground(picture), times: times(picture), names: flags::room(picture) }
}

fn ground(picture: &Picture) -> (c64, c64) {
    let paths = picture.actors.iter().flat_map(|actor| actor.rest.iter().chain(actor.edited));
    let targets =
        picture.handles.iter().flat_map(|handle| handle.target.into_iter().chain(handle.dragged_from));
    let bases = picture
        .objects
        .iter()
        .flat_map(|object| object.poses.iter().flat_map(|pose| base(object.size, pose)));
    bounds(paths.copied().chain(targets).chain(bases))
}

fn times(picture: &Picture) -> (f64, f64) {
    let times = picture.actors.iter().flat_map(|actor| actor.times.iter().copied());
    let ties = picture.ties.iter().flat_map(|tie| tie.points.iter().map(|point| point.1));
    let times = times.chain(ties).filter(|time| time.abs() < LAST);
    let bounds = times.fold(None, |bounds: Option<(f64, f64)>, time| {
        let (first, last) = bounds.unwrap_or((time, time));
        Some((first.min(time), last.max(time)))
    });
    bounds.unwrap_or((0.0, 1.0))
}

/// Lower left and upper right corner of what can be drawn.
pub(super) fn bounds(points: impl Iterator<Item = c64>) -> (c64, c64) {
    let points = points.filter(|point| is_drawable(*point));
    let bounds = points.fold(None, |bounds: Option<(c64, c64)>, point| {
        let (low, high) = bounds.unwrap_or((point, point));
        Some((
            c64::new(low.re.min(point.re), low.im.min(point.im)),
            c64::new(high.re.max(point.re), high.im.max(point.im)),
        ))
    });
    bounds.unwrap_or_default()
}
