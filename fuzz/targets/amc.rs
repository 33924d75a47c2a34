//! Acclaim motions.
#![no_main]

use cotillion_fuzz::clip::read::{Capture, ReadOptions};
use cotillion_fuzz::{ASF, check};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    check(Capture::Acclaim { skeleton: ASF, motion: data }, &ReadOptions::default());
});
