//! The scene on the GPU: corners in world space, materials, lights, and what to draw in which pass.

use crate::{RenderError, maps::MapSets, methods::DrawContext};
use bytemuck::{Pod, Zeroable};
use peelnet_core::absorbance::DepthWarp;
use peelnet_gpu::{
    Gpu, GpuError,
    bind::{Bind, Bound},
    wgpu,
};
use peelnet_scene::{Camera, Lighting, Material, Object, Scene, Setting, Source, Variant};
use std::ops::Range;

/// One corner of a triangle. Corners are not shared: `vertex_index / 3` is then the triangle's index in the scene's
/// list, which portable WebGPU has no other way to learn.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct Corner {
    position: [f32; 3],
    material: u32,
}

/// What only some materials read of a corner, from buffers of their own, and the shader feature that reads it.
const ATTRIBUTES: [(wgpu::VertexFormat, &str); 4] = [
    (wgpu::VertexFormat::Float32x2, "mapped"),
    (wgpu::VertexFormat::Float32x4, "normal_map"),
    (wgpu::VertexFormat::Float32x4, "vertex_colors"),
    (wgpu::VertexFormat::Float32x3, "lit"),
];

/// Links a pass's fragment shader for a variant with nothing that it does not read: a pass that needs no colour needs no normals and no
/// images. Returns the features that are left and the text.
fn linked<'a>(
    pass: &GeometryPass<'a>,
    mut features: Vec<&'a str>,
) -> Result<(Vec<&'a str>, String), RenderError> {
    /// What the text holds where it reads something, and the features that bring that with them.
    const READ: [(&str, &[&str]); 3] = [
        (".triangle", &["numbered"]),
        (
            ".world",
            &[
                "lit",
                "phong",
                "pbr",
                "sun",
                "normal_map",
                "metallic_roughness_map",
                "occlusion_map",
            ],
        ),
        (
            "textureSampleGrad",
            &[
                "mapped",
                "color_map",
                "normal_map",
                "metallic_roughness_map",
                "occlusion_map",
                "emissive_map",
            ],
        ),
    ];
    features.push("numbered");
    let text = peelnet_shaders::link(pass.shader, &features, pass.extra)?;
    let before = features.len();
    for (word, brought) in READ {
        if !text.contains(word) {
            features.retain(|f| !brought.contains(f));
        }
    }
    if features.len() == before {
        return Ok((features, text));
    }
    let text = peelnet_shaders::link(pass.shader, &features, pass.extra)?;
    Ok((features, text))
}

/// What tells the pipelines of one pass apart.
#[derive(PartialEq)]
struct PipelineKey {
    culled: bool,
    /// Images of the bind group, read or not; `None` where none is bound.
    bound: Option<[bool; 5]>,
    /// The linked text, which also says what the vertex shader hands on.
    fragment: String,
}

/// Layout of `Material` in `scene/shade.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct MaterialData {
    color: [f32; 4],
    look: [f32; 4],
    emission: [f32; 4],
    transmission: [f32; 4],
}

impl MaterialData {
    fn of(m: &Material, layer: u32) -> Self {
        let [r, g, b] = m.color;
        let [first, second] = match m.lighting {
            Lighting::Pbr => [m.metallic, m.roughness],
            _ => [m.specular, m.shininess],
        };
        let [er, eg, eb] = m.emission;
        let [tr, tg, tb] = m.transmission;
        let cutoff = m.alpha_cutoff.unwrap_or(0.0);
        Self {
            color: [r, g, b, m.alpha],
            look: [first, second, cutoff, layer as f32],
            emission: [er, eg, eb, m.maps.normal_scale],
            transmission: [tr, tg, tb, m.maps.occlusion_strength],
        }
    }
}

/// Layout of `Light` in `scene/shade.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct LightData {
    position: [f32; 4],
    color: [f32; 4],
}

/// Layout of `Camera` in `scene/camera.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct CameraUniform {
    clip_from_world: [[f32; 4]; 4],
    eye: [f32; 4],
    frame: [u32; 4],
    sample: [u32; 4],
    depth_scale: [f32; 4],
}

/// Which pixels of a view are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelSample {
    /// Seed of the hash.
    pub seed: u32,
    /// Number of the view, so that views sample different pixels.
    pub view: u32,
    /// Largest hash that is kept, see [`peelnet_core::hash::sample_threshold`].
    pub threshold: u32,
}

impl PixelSample {
    /// Keeps every pixel.
    pub const ALL: Self = Self {
        seed: 0,
        view: 0,
        threshold: u32::MAX,
    };
}

/// A run of triangles that one pipeline draws.
#[derive(Clone, Debug, PartialEq, Eq)]
struct DrawRun {
    vertices: Range<u32>,
    variant: Variant,
    /// Number of its images' set.
    maps: Option<usize>,
}

