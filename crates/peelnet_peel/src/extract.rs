//! The extraction itself: items in order, the GPU on one thread, rows and files on another.

use crate::{
    PeelError,
    harvest::{Harvest, Harvester, Peel},
    items::{Item, Views, items},
    rows::{RawTile, RowCounts, ViewConstants, append_rows},
};
use peelnet_dataset::{
    CameraInfo, DatasetWriter, Format, FragmentBatch, Header, Manifest, Part, SceneEntry, Shard,
    worker_name,
};
use peelnet_files::thousands;
use peelnet_gpu::Gpu;
use peelnet_raster::PixelSample;
use peelnet_scene::{Camera, Census, Scene};
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    sync::{
        atomic::{AtomicBool, Ordering},
        mpsc::{Receiver, SyncSender, channel, sync_channel},
    },
    time::Instant,
};

/// Fragments of one tile by default: 100 MB of GPU storage and as much for the copy of it.
const DEFAULT_BUDGET: u64 = 4 << 20;

/// Rows handed to the writer at a time.
const ROWS_AT_A_TIME: usize = 1 << 18;

/// What to extract, and where to.
#[derive(Clone, Debug)]
pub struct ExtractOptions {
    /// Folder of the dataset.
    pub out: PathBuf,
    /// Frame width and height in pixels.
    pub size: [u32; 2],
    /// Views of each scene.
    pub views: Views,
    /// File format.
    pub format: Format,
    /// How fragments are found.
    pub peel: Peel,
    /// Cap on peeling passes; what lies beyond is counted as lost.
    pub max_passes: Option<u32>,
    /// Fraction of pixels to keep, 0 … 1.
    pub pixels: f64,
    /// Varied copies of each scene.
    pub augment: u32,
    /// Seed of the pixel sample and of the copies.
    pub seed: u64,
    /// The part of the items to do; other shards write the others into the same folder, at any time.
    pub shard: Option<Shard>,
    /// Does only what is missing of the dataset that is there. Shards always do.
    pub resume: bool,
    /// The command line, for the manifest.
    pub command: String,
    /// Fragments of one tile; memory grows with it.
    pub budget: Option<u64>,
}

impl ExtractOptions {
    /// All views at 1024×768, every pixel, Parquet files, no varied copies.
    pub fn new(out: impl Into<PathBuf>) -> Self {
        Self {
            out: out.into(),
            size: [1024, 768],
            views: Views::All,
            format: Format::Parquet,
            peel: Peel::SBuffer,
            max_passes: None,
            pixels: 1.0,
            augment: 0,
            seed: 1,
            shard: None,
            resume: false,
            command: String::new(),
            budget: None,
        }
    }
}

/// How far an extraction is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Progress {
    /// Items done.
    pub items_done: u32,
    /// Items to do.
    pub items: u32,
    /// Rows found so far.
    pub rows: u64,
    /// Seconds since the start.
    pub seconds: f64,
}

impl Progress {
    /// What a progress bar says.
    pub fn text(&self) -> String {
        let rate = self.rows as f64 / self.seconds.max(1e-3);
        let (rows, rate) = (thousands(self.rows), thousands(rate as u64));
        format!("{rows} rows, {rate} rows/s")
    }
}

/// What an extraction did.
#[derive(Clone, Debug)]
pub struct ExtractReport {
    /// The manifest: of the whole dataset if it is sealed now, otherwise of this shard's parts ([`Manifest::is_whole`]).
    pub manifest: Manifest,
    /// Parts that this extraction wrote; others were there.
    pub parts: u32,
    /// Rows that it wrote.
    pub rows: u64,
    /// GPU time of all passes, microseconds (0 without timestamps).
    pub gpu_micros: f64,
    /// Clock time of everything, microseconds.
    pub wall_micros: f64,
    /// Fragments that peeling left out.
    pub lost: u64,
    /// Neighbours of equal depth.
    pub coplanar: u64,
    /// Tiles drawn.
    pub tiles: u64,
}

