//! Finds all fragments of a view, tile by tile, in one of three ways that leave the same runs in storage.

use crate::PeelError;
use peelnet_core::absorbance::DepthWarp;
use peelnet_render::geometry::{
    FrameTargets, PixelSample, RenderError, SamplePoint, SceneBuffers,
    count::{CountPass, FragmentCount},
    depth_peel::DepthPeel,
    fragments::Tile,
    frame::Output,
    sbuffer::SBuffer,
};
use peelnet_render::gpu::{
    Gpu, Kernel,
    bind::Bind,
    record::{Recorder, Timer},
    wgpu,
};
use peelnet_scene::{Camera, Scene};
use std::{fmt, str::FromStr};

/// How fragments are found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Peel {
    /// Count, prefix sum, exact store, sort per pixel.
    #[default]
    SBuffer,
    /// Dual depth peeling: two layers a pass. Loses coplanar fragments, and says how many.
    Dual,
    /// Front to back, one layer a pass.
    Single,
}

impl Peel {
    const NAMES: [(Self, &str); 3] = [
        (Self::SBuffer, "sbuffer"),
        (Self::Dual, "dual"),
        (Self::Single, "single"),
    ];
}

impl FromStr for Peel {
    type Err = String;

    fn from_str(s: &str) -> Result<Self, String> {
        let found = Self::NAMES.into_iter().find(|(_, name)| *name == s);
        let found = found.map(|(peel, _)| peel);
        found.ok_or_else(|| format!("'{s}' is not one of sbuffer, dual, single"))
    }
}

impl fmt::Display for Peel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(Self::NAMES[*self as usize].1)
    }
}

/// What a tile left in GPU storage, read back.
#[derive(Debug, Default)]
pub struct RawTile {
    /// Row-major index of the first pixel.
    pub first_pixel: u32,
    /// First fragment of each pixel and the total, counted from the tile's first fragment.
    pub offsets: Vec<u32>,
    /// Linear depths; 0 in a slot that peeling left empty.
    pub depths: Vec<f32>,
    /// Un-premultiplied linear radiance and alpha.
    pub colors: Vec<[f32; 4]>,
    /// Indices in the scene's list of triangles, which is the order of drawing; empty unless asked for, see
    /// [`FragmentReader::keep_triangles`].
    pub triangles: Vec<u32>,
}

/// A scene made ready for peeling at one frame size.
#[derive(Debug)]
pub struct FragmentReader {
    gpu: Gpu,
    scene: SceneBuffers,
    frame: FrameTargets,
    sbuffer: SBuffer,
    /// Passes that find layers, for the ways that do not store and sort.
    peeler: Option<DepthPeel>,
    /// They put peeled layers into runs, in turn; made anew when storage grows.
    collectors: Option<[Kernel; 2]>,
    step: wgpu::Buffer,
    with_triangles: bool,
    /// Its memory is used again.
    tile: RawTile,
}

/// What was found in one view.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ReadBack {
    /// Fragments of its fullest pixel.
    pub max_layers: u32,
    /// Tiles it took.
    pub tiles: u32,
    /// GPU time of all passes, microseconds; 0 without timestamps.
    pub gpu_micros: f64,
}

impl FragmentReader {
    /// Uploads a scene. `sampled` if views will be given a real [`PixelSample`]; `budget` bounds a tile's fragments.
    ///
    /// # Errors
    /// A scene or frame beyond the adapter's limits, or a feature it lacks.
    pub fn new(
        gpu: &Gpu,
        scene: &Scene,
        size: [u32; 2],
        peel: Peel,
        sampled: bool,
        budget: Option<u64>,
    ) -> Result<Self, PeelError> {
        let features = &["dataset", "sampled"][..1 + usize::from(sampled)];
        let scene = SceneBuffers::new(gpu, scene)?;
        if scene.tinted {
            return Err(PeelError::Tinted);
        }
        let frame = scene.targets(size, Output::Image, None)?;
        let peeler = match peel {
            Peel::SBuffer => None,
            Peel::Dual => Some(DepthPeel::dual(&scene, &frame, features, None)?),
            Peel::Single => Some(DepthPeel::single(&scene, &frame, features)?),
        };
        Ok(Self {
            sbuffer: SBuffer::new(&scene, &frame, budget, features)?,
            step: gpu.upload("step", &[0u32; 4], wgpu::BufferUsages::UNIFORM),
            collectors: None,
            with_triangles: false,
            tile: RawTile::default(),
            gpu: gpu.clone(),
            scene,
            frame,
            peeler,
        })
    }

