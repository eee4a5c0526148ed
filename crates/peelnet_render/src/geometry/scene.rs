//! A scene's buffers, drawn from every view by every method, and edited in place.

use crate::geometry::{
    FrameTargets, GeometryPipelines, PixelSample, RenderError, SamplePoint,
    frame::{OpaqueDepth, attachment, clear_color, depth_attachment},
    maps::MapSets,
    splats::SplatBuffers,
    uniforms::{CameraUniform, MaterialData, unit_from_depth},
    upload::{ATTRIBUTES, Attributes, DrawRun, Placement, Vertex, extend, floats, push_run},
};
use crate::gpu::{
    Gpu,
    bind::{Bind, Bound},
    record::Recorder,
    wgpu,
};
use bytemuck::Zeroable;
use peelnet_core::{absorbance::DepthWarp, srgb};
use peelnet_scene::{Blending, Camera, EFFECTS, MaterialFlags, Object, Scene};
use std::collections::{BTreeSet, HashSet};

/// The order in which the transparent parts of objects are submitted to the GPU. Depths, numbers of triangles and everything that is
/// computed of them stay as they are: only what depends on the order of drawing may change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Submission {
    /// In the scene's order.
    Listed,
    /// The last first.
    Reversed,
    /// By a hash of their places and this seed.
    Shuffled(u32),
}

/// A part of an object with one material, on the GPU.
#[derive(Clone, Debug)]
pub(crate) struct PartBuffers {
    /// Number of its object and of the part in it.
    pub(crate) place: (usize, usize),
    pub(crate) run: DrawRun,
    pub(crate) opaque: bool,
    /// World-space box; `None` of no triangles.
    pub(crate) bounds: Option<[glam::Vec3; 2]>,
    /// World-space centre of every triangle, of transparent parts.
    pub(crate) centroids: Vec<glam::Vec3>,
}

/// Label of the pass that draws the background and the opaque surfaces.
pub const BACKGROUND_PASS: &str = "background";

/// A scene's buffers, the same for every view and method.
///
/// Objects, materials and lights change in place; [`SceneBuffers::generation`] counts the changes that need other pipelines, bind
/// groups or targets. Changes apply to all commands submitted after them.
#[derive(Debug)]
pub struct SceneBuffers {
    pub gpu: Gpu,
    pub(crate) scene: Scene,
    pub(crate) vertices: wgpu::Buffer,
    pub(crate) vertex_count: usize,
    /// For every vertex the first one that is the same.
    pub(crate) shared: wgpu::Buffer,
    /// In the order of [`ATTRIBUTES`], for every vertex; each where any material reads it.
    pub(crate) attributes: [Option<wgpu::Buffer>; ATTRIBUTES.len()],
    /// Where there are any.
    pub(crate) splats: Option<SplatBuffers>,
    pub(crate) maps: MapSets,
    pub(crate) materials: wgpu::Buffer,
    /// Where any material is lit.
    pub(crate) lights: Option<wgpu::Buffer>,
    /// The view's uniform.
    pub camera: wgpu::Buffer,
    /// In the scene's order; a part's number is its material's.
    pub(crate) parts: Vec<PartBuffers>,
    /// The order in which transparent parts are submitted.
    submission: Submission,
    submitted: Vec<usize>,
    opaque: Vec<DrawRun>,
    transparent: Vec<DrawRun>,
    pub(crate) generation: u64,
    /// Whether every colour is grey.
    pub grey: bool,
    /// Whether transmission is coloured.
    pub tinted: bool,
}

fn corners_of([lo, hi]: [glam::Vec3; 2]) -> impl Iterator<Item = glam::Vec3> {
    (0..8).map(move |i| {
        let pick = |bit: u32, k: usize| if i >> bit & 1 == 0 { lo[k] } else { hi[k] };
        glam::Vec3::new(pick(0, 0), pick(1, 1), pick(2, 2))
    })
}