/// What the GPU's side sends, view by view.
pub(crate) enum Message {
    Begin(Part),
    Tile(RawTile),
    End(Harvest),
    /// The last one.
    Failed(PeelError),
}

/// The GPU's end of the channels.
pub(crate) struct Outbox {
    send: SyncSender<Message>,
    spare: Receiver<RawTile>,
}

impl Outbox {
    /// A tile to fill, with the memory of an earlier one where there is one.
    pub(crate) fn spare(&self) -> RawTile {
        self.spare.try_recv().unwrap_or_default()
    }

    /// Sends a message; an error once nobody receives any more.
    pub(crate) fn deliver(&self, message: Message) -> Result<(), PeelError> {
        let sent = self.send.send(message);
        sent.map_err(|_| PeelError::Interrupted)
    }
}

/// What comes of a view's messages.
pub(crate) enum Event<'a> {
    Begin(Part),
    Rows(&'a FragmentBatch),
    End(Harvest, RowCounts),
}

/// Makes rows of what `make` sends from another thread, view by view. Once `each` fails, `make` stops at its next message.
pub(crate) fn stream(
    make: impl FnOnce(&Outbox) + Send,
    mut each: impl FnMut(Event<'_>) -> Result<(), PeelError>,
) -> Result<(), PeelError> {
    let (send, received) = sync_channel(1);
    let (give_back, spare) = channel();
    std::thread::scope(move |scope| {
        scope.spawn(move || make(&Outbox { send, spare }));
        let mut batch = FragmentBatch::with_capacity(ROWS_AT_A_TIME + 4096);
        let mut current = None;
        for message in received {
            match (message, &mut current) {
                (Message::Begin(part), _) => {
                    current = Some((ViewConstants::from(&part), RowCounts::default()));
                    each(Event::Begin(part))?;
                }
                (Message::Tile(tile), Some((view, counts))) => {
                    let rows = |rows: &FragmentBatch| each(Event::Rows(rows));
                    *counts += append_rows(&tile, *view, &mut batch, ROWS_AT_A_TIME, rows)?;
                    counts.check()?;
                    // Unless the other side has ended.
                    let _ = give_back.send(tile);
                }
                (Message::End(found), Some((_, counts))) => each(Event::End(found, *counts))?,
                (Message::Failed(error), _) => return Err(error),
                // A view begins first.
                (Message::Tile(_) | Message::End(_), None) => {}
            }
        }
        Ok(())
    })
}

/// The number of all work items, and those of the options' shard.
pub(crate) fn work(
    scenes: &[Scene],
    options: &ExtractOptions,
) -> Result<(u32, Vec<Item>), PeelError> {
    if !(options.pixels > 0.0 && options.pixels <= 1.0) {
        return Err(PeelError::Fraction(options.pixels));
    }
    let all = items(scenes, options.views, options.augment)?;
    if all.is_empty() {
        return Err(PeelError::NoScene);
    }
    let (count, mut mine) = (all.len() as u32, all);
    mine.retain(|i| options.shard.is_none_or(|s| s.contains(i.index)));
    Ok((count, mine))
}

/// Peels the scenes and writes the dataset. Every part is the dataset's when it is finished, so that an extraction that is killed or fails
/// can be resumed; only where an older dataset is replaced, everything appears at the end. Whoever finishes the last part seals the dataset.
///
/// # Errors
/// Scenes that lack views or share a name, a fraction outside 0 … 1, an adapter's limits, a folder that cannot be
/// written, or [`PeelError::Interrupted`] when `stop` becomes true.
pub fn extract(
    gpu: &Gpu,
    scenes: &[Scene],
    options: &ExtractOptions,
    stop: &AtomicBool,
    progress: &mut dyn FnMut(&Progress),
) -> Result<ExtractReport, PeelError> {
    let (all, mine) = work(scenes, options)?;
    let header = Header {
        format: options.format,
        seed: options.seed,
        adapter: gpu.info.name.clone(),
        adapter_class: adapter_class(gpu),
        tool_version: env!("CARGO_PKG_VERSION").to_owned(),
        command: options.command.clone(),
        peel: options.peel.to_string(),
        pixels_fraction: options.pixels,
        augment: options.augment,
        settings: settings(scenes, options)?,
        scenes: scenes.iter().map(scene_entry).collect(),
        work_items: all,
        shard: options.shard,
        resume: options.resume,
        worker: worker_name(),
    };
    write(&options.out, header, stop, progress, |missing, outbox| {
        let missing = mine.iter().filter(|item| missing.contains(&item.index));
        peel(gpu, scenes, options, missing, outbox);
    })
}

/// Writes the parts that a dataset lacks: `make` is called with their numbers on another thread, and sends them view by view.
pub(crate) fn write(
    out: &Path,
    header: Header,
    stop: &AtomicBool,
    progress: &mut dyn FnMut(&Progress),
    make: impl FnOnce(&[u32], &Outbox) + Send,
) -> Result<ExtractReport, PeelError> {
    let start = Instant::now();
    let all = 0..header.work_items;
    let writer = DatasetWriter::create(out, header)?;
    let missing: Vec<u32> = all.filter(|k| writer.needs(*k)).collect();
    let mut state = Progress {
        items: missing.len() as u32,
        ..Default::default()
    };
    progress(&state);
    let (mut total, mut gpu_micros, mut tiles) = (RowCounts::default(), 0.0, 0);
    let mut part = None;
    let make = |outbox: &Outbox| make(&missing, outbox);
    stream(make, |event| {
        match event {
            Event::Begin(info) => part = Some(writer.begin(info)?),
            Event::Rows(rows) => part.iter_mut().try_for_each(|part| part.write(rows))?,
            Event::End(found, counts) => {
                let mut part = part.take().into_iter();
                part.try_for_each(|part| part.finish(counts.lost, counts.coplanar))?;
                total += counts;
                gpu_micros += found.gpu_micros;
                tiles += u64::from(found.tiles);
                state.items_done += 1;
                state.rows = total.rows;
                state.seconds = start.elapsed().as_secs_f64();
                progress(&state);
            }
        }
        match stop.load(Ordering::Relaxed) {
            true => Err(PeelError::Interrupted),
            false => Ok(()),
        }
    })?;
    drop(part);
    Ok(ExtractReport {
        manifest: writer.finish()?,
        parts: missing.len() as u32,
        rows: total.rows,
        gpu_micros,
        wall_micros: start.elapsed().as_secs_f64() * 1e6,
        lost: total.lost,
        coplanar: total.coplanar,
        tiles,
    })
}

/// The GPU's side: every item's tiles into the channel.
pub(crate) fn peel<'a>(
    gpu: &Gpu,
    scenes: &[Scene],
    options: &ExtractOptions,
    items: impl IntoIterator<Item = &'a Item>,
    outbox: &Outbox,
) {
    let mut current = None;
    for item in items {
        let peeled = peel_item(gpu, scenes, options, item, &mut current, outbox);
        if let Err(error) = peeled {
            // The other side may have stopped it.
            let _ = outbox.deliver(Message::Failed(in_part(error, options, item, scenes)));
            return;
        }
    }
}

