//! Clips performed by other skeletons look as they did: captures of every flavour, from each to each.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use cotillion::clip::Clip;
use cotillion::clip::builtin::generate;
use cotillion::clip::contacts::{FootPoint, foot_point};
use cotillion::clip::file::read_file;
use cotillion::clip::measure::foot_slide;
use cotillion::clip::read::ReadOptions;
use cotillion::clip::retarget::retarget;
use cotillion::clip::working::{WORKING_STEP, WorkingClip};
use cotillion::index::SourceFrame;
use cotillion::skeleton::{JointFrame, JointRole, Pose};
use libtest_mimic::{Arguments, Failed, Trial};

fn measure(from: &str, onto: &str) -> Result<(), Failed> {
    let (a, b) = (clip(from)?, clip(onto)?);
    let (there, report) = retarget(&a, &b)?;
    let (back, _) = retarget(&there, &a)?;
    let slides = slides(&a, &there);
    let own = [&a, &there].map(|c| cotillion::clip::measure::foot_slide_working(&working(c)).unwrap_or(0.0));
    println!("own {:.3} src {:.3}", own[1] / (own[0] * report.scale), slides[1] / (slides[0] * report.scale));
    let lows = lows(&a, &there);
    println!(
        "{from:45} {onto:40} scale {:.3} short {:.4} slide {:.4} {:.4} low {:.4?} {:?}",
        report.scale,
        report.shortfall,
        slides[0] * report.scale,
        slides[1],
        lows,
        directions(&a, &back)
    );
    Ok(())
}

fn main() {
    let mut trials = Vec::new();
    for from in NAMES {
        for onto in NAMES {
            trials.push(Trial::test(format!("{from} {onto}"), move || measure(from, onto)));
        }
    }
    libtest_mimic::run(&Arguments::from_args(), trials).exit();
}

const NAMES: [&str; 7] = [
    "builtin:walk",
    "amc/cmu_16_15_walk_straight.amc",
    "bvh/snu_walk_straight_normal.bvh",
    "bvh/cmu_60_05_salsa_A.bvh",
    "bvh/mass_walk.bvh",
    "deepmimic/humanoid3d_walk.txt",
    "bvh/cmu_37_01_walk.bvh",
];

fn clip(name: &str) -> Result<Clip, Failed> {
    if let Some(builtin) = name.strip_prefix("builtin:") {
        return Ok(generate(builtin, &BTreeMap::new())?);
    }
    Ok(read_file(&mocap().ok_or("no captures")?.join(name), None, &ReadOptions::default())?.clip)
}

fn mocap() -> Option<PathBuf> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/mocap");
    let folder = std::env::var_os("COTILLION_MOCAP").map_or_else(beside, PathBuf::from);
    folder.is_dir().then_some(folder)
}

fn working(clip: &Clip) -> WorkingClip {
    WorkingClip::new("w", Arc::new(clip.clone()), clip.usable.0, clip.usable.1)
}

fn slides(a: &Clip, b: &Clip) -> [f64; 2] {
    let contacts = working(a).contacts;
    [a, b].map(|clip| {
        let w = working(clip);
        let poses: Vec<Pose> = (0..w.frame_count()).map(|i| w.pose(i as f64)).collect();
        let c = Clip::from_poses("", Arc::clone(&clip.skeleton), 1.0 / WORKING_STEP, &poses);
        foot_slide(&c, &contacts).unwrap_or(0.0)
    })
}

fn frames(clip: &Clip) -> impl Iterator<Item = Vec<JointFrame>> + '_ {
    (clip.usable.0.0..=clip.usable.1.0).map(|f| clip.skeleton.forward_kinematics(&clip.pose(SourceFrame(f))))
}

/// Ankle and toe least heights
fn lows(a: &Clip, b: &Clip) -> Vec<f64> {
    [a, b]
        .into_iter()
        .flat_map(|clip| {
            [[FootPoint::LeftHeel, FootPoint::RightHeel], [FootPoint::LeftToe, FootPoint::RightToe]].map(
                |points| {
                    let points: Vec<_> =
                        points.into_iter().filter_map(|p| foot_point(&clip.skeleton, p)).collect();
                    frames(clip)
                        .flat_map(|f| points.iter().map(|p| p.place(&f).y).collect::<Vec<_>>())
                        .fold(f64::INFINITY, f64::min)
                },
            )
        })
        .collect()
}

fn directions(a: &Clip, back: &Clip) -> Vec<(String, f64)> {
    use JointRole as R;
    let bones = [
        (R::LeftHip, R::LeftKnee),
        (R::LeftKnee, R::LeftFoot),
        (R::RightKnee, R::RightFoot),
        (R::LeftShoulder, R::LeftElbow),
        (R::Pelvis, R::Chest),
        (R::Chest, R::LeftShoulder),
        (R::LeftFoot, R::LeftToe),
    ];
    let mut worst: BTreeMap<String, f64> = BTreeMap::new();
    for (fa, fb) in frames(a).zip(frames(back)) {
        for (from, to) in bones {
            let (Some(i), Some(j)) = (a.skeleton.joint_of(from), a.skeleton.joint_of(to)) else { continue };
            let d = |f: &[JointFrame]| f[j.as_usize()].position - f[i.as_usize()].position;
            let angle = d(&fa).angle_between(d(&fb)).to_degrees();
            let w = worst.entry(format!("{from}")).or_default();
            *w = w.max((angle * 10.0).round() / 10.0);
        }
    }
    worst.into_iter().collect()
}
