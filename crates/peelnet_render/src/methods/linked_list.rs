//! `linked-list`: every fragment in its pixel's linked list, in one geometry pass (Yang, Hensley, Grün & Thibieroz 2010).
//!
//! A pool that turns out too small is made larger and the pass drawn again: nothing is dropped.

use super::{Build, Compositor, Count, DrawContext, FrameStats, Method, Parameter, Promises};
use crate::{
    RenderError,
    passes::{
        count::{groups_2d, unwritten, unwritten_attachment, unwritten_texture},
        sbuffer::{FragmentStorage, bytes_per_fragment},
    },
    scene::{FrameTargets, GeometryPass, GeometryPipelines, SceneBuffers, Surfaces},
};
use peelnet_core::methods::over;
use peelnet_gpu::{
    Gpu,
    bind::{Bind, Bound},
    wgpu,
};

const NODES: Count = Count {
    name: "nodes",
    about: "size of the first pool; it grows as needed",
};

pub(super) const METHOD: Method = Method {
    parameters: &[Parameter::Count(NODES)],
    promises: |_| Promises {
        tinted: true,
        ..Promises::EXACT
    },
    twin: Some(|_, p| Some(over::composite(p.fragments, p.background))),
    ..Method::new(
        "linked-list",
        "exact: one pass into a list for each pixel, sorted by relinking",
        build,
    )
};

/// Nodes that the first frame gets for each pixel.
const FIRST_GUESS: u64 = 4;

#[derive(Debug)]
struct LinkedList {
    heads: wgpu::Buffer,
    used: wgpu::Buffer,
    extent: wgpu::Buffer,
    attachment: wgpu::TextureView,
    pool: Pool,
}

#[derive(Debug)]
struct Pool {
    nodes: u64,
    build: GeometryPipelines,
    build_group: Bound,
    composite: wgpu::ComputePipeline,
    composite_group: Bound,
}

fn build(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    let (gpu, frame) = (b.gpu, b.frame);
    let pixels = frame.pixels();
    let heads = gpu.storage("list heads", u64::from(pixels) * 4)?;
    let used = gpu.storage("nodes used", 4)?;
    let [width, height] = frame.size;
    let extent = gpu.upload(
        "extent",
        &[width, height, groups_2d(pixels)[0], 0],
        wgpu::BufferUsages::UNIFORM,
    );
    let nodes = NODES.given(b.spec);
    let first = nodes.unwrap_or(u64::from(pixels) * FIRST_GUESS);
    let pool = Pool::new(gpu, b.scene, frame, [&heads, &used, &extent], first)?;
    Ok(Box::new(LinkedList {
        attachment: unwritten_texture(gpu, frame)?,
        heads,
        used,
        extent,
        pool,
    }))
}

impl Pool {
    fn new(
        gpu: &Gpu,
        scene: &SceneBuffers,
        frame: &FrameTargets,
        [heads, used, extent]: [&wgpu::Buffer; 3],
        nodes: u64,
    ) -> Result<Self, RenderError> {
        let features: &[&str] = if scene.tinted { &["tinted"] } else { &[] };
        let next = gpu.storage("list links", nodes * 4)?;
        let storage = FragmentStorage::new(gpu, nodes, scene.tinted)?;
        let build_group = gpu.bind(
            "build",
            wgpu::ShaderStages::FRAGMENT,
            &[
                Bind::Write(heads),
                Bind::Write(used),
                Bind::Write(&next),
                Bind::Write(&storage.depths),
                Bind::Write(&storage.triangles),
                Bind::Write(&storage.colors),
            ],
        );
        let build = scene.pipelines(
            gpu,
            frame,
            Surfaces::Transparent,
            &GeometryPass {
                label: "build",
                shader: "methods::linked_list::build",
                features,
                extra: &[],
                group: Some(&build_group.layout),
                targets: &[unwritten()],
                depth: None,
            },
        )?;
        let composite_group = gpu.bind(
            "composite",
            wgpu::ShaderStages::COMPUTE,
            &[
                Bind::Uniform(extent),
                Bind::Read(heads),
                Bind::Write(&next),
                Bind::Read(&storage.depths),
                Bind::Read(&storage.triangles),
                Bind::Read(&storage.colors),
                Bind::Texture(&frame.background),
                Bind::Store(&frame.image),
            ],
        );
        let wgsl = peelnet_shaders::link("methods::linked_list::composite", features, &[])?;
        Ok(Self {
            nodes,
            build,
            build_group,
            composite: gpu.compute("composite", &wgsl, &[&composite_group.layout]),
            composite_group,
        })
    }
}

impl Compositor for LinkedList {
    fn draw(&mut self, cx: &mut DrawContext<'_, '_>) -> Result<FrameStats, RenderError> {
        let gpu = cx.recorder.gpu();
        let mut geometry_passes = 0;
        let total = loop {
            cx.recorder.encoder().clear_buffer(&self.heads, 0, None);
            cx.recorder.encoder().clear_buffer(&self.used, 0, None);
            {
                let attachment = [unwritten_attachment(&self.attachment)];
                let mut pass = cx.recorder.render("build", &attachment, None);
                pass.set_bind_group(1, &self.pool.build_group.group, &[]);
                let build = &self.pool.build;
                cx.scene
                    .draw(&mut pass, cx.frame, Surfaces::Transparent, build);
            }
            cx.recorder.submit();
            geometry_passes += 1;
            let used: Vec<u32> = gpu.read(&self.used, 0..4)?;
            let needed = u64::from(used[0]);
            if needed <= self.pool.nodes {
                break needed;
            }
            // A quarter more, so that a moving camera does not redo every frame.
            let nodes = needed + needed / 4;
            let shared = [&self.heads, &self.used, &self.extent];
            self.pool = Pool::new(gpu, cx.scene, cx.frame, shared, nodes)?;
        };
        {
            let mut pass = cx.recorder.compute("composite");
            pass.set_pipeline(&self.pool.composite);
            pass.set_bind_group(0, &self.pool.composite_group.group, &[]);
            let [x, y] = groups_2d(cx.frame.pixels());
            pass.dispatch_workgroups(x, y, 1);
        }
        let pixels = f64::from(cx.frame.pixels());
        // The fragment and a link.
        let node = bytes_per_fragment(cx.scene.tinted) + 4;
        Ok(FrameStats {
            fragments: Some(total),
            tiles: 1,
            geometry_passes,
            fullscreen_passes: 1,
            // Heads and the unwritten attachment; then the pool.
            bytes_per_pixel: 5.0 + (self.pool.nodes * node) as f64 / pixels,
            ..Default::default()
        })
    }
}
