//! See peelnet_tests::readers, `ply`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| (peelnet_tests::readers::READERS[5].1)(bytes));
