//! Cost of bringing hands and feet where they must be, by frames: a walk of 31 joints on a bent and stretched path.

mod many_joints;

use std::sync::Arc;

use cotillion::clip::working::{WORKING_STEP, WorkingClip};
use cotillion::full_body::{BodyInput, Effector, Jerks, PlantMode, Seams, Target, refine};
use cotillion::geometry::{cis, plan_of, world_of, yaw};
use cotillion::index::SourceFrame;
use cotillion::skeleton::{JointRole, Pose, Skeleton};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::DVec3;
use many_joints::{with_fingers, with_still_fingers};

/// `frames` frames of a walk, laid onto an arc and stretched, of a skeleton of 31 joints.
fn walk(frames: u32) -> (Skeleton, BodyInput) {
    // A walk has whole cycles: a little longer than asked for is enough, and the range cuts it.
    let clip = many_joints::walk(f64::from(frames) / 30.0 + 2.0);
    let working = WorkingClip::new("walk", Arc::new(clip), SourceFrame(0), SourceFrame(frames - 1));
    let skeleton = with_fingers(&working.clip.skeleton);
    let pose = |frame: usize| with_still_fingers(working.pose(frame as f64));
    let rest: Vec<Pose> = (0..working.frame_count()).map(pose).collect();
    let input = BodyInput {
        times: (0..rest.len()).map(|frame| frame as f64 * WORKING_STEP).collect(),
        moved: rest.iter().map(bent).collect(),
        contacts: working.contacts.clone(),
        rest,
        effectors: Vec::new(),
        seams: Seams::default(),
        source: Jerks::default(),
    };
    (skeleton, input)
}

/// Half as far again, on a circle of 10 m.
fn bent(pose: &Pose) -> Pose {
    let at = plan_of(pose.root) * 1.3;
    let angle = at.norm() / 10.0;
    let mut moved = pose.clone();
    moved.root = world_of(at * cis(0.5 * angle), pose.root.y);
    moved.rotations[0] = yaw(angle) * pose.rotations[0];
    moved
}

fn full_body(criterion: &mut Criterion) {
    for (group, mode, reaches) in [
        ("full_body", PlantMode::AsCaptured, false),
        ("full_body_pinned", PlantMode::Pinned, false),
        ("full_body_whole", PlantMode::Whole, false),
        ("full_body_reaching", PlantMode::AsCaptured, true),
    ] {
        let mut group = criterion.benchmark_group(group);
        group.sample_size(10);
        for frames in [1_000, 10_000] {
            let (skeleton, mut input) = walk(frames);
            if reaches {
                input.effectors = hands(&skeleton, &input);
            }
            group.throughput(Throughput::Elements(u64::from(frames)));
            group.bench_function(BenchmarkId::new("frames", frames), |b| {
                b.iter(|| refine(&skeleton, &input, mode));
            });
        }
        group.finish();
    }
}

/// A hand that reaches out for half a second every four seconds.
fn hands(skeleton: &Skeleton, input: &BodyInput) -> Vec<Effector> {
    let joint = skeleton.joint_of(JointRole::LeftHand).expect("the generated body has hands");
    let target = |pose: &Pose| Target { position: pose.root + DVec3::new(0.3, 0.3, 0.3), rotation: None };
    let grasp = |first: usize| Effector {
        joint,
        first,
        targets: input.moved[first..first + 15].iter().map(target).collect(),
        holds: false,
    };
    (60..input.moved.len() - 15).step_by(120).map(grasp).collect()
}

criterion_group!(benches, full_body);
criterion_main!(benches);
