//! Where tensors live.

use std::num::NonZeroUsize;

use burn::tensor::Device;

/// What computes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Compute {
    /// burn's `flex` back end, several threads.
    #[default]
    Cpu,
    /// burn's wgpu back end on the default adapter. Worth it for large batches only: a step of 128 rows is all overhead.
    #[cfg(feature = "gpu")]
    Gpu,
}

impl Compute {
    pub(crate) fn device(self) -> Device {
        match self {
            Self::Cpu => Device::flex(),
            #[cfg(feature = "gpu")]
            Self::Gpu => Device::wgpu(burn::tensor::DeviceKind::DefaultDevice),
        }
    }

    /// The threads that evaluate chunks: those asked for, else all cores, at most 16 (beyond that a batch has no more
    /// chunks). A GPU has one queue.
    pub(crate) fn threads(self, asked: Option<NonZeroUsize>) -> usize {
        match self {
            Self::Cpu => asked
                .or_else(|| std::thread::available_parallelism().ok())
                .map_or(1, |n| n.get().min(16)),
            #[cfg(feature = "gpu")]
            Self::Gpu => 1,
        }
    }
}