/// A part of a transparent object with one material.
#[derive(Clone, Debug)]
struct TransparentPart {
    run: DrawRun,
    /// World-space box.
    bounds: [glam::Vec3; 2],
    /// World-space centre of every triangle.
    centroids: Vec<glam::Vec3>,
}

/// In which order transparent surfaces are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// As the scene lists them.
    Scene,
    /// Parts of objects with one material, the farthest centre of a box first.
    Objects,
    /// Triangles, the farthest centre first.
    Triangles,
}

/// In which order the transparent parts of objects are handed to the GPU. Depths, numbers of triangles and everything that is
/// computed of them stay as they are: only what depends on the order of drawing may change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Submission {
    /// As the scene lists them.
    Listed,
    /// The last first.
    Reversed,
    /// By a hash of their places and this seed.
    Shuffled(u32),
}

/// Which half of the scene a geometry pass draws.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Surfaces {
    /// Opaque objects.
    Opaque,
    /// Transparent ones.
    Transparent,
}

/// A scene's buffers, the same for every view and method.
#[derive(Debug)]
pub struct SceneBuffers {
    corners: wgpu::Buffer,
    /// In the order of [`ATTRIBUTES`], for every corner; each where any material reads it.
    attributes: [Option<wgpu::Buffer>; 4],
    maps: MapSets,
    /// Which images any material reads.
    mapped: [bool; 5],
    materials: wgpu::Buffer,
    /// Where any material is lit.
    lights: Option<wgpu::Buffer>,
    camera: wgpu::Buffer,
    light_count: u32,
    opaque: Vec<DrawRun>,
    transparent: Vec<DrawRun>,
    parts: Vec<TransparentPart>,
    /// Background radiance, linear RGB.
    pub background: [f32; 3],
    /// Whether every colour is grey.
    pub grey: bool,
    /// Whether light takes a colour where it passes through surfaces.
    pub tinted: bool,
    /// Of the resolution that the scene asks transparency to be drawn at.
    pub transparency_scale: f32,
}

/// The frame's own targets: `C_0`, the opaque depth and the finished image.
#[derive(Debug)]
pub struct FrameTargets {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Width over height of what is seen; not that of `size` where a lower resolution was rounded.
    pub aspect: f32,
    /// `C_0`: the opaque image over the background, RGBA32F.
    pub background: wgpu::TextureView,
    /// Depth of the opaque image.
    pub depth: Option<wgpu::TextureView>,
    /// The finished image, RGBA32F.
    pub image: wgpu::TextureView,
    scene_group: Bound,
    opaque_group: Bound,
}

impl FrameTargets {
    /// Number of pixels.
    pub const fn pixels(&self) -> u32 {
        self.size[0] * self.size[1]
    }
}

/// Pipelines of one geometry pass: one for each variant of the materials that it draws.
#[derive(Debug)]
pub struct GeometryPipelines(Vec<(Variant, wgpu::RenderPipeline)>);

impl GeometryPipelines {
    fn set(&self, pass: &mut wgpu::RenderPass<'_>, variant: Variant) {
        // Built for every run's variant.
        if let Some((_, pipeline)) = self.0.iter().find(|(v, _)| *v == variant) {
            pass.set_pipeline(pipeline);
        }
    }
}

/// What a geometry pass is made of.
#[derive(Debug)]
pub struct GeometryPass<'a> {
    /// Label for messages and times.
    pub label: &'a str,
    /// Root module of the fragment shader.
    pub shader: &'a str,
    /// Features besides those that the scene calls for.
    pub features: &'a [&'a str],
    /// Modules that are not in the repository.
    pub extra: &'a [(&'a str, &'a str)],
    /// Layout of bind group 1.
    pub group: Option<&'a wgpu::BindGroupLayout>,
    /// Colour targets.
    pub targets: &'a [Option<wgpu::ColorTargetState>],
    /// Depth state.
    pub depth: Option<wgpu::DepthStencilState>,
}

