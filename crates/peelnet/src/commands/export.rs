//! `peelnet export`: weights into shader code.

use super::Context;
use crate::cli::{ExportArgs, Lang, Precision};
use crate::failure::Failure;
use crate::outputs::Outputs;
use crate::parse::{json_path, shown};
use peelnet_export::Language;
use serde_json::json;

pub(super) fn run(context: &Context<'_>, args: &ExportArgs) -> Result<(), Failure> {
    let mut outputs = Outputs::new(context, [&args.model]);
    outputs.file("--out", &args.out, peelnet_export::KIND)?;
    if let Some(description) = peelnet_export::description_path(&args.out) {
        outputs.file("--out", &description, peelnet_export::JSON_KIND)?;
    }
    let language = Language::from(args.lang);
    let model = peelnet::load_model(&args.model)?;
    let gpu = context.gpu()?;
    outputs.begin(&[])?;
    let options = peelnet_export::Options {
        language,
        precision: args.precision.into(),
    };
    let verification = peelnet_export::export(&gpu, &model, &args.out, &options)?;
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
                "precision": match args.precision {
                    Precision::F32 => "f32",
                    Precision::F16 => "f16",
                },
                "adapter": gpu.info.name,
                "samples": verification.samples,
                "worst_absolute": verification.worst_absolute,
                "worst_relative_to_tolerance": verification.worst_relative_to_tolerance,
            })
        },
    )
}

impl From<Lang> for Language {
    fn from(lang: Lang) -> Self {
        match lang {
            Lang::Wgsl => Self::Wgsl,
            Lang::GlslEs => Self::GlslEs,
            Lang::Glsl => Self::Glsl,
            Lang::Hlsl => Self::Hlsl,
            Lang::Msl => Self::Msl,
        }
    }
}

impl From<Precision> for peelnet_export::Precision {
    fn from(precision: Precision) -> Self {
        match precision {
            Precision::F32 => Self::F32,
            Precision::F16 => Self::F16,
        }
    }
}
