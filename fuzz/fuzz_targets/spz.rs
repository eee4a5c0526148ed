//! See peelnet_tests::readers, `spz`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| (peelnet_tests::readers::READERS[10].1)(bytes));
