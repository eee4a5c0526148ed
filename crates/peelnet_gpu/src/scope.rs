//! Which adapters a statement is about, such as a known flaw of a driver.

/// A set of adapters. Every field that is set must match; the empty scope is every adapter.
///
/// wgpu scopes its expected test failures in the same way.
///
/// ```
/// use peelnet_gpu::{AdapterScope, wgpu};
///
/// let mut info = wgpu::AdapterInfo::new(wgpu::DeviceType::Cpu, wgpu::Backend::Vulkan);
/// info.driver = "llvmpipe".to_owned();
/// assert!(AdapterScope::LLVMPIPE.contains(&info));
/// info.device_type = wgpu::DeviceType::DiscreteGpu;
/// assert!(!AdapterScope::LLVMPIPE.contains(&info) && AdapterScope::ANY.contains(&info));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AdapterScope {
    /// Back end.
    pub backend: Option<wgpu::Backend>,
    /// Kind of device.
    pub kind: Option<wgpu::DeviceType>,
    /// Part of the adapter's name, in any case.
    pub name: Option<&'static str>,
    /// Part of the driver's name or version, in any case.
    pub driver: Option<&'static str>,
}

impl AdapterScope {
    /// Every adapter.
    pub const ANY: Self = Self {
        backend: None,
        kind: None,
        name: None,
        driver: None,
    };

    /// Mesa's software rasteriser.
    pub const LLVMPIPE: Self = Self {
        backend: Some(wgpu::Backend::Vulkan),
        kind: Some(wgpu::DeviceType::Cpu),
        driver: Some("llvmpipe"),
        ..Self::ANY
    };

    /// Whether an adapter belongs to the set.
    pub fn contains(&self, info: &wgpu::AdapterInfo) -> bool {
        let part = |wanted: Option<&str>, text: &str| {
            wanted.is_none_or(|w| text.to_lowercase().contains(&w.to_lowercase()))
        };
        self.backend.is_none_or(|b| b == info.backend)
            && self.kind.is_none_or(|k| k == info.device_type)
            && part(self.name, &info.name)
            && part(
                self.driver,
                &format!("{} {}", info.driver, info.driver_info),
            )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_field_that_is_set_must_match() {
        let info = wgpu::AdapterInfo {
            name: "NVIDIA H100".to_owned(),
            driver: "NVIDIA".to_owned(),
            driver_info: "580.65".to_owned(),
            ..wgpu::AdapterInfo::new(wgpu::DeviceType::DiscreteGpu, wgpu::Backend::Vulkan)
        };
        let scope = AdapterScope {
            name: Some("h100"),
            driver: Some("nvidia 580"),
            ..AdapterScope::ANY
        };
        assert!(scope.contains(&info));
        let others: [fn(&mut AdapterScope); 5] = [
            |s| s.backend = Some(wgpu::Backend::Metal),
            |s| s.kind = Some(wgpu::DeviceType::Cpu),
            |s| s.name = Some("A100"),
            |s| s.driver = Some("nvidia 570"),
            |s| *s = AdapterScope::LLVMPIPE,
        ];
        for change in others {
            let mut other = scope;
            change(&mut other);
            assert!(!other.contains(&info), "{other:?}");
        }
    }
}
