//! All tests that need more than one crate, in one binary: each further one would link everything again.

#![allow(clippy::unwrap_used, reason = "a failing test may panic")]

mod benching;
mod contours;
mod effects;
mod exported;
mod fuzzed_readers;
mod generated_tables;
mod gpu_faults;
mod library;
mod methods;
mod peeling;
mod pictures;
mod pipeline;
mod random_lists;
mod ranges;
mod references;
mod report_in_browser;
mod samples;
mod shader_functions;
mod splats;
mod surfaces;
mod tiles;
mod training_on_pixels;
mod voxels;
