use crate::geometry::{
    FrameTargets, RenderError, SceneBuffers,
    pipelines::GeometryPipelines,
    upload::{DrawRun, push_run},
};
use crate::gpu::{Kernel, bind::Bind, record::Recorder, wgpu};
use peelnet_scene::Camera;

/// The order in which transparent surfaces are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// In the scene's order.
    Scene,
    /// Parts of objects with one material, the farthest centre of a box first.
    Objects,
    /// Triangles, the farthest centre first.
    Triangles,
    /// The same, sorted on the GPU.
    TrianglesOnGpu,
}

/// The transparent surfaces in an order that depends on the view.
#[derive(Debug)]
pub struct Sorted {
    /// Vertex numbers of the sorted triangles; runs are ranges of it.
    indices: Option<wgpu::Buffer>,
    runs: Vec<DrawRun>,
    /// Where the GPU sorts them.
    kernels: Option<SortKernels>,
}

impl Sorted {
    /// Room for the order; none is needed to draw in the scene's order.
    pub fn new(scene: &SceneBuffers, order: Order) -> Result<Option<Self>, RenderError> {
        let indices = match order {
            Order::Scene => return Ok(None),
            Order::Objects => None,
            Order::Triangles | Order::TrianglesOnGpu => {
                let gpu = &scene.gpu;
                let triangles: usize = scene.transparent_parts().map(|p| p.centroids.len()).sum();
                let size = triangles.max(1) as u64 * 12;
                let what = format!("the order of {triangles} triangles");
                let hint = "sort objects instead (painter-object)";
                gpu.check_limit(what, size, gpu.limits.max_buffer_size, "bytes", hint)?;
                let usage = wgpu::BufferUsages::INDEX
                    | wgpu::BufferUsages::COPY_DST
                    | wgpu::BufferUsages::STORAGE;
                Some(gpu.buffer("sorted triangles", size, usage))
            }
        };
        let mut runs = Vec::new();
        let kernels = match (&indices, order) {
            (Some(indices), Order::TrianglesOnGpu) => {
                runs.extend(one_run(scene)?);
                Some(SortKernels::new(scene, indices)?)
            }
            _ => None,
        };
        Ok(Some(Self {
            indices,
            runs,
            kernels,
        }))
    }

    /// Bytes that the order takes on the GPU.
    pub fn bytes(&self) -> u64 {
        let own = self.kernels.as_ref().map_or(0, |kernels| kernels.bytes);
        self.indices.as_ref().map_or(0, wgpu::Buffer::size) + own
    }

    /// Sorts for a view; the time of the CPU is recorded beside those of the passes.
    pub fn sort(&mut self, recorder: &mut Recorder<'_>, scene: &SceneBuffers, camera: &Camera) {
        if let Some(kernels) = &self.kernels {
            kernels.sort(recorder);
            return;
        }
        let start = web_time::Instant::now();
        let view = camera.view_from_world();
        let depth = |p: glam::Vec3| -view.transform_point3(p).z;
        let parts = || scene.transparent_parts();
        self.runs.clear();
        if let Some(buffer) = &self.indices {
            let mut triangles: Vec<(f32, u32, &DrawRun)> = parts()
                .flat_map(|part| {
                    let first = part.run.vertices.start;
                    let all = part.centroids.iter().zip(0..);
                    all.map(move |(&c, i)| (depth(c), first + 3 * i, &part.run))
                })
                .collect();
            // Ties by place, so that the image does not depend on the order of submission.
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
            recorder.write(buffer, &indices);
        } else {
            let middle = |[lo, hi]: [glam::Vec3; 2]| depth((lo + hi) / 2.0);
            let mut sorted: Vec<_> = parts()
                .filter_map(|p| Some((middle(p.bounds?), &p.run)))
                .collect();
            sorted.sort_by(|a, b| {
                let place = |run: &DrawRun| run.vertices.start;
                b.0.total_cmp(&a.0).then(place(a.1).cmp(&place(b.1)))
            });
            self.runs
                .extend(sorted.into_iter().map(|(_, run)| run.clone()));
        }
        recorder.on_the_cpu("sort", start.elapsed());
    }

    /// Draws the transparent half in this order.
    pub fn draw(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        scene: &SceneBuffers,
        frame: &FrameTargets,
        pipelines: &GeometryPipelines,
    ) {
        scene.draw_runs(pass, frame, pipelines, &self.runs, self.indices.as_ref());
    }
}

/// Most triangles that are sorted on the GPU: one thread sums up the counts of a share of them.
const MOST_ON_GPU: u64 = 1_000_000;

