//! Acclaim skeletons.
#![no_main]

use cotillion_fuzz::clip::read::{Capture, ReadOptions};
use cotillion_fuzz::{AMC, check};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    check(Capture::Acclaim { skeleton: data, motion: AMC }, &ReadOptions::default());
});
