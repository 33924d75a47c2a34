//! DeepMimic motions.
#![no_main]

use cotillion_fuzz::check;
use cotillion_fuzz::clip::read::{Capture, ReadOptions};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    check(Capture::DeepMimic(data), &ReadOptions::default());
});
