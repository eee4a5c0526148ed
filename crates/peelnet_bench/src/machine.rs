use crate::Machine;
use peelnet_render::gpu::Gpu;
use sysinfo::{CpuRefreshKind, MemoryRefreshKind, RefreshKind, System};

impl Machine {
    pub fn describe(gpu: &Gpu) -> Self {
        let system = System::new_with_specifics(
            RefreshKind::nothing()
                .with_cpu(CpuRefreshKind::nothing())
                .with_memory(MemoryRefreshKind::nothing().with_ram()),
        );
        let cpu = system.cpus().first().map_or("", |cpu| cpu.brand().trim());
        let info = &gpu.info;
        let build = ["release", "debug"][usize::from(cfg!(debug_assertions))];
        let driver = format!("{} {}", info.driver, info.driver_info);
        Self {
            os: std::env::consts::OS.to_owned(),
            arch: std::env::consts::ARCH.to_owned(),
            cpu: if cpu.is_empty() { "unknown" } else { cpu }.to_owned(),
            // Unlike sysinfo's count, this one respects the limits of a container.
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            memory: system.total_memory(),
            adapter: info.name.clone(),
            adapter_kind: peelnet_render::gpu::adapter::kind_name(info.device_type).to_owned(),
            backend: info.backend.to_string(),
            driver: driver.trim().to_owned(),
            peelnet: env!("CARGO_PKG_VERSION").to_owned(),
            build: build.to_owned(),
        }
    }
}

/// How many programs wanted to run in the last minute, on average. Windows does not report it.
pub fn load() -> Option<f64> {
    (!cfg!(windows)).then(|| System::load_average().one)
}
