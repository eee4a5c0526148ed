//! Which adapters there are, and which one is used.

use crate::gpu::GpuError;
use serde::Serialize;
use std::{convert::Infallible, str::FromStr};

/// How to get a driver where there is none.
pub const INSTALL_HINT: &str = "on Debian or Ubuntu run: sudo apt-get install -y mesa-vulkan-drivers libvulkan1 \
     (Mesa lavapipe, a software rasteriser); elsewhere install your GPU vendor's Vulkan driver";

/// Where the Vulkan loader of a Linux system looks for drivers.
const DRIVER_FOLDERS: [&str; 3] = [
    "/usr/share/vulkan/icd.d",
    "/usr/local/share/vulkan/icd.d",
    "/etc/vulkan/icd.d",
];

/// Why there is no adapter: a driver that is installed and does not start needs another fix than none.
pub fn why_none() -> String {
    let installed = DRIVER_FOLDERS
        .iter()
        .filter_map(|folder| std::fs::read_dir(folder).ok())
        .any(|mut folder| folder.next().is_some());
    if installed {
        return "a Vulkan driver is installed, but none starts: is memory short or limited (ulimit -v), or does VK_DRIVER_FILES or \
                VK_ICD_FILENAMES name another one? vulkaninfo says more"
            .to_owned();
    }
    format!("no Vulkan driver is installed; {INSTALL_HINT}")
}

/// Which adapter to use.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum AdapterRequest {
    /// The fastest kind: discrete before integrated before virtual before software.
    #[default]
    Auto,
    /// A software rasteriser such as Mesa lavapipe.
    Software,
    /// The first adapter whose name contains this text, whatever its case.
    Named(String),
}

impl FromStr for AdapterRequest {
    type Err = Infallible;

    fn from_str(s: &str) -> Result<Self, Infallible> {
        Ok(match s {
            "auto" => Self::Auto,
            "software" => Self::Software,
            name => Self::Named(name.to_owned()),
        })
    }
}

/// An optional feature: what uses it and what its absence costs.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct OptionalFeature {
    /// WebGPU's name of it.
    pub name: &'static str,
    /// What we use it for and what happens without it.
    pub without: &'static str,
    /// The wgpu flag.
    #[serde(skip)]
    pub flag: wgpu::Features,
}

/// Every optional feature that a device is opened with where it exists.
pub(crate) const OPTIONAL_FEATURES: &[OptionalFeature] = &[
    OptionalFeature {
        name: "float32-blendable",
        without: "dual depth peeling and 32-bit blending targets are unavailable; use sbuffer or single peeling and 16-bit targets",
        flag: wgpu::Features::FLOAT32_BLENDABLE,
    },
    OptionalFeature {
        name: "timestamp-query",
        without: "GPU time per pass is not reported; whole-frame times come from the clock",
        flag: wgpu::Features::TIMESTAMP_QUERY,
    },
    OptionalFeature {
        name: "shader-f16",
        without: "functions exported in 16-bit precision cannot be verified here",
        flag: wgpu::Features::SHADER_F16,
    },
];

/// One adapter, as `peelnet doctor` shows it.
#[derive(Clone, Debug, Serialize)]
pub struct AdapterReport {
    /// Name the driver gives.
    pub name: String,
    /// `discrete`, `integrated`, `virtual`, `software` or `other`.
    pub kind: &'static str,
    /// `vulkan`, `metal`, …
    pub backend: String,
    /// Driver name and version.
    pub driver: String,
    /// Optional features it has.
    pub features: Vec<&'static str>,
    /// Optional features it lacks, with what that costs.
    pub missing: Vec<OptionalFeature>,
    /// Largest storage binding in bytes: bounds the fragments of one tile.
    pub max_storage_binding: u64,
    /// Largest texture side in pixels.
    pub max_texture_side: u32,
    /// Whether [`AdapterRequest::Auto`] picks it.
    pub chosen: bool,
    /// Why it is chosen or not.
    pub why: &'static str,
}

