//! Fragment lists that no scene was drawn for: training data wider than any suite of scenes.
//!
//! Lists come in *worlds* of [`PIXELS`] lists. A world draws once what the pixels of a view have in common: how far its
//! depths range (1.05 to 8,000 times), where its objects lie (evenly, towards the front, in clusters, in rows), whether
//! they are sheets, bodies with two surfaces or thin walls, how opaque each is (the schemes that scenes are varied with,
//! and particles), and their colours. A list is then a ray through it: it meets some objects, each off its middle by
//! chance. Of five worlds two have a sheet or two apart from the rest, as windows, visors, water and backdrops are. A world is a part of the
//! dataset like a view of a scene, with the same columns.

use crate::{
    ExtractOptions, ExtractReport, PeelError, Progress,
    extract::{Message, Outbox, write},
    read_back::{RawTile, ReadBack},
};
use peelnet_core::random::Random;
use peelnet_dataset::{CameraInfo, Header, MAX_WORK_ITEMS, Part, SceneEntry, worker_name};
use std::sync::atomic::AtomicBool;

/// Lists of one world.
pub const PIXELS: u64 = 32 * 32;
/// Lists of one dataset.
pub const MAX_LISTS: u64 = PIXELS * MAX_WORK_ITEMS as u64;
/// Most fragments of one list.
const MOST: usize = 160;
/// The scene's name in the dataset.
const NAME: &str = "synthetic";

/// Something that rays meet.
#[derive(Clone, Copy, Debug)]
struct Object {
    /// Middle, in 0 … 1 of the world's depth range.
    middle: f32,
    /// Half of its depth; 0 for a sheet.
    half: f32,
    /// Thickness of its walls; 0 where a surface is one fragment.
    wall: f32,
    alpha: f32,
    color: [f32; 3],
}

/// What the lists of a part have in common.
#[derive(Clone, Debug)]
struct World {
    /// Nearest depth, scene units.
    near: f32,
    /// Logarithm of the depth range.
    log_range: f32,
    objects: Vec<Object>,
    /// Sheets far before or behind the objects, which nearly all rays meet.
    apart: Vec<Object>,
    /// How likely a ray meets an object.
    hit: f32,
    /// How much a sheet's depth varies from ray to ray.
    slope: f32,
    /// Whether opacity falls off towards an object's rim, as in sprites.
    sprites: bool,
    own_alpha: bool,
}

impl World {
    fn new(random: &mut Random) -> Self {
        let count = random.log_between(2.0, 90.0) as usize;
        let log_range = random.log_between(0.05, 9.0);
        let placement = random.below(5);
        let clusters: [f32; 3] = std::array::from_fn(|_| random.unit());
        let kind = random.below(6);
        let scheme = random.below(9);
        let same = random.between(0.02, 0.98);
        let bands = [random.between(0.02, 0.98), random.between(0.02, 0.98)];
        let palette: [f32; 4] = std::array::from_fn(|_| random.between(0.02, 0.98));
        let wall = random.log_between(1e-3, 0.1);
        let size = random.log_between(0.01, 0.5);
        let objects = (0..count)
            .map(|i| {
                let u = random.unit();
                let middle = match placement {
                    0 => u,
                    1 => u * u,
                    2 => 1.0 - u * u,
                    3 => (clusters[random.below(3)] + 0.1 * (u - 0.5)).clamp(0.0, 1.0),
                    _ => (i as f32 + 0.5 * u) / count as f32,
                };
                let body = match kind {
                    0 | 1 => false,
                    2 | 3 => true,
                    _ => random.unit() < 0.5,
                };
                let half = if body {
                    size * random.between(0.3, 1.0)
                } else {
                    0.0
                };
                let thin = body && kind == 3 || random.unit() < 0.15;
                let u = random.unit();
                let alpha = match scheme {
                    0 | 1 => 0.02 + 0.97 * u,
                    2 => same,
                    3 => [0.02, 0.98][usize::from(u < 0.5)],
                    4 => 0.8 + 0.19 * u,
                    5 => 0.02 + 0.18 * u,
                    6 => (bands[usize::from(middle > 0.5)] + 0.1 * (u - 0.5)).clamp(0.02, 0.98),
                    7 => palette[random.below(4)],
                    _ => u * u * u,
                };
                Object {
                    middle,
                    half,
                    wall: if thin { wall } else { 0.0 },
                    alpha: alpha.clamp(0.005, 0.998),
                    color: random.color(),
                }
            })
            .collect();
        let apart = [0.6, 0.7].map(|one_more| {
            let (is_none, is_near) = (random.unit() < one_more, random.unit() < 0.7);
            let times = if is_near {
                1.0 / random.log_between(1.5, 50.0)
            } else {
                random.log_between(1.5, 20.0)
            };
            let sheet = Object {
                middle: f32::from(u8::from(!is_near)) + times.ln() / log_range,
                half: 0.0,
                wall: 0.0,
                alpha: random.between(0.03, 0.6),
                color: random.color(),
            };
            (!is_none).then_some(sheet)
        });
        // A second one only beside a first.
        let apart = apart.into_iter().map_while(|sheet| sheet).collect();
        Self {
            apart,
            near: random.log_between(0.05, 20.0),
            log_range,
            objects,
            hit: random.between(0.15, 1.0),
            slope: random.log_between(1e-3, 0.3),
            sprites: random.unit() < 0.15,
            own_alpha: random.unit() < 0.1,
        }
    }

