use crate::geometry::{
    FrameTargets, RenderError, SceneBuffers,
    frame::UNWRITTEN,
    needs::{self, Needs},
    upload::{ATTRIBUTES, Vertex},
};
use crate::gpu::{
    Gpu, RenderPipeline,
    bind::{Bind, Bound, numbered},
    wgpu,
};
use crate::shaders::Shader;
use peelnet_scene::MaterialFlags;

/// Pipelines of one geometry pass: one for each variant of the materials that it draws.
#[derive(Debug)]
pub struct GeometryPipelines {
    /// Of the opaque surfaces or the transparent ones.
    pub(crate) opaque: bool,
    /// Bind group 1.
    pub(crate) group: Option<Bound>,
    pub(crate) variants: Vec<OfVariant>,
}

#[derive(Debug)]
pub(crate) struct OfVariant {
    pub(crate) variant: MaterialFlags,
    pub(crate) pipeline: wgpu::RenderPipeline,
    /// Whether it reads the number of a fragment's triangle.
    pub(crate) numbered: bool,
}

#[derive(Debug)]
pub struct GeometryPass<'a> {
    pub label: &'a str,
    /// Root module of the fragment shader.
    pub shader: &'a str,
    /// Whether it draws the opaque surfaces of the scene, not the transparent ones.
    pub opaque: bool,
    /// What it reads of surfaces.
    pub needs: Needs,
    /// Features besides those that the scene's materials need.
    pub features: &'a [&'a str],
    /// Modules that are not in the repository.
    pub extra: &'a [(&'a str, &'a str)],
    /// What the names of group 1 stand for.
    pub entries: &'a [(&'a str, Bind<'a>)],
    /// Colour targets; none of a pass that writes storage alone.
    pub targets: &'a [Option<wgpu::ColorTargetState>],
    pub depth: Option<wgpu::DepthStencilState>,
    pub samples: u32,
}

impl GeometryPass<'_> {
    /// What most passes leave out.
    pub const NONE: GeometryPass<'static> = GeometryPass {
        label: "",
        shader: "",
        opaque: false,
        needs: Needs::COLOR,
        features: &[],
        extra: &[],
        entries: &[],
        targets: &[],
        depth: None,
        samples: 1,
    };

    /// Bind group 1 of a linked shader, where it has any.
    pub(crate) fn bind(&self, gpu: &Gpu, shader: &Shader) -> Result<Option<Bound>, RenderError> {
        let entries = numbered(shader, 1, self.entries)?;
        let stages = wgpu::ShaderStages::FRAGMENT;
        Ok((!entries.is_empty()).then(|| gpu.bind(self.label, stages, &entries)))
    }
}

impl SceneBuffers {
    /// Builds a geometry pass's pipelines: the shared vertex shader, the pass's fragment shader, and the features
    /// that this scene's materials need.
    pub fn pipelines(
        &self,
        frame: &FrameTargets,
        pass: &GeometryPass<'_>,
    ) -> Result<GeometryPipelines, RenderError> {
        let (scene_group, runs) = self.half(frame, pass.opaque);
        let mut own_group = None;
        needs::compare(pass)?;
        let mut variants: Vec<(MaterialFlags, Option<usize>)> = Vec::new();
        for run in runs {
            if !variants.iter().any(|(v, _)| *v == run.variant) {
                variants.push((run.variant, run.maps));
            }
        }
        let compared: &[&str] = match &frame.depth {
            Some(depth) if !pass.opaque => depth.features(),
            _ => &[],
        };
        let mut all = Vec::with_capacity(variants.len());
        for (variant, maps) in variants {
            let mut features = pass.features.to_vec();
            features.extend(pass.needs.features(&variant.features()));
            features.extend(compared);
            let fragment = crate::shaders::link(pass.shader, &features, pass.extra)?;
            // The same of all variants: what a pass reads besides surfaces is its own.
            if own_group.is_none() {
                own_group = pass.bind(&self.gpu, &fragment)?;
            }
            let maps = maps.filter(|_| features.contains(&"mapped"));
            let maps = maps.map(|number| self.maps.bound(number));
            let mut groups = vec![Some(scene_group), own_group.as_ref(), maps];
            while groups.last().is_some_and(Option::is_none) {
                groups.pop();
            }
            all.push(OfVariant {
                variant,
                pipeline: pipeline(
                    &self.gpu,
                    pass,
                    &groups,
                    &features,
                    &fragment,
                    variant.contains(MaterialFlags::CULLED),
                )?,
                numbered: features.contains(&"numbered"),
            });
        }
        Ok(GeometryPipelines {
            opaque: pass.opaque,
            group: own_group,
            variants: all,
        })
    }
}

/// The pipeline of one variant. Passes that need no colour draw many variants alike: equal shaders and groups share a pipeline.
fn pipeline(
    gpu: &Gpu,
    pass: &GeometryPass<'_>,
    groups: &[Option<&Bound>],
    features: &[&str],
    fragment: &Shader,
    culled: bool,
) -> Result<wgpu::RenderPipeline, RenderError> {
    let carried = [
        "numbered",
        "material",
        "lit",
        "mapped",
        "normal_map",
        "vertex_colors",
        "splat",
        "splat_color",
        "display",
    ];
    let mut of_vertex = features.to_vec();
    of_vertex.retain(|f| carried.contains(f));
    let vertex = crate::shaders::link("scene::vertex", &of_vertex, &[])?;
    let layout = |step: u64, attributes| wgpu::VertexBufferLayout {
        array_stride: step,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes,
    };
    let always = wgpu::vertex_attr_array![0 => Float32x3, 1 => Uint32];
    let mut buffers = vec![Some(layout(size_of::<Vertex>() as u64, always.as_slice()))];
    for (_, attribute, feature) in ATTRIBUTES {
        let is_read = features.contains(feature);
        buffers.push(is_read.then(|| layout(attribute[0].format.size(), attribute)));
    }
    while buffers.last().is_some_and(Option::is_none) {
        buffers.pop();
    }
    let unwritten = [Some(wgpu::ColorTargetState {
        write_mask: wgpu::ColorWrites::empty(),
        ..UNWRITTEN.into()
    })];
    Ok(gpu.render_pipeline(&RenderPipeline {
        label: pass.label,
        vertex: &vertex,
        fragment,
        groups,
        buffers: &buffers,
        targets: match pass.targets {
            [] => &unwritten,
            targets => targets,
        },
        depth: pass.depth.clone(),
        samples: pass.samples,
        culled: culled.then_some(wgpu::Face::Back),
    }))
}
