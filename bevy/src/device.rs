//! What a device must be able to do.

use crate::{
    model::{Format, PeelnetModel},
    pipelines::texture_format,
    shader_text::GROUP,
};
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
            let bytes: u32 = targets.iter().map(|t| t.format.bytes()).sum();
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
        let mut formats: Vec<Format> = model.targets.iter().map(|t| t.format).collect();
        formats.dedup();
        for format in formats {
            let flags = (self.flags_of)(texture_format(format));
            if !flags.contains(TextureFormatFeatureFlags::BLENDABLE) {
                return Some(format!("the device cannot blend {}", format.name()));
            }
            if samples > 1 && !flags.sample_count_supported(samples) {
                return Some(format!(
                    "the device has no {} with {samples} samples a pixel",
                    format.name()
                ));
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plain() -> Abilities {
        Abilities {
            limits: WgpuLimits {
                max_bind_groups: 8,
                ..WgpuLimits::default()
            },
            sample_shading: true,
            flags_of: Box::new(|_| {
                TextureFormatFeatureFlags::BLENDABLE | TextureFormatFeatureFlags::MULTISAMPLE_X4
            }),
        }
    }

    #[test]
    fn a_device_with_default_limits_and_five_bind_groups_will_do() {
        for model in [
            PeelnetModel::small(),
            PeelnetModel::medium(),
            PeelnetModel::large(),
        ] {
            assert_eq!(plain().refusal(&model, 1), None);
            assert_eq!(plain().refusal(&model, 4), None);
        }
    }

    #[test]
    fn each_missing_ability_is_named() {
        let medium = PeelnetModel::medium();
        let mut device = plain();
        device.limits.max_bind_groups = 4;
        let text = device.refusal(&medium, 1).expect("is refused");
        assert!(text.contains("5 bind groups"), "{text}");

        let mut device = plain();
        device.limits.max_color_attachment_bytes_per_sample = 16;
        let text = device.refusal(&medium, 1).expect("is refused");
        assert!(text.contains("24 bytes a sample"), "{text}");

        let mut device = plain();
        device.limits.max_color_attachments = 2;
        let text = device.refusal(&medium, 1).expect("is refused");
        assert!(text.contains("3 targets"), "{text}");

        let mut device = plain();
        device.sample_shading = false;
        assert_eq!(device.refusal(&medium, 1), None);
        let text = device.refusal(&medium, 4).expect("is refused");
        assert!(text.contains("Msaa::Off"), "{text}");

        let mut device = plain();
        device.flags_of = Box::new(|_| TextureFormatFeatureFlags::empty());
        let text = device.refusal(&medium, 1).expect("is refused");
        assert!(text.contains("cannot blend rg8unorm"), "{text}");
    }
}
