//! See peelnet_tests::readers, `dataset`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| (peelnet_tests::readers::READERS[2].1)(bytes));