impl SceneBuffers {
    /// Transforms the scene to world space and uploads it.
    ///
    /// # Errors
    /// A scene larger than the adapter's largest buffer.
    pub fn new(gpu: &Gpu, scene: &Scene) -> Result<Self, RenderError> {
        let triangles = scene.triangles();
        let needed = triangles as u64 * 3 * size_of::<Vertex>() as u64;
        // Numbers of vertices have 32 bits.
        let limit = gpu
            .limits
            .max_buffer_size
            .min(u64::from(u32::MAX) * size_of::<Vertex>() as u64);
        let what = format!("scene '{}' with {triangles} triangles", scene.name);
        let hint = "split the scene or simplify its meshes";
        gpu.check_limit(what, needed, limit, "bytes", hint)?;
        let lights = scene.light_flags();
        let mut attributes: Attributes = Default::default();
        let splats = SplatBuffers::new(gpu, scene)?;
        let mut maps = MapSets::default();
        let mut vertices = Vec::with_capacity(triangles * 3);
        let mut shared = Vec::with_capacity(triangles * 3);
        let mut materials = Vec::new();
        let mut parts = Vec::new();
        for (number, object) in scene.objects.iter().enumerate() {
            let first_splat = splats.as_ref().map_or(0, |all| all.first(number));
            let placement = Placement::from_object(object);
            let all = object.mesh.parts.iter().zip(&object.materials);
            for (part_number, (part, material)) in all.enumerate() {
                let index = materials.len() as u32;
                materials.push(MaterialData::from_material(
                    material,
                    object.layer.unwrap_or(0),
                ));
                let variant = MaterialFlags::new(material, object, lights);
                let begin = vertices.len();
                vertices.extend(placement.vertices(part.triangles.clone(), index));
                let of_part = placement.attributes(&part.triangles, variant, first_splat);
                shared.extend(placement.shared(&part.triangles, &of_part, begin));
                extend(&mut attributes, begin, of_part);
                let mut buffers = PartBuffers {
                    place: (number, part_number),
                    run: DrawRun {
                        vertices: begin as u32..vertices.len() as u32,
                        variant,
                        maps: maps.number(gpu, material, variant, &part.triangles)?,
                    },
                    opaque: material.is_opaque(),
                    bounds: None,
                    centroids: Vec::new(),
                };
                buffers.measure(&vertices[begin..], object);
                parts.push(buffers);
            }
        }
        // A binding may not be smaller than one element.
        materials.resize(materials.len().max(1), MaterialData::zeroed());
        let attributes = std::array::from_fn(|i| {
            let all = &mut attributes[i];
            (!all.is_empty()).then(|| {
                all.resize(vertices.len() * floats(i), 0.0);
                gpu.upload(ATTRIBUTES[i].0, all, wgpu::BufferUsages::VERTEX)
            })
        });
        let camera = [CameraUniform::zeroed()];
        let mut buffers = Self {
            gpu: gpu.clone(),
            attributes,
            splats,
            maps,
            vertices: gpu.upload("vertices", &vertices, wgpu::BufferUsages::VERTEX),
            vertex_count: vertices.len(),
            shared: gpu.upload("shared vertices", &shared, wgpu::BufferUsages::INDEX),
            materials: gpu.upload("materials", &materials, wgpu::BufferUsages::STORAGE),
            lights: None,
            camera: gpu.upload("camera", &camera, wgpu::BufferUsages::UNIFORM),
            parts,
            submission: Submission::Listed,
            submitted: Vec::new(),
            opaque: Vec::new(),
            transparent: Vec::new(),
            generation: 0,
            grey: scene.is_grey(),
            tinted: scene.is_tinted(),
            scene: scene.clone(),
        };
        buffers.upload_lights()?;
        buffers.arrange();
        Ok(buffers)
    }

    /// The scene as it stands after all changes.
    pub const fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Counts the changes that need pipelines, bind groups or targets made anew (from caches).
    pub const fn generation(&self) -> u64 {
        self.generation
    }

    /// Puts the runs of triangles in order.
    pub(crate) fn arrange(&mut self) {
        let parts = self.parts.iter().enumerate();
        let transparent = parts.filter(|(_, p)| !p.opaque && !p.run.vertices.is_empty());
        self.submitted = transparent.map(|(number, _)| number).collect();
        self.submitted.sort_by_key(|&number| {
            let place = self.parts[number].run.vertices.start;
            match self.submission {
                Submission::Listed => place,
                Submission::Reversed => u32::MAX - place,
                Submission::Shuffled(seed) => peelnet_core::hash::pixel_hash(seed, 0, place, 0),
            }
        });
        self.opaque.clear();
        self.transparent.clear();
        for part in self.parts.iter().filter(|p| p.opaque) {
            push_run(&mut self.opaque, part.run.clone());
        }
        for &number in &self.submitted {
            push_run(&mut self.transparent, self.parts[number].run.clone());
        }
    }

