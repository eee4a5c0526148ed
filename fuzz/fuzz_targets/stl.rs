//! See peelnet_tests::readers, `stl`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| (peelnet_tests::readers::READERS[6].1)(bytes));
