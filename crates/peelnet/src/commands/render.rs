//! `peelnet render`: one frame with one method.

use super::Context;
use crate::cli::{LayersChoice, RenderArgs};
use crate::failure::{Failure, one_line};
use crate::learned;
use crate::outputs::Outputs;
use crate::parse::{json_path, shown};
use peelnet_files::counted;
use peelnet_render::{
    Frame, ImageFormat, LayerFormula, LayerView, MethodOptions, RenderError, Renderer,
};
use serde_json::json;

pub(super) fn run(context: &Context<'_>, args: &RenderArgs) -> Result<(), Failure> {
    let format = ImageFormat::of(&args.out).map_err(|e| match e {
        RenderError::Image { message, .. } => {
            Failure::Usage(format!("--out {}: {message}", shown(&args.out)))
        }
        e => e.into(),
    })?;
    let inputs = args.model.iter().chain([&args.scene]);
    let mut outputs = Outputs::new(context, inputs);
    outputs.file("--out", &args.out, format.kind())?;
    let mut scene = context.scene_at(&args.scene, args.time)?;
    outputs.begin(std::slice::from_ref(&scene))?;
    let layers = args.highlight.map(|highlight| LayerView {
        highlight,
        increasing: args.increasing,
        formula: match args.layers {
            LayersChoice::Front => LayerFormula::Front,
            LayersChoice::Printed => LayerFormula::Printed,
        },
    });
    if let Some(view) = layers {
        scene = scene.layer_view(view.highlight, false).map_err(|e| {
            Failure::Usage(format!("--highlight {}: {}", view.highlight, one_line(&e)))
        })?;
    }
    let camera = scene.views.get(args.view as usize).ok_or_else(|| {
        Failure::Usage(format!(
            "--view {}: {} has {}, numbered from 0",
            args.view,
            shown(&args.scene),
            counted(scene.views.len() as u64, "view")
        ))
    })?;
    let gpu = context.gpu()?;
    let learned = learned::weight_of(context.console, &gpu, &args.method, args.model.as_deref())?;
    let renderer = Renderer::new(&gpu, &scene)?;
    let mut prepared = match layers {
        Some(view) => renderer.layers(view, args.size.0)?,
        None => renderer.method(
            &args.method,
            MethodOptions::sized(args.size.0)
                .sampled(args.samples)
                .with(learned.as_ref()),
        )?,
    };
    let method = layers.map_or_else(
        || args.method.to_string(),
        |view| match view.formula {
            LayerFormula::Front => format!("layer {}", view.highlight),
            LayerFormula::Printed => format!("layer {} (formula as printed)", view.highlight),
        },
    );
    let frame = renderer.image(&mut prepared, camera)?;
    context.check_interrupt()?;
    frame.image.save(&args.out)?;
    if frame.stats.lost > 0 {
        context.console.warn(format!(
            "{method}: not in the image: {}",
            counted(frame.stats.lost, "fragment")
        ));
    }
    context.warn_of_memory(&gpu);
    if frame.image.non_finite() > 0 {
        context.console.warn(format!(
            "{method}: not finite: {}",
            counted(frame.image.non_finite() as u64, "pixel")
        ));
    }
    context.console.result(
        || text(args, &method, &gpu.info.name, &frame),
        || {
            json!({
                "out": json_path(&args.out),
                "scene": scene.name,
                "method": method,
                "highlight": args.highlight,
                "time": (!scene.timeline.is_empty()).then_some(scene.time),
                "view": args.view,
                "width": frame.image.width,
                "height": frame.image.height,
                "fragments": frame.stats.fragments,
                "samples": args.samples,
                "max_layers": frame.stats.max_layers,
                "lost": frame.stats.lost,
                "tiles": frame.stats.tiles,
                "geometry_passes": frame.stats.geometry_passes,
                "fullscreen_passes": frame.stats.fullscreen_passes,
                "bytes_per_pixel": frame.stats.bytes_per_pixel,
                "non_finite_pixels": frame.image.non_finite(),
                "time_ms": gpu_ms(&frame),
                "wall_ms": frame.wall_micros / 1e3,
                "passes": frame.times.iter().map(|t| json!({"label": t.label, "micros": t.micros})).collect::<Vec<_>>(),
                "adapter": gpu.info.name,
            })
        },
    )
}

/// GPU time of all passes, where the adapter measures it.
fn gpu_ms(frame: &Frame) -> Option<f64> {
    (!frame.times.is_empty()).then(|| frame.times.iter().map(|t| t.micros).sum::<f64>() / 1e3)
}

fn text(args: &RenderArgs, method: &str, adapter: &str, frame: &Frame) -> String {
    let fragments = frame.stats.fragments.map_or_else(String::new, |n| {
        let most = frame.stats.max_layers;
        let most = most.map_or_else(String::new, |most| format!(", up to {most} a pixel"));
        format!(", {}{most}", counted(n, "fragment"))
    });
    let samples = match args.samples {
        1 => String::new(),
        n => format!(" with {n} samples a pixel, drawn one after the other"),
    };
    let time = gpu_ms(frame).map_or_else(
        || format!("{:.1} ms by the clock", frame.wall_micros / 1e3),
        |ms| format!("{ms:.1} ms on the GPU"),
    );
    format!(
        "{}: {method} of {}, {}{samples}{fragments}; {} geometry and {} full-screen passes, {:.0} bytes a pixel, {time}, on {adapter}",
        shown(&args.out),
        shown(&args.scene),
        args.size,
        frame.stats.geometry_passes,
        frame.stats.fullscreen_passes,
        frame.stats.bytes_per_pixel,
    )
}
