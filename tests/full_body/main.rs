mod bend;
use std::path::Path;
use std::sync::Arc;
use bend::*;
use cotillion::clip::contacts::*;
use cotillion::clip::file::read_file;
use cotillion::clip::read::ReadOptions;
use cotillion::clip::working::*;
use cotillion::full_body::*;
use cotillion::metrics::foot_slide;
use cotillion::clip::Clip;
use cotillion::skeleton::*;
use cotillion::geometry::*;
use glam::DVec3;

fn knee(s: &Skeleton, poses: &[Pose]) -> f64 {
    let mut worst: f64 = 0.0;
    for leg in chain::legs(s).into_iter().flatten() {
        let a: Vec<f64> = poses.iter().map(|p| { let l = leg.place(s, p).limb; (l.middle - l.upper).angle_between(l.lower - l.middle) }).collect();
        for w in a.windows(3) { worst = worst.max((w[0] - 2.0 * w[1] + w[2]).abs() * 900.0); }
    }
    worst
}
fn drifts(s: &Skeleton, poses: &[Pose], contacts: &[FootContacts]) -> Vec<f64> {
    let mut out = vec![];
    for point in FootPoint::ALL {
        let Some(at) = foot_point(s, point) else { continue };
        let bears: Vec<bool> = contacts.iter().map(|c| c.at(point)).collect();
        for (a, b) in runs(&bears) {
            let p: Vec<DVec3> = poses[a..=b].iter().map(|p| at.place(&s.forward_kinematics(p))).collect();
            let mean = p.iter().sum::<DVec3>() / p.len() as f64;
            out.push(p.iter().map(|q| q.distance(mean)).fold(0.0, f64::max));
        }
    }
    out
}
fn main() {
    let folder = std::env::var("COTILLION_MOCAP").unwrap();
    let text = std::fs::read_to_string(Path::new(&folder).join("MANIFEST.tsv")).unwrap();
    let only = std::env::var("ONLY").unwrap_or_default();
    for line in text.lines().skip(1) {
        let c: Vec<&str> = line.split('\t').collect();
        let file = c[0];
        if !(file.starts_with("amc/") || file.starts_with("bvh/") || file.starts_with("deep")) || file.ends_with(".asf") { continue }
        if !["walk", "run", "jog", "turn", "spiral", "slope", "navigate"].iter().any(|w| file.contains(w)) { continue }
        if !file.contains(&only) { continue }
        let fps = (file.contains("snu_") && c[9].starts_with("24")).then_some(30.0);
        let read = read_file(&Path::new(&folder).join(file), None, &ReadOptions { fps, ..Default::default() }).unwrap();
        let clip = Arc::new(read.clip);
        let (f, l) = clip.usable;
        let w = WorkingClip::new(file, clip.clone(), f, l);
        let all: Vec<Pose> = (0..w.frame_count()).map(|k| w.pose(k as f64)).collect();
        let ratio: f64 = std::env::var("RATIO").ok().and_then(|v| v.parse().ok()).unwrap_or(1.4);
        for (from, to) in pieces(&all, ratio) {
        let rest = all[from..=to].to_vec();
        struct W { contacts: Vec<FootContacts> }
        let w = W { contacts: w.contacts[from..=to].to_vec() };
        let times: Vec<f64> = (0..rest.len()).map(|k| k as f64 / 30.0).collect();
        let s = &clip.skeleton;
        let len: f64 = rest.windows(2).map(|p| (plan_of(p[1].root) - plan_of(p[0].root)).norm()).sum();
        let chord = (plan_of(rest[rest.len()-1].root) - plan_of(rest[0].root)).norm();
        let k0 = knee(s, &rest);
        let d0 = drifts(s, &rest, &w.contacts);
        let sl = |poses: &[Pose]| foot_slide(&Clip::from_poses("", clip.skeleton.clone(), 30.0, poses), &w.contacts).unwrap_or(0.0);
        let s0 = sl(&rest);
        println!("{file} n {} len {len:.2} chord {chord:.2} knee {k0:.0} drift {:.4} slide {s0:.4}", rest.len(), d0.iter().fold(0.0, |a: f64, b| a.max(*b)));
        let q = std::f64::consts::FRAC_PI_2;
        for (turn, stretch) in [(0.0, 1.0), (q, 1.0), (0.0, 1.3), (0.0, 0.7), (q, 1.3), (q, 0.7)] {
            let moved = bent(&rest, Bend { turn, stretch });
            let input = BodyInput { times: times.clone(), rest: rest.clone(), moved: moved.clone(), contacts: w.contacts.clone() };
            let (poses, report) = refine(s, &input);
            if std::env::var("TRACE").is_ok() {
                for (side, leg) in chain::legs(s).into_iter().flatten().enumerate() {
                    let ang = |poses: &[Pose]| -> Vec<f64> { poses.iter().map(|p| { let l = leg.place(s, p).limb; (l.middle - l.upper).angle_between(l.lower - l.middle).to_degrees() }).collect() };
                    let (a, b) = (ang(&rest), ang(&poses));
                    let bears = |k: usize| { let c = w.contacts[k]; let (h, t) = if side == 0 { (c.left_heel, c.left_toe) } else { (c.right_heel, c.right_toe) }; format!("{}{}", if h {"H"} else {"-"}, if t {"T"} else {"-"}) };
                    for k in 1..a.len() - 1 {
                        let acc = |a: &[f64]| (a[k-1] - 2.0 * a[k] + a[k+1]).to_radians() * 900.0;
                        println!("T {turn:.0} {stretch} {side} {k} {} rest {:.1} {:.0} new {:.1} {:.0} drop {:.3}", bears(k), a[k], acc(&a), b[k], acc(&b), moved[k].root.y - poses[k].root.y);
                    }
                }
            }
            let d: f64 = drifts(s, &poses, &w.contacts).iter().zip(&d0).map(|(a, b)| a - b).fold(f64::NEG_INFINITY, f64::max);
            let change = poses.iter().zip(&rest).flat_map(|(a, b)| a.rotations.iter().zip(&b.rotations).skip(1).map(|(a, b)| log(a.inverse() * *b).length())).fold(0.0, f64::max);
            let low = |poses: &[Pose]| -> Vec<f64> { FootPoint::ALL.into_iter().filter_map(|p| foot_point(s, p)).flat_map(|at| poses.iter().map(move |p| at.place(&s.forward_kinematics(p)).y)).collect() };
            let floor = low(&rest).iter().fold(9.0f64, |a, b| a.min(*b));
            let sink = low(&poses).iter().zip(low(&rest)).map(|(a, b)| a - b).fold(0.0f64, f64::min);
            let below = low(&poses).iter().fold(9.0f64, |a, b| a.min(*b)) - floor;
            print!("  sink {sink:.3} below {below:.3}");
            println!("   {:>3.0} {stretch:.1}: drift+ {d:+.4} slide {:.4} knee {:.2} (moved {:.2}) short {:.4} drop {:.3} change {:.1}", turn.to_degrees(), sl(&poses) / s0, knee(s, &poses) / k0, knee(s, &moved) / k0, report.shortfall, report.drop, change.to_degrees());
        }
        }
    }
}

fn pieces(poses: &[Pose], ratio: f64) -> Vec<(usize, usize)> {
    let at = |k: usize| plan_of(poses[k].root);
    let mut out = vec![];
    let mut from = 0;
    let mut path = 0.0;
    let mut last_ok = None;
    for k in 1..poses.len() {
        path += (at(k) - at(k - 1)).norm();
        if path <= ratio * (at(k) - at(from)).norm() { last_ok = Some(k); }
        if path > 1.0 && path > 1.5 * ratio * (at(k) - at(from)).norm() || k + 1 == poses.len() {
            if let Some(to) = last_ok { out.push((from, to)); from = to; path = (to + 1..=k).map(|j| (at(j) - at(j-1)).norm()).sum(); last_ok = None; }
        }
    }
    out
}
