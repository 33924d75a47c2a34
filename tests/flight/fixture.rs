//! A chain of three links that somersaults and tucks by formulas: its momenta are known to eight digits.

use std::f64::consts::PI;
use std::sync::Arc;

use cotillion::clip::Clip;
use cotillion::index::JointId;
use cotillion::physics::body_model::{BodyModel, Link, Segment};
use cotillion::physics::flight::momentum::{Pair, pairs};
use cotillion::physics::posed::{PosedClip, centers_of_mass, link_places};
use cotillion::skeleton::{Axis, Joint, Pose, Skeleton};
use glam::{DMat3, DQuat, DVec3};

/// Frames, and how many a second.
pub(crate) const FRAMES: usize = 25;
pub(crate) const FPS: f64 = 30.0;

pub(crate) fn body() -> BodyModel {
    let link = |joint: u32, segment, mass, com: [f64; 3], inertia: [f64; 3]| Link {
        joint: JointId(joint),
        segment,
        mass,
        com: DVec3::from_array(com),
        inertia: DMat3::from_diagonal(DVec3::from_array(inertia)),
    };
    let links = vec![
        link(0, Segment::Thorax, 30.0, [0.0, 0.25, 0.0], [0.9, 0.3, 0.8]),
        link(1, Segment::Thigh, 12.0, [0.0, -0.2, 0.02], [0.15, 0.03, 0.15]),
        link(2, Segment::Shank, 5.0, [0.0, -0.18, 0.0], [0.06, 0.01, 0.06]),
    ];
    BodyModel { links, mass: 47.0, stature: 1.75 }
}

fn skeleton() -> Skeleton {
    let joint = |name: &str, parent: Option<u32>, down: f64| Joint {
        name: name.to_owned(),
        parent: parent.map(JointId),
        offset: DVec3::NEG_Y * down,
        end_site: None,
        rotation_order: [Axis::X, Axis::Y, Axis::Z],
        role: None,
    };
    Skeleton {
        joints: vec![joint("torso", None, 0.0), joint("thigh", Some(0), 0.05), joint("shank", Some(1), 0.42)],
    }
}

/// The motion, with its centre of mass on a parabola.
pub(crate) fn clip() -> Clip {
    let turned = |k: usize| {
        let time = k as f64 / FPS;
        let bend = (PI * k as f64 / 24.0).sin().powi(2);
        let about_x = |angle: f64| DQuat::from_rotation_x(angle);
        Pose {
            root: DVec3::ZERO,
            rotations: vec![about_x(2.4 * PI * time), about_x(-1.2 * bend), about_x(1.5 * bend)],
            offsets: Vec::new(),
        }
    };
    let poses: Vec<Pose> = (0..FRAMES).map(turned).collect();
    let mut clip = Clip::from_poses("somersault", Arc::new(skeleton()), FPS, &poses);
    let posed = PosedClip::of(&clip);
    let centers = centers_of_mass(&body(), &link_places(&body(), &posed));
    for (k, center) in centers.into_iter().enumerate() {
        let time = k as f64 / FPS;
        clip.root_positions[k] = DVec3::new(0.0, 1.0 + 3.9 * time - 4.905 * time * time, time) - center;
    }
    clip
}

/// Pairs of its frames, the whole body turning.
pub(crate) fn all_pairs() -> Vec<Pair> {
    pairs(&body(), &PosedClip::of(&clip()), (0, FRAMES - 1), None)
}
