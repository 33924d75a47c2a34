//! How far bodies lean: the centre of mass against the middle of both feet (half way from ankle to ball), both averaged over a stride.

use cotillion::clip::Clip;
use cotillion::physics::GRAVITY;
use cotillion::physics::body_model::{BodyModel, Segment};
use cotillion::physics::on_plan;
use cotillion::physics::posed::{PosedClip, centers_of_mass, link_places};
use glam::{DVec2, DVec3};

/// A body's centre of mass and its feet along time, both averaged over a stride around each frame.
pub(crate) struct Strides {
    centers: Vec<DVec3>,
    /// The centre of mass, not averaged.
    raw: Vec<DVec3>,
    feet: Vec<DVec3>,
    /// Frames to either side of the average.
    half: usize,
    fps: f64,
}

impl Strides {
    /// `stride`: frames of a cycle.
    pub(crate) fn of(clip: &Clip, body: &BodyModel, stride: usize) -> Self {
        let posed = PosedClip::of(clip);
        let centers = centers_of_mass(body, &link_places(body, &posed));
        let places = link_places(body, &posed);
        let feet: Vec<usize> =
            (0..body.links.len()).filter(|link| body.links[*link].segment == Segment::Foot).collect();
        let middle =
            |frame| feet.iter().map(|foot| places.vector(*foot, frame)).sum::<DVec3>() / feet.len() as f64;
        let feet: Vec<DVec3> = (0..posed.frame_count()).map(middle).collect();
        let half = stride / 2;
        Self {
            centers: averaged(&centers, half),
            raw: centers,
            feet: averaged(&feet, half),
            half,
            fps: clip.fps,
        }
    }

    /// Way of the centre of mass from one frame to another, on the plan, metres.
    pub(crate) fn way(&self, from: usize, to: usize) -> DVec2 {
        on_plan(self.raw[to] - self.raw[from])
    }

    /// Angle at which the centre of mass, averaged, climbs from one frame to another, radians.
    pub(crate) fn climb(&self, from: usize, to: usize) -> f64 {
        let way = self.centers[to] - self.centers[from];
        way.y.atan2(on_plan(way).length())
    }

    /// Frames of whole strides, at least `margin` frames from both ends.
    pub(crate) fn frames(&self, margin: usize) -> std::ops::Range<usize> {
        let from = self.half + margin;
        from..(self.centers.len().saturating_sub(from)).max(from)
    }

    /// Unit vector of travel at a frame, on the plan.
    pub(crate) fn ahead(&self, frame: usize) -> DVec2 {
        self.velocity(frame).normalize_or(DVec2::X)
    }

    /// Velocity over a quarter of a stride, m/s.
    pub(crate) fn velocity(&self, frame: usize) -> DVec2 {
        let reach = (self.half / 4).max(1);
        let way = on_plan(self.centers[frame + reach] - self.centers[frame - reach]);
        way * (self.fps / (2 * reach) as f64)
    }

    /// Acceleration over half a stride, m/s².
    pub(crate) fn acceleration(&self, frame: usize) -> DVec2 {
        let reach = (self.half / 2).max(1);
        let change =
            on_plan(self.centers[frame + reach] - 2.0 * self.centers[frame] + self.centers[frame - reach]);
        change * (self.fps / reach as f64).powi(2)
    }

    /// Angle against the vertical in the plan direction `towards`, radians.
    pub(crate) fn lean(&self, frame: usize, towards: DVec2) -> f64 {
        let up = self.centers[frame] - self.feet[frame];
        (on_plan(up).dot(towards) / up.y).atan()
    }
}

/// The lean that balances an acceleration, radians.
pub(crate) fn balancing(acceleration: f64) -> f64 {
    (acceleration / GRAVITY).atan()
}

/// Left of a plan direction `(x, z)`.
pub(crate) fn left(ahead: DVec2) -> DVec2 {
    DVec2::new(ahead.y, -ahead.x)
}

pub(crate) fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    sum / count
}

/// Mean over `half` frames on either side; where the window leaves the clip, of what is left of it.
fn averaged(places: &[DVec3], half: usize) -> Vec<DVec3> {
    let window = |frame: usize| &places[frame.saturating_sub(half)..(frame + half + 1).min(places.len())];
    (0..places.len()).map(|frame| window(frame).iter().sum::<DVec3>() / window(frame).len() as f64).collect()
}
