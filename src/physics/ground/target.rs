//! Where zero moment points are to be.

use glam::{DQuat, DVec2, DVec3};

use crate::clip::Clip;
use crate::clip::facing::turn_about_up;
use crate::geometry::wrap;
use crate::physics::GRAVITY;
use crate::physics::body_model::BodyModel;
use crate::physics::derivatives::{Filter, Kernel, Lanes, smooth};
use crate::physics::on_plan;
use crate::physics::posed::PosedClip;
use crate::physics::stages::{Phase, Polygon, Stages};
use crate::physics::support::{nearest, shrunk};
use crate::physics::zmp::{
    CLIP_END, DistanceSummary, ForceSettings, Reaction, confidence_of, link_forces, reactions,
};

/// What bears a body in each frame, where its feet are held.
#[derive(Clone, Debug, PartialEq)]
pub struct Standing {
    /// World, metres: those of frame 0, then of frame 1 …
    points: Vec<DVec3>,
    /// Where the points of each frame begin, and their number at the end.
    starts: Vec<usize>,
    /// Of the body, newtons.
    weight: f64,
}

impl Standing {
    /// Points that bear in `posed`; none near the ends of the clip and off the ground. Cost: linear.
    pub fn of(body: &BodyModel, posed: &PosedClip, stages: &Stages) -> Self {
        let last = posed.frame_count().saturating_sub(1);
        let (mut points, mut starts) = (Vec::new(), vec![0]);
        for frame in 0..posed.frame_count() {
            let to_end = frame.min(last - frame) as f64 / posed.fps;
            if stages.phases[frame] == Phase::Ground && to_end >= CLIP_END {
                points.extend(stages.contacts(posed, frame));
            }
            starts.push(points.len());
        }
        Self { points, starts, weight: body.mass * GRAVITY }
    }

    /// What bears in one frame, metres.
    pub fn contacts(&self, frame: usize) -> &[DVec3] {
        &self.points[self.starts[frame]..self.starts[frame + 1]]
    }

    /// Mean of what bears in one frame.
    fn middle(&self, frame: usize) -> Option<DVec3> {
        let contacts = self.contacts(frame);
        (!contacts.is_empty()).then(|| contacts.iter().sum::<DVec3>() / contacts.len() as f64)
    }
}

/// What zero moment points are to be in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target {
    /// The polygon of support, every edge of it moved inwards.
    Hull {
        /// By how much, share of the stature; never beyond the centroid.
        margin: f64,
    },
    /// Where it was in the motion that was edited, as seen from what bears. Needs a [`Source`].
    Carried,
}

/// What is known of the motion that was edited, one of each a frame of the edited motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Source {
    /// The zero moment point from the middle of what bears, `(x, z)`, metres, by the filter that is optimised and by the judge.
    pub offsets: [Vec<Option<DVec2>>; 2],
    /// World rotation of the root.
    pub roots: Vec<DQuat>,
    /// How far its points are from its polygons, by both filters.
    pub distances: [Option<DistanceSummary>; 2],
}

/// What is optimised, and what judges.
pub const FILTERS: [Filter; 2] = [Filter::Gaussian, Filter::Butterworth];

impl Source {
    /// All frames of `clip`. Cost: linear.
    pub fn of(clip: &Clip, body: &BodyModel, stages: &Stages) -> Self {
        let posed = PosedClip::of(clip);
        let standing = Standing::of(body, &posed, stages);
        let seen = FILTERS.map(|filter| {
            let settings = ForceSettings { filter, ..ForceSettings::default() };
            let reactions = reactions(&link_forces(body, &posed, &settings));
            Sight::all(&standing, &reactions, &Goal::Hull(0.0))
        });
        let offset = |(frame, sight): (usize, &Option<Sight>)| {
            Some(sight.as_ref()?.zmp - on_plan(standing.middle(frame)?))
        };
        Self {
            offsets: [0, 1].map(|filter| seen[filter].iter().enumerate().map(offset).collect()),
            roots: (0..posed.frame_count()).map(|frame| posed.frame(frame)[0].rotation).collect(),
            distances: [0, 1].map(|filter| summary(&seen[filter], |sight| sight.distance)),
        }
    }

    /// The source of a motion that shows its frames in another order or pace: `frames`, one a frame of that motion.
    ///
    /// # Panics
    /// If a frame is beyond the source's last.
    pub fn at(&self, frames: &[usize]) -> Self {
        Self {
            offsets: [0, 1].map(|filter| frames.iter().map(|frame| self.offsets[filter][*frame]).collect()),
            roots: frames.iter().map(|frame| self.roots[*frame]).collect(),
            distances: self.distances,
        }
    }