impl SceneBuffers {
    /// Transforms the scene to world space and uploads it.
    ///
    /// # Errors
    /// A scene larger than the adapter's largest buffer.
    pub fn new(gpu: &Gpu, scene: &Scene) -> Result<Self, RenderError> {
        let triangles: usize = scene.objects.iter().map(|o| o.mesh.triangles.len()).sum();
        let needed = triangles as u64 * 3 * size_of::<Corner>() as u64;
        if needed > gpu.limits.max_buffer_size || triangles > (u32::MAX / 3) as usize {
            return Err(RenderError::Gpu(GpuError::TooLarge {
                what: format!("scene '{}' with {triangles} triangles", scene.name),
                needed,
                limit: gpu.limits.max_buffer_size,
                adapter: gpu.info.name.clone(),
                mend: "split the scene or simplify its meshes",
            }));
        }
        let setting = Setting::of(scene);
        let mut attributes = Attributes::default();
        let mut maps = MapSets::default();
        let mut mapped = [false; 5];
        let mut corners = Vec::with_capacity(triangles * 3);
        let mut materials = Vec::new();
        let (mut opaque, mut transparent) = (Vec::new(), Vec::new());
        let mut parts = Vec::new();
        for object in &scene.objects {
            let world = object.world_from_object;
            let normal_matrix = glam::Mat3::from_mat4(world).inverse().transpose();
            // A mirrored object turns its triangles inside out: turn them back, so that culling stays right.
            let order = if glam::Mat3::from_mat4(world).determinant() < 0.0 {
                [0, 2, 1]
            } else {
                [0, 1, 2]
            };
            // Tangents turn with the surface, and over with a mirror.
            let turning = Turning {
                world,
                normal_matrix,
                order,
                mirrored: order[1] == 2,
            };
            for (part, material) in object.mesh.parts.iter().zip(&object.materials) {
                let index = materials.len() as u32;
                materials.push(MaterialData::of(material, object.layer.unwrap_or(0)));
                let variant = Variant::of(material, object, setting);
                let set = if variant.is_mapped() && !part.triangles.is_empty() {
                    for (any, read) in mapped.iter_mut().zip(variant.maps) {
                        *any |= read;
                    }
                    Some(maps.number(gpu, &material.maps, variant.maps)?)
                } else {
                    None
                };
                let begin = corners.len() as u32;
                for triangle in &object.mesh.triangles[part.triangles.clone()] {
                    for k in order {
                        let i = triangle[k] as usize;
                        corners.push(Corner {
                            position: world.transform_point3(object.mesh.positions[i]).to_array(),
                            material: index,
                        });
                    }
                }
                let runs = if material.is_opaque() {
                    &mut opaque
                } else {
                    &mut transparent
                };
                let run = DrawRun {
                    vertices: begin..corners.len() as u32,
                    variant,
                    maps: set,
                };
                push_run(runs, run.clone());
                let at = begin as usize..corners.len();
                attributes.extend(at, object, part.triangles.clone(), variant, turning);
                let own = &corners[begin as usize..];
                if let (false, Some(bounds)) = (material.is_opaque(), bounding_box(own)) {
                    parts.push(TransparentPart {
                        run,
                        bounds,
                        centroids: own.chunks_exact(3).map(centroid).collect(),
                    });
                }
            }
        }
        let lights: Vec<_> = scene
            .lights
            .iter()
            .map(|l| LightData {
                position: match l.source {
                    Source::Point(place) => place.extend(1.0).to_array(),
                    Source::Toward(direction) => direction.extend(0.0).to_array(),
                },
                color: [
                    l.color[0] * l.intensity,
                    l.color[1] * l.intensity,
                    l.color[2] * l.intensity,
                    0.0,
                ],
            })
            .collect();
        let storage = wgpu::BufferUsages::STORAGE;
        // A binding may not be smaller than one element.
        let at_least_one = |n: usize| n.max(1);
        materials.resize(at_least_one(materials.len()), MaterialData::zeroed());
        Ok(Self {
            attributes: attributes.upload(gpu, corners.len()),
            maps,
            mapped,
            grey: scene.is_grey(),
            tinted: scene.is_tinted(),
            corners: gpu.upload("corners", &corners, wgpu::BufferUsages::VERTEX),
            materials: gpu.upload("materials", &materials, storage),
            lights: opaque
                .iter()
                .chain(&transparent)
                .any(|run: &DrawRun| run.variant.is_lit())
                .then(|| gpu.upload("lights", &lights, storage)),
            camera: gpu.upload(
                "camera",
                &[CameraUniform::zeroed()],
                wgpu::BufferUsages::UNIFORM,
            ),
            light_count: lights.len() as u32,
            opaque,
            transparent,
            parts,
            background: scene.background,
            transparency_scale: scene.transparency_scale,
        })
    }

    /// Hands the transparent parts to the GPU in another order from now on.
    pub fn submit(&mut self, order: Submission) {
        self.parts.sort_by_key(|part| {
            let place = part.run.vertices.start;
            match order {
                Submission::Listed => place,
                Submission::Reversed => u32::MAX - place,
                Submission::Shuffled(seed) => peelnet_core::hash::pixel_hash(seed, 0, place, 0),
            }
        });
        self.transparent.clear();
        for TransparentPart { run, .. } in &self.parts {
            push_run(&mut self.transparent, run.clone());
        }
    }

    /// The view's uniform.
    pub(crate) const fn camera_buffer(&self) -> &wgpu::Buffer {
        &self.camera
    }