    /// Submits the transparent parts in another order from now on.
    pub fn submit(&mut self, order: Submission) {
        self.submission = order;
        self.arrange();
    }

    /// The transparent parts in the order of submission.
    pub(crate) fn transparent_parts(&self) -> impl Iterator<Item = &PartBuffers> {
        self.submitted.iter().map(|&number| &self.parts[number])
    }

    /// Names of the bindings of the scene that a transparent pass has.
    pub fn bindings(&self) -> Vec<&'static str> {
        let drawn = || self.parts.iter().filter(|p| p.run.maps.is_some());
        let mapped = |flag: MaterialFlags| drawn().any(|p| p.run.variant.contains(flag));
        let mut names = vec!["camera", "materials"];
        names.extend(self.lights.is_some().then_some("lights"));
        if self.splats.is_some() {
            names.extend(["splats", "harmonics"]);
        }
        names.extend(self.has_opaque().then_some("opaque depth"));
        names.extend(drawn().next().map(|_| "sampler"));
        let maps = (EFFECTS.iter()).filter(|e| MaterialFlags::MAPS.contains(&e.flag));
        names.extend(maps.filter(|e| mapped(e.flag)).map(|e| e.name));
        names
    }

    /// Names of the attributes of a vertex that the vertex shader reads.
    pub fn vertex_attributes(&self) -> Vec<&'static str> {
        let extra = ATTRIBUTES.iter().zip(&self.attributes);
        let extra = extra.filter_map(|((name, ..), buffer)| buffer.as_ref().map(|_| *name));
        ["position", "material"].into_iter().chain(extra).collect()
    }

    /// Whether anything opaque can hide transparent fragments.
    pub fn has_opaque(&self) -> bool {
        !self.opaque.is_empty()
    }

    /// Bind group 0 of opaque passes and of transparent ones.
    pub(crate) fn groups(&self, depth: Option<&OpaqueDepth>) -> [Bound; 2] {
        let stages = wgpu::ShaderStages::VERTEX_FRAGMENT;
        let mut entries = vec![
            (0, Bind::Uniform(&self.camera)),
            (1, Bind::Read(&self.materials)),
        ];
        // Where nothing is lit no light is bound.
        entries.extend(self.lights.as_ref().map(|lights| (2, Bind::Read(lights))));
        if let Some(splats) = &self.splats {
            entries.extend([
                (4, Bind::Read(&splats.splats)),
                (5, Bind::Read(&splats.harmonics)),
            ]);
        }
        let opaque = self.gpu.bind("opaque scene", stages, &entries);
        entries.extend(depth.map(|depth| (3, Bind::Texture(&depth.view))));
        [opaque, self.gpu.bind("scene", stages, &entries)]
    }

    /// Records the write of a view into the camera uniform; `point` is where pixels are sampled.
    pub fn set_view(
        &self,
        recorder: &mut Recorder<'_>,
        camera: &Camera,
        frame: &FrameTargets,
        sample: PixelSample,
        point: SamplePoint,
    ) {
        let clip_from_world = clip_from_world(camera, frame, point);
        let warp = self.depth_warp(camera);
        let uniform = CameraUniform {
            clip_from_world: clip_from_world.to_cols_array_2d(),
            eye: camera.position.to_array(),
            light_count: self.scene.lights.len() as u32,
            frame_size: frame.size,
            sample_seed: sample.seed,
            sample_view: sample.view,
            sample_threshold: sample.threshold,
            unit_from_depth: unit_from_depth(camera.far),
            warp_inverse_near: (-warp.near.ln()).exp() as f32,
            warp_near: warp.near as f32,
            warp_scale: warp.scale as f32,
            window_depth_at_infinity: camera.far / (camera.far - camera.near),
            pad: [0; 2],
            gaps: [0, 1, 2, 3].map(|k| warp.gaps[k / 2][k % 2] as f32),
        };
        recorder.write(&self.camera, &[uniform]);
    }

    /// The warp over the depths that transparent objects span in a view: from their boxes, clipped to near and far. A tight
    /// range is what moments get their precision from.
    pub fn depth_warp(&self, camera: &Camera) -> DepthWarp {
        let view = camera.view_from_world();
        let depth = |p| (-view.transform_point3(p).z).clamp(camera.near, camera.far);
        let spans = self.boxes().map(|bounds| {
            let depths = corners_of(bounds).map(depth);
            depths.fold([f32::INFINITY, 0.0], |[a, b], z| [a.min(z), b.max(z)])
        });
        let spans: Vec<[f32; 2]> = spans.collect();
        let none = [f32::INFINITY, 0.0];
        let [near, far] =
            (spans.iter()).fold(none, |[a, b], span| [a.min(span[0]), b.max(span[1])]);
        if near <= far {
            let warp = DepthWarp::new(near.into(), far.into());
            warp.with_spans(spans.into_iter().map(|span| span.map(f64::from)))
        } else {
            DepthWarp::new(camera.near.into(), camera.far.into())
        }
    }

    /// The boxes around transparent parts, in world space.
    fn boxes(&self) -> impl Iterator<Item = [glam::Vec3; 2]> {
        self.transparent_parts().filter_map(|part| part.bounds)
    }

    /// A rectangle of pixels (x, y, width, height) outside which no transparent surface is seen: around the boxes of all of them, and the
    /// whole frame where one reaches behind the eye. Never empty.
    pub fn touched(&self, camera: &Camera, frame: &FrameTargets, point: SamplePoint) -> [u32; 4] {
        let clip = clip_from_world(camera, frame, point);
        let size = glam::Vec2::from_array(frame.size.map(|s| s as f32));
        let (mut low, mut high) = (size, glam::Vec2::ZERO);
        for corner in self.boxes().flat_map(corners_of) {
            let place = clip * corner.extend(1.0);
            // Splats are blurred on the screen, beyond their boxes.
            if place.w <= 0.0 || self.splats.is_some() {
                (low, high) = (glam::Vec2::ZERO, size);
                break;
            }
            let [x, y] = [place.x / place.w, place.y / place.w];
            let pixel = glam::Vec2::new(0.5 + 0.5 * x, 0.5 - 0.5 * y) * size;
            (low, high) = (low.min(pixel), high.max(pixel));
        }
        // A pixel more on every side than rounding can take.
        let low = (low - 1.0).floor().clamp(glam::Vec2::ZERO, size - 1.0);
        let high = (high + 1.0).ceil().clamp(low + 1.0, size);
        let extent = high - low;
        [low.x, low.y, extent.x, extent.y].map(|v| v as u32)
    }

    pub(crate) fn half<'a>(
        &'a self,
        frame: &'a FrameTargets,
        opaque: bool,
    ) -> (&'a Bound, &'a [DrawRun]) {
        if opaque {
            (&frame.opaque_group, &self.opaque)
        } else {
            (&frame.scene_group, &self.transparent)
        }
    }

    /// Draws the half of the scene that the pipelines are of, triangles in the order of the scene's list.
    pub fn draw(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        frame: &FrameTargets,
        pipelines: &GeometryPipelines,
    ) {
        let runs = self.half(frame, pipelines.opaque).1;
        self.draw_runs(pass, frame, pipelines, runs, None);
    }

    /// Draws runs of triangles, of `indices` where there are any. Otherwise each vertex is drawn once where no pipeline asks for the number
    /// of its triangle.
    pub(crate) fn draw_runs(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        frame: &FrameTargets,
        pipelines: &GeometryPipelines,
        runs: &[DrawRun],
        indices: Option<&wgpu::Buffer>,
    ) {
        let scene_group = self.half(frame, pipelines.opaque).0;
        let groups = [Some(scene_group), pipelines.group.as_ref()];
        for (bound, index) in groups.iter().zip(0..) {
            pass.set_bind_group(index, bound.map(|bound| &bound.group), &[]);
        }
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        for (buffer, slot) in self.attributes.iter().zip(1..) {
            if let Some(buffer) = buffer {
                pass.set_vertex_buffer(slot, buffer.slice(..));
            }
        }
        if let Some(indices) = indices {
            pass.set_index_buffer(indices.slice(..), wgpu::IndexFormat::Uint32);
        }
        for run in runs {
            // There is one for every run's variant.
            let mut variants = pipelines.variants.iter();
            let Some(found) = variants.find(|p| p.variant == run.variant) else {
                continue;
            };
            pass.set_pipeline(&found.pipeline);
            if let Some(number) = run.maps {
                pass.set_bind_group(2, &self.maps.bound(number).group, &[]);
            }
            if indices.is_none() && found.numbered {
                pass.draw(run.vertices.clone(), 0..1);
                continue;
            }
            if indices.is_none() {
                pass.set_index_buffer(self.shared.slice(..), wgpu::IndexFormat::Uint32);
            }
            pass.draw_indexed(run.vertices.clone(), 0, 0..1);
        }
    }

    /// Draws what lies behind the transparent surfaces: background colour and opaque objects, into `C_0`, or onto `target` where the
    /// output blends over it (the background only if `clear`).
    pub fn draw_background(
        &self,
        recorder: &mut Recorder<'_>,
        frame: &FrameTargets,
        target: Option<&wgpu::TextureView>,
        clear: bool,
    ) {
        let background = match self.scene.blending {
            Blending::Linear => self.scene.background,
            Blending::Display => self.scene.background.map(srgb::encode),
        };
        let [r, g, b] = background.map(f64::from);
        let begin = [r, g, b, 1.0];
        let (over, pipelines) = (frame.output.is_over(), frame.opaque.as_ref());
        if over && !clear && pipelines.is_none() {
            return;
        }
        let color = match target.filter(|_| over) {
            Some(view) if clear => clear_color(view, begin),
            Some(view) => attachment(view, wgpu::LoadOp::Load),
            None => clear_color(&frame.background, begin),
        };
        // Attached where the pass has that many samples: depth of the caller's for a C_0 of our own may have others.
        let depth = frame
            .depth
            .as_ref()
            .filter(|_| pipelines.is_some() || !over);
        let depth = depth.map(|depth| {
            let load = if depth.is_callers {
                wgpu::LoadOp::Load
            } else {
                wgpu::LoadOp::Clear(1.0)
            };
            depth_attachment(&depth.view, load, wgpu::StoreOp::Store)
        });
        let mut pass = recorder.render(BACKGROUND_PASS, &[color], depth);
        if let Some(pipelines) = pipelines {
            self.draw(&mut pass, frame, pipelines);
        }
    }
}

