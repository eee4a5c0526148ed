//! The three ways to peel against one another and against the 64-bit scan-line reference.

use glam::Vec3;
use peelnet_bench::stress::ground_truth::clip_triangles;
use peelnet_core::{hash, random::Random, scanline, tolerance::UNIT_ROUNDOFF};
use peelnet_peel::{
    Peel,
    read_back::{FragmentReader, RawTile},
};
use peelnet_render::gpu::Gpu;
use peelnet_render::{PixelSample, Renderer};
use peelnet_scene::{Material, Scene};
use peelnet_tests::{assert_refused, gpu, object, prepare, rectangle, scene, soup};

const SIZE: [u32; 2] = [61, 47];

/// Half the sub-pixel grid that WebGPU's adapters must at least have (1/16 pixel in Vulkan; 4 bits): vertices move by
/// at most this far, so a pixel whose fragments do not change under a shift this large is no silhouette.
const SNAP: f64 = 1.0 / 16.0;

/// Depth of a fragment moves with its position: pixels where the slope is steep see the snapping. Relative.
const DEPTH_TOLERANCE: f64 = 2e-3;

/// Random triangles, three to an object: a closed form is not needed where a reference is.
fn mixed(objects: usize, seed: u64) -> Scene {
    scene("soup", [0.5; 3], soup(seed, objects, 3, [2.0, 32.0]))
}

/// One pixel: depths and colours, front to back; empty slots left out.
type Pixel = Vec<(f32, [f32; 4])>;

fn read_pixels(
    gpu: &Gpu,
    scene: &Scene,
    peel: Peel,
    budget: Option<u64>,
    sample: Option<PixelSample>,
) -> (Vec<Pixel>, u32) {
    let mut reader = FragmentReader::new(gpu, scene, SIZE, peel, sample.is_some(), budget).unwrap();
    let mut pixels = vec![Pixel::new(); (SIZE[0] * SIZE[1]) as usize];
    let take = |tile: &mut RawTile| {
        for (run, i) in tile.offsets.windows(2).zip(tile.first_pixel as usize..) {
            let run = run[0] as usize..run[1] as usize;
            let fragments = run.map(|k| (tile.depths[k], tile.colors[k]));
            pixels[i].extend(fragments.filter(|(depth, _)| *depth > 0.0));
        }
        Ok(())
    };
    let sample = sample.unwrap_or(PixelSample::ALL);
    let found = reader
        .read_view(&scene.views[0], sample, None, take)
        .unwrap();
    let most = pixels.iter().map(Vec::len).max();
    assert_eq!(Some(found.max_layers as usize), most);
    (pixels, found.tiles)
}

/// In one tile, and of one scene also in tiles of a third of the frame and of less than a row.
#[test]
fn all_three_ways_find_the_same_fragments() {
    let gpu = gpu();
    for (seed, tilings) in [(1, 3), (2, 1), (3, 1)] {
        let scene = mixed(40, seed);
        let (sbuffer, _) = read_pixels(&gpu, &scene, Peel::SBuffer, None, None);
        assert!(sbuffer.iter().map(Vec::len).max() > Some(10));
        let total: usize = sbuffer.iter().map(Vec::len).sum();
        for peel in [Peel::SBuffer, Peel::Dual, Peel::Single] {
            let budgets = [None, Some(total as u64 / 3), Some(150)];
            for budget in &budgets[..tilings] {
                let (found, tiles) = read_pixels(&gpu, &scene, peel, *budget, None);
                assert!(budget.map_or(tiles == 1, |_| tiles >= 3));
                assert!(found == sbuffer, "{peel}, seed {seed}, {tiles} tiles");
            }
        }
    }
}

/// Stacks side by side, one pixel each: `lists` are their depths in the order of drawing. The layers of a stack are quads of 32 materials.
fn deep_pixels(lists: &[Vec<f32>]) -> (Scene, [u32; 2]) {
    let columns = (lists.len() as f32).sqrt().ceil() as usize;
    let size = [columns, lists.len().div_ceil(columns)];
    let side = |i: usize, n: usize| 2.0 * i as f32 / n as f32 - 1.0;
    let aspect = size[0] as f32 / size[1] as f32;
    let mut objects: Vec<Vec<[Vec3; 3]>> = vec![Vec::new(); 32];
    for (i, list) in lists.iter().enumerate() {
        let (x, y) = (i % columns, i / columns);
        for (k, &z) in list.iter().enumerate() {
            let columns = [x, x + 1].map(|x| side(x, size[0]) * aspect * z);
            let rows = [y + 1, y].map(|y| -side(y, size[1]) * z);
            objects[k % 32].extend(rectangle(columns, rows, z));
        }
    }
    let layers = |(i, triangles): (usize, &Vec<[Vec3; 3]>)| {
        let color = [i as f32 / 32.0, 1.0 - i as f32 / 32.0, 0.25];
        object(triangles, Material::unlit(color, 0.01))
    };
    let objects = objects.iter().enumerate().map(layers).collect();
    let scene = scene("deep pixels", [0.5; 3], objects);
    (scene, size.map(|n| n as u32))
}

