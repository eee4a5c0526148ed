//! The extraction itself: items in order, the GPU on one thread, rows and files on another.

use crate::{
    PeelError,
    harvest::{Harvest, Harvester, Peel},
    items::{Item, Views, items},
    rows::{RawTile, RowCounts, ViewConstants, append_rows},
};
use peelnet_dataset::{
    CameraInfo, DatasetWriter, Format, FragmentBatch, Header, Manifest, PartCounts, PartInfo,
    SceneEntry, Shard, worker_name,
};
use peelnet_gpu::Gpu;
use peelnet_raster::PixelSample;
use peelnet_scene::{Camera, Census, Scene};
use std::{
    collections::BTreeMap,
    path::PathBuf,
    sync::{
        atomic::{AtomicBool, Ordering},
        mpsc::{Receiver, Sender, SyncSender, channel, sync_channel},
    },
    time::Instant,
};

/// Fragments of one tile by default: 100 MB of GPU storage and as much for the copy of it.
const DEFAULT_BUDGET: u64 = 4 << 20;

/// Rows handed to the writer at a time.
pub(crate) const ROWS_AT_A_TIME: usize = 1 << 18;

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

/// What the GPU's side spent.
#[derive(Default)]
pub(crate) struct Effort {
    gpu_micros: f64,
    tiles: u64,
}

/// What the GPU's side sends.
pub(crate) enum Message {
    Begin(PartInfo, ViewConstants),
    Tile(RawTile),
    End,
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
    let mine = all
        .iter()
        .copied()
        .filter(|i| options.shard.is_none_or(|s| s.contains(i.index)))
        .collect();
    Ok((all.len() as u32, mine))
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
    let start = Instant::now();
    let (all, mut mine) = work(scenes, options)?;
    let writer = DatasetWriter::create(
        &options.out,
        Header {
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
        },
    )?;
    mine.retain(|item| writer.needs(item.index));
    let mut effort = Effort::default();
    let counts = std::thread::scope(|scope| {
        let (send, receive) = sync_channel(1);
        let (give_back, take) = channel();
        let writer = &writer;
        let writing = scope.spawn(move || write(writer, &receive, &give_back));
        let peeled = peel(
            gpu,
            scenes,
            options,
            &mine,
            stop,
            progress,
            &send,
            &take,
            &mut effort,
        );
        // Without a sender the writer comes to its end.
        drop(send);
        let written = writing
            .join()
            .unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        // Whichever side failed first made the other one stop with `Interrupted`: report the real reason.
        match (written, peeled) {
            (Err(PeelError::Interrupted) | Ok(_), Err(e)) | (Err(e), _) => Err(e),
            (Ok(counts), Ok(())) => Ok(counts),
        }
    })?;
    let manifest = writer.finish()?;
    Ok(ExtractReport {
        manifest,
        parts: mine.len() as u32,
        rows: counts.rows,
        gpu_micros: effort.gpu_micros,
        wall_micros: start.elapsed().as_secs_f64() * 1e6,
        lost: counts.lost,
        coplanar: counts.coplanar,
        tiles: effort.tiles,
    })
}