    /// What a transparent pass binds of the scene.
    pub fn bindings(&self) -> Vec<&'static str> {
        let lights = self.lights.is_some().then_some("lights");
        let depth = self.has_opaque().then_some("opaque depth");
        let always = ["camera", "materials"].into_iter();
        let sampler = self.mapped.contains(&true).then_some("sampler");
        let names = peelnet_scene::Effect::MAPS.map(peelnet_scene::Effect::name);
        let maps = names.into_iter().zip(self.mapped);
        let maps = maps.filter_map(|(name, read)| read.then_some(name));
        always
            .chain(lights)
            .chain(depth)
            .chain(sampler)
            .chain(maps)
            .collect()
    }

    /// What the vertex shader reads of a corner.
    pub fn corner_attributes(&self) -> Vec<&'static str> {
        let names = ["places on images", "tangent", "color", "normal"].into_iter();
        let extra = names.zip(&self.attributes);
        let extra = extra.filter_map(|(name, buffer)| buffer.as_ref().map(|_| name));
        let always = ["position", "material"].into_iter();
        always.chain(extra).collect()
    }

    /// Whether anything opaque can hide transparent fragments.
    pub fn has_opaque(&self) -> bool {
        !self.opaque.is_empty()
    }

    /// Makes the targets of a frame.
    ///
    /// # Errors
    /// A frame without pixels, or larger than the adapter allows.
    pub fn targets(&self, gpu: &Gpu, size: [u32; 2]) -> Result<FrameTargets, RenderError> {
        self.targets_of(gpu, size, size[0] as f32 / size[1] as f32)
    }

    /// The same for pixels that need not be square: `aspect` is the width of what is seen over its height.
    pub(crate) fn targets_of(
        &self,
        gpu: &Gpu,
        size: [u32; 2],
        aspect: f32,
    ) -> Result<FrameTargets, RenderError> {
        if size[0] == 0 || size[1] == 0 {
            return Err(RenderError::EmptyFrame {
                width: size[0],
                height: size[1],
            });
        }
        let none = wgpu::TextureUsages::empty();
        let format = wgpu::TextureFormat::Rgba32Float;
        let depth = if self.has_opaque() {
            Some(gpu.texture(
                "opaque depth",
                wgpu::TextureFormat::Depth32Float,
                size,
                none,
            )?)
        } else {
            None
        };
        let stages = wgpu::ShaderStages::VERTEX_FRAGMENT;
        // Where nothing is lit no light is bound.
        let lights = self.lights.as_ref().map_or(Bind::None, Bind::Read);
        let mut entries = vec![
            Bind::Uniform(&self.camera),
            Bind::Read(&self.materials),
            lights,
        ];
        let opaque_group = gpu.bind("opaque scene", stages, &entries);
        if let Some(depth) = &depth {
            entries.push(Bind::Depth(depth));
        }
        let scene_group = gpu.bind("scene", stages, &entries);
        Ok(FrameTargets {
            size,
            aspect,
            background: gpu.texture("background", format, size, none)?,
            image: gpu.texture("image", format, size, wgpu::TextureUsages::STORAGE_BINDING)?,
            depth,
            scene_group,
            opaque_group,
        })
    }

    /// Points the camera uniform at a view.
    pub fn set_view(&self, gpu: &Gpu, camera: &Camera, frame: &FrameTargets, sample: PixelSample) {
        let clip_from_world = camera.clip_from_view(frame.aspect) * camera.view_from_world();
        let warp = self.depth_warp(camera);
        let uniform = CameraUniform {
            clip_from_world: clip_from_world.to_cols_array_2d(),
            eye: camera.position.extend(1.0).to_array(),
            frame: [frame.size[0], frame.size[1], self.light_count, sample.seed],
            sample: [sample.view, sample.threshold, 0, 0],
            depth_scale: [
                depth_scale(camera.far),
                (-warp.log_near).exp() as f32,
                warp.scale as f32,
                camera.far / (camera.far - camera.near),
            ],
        };
        gpu.queue
            .write_buffer(&self.camera, 0, bytemuck::bytes_of(&uniform));
    }

    /// The warp over the depths that transparent objects span in a view: from their boxes, clipped to near and far. A tight
    /// range is what moments get their precision from.
    pub fn depth_warp(&self, camera: &Camera) -> DepthWarp {
        let view = camera.view_from_world();
        let boxes = self.parts.iter().map(|part| part.bounds);
        let corners = boxes.flat_map(|[lo, hi]| {
            (0..8).map(move |i| {
                let pick = |bit: u32, k: usize| if i >> bit & 1 == 0 { lo[k] } else { hi[k] };
                glam::Vec3::new(pick(0, 0), pick(1, 1), pick(2, 2))
            })
        });
        let (near, far) = corners
            .map(|p| (-view.transform_point3(p).z).clamp(camera.near, camera.far))
            .fold((f32::INFINITY, 0.0f32), |(a, b), z| (a.min(z), b.max(z)));
        if near <= far {
            DepthWarp::new(near.into(), far.into())
        } else {
            DepthWarp::new(camera.near.into(), camera.far.into())
        }
    }

    /// Builds a geometry pass's pipelines: the shared vertex shader, the pass's fragment shader, and the features
    /// that this scene calls for.
    ///
    /// # Errors
    /// A shader that does not link.
    pub fn pipelines(
        &self,
        gpu: &Gpu,
        frame: &FrameTargets,
        surfaces: Surfaces,
        pass: &GeometryPass<'_>,
    ) -> Result<GeometryPipelines, RenderError> {
        let (group, runs) = match surfaces {
            Surfaces::Opaque => (&frame.opaque_group, &self.opaque),
            Surfaces::Transparent => (&frame.scene_group, &self.transparent),
        };
        let mut variants: Vec<(Variant, Option<usize>)> = Vec::new();
        for run in runs {
            if !variants.iter().any(|(v, _)| *v == run.variant) {
                variants.push((run.variant, run.maps));
            }
        }
        let opaque = surfaces == Surfaces::Transparent && self.has_opaque();
        let mut built: Vec<(PipelineKey, wgpu::RenderPipeline)> = Vec::new();
        let mut of_variants = Vec::with_capacity(variants.len());
        for (variant, maps) in variants {
            let mut features = pass.features.to_vec();
            features.extend(variant.features());
            features.extend(opaque.then_some("opaque"));
            let (features, fragment) = linked(pass, features)?;
            let maps = maps.filter(|_| features.contains(&"mapped"));
            // Passes that need no colour draw many variants alike.
            let key = PipelineKey {
                culled: variant.culled,
                bound: maps.map(|_| variant.maps),
                fragment,
            };
            if let Some((_, pipeline)) = built.iter().find(|(k, _)| *k == key) {
                of_variants.push((variant, pipeline.clone()));
                continue;
            }
            let maps = maps.map(|number| &self.maps.bound(number).layout);
            let mut layouts = vec![Some(&group.layout), pass.group, maps];
            while layouts.last().is_some_and(Option::is_none) {
                layouts.pop();
            }
            let layout = gpu.layout(&layouts);
            let pipeline = self.pipeline(gpu, &layout, pass, &features, &key)?;
            built.push((key, pipeline.clone()));
            of_variants.push((variant, pipeline));
        }
        Ok(GeometryPipelines(of_variants))
    }

    fn pipeline(
        &self,
        gpu: &Gpu,
        layout: &wgpu::PipelineLayout,
        pass: &GeometryPass<'_>,
        features: &[&str],
        key: &PipelineKey,
    ) -> Result<wgpu::RenderPipeline, RenderError> {
        let carried = ["numbered", "lit", "mapped", "normal_map", "vertex_colors"];
        let mut of_vertex = features.to_vec();
        of_vertex.retain(|f| carried.contains(f));
        let vertex = gpu.shader(
            "scene::vertex",
            &peelnet_shaders::link("scene::vertex", &of_vertex, &[])?,
        );
        let fragment = gpu.shader(pass.shader, &key.fragment);
        let always = wgpu::vertex_attr_array![0 => Float32x3, 1 => Uint32];
        let extra = ATTRIBUTES.map(|(format, _)| format).into_iter().zip(2..);
        let extra: Vec<[wgpu::VertexAttribute; 1]> = extra
            .map(|(format, shader_location)| {
                [wgpu::VertexAttribute {
                    format,
                    offset: 0,
                    shader_location,
                }]
            })
            .collect();
        let mut buffers = vec![Some(wgpu::VertexBufferLayout {
            array_stride: size_of::<Corner>() as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &always,
        })];
        buffers.extend(
            ATTRIBUTES
                .iter()
                .zip(&extra)
                .map(|((format, feature), attributes)| {
                    features
                        .contains(feature)
                        .then(|| wgpu::VertexBufferLayout {
                            array_stride: format.size(),
                            step_mode: wgpu::VertexStepMode::Vertex,
                            attributes,
                        })
                }),
        );
        while buffers.last().is_some_and(Option::is_none) {
            buffers.pop();
        }
        let descriptor = wgpu::RenderPipelineDescriptor {
            label: Some(pass.label),
            layout: Some(layout),
            vertex: wgpu::VertexState {
                module: &vertex,
                entry_point: Some("vertex_main"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &buffers,
            },
            primitive: wgpu::PrimitiveState {
                cull_mode: key.culled.then_some(wgpu::Face::Back),
                ..Default::default()
            },
            depth_stencil: pass.depth.clone(),
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &fragment,
                entry_point: Some("fragment_main"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: pass.targets,
            }),
            multiview_mask: None,
            cache: None,
        };
        Ok(gpu.device.create_render_pipeline(&descriptor))
    }

    /// Draws one half of the scene, triangles in the order of the scene's list.
    pub fn draw(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        frame: &FrameTargets,
        surfaces: Surfaces,
        pipelines: &GeometryPipelines,
    ) {
        let (group, runs) = match surfaces {
            Surfaces::Opaque => (&frame.opaque_group, &self.opaque),
            Surfaces::Transparent => (&frame.scene_group, &self.transparent),
        };
        self.set_corners(pass, group);
        for run in runs {
            self.set_run(pass, pipelines, run);
            pass.draw(run.vertices.clone(), 0..1);
        }
    }

    fn set_corners(&self, pass: &mut wgpu::RenderPass<'_>, group: &Bound) {
        pass.set_bind_group(0, &group.group, &[]);
        pass.set_vertex_buffer(0, self.corners.slice(..));
        for (buffer, slot) in self.attributes.iter().zip(1..) {
            if let Some(buffer) = buffer {
                pass.set_vertex_buffer(slot, buffer.slice(..));
            }
        }
    }

    fn set_run(&self, pass: &mut wgpu::RenderPass<'_>, all: &GeometryPipelines, run: &DrawRun) {
        all.set(pass, run.variant);
        if let Some(number) = run.maps {
            pass.set_bind_group(2, &self.maps.bound(number).group, &[]);
        }
    }

    /// Draws opaque objects over the background colour into `C_0`.
    ///
    /// # Errors
    /// A shader that does not link.
    pub fn draw_background(
        &self,
        recorder: &mut peelnet_gpu::record::Recorder<'_>,
        frame: &FrameTargets,
        pipelines: Option<&GeometryPipelines>,
    ) {
        let [r, g, b] = self.background.map(f64::from);
        let color = clear_color(&frame.background, [r, g, b, 1.0]);
        let depth = frame
            .depth
            .as_ref()
            .map(|view| wgpu::RenderPassDepthStencilAttachment {
                view,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(1.0),
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: None,
            });
        let mut pass = recorder.render("background", &[color], depth);
        if let Some(pipelines) = pipelines {
            self.draw(&mut pass, frame, Surfaces::Opaque, pipelines);
        }
    }

    /// The opaque pass's pipelines, where the scene has anything opaque.
    ///
    /// # Errors
    /// A shader that does not link.
    pub fn opaque_pipelines(
        &self,
        gpu: &Gpu,
        frame: &FrameTargets,
    ) -> Result<Option<GeometryPipelines>, RenderError> {
        if !self.has_opaque() {
            return Ok(None);
        }
        let pass = GeometryPass {
            label: "opaque",
            shader: "scene::opaque",
            features: &[],
            extra: &[],
            group: None,
            targets: &[Some(wgpu::TextureFormat::Rgba32Float.into())],
            depth: Some(depth_state(true, wgpu::CompareFunction::Less)),
        };
        self.pipelines(gpu, frame, Surfaces::Opaque, &pass)
            .map(Some)
    }
}