    /// Whether tiles hold the triangles of their fragments, which [`Peel::SBuffer`] alone keeps.
    pub const fn keep_triangles(&mut self, keep: bool) {
        self.with_triangles = keep && self.peeler.is_none();
    }

    /// The warp that methods take a view's depths through.
    pub fn depth_warp(&self, camera: &Camera) -> DepthWarp {
        self.scene.depth_warp(camera)
    }

    /// Finds a view's fragments and hands each tile over. `ready` may take it, and leave another whose memory is used, and it may end the
    /// reading by an error.
    ///
    /// # Errors
    /// A lost device, a pixel beyond the budget, or what `ready` returns.
    pub fn read_view(
        &mut self,
        camera: &Camera,
        sample: PixelSample,
        max_passes: Option<u32>,
        mut ready: impl FnMut(&mut RawTile) -> Result<(), PeelError>,
    ) -> Result<ReadBack, PeelError> {
        // Handles, so that storage can be planned while it records.
        let (gpu, mut raw) = (&self.gpu.clone(), std::mem::take(&mut self.tile));
        let (mut encoder, mut timer) = (gpu.encoder(), Timer::new(gpu));
        let mut recorder = Recorder::new(gpu, &mut encoder, Some(&mut timer));
        let (scene, frame) = (&self.scene, &self.frame);
        scene.set_view(&mut recorder, camera, frame, sample, SamplePoint::MIDDLE);
        scene.draw_background(&mut recorder, frame, None, true);
        let count = &self.sbuffer.count;
        count.encode(&mut recorder, scene, frame);
        recorder.submit();
        let found = CountPass::parse(&gpu.read(&count.total, 0..count.total.size())?)?;
        let needed = match self.peeler {
            None => found,
            // They come sorted.
            Some(_) => FragmentCount { most: 0, ..found },
        };
        let mut planned = self.sbuffer.plan(scene, frame, needed, None)?;
        if planned.is_none() {
            let offsets = &self.sbuffer.count.offsets;
            let offsets: Vec<u32> = gpu.read(offsets, 0..u64::from(frame.pixels()) * 4 + 4)?;
            planned = self.sbuffer.plan(scene, frame, needed, Some(&offsets))?;
        }
        let (tiles, grown) = planned.unwrap_or_default();
        if grown {
            self.collectors = self.collectors()?;
        }
        let passes = max_passes.unwrap_or(u32::MAX);
        for tile in &tiles {
            match &self.peeler {
                None => {
                    let sbuffer = &self.sbuffer;
                    sbuffer.store_and_sort(&mut recorder, scene, frame, tile);
                }
                Some(peeler) => self.peel(peeler, &mut recorder, tile, found.most, passes),
            }
            recorder.submit();
            self.read(tile, &mut raw)?;
            if !raw.depths.is_empty() {
                ready(&mut raw)?;
            }
        }
        self.tile = raw;
        let faults = &self.sbuffer.count.faults;
        CountPass::check(&gpu.read(faults, 0..faults.size())?, self.frame.size[0])?;
        let times = timer.finish(gpu, &mut encoder);
        gpu.queue.submit([encoder.finish()]);
        let times = gpu.block_on(times)?;
        Ok(ReadBack {
            max_layers: found.most,
            tiles: tiles.len() as u32,
            gpu_micros: times.iter().map(|t| t.micros).sum(),
        })
    }

