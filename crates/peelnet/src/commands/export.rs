//! `peelnet export`: weights into shader code.

use super::Context;
use crate::cli::{ExportArgs, Precision};
use crate::failure::Failure;
use crate::outputs::Outputs;
use crate::parse::{json_path, shown};
use peelnet_export::Language;
use peelnet_model::Model;
use serde_json::json;

pub(super) fn run(context: &Context<'_>, args: &ExportArgs) -> Result<(), Failure> {
    if args.precision != Precision::F32 {
        return Err(Failure::Usage(
            "--precision f16: this version does not write it yet; use --precision f32".into(),
        ));
    }
    let mut outputs = Outputs::new(context, [&args.model]);
    outputs.file("--out", &args.out, peelnet_export::KIND)?;
    if let Some(description) = peelnet_export::description_path(&args.out) {
        outputs.file("--out", &description, peelnet_export::JSON_KIND)?;
    }
    let language = Language::from(args.lang);
    let model = Model::load(&args.model)?;
    let gpu = context.gpu()?;
    outputs.begin(&[])?;
    let verification = peelnet_export::export(
        &gpu,
        &model,
        &args.out,
        &peelnet_export::Options { language },
    )?;
    context.console.result(
        || {
            format!(
                "{}: {} inputs, verified on {}: {verification}",
                shown(&args.out),
                model.meta.inputs.len(),
                gpu.info.name
            )
        },
        || {
            json!({
                "out": json_path(&args.out),
                "model": json_path(&args.model),
                "recipe": model.meta.recipe,
                "lang": language.name(),
                "precision": "f32",
                "adapter": gpu.info.name,
                "samples": verification.samples,
                "worst_absolute": verification.worst_absolute,
                "worst_relative_to_tolerance": verification.worst_relative_to_tolerance,
            })
        },
    )
}
