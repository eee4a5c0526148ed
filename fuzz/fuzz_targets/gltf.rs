//! See peelnet_tests::readers, `gltf`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| (peelnet_tests::readers::READERS[4].1)(bytes));
