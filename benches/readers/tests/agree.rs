//! Our reader and `bvh_anim` see the same joints, places and channels in what we write.

use std::collections::BTreeMap;

use cotillion::clip::builtin::generate;
use cotillion::clip::read::{Capture, ReadOptions, read};
use cotillion::export::bvh::{rotation_of, to_bvh};

/// `bvh_anim` keeps 32 bits: seven digits of angles up to 180 degrees, in radians, and of metres.
const ROUNDING: f64 = 1e-5;

#[test]
fn joints_places_and_rotations_are_those_of_another_reader() {
    let clip = generate("slap", &BTreeMap::new()).expect("a generated clip");
    let text = to_bvh(&clip);
    let ours =
        read(Capture::Bvh(text.as_bytes()), "slap", &ReadOptions::default()).expect("our own file").clip;
    let theirs = bvh_anim::from_bytes(text.as_bytes()).expect("our own file");
    let names: Vec<String> = theirs.joints().map(|joint| joint.data().name().to_string()).collect();
    assert_eq!(names, ours.skeleton.joints.iter().map(|joint| joint.name.clone()).collect::<Vec<_>>());
    assert_eq!(theirs.frames().count(), ours.frame_count());
    for (frame, row) in theirs.frames().enumerate() {
        let row: Vec<f64> = row.as_slice().iter().map(|value| f64::from(*value)).collect();
        let place = glam::DVec3::new(row[0], row[1], row[2]);
        assert!(place.distance(ours.root_positions[frame]) < ROUNDING);
        for (joint, angles) in row[3..].chunks(3).enumerate() {
            let order = ours.skeleton.joints[joint].rotation_order;
            let turn = rotation_of([0, 1, 2].map(|index| angles[index].to_radians()), order);
            let read = ours.rotations[frame * ours.skeleton.joints.len() + joint];
            assert!(turn.dot(read).abs() > 1.0 - ROUNDING, "frame {frame}, joint {joint}");
        }
    }
}
