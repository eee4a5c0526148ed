//! What draws a frame.

use crate::{
    error::RenderError,
    methods::{
        self,
        compositor::{Build, Compositor},
        layers::{self, LayerView},
        spec::MethodSpec,
        surfaces,
    },
    target::MethodOptions,
};
use peelnet_gpu::Gpu;
use peelnet_raster::{FrameTargets, SceneBuffers};

/// What draws: a method by name, or a view that is no method of transparency.
#[derive(Clone, Debug)]
pub(crate) enum Kind {
    Method(MethodSpec),
    Layers(LayerView),
    Surfaces,
}

impl Kind {
    /// Makes the passes for a frame.
    pub fn build(
        &self,
        gpu: &Gpu,
        scene: &SceneBuffers,
        frame: &FrameTargets,
        options: &MethodOptions,
    ) -> Result<Box<dyn Compositor>, RenderError> {
        match self {
            Self::Method(spec) => methods::build(&Build {
                gpu,
                scene,
                frame,
                spec,
                learned: options.learned.as_ref(),
                sums: options.sums,
            }),
            Self::Layers(view) => layers::build(gpu, scene, frame, *view),
            Self::Surfaces => surfaces::build(gpu, scene, frame),
        }
    }
}
