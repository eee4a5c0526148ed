//! See peelnet_tests::readers, `model`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| (peelnet_tests::readers::READERS[3].1)(bytes));
