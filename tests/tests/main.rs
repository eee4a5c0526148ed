//! All tests that need more than one crate, in one binary: each further one would link everything again.

#![allow(clippy::unwrap_used, reason = "a failing test may panic")]

mod benching;
mod closed_forms;
mod contours;
mod descriptions;
mod effects;
mod exported_slabs;
mod exported_texts;
mod fuzzed_readers;
mod generated_tables;
mod gpu_faults;
mod languages;
mod learned;
mod library;
mod low_resolution;
mod peeling;
mod pipeline;
mod published_networks;
mod random_lists;
mod ranges;
mod report_in_browser;
mod samples;
mod shader_twins;
mod stress;
mod surfaces;
mod training_on_pixels;
mod voxels;
