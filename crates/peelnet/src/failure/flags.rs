//! Which flag a library's error depends on.

use peelnet::cause::find;
use peelnet_dataset::DatasetError;
use peelnet_eval::EvalError;
use peelnet_export::ExportError;
use peelnet_gpu::GpuError;
use peelnet_peel::PeelError;
use peelnet_raster::RasterError;
use peelnet_render::RenderError;
use peelnet_train::TrainError;
use std::error::Error;

/// What to do about an error, in terms of flags: of the first error in its chain that depends on one.
pub(super) fn hint(error: &(dyn Error + 'static)) -> Option<&'static str> {
    let mut next = Some(error);
    while let Some(error) = next {
        let hint = find(error, gpu)
            .or_else(|| find(error, render))
            .or_else(|| find(error, peel))
            .or_else(|| find(error, dataset))
            .or_else(|| find(error, train))
            .or_else(|| find(error, export))
            .or_else(|| find(error, eval));
        if hint.is_some() {
            return hint;
        }
        next = error.source();
    }
    None
}

fn gpu(error: &GpuError) -> Option<&'static str> {
    match error {
        GpuError::NoSuchAdapter { .. } => Some("choose one with --adapter, or leave the flag out"),
        GpuError::OutOfMemory { .. } | GpuError::Lost(_) => Some("--adapter software"),
        GpuError::MissingFeature { what, .. } | GpuError::TooLarge { what, .. }
            if what.starts_with("dual depth peeling") =>
        {
            Some("--peel sbuffer or --peel single")
        }
        _ => None,
    }
}

fn render(error: &RenderError) -> Option<&'static str> {
    match error {
        // Transparent errors stand for what they wrap, and are not in the chain twice.
        RenderError::Gpu(error) => gpu(error),
        RenderError::NeedsModel(_) => Some("give its model file with --model"),
        _ => None,
    }
}

fn peel(error: &PeelError) -> Option<&'static str> {
    match error {
        PeelError::Raster(RasterError::Gpu(error)) => gpu(error),
        PeelError::Gpu(error) => gpu(error),
        PeelError::Dataset(error) => dataset(error),
        PeelError::TooFewViews { .. } => Some("set it with --views"),
        PeelError::Fraction(_) => Some("set it with --pixels"),
        PeelError::TooManyLists(_) => Some("set it with --synthetic"),
        _ => None,
    }
}

fn dataset(error: &DatasetError) -> Option<&'static str> {
    match error {
        DatasetError::TooManyItems { .. } => Some("lower --augment or --views"),
        _ => None,
    }
}

fn train(error: &TrainError) -> Option<&'static str> {
    match error {
        TrainError::Checkpoint { .. } => Some("leave out --resume to start again"),
        TrainError::Dataset(error) => dataset(error),
        TrainError::Config { setting, .. } => match *setting {
            "epochs" => Some("set it with --epochs"),
            "batch" => Some("set it with --batch"),
            "hidden" => Some("set it with --hidden"),
            "max_rows" => Some("set it with --max-rows"),
            "buffer_rows" => Some("set it with --buffer-rows"),
            "learning_rate" => Some("set it with --lr"),
            "patience" => Some("set it with --patience"),
            "loss" => Some("set it with --loss"),
            _ => None,
        },
        _ => None,
    }
}

fn export(error: &ExportError) -> Option<&'static str> {
    match error {
        ExportError::Gpu(error) => gpu(error),
        _ => None,
    }
}

fn eval(error: &EvalError) -> Option<&'static str> {
    match error {
        EvalError::Resume { .. } => Some("leave out --resume to start again"),
        _ => None,
    }
}
