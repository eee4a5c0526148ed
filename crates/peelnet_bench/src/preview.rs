//! What an extraction would write: its rows are peeled and counted, or estimated from one view, and its views are drawn. Nothing is written.

use crate::{
    EvalError,
    stage::{EXACT, check_stop},
};
use peelnet_dataset::{Format, FragmentBatch, Part, Summary, summary::Bin};
use peelnet_peel::{ExtractOptions, PeelError, items::items, peel_rows};
use peelnet_render::gpu::Gpu;
use peelnet_render::{FrameStats, Image, MethodOptions, RenderError, Renderer};
use peelnet_scene::{Camera, Scene};
use serde::Serialize;
use std::{
    collections::BTreeMap,
    sync::atomic::{AtomicBool, Ordering},
};

/// Pictures of all scenes together, and their longer side in pixels.
const MOST_PICTURES: usize = 48;
const PICTURE_SIDE: u32 = 320;

/// Rows of each piece (2¹⁸ rows, or those of a tile) that are encoded to estimate the size of the files.
const SAMPLED_ROWS: usize = 1 << 16;

/// Bits of a depth that its bin does not depend on: a power of two has 32 bins. And bins that are kept in the end.
const DEPTH_BITS: u32 = 18;
const DEPTH_BINS: u32 = 64;

/// An extraction in figures.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Preview {
    pub size: [u32; 2],
    pub format: Format,
    /// Rows that the extraction writes.
    pub rows: u64,
    pub pixels: u64,
    pub parts: u64,
    /// Fragments that peeling leaves out.
    pub lost_fragments: u64,
    pub coplanar_ties: u64,
    /// Bytes of the parts' files: an estimate from some rows of each view.
    pub expected_bytes: u64,
    /// The rows of that estimate.
    pub sampled_rows: u64,
    pub scenes: Vec<ScenePreview>,
}

/// The same of one scene, with its varied copies.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ScenePreview {
    pub name: String,
    pub held_out: bool,
    /// Views that are extracted.
    pub views: u64,
    pub parts: u64,
    pub rows: u64,
    pub pixels: u64,
    /// Pixels by their number of fragments, rows by α, rows by depth.
    pub fragments_per_pixel: Vec<Bin>,
    pub alpha: Vec<Bin>,
    pub depth: Vec<Bin>,
    /// The first views, drawn exactly, for the page alone.
    #[serde(skip)]
    pub pictures: Vec<Image>,
}

/// Peels and counts what [`peelnet_peel::extract()`] would write with these options, and draws the first views. Progress is the number of
/// parts that are done, and of all. Folder, shard and `resume` of the options are not used.
///
/// # Errors
/// Those of peeling, drawing, and of temporary files.
pub fn measure(
    gpu: &Gpu,
    scenes: &[Scene],
    options: &ExtractOptions,
    stop: &AtomicBool,
    progress: &mut dyn FnMut(u64, u64),
) -> Result<Preview, EvalError> {
    let parts = items(scenes, options)?;
    let total = parts.len() as u64;
    let mut gathered: Vec<Gathered> = scenes.iter().map(|_| Gathered::default()).collect();
    let peeled = peel_rows(gpu, scenes, options, parts, |part, rows| {
        progress(part.index.into(), total);
        gathered[part.scene as usize].add(rows, options.format)?;
        let goes_on = !stop.load(Ordering::Relaxed);
        goes_on.then_some(()).ok_or(PeelError::Interrupted)
    })?;
    progress(total, total);
    let mut preview = Preview {
        size: options.size,
        format: options.format,
        parts: total,
        ..Preview::default()
    };
    let mut left = MOST_PICTURES;
    for (k, (scene, gathered)) in scenes.iter().zip(gathered).enumerate() {
        let own = peeled.iter().filter(|part| part.scene as usize == k);
        let sum = |of: fn(&Part) -> u64| own.clone().map(of).sum::<u64>();
        let rows = sum(|p| p.rows);
        preview.rows += rows;
        preview.pixels += sum(|p| p.pixels);
        preview.lost_fragments += sum(|p| p.lost_fragments);
        preview.coplanar_ties += sum(|p| p.coplanar_ties);
        preview.sampled_rows += gathered.sampled[0];
        preview.expected_bytes += gathered.expected_bytes(rows);
        let of_first = peeled
            .iter()
            .filter(|p| p.scene as usize == k && p.copy == 0);
        let views = of_first.count();
        let drawn = views.min(left).min((MOST_PICTURES / scenes.len()).max(1));
        left -= drawn;
        check_stop(stop)?;
        let pictures = draw(gpu, scene, drawn, options.size);
        preview.scenes.push(ScenePreview {
            name: scene.name.clone(),
            held_out: scene.held_out,
            views: views as u64,
            parts: own.clone().count() as u64,
            rows,
            pixels: sum(|p| p.pixels),
            depth: gathered.depth_bins(),
            fragments_per_pixel: gathered.summary.fragments_per_pixel,
            alpha: gathered.summary.alpha,
            pictures: pictures.map_err(EvalError::render(&scene.name, EXACT))?,
        });
    }
    Ok(preview)
}

