use crate::geometry::{
    FrameTargets, RenderError, SceneBuffers,
    pipelines::GeometryPipelines,
    upload::{DrawRun, push_run},
};
use crate::gpu::{record::Recorder, wgpu};
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
}

/// The transparent surfaces in an order that depends on the view.
#[derive(Debug)]
pub struct Sorted {
    /// Vertex numbers of the sorted triangles; runs are ranges of it.
    indices: Option<wgpu::Buffer>,
    runs: Vec<DrawRun>,
}

impl Sorted {
    /// Room for the order; none is needed to draw in the scene's order.
    pub fn new(scene: &SceneBuffers, order: Order) -> Result<Option<Self>, RenderError> {
        let indices = match order {
            Order::Scene => return Ok(None),
            Order::Objects => None,
            Order::Triangles => {
                let gpu = &scene.gpu;
                let triangles: usize = scene.transparent_parts().map(|p| p.centroids.len()).sum();
                let size = triangles.max(1) as u64 * 12;
                let what = format!("the order of {triangles} triangles");
                let hint = "sort objects instead (painter-object)";
                gpu.check_limit(what, size, gpu.limits.max_buffer_size, "bytes", hint)?;
                let usage = wgpu::BufferUsages::INDEX | wgpu::BufferUsages::COPY_DST;
                Some(gpu.buffer("sorted triangles", size, usage))
            }
        };
        let runs = Vec::new();
        Ok(Some(Self { indices, runs }))
    }

    /// Bytes that the order takes on the GPU.
    pub fn bytes(&self) -> u64 {
        self.indices.as_ref().map_or(0, wgpu::Buffer::size)
    }

    /// Sorts for a view, on the CPU; its time is recorded beside those of the passes.
    pub fn sort(&mut self, recorder: &mut Recorder<'_>, scene: &SceneBuffers, camera: &Camera) {
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
