//! `peelnet seal`: finished parts into one dataset.

use super::Context;
use crate::cli::SealArgs;
use crate::failure::Failure;
use crate::parse::{json_path, shown};
use peelnet_files::counted;
use serde_json::json;

pub(super) fn run(context: &Context<'_>, args: &SealArgs) -> Result<(), Failure> {
    let m = peelnet_dataset::seal(&args.dataset)?;
    context.console.result(
        || {
            format!(
                "{}: sealed, {} of {} in {}, hash {}",
                shown(&args.dataset),
                counted(m.rows, "row"),
                counted(m.pixels, "pixel"),
                counted(m.parts.len() as u64, "part"),
                m.hash
            )
        },
        || {
            json!({
                "dataset": json_path(&args.dataset),
                "rows": m.rows,
                "pixels": m.pixels,
                "parts": m.parts.len(),
                "hash": m.hash,
                "plan": m.plan,
                "lost_fragments": m.lost_fragments,
                "coplanar_ties": m.coplanar_ties,
                "rows_by_scene": m.rows_by_scene(),
                "adapter": m.adapter,
            })
        },
    )
}