/// Bytes of shader text that a scene's surfaces link, without tests of visibility: the opaque pass and one that gathers premultiplied
/// colour (`blended`), a text for each variant.
///
/// # Errors
/// A shader that does not link.
pub fn shader_bytes(scene: &Scene) -> Result<usize, RenderError> {
    let setting = Setting::of(scene);
    let mut texts: Vec<String> = Vec::new();
    for object in &scene.objects {
        for (part, material) in object.mesh.parts.iter().zip(&object.materials) {
            if part.triangles.is_empty() {
                continue;
            }
            let features = Variant::of(material, object, setting).features();
            let pass = if material.is_opaque() {
                "scene::opaque"
            } else {
                "methods::blended::gather"
            };
            for (shader, features) in [("scene::vertex", &features), (pass, &features)] {
                let text = peelnet_shaders::link(shader, features, &[])?;
                if !texts.contains(&text) {
                    texts.push(text);
                }
            }
        }
    }
    Ok(texts.iter().map(String::len).sum())
}

/// The transparent surfaces in an order that depends on the view.
#[derive(Debug)]
pub struct Sorted {
    order: Order,
    /// Vertex numbers of the sorted triangles; runs are ranges of it.
    indices: Option<wgpu::Buffer>,
    runs: Vec<DrawRun>,
}

