//! The extraction itself: items in order, the GPU on one thread, rows and files on another.

use crate::{
    PeelError,
    items::{camera_info, items},
    read_back::{FragmentReader, Peel, RawTile, ReadBack},
    rows::{RowCounts, make_rows},
};
use peelnet_core::files::thousands;
use peelnet_dataset::{
    DatasetWriter, Format, FragmentBatch, Header, Manifest, Part, SceneEntry, Shard, worker_name,
};
use peelnet_render::geometry::PixelSample;
use peelnet_render::gpu::Gpu;
use peelnet_scene::{Scene, SceneFeatures};
use std::{
    collections::BTreeMap,
    mem,
    path::{Path, PathBuf},
    sync::{
        atomic::{AtomicBool, Ordering},
        mpsc::{Receiver, Sender, SyncSender, channel, sync_channel},
    },
    time::Instant,
};

/// Fragments of one tile: 100 MB of GPU storage and as much for the copy of it.
const BUDGET: u64 = 4 << 20;

/// Rows handed to the writer at a time.
const ROWS_AT_A_TIME: usize = 1 << 18;

/// What to extract, and where to.
#[derive(Clone, Debug)]
pub struct ExtractOptions {
    /// Folder of the dataset.
    pub out: PathBuf,
    /// Frame width and height in pixels.
    pub size: [u32; 2],
    /// The first n views of each scene, which must have so many; `None` takes all.
    pub views: Option<u32>,
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
}

