//! The motion as it stands between two steps, with what physics says of it.

use crate::clip::Clip;
use crate::index::JointId;
use crate::physics::body_model::BodyModel;
use crate::physics::derivatives::Lanes;
use crate::physics::ground::GroundSettings;
use crate::physics::ground::displacement::{Displacement, apply, smoothed};
use crate::physics::ground::loads::arm_sums;
use crate::physics::ground::parts::JointMotion;
use crate::physics::ground::plants::Plants;
use crate::physics::ground::report::{Judged, StepReport};
use crate::physics::ground::step::{PreparedStep, TurnFaults};
use crate::physics::ground::target::{FILTERS, Goal, Sight, Source, Standing, Target};
use crate::physics::posed::{PosedClip, link_places};
use crate::physics::stages::Stages;
use crate::physics::zmp::{ForceSettings, LinkForces, Reaction, link_forces_at, reactions};

pub(super) struct State<'a> {
    pub(super) clip: Clip,
    pub(super) posed: PosedClip,
    pub(super) plants: Plants,
    body: &'a BodyModel,
    settings: &'a GroundSettings,
    standing: Standing,
    goals: [Goal; 2],
    forces: LinkForces,
    reactions: Vec<Reaction>,
    /// By what is optimised and by the judge.
    sights: [Vec<Option<Sight>>; 2],
}

impl<'a> State<'a> {
    pub(super) fn new(
        (clip, body, stages): (&Clip, &'a BodyModel, &Stages),
        source: Option<&Source>,
        settings: &'a GroundSettings,
    ) -> Self {
        let posed = PosedClip::of(clip);
        let standing = Standing::of(body, &posed, stages);
        let goals = Goal::of(settings.target, body.stature, (&standing, &posed), source);
        let plants = Plants::of(clip, body, stages, &posed);
        let none = Lanes::zeros(0, 0);
        let forces = LinkForces { places: none.clone(), forces: none, free_moments: Vec::new() };
        let mut state = Self {
            clip: clip.clone(),
            posed,
            plants,
            body,
            settings,
            standing,
            goals,
            forces,
            reactions: Vec::new(),
            sights: [Vec::new(), Vec::new()],
        };
        state.look();
        state
    }

    /// Finds the zero moment points of the motion as it stands.
    fn look(&mut self) {
        let places = link_places(self.body, &self.posed);
        let forces = |filter, places| {
            let GroundSettings { inertia, external, .. } = self.settings;
            let settings = ForceSettings { filter, inertia: *inertia, external };
            link_forces_at(places, self.body, &self.posed, &settings)
        };
        let judge = reactions(&forces(FILTERS[1], places.clone()));
        self.forces = forces(FILTERS[0], places);
        self.reactions = reactions(&self.forces);
        self.sights[0] = Sight::all(&self.standing, &self.reactions, &self.goals[0]);
        self.sights[1] = Sight::all(&self.standing, &judge, &self.goals[1]);
    }

    pub(super) fn judged(&self) -> Judged {
        Judged::of(&self.sights, self.settings.target == Target::Carried)
    }

    pub(super) fn is_good_enough(&self, tolerance: f64) -> bool {
        self.judged().distance[0].is_none_or(|distance| distance.mean <= tolerance)
    }

    pub(super) fn step(&mut self, step: &PreparedStep) -> StepReport {
        let arms = arm_sums(&step.sets, self.body, &self.posed, &self.forces);
        let mut faults = TurnFaults::default();
        let known: Vec<Option<Displacement>> = self.sights[0]
            .iter()
            .enumerate()
            .map(|(frame, sight)| {
                let of_frame = (&self.reactions[frame], arms[frame], self.clip.root_positions[frame]);
                Some(step.displacement(sight.as_ref()?, of_frame, self.settings.two_axis, &mut faults))
            })
            .collect();
        apply(&smoothed(&known, &step.kernel), &step.sets, &self.posed, &mut self.clip);
        let moves = |joint: JointId| step.sets.motions[joint.as_usize()] != JointMotion::Stays;
        if self.plants.are_moved(moves) {
            self.plants.replant(&mut self.clip, &mut self.posed);
        }
        self.posed.pose_again(&self.clip);
        self.look();
        StepReport { faults, judged: self.judged() }
    }
}