    /// A ray's fragments, in any order: depth and (radiance, α).
    fn list(&self, random: &mut Random) -> Vec<(f32, [f32; 4])> {
        let mut list = Vec::new();
        for sheet in &self.apart {
            let (met, at) = (random.unit(), sheet.middle);
            if met < 0.9 {
                let [r, g, b] = sheet.color;
                list.push((
                    self.near * (self.log_range * at).exp(),
                    [r, g, b, sheet.alpha],
                ));
            }
        }
        for o in &self.objects {
            // Drawn for every object, so that missing one changes nothing of the others.
            let (met, offset, falloff) = (random.unit(), random.unit(), random.unit());
            if met >= self.hit || list.len() + 4 > MOST {
                continue;
            }
            let middle = o.middle + self.slope * (offset - 0.5);
            // Half a chord through a ball, `offset` of the radius off its middle.
            let chord = o.half * (1.0 - offset * offset).sqrt();
            let shade = 0.4 + 0.6 * falloff;
            let mut add = |at: f32| {
                let mut alpha = o.alpha;
                if self.sprites {
                    alpha *= 1.0 - falloff * falloff;
                }
                if self.own_alpha {
                    alpha = random.between(0.02, 0.98);
                }
                let [r, g, b] = o.color.map(|c| c * shade);
                let depth = self.near * (self.log_range * at).exp();
                list.push((depth, [r, g, b, alpha.max(1e-3)]));
            };
            let walls: &[f32] = if o.wall > 0.0 { &[0.0, o.wall] } else { &[0.0] };
            for inward in walls {
                add(middle - chord + inward);
                if chord > 0.0 {
                    add(middle + chord - inward);
                }
            }
        }
        list
    }
}

