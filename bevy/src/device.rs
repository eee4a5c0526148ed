//! What a device must be able to do.

use crate::model::{Pass, PeelnetModel, Target};
use bevy::{
    ecs::resource::Resource,
    platform::collections::HashMap,
    render::{
        render_resource::{DownlevelFlags, TextureFormatFeatureFlags, WgpuFeatures},
        renderer::{RenderAdapter, RenderDevice},
    },
};

/// Why the present device cannot draw, by samples a pixel. Asked once; another device is asked again.
#[derive(Default, Resource)]
pub(crate) struct Refusals(pub HashMap<u32, Option<String>>);

/// Why this device cannot draw with a network at so many samples a pixel.
pub(crate) fn refusal_of(
    model: &PeelnetModel,
    samples: u32,
    device: &RenderDevice,
    adapter: &RenderAdapter,
) -> Option<String> {
    let limits = device.limits();
    let cost = |target: &Target| target.format.target_pixel_byte_cost().unwrap_or_default();
    for Pass { name, targets, .. } in &model.description.passes {
        for (found, what, allowed) in [
            (
                targets.iter().map(cost).sum(),
                "bytes a sample",
                limits.max_color_attachment_bytes_per_sample,
            ),
            (
                targets.len() as u32,
                "targets",
                limits.max_color_attachments,
            ),
        ] {
            if found > allowed {
                return Some(format!(
                    "pass {name:?} writes {found} {what}, the device allows {allowed}"
                ));
            }
        }
    }
    let downlevel = adapter.get_downlevel_capabilities().flags;
    if samples > 1 && !downlevel.contains(DownlevelFlags::MULTISAMPLED_SHADING) {
        return Some(format!(
            "{samples} samples a pixel need shading by sample, which the device cannot do; take Msaa::Off"
        ));
    }
    let features = device.features();
    for (format, every) in model
        .targets()
        .map(|(target, every)| (target.format, every))
    {
        // What the adapter could do counts only where the device was asked for it.
        let flags = if features.contains(WgpuFeatures::TEXTURE_ADAPTER_SPECIFIC_FORMAT_FEATURES) {
            adapter.get_texture_format_features(format).flags
        } else {
            format.guaranteed_format_features(features).flags
        };
        if !flags.contains(TextureFormatFeatureFlags::BLENDABLE) {
            return Some(format!("the device cannot blend {format:?}"));
        }
        if samples > 1 && every == 1 && !flags.sample_count_supported(samples) {
            return Some(format!(
                "the device has no {format:?} with {samples} samples a pixel"
            ));
        }
    }
    None
}
