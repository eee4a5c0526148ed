//! `abuffer`: every fragment stored, sorted and composited (S-buffer, Vasilakis & Fudos 2012).
//!
//! A frame's storage has the room that an earlier frame needed. Fragments beyond it are left out and counted, and the next frame has room.

mod expectations;

use crate::geometry::{
    FrameTargets, SceneBuffers,
    count::{CountPass, FragmentCount},
    fragments::Tile,
    fullscreen::FullscreenPass,
    long_runs::{self, Fold},
    sbuffer::SBuffer,
};
use crate::gpu::{bind::Bind, wgpu};
use crate::methods::prelude::*;
use crate::passes::{compositor::resolve, views::Composite};

const BUDGET: Parameter = Parameter::whole(
    "budget",
    "fragments that one tile may hold",
    None,
    (1, 1 << 32),
);

pub(super) const METHOD: Method = Method {
    parameters: &[BUDGET],
    curve: &["", ":scale=0.5"],
    expectations: expectations::METHOD,
    ..Method::own(
        "abuffer",
        "exact: S-buffer, every fragment stored and sorted",
        build,
    )
};

/// Fragments that the first frame has room for, a pixel, where nothing is known yet.
pub(super) const FIRST_GUESS: u64 = 4;

#[derive(Debug)]
struct ABuffer {
    sbuffer: SBuffer,
    composite: Composite,
    pass: Option<FullscreenPass>,
    /// Where runs are long.
    fold: Option<Fold>,
    /// Of the last plan; empty before the first.
    tiles: Vec<Tile>,
    /// Offsets of the frame at the ends of its tiles, for frames of several.
    ends: wgpu::Buffer,
    /// Whether the tiles come from counts, not from a guess.
    is_counted: bool,
    /// Whether the next frame's offsets come back: they plan the tiles of the frame that follows.
    wants_offsets: bool,
}

fn build(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    build_with(b, None)
}

/// Stores, sorts and composites every pixel's run; `rounding` is the feature of how colours are stored.
pub(super) fn build_with(
    b: &Build<'_>,
    rounding: Option<&'static str>,
) -> Result<Box<dyn Compositor>, RenderError> {
    let composite = b.options.shows.composite(b.scene.tinted);
    let features: Vec<_> = rounding.into_iter().chain(composite.stored).collect();
    let budget = BUDGET.count(b.spec);
    Ok(Box::new(ABuffer {
        sbuffer: SBuffer::new(b.scene, b.frame, budget, &features)?,
        composite,
        pass: None,
        fold: None,
        tiles: Vec::new(),
        ends: b.scene.gpu.storage("tile ends", 4)?,
        is_counted: false,
        // A first frame may need several tiles.
        wants_offsets: true,
    }))
}

impl ABuffer {
    /// Plans the tiles of a frame; without `offsets` it may find that it needs them.
    fn plan(
        &mut self,
        scene: &SceneBuffers,
        frame: &FrameTargets,
        needed: FragmentCount,
        offsets: Option<&[u32]>,
    ) -> Result<bool, RenderError> {
        let planned = self.sbuffer.plan(scene, frame, needed, offsets)?;
        let Some((tiles, is_new)) = planned else {
            return Ok(false);
        };
        let gpu = &scene.gpu;
        let ends = tiles.len() as u64 * 4;
        if self.ends.size() < ends {
            self.ends = gpu.storage("tile ends", ends)?;
        }
        if let (true, Some(storage)) = (is_new || self.pass.is_none(), self.sbuffer.storage()) {
            let mut entries = vec![
                ("tile", Bind::Uniform(&self.sbuffer.tile)),
                ("camera", Bind::Uniform(&scene.camera)),
                ("offsets", Bind::Read(&self.sbuffer.count.offsets)),
                ("fragments", Bind::Read(&storage.colors)),
                ("background", Bind::Texture(&frame.background)),
            ];
            let mut features = self.composite.features.clone();
            let parameters = self.composite.parameters.clone() + &long_runs::parameters();
            self.fold = None;
            if let Some(long) = self.sbuffer.long_runs() {
                entries.push(("order", Bind::Write(&long.order)));
                features.push("long");
                let of_fold = [features.as_slice(), &[self.composite.name]].concat();
                let most = self.sbuffer.most();
                self.fold = Some(Fold::new(gpu, &of_fold, &parameters, &entries, most)?);
            }
            let shader = self.composite.shader;
            let extra = [("parameters", parameters.as_str())];
            let pass = resolve(gpu, frame, shader, &features, &extra, &entries);
            self.pass = Some(pass?);
        }
        self.tiles = tiles;
        Ok(true)
    }