/// One run over all triangles, in sorted order; nothing of a scene without any.
///
/// # Errors
/// A scene whose triangles take several pipelines: the CPU does not know where one follows another.
fn one_run(scene: &SceneBuffers) -> Result<Option<DrawRun>, RenderError> {
    let mut parts = scene.transparent_parts();
    let Some(first) = parts.next() else {
        return Ok(None);
    };
    let mut count = first.centroids.len() as u32;
    for part in parts {
        if (part.run.variant, part.run.maps) != (first.run.variant, first.run.maps) {
            return Err(RenderError::Refused(
                "sort=gpu draws one kind of material, and this scene has several; use sort=cpu"
                    .into(),
            ));
        }
        count += part.centroids.len() as u32;
    }
    Ok(Some(DrawRun {
        vertices: 0..3 * count,
        ..first.run.clone()
    }))
}

/// A radix sort of the depths of triangles' centres: four bytes, the least first, each of which keeps the order of those that are alike.
#[derive(Debug)]
struct SortKernels {
    keys: Kernel,
    /// For each byte: its counts, their places, and the keys in order of it.
    bytewise: Vec<[Kernel; 3]>,
    count: u32,
    blocks: u32,
    bytes: u64,
}

impl SortKernels {
    fn new(scene: &SceneBuffers, indices: &wgpu::Buffer) -> Result<Self, RenderError> {
        let gpu = &scene.gpu;
        let mut centers: Vec<[f32; 4]> = Vec::new();
        for part in scene.transparent_parts() {
            let vertices = (part.run.vertices.start..).step_by(3);
            let all = part.centroids.iter().zip(vertices);
            centers.extend(all.map(|(c, first)| c.extend(f32::from_bits(first)).to_array()));
        }
        let triangles = centers.len() as u64;
        let what = format!("sort=gpu of {triangles} triangles");
        gpu.check_limit(what, triangles, MOST_ON_GPU, "triangles", "use sort=cpu")?;
        centers.resize(centers.len().max(1), [0.0; 4]);
        let count = triangles as u32;
        let blocks = count.div_ceil(256).max(1);
        let centers = gpu.upload("centers", &centers, wgpu::BufferUsages::STORAGE);
        let keys = ["keys", "keys, other"].map(|label| gpu.storage(label, 8 * triangles.max(1)));
        let [keys, others] = keys;
        let (keys, others) = (keys?, others?);
        let counts = gpu.storage("counts of keys", u64::from(blocks) * 1024)?;
        let usage = wgpu::BufferUsages::UNIFORM;
        let extent = gpu.upload("extent of keys", &[count, blocks, 0, 0], usage);
        let bytes = 16 * triangles + 2 * keys.size() + counts.size();
        let extent = ("extent", Bind::Uniform(&extent));
        let first = Kernel::link(
            gpu,
            "passes::sort::keys",
            &[],
            &[],
            &[
                extent,
                ("camera", Bind::Uniform(&scene.camera)),
                ("centers", Bind::Read(&centers)),
                ("sorted", Bind::Write(&keys)),
            ],
        )?;
        let mut bytewise = Vec::new();
        for (byte, (from, to)) in [(&keys, &others), (&others, &keys)]
            .into_iter()
            .cycle()
            .take(4)
            .enumerate()
        {
            let shift = format!("const SHIFT: u32 = {}u;\n", 8 * byte);
            let modules = [("parameters", shift.as_str())];
            let last: &[&str] = if byte == 3 { &["last"] } else { &[] };
            let sorted = ("sorted", Bind::Read(from));
            let named = [
                extent,
                sorted,
                ("counts", Bind::Read(&counts)),
                ("next", Bind::Write(to)),
                ("indices", Bind::Write(indices)),
            ];
            let written = ("counts", Bind::Write(&counts));
            let link = |shader, features, named: &[(&str, Bind<'_>)]| {
                Kernel::link(gpu, shader, features, &modules, named)
            };
            bytewise.push([
                link("passes::sort::count", &[], &[extent, sorted, written])?,
                Kernel::link(gpu, "passes::sort::scan", &[], &[], &[extent, written])?,
                link("passes::sort::scatter", last, &named)?,
            ]);
        }
        Ok(Self {
            keys: first,
            bytewise,
            count,
            blocks,
            bytes,
        })
    }

    fn sort(&self, recorder: &mut Recorder<'_>) {
        self.keys.dispatch(recorder, self.count);
        for [count, scan, scatter] in &self.bytewise {
            count.dispatch(recorder, 64 * self.blocks);
            scan.dispatch(recorder, 64);
            scatter.dispatch(recorder, 64 * self.blocks);
        }
    }
}