/// The kinds of adapters with their words, the one that [`AdapterRequest::Auto`] prefers first.
const KINDS: [(wgpu::DeviceType, &str); 5] = [
    (wgpu::DeviceType::DiscreteGpu, "discrete"),
    (wgpu::DeviceType::IntegratedGpu, "integrated"),
    (wgpu::DeviceType::VirtualGpu, "virtual"),
    (wgpu::DeviceType::Other, "other"),
    (wgpu::DeviceType::Cpu, "software"),
];

/// Word for an adapter's kind.
pub fn kind_name(kind: wgpu::DeviceType) -> &'static str {
    KINDS[rank(kind)].1
}

fn rank(kind: wgpu::DeviceType) -> usize {
    let found = KINDS.iter().position(|(k, _)| *k == kind);
    found.unwrap_or_default()
}

/// All adapters, best first.
pub(crate) async fn enumerate() -> (wgpu::Instance, Vec<wgpu::Adapter>) {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends: wgpu::Backends::PRIMARY,
        // wgpu validates by itself; the distribution's Vulkan layers are often too old for its SPIR-V.
        flags: wgpu::InstanceFlags::empty(),
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    });
    let mut adapters = instance.enumerate_adapters(wgpu::Backends::PRIMARY).await;
    adapters.sort_by_key(|a| rank(a.get_info().device_type));
    (instance, adapters)
}

pub(crate) fn pick(
    adapters: Vec<wgpu::Adapter>,
    request: &AdapterRequest,
) -> Result<wgpu::Adapter, GpuError> {
    if adapters.is_empty() {
        return Err(GpuError::NoAdapter);
    }
    let names: Vec<_> = adapters.iter().map(|a| a.get_info().name).collect();
    let (wanted, found) = match request {
        AdapterRequest::Auto => ("auto", Some(0)),
        AdapterRequest::Software => {
            let is_software = |a: &wgpu::Adapter| a.get_info().device_type == wgpu::DeviceType::Cpu;
            ("software", adapters.iter().position(is_software))
        }
        AdapterRequest::Named(name) => {
            let text = name.to_lowercase();
            let is_named = |n: &String| n.to_lowercase().contains(&text);
            (name.as_str(), names.iter().position(is_named))
        }
    };
    let found = found.and_then(|place| adapters.into_iter().nth(place));
    found.ok_or_else(|| GpuError::NoSuchAdapter {
        wanted: wanted.to_owned(),
        available: names.join(", "),
    })
}

/// What `peelnet doctor` prints. Empty where no driver is installed.
#[cfg(not(target_arch = "wasm32"))]
pub fn report() -> Vec<AdapterReport> {
    let (_instance, adapters) = pollster::block_on(enumerate());
    adapters
        .iter()
        .enumerate()
        .map(|(i, adapter)| {
            let info = adapter.get_info();
            let (has, lacks): (Vec<OptionalFeature>, Vec<OptionalFeature>) = OPTIONAL_FEATURES
                .iter()
                .copied()
                .partition(|f| adapter.features().contains(f.flag));
            AdapterReport {
                name: info.name,
                kind: kind_name(info.device_type),
                backend: info.backend.to_string(),
                driver: format!("{} {}", info.driver, info.driver_info),
                features: has.iter().map(|f| f.name).collect(),
                missing: lacks,
                max_storage_binding: adapter.limits().max_storage_buffer_binding_size,
                max_texture_side: adapter.limits().max_texture_dimension_2d,
                chosen: i == 0,
                why: match (i, info.device_type) {
                    (0, wgpu::DeviceType::Cpu) => "the only kind there is: software rasteriser",
                    (0, _) => "first in the order discrete, integrated, virtual, other, software",
                    _ => "comes later in the order discrete, integrated, virtual, other, software",
                },
            }
        })
        .collect()
}
