//! `peelnet view`: the viewer, where the program was built with it.

use super::Context;
use crate::cli::ViewArgs;
use peelnet::Failure;

#[cfg(not(feature = "view"))]
pub(super) fn run(_: &Context<'_>, _: &ViewArgs) -> Result<(), Failure> {
    Err(Failure::failed(
        "this program was built without the viewer; in the repository: cargo run --release --package peelnet --features view -- view",
    ))
}

#[cfg(feature = "view")]
pub(super) fn run(context: &Context<'_>, args: &ViewArgs) -> Result<(), Failure> {
    use peelnet_core::files::shown;
    use peelnet_render::ImageFormat;
    use peelnet_view::{Script, Start};

    let camera = args.camera.as_deref().map(peelnet_view::camera_numbers);
    let camera = camera
        .transpose()
        .map_err(|e| Failure::wrong(format!("--camera: {e}")))?;
    let mut outputs = context.outputs(args.model.iter().chain([&args.scene]).chain(&args.dataset));
    if let Some(path) = &args.screenshot {
        if !matches!(ImageFormat::from_ending(path), Ok(ImageFormat::Png)) {
            return Err(Failure::wrong(format!(
                "--screenshot {}: is a PNG file; let its name end in .png",
                shown(path)
            )));
        }
        outputs.file("--screenshot", path, ImageFormat::Png.kind())?;
    }
    let _begun = context.begin(outputs, &[])?;
    let is_script = args.frames.is_some() || args.screenshot.is_some();
    // A script has nobody who reads messages in the window: what does not load ends it here.
    let mut loaded = None;
    if is_script {
        let scene = context.scene(&args.scene, args.time)?;
        peelnet::view_of(&scene, args.view)?;
        loaded = Some(scene);
    }
    let gpu = context.gpu()?;
    if is_script {
        context.weight(&gpu, &args.method, args.model.as_deref())?;
    }
    let start = Start {
        loaded,
        model: args.model.clone(),
        view: args.view as usize,
        camera,
        compare: args.compare.parse().map_err(Failure::wrong)?,
        against: Some(args.against.clone()),
        time: args.time,
        files_from: context.global.files_from.clone(),
        bare: args.bare,
        dataset: args.dataset.clone(),
        train: args.train,
        script: is_script.then(|| Script::new(args.frames, args.screenshot.clone())),
        ..Start::new(&args.scene, args.method.clone())
    };
    let costs = peelnet_view::open(&gpu, start, args.size).map_err(Failure::failed)?;
    if let Some(costs) = costs.filter(|_| args.frames.is_some() || args.train.is_some()) {
        context.console.message(costs);
    }
    if let Some(path) = &args.screenshot {
        let message = format!("{} is written", shown(path));
        context.console.message(message);
    }
    Ok(())
}
