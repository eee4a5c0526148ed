//! `abuffer`: every fragment stored, sorted and composited (S-buffer, Vasilakis & Fudos 2012).

use super::{Build, Compositor, Count, DrawContext, FrameStats, Method, Parameter, Promises, Role};
use crate::{
    RenderError,
    passes::sbuffer::{FragmentStorage, SBuffer, bytes_per_fragment},
    scene::{FrameTargets, SceneBuffers},
};
use peelnet_core::methods::over;
use peelnet_gpu::{
    Gpu,
    bind::{Bind, Bound},
    wgpu,
};

const BUDGET: Count = Count {
    name: "budget",
    about: "fragments that one tile may hold",
};

pub(super) const METHOD: Method = Method {
    parameters: &[Parameter::Count(BUDGET)],
    promises: |_| Promises {
        tinted: true,
        ..Promises::EXACT
    },
    curve: &["", ":scale=0.5"],
    roles: &[(Role::Reference, "abuffer")],
    twin: Some(|_, p| Some(over::composite(p.fragments, p.background))),
    ..Method::new(
        "abuffer",
        "exact: S-buffer, every fragment stored and sorted",
        build,
    )
};

#[derive(Debug)]
struct ABuffer {
    sbuffer: SBuffer,
    composite: wgpu::ComputePipeline,
    group: Option<Bound>,
    tinted: bool,
}

fn build(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    let features: &[&str] = if b.scene.tinted { &["tinted"] } else { &[] };
    let wgsl = peelnet_shaders::link("methods::abuffer::composite", features, &[])?;
    build_with(
        b.gpu,
        b.scene,
        b.frame,
        BUDGET.given(b.spec),
        features,
        &wgsl,
    )
}

/// Stores, sorts and hands every pixel's run to a compute shader; `features` are those of storing.
pub(super) fn build_with(
    gpu: &Gpu,
    scene: &SceneBuffers,
    frame: &FrameTargets,
    budget: Option<u64>,
    features: &[&str],
    wgsl: &str,
) -> Result<Box<dyn Compositor>, RenderError> {
    let sbuffer = SBuffer::new(gpu, scene, frame, budget, features)?;
    // Storage is sized by the first frame; the layout does not depend on it, so any buffer stands in for it here.
    let layout = group(gpu, &sbuffer, &sbuffer.count.counts, frame).layout;
    Ok(Box::new(ABuffer {
        composite: gpu.compute("composite", wgsl, &[&layout]),
        group: None,
        sbuffer,
        tinted: features.contains(&"tinted"),
    }))
}

fn group(gpu: &Gpu, sbuffer: &SBuffer, colors: &wgpu::Buffer, frame: &FrameTargets) -> Bound {
    gpu.bind(
        "composite",
        wgpu::ShaderStages::COMPUTE,
        &[
            Bind::Uniform(sbuffer.tile_buffer()),
            Bind::Read(&sbuffer.count.offsets),
            Bind::Read(colors),
            Bind::Texture(&frame.background),
            Bind::Store(&frame.image),
        ],
    )
}

impl Compositor for ABuffer {
    fn draw(&mut self, cx: &mut DrawContext<'_, '_>) -> Result<FrameStats, RenderError> {
        let gpu = cx.recorder.gpu();
        let found = self.sbuffer.count.run(cx.recorder, cx.scene, cx.frame)?;
        let (tiles, grown) = self.sbuffer.plan(gpu, cx.scene, cx.frame, found.total)?;
        if grown || self.group.is_none() {
            let colors = self
                .sbuffer
                .storage()
                .map_or(&self.sbuffer.count.counts, |s| &s.colors);
            self.group = Some(group(gpu, &self.sbuffer, colors, cx.frame));
        }
        for tile in &tiles {
            self.sbuffer
                .store_and_sort(cx.recorder, cx.scene, cx.frame, tile);
            let mut pass = cx.recorder.compute("composite");
            pass.set_pipeline(&self.composite);
            pass.set_bind_group(0, self.group.as_ref().map(|g| &g.group), &[]);
            let [x, y] = tile.dispatch();
            pass.dispatch_workgroups(x, y, 1);
            drop(pass);
            // The tile's uniform is written at submission: one submission a tile.
            cx.recorder.submit();
        }
        let pixels = f64::from(cx.frame.pixels());
        let bytes = bytes_per_fragment(self.tinted);
        let stored = if tiles.len() > 1 {
            FragmentStorage::limit(gpu, None, self.tinted).min(found.total)
        } else {
            found.total
        };
        Ok(FrameStats {
            fragments: Some(found.total),
            max_layers: Some(found.most),
            lost: 0,
            tiles: tiles.len() as u32,
            geometry_passes: 1 + tiles.len() as u32,
            fullscreen_passes: 3 + 2 * tiles.len() as u32,
            // Count, offset and the unwritten attachment; then the fragments.
            bytes_per_pixel: 9.0 + (stored * bytes) as f64 / pixels,
        })
    }
}
