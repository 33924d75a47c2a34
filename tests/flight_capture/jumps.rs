//! Captured jumps laid on arcs.

use cotillion::geometry::{c64, cis, plan_of, world_of, yaw};

use crate::performance::Performance;

/// `jump` with its path laid from its chord onto an arc that turns by `degrees`, bodies turned with it. Stages are those it had.
pub(crate) fn on_arc(mut jump: Performance, degrees: f64) -> Performance {
    let turn = degrees.to_radians();
    let joints = jump.clip.skeleton.joints.len();
    let roots = &jump.clip.root_positions;
    let start = plan_of(roots[0]);
    let chord = plan_of(roots[roots.len() - 1]) - start;
    let (ahead, radius) = (chord / chord.norm(), chord.norm() / turn);
    for (frame, root) in jump.clip.root_positions.iter_mut().enumerate() {
        let local = (plan_of(*root) - start) / ahead;
        let angle = local.re / radius;
        let laid = c64::new(0.0, radius) + c64::new(0.0, local.im - radius) * cis(angle);
        *root = world_of(start + ahead * laid, root.y);
        let rotation = &mut jump.clip.rotations[frame * joints];
        *rotation = yaw(angle) * *rotation;
    }
    jump
}