/// Draws a view exactly, which counts its fragments: without lights, which are of none.
///
/// # Errors
/// As drawing does.
pub fn count(
    gpu: &Gpu,
    scene: &Scene,
    camera: &Camera,
    size: [u32; 2],
) -> Result<FrameStats, RenderError> {
    let mut unlit = scene.clone();
    unlit.lights.clear();
    let renderer = Renderer::new(gpu, &unlit)?;
    let mut exact = renderer.method(&EXACT.parse()?, MethodOptions::sized(size))?;
    Ok(renderer.image(&mut exact, camera)?.stats)
}

/// Draws the first views exactly, small.
fn draw(gpu: &Gpu, scene: &Scene, views: usize, size: [u32; 2]) -> Result<Vec<Image>, RenderError> {
    let longer = u64::from(size[0].max(size[1]).max(PICTURE_SIDE));
    let side = |n: u32| (u64::from(n) * u64::from(PICTURE_SIDE) / longer).max(1) as u32;
    let renderer = Renderer::new(gpu, scene)?;
    let options = MethodOptions::sized(size.map(side));
    let mut exact = renderer.method(&EXACT.parse()?, options)?;
    let views = scene.views[..views].iter();
    let frames = views.map(|camera| Ok(renderer.image(&mut exact, camera)?.image));
    frames.collect()
}

/// What is gathered of a scene's rows.
#[derive(Debug, Default)]
struct Gathered {
    summary: Summary,
    /// Rows by the leading bits of their depth. Numbers above 0 have the order of their bits.
    depths: BTreeMap<u32, u64>,
    /// Rows that were encoded, and their bytes.
    sampled: [u64; 2],
}

impl Gathered {
    fn add(&mut self, rows: &FragmentBatch, format: Format) -> Result<(), PeelError> {
        self.summary.add(rows);
        for depth in &rows.linear_depth {
            let key = depth.to_bits() >> DEPTH_BITS;
            *self.depths.entry(key).or_default() += 1;
        }
        let mut sample = FragmentBatch::default();
        sample.extend_from(rows, 0..rows.len().min(SAMPLED_ROWS));
        self.sampled[0] += sample.len() as u64;
        self.sampled[1] += format.bytes_of(&sample)?;
        Ok(())
    }

    fn expected_bytes(&self, rows: u64) -> u64 {
        let [sampled, bytes] = self.sampled.map(u128::from);
        (bytes * u128::from(rows) / sampled.max(1)) as u64
    }

    /// Bins of depth from the least to the greatest; neighbours are joined until they are few.
    fn depth_bins(&self) -> Vec<Bin> {
        let keys = self.depths.keys();
        let (Some(&first), Some(&last)) = (keys.clone().next(), keys.clone().next_back()) else {
            return Vec::new();
        };
        let mut joined = 0;
        while (last >> joined) - (first >> joined) >= DEPTH_BINS {
            joined += 1;
        }
        let edge = |key: u32| {
            let bits = key << (DEPTH_BITS + joined);
            f64::from(f32::from_bits(bits.min(f32::MAX.to_bits())))
        };
        let first = first >> joined;
        let bins = (first..=last >> joined).map(|key| Bin {
            from: edge(key),
            to: edge(key + 1),
            count: 0,
        });
        let mut bins: Vec<Bin> = bins.collect();
        for (key, count) in &self.depths {
            bins[((key >> joined) - first) as usize].count += count;
        }
        bins
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every depth is in the bin that its edges say, however far apart depths are.
    #[test]
    fn depths_are_in_their_bins() {
        for depths in [&[3.0, 3.01, 4.5][..], &[1e-30, 0.5, 2.0, 3e38], &[]] {
            let mut gathered = Gathered::default();
            let rows = FragmentBatch {
                linear_depth: depths.to_vec(),
                ..FragmentBatch::default()
            };
            gathered.add(&rows, Format::Csv).expect("adds");
            let bins = gathered.depth_bins();
            assert!(bins.len() <= DEPTH_BINS as usize);
            for bin in &bins {
                let is_in = |z: &&f32| (bin.from..bin.to).contains(&f64::from(**z));
                assert_eq!(depths.iter().filter(is_in).count() as u64, bin.count);
            }
            let all: u64 = bins.iter().map(|bin| bin.count).sum();
            assert_eq!(all, depths.len() as u64);
        }
    }
}
