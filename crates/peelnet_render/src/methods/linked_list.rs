//! `linked-list`: every fragment in its pixel's linked list, in one geometry pass (Yang, Hensley, Grün & Thibieroz 2010).
//!
//! A pool that turns out too small is made larger for the next frame, which counts as too small until then: nothing is dropped silently.
//! One thread sorts and composites a list, so lists of more than 1,024 nodes are not walked: such frames are drawn from the S-buffer, with
//! colours rounded as the list rounds them.

use super::{
    abuffer::{self, Composite, FIRST_GUESS},
    prelude::*,
    stored::{self, COLORS},
};
use peelnet_core::methods::over;
use peelnet_gpu::{
    Gpu,
    bind::{Bind, Bound},
    wgpu,
};
use peelnet_raster::{
    FrameTargets, GeometryPass, GeometryPipelines, SceneBuffers, Surfaces,
    count::{Faults, unwritten, unwritten_attachment, unwritten_texture},
    fullscreen::FullscreenPass,
};
use std::ops::Range;

const NODES: Parameter = Parameter::whole(
    "nodes",
    "size of the first pool; it grows as needed",
    None,
    (1, 1 << 32),
);

pub(super) const METHOD: Method = Method {
    parameters: &[NODES, COLORS],
    promises: |s| Promises {
        tinted: true,
        ..stored::promises(s, Promises::EXACT)
    },
    curve: &["", ":colors=f16", ":colors=u8"],
    flaws: &[
        stored::in_bytes(
            Property::Background,
            "alpha-tiny alpha-zero coplanar emissive far grazing intersecting isolated moving-camera opaque-mix \
             thin-slab two-layers wide-range",
        ),
        stored::in_bytes(
            Property::Hull,
            "alpha-tiny coplanar deep emissive grazing intersecting moving-camera near-overflow",
        ),
        stored::in_bytes(Property::Single, "emissive grazing"),
    ],
    twin: Some(|s, p| {
        let colors = stored::colors(s);
        let kept: Vec<_> = p.fragments.iter().map(|f| colors.kept(f)).collect();
        Some(over::composite(&kept, p.background))
    }),
    ..Method::own(
        "linked-list",
        "exact: one pass into a list for each pixel, sorted by relinking",
        build,
    )
};

/// The bytes of what is found of a frame's lists.
const FOUND: Range<u64> = 0..20;

#[derive(Debug)]
struct LinkedList {
    shared: Shared,
    attachment: wgpu::TextureView,
    pool: Pool,
    version: u64,
    /// What draws instead, since a list was too long.
    long: Option<Box<dyn Compositor>>,
}

/// What every pool is bound with.
#[derive(Debug)]
struct Shared {
    heads: wgpu::Buffer,
    /// `Found` in `methods/linked_list/composite.wgsl`.
    found: wgpu::Buffer,
    background: wgpu::TextureView,
    /// How colours are stored: features of the shaders, and bytes of a fragment's.
    features: Vec<&'static str>,
    color_bytes: u64,
}

#[derive(Debug)]
struct Pool {
    nodes: u64,
    build: GeometryPipelines,
    build_group: Bound,
    composite: FullscreenPass,
}

fn build(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    let (gpu, frame, tinted) = (b.gpu, b.frame, b.scene.tinted);
    let pixels = u64::from(frame.pixels());
    let (_, bytes, layout) = stored::layout(b.spec);
    let shared = Shared {
        heads: gpu.storage("list heads", pixels * 4)?,
        found: gpu.storage("nodes found", FOUND.end)?,
        background: frame.background.clone(),
        features: layout
            .into_iter()
            .chain(tinted.then_some("tinted"))
            .collect(),
        // Where light takes a colour two of a fragment.
        color_bytes: u64::from(bytes) * if tinted { 2 } else { 1 },
    };
    let first = NODES.count(b.spec).unwrap_or(pixels * FIRST_GUESS);
    Ok(Box::new(LinkedList {
        attachment: unwritten_texture(gpu, frame)?,
        pool: Pool::new(gpu, b.scene, frame, &shared, first)?,
        shared,
        version: 0,
        long: None,
    }))
}

