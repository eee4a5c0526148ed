use peelnet_gpu::Gpu;
use serde::{Deserialize, Serialize};

/// What a result was measured on.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Machine {
    /// Operating system.
    pub os: String,
    /// Processor architecture.
    pub arch: String,
    /// Processor name, where the system says it.
    pub cpu: String,
    /// Logical cores that the process may use.
    pub cores: usize,
    /// GPU adapter.
    pub adapter: String,
    /// `discrete`, `integrated`, `virtual`, `software` or `other`.
    pub adapter_kind: String,
    /// `vulkan`, `metal`, …
    pub backend: String,
    /// Driver name and version.
    pub driver: String,
    /// Version of this program.
    pub peelnet: String,
    /// `debug` or `release`.
    pub build: String,
}

impl Machine {
    /// This machine, with an open device.
    pub fn of(gpu: &Gpu) -> Self {
        Self {
            os: std::env::consts::OS.to_owned(),
            arch: std::env::consts::ARCH.to_owned(),
            cpu: cpu_name(),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            adapter: gpu.info.name.clone(),
            adapter_kind: peelnet_gpu::adapter::kind_name(gpu.info.device_type).to_owned(),
            backend: gpu.info.backend.to_string(),
            driver: format!("{} {}", gpu.info.driver, gpu.info.driver_info)
                .trim()
                .to_owned(),
            peelnet: env!("CARGO_PKG_VERSION").to_owned(),
            build: if cfg!(debug_assertions) {
                "debug"
            } else {
                "release"
            }
            .to_owned(),
        }
    }

    /// The sentence under a table of figures.
    pub(crate) fn credit(&self, command: &str) -> String {
        format!(
            "Measured on {} ({}, {} cores) with `{command}`.",
            self.adapter, self.cpu, self.cores
        )
    }

    /// Name and value of each property, for tables.
    pub fn lines(&self) -> Vec<(&'static str, String)> {
        vec![
            (
                "adapter",
                format!("{} ({})", self.adapter, self.adapter_kind),
            ),
            ("driver", format!("{}, {}", self.backend, self.driver)),
            ("processor", format!("{}, {} cores", self.cpu, self.cores)),
            ("system", format!("{} {}", self.os, self.arch)),
            (
                "peelnet",
                format!("{} ({} build)", self.peelnet, self.build),
            ),
        ]
    }
}

/// How many programs wanted to run on this machine in the last minute, on average, where the system says it (Linux).
pub fn load() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/loadavg").ok()?;
    text.split_whitespace().next()?.parse().ok()
}

/// The processor's name on Linux; elsewhere no portable source exists.
fn cpu_name() -> String {
    std::fs::read_to_string("/proc/cpuinfo")
        .ok()
        .and_then(|text| {
            text.lines()
                .find(|line| line.starts_with("model name"))
                .and_then(|line| line.split_once(':'))
                .map(|(_, name)| name.trim().to_owned())
        })
        .unwrap_or_else(|| "unknown".to_owned())
}
