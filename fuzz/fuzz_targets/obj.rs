//! See peelnet_tests::readers, `obj`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| (peelnet_tests::readers::READERS[1].1)(bytes));
