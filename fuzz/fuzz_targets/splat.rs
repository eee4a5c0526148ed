//! See peelnet_tests::readers, `splat`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| (peelnet_tests::readers::READERS[9].1)(bytes));
