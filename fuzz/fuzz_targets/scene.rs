//! See peelnet_tests::readers, `scene`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| (peelnet_tests::readers::READERS[0].1)(bytes));
