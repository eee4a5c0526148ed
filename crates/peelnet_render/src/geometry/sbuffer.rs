//! The S-buffer (Vasilakis & Fudos 2012): every fragment of a tile, in storage of exactly the right size, sorted.
//!
//! Storage is bounded: a frame whose fragments exceed the budget is worked off in tiles, runs of row-major pixels
//! whose fragments fit. Nothing is dropped: every sort counts what is out of order, lost or stored twice behind it ([`CountPass::faults`]).

use crate::geometry::{
    FrameTargets, GeometryPass, GeometryPipelines, Needs, RenderError, SceneBuffers,
    count::{CountPass, FragmentCount},
    error::over_budget,
    fragments::{FragmentStorage, Tile, color_bytes, tiles},
    frame::unwritten_attachment,
    long_runs::{LongRuns, MAX_RUN, SHORT, kernel},
};
use crate::gpu::{GpuError, Kernel, bind::Bind, record::Recorder, wgpu};
use bytemuck::Zeroable;

/// Store and sort, for one tile at a time.
#[derive(Debug)]
pub struct SBuffer {
    pub count: CountPass,
    /// Uniform that holds the tile being worked on.
    pub tile: wgpu::Buffer,
    /// Fragments that one tile may hold: what the adapter, the budget and memory allow.
    pub limit: u64,
    store: Option<Kernels>,
    features: Vec<&'static str>,
    tinted: bool,
}

#[derive(Debug)]
struct Kernels {
    storage: FragmentStorage,
    /// Fragments of a pixel that are sorted.
    most: u32,
    store: GeometryPipelines,
    sort: Kernel,
    /// Where a pixel may have more than [`SHORT`] fragments.
    long: Option<LongRuns>,
}

impl SBuffer {
    /// Builds the passes. `budget` bounds the fragments of a tile; `features` may hold `sampled`, and one of
    /// `dataset`, `tinted`, `layered` and `named`, which say what is kept of a fragment; `half_colors` or `byte_colors` rounds it.
    pub fn new(
        scene: &SceneBuffers,
        frame: &FrameTargets,
        budget: Option<u64>,
        features: &[&'static str],
    ) -> Result<Self, RenderError> {
        let (gpu, tinted) = (&scene.gpu, features.contains(&"tinted"));
        let limits = &gpu.limits;
        let largest = limits.max_storage_buffer_binding_size;
        let binding = largest.min(limits.max_buffer_size) / color_bytes(tinted);
        Ok(Self {
            count: CountPass::new(scene, frame, features)?,
            tile: gpu.upload("tile", &[Tile::zeroed()], wgpu::BufferUsages::UNIFORM),
            limit: budget.map_or(binding, |b| b.clamp(1, binding)),
            store: None,
            features: features.to_vec(),
            tinted,
        })
    }

    /// Fragment storage, once [`Self::plan`] has made it.
    pub fn storage(&self) -> Option<&FragmentStorage> {
        self.store.as_ref().map(|k| &k.storage)
    }

    /// What the names of kernels over a tile's fragments stand for.
    pub fn named<'a>(&'a self, storage: &'a FragmentStorage) -> [(&'static str, Bind<'a>); 7] {
        [
            ("tile", &self.tile),
            ("counts", &self.count.counts),
            ("offsets", &self.count.offsets),
            ("faults", &self.count.faults),
            ("depths", &storage.depths),
            ("triangles", &storage.triangles),
            ("colors", &storage.colors),
        ]
        .map(|(name, buffer)| (name, Bind::Buffer(buffer)))
    }

    /// How long runs are sorted, once [`Self::plan`] has made room for them.
    pub fn long_runs(&self) -> Option<&LongRuns> {
        self.store.as_ref()?.long.as_ref()
    }

    /// Fragments of a pixel that [`Self::plan`] has made room for. A frame that has more in one is not sorted.
    pub fn most(&self) -> u32 {
        self.store.as_ref().map_or(SHORT, |k| k.most)
    }

    /// Bytes of one fragment in storage: depth, triangle, its colours, and its places in the orders of long runs.
    pub fn bytes_per_fragment(&self) -> f64 {
        let long = self.long_runs().map_or(0.0, |_| LongRuns::BYTES);
        (4 + 4 + color_bytes(self.tinted)) as f64 + long
    }

