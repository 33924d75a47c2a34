//! All formats with all options: two bytes say which, the file follows; of an Acclaim motion the skeleton first, then 0.
#![no_main]

use cotillion_fuzz::check;
use cotillion_fuzz::clip::read::{Capture, ReadOptions, Up};
use cotillion_fuzz::skeleton::JointRole;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let [format, options, file @ ..] = data else {
        return;
    };
    let capture = match format % 3 {
        0 => Capture::Bvh(file),
        1 => {
            let end = file.iter().position(|&byte| byte == 0).unwrap_or(file.len());
            let motion = file.get(end + 1..).unwrap_or_default();
            Capture::Acclaim { skeleton: &file[..end], motion }
        }
        _ => Capture::DeepMimic(file),
    };
    check(capture, &options_of(*options));
});

fn options_of(byte: u8) -> ReadOptions {
    let has = |bit: u8| byte >> bit & 1 == 1;
    let role = (JointRole::LeftHand, "knee".to_owned());
    ReadOptions {
        fps: has(0).then_some(60.0),
        unit_to_m: has(1).then_some(0.01),
        up: has(2).then_some(if has(3) { Up::Z } else { Up::Y }),
        roles: has(4).then_some(role).into_iter().collect(),
        repair: has(6) || has(7),
    }
}