impl Pool {
    fn new(
        gpu: &Gpu,
        scene: &SceneBuffers,
        frame: &FrameTargets,
        shared: &Shared,
        nodes: u64,
    ) -> Result<Self, RenderError> {
        let features = &shared.features;
        let storage = |label, bytes| gpu.storage(label, nodes * bytes);
        let next = storage("list links", 4)?;
        let depths = storage("fragment depths", 4)?;
        let triangles = storage("fragment triangles", 4)?;
        let colors = storage("fragment colours", shared.color_bytes)?;
        let written = [
            &shared.heads,
            &shared.found,
            &next,
            &depths,
            &triangles,
            &colors,
        ];
        let stages = wgpu::ShaderStages::FRAGMENT;
        let build_group = gpu.bind("build", stages, &written.map(Bind::Write));
        let build = scene.pipelines(
            gpu,
            frame,
            Surfaces::Transparent,
            &GeometryPass {
                label: "build",
                shader: "methods::linked_list::build",
                features,
                group: Some(&build_group),
                targets: &[unwritten()],
                ..GeometryPass::NONE
            },
        )?;
        let composite = FullscreenPass::resolve(
            gpu,
            "methods::linked_list::composite",
            features,
            &[],
            &[
                Bind::Uniform(scene.camera_buffer()),
                Bind::Read(&shared.heads),
                Bind::Write(&next),
                Bind::Read(&depths),
                Bind::Read(&triangles),
                Bind::Read(&colors),
                Bind::Texture(&shared.background),
                Bind::Write(&shared.found),
            ],
            frame.output,
        )?;
        Ok(Self {
            nodes,
            build,
            build_group,
            composite,
        })
    }
}

impl Compositor for LinkedList {
    fn draw(&mut self, cx: &mut DrawContext<'_, '_>) -> Result<FrameStats, RenderError> {
        if let Some(long) = &mut self.long {
            return long.draw(cx);
        }
        let encoder = cx.recorder.encoder();
        encoder.clear_buffer(&self.shared.heads, 0, None);
        encoder.clear_buffer(&self.shared.found, 0, None);
        {
            let attachment = [unwritten_attachment(&self.attachment)];
            let mut pass = cx.recorder.render("build", &attachment, None);
            pass.set_bind_group(1, &self.pool.build_group.group, &[]);
            let build = &self.pool.build;
            cx.scene
                .draw(&mut pass, cx.frame, Surfaces::Transparent, build);
        }
        cx.resolve(&self.pool.composite);
        let pixels = f64::from(cx.frame.pixels());
        // Depth, triangle, link, and colours.
        let node = 3 * 4 + self.shared.color_bytes;
        Ok(FrameStats {
            tiles: 1,
            geometry_passes: 1,
            fullscreen_passes: 1,
            // Heads and the unwritten attachment; then the pool.
            bytes_per_pixel: 5.0 + (self.pool.nodes * node) as f64 / pixels,
            ..Default::default()
        })
    }

    fn is_ready(&self) -> bool {
        self.long.as_ref().is_none_or(|long| long.is_ready())
    }

    fn feedback(&self) -> Vec<(wgpu::Buffer, Range<u64>)> {
        match &self.long {
            Some(long) => long.feedback(),
            None => vec![(self.shared.found.clone(), FOUND)],
        }
    }

    fn learn(
        &mut self,
        cx: &Learning<'_>,
        words: &[Vec<u32>],
        stats: &mut FrameStats,
    ) -> Result<Fit, RenderError> {
        if let Some(long) = &mut self.long {
            return long.learn(cx, words, stats);
        }
        let &[used, too_long, composited, unsorted, pixel] = words[0].as_slice() else {
            return Ok(Fit::TooSmall);
        };
        let needed = u64::from(used);
        stats.fragments = Some(needed);
        if too_long > 0 {
            let (features, composite) = (&self.shared.features, Composite::exact(cx.scene.tinted));
            let long = abuffer::build_with(cx.gpu, cx.scene, cx.frame, None, features, composite);
            self.long = Some(long?);
            self.version += 1;
            return Ok(Fit::TooSmall);
        }
        if needed > self.pool.nodes {
            // A quarter more, so that a moving camera does not grow it every frame.
            let nodes = needed + needed / 4;
            self.pool = Pool::new(cx.gpu, cx.scene, cx.frame, &self.shared, nodes)?;
            self.version += 1;
            return Ok(Fit::TooSmall);
        }
        let (lost, uncounted) = (
            used.saturating_sub(composited),
            composited.saturating_sub(used),
        );
        let faults = [unsorted, lost, uncounted, pixel];
        Faults::check(&faults, cx.frame.size[0])?;
        Ok(Fit::Whole)
    }

    fn version(&self) -> u64 {
        self.version + self.long.as_ref().map_or(0, |long| long.version())
    }
}
