//! What a device must be able to do.

use crate::{model::PeelnetModel, shader_text::GROUP};
use bevy::{
    ecs::resource::Resource,
    platform::collections::HashMap,
    render::{
        render_resource::{
            DownlevelFlags, TextureFormat, TextureFormatFeatureFlags, WgpuFeatures, WgpuLimits,
        },
        renderer::{RenderAdapter, RenderDevice},
    },
};

/// Why the present device cannot draw, by samples a pixel. Asked once; another device is asked again.
#[derive(Default, Resource)]
pub(crate) struct Refusals(HashMap<u32, Option<String>>);

impl Refusals {
    pub fn of(
        &mut self,
        model: &PeelnetModel,
        samples: u32,
        device: &RenderDevice,
        adapter: &RenderAdapter,
    ) -> Option<String> {
        let refusal = self.0.entry(samples);
        refusal
            .or_insert_with(|| Abilities::of(device, adapter).refusal(model, samples))
            .clone()
    }
}

/// The abilities that matter, apart from the device for the sake of tests.
pub(crate) struct Abilities {
    pub limits: WgpuLimits,
    pub sample_shading: bool,
    pub flags_of: Box<dyn Fn(TextureFormat) -> TextureFormatFeatureFlags>,
}

impl Abilities {
    pub fn of(device: &RenderDevice, adapter: &RenderAdapter) -> Self {
        let downlevel = adapter.get_downlevel_capabilities();
        let features = device.features();
        let adapter = adapter.clone();
        // What the adapter could do counts only where the device was asked for it.
        let specific = features.contains(WgpuFeatures::TEXTURE_ADAPTER_SPECIFIC_FORMAT_FEATURES);
        Self {
            limits: device.limits(),
            sample_shading: downlevel
                .flags
                .contains(DownlevelFlags::MULTISAMPLED_SHADING),
            flags_of: Box::new(move |format| {
                if specific {
                    adapter.get_texture_format_features(format).flags
                } else {
                    format.guaranteed_format_features(features).flags
                }
            }),
        }
    }

    /// Why this device cannot draw with a network at so many samples a pixel.
    pub fn refusal(&self, model: &PeelnetModel, samples: u32) -> Option<String> {
        let limits = &self.limits;
        let groups = GROUP + 1;
        if (limits.max_bind_groups as usize) < groups {
            return Some(format!(
                "{groups} bind groups are needed (Bevy's four and one for the statistics), the device has {}",
                limits.max_bind_groups
            ));
        }
        for pass in &model.passes {
            let targets = &model.targets[pass.targets.clone()];
            let bytes = PeelnetModel::bytes_of(targets);
            if bytes > limits.max_color_attachment_bytes_per_sample {
                return Some(format!(
                    "pass {:?} writes {bytes} bytes a sample, the device allows {}",
                    pass.name, limits.max_color_attachment_bytes_per_sample
                ));
            }
            if targets.len() > limits.max_color_attachments as usize {
                return Some(format!(
                    "pass {:?} has {} targets, the device allows {}",
                    pass.name,
                    targets.len(),
                    limits.max_color_attachments
                ));
            }
        }
        if samples > 1 && !self.sample_shading {
            return Some(format!(
                "{samples} samples a pixel need shading by sample, which the device cannot do; take Msaa::Off"
            ));
        }
        for format in model.targets.iter().map(|target| target.format) {
            let flags = (self.flags_of)(format);
            if !flags.contains(TextureFormatFeatureFlags::BLENDABLE) {
                return Some(format!("the device cannot blend {format:?}"));
            }
            if samples > 1 && !flags.sample_count_supported(samples) {
                return Some(format!(
                    "the device has no {format:?} with {samples} samples a pixel"
                ));
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_missing_ability_is_named() {
        // Why a device with default limits and five bind groups cannot draw, once it has changed.
        let refusal = |change: fn(&mut Abilities), samples| {
            let usual =
                TextureFormatFeatureFlags::BLENDABLE | TextureFormatFeatureFlags::MULTISAMPLE_X4;
            let mut device = Abilities {
                limits: WgpuLimits {
                    max_bind_groups: 5,
                    ..WgpuLimits::default()
                },
                sample_shading: true,
                flags_of: Box::new(move |_| usual),
            };
            change(&mut device);
            device.refusal(&PeelnetModel::medium(), samples)
        };
        for samples in [1, 4] {
            assert_eq!(refusal(|_| (), samples), None);
        }
        assert_eq!(refusal(|d| d.sample_shading = false, 1), None);
        let changes: [(fn(&mut Abilities), _, _); 5] = [
            (|d| d.limits.max_bind_groups = 4, 1, "5 bind groups"),
            (
                |d| d.limits.max_color_attachment_bytes_per_sample = 16,
                1,
                "24 bytes a sample",
            ),
            (|d| d.limits.max_color_attachments = 2, 1, "3 targets"),
            (|d| d.sample_shading = false, 4, "Msaa::Off"),
            (
                |d| d.flags_of = Box::new(|_| TextureFormatFeatureFlags::empty()),
                1,
                "cannot blend Rg8Unorm",
            ),
        ];
        for (change, samples, says) in changes {
            let text = refusal(change, samples).expect("is refused");
            assert!(text.contains(says), "{text}");
        }
    }
}
