//! Captured jumps fly as bodies do after the flight pass, and change hardly.
//!
//! Looks in `$COTILLION_MOCAP`, else in `../shared/mocap` beside the checkout; where neither exists every test is ignored,
//! by name.

mod jumps;

use std::path::{Path, PathBuf};

use cotillion::physics::flight::{FlightSettings, fly};

fn main() {
    let folder = mocap_folder().unwrap();
    for file in [
        "amc/cmu_16_05_forward_jump.amc", "amc/cmu_16_03_high_jump_in_place.amc", "amc/cmu_02_04_jump_then_balance_on_one_leg.amc",
        "amc/cmu_49_02_jump_up_and_down_hop_on_one_foot.amc", "amc/cmu_127_21_run_jump_stop_run.amc","amc/cmu_127_25_run_jump_over_obstacle.amc",
        "bvh/snu_broad_jump.bvh", "bvh/mass_backflip.bvh"] {
        let jump = jumps::load(&folder, file).unwrap();
        show(file, &jump);
    }
    for (fps, scale) in [(Some(60.0), 1.0), (None, 2.54)] {
        let jump = jumps::load_as(&folder, "amc/cmu_16_05_forward_jump.amc", fps, scale).unwrap();
        show("odd", &jump);
    }
    for degrees in [30.0, 60.0, -60.0] {
        let jump = jumps::load(&folder, "amc/cmu_16_05_forward_jump.amc").unwrap().bent(degrees);
        show("bent", &jump);
    }
}
fn show(name: &str, jump: &jumps::Jump) {
    println!("== {name} {} frames", jump.clip.frame_count());
    for steps in [Vec::new(), cotillion::physics::flight::halves_in_turn()] {
    let start = std::time::Instant::now();
        let flown = fly(&jump.clip, &jump.body, &jump.stages, &FlightSettings { steps, ..FlightSettings::default() }).unwrap();
        println!("{:?}", start.elapsed());
        let joints = jump.clip.skeleton.joints.len();
        let (worst, at) = flown.clip.rotations.iter().zip(&jump.clip.rotations).enumerate().map(|(i,(a,b))| (a.angle_between(*b).to_degrees(), i)).fold((0.0,0), |a: (f64,usize), b| if b.0 > a.0 {b} else {a});
        let shift = flown.clip.root_positions.iter().zip(&jump.clip.root_positions).map(|(a,b)| a.distance(*b)).fold(0.0, f64::max);
        println!("joint turn {worst:.3} at frame {} {}; root {:.1} mm", at / joints, jump.clip.skeleton.joints[at % joints].name, shift*1e3);
        for f in &flown.report.flights {
            let d = |s: &[Option<cotillion::physics::zmp::DistanceSummary>;2]| s.map(|s| s.map_or(-1.0, |s| s.mean*1e3));
            println!("{f}\n   rel {:?} kept {} beside {:.1?} {:.1?} g {:.1}", f.relative_momentum_errors(), f.borders_kept, d(&f.beside), d(&f.beside_judged), f.gravity);
        }
    }
}

fn mocap_folder() -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/mocap");
    let set = std::env::var_os("COTILLION_MOCAP").map(PathBuf::from);
    [set, Some(beside)].into_iter().flatten().find(|folder| folder.is_dir())
}