/// A scene or a varied copy of one that is on the GPU, behind their numbers.
type Current = ((u32, u32), Scene, Harvester);

fn peel_item(
    gpu: &Gpu,
    scenes: &[Scene],
    options: &ExtractOptions,
    item: &Item,
    current: &mut Option<Current>,
    outbox: &Outbox,
) -> Result<(), PeelError> {
    let key = (item.scene, item.copy);
    // The old scene's buffers go before the new one's come.
    let kept = match current.take().filter(|(of, _, _)| *of == key) {
        Some(kept) => kept,
        None => {
            let scene = scenes[item.scene as usize].varied(options.seed, item.copy);
            let (size, sampled) = (options.size, options.pixels < 1.0);
            let budget = Some(options.budget.unwrap_or(DEFAULT_BUDGET));
            let harvester = Harvester::new(gpu, &scene, size, options.peel, sampled, budget)?;
            (key, scene, harvester)
        }
    };
    let (_, scene, harvester) = current.insert(kept);
    let camera = &scene.views[item.view as usize];
    outbox.deliver(Message::Begin(Part {
        index: item.index,
        scene: item.scene,
        copy: item.copy,
        view: item.view,
        camera: camera_info(camera),
        width: options.size[0],
        height: options.size[1],
        ..Part::default()
    }))?;
    // The hash takes 32 bits of seed; both halves count.
    let sample = PixelSample {
        seed: (options.seed ^ (options.seed >> 32)) as u32,
        view: item.index,
        threshold: peelnet_core::hash::sample_threshold(options.pixels),
    };
    let found = harvester.harvest(
        camera,
        sample,
        options.max_passes,
        || outbox.spare(),
        |tile| outbox.deliver(Message::Tile(tile)),
    )?;
    outbox.deliver(Message::End(found))
}