    /// Decides the tiles of a frame of `needed` fragments and makes storage for the largest; returns whether storage was made anew, or
    /// `None` where the frame needs several tiles and so the offsets of its pixels. Where the GPU has no memory for it, tiles get
    /// smaller until they fit.
    ///
    /// # Errors
    /// A pixel that does not fit, or a lost device.
    pub fn plan(
        &mut self,
        scene: &SceneBuffers,
        frame: &FrameTargets,
        needed: FragmentCount,
        offsets: Option<&[u32]>,
    ) -> Result<Option<(Vec<Tile>, bool)>, RenderError> {
        let FragmentCount { total, most } = needed;
        if most > MAX_RUN {
            return Err(over_budget(most.into(), MAX_RUN.into()));
        }
        let has_room = most <= self.most();
        // A power of two, so that a moving camera does not grow it every frame.
        let most = if has_room {
            self.most()
        } else {
            most.next_power_of_two()
        };
        let pixels = frame.pixels();
        loop {
            let (mut tiles, largest) = if total <= self.limit {
                (vec![Tile::new(0, pixels, total)], total)
            } else if let Some(offsets) = offsets {
                let tiles = tiles(offsets, frame.size[0], self.limit)?;
                (tiles, self.limit)
            } else {
                return Ok(None);
            };
            let known = self.storage().map(|s| s.capacity);
            let capacity = known.filter(|&c| c >= largest && has_room);
            for tile in &mut tiles {
                *tile = Tile::new(tile.begin, tile.end, capacity.unwrap_or(largest));
            }
            if capacity.is_some() {
                return Ok(Some((tiles, false)));
            }
            // The old storage goes first, so that both are never held at once.
            self.store = None;
            match self.kernels(scene, frame, largest, most) {
                Ok(kernels) => {
                    self.store = Some(kernels);
                    return Ok(Some((tiles, true)));
                }
                // Smaller tiles, from now on, until a pixel does not fit.
                Err(RenderError::Gpu(GpuError::OutOfMemory { .. })) if largest > 1 => {
                    self.limit = largest / 2;
                }
                Err(e) => return Err(e),
            }
        }
    }

    fn kernels(
        &self,
        scene: &SceneBuffers,
        frame: &FrameTargets,
        fragments: u64,
        most: u32,
    ) -> Result<Kernels, RenderError> {
        let gpu = &scene.gpu;
        let storage = FragmentStorage::new(gpu, fragments, self.tinted)?;
        let mut named = self.named(&storage).to_vec();
        // Which surfaces there are takes their materials' numbers alone.
        let needs = match self.features.contains(&"named") {
            true => Needs::MATERIAL,
            false => Needs::COLOR,
        };
        let pass = GeometryPass {
            label: "store",
            shader: "peel::store",
            needs: needs | Needs::TRIANGLE,
            features: &self.features,
            entries: &named,
            ..GeometryPass::NONE
        };
        let store = scene.pipelines(frame, &pass)?;
        let long = (most > SHORT)
            .then(|| LongRuns::new(gpu, &named, fragments, most))
            .transpose()?;
        let mut features = Vec::from_iter(self.tinted.then_some("tinted"));
        if let Some(long) = &long {
            named.push(("order", Bind::Buffer(&long.order)));
            features.push("long");
        }
        Ok(Kernels {
            sort: kernel(gpu, "peel::sort", &features, &named)?,
            long,
            most,
            storage,
            store,
        })
    }

    /// Stores and sorts one tile's fragments, in storage that [`Self::plan`] made, and adds what is wrong to [`CountPass::faults`].
    pub fn store_and_sort(
        &self,
        recorder: &mut Recorder<'_>,
        scene: &SceneBuffers,
        frame: &FrameTargets,
        tile: &Tile,
    ) {
        let Some(kernels) = &self.store else {
            return;
        };
        recorder.write(&self.tile, &[*tile]);
        {
            let mut pass = recorder.render(
                "store",
                &[unwritten_attachment(&self.count.attachment)],
                None,
            );
            let [x, y, w, h] = tile.scissor(frame.size[0]);
            pass.set_scissor_rect(x, y, w, h);
            scene.draw(&mut pass, frame, &kernels.store);
        }
        kernels.sort.dispatch(recorder, tile.end - tile.begin);
        if let Some(long) = &kernels.long {
            long.sort(recorder);
        }
    }
}