impl Sorted {
    /// Room for the order; none is needed to draw the scene as it is listed.
    ///
    /// # Errors
    /// More triangles than the adapter's largest buffer indexes.
    pub fn new(gpu: &Gpu, scene: &SceneBuffers, order: Order) -> Result<Option<Self>, RenderError> {
        let triangles: usize = scene.parts.iter().map(|p| p.centroids.len()).sum();
        let size = triangles.max(1) as u64 * 12;
        if order == Order::Triangles && size > gpu.limits.max_buffer_size {
            return Err(RenderError::Gpu(GpuError::TooLarge {
                what: format!("the order of {triangles} triangles"),
                needed: size,
                limit: gpu.limits.max_buffer_size,
                adapter: gpu.info.name.clone(),
                mend: "sort objects instead (painter-object)",
            }));
        }
        let indices = (order == Order::Triangles).then(|| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("sorted triangles"),
                size,
                usage: wgpu::BufferUsages::INDEX | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        });
        Ok((order != Order::Scene).then_some(Self {
            order,
            indices,
            runs: Vec::new(),
        }))
    }

    /// Bytes that the order takes on the GPU.
    pub fn bytes(&self) -> u64 {
        self.indices.as_ref().map_or(0, wgpu::Buffer::size)
    }

    /// Sorts for a view, on the CPU; its time is recorded beside those of the passes.
    pub fn sort(&mut self, cx: &mut DrawContext<'_, '_>) {
        let start = std::time::Instant::now();
        let view = cx.camera.view_from_world();
        let depth = |p: glam::Vec3| -view.transform_point3(p).z;
        let parts = &cx.scene.parts;
        self.runs.clear();
        if let Some(buffer) = &self.indices {
            let mut triangles: Vec<(f32, u32, &DrawRun)> = parts
                .iter()
                .flat_map(|part| {
                    let first = part.run.vertices.start;
                    let all = part.centroids.iter().zip(0..);
                    all.map(move |(&c, i)| (depth(c), first + 3 * i, &part.run))
                })
                .collect();
            // Ties by place, so that the image does not depend on the order in which parts are handed over.
            triangles.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
            let mut indices = Vec::with_capacity(triangles.len() * 3);
            for (_, first, run) in triangles {
                let at = indices.len() as u32;
                indices.extend([first, first + 1, first + 2]);
                let own = DrawRun {
                    vertices: at..at + 3,
                    ..run.clone()
                };
                push_run(&mut self.runs, own);
            }
            if !indices.is_empty() {
                let queue = &cx.recorder.gpu().queue;
                queue.write_buffer(buffer, 0, bytemuck::cast_slice(&indices));
            }
        } else {
            let middle = |p: &TransparentPart| depth((p.bounds[0] + p.bounds[1]) / 2.0);
            let mut sorted: Vec<_> = parts.iter().map(|p| (middle(p), &p.run)).collect();
            sorted.sort_by(|a, b| {
                let place = |run: &DrawRun| run.vertices.start;
                b.0.total_cmp(&a.0).then(place(a.1).cmp(&place(b.1)))
            });
            self.runs
                .extend(sorted.into_iter().map(|(_, run)| run.clone()));
        }
        cx.recorder.on_the_cpu("sort", start.elapsed());
    }

    /// Draws the transparent half in this order.
    pub fn draw(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        scene: &SceneBuffers,
        frame: &FrameTargets,
        pipelines: &GeometryPipelines,
    ) {
        scene.set_corners(pass, &frame.scene_group);
        if let Some(indices) = &self.indices {
            pass.set_index_buffer(indices.slice(..), wgpu::IndexFormat::Uint32);
        }
        for run in &self.runs {
            scene.set_run(pass, pipelines, run);
            match self.order {
                Order::Triangles => pass.draw_indexed(run.vertices.clone(), 0, 0..1),
                _ => pass.draw(run.vertices.clone(), 0..1),
            }
        }
    }
}

