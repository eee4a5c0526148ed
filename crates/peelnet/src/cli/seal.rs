//! The flags of `peelnet seal`.

use clap::Args;
use std::path::PathBuf;

/// `peelnet seal`.
#[derive(Clone, Debug, Args)]
#[command(after_help = "Examples:
  peelnet seal d
  peelnet seal d --json | jq .hash

Parts are written by peelnet extract --shard and --resume; whoever writes the last one seals the dataset. This command does it where that
writer was stopped, and reports what is missing or wrong, with the part and its worker. A sealed dataset stays as it is.")]
pub struct SealArgs {
    /// The dataset
    #[arg(value_name = "DATASET")]
    pub dataset: PathBuf,
}