    /// Turned with the smoothed turn of `roots` since the source and put on the middle of what bears now.
    fn carried(&self, filter: usize, standing: &Standing, turns: &[f64]) -> Vec<Option<DVec2>> {
        let place = |(frame, offset): (usize, &Option<DVec2>)| {
            // Turns count from above, pairs (x, z) the other way.
            let turned = DVec2::from_angle(-turns[frame]).rotate((*offset)?);
            Some(on_plan(standing.middle(frame)?) + turned)
        };
        self.offsets[filter].iter().enumerate().map(place).collect()
    }

    /// By how much the edited body is turned about the vertical, smoothed, radians.
    fn turns(&self, posed: &PosedClip) -> Vec<f64> {
        let mut turns: Vec<f64> = Vec::with_capacity(self.roots.len());
        for (frame, root) in self.roots.iter().enumerate() {
            let turn = turn_about_up(posed.frame(frame)[0].rotation * root.inverse());
            turns.push(turns.last().map_or(turn, |before| before + wrap(turn - before)));
        }
        let lanes = Lanes { frame_count: turns.len(), values: turns };
        smooth(&lanes, &Kernel::gaussian(HEADING_WIDTH, posed.fps)).values
    }
}

/// Width of the kernel that smooths turns, frames at 30 fps: half a stride.
const HEADING_WIDTH: f64 = 20.0;

/// Where points are to be in all frames, for one filter.
#[derive(Clone, Debug, PartialEq)]
pub enum Goal {
    /// In the polygon less this margin, metres.
    Hull(f64),
    /// At these places; `None` where none is known.
    Places(Vec<Option<DVec2>>),
}

impl Goal {
    /// Of both filters. `source`: of the frames of `posed`.
    pub fn of(
        target: Target,
        stature: f64,
        (standing, posed): (&Standing, &PosedClip),
        source: Option<&Source>,
    ) -> [Self; 2] {
        match (target, source) {
            (Target::Carried, Some(source)) => {
                let turns = source.turns(posed);
                [0, 1].map(|filter| Self::Places(source.carried(filter, standing, &turns)))
            }
            (Target::Hull { margin }, _) => [Self::Hull(margin * stature), Self::Hull(margin * stature)],
            (Target::Carried, None) => [Self::Hull(0.0), Self::Hull(0.0)],
        }
    }

    fn place(&self, frame: usize, corners: &[DVec2], zmp: DVec2) -> Option<DVec2> {
        match self {
            Self::Places(places) => places[frame],
            Self::Hull(margin) if *margin > 0.0 => Some(nearest(&shrunk(corners, *margin), zmp)?.point),
            Self::Hull(_) => Some(nearest(corners, zmp)?.point),
        }
    }
}

/// The zero moment point of one frame and where it is to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sight {
    /// `(x, z)`, metres.
    pub zmp: DVec2,
    /// Of the plane it is on, metres.
    pub height: f64,
    /// From the polygon, metres; 0 inside.
    pub distance: f64,
    /// Where it is to be.
    pub target: DVec2,
    /// 0 to 1, see [`confidence_of`].
    pub confidence: f64,
}

impl Sight {
    /// Of all frames; `None` where nothing bears, or too little. Cost: linear in frames times contacts.
    pub fn all(standing: &Standing, reactions: &[Reaction], goal: &Goal) -> Vec<Option<Self>> {
        let sight = |(frame, reaction): (usize, &Reaction)| {
            let contacts = standing.contacts(frame);
            let confidence = confidence_of(reaction.force.y / standing.weight);
            if contacts.is_empty() || confidence <= 0.0 {
                return None;
            }
            let Polygon { height, corners } = Polygon::of(contacts, reaction.force);
            let zmp = reaction.zero_moment_point(height)?;
            let distance = nearest(&corners, zmp)?.distance;
            let target = goal.place(frame, &corners, zmp)?;
            Some(Self { zmp, height, distance, target, confidence })
        };
        reactions.iter().enumerate().map(sight).collect()
    }

    /// From where the point is to where it is to be, metres.
    pub fn miss(&self) -> f64 {
        self.target.distance(self.zmp)
    }
}

/// Sums up `measure` (metres) over the frames whose confidence is above 1/2; `None` if there is none.
pub fn summary(sights: &[Option<Sight>], measure: impl Fn(&Sight) -> f64) -> Option<DistanceSummary> {
    let mut found = DistanceSummary::default();
    let (mut sum, mut outside) = (0.0, 0usize);
    for sight in sights.iter().flatten().filter(|sight| sight.confidence > 0.5) {
        let value = measure(sight);
        sum += value;
        found.largest = found.largest.max(value);
        outside += usize::from(value > 0.0);
        found.frames += 1;
    }
    let share = |part: f64| part / found.frames as f64;
    (found.frames > 0).then(|| DistanceSummary { mean: share(sum), outside: share(outside as f64), ..found })
}