impl ExtractOptions {
    /// All views at 1024×768, every pixel, Parquet files, no varied copies.
    pub fn new(out: impl Into<PathBuf>) -> Self {
        Self {
            out: out.into(),
            size: [1024, 768],
            views: None,
            format: Format::Parquet,
            peel: Peel::SBuffer,
            max_passes: None,
            pixels: 1.0,
            augment: 0,
            seed: 1,
            shard: None,
            resume: false,
            command: String::new(),
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

/// What a maker of parts sends: a part begins, its tiles follow, it ends.
pub(crate) enum Message {
    Begin(Part),
    Tile(RawTile),
    End(ReadBack),
}

/// The maker's end of the channels. Its functions fail with [`PeelError::Interrupted`] once nobody receives any more.
pub(crate) struct Outbox {
    send: SyncSender<Message>,
    spare: Receiver<RawTile>,
}

impl Outbox {
    /// Sends a tile, and leaves one with the memory of an earlier one in its place.
    pub(crate) fn tile(&self, tile: &mut RawTile) -> Result<(), PeelError> {
        let spare = self.spare.try_recv().unwrap_or_default();
        self.deliver(Message::Tile(mem::replace(tile, spare)))
    }

    pub(crate) fn deliver(&self, message: Message) -> Result<(), PeelError> {
        let sent = self.send.send(message);
        sent.map_err(|_| PeelError::Interrupted)
    }
}

/// The receiver's end: parts, one after the other.
pub(crate) struct Feed {
    messages: Receiver<Message>,
    give_back: Sender<RawTile>,
    batch: FragmentBatch,
}

impl Feed {
    /// The next part; none at the end, or once the maker failed.
    pub(crate) fn part(&self) -> Option<Part> {
        match self.messages.recv() {
            Ok(Message::Begin(part)) => Some(part),
            _ => None,
        }
    }

    /// Hands over the rows of the part that began last.
    pub(crate) fn rows(
        &mut self,
        part: &Part,
        mut each: impl FnMut(&FragmentBatch) -> Result<(), PeelError>,
    ) -> Result<(ReadBack, RowCounts), PeelError> {
        let (mut counts, batch) = (RowCounts::default(), &mut self.batch);
        loop {
            match self.messages.recv() {
                Ok(Message::Tile(tile)) => {
                    make_rows(&tile, part, batch, ROWS_AT_A_TIME, &mut counts, &mut each)?;
                    // Unless the maker has ended.
                    let _ = self.give_back.send(tile);
                }
                Ok(Message::End(found)) => return Ok((found, counts)),
                // The maker failed, and says why.
                Ok(Message::Begin(_)) | Err(_) => return Err(PeelError::Interrupted),
            }
        }
    }
}

/// Takes what `make` sends from another thread. Once `take` fails, `make` does at its next message.
pub(crate) fn stream(
    make: impl FnOnce(&Outbox) -> Result<(), PeelError> + Send,
    take: impl FnOnce(Feed) -> Result<(), PeelError>,
) -> Result<(), PeelError> {
    let (send, messages) = sync_channel(1);
    let (give_back, spare) = channel();
    std::thread::scope(|scope| {
        let making = std::thread::Builder::new();
        let making = making.spawn_scoped(scope, move || make(&Outbox { send, spare }));
        let making = making.map_err(PeelError::Thread)?;
        let taken = take(Feed {
            messages,
            give_back,
            batch: FragmentBatch::default(),
        });
        let ended = making.join();
        match ended.unwrap_or_else(|panic| std::panic::resume_unwind(panic)) {
            Ok(()) | Err(PeelError::Interrupted) => taken,
            failed => failed,
        }
    })
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
    let all = items(scenes, options)?;
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
        settings: settings(&all, options),
        scenes: scenes.iter().map(scene_entry).collect(),
        work_items: all.len() as u32,
        shard: options.shard,
        resume: options.resume,
        worker: worker_name(),
    };
    write(&options.out, header, stop, progress, |missing, outbox| {
        let missing = missing.iter().map(|&k| all[k as usize].clone());
        peel(gpu, scenes, options, missing, outbox)
    })
}

/// Writes the parts that a dataset lacks: `make` is called with their numbers on another thread, and sends them.
pub(crate) fn write(
    out: &Path,
    header: Header,
    stop: &AtomicBool,
    progress: &mut dyn FnMut(&Progress),
    make: impl FnOnce(&[u32], &Outbox) -> Result<(), PeelError> + Send,
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
    let (mut lost, mut coplanar, mut gpu_micros, mut tiles) = (0, 0, 0.0, 0);
    let goes_on = || !stop.load(Ordering::Relaxed);
    let go_on = || goes_on().then_some(()).ok_or(PeelError::Interrupted);
    let make = |outbox: &Outbox| make(&missing, outbox);
    stream(make, |mut feed| {
        while let Some(part) = feed.part() {
            let mut written = writer.begin(part.clone())?;
            let (found, counts) = feed.rows(&part, |rows| {
                written.write(rows)?;
                go_on()
            })?;
            written.finish(counts.lost, counts.coplanar)?;
            lost += counts.lost;
            coplanar += counts.coplanar;
            gpu_micros += found.gpu_micros;
            tiles += u64::from(found.tiles);
            state.items_done += 1;
            state.rows += counts.rows;
            state.seconds = start.elapsed().as_secs_f64();
            progress(&state);
            go_on()?;
        }
        Ok(())
    })?;
    Ok(ExtractReport {
        manifest: writer.finish()?,
        parts: state.items,
        rows: state.rows,
        gpu_micros,
        wall_micros: start.elapsed().as_secs_f64() * 1e6,
        lost,
        coplanar,
        tiles,
    })
}

/// A scene or a varied copy of one that is on the GPU, behind their numbers.
type Current = ((u32, u32), Scene, FragmentReader);

/// The GPU's side: peels these parts.
pub(crate) fn peel(
    gpu: &Gpu,
    scenes: &[Scene],
    options: &ExtractOptions,
    parts: impl IntoIterator<Item = Part>,
    outbox: &Outbox,
) -> Result<(), PeelError> {
    let mut current = None;
    for part in parts {
        let (index, view) = (part.index, part.view);
        let scene = &scenes[part.scene as usize];
        peel_part(gpu, scene, options, part, &mut current, outbox).map_err(|error| {
            // Of a shard, an error says which part and whose: it is read among those of other workers.
            if options.shard.is_none() || matches!(error, PeelError::Interrupted) {
                return error;
            }
            PeelError::Part {
                index,
                scene: scene.name.clone(),
                view,
                worker: worker_name(),
                source: Box::new(error),
            }
        })?;
    }
    Ok(())
}

fn peel_part(
    gpu: &Gpu,
    scene: &Scene,
    options: &ExtractOptions,
    mut part: Part,
    current: &mut Option<Current>,
    outbox: &Outbox,
) -> Result<(), PeelError> {
    let key = (part.scene, part.copy);
    // The old scene's buffers go before the new one's come.
    let uploaded = match current.take().filter(|(number, _, _)| *number == key) {
        Some(uploaded) => uploaded,
        None => {
            let scene = scene.varied(options.seed, part.copy);
            let (size, sampled) = (options.size, options.pixels < 1.0);
            let reader =
                FragmentReader::new(gpu, &scene, size, options.peel, sampled, Some(BUDGET))?;
            (key, scene, reader)
        }
    };
    let (_, scene, reader) = current.insert(uploaded);
    let camera = &scene.views[part.view as usize];
    part.camera = camera_info(camera);
    // The hash takes 32 bits of seed; both halves count.
    let sample = PixelSample {
        seed: (options.seed ^ (options.seed >> 32)) as u32,
        view: part.index,
        threshold: peelnet_core::hash::sample_threshold(options.pixels),
    };
    outbox.deliver(Message::Begin(part))?;
    let found = reader.read_view(camera, sample, options.max_passes, |tile| outbox.tile(tile))?;
    outbox.deliver(Message::End(found))
}

/// Adapters that are expected to give the same bytes: software, or GPUs of one name and back end.
fn adapter_class(gpu: &Gpu) -> String {
    let info = &gpu.info;
    if info.device_type == peelnet_render::gpu::wgpu::DeviceType::Cpu {
        // Behind the first word there are versions, and the width of the processor's vectors.
        let rasterizer = info.name.split_whitespace().next().unwrap_or("rasterizer");
        format!("software, {rasterizer} ({})", info.backend)
    } else {
        format!("{} ({})", info.name, info.backend)
    }
}

/// What shapes the rows beside the scenes' contents.
fn settings(items: &[Part], options: &ExtractOptions) -> BTreeMap<String, String> {
    let passes = options.max_passes;
    let passes = passes.map_or("all".to_owned(), |n| n.to_string());
    // Scenes that a program made or changed have cameras that no file has.
    let line = |p: &Part| format!("{} {} {} {:?}\n", p.scene, p.copy, p.view, p.camera);
    let cameras: String = items.iter().map(line).collect();
    let [width, height] = options.size;
    let named = [
        ("size", format!("{width}x{height}")),
        ("limit of passes", passes),
        (
            "list of cameras",
            peelnet_dataset::sha256(cameras.as_bytes()),
        ),
    ];
    named.map(|(name, value)| (name.to_owned(), value)).into()
}

fn scene_entry(scene: &Scene) -> SceneEntry {
    let features = SceneFeatures::new(scene);
    let effects = features.effects.iter().filter(|e| e.on);
    SceneEntry {
        name: scene.name.clone(),
        file: scene.source.display().to_string(),
        sha256: scene.hash.clone(),
        content: scene.content.clone(),
        held_out: scene.held_out,
        effects: effects.map(|e| e.name.to_owned()).collect(),
    }
}
