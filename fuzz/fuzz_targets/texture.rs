//! See peelnet_tests::readers, `texture`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| (peelnet_tests::readers::READERS[7].1)(bytes));