    /// Peels the whole frame of so many layers and keeps what lies in `tile`.
    fn peel(
        &self,
        peeler: &DepthPeel,
        recorder: &mut Recorder<'_>,
        tile: &Tile,
        layers: u32,
        most_passes: u32,
    ) {
        let (Some(collectors), Some(storage)) = (&self.collectors, self.sbuffer.storage()) else {
            return;
        };
        recorder.write(&self.sbuffer.tile, &[*tile]);
        // A depth of 0 marks a slot that no pass fills.
        recorder.encoder().clear_buffer(&storage.depths, 0, None);
        let (scene, frame) = (&self.scene, &self.frame);
        peeler.init(recorder, scene, frame);
        let passes = layers.div_ceil(peeler.layers.len() as u32);
        for pass_index in 0..passes.min(most_passes) {
            peeler.peel(recorder, scene, frame, pass_index, false);
            // `Step` in `peel/collect_dual.wgsl`.
            recorder.write(&self.step, &[pass_index, frame.size[0], 0, 0]);
            collectors[(pass_index % 2) as usize].dispatch(recorder, tile.end - tile.begin);
        }
    }

    fn collectors(&self) -> Result<Option<[Kernel; 2]>, PeelError> {
        let (Some(peeler), Some(storage)) = (&self.peeler, self.sbuffer.storage()) else {
            return Ok(None);
        };
        let collector = |from: usize| {
            let (range, key) = (&peeler.reached[from], &peeler.reached[1 - from]);
            let (shader, peeled) = match peeler.layers.as_slice() {
                [front, back] => (
                    "peel::collect_dual",
                    vec![("range", range), ("front", front), ("back", back)],
                ),
                layers => (
                    "peel::collect_single",
                    vec![("key", key), ("color", &layers[0])],
                ),
            };
            let mut named = self.sbuffer.named(storage).to_vec();
            named.push(("peel_step", Bind::Buffer(&self.step)));
            named.extend(
                peeled
                    .iter()
                    .map(|&(name, view)| (name, Bind::Texture(view))),
            );
            Kernel::link(&self.gpu, shader, &[], &[], &named).map_err(RenderError::from)
        };
        Ok(Some([collector(0)?, collector(1)?]))
    }

    fn read(&self, tile: &Tile, raw: &mut RawTile) -> Result<(), PeelError> {
        let (gpu, offsets) = (&self.gpu, &mut raw.offsets);
        raw.first_pixel = tile.begin;
        let pixels = u64::from(tile.begin) * 4..u64::from(tile.end) * 4 + 4;
        gpu.read_into(&self.sbuffer.count.offsets, pixels, offsets)?;
        let base = offsets.first().copied().unwrap_or(0);
        offsets.iter_mut().for_each(|offset| *offset -= base);
        let fragments = u64::from(offsets.last().copied().unwrap_or(0));
        let Some(storage) = self.sbuffer.storage() else {
            return Ok(());
        };
        gpu.read_into(&storage.depths, 0..fragments * 4, &mut raw.depths)?;
        gpu.read_into(&storage.colors, 0..fragments * 16, &mut raw.colors)?;
        if self.with_triangles {
            gpu.read_into(&storage.triangles, 0..fragments * 4, &mut raw.triangles)?;
        }
        // Long runs are sorted by the numbers of their slots.
        if let Some(long) = self.sbuffer.long_runs() {
            let order: Vec<u32> = gpu.read(&long.order, 0..fragments * 4)?;
            put_in_order(&mut raw.depths, &order);
            put_in_order(&mut raw.colors, &order);
            if self.with_triangles {
                put_in_order(&mut raw.triangles, &order);
            }
        }
        Ok(())
    }
}

/// Replaces the `i`-th value by that in slot `order[i]`.
fn put_in_order<T: Copy>(values: &mut Vec<T>, order: &[u32]) {
    *values = order.iter().map(|&slot| values[slot as usize]).collect();
}
