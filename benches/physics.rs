//! Cost of touching up a motion on the ground, by frames: a bent walk of 31 joints at 120 frames a second, three steps.
//!
//! The paper needed 0.108 s for 98 frames and three steps: 907 frames a second.

mod many_joints;

use std::sync::Arc;

use cotillion::clip::Clip;
use cotillion::clip::derived::bent;
use cotillion::physics::body_model::{BodyModel, BodySettings, body_model};
use cotillion::physics::ground::GroundSettings;
use cotillion::physics::ground::target::{Source, Target};
use cotillion::physics::posed::PosedClip;
use cotillion::physics::stages::{StageSettings, Stages, stages};
use cotillion::physics::touch_up::{TouchUpSettings, touch_up};
use cotillion::skeleton::Pose;
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use many_joints::{with_fingers, with_still_fingers};

/// Frames per second of most captures.
const RATE: f64 = 120.0;

struct Walk {
    clip: Clip,
    body: BodyModel,
    stages: Stages,
    source: Source,
}

/// `frames` frames of a walk on an arc of 3 m, of a skeleton of 31 joints.
fn walk(frames: usize) -> Walk {
    let slow = many_joints::walk(frames as f64 / RATE + 2.0);
    let pose = |frame: usize| with_still_fingers(slow.sample(frame as f64 * slow.fps / RATE));
    let poses: Vec<Pose> = (0..frames).map(pose).collect();
    let straight = Clip::from_poses("walk", Arc::new(with_fingers(&slow.skeleton)), RATE, &poses);
    let body = body_model(&straight.skeleton, &BodySettings::default()).expect("generated bodies are whole");
    let stages = stages(&straight, &body, &PosedClip::of(&straight), &StageSettings::default());
    let source = Source::of(&straight, &body, &stages);
    Walk { clip: bent(&straight, 3.0).expect("a walk has a chord"), body, stages, source }
}

fn ground(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("touch_up");
    group.sample_size(20);
    for (name, target) in [("hull", Target::Hull { margin: 0.0125 }), ("carried", Target::Carried)] {
        for frames in [400, 1600, 6400] {
            let walk = walk(frames);
            let ground = GroundSettings { rounds: 1, target, ..GroundSettings::default() };
            let settings = TouchUpSettings { ground, flight: None };
            group.throughput(Throughput::Elements(frames as u64));
            group.bench_with_input(BenchmarkId::new(name, frames), &walk, |bencher, walk| {
                bencher.iter(|| {
                    touch_up(&walk.clip, &walk.body, &walk.stages, Some(&walk.source), &settings)
                        .expect("what was built together fits together")
                });
            });
        }
    }
    group.finish();
}

criterion_group!(benches, ground);
criterion_main!(benches);