/// Writes a dataset of so many lists, part by part, as [`extract`](crate::extract()) does. Of the options, folder, format, seed, command
/// and `resume` are used.
///
/// # Errors
/// More than [`MAX_LISTS`], a folder that cannot be written, or [`PeelError::Interrupted`] when `stop` becomes true.
pub fn synthetic(
    lists: u64,
    options: &ExtractOptions,
    stop: &AtomicBool,
    progress: &mut dyn FnMut(&Progress),
) -> Result<ExtractReport, PeelError> {
    if lists > MAX_LISTS {
        let reason = format!("{lists} synthetic lists are too many: at most {MAX_LISTS}");
        return Err(PeelError::setting("lists", reason));
    }
    let header = Header {
        format: options.format,
        seed: options.seed,
        adapter: "none".to_owned(),
        adapter_class: "none".to_owned(),
        tool_version: env!("CARGO_PKG_VERSION").to_owned(),
        command: options.command.clone(),
        peel: NAME.to_owned(),
        pixels_fraction: 1.0,
        settings: [("number of lists".to_owned(), lists.to_string())].into(),
        scenes: vec![SceneEntry {
            name: NAME.to_owned(),
            file: NAME.to_owned(),
            // Nothing is read; the lists follow from the seed and this version.
            sha256: "0".repeat(64),
            content: String::new(),
            held_out: false,
            effects: Vec::new(),
        }],
        work_items: lists.div_ceil(PIXELS) as u32,
        resume: options.resume,
        worker: worker_name(),
        ..Header::default()
    };
    write(&options.out, header, stop, progress, |missing, outbox| {
        let mut missing = missing.iter();
        missing.try_for_each(|&index| {
            let lists = PIXELS.min(lists - u64::from(index) * PIXELS);
            make(options.seed, index, lists, outbox)
        })
    })
}

/// One world into the channel.
fn make(seed: u64, index: u32, lists: u64, outbox: &Outbox) -> Result<(), PeelError> {
    let mut random = Random::new(seed, &[0x5e7f, index.into()]);
    let world = World::new(&mut random);
    let (mut tile, [near, far]) = draw(&world, lists, &mut random);
    outbox.deliver(Message::Begin(Part {
        index,
        view: index,
        camera: CameraInfo {
            position: [0.0; 3],
            target: [0.0, 0.0, -1.0],
            up: [0.0, 1.0, 0.0],
            fov_y_degrees: 45.0,
            near,
            far,
        },
        width: 32,
        height: 32,
        ..Part::default()
    }))?;
    outbox.tile(&mut tile)?;
    outbox.deliver(Message::End(ReadBack::default()))
}

/// A tile of a world's lists, sorted, and clip distances around them.
fn draw(world: &World, lists: u64, random: &mut Random) -> (RawTile, [f32; 2]) {
    let mut tile = RawTile::default();
    tile.offsets.push(0);
    for _ in 0..lists {
        let mut list = world.list(random);
        list.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (depth, color) in list {
            tile.depths.push(depth);
            tile.colors.push(color);
        }
        tile.offsets.push(tile.depths.len() as u32);
    }
    let near = tile.depths.iter().copied().fold(f32::MAX, f32::min);
    let far = tile.depths.iter().copied().fold(0.0, f32::max);
    let clip = match far > 0.0 {
        true => [near * 0.5, far * 2.0],
        false => [0.1, 100.0],
    };
    (tile, clip)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Worlds differ widely, and each of their lists is a valid pixel.
    #[test]
    fn worlds_are_wide() {
        let mut ranges = Vec::new();
        let mut layers = Vec::new();
        let mut apart = [0; 3];
        for seed in 0..300 {
            let mut random = Random::new(seed, &[]);
            let world = World::new(&mut random);
            let (tile, range) = draw(&world, 64, &mut random);
            assert_eq!(tile.offsets.len(), 65);
            for run in tile.offsets.windows(2) {
                let depths = &tile.depths[run[0] as usize..run[1] as usize];
                assert!(depths.is_sorted() && depths.len() <= MOST);
                layers.push(depths.len());
            }
            assert!(tile.depths.iter().all(|&z| z > range[0] && z < range[1]));
            assert!(tile.colors.iter().all(|c| c[3] > 0.0 && c[3] < 1.0));
            ranges.push(world.log_range);
            apart[world.apart.len()] += 1;
        }
        let most = layers.iter().max().copied().unwrap_or(0);
        assert!(most >= 100 && layers.contains(&3), "{most}");
        assert!(
            apart[0] > 150 && apart[1] > 50 && apart[2] > 15,
            "{apart:?}"
        );
        assert!(ranges.iter().any(|&r| r < 0.1) && ranges.iter().any(|&r| r > 8.0));
    }
}
