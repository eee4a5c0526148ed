//! `peelnet export`: weights into shader code.

use super::Context;
use crate::cli::{ExportArgs, Lang, Precision};
use crate::failure::Failure;
use crate::outputs::Outputs;
use crate::parse::{json_path, shown};
use peelnet_model::Model;
use serde_json::json;

pub(super) fn run(context: &Context<'_>, args: &ExportArgs) -> Result<(), Failure> {
    if args.lang != Lang::Wgsl {
        return Err(not_yet("--lang", &args.lang, "wgsl"));
    }
    if args.precision != Precision::F32 {
        return Err(not_yet("--precision", &args.precision, "f32"));
    }
    let mut outputs = Outputs::new(context, [&args.model]);
    outputs.file("--out", &args.out, peelnet_export::KIND)?;
    let model = Model::load(&args.model)?;
    let gpu = context.gpu()?;
    outputs.begin(&[])?;
    let verification =
        peelnet_export::export(&gpu, &model, &args.out, &peelnet_export::Options::default())?;
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
                "lang": "wgsl",
                "precision": "f32",
                "adapter": gpu.info.name,
                "samples": verification.samples,
                "worst_absolute": verification.worst_absolute,
                "worst_relative_to_tolerance": verification.worst_relative_to_tolerance,
            })
        },
    )
}

fn not_yet(flag: &str, value: &impl clap::ValueEnum, there_is: &str) -> Failure {
    let name = value
        .to_possible_value()
        .map_or_else(String::new, |v| v.get_name().to_owned());
    Failure::Usage(format!(
        "{flag} {name}: this version does not write it yet; use {flag} {there_is}"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::ValueEnum as _;

    #[test]
    fn what_is_missing_is_said_with_what_there_is() {
        let text = not_yet("--lang", &Lang::Glsl, "wgsl").to_string();
        assert!(
            text.contains("glsl") && text.contains("use --lang wgsl"),
            "{text}"
        );
        assert_eq!(Lang::value_variants().len(), 5);
    }
}
