use super::{Context, json_path};
use crate::cli::RenderArgs;
use peelnet::Failure;
use peelnet_core::files::{counted, error_line, shown};
use peelnet_render::{
    Frame, ImageFormat, LayerFormula, LayerView, MethodOptions, RenderError, Renderer,
};
use serde_json::json;

pub(super) fn run(context: &Context<'_>, args: &RenderArgs) -> Result<(), Failure> {
    let format = ImageFormat::from_ending(&args.out).map_err(|e| match e {
        RenderError::Image { message, .. } => {
            Failure::wrong(format!("--out {}: {message}", shown(&args.out)))
        }
        e => e.into(),
    })?;
    let mut outputs = context.outputs(args.model.iter().chain([&args.scene]));
    outputs.file("--out", &args.out, format.kind())?;
    let mut scene = context.scene(&args.scene, args.time)?;
    let _begun = context.begin(outputs, std::slice::from_ref(&scene))?;
    let layers = args.highlight.map(|highlight| LayerView {
        highlight,
        increasing: args.increasing,
        formula: args.layers,
    });
    if let Some(LayerView { highlight, .. }) = layers {
        let wrong = |e| Failure::wrong(format!("--highlight {highlight}: {}", error_line(&e)));
        scene = scene.layer_view(highlight, false).map_err(wrong)?;
    }
    let camera = peelnet::view_of(&scene, args.view)?;
    let gpu = context.gpu()?;
    let learned = context.weight(&gpu, &args.method, args.model.as_deref())?;
    let renderer = Renderer::new(&gpu, &scene)?;
    let (method, mut prepared) = match layers {
        Some(view) => {
            let formula = match view.formula {
                LayerFormula::Front => "",
                LayerFormula::Printed => " (formula as printed)",
            };
            let name = format!("layer {}{formula}", view.highlight);
            (name, renderer.layers(view, args.size)?)
        }
        None => {
            let options = MethodOptions::sized(args.size).sampled(args.samples);
            let options = options.with(learned.as_ref());
            let prepared = renderer.method(&args.method, options)?;
            (args.method.to_string(), prepared)
        }
    };
    let frame = renderer.image(&mut prepared, camera)?;
    context.check_interrupt()?;
    frame.image.save(&args.out)?;
    let Frame { image, stats, .. } = &frame;
    for warning in frame.warnings() {
        context.console.warn(format!("{method}: {warning}"));
    }
    context.warn_of_memory(&gpu);
    let adapter = &gpu.info.name;
    let text = || text(args, &method, adapter, &frame);
    context.console.result(text, || {
        json!({
            "out": json_path(&args.out),
            "scene": scene.name,
            "method": method,
            "highlight": args.highlight,
            "time": (!scene.timeline.is_empty()).then_some(scene.time),
            "view": args.view,
            "width": image.width,
            "height": image.height,
            "fragments": stats.fragments,
            "samples": args.samples,
            "max_layers": stats.max_layers,
            "lost": stats.lost,
            "tiles": stats.tiles,
            "geometry_passes": stats.geometry_passes,
            "fullscreen_passes": stats.fullscreen_passes,
            "bytes_per_pixel": stats.bytes_per_pixel,
            "non_finite_pixels": image.non_finite(),
            "time_ms": gpu_ms(&frame),
            "wall_ms": frame.wall_micros / 1e3,
            "passes": frame.times.iter().map(|t| json!({"label": t.label, "micros": t.micros})).collect::<Vec<_>>(),
            "adapter": adapter,
        })
    })
}

/// GPU time of all passes, where the adapter measures it.
fn gpu_ms(frame: &Frame) -> Option<f64> {
    (!frame.times.is_empty()).then(|| frame.times.iter().map(|t| t.micros).sum::<f64>() / 1e3)
}

fn text(args: &RenderArgs, method: &str, adapter: &str, frame: &Frame) -> String {
    let stats = &frame.stats;
    let [width, height] = args.size;
    let fragments = stats.fragments.map(|n| {
        let most = stats
            .max_layers
            .map(|most| format!(", up to {most} a pixel"));
        format!(", {}{}", counted(n, "fragment"), most.unwrap_or_default())
    });
    let samples = match args.samples {
        1 => String::new(),
        n => format!(" with {n} samples a pixel, drawn one after the other"),
    };
    let time = match gpu_ms(frame) {
        None => format!("{:.1} ms by the clock", frame.wall_micros / 1e3),
        Some(ms) => format!("{ms:.1} ms on the GPU"),
    };
    format!(
        "{}: {method} of {}, {width}x{height}{samples}{}; {} geometry and {} full-screen passes, {:.0} bytes a pixel, {time}, on {adapter}",
        shown(&args.out),
        shown(&args.scene),
        fragments.unwrap_or_default(),
        stats.geometry_passes,
        stats.fullscreen_passes,
        stats.bytes_per_pixel,
    )
}
