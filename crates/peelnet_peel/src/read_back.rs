//! Finds all fragments of a view, tile by tile, in one of three ways that leave the same runs in storage.

use crate::PeelError;
use bytemuck::{Pod, Zeroable};
use peelnet_core::absorbance::DepthWarp;
use peelnet_dataset::PeeledFragment;
use peelnet_render::geometry::{
    FrameTargets, PixelSample, SamplePoint, SceneBuffers,
    count::{CountPass, FragmentCount},
    dual::DualPeel,
    fragments::Tile,
    frame::Output,
    sbuffer::SBuffer,
    single::SinglePeel,
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

impl RawTile {
    /// The fragment in a slot, as rows say it.
    pub(crate) fn fragment(&self, slot: usize) -> PeeledFragment {
        PeeledFragment {
            depth: self.depths[slot],
            color: self.colors[slot],
        }
    }
}

/// Layout of `Step` in `peel/collect_dual.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct Step {
    pass_index: u32,
    width: u32,
    pad: [u32; 2],
}

/// Passes that find layers, for the ways that do not store and sort.
#[derive(Debug)]
enum Peeler {
    Dual(Box<DualPeel>),
    Single(Box<SinglePeel>),
}

/// A scene made ready for peeling at one frame size.
#[derive(Debug)]
pub struct FragmentReader {
    gpu: Gpu,
    scene: SceneBuffers,
    frame: FrameTargets,
    sbuffer: SBuffer,
    peeler: Option<Peeler>,
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
            Peel::Dual => {
                let dual = DualPeel::new(&scene, &frame, features, None)?;
                Some(Peeler::Dual(dual.into()))
            }
            Peel::Single => {
                let single = SinglePeel::new(&scene, &frame, features)?;
                Some(Peeler::Single(single.into()))
            }
        };
        Ok(Self {
            sbuffer: SBuffer::new(&scene, &frame, budget, features)?,
            step: gpu.upload("step", &[Step::zeroed()], wgpu::BufferUsages::UNIFORM),
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
        let found = self.sbuffer.count.run(&mut recorder, scene, frame)?;
        let needed = match self.peeler {
            None => found,
            // They come sorted.
            Some(_) => FragmentCount { most: 0, ..found },
        };
        let (tiles, grown) = self.sbuffer.plan_counted(scene, frame, needed)?;
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
        peeler: &Peeler,
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
        let passes = match peeler {
            Peeler::Dual(dual) => {
                dual.init(recorder, scene, frame);
                layers.div_ceil(2)
            }
            Peeler::Single(single) => {
                single.init(recorder);
                layers
            }
        };
        for pass_index in 0..passes.min(most_passes) {
            match peeler {
                Peeler::Dual(dual) => dual.peel(recorder, scene, frame, pass_index, false),
                Peeler::Single(single) => single.peel(recorder, scene, frame, pass_index),
            }
            let step = Step {
                pass_index,
                width: frame.size[0],
                pad: [0; 2],
            };
            recorder.write(&self.step, &[step]);
            collectors[(pass_index % 2) as usize].dispatch(recorder, tile.end - tile.begin);
        }
    }

    fn collectors(&self) -> Result<Option<[Kernel; 2]>, PeelError> {
        let (Some(peeler), Some(storage)) = (&self.peeler, self.sbuffer.storage()) else {
            return Ok(None);
        };
        let (shader, textures) = match peeler {
            Peeler::Dual(dual) => {
                let [front, back] = [&dual.front, &dual.back].map(Bind::Texture);
                let bind = |range| vec![Bind::Texture(range), front, back];
                ("peel::collect_dual", dual.ranges.each_ref().map(bind))
            }
            Peeler::Single(single) => {
                let [first, second] = single.keys.each_ref();
                let bind = |key| vec![Bind::Texture(key), Bind::Texture(&single.layer)];
                ("peel::collect_single", [second, first].map(bind))
            }
        };
        let shader = peelnet_render::shaders::link(shader, &[], &[])?;
        let kernel = |textures: Vec<Bind<'_>>| {
            let mut entries = vec![
                Bind::Uniform(&self.sbuffer.tile),
                Bind::Uniform(&self.step),
                Bind::Read(&self.sbuffer.count.offsets),
                Bind::Write(&storage.depths),
                Bind::Write(&storage.colors),
            ];
            entries.extend(textures);
            Kernel::new(&self.gpu, &shader, &entries)
        };
        Ok(Some(textures.map(kernel)))
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
