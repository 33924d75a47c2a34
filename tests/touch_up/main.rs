//! Captured walks and runs that are bent, tilted and blended become plausible, and stay what they are where nothing was edited.
//!
//! Looks in `$COTILLION_MOCAP`, else in `../shared/mocap` beside the checkout; where neither exists every test is ignored,
//! by name. With `$COTILLION_TABLE` set, every measure is printed.

mod lean;
mod performer;

use std::path::{Path, PathBuf};

use libtest_mimic::{Arguments, Failed, Trial};
use performer::{Edited, load};
use cotillion::physics::ground::GroundSettings;
use cotillion::physics::ground::schedule::{five_five_two, uphill};
use cotillion::physics::ground::target::Target;

fn main() {
    let arguments = Arguments::from_args();
    let folder = mocap_folder();
    let trial = |name: String, run: fn(&Path, &str) -> Result<(), Failed>, file: &'static str| {
        let folder = folder.clone();
        let is_missing = folder.is_none();
        Trial::test(name, move || match folder {
            Some(folder) => run(&folder, file),
            None => Err("no captures found".into()),
        })
        .with_ignored_flag(is_missing)
    };
    let trials = vec![trial("explore".to_owned(), explore, "")];
    libtest_mimic::run(&arguments, trials).exit();
}

fn explore(folder: &Path, _: &str) -> Result<(), Failed> {
    let walk = load(folder, "amc/cmu_16_15_walk_straight.amc")?;
    let jog = load(folder, "amc/cmu_16_35_jog_straight.amc")?;
    let mut cases = Vec::new();
    for radius in [2.0, -2.0, 3.0, -3.0, 4.0, -4.0] {
        cases.push((format!("R {radius}"), Edited::bent(&walk, radius)?, false));
    }
    cases.push(("uphill".to_owned(), Edited::tilted(&walk, 10.0)?, true));
    cases.push(("blend".to_owned(), Edited::blended(&walk, &jog)?, false));
    cases.push(("16_15".to_owned(), Edited::untouched(&walk), false));
    for (name, edited, is_uphill) in cases {
        let schedule = || if is_uphill { uphill() } else { cotillion::physics::ground::schedule::level() };
        let hull = |margin| Target::Hull { margin };
        let nine = GroundSettings { schedule: schedule(), target: hull(0.0), ..GroundSettings::default() };
        let twelve = GroundSettings { schedule: five_five_two(), rounds: 1, target: hull(0.0), ..GroundSettings::default() };
        let settings = [
            ("paper 9", nine.clone()),
            ("paper 12", twelve.clone()),
            ("margin 9", GroundSettings { target: hull(0.0125), ..nine.clone() }),
            ("margin 12", GroundSettings { target: hull(0.0125), ..twelve }),
            ("carried 9", GroundSettings { target: Target::Carried, ..nine }),
        ];
        for (label, settings) in settings {
            if label.starts_with("carried") && edited.source.is_none() { continue; }
            let start = std::time::Instant::now();
            let (clip, report) = edited.touch_up(&settings)?;
            let time = start.elapsed().as_secs_f64();
            let mm = |judged: &cotillion::physics::ground::report::Judged| judged.distance.map(|d| (d.map_or(0.0, |d| d.mean) * 1e4).round() / 10.0);
            println!("{name} {label}: {:?} -> {:?} kept {}/{} miss {:?}->{:?} plant {:.4} mm {:.2e} root {:.0} mm joint {:.1} deg; {:.2} us", mm(&report.before), mm(&report.after), report.kept, report.steps.len(), report.before.miss.map(|m| m.map(|m| (m * 1e3).round())), report.after.miss.map(|m| m.map(|m| (m * 1e3).round())), report.plant_error * 1e3, report.plant_turn, report.root_shift * 1e3, report.largest_change.map_or(0.0, |c| c.angle.to_degrees()), time * 1e6 / (report.steps.len() * clip.frame_count()) as f64);
            println!("    {:?}", report.steps.iter().map(|s| mm(&s.judged)).collect::<Vec<_>>());
            println!("    {:?}", report.steps.iter().map(|s| (s.faults.unreachable, s.faults.clamped, s.faults.without_lever)).collect::<Vec<_>>());
            println!("    misses {:?}", report.steps.iter().map(|s| s.judged.miss.map(|m| m.map(|m| (m * 1e3).round()))).collect::<Vec<_>>());
            let stride = 132;
            let [before, after] = [&edited.clip, &clip].map(|clip| lean::Strides::of(clip, &edited.body, stride));
            for margin in [34, 100] {
            let frames = || before.frames(margin);
            let by = |towards: &dyn Fn(usize) -> glam::DVec2| {
                let added = lean::mean(frames().map(|k| after.lean(k, towards(k)) - before.lean(k, towards(k)))).to_degrees();
                let own = lean::mean(frames().map(|k| before.lean(k, towards(k)))).to_degrees();
                let asked = lean::mean(frames().map(|k| lean::balancing(before.acceleration(k).dot(towards(k))))).to_degrees();
                (own, added, asked)
            };
            let speed = lean::mean(frames().map(|k| before.velocity(k).length()));
            println!("    lean {:?} left {:.2?} ahead {:.2?} speed {speed:.2}", frames(), by(&|k| lean::left(before.ahead(k))), by(&|k| before.ahead(k)));
            }
        }
    }
    Ok(())
}

fn mocap_folder() -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/mocap");
    let set = std::env::var_os("COTILLION_MOCAP").map(PathBuf::from);
    [set, Some(beside)].into_iter().flatten().find(|folder| folder.is_dir())
}