    /// Whether every tile had room for its fragments. `ends` are the offsets at the tiles' ends, where there are several.
    fn had_room(&self, total: u64, ends: Option<&Vec<u32>>) -> bool {
        let several = ends.filter(|_| self.tiles.len() > 1);
        let last = [u32::try_from(total).unwrap_or(u32::MAX)];
        let ends: &[u32] = several.map_or(&last, |ends| ends);
        let mut begin = 0;
        self.tiles.iter().zip(ends).all(|(tile, &end)| {
            let load = end.wrapping_sub(begin);
            begin = end;
            load <= tile.capacity
        })
    }
}

impl Compositor for ABuffer {
    fn draw(&mut self, cx: &mut DrawContext<'_, '_>) -> Result<FrameStats, RenderError> {
        self.sbuffer.count.encode(cx.recorder, cx.scene, cx.frame);
        if cx.only_count {
            return Ok(FrameStats::default());
        }
        if self.tiles.is_empty() {
            let guess = u64::from(cx.frame.pixels()) * FIRST_GUESS;
            let guess = FragmentCount {
                total: guess.min(self.sbuffer.limit),
                most: 0,
            };
            self.plan(cx.scene, cx.frame, guess, None)?;
        }
        let mut output = cx.output();
        for (number, tile) in (0..).zip(&self.tiles) {
            self.sbuffer
                .store_and_sort(cx.recorder, cx.scene, cx.frame, tile);
            if let Some(fold) = &self.fold {
                fold.encode(cx.recorder, tile);
            }
            if let Some(pass) = &self.pass {
                let within = tile.scissor(cx.frame.size[0]);
                pass.draw(cx.recorder, &[output.clone()], Some(within));
            }
            // The tiles before stay.
            if let Some(output) = &mut output {
                output.ops.load = wgpu::LoadOp::Load;
            }
            let offsets = &self.sbuffer.count.offsets;
            let end = u64::from(tile.end) * 4;
            cx.recorder
                .encoder()
                .copy_buffer_to_buffer(offsets, end, &self.ends, number * 4, 4);
        }
        Ok(FrameStats {
            tiles: self.tiles.len() as u32,
            geometry_passes: 1 + self.tiles.len() as u32,
            fullscreen_passes: 3 + 2 * self.tiles.len() as u32,
            ..Default::default()
        })
    }

    fn is_ready(&self) -> bool {
        self.is_counted
    }

    fn feedback(&self) -> Vec<wgpu::Buffer> {
        let count = &self.sbuffer.count;
        let offsets = self.wants_offsets.then_some(&count.offsets);
        let all = [&count.total, &count.faults, &self.ends].into_iter();
        all.chain(offsets).cloned().collect()
    }

    fn learn(
        &mut self,
        b: &Build<'_>,
        exact: bool,
        words: &[Vec<u32>],
        stats: &mut FrameStats,
    ) -> Result<Fit, RenderError> {
        let found = CountPass::parse(&words[0])?;
        stats.fragments = Some(found.total);
        stats.max_layers = Some(found.most);
        let stored = if self.tiles.len() > 1 {
            self.sbuffer.limit.min(found.total)
        } else {
            found.total
        };
        // Count, offset and the unwritten attachment; then the fragments.
        stats.bytes_per_pixel =
            9.0 + stored as f64 * self.sbuffer.bytes_per_fragment() / f64::from(b.frame.pixels());
        // A frame that fits one tile may be followed by one that does not; at least half of a tile is left then.
        self.wants_offsets = found.total > self.sbuffer.limit / 2;
        let is_whole = !self.tiles.is_empty()
            && found.most <= self.sbuffer.most()
            && self.had_room(found.total, words.get(2));
        if is_whole {
            CountPass::check(&words[1], b.frame.size[0])?;
        }
        let one_would_do = self.tiles.len() > 1 && found.total <= self.sbuffer.limit;
        if is_whole && !one_would_do {
            self.is_counted = true;
            return Ok(Fit::Whole);
        }
        let limit = self.sbuffer.limit;
        // A quarter more where views move, as far as one tile holds it.
        let reserve = if exact { 0 } else { found.total / 4 };
        let needed = FragmentCount {
            total: (found.total + reserve).min(limit).max(found.total),
            most: found.most,
        };
        let offsets = words.get(3).map(Vec::as_slice);
        self.is_counted = self.plan(b.scene, b.frame, needed, offsets)?;
        Ok(if is_whole { Fit::Loose } else { Fit::TooSmall })
    }
}
