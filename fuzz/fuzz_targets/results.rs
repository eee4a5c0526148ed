//! See peelnet_tests::readers, `results`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| (peelnet_tests::readers::READERS[8].1)(bytes));