/// Of a shard, an error says which part and whose: it is read among those of other workers.
fn in_part(error: PeelError, options: &ExtractOptions, item: &Item, scenes: &[Scene]) -> PeelError {
    if options.shard.is_none() || matches!(error, PeelError::Interrupted) {
        return error;
    }
    PeelError::Part {
        index: item.index,
        scene: scenes[item.scene as usize].name.clone(),
        view: item.view,
        worker: worker_name(),
        source: Box::new(error),
    }
}

/// Adapters that are expected to give the same bytes: software, or GPUs of one name and back end.
fn adapter_class(gpu: &Gpu) -> String {
    let info = &gpu.info;
    if info.device_type == peelnet_gpu::wgpu::DeviceType::Cpu {
        // Behind the first word there are versions, and the width of the processor's vectors.
        let rasterizer = info.name.split_whitespace().next().unwrap_or("rasterizer");
        format!("software, {rasterizer} ({})", info.backend)
    } else {
        format!("{} ({})", info.name, info.backend)
    }
}

/// What shapes the rows beside the scenes' contents.
fn settings(
    scenes: &[Scene],
    options: &ExtractOptions,
) -> Result<BTreeMap<String, String>, PeelError> {
    let passes = options
        .max_passes
        .map_or("all".to_owned(), |n| n.to_string());
    // Scenes that a program made or changed have cameras that no file has.
    let mut cameras = String::new();
    for item in items(scenes, options.views, options.augment)? {
        let view = &scenes[item.scene as usize].views[item.view as usize];
        let (scene, copy, camera) = (item.scene, item.copy, camera_info(view));
        cameras += &format!("{scene} {copy} {} {camera:?}\n", item.view);
    }
    let [width, height] = options.size;
    let named = [
        ("size", format!("{width}x{height}")),
        ("limit of passes", passes),
        (
            "list of cameras",
            peelnet_dataset::sha256(cameras.as_bytes()),
        ),
    ];
    Ok(named.map(|(name, value)| (name.to_owned(), value)).into())
}

fn scene_entry(scene: &Scene) -> SceneEntry {
    let census = Census::of(scene);
    let effects = census.effects.iter().filter(|e| e.on);
    SceneEntry {
        name: scene.name.clone(),
        file: scene.source.display().to_string(),
        sha256: scene.hash.clone(),
        held_out: scene.held_out,
        effects: effects.map(|e| e.name.to_owned()).collect(),
    }
}

fn camera_info(camera: &Camera) -> CameraInfo {
    CameraInfo {
        position: camera.position.to_array(),
        target: camera.target.to_array(),
        up: camera.up.to_array(),
        fov_y_degrees: camera.fov_y_degrees,
        near: camera.near,
        far: camera.far,
    }
}