/// The GPU's side: every item's tiles into the channel.
#[allow(
    clippy::too_many_arguments,
    reason = "one call site, and a struct of references would only rename them"
)]
pub(crate) fn peel(
    gpu: &Gpu,
    scenes: &[Scene],
    options: &ExtractOptions,
    mine: &[Item],
    stop: &AtomicBool,
    progress: &mut dyn FnMut(&Progress),
    send: &SyncSender<Message>,
    take: &Receiver<RawTile>,
    effort: &mut Effort,
) -> Result<(), PeelError> {
    let start = Instant::now();
    let deliver = |message| send.send(message).map_err(|_| PeelError::Interrupted);
    let threshold = peelnet_core::hash::sample_threshold(options.pixels);
    let mut state = Progress {
        items: mine.len() as u32,
        ..Default::default()
    };
    progress(&state);
    let mut current: Option<((u32, u32), Scene, Harvester)> = None;
    for item in mine {
        let key = (item.scene, item.copy);
        if current.as_ref().is_none_or(|(k, ..)| *k != key) {
            // The old scene's buffers go before the new one's come.
            drop(current.take());
            let scene = scenes[item.scene as usize].varied(options.seed, item.copy);
            let harvester = Harvester::new(
                gpu,
                &scene,
                options.size,
                options.peel,
                options.pixels < 1.0,
                Some(options.budget.unwrap_or(DEFAULT_BUDGET)),
            )
            .map_err(|e| in_part(e, options, item, &scene.name))?;
            current = Some((key, scene, harvester));
        }
        let Some((_, scene, harvester)) = &mut current else {
            continue;
        };
        let camera = &scene.views[item.view as usize];
        let info = PartInfo {
            index: item.index,
            scene: item.scene,
            copy: item.copy,
            view: item.view,
            camera: camera_info(camera),
            width: options.size[0],
            height: options.size[1],
        };
        let constants = ViewConstants {
            view: item.index,
            width: options.size[0],
            near: camera.near,
            far: camera.far,
        };
        deliver(Message::Begin(info, constants))?;
        // The hash takes 32 bits of seed; both halves count.
        let sample = PixelSample {
            seed: (options.seed ^ (options.seed >> 32)) as u32,
            view: item.index,
            threshold,
        };
        let Harvest {
            fragments,
            tiles,
            gpu_micros,
            ..
        } = harvester
            .harvest(
                camera,
                sample,
                options.max_passes,
                || take.try_recv().unwrap_or_default(),
                |tile| {
                    if stop.load(Ordering::Relaxed) {
                        return Err(PeelError::Interrupted);
                    }
                    deliver(Message::Tile(tile))
                },
            )
            .map_err(|e| in_part(e, options, item, &scene.name))?;
        deliver(Message::End)?;
        effort.gpu_micros += gpu_micros;
        effort.tiles += u64::from(tiles);
        state.items_done += 1;
        state.rows += fragments;
        state.seconds = start.elapsed().as_secs_f64();
        progress(&state);
        if stop.load(Ordering::Relaxed) {
            return Err(PeelError::Interrupted);
        }
    }
    Ok(())
}

/// Of a shard, an error says which part and whose: it is read among those of other workers.
fn in_part(error: PeelError, options: &ExtractOptions, item: &Item, scene: &str) -> PeelError {
    if options.shard.is_none() || matches!(error, PeelError::Interrupted) {
        return error;
    }
    PeelError::Part {
        index: item.index,
        scene: scene.to_owned(),
        view: item.view,
        worker: worker_name(),
        source: Box::new(error),
    }
}

/// The files' side: tiles from the channel to rows of parts.
fn write(
    writer: &DatasetWriter,
    receive: &Receiver<Message>,
    give_back: &Sender<RawTile>,
) -> Result<RowCounts, PeelError> {
    let mut total = RowCounts::default();
    let mut batch = FragmentBatch::with_capacity(ROWS_AT_A_TIME + 4096);
    while let Ok(Message::Begin(info, constants)) = receive.recv() {
        let mut part = writer.begin(info)?;
        let mut counts = RowCounts::default();
        loop {
            match receive.recv() {
                Ok(Message::Tile(tile)) => {
                    let found =
                        append_rows(&tile, constants, &mut batch, ROWS_AT_A_TIME, |rows| {
                            part.write(rows)
                        })?;
                    counts.rows += found.rows;
                    counts.lost += found.lost;
                    counts.coplanar += found.coplanar;
                    counts.unsorted += found.unsorted;
                    // Nobody may be left to use it again; then it is freed.
                    let _ = give_back.send(tile);
                }
                Ok(_) => break,
                // The other side ended early: the part is abandoned with the whole dataset.
                Err(_) => return Err(PeelError::Interrupted),
            }
        }
        if counts.unsorted > 0 {
            return Err(PeelError::Unsorted(counts.unsorted));
        }
        part.finish(PartCounts {
            lost_fragments: counts.lost,
            coplanar_ties: counts.coplanar,
        })?;
        total.rows += counts.rows;
        total.lost += counts.lost;
        total.coplanar += counts.coplanar;
    }
    Ok(total)
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
    SceneEntry {
        name: scene.name.clone(),
        file: scene.source.display().to_string(),
        sha256: scene.hash.clone(),
        held_out: scene.held_out,
        effects: Census::of(scene)
            .effects
            .iter()
            .filter(|e| e.on)
            .map(|e| e.name.to_owned())
            .collect(),
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