/// Runs of every length around the borders between one sort and another, random ones up to 20,000, with ties: the rows are those that the
/// CPU's sort gives, bit for bit, and no fragment is lost, found twice, or given another's colour.
#[test]
fn rows_of_deep_pixels_are_those_of_a_sort_on_the_cpu() {
    use peelnet_render::geometry::long_runs::{PIECE, SHORT};
    let gpu = gpu();
    let mut random = Random::new(33, &[]);
    // Once and twice the window of a thread lie among them.
    let mut lengths: Vec<usize> = (1..=2 * SHORT as usize + 3).collect();
    for border in [256, 512, 1024, 2048, 4096, PIECE as usize] {
        lengths.extend([border - 1, border, border + 1]);
    }
    lengths.extend((0..4).map(|_| 129 + (random.unit() * 19_871.0) as usize));
    let mut list = |n: usize, tied: bool| -> Vec<f32> {
        let depth = |t: f32| 2.0 + if tied { (t * 7.0).floor() } else { 4.0 * t };
        (0..n).map(|_| depth(random.unit())).collect()
    };
    let lists = lengths.iter().enumerate();
    let lists: Vec<Vec<f32>> = lists.map(|(i, &n)| list(n, i % 3 == 0)).collect();
    let (scene, size) = deep_pixels(&lists);
    let objects = scene.objects.iter();
    let colors: Vec<[f32; 3]> = objects
        .flat_map(|o| vec![o.materials[0].color; o.mesh.triangles.len()])
        .collect();
    // A tile for all, and tiles of which some hold a few pixels.
    for budget in [None, Some(30_000)] {
        let reader = FragmentReader::new(&gpu, &scene, size, Peel::SBuffer, false, budget);
        let mut reader = reader.unwrap();
        reader.keep_triangles(true);
        let mut pixels = 0;
        let check = |tile: &mut RawTile| {
            for (run, pixel) in tile.offsets.windows(2).zip(tile.first_pixel..) {
                let run = run[0] as usize..run[1] as usize;
                let Some(list) = lists.get(pixel as usize) else {
                    continue;
                };
                pixels += 1;
                let key = |i: usize| (tile.depths[i].to_bits(), tile.triangles[i]);
                let rows: Vec<(u32, u32)> = run.clone().map(key).collect();
                assert_eq!(rows.len(), list.len());
                let mut sorted = rows.clone();
                sorted.sort_unstable();
                assert!(rows == sorted, "{} rows of pixel {pixel}", rows.len());
                sorted.dedup();
                assert_eq!(sorted.len(), list.len());
                for i in run {
                    let color = colors[tile.triangles[i] as usize];
                    assert_eq!(tile.colors[i][..3], color, "pixel {pixel}");
                }
                let mut depths = list.clone();
                depths.sort_unstable_by(f32::total_cmp);
                for (row, depth) in rows.iter().zip(depths) {
                    let error = f64::from((f32::from_bits(row.0) - depth).abs());
                    assert!(error <= 8.0 * UNIT_ROUNDOFF * f64::from(depth), "{error}");
                }
            }
            Ok(())
        };
        let (view, all) = (&scene.views[0], PixelSample::ALL);
        reader.read_view(view, all, None, check).unwrap();
        assert_eq!(pixels, lists.len());
    }
}

/// Depths between 2 and 6 in any order.
fn random_depths(n: usize, seed: u64) -> Vec<f32> {
    let mut random = Random::new(seed, &[]);
    (0..n).map(|_| 2.0 + 4.0 * random.unit()).collect()
}

/// A shader's module, what of its text is changed to what, and what the error then says: of storage that is sorted in passes of its own, and of
/// linked lists.
const BROKEN: &str = "
peel::sort => if next < depth => if next <= depth + 1.0 => out of order
peel::long_chunks => depth < own => depth < own * 0.5 => out of order
peel::long_merge => near.depth < far.depth => near.depth > far.depth => out of order
peel::long_merge => least = half + 1u => least = half + 2u => out of order
peel::store => let pixel = => if surface.triangle == 6u { discard; } let pixel = => 1 lost
peel::store => let pixel = => if surface.triangle == 6u { let at = vec2u(surface.position.xy); atomicSub(&counts[at.y * camera.frame_size.x + at.x], 1u); } let pixel = => 1 found twice
methods::linked_list::composite => return near < far => return near > far => out of order
methods::linked_list::composite => let following = next[node - 1u]; => let following = next[next[node - 1u] - 1u]; => lost
methods::linked_list::composite => left_count > 0u && (right_empty || before(left, right)) => left_count > 0u => out of order
";