fn clip_from_world(camera: &Camera, frame: &FrameTargets, point: SamplePoint) -> glam::Mat4 {
    point.shift() * camera.clip_from_view(frame.aspect) * camera.view_from_world()
}

impl PartBuffers {
    pub(crate) fn measure(&mut self, vertices: &[Vertex], object: &Object) {
        let points = || vertices.iter().map(|v| glam::Vec3::from_array(v.position));
        let [lo, hi] = [glam::Vec3::min, glam::Vec3::max].map(|pick| points().reduce(pick));
        self.bounds = lo.zip(hi).map(|(lo, hi)| [lo, hi]);
        if object.mesh.splats.is_some() {
            // They reach beyond their centres, which the box of the mesh knows.
            let box_of = object.mesh.box_of(self.place.1);
            let corners = box_of.into_iter().flat_map(|from_unit| {
                let unit = [glam::Vec3::ZERO, glam::Vec3::ONE];
                corners_of(unit).map(move |p| from_unit.transform_point3(p))
            });
            let corners = corners.map(|p| object.world_from_object.transform_point3(p));
            let boxes = corners.map(|p| [p, p]);
            self.bounds = boxes.reduce(|[lo, hi], [p, _]| [lo.min(p), hi.max(p)]);
        }
        let points: Vec<_> = points().collect();
        let (triangles, _) = points.as_chunks::<3>();
        let middle = |triangle: &[glam::Vec3; 3]| triangle.iter().sum::<glam::Vec3>() / 3.0;
        self.centroids = triangles.iter().map(middle).collect();
    }
}

/// Bytes of shader text that a scene's surfaces link, without tests of visibility: the opaque pass and one that gathers premultiplied
/// colour (`blended`), a text for each variant.
pub fn shader_bytes(scene: &Scene) -> Result<usize, RenderError> {
    let lights = scene.light_flags();
    let mut variants = HashSet::new();
    for object in &scene.objects {
        let parts = object.mesh.parts.iter().zip(&object.materials);
        let parts = parts.filter(|(part, _)| !part.triangles.is_empty());
        let flags = |m| (MaterialFlags::new(m, object, lights), m.is_opaque());
        variants.extend(parts.map(|(_, material)| flags(material)));
    }
    let mut texts = BTreeSet::new();
    for (flags, is_opaque) in variants {
        let pass = match is_opaque {
            true => "scene::opaque",
            false => "methods::blended::gather",
        };
        for shader in ["scene::vertex", pass] {
            let shader = crate::shaders::link(shader, &flags.features(), &[])?;
            texts.insert(shader.text.clone());
        }
    }
    Ok(texts.iter().map(String::len).sum())
}