/// The middle of a triangle.
fn centroid(corners: &[Corner]) -> glam::Vec3 {
    let sum: glam::Vec3 = corners
        .iter()
        .map(|c| glam::Vec3::from_array(c.position))
        .sum();
    sum / corners.len() as f32
}

/// The largest power of two that maps depths up to `far` below 1: multiplying by it loses no bit.
fn depth_scale(far: f32) -> f32 {
    (-(far.log2().floor() + 1.0)).exp2()
}

/// The box around some corners; `None` without any.
fn bounding_box(corners: &[Corner]) -> Option<[glam::Vec3; 2]> {
    let mut points = corners.iter().map(|c| glam::Vec3::from_array(c.position));
    let first = points.next()?;
    Some(points.fold([first; 2], |[lo, hi], p| [lo.min(p), hi.max(p)]))
}

/// Appends a run, joining it with the one before where the same pipeline draws both.
fn push_run(runs: &mut Vec<DrawRun>, run: DrawRun) {
    if run.vertices.is_empty() {
        return;
    }
    let same = |last: &DrawRun| (last.variant, last.maps) == (run.variant, run.maps);
    match runs.last_mut() {
        Some(last) if same(last) && last.vertices.end == run.vertices.start => {
            last.vertices.end = run.vertices.end;
        }
        _ => runs.push(run),
    }
}

/// How an object stands in the world.
#[derive(Clone, Copy)]
struct Turning {
    world: glam::Mat4,
    normal_matrix: glam::Mat3,
    /// Of a triangle's corners.
    order: [usize; 3],
    mirrored: bool,
}

/// What only some materials read of a corner: places on images, tangents, colours, normals.
#[derive(Default)]
struct Attributes {
    uvs: Vec<[f32; 2]>,
    tangents: Vec<[f32; 4]>,
    colors: Vec<[f32; 4]>,
    normals: Vec<[f32; 3]>,
}

