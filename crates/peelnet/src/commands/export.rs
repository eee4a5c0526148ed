use super::{Context, json_path};
use crate::cli::ExportArgs;
use peelnet::{Failure, PRECISIONS};
use peelnet_core::files::shown;
use peelnet_export::Language;
use serde_json::json;

pub(super) fn run(context: &Context<'_>, args: &ExportArgs) -> Result<(), Failure> {
    let said = Language::from_ending(&args.out);
    let language = args.lang.or(said).unwrap_or_default();
    if let Some(said) = said.filter(|said| !language.extension().ends_with(said.extension())) {
        return Err(Failure::wrong(format!(
            "--out {}: the ending says {said}, --lang says {language}; let the name end in .{}",
            shown(&args.out),
            language.extension()
        )));
    }
    let mut outputs = context.outputs([&args.model]);
    outputs.file("--out", &args.out, peelnet_export::KIND)?;
    if let Some(description) = peelnet_export::description_path(&args.out) {
        outputs.file("--out", &description, peelnet_export::JSON_KIND)?;
    }
    let model = peelnet::load_model(&args.model)?;
    let other = peelnet_export::other_described(&model, &args.out)?;
    if let Some(other) = other.filter(|_| !context.global.force) {
        return Err(Failure::failed(format!(
            "--out {}: the description beside it is that of another network's {}; choose another name, or replace it with --force",
            shown(&args.out),
            shown(&other)
        )));
    }
    let gpu = context.gpu()?;
    let _begun = context.begin(outputs, &[])?;
    let options = peelnet_export::Options {
        language,
        precision: args.precision,
    };
    let verification = peelnet_export::export(&gpu, &model, &args.out, &options)?;
    let inputs = model.meta.inputs.len();
    let adapter = &gpu.info.name;
    let precision = PRECISIONS.iter().find(|(_, p)| *p == args.precision);
    let text = || {
        let out = shown(&args.out);
        format!("{out}: {inputs} inputs, verified on {adapter}: {verification}")
    };
    context.console.result(text, || {
        json!({
            "out": json_path(&args.out),
            "model": json_path(&args.model),
            "recipe": model.meta.recipe,
            "lang": language.name(),
            "precision": precision.map(|(name, _)| name),
            "adapter": adapter,
            "samples": verification.samples,
            "worst_absolute": verification.worst_absolute,
            "worst_relative_to_tolerance": verification.worst_relative_to_tolerance,
        })
    })
}