/// What is wrong in a sort or loses fragments ends the extraction and the exact image with an error that says what and where.
#[test]
fn broken_sorts_and_lost_fragments_are_errors() {
    let gpu = gpu();
    for row in BROKEN.trim().lines() {
        let columns: Vec<&str> = row.split(" => ").collect();
        let [module, from, to, expected] = columns[..] else {
            panic!("{row}");
        };
        let is_stored = module.starts_with("peel::");
        let mut lists = vec![random_depths(40, 1)];
        lists.extend(is_stored.then(|| random_depths(3000, 2)));
        let (scene, size) = deep_pixels(&lists);
        let text = peelnet_render::shaders::source(module).unwrap();
        assert!(text.contains(from), "{module}: {from}");
        let altered = text.replacen(from, to, 1);
        peelnet_render::shaders::with_altered(module, &altered, || {
            if is_stored {
                let reader = FragmentReader::new(&gpu, &scene, size, Peel::SBuffer, false, None);
                let (view, all) = (&scene.views[0], PixelSample::ALL);
                let ignored = |_: &mut RawTile| Ok(());
                let read = reader.unwrap().read_view(view, all, None, ignored);
                assert_refused(read, &[expected, "pixel ("]);
            }
            let renderer = Renderer::new(&gpu, &scene).unwrap();
            let method = if is_stored { "abuffer" } else { "linked-list" };
            let mut prepared = prepare(&renderer, method, size);
            let drawn = renderer.image(&mut prepared, &scene.views[0]);
            assert_refused(drawn, &[expected]);
        });
    }
}

#[test]
fn a_pixel_sample_keeps_whole_pixels_and_the_right_ones() {
    let gpu = gpu();
    let scene = mixed(30, 5);
    let sample = PixelSample {
        seed: 77,
        view: 3,
        threshold: hash::sample_threshold(0.3),
    };
    let (whole, _) = read_pixels(&gpu, &scene, Peel::SBuffer, None, None);
    let (kept, _) = read_pixels(&gpu, &scene, Peel::SBuffer, None, Some(sample));
    for (i, (w, k)) in (0..).zip(whole.iter().zip(&kept)) {
        let (x, y) = (i % SIZE[0], i / SIZE[0]);
        let inside = hash::pixel_hash(77, 3, x, y) <= sample.threshold;
        assert!(if inside { w == k } else { k.is_empty() }, "pixel {x}, {y}");
    }
}

#[test]
fn the_reference_finds_the_same_fragments() {
    let gpu = gpu();
    for seed in 20..24 {
        let scene = mixed(30, seed);
        let triangles = clip_triangles(&scene, &scene.views[0], SIZE);
        let [w, h] = SIZE.map(|s| s as usize);
        let reference = scanline::rasterise(&triangles, w, h, [0.0; 2]);
        let stable = scanline::stable_pixels(&triangles, w, h, SNAP);
        let (peeled, _) = read_pixels(&gpu, &scene, Peel::SBuffer, None, None);
        let (mut judged, mut fragments) = (0, 0);
        for i in 0..w * h {
            if !stable[i] {
                continue;
            }
            judged += 1;
            let (want, got) = (&reference.pixels[i], &peeled[i]);
            assert_eq!(want.len(), got.len(), "pixel {i}, seed {seed}");
            for (k, (want, (depth, color))) in want.iter().zip(got).enumerate() {
                fragments += 1;
                let off = (f64::from(*depth) / want.depth - 1.0).abs();
                assert!(off <= DEPTH_TOLERANCE, "pixel {i}, layer {k}: {off}");
                // Where neighbours are further apart than the tolerance their order is certain, and so is the colour.
                let apart = |j: Option<&scanline::Hit>| {
                    j.is_none_or(|o| (o.depth / want.depth - 1.0).abs() > 2.0 * DEPTH_TOLERANCE)
                };
                let before = k.checked_sub(1).and_then(|k| reference.pixels[i].get(k));
                if apart(before) && apart(reference.pixels[i].get(k + 1)) {
                    let material = &scene.objects[want.id as usize / 3].materials[0];
                    assert_eq!(color[3], material.alpha);
                    assert_eq!(color[..3], material.color);
                }
            }
        }
        assert!(judged > w * h / 2, "only {judged} are no silhouettes");
        assert!(fragments > 3 * judged, "{fragments} in {judged} pixels");
    }
}