impl Attributes {
    /// Those of a part whose corners are numbered `at`.
    fn extend(
        &mut self,
        at: Range<usize>,
        object: &Object,
        triangles: Range<usize>,
        variant: Variant,
        Turning {
            world,
            normal_matrix,
            order,
            mirrored,
        }: Turning,
    ) {
        let mesh = &object.mesh;
        if variant.is_mapped() && !mesh.uvs.is_empty() {
            self.uvs.resize(at.start, [0.0; 2]);
            let all = mesh.uvs[triangles.clone()].iter();
            self.uvs
                .extend(all.flat_map(|t| order.map(|k| t[k].to_array())));
        }
        if let Some(found) = variant
            .has_normal_map()
            .then(|| mesh.tangents(triangles.clone()))
            .flatten()
        {
            let sign = if mirrored { -1.0 } else { 1.0 };
            let turned = |[x, y, z, w]: [f32; 4]| {
                let tangent = world.transform_vector3(glam::Vec3::new(x, y, z));
                let [x, y, z] = tangent.normalize_or_zero().to_array();
                [x, y, z, w * sign]
            };
            self.tangents.resize(at.start, [0.0; 4]);
            self.tangents
                .extend(found.iter().flat_map(|t| order.map(|k| turned(t[k]))));
        }
        let corners = || {
            mesh.triangles[triangles.clone()]
                .iter()
                .flat_map(|t| order.map(|k| t[k] as usize))
        };
        if variant.vertex_colors {
            self.colors.resize(at.start, [1.0; 4]);
            self.colors.extend(corners().map(|i| mesh.colors[i]));
        }
        if variant.is_lit() {
            self.normals.resize(at.start, [0.0; 3]);
            let turned = |i: usize| (normal_matrix * mesh.normals[i]).normalize_or_zero();
            self.normals.extend(corners().map(|i| turned(i).to_array()));
        }
    }

    fn upload(mut self, gpu: &Gpu, corners: usize) -> [Option<wgpu::Buffer>; 4] {
        fn one<T: Pod>(gpu: &Gpu, label: &str, all: &mut Vec<T>, n: usize) -> Option<wgpu::Buffer> {
            if all.is_empty() {
                return None;
            }
            all.resize(n, T::zeroed());
            Some(gpu.upload(label, all, wgpu::BufferUsages::VERTEX))
        }
        [
            one(gpu, "places on images", &mut self.uvs, corners),
            one(gpu, "tangents", &mut self.tangents, corners),
            one(gpu, "corner colours", &mut self.colors, corners),
            one(gpu, "normals", &mut self.normals, corners),
        ]
    }
}

/// Depth test state on a 32-bit float target.
pub(crate) fn depth_state(write: bool, compare: wgpu::CompareFunction) -> wgpu::DepthStencilState {
    wgpu::DepthStencilState {
        format: wgpu::TextureFormat::Depth32Float,
        depth_write_enabled: Some(write),
        depth_compare: Some(compare),
        stencil: wgpu::StencilState::default(),
        bias: wgpu::DepthBiasState::default(),
    }
}

/// A colour attachment that starts from one value.
pub(crate) fn clear_color(
    view: &wgpu::TextureView,
    [r, g, b, a]: [f64; 4],
) -> Option<wgpu::RenderPassColorAttachment<'_>> {
    attachment(view, wgpu::LoadOp::Clear(wgpu::Color { r, g, b, a }))
}

/// A colour attachment.
pub(crate) fn attachment(
    view: &wgpu::TextureView,
    load: wgpu::LoadOp<wgpu::Color>,
) -> Option<wgpu::RenderPassColorAttachment<'_>> {
    Some(wgpu::RenderPassColorAttachment {
        view,
        depth_slice: None,
        resolve_target: None,
        ops: wgpu::Operations {
            load,
            store: wgpu::StoreOp::Store,
        },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn depth_scale_is_the_next_power_of_two() {
        for (far, scale) in [
            (0.5, 1.0),
            (0.9, 1.0),
            (1.0, 0.5),
            (100.0, 1.0 / 128.0),
            (128.0, 1.0 / 256.0),
        ] {
            assert_eq!(depth_scale(far), scale, "{far}");
            assert!(far * depth_scale(far) < 1.0);
        }
    }

    #[test]
    fn runs_join_where_they_can() {
        let material = Material::unlit([1.0; 3], 0.5);
        let object = Object::of_triangles("none", &[], material.clone());
        let setting = Setting {
            lit: false,
            sun: false,
        };
        let two_sided = Variant::of(&material, &object, setting);
        let culled = Variant {
            culled: true,
            ..two_sided
        };
        let mut runs = Vec::new();
        for (vertices, variant, maps) in [
            (0..3, two_sided, None),
            (3..9, two_sided, None),
            (9..12, culled, None),
            (12..12, culled, None),
            (15..18, culled, None),
            (18..21, culled, Some(0)),
            (21..24, culled, Some(0)),
        ] {
            let run = DrawRun {
                vertices,
                variant,
                maps,
            };
            push_run(&mut runs, run);
        }
        let vertices: Vec<_> = runs.iter().map(|r| r.vertices.clone()).collect();
        assert_eq!(vertices, [0..9, 9..12, 15..18, 18..24]);
    }
}
