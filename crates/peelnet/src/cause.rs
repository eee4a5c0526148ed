//! What an error was caused by, wherever in its chain that stands.

use peelnet_dataset::DatasetError;
use peelnet_eval::EvalError;
use peelnet_gpu::GpuError;
use peelnet_peel::PeelError;
use peelnet_render::RenderError;
use std::error::Error;

/// What `of` finds in an error of its type. Sources in a box are seen as the box.
pub fn find<E: Error + 'static, T>(
    error: &(dyn Error + 'static),
    of: impl Fn(&E) -> Option<T>,
) -> Option<T> {
    let boxed = || error.downcast_ref::<Box<E>>().map(|b| &**b);
    error.downcast_ref::<E>().or_else(boxed).and_then(of)
}

/// Whether the cause is a wrong value that the caller gave: the command line then ends with exit code 2, and Python raises `ValueError`.
pub fn is_wrong_value(error: &(dyn Error + 'static)) -> bool {
    let names = |error: &EvalError| matches!(error, EvalError::SameName { .. }).then_some(());
    let method = |error: &RenderError| match error {
        RenderError::Parameter { .. } | RenderError::UnknownMethod { .. } => Some(()),
        _ => None,
    };
    let wrong = |error: &PeelError| match error {
        PeelError::NoScene
        | PeelError::SameName { .. }
        | PeelError::TooFewViews { .. }
        | PeelError::Fraction(_)
        | PeelError::TooManyLists(_)
        | PeelError::Dataset(DatasetError::TooManyItems { .. }) => Some(()),
        _ => None,
    };
    let adapter = |error: &GpuError| matches!(error, GpuError::NoSuchAdapter { .. }).then_some(());
    find(error, wrong)
        .or_else(|| find(error, adapter))
        .or_else(|| find(error, names))
        .or_else(|| find(error, method))
        .is_some()
        || is_wrong_setting(error)
}

#[cfg(feature = "train")]
fn is_wrong_setting(error: &(dyn Error + 'static)) -> bool {
    use peelnet_train::TrainError;
    let setting = |error: &TrainError| match error {
        TrainError::Config { .. } | TrainError::CurveFormat(_) => Some(()),
        _ => None,
    };
    find(error, setting).is_some()
}

#[cfg(not(feature = "train"))]
fn is_wrong_setting(_: &(dyn Error + 'static)) -> bool {
    false
}
