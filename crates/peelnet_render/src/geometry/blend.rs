use crate::gpu::wgpu;
use peelnet_core::guards::HALF_MAX;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Blend {
    /// `dst + src`, from 0.
    Add,
    /// `dst · (1 − src)`, from 1.
    Transmit,
    /// `dst + src` of red, green and blue, from 0; `dst · (1 − src.a)` of alpha, from 1.
    AddTransmit,
    /// `src + dst · (1 − src.a)` of premultiplied colour, from 0; `dst · (1 − src.a)` of alpha, from 1.
    Over,
    /// `dst + src · dst.a` of premultiplied colour, from 0; `dst · (1 − src.a)` of alpha, from 1.
    Under,
    /// `max(dst, src)` of red, green and blue, from the smallest half; `dst + src` of alpha, from 0.
    MaxAdd,
    /// `dst + src` of red, green and blue, from 0; `max(dst, src)` of alpha, from the smallest half.
    AddMax,
    /// `max(dst, src)`, from the smallest half.
    Max,
    /// `max(dst, src)` of 8-bit channels, 0 … 1, from 0.
    MaxBytes,
    /// `dst + src` of 8-bit channels, at most 1, from 0.
    AddBytes,
}

impl Blend {
    /// What a target is cleared to, and how colour and alpha blend.
    fn table(self) -> ([f64; 4], [wgpu::BlendComponent; 2]) {
        use wgpu::{BlendFactor as F, BlendOperation as O};
        let component = |src_factor, dst_factor, operation| wgpu::BlendComponent {
            src_factor,
            dst_factor,
            operation,
        };
        let add = component(F::One, F::One, O::Add);
        let max = component(F::One, F::One, O::Max);
        let transmit = component(F::Zero, F::OneMinusSrc, O::Add);
        let transmit_alpha = component(F::Zero, F::OneMinusSrcAlpha, O::Add);
        let over = component(F::One, F::OneMinusSrcAlpha, O::Add);
        let under = component(F::DstAlpha, F::One, O::Add);
        let (clear, least) = ([0.0, 0.0, 0.0, 1.0], -f64::from(HALF_MAX));
        match self {
            Self::Add | Self::AddBytes => ([0.0; 4], [add, add]),
            Self::MaxBytes => ([0.0; 4], [max, max]),
            Self::Transmit => ([1.0; 4], [transmit, transmit]),
            Self::AddTransmit => (clear, [add, transmit_alpha]),
            Self::Over => (clear, [over, transmit_alpha]),
            Self::Under => (clear, [under, transmit_alpha]),
            Self::MaxAdd => ([least, least, least, 0.0], [max, add]),
            Self::AddMax => ([0.0, 0.0, 0.0, least], [add, max]),
            Self::Max => ([least; 4], [max, max]),
        }
    }

    pub fn state(self, format: wgpu::TextureFormat) -> wgpu::ColorTargetState {
        let (_, [color, alpha]) = self.table();
        wgpu::ColorTargetState {
            blend: Some(wgpu::BlendState { color, alpha }),
            ..format.into()
        }
    }

    /// What a target is cleared to.
    pub fn start(self) -> [f64; 4] {
        self.table().0
    }
}
