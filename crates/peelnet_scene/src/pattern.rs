//! Generated textures: a field of 0 … 1 that repeats without a seam, read as colours, heights or values.

mod letters;

use crate::{
    parameters::parameters,
    texture::{Texture, fill, normals_of},
};
use glam::{IVec2, Vec2};
use peelnet_core::{hash::pixel_hash, srgb};
use rayon::prelude::*;
use serde::Deserialize;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Field {
    /// Squares of 0 and 1.
    Checker,
    /// Smooth noise of five octaves.
    Noise,
    /// 1 along the borders of irregular cells, like cracks in a glaze.
    Cracks,
    /// 1 in some bands across the texture, with waves on their edges: painted decoration.
    Bands,
    /// 1 on capital letters in lines, with words between spaces: a page of a text that means nothing.
    Letters,
    /// 1 in the middle, falling to 0 before the edges with a ragged border: a puff of smoke or a small cloud.
    Puff,
}

parameters! {
    /// A generated map: `color_map = { pattern = "cracks", cells = 12, colors = [[1, 1, 1], [0.2, 0.1, 0]] }`.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) struct Pattern {
        pattern: Field = Field::Checker,
        /// Cells across and down the texture.
        cells: u32 = 8,
        /// Another seed, another pattern.
        seed: u32 = 0,
        /// Width and height in texels.
        size: u32 = 512,
        /// Where the field goes from 0 to 1: values below the first are 0, above the second 1.
        range: [f32; 2] = [0.0, 1.0],
        /// Width of cracks as a part of a cell.
        width: f32 = 1.0 / 12.0,
        /// Linear RGB, or RGB and alpha, at 0 and at 1; for colours and emission.
        colors: [Vec<f32>; 2] = [vec![0.0; 3], vec![1.0; 3]],
        /// Rise of 1 over 0 in widths of a cell; for normals.
        height: f32 = 1.0 / 12.0,
        /// Metallic factor at 0 and at 1.
        metallic: [f32; 2] = [0.0, 1.0],
        /// Roughness factor at 0 and at 1.
        roughness: [f32; 2] = [0.0, 1.0],
        /// Share of ambient light that arrives at 0 and at 1.
        occlusion: [f32; 2] = [0.0, 1.0],
    }
}

impl Pattern {
    pub fn check(&self) -> Result<(), String> {
        let unit = |x: f32| (0.0..=1.0).contains(&x);
        if !(4..=4096).contains(&self.size) {
            return Err(format!("size {} must lie in 4 … 4096", self.size));
        }
        if !(1..=256).contains(&self.cells) {
            return Err(format!("cells {} must lie in 1 … 256", self.cells));
        }
        if self.colors.iter().any(|c| !matches!(c.len(), 3 | 4)) {
            return Err(
                "colors must be two of [red, green, blue] or [red, green, blue, alpha]".into(),
            );
        }
        let factors = [self.metallic, self.roughness, self.occlusion];
        let all = factors.iter().flatten().chain(self.colors.iter().flatten());
        if let Some(x) = all.chain([&self.width]).find(|x| !unit(**x)) {
            return Err(format!("{x} must lie in 0 … 1, as all values of a pattern"));
        }
        if !(self.height.is_finite() && self.range.iter().all(|x| x.is_finite()))
            || self.range[0] == self.range[1]
        {
            return Err("height and range must be finite, and the ends of range differ".into());
        }
        Ok(())
    }

    /// The field's values, row by row.
    fn values(&self) -> Vec<f32> {
        let n = self.size;
        let grid = |(times, channel)| self.grid(self.cells * times, channel);
        let grids: Vec<Grid> = match self.pattern {
            Field::Checker | Field::Bands => Vec::new(),
            Field::Letters => vec![grid((1, 9))],
            Field::Noise | Field::Puff => (0..5).map(|k| grid((1 << k, k))).collect(),
            Field::Cracks => [(1, 5), (1, 6), (2, 7), (2, 8)].map(grid).into(),
        };
        let at = |x: u32, y: u32| {
            // Texel centres, in cells.
            let place = (Vec2::new(x as f32, y as f32) + 0.5) / n as f32 * self.cells as f32;
            let raw = match self.pattern {
                Field::Checker => ((place.x as u32 + place.y as u32) % 2) as f32,
                Field::Noise => octaves(&grids, place),
                Field::Cracks => {
                    // Not straight: the borders of cells are pushed about by noise.
                    let push = Vec2::new(grids[2].noise(place * 2.0), grids[3].noise(place * 2.0));
                    let border = border(&grids, place + (push - 0.5) * 0.35);
                    1.0 - smoothstep(0.0, self.width, border)
                }
                Field::Letters => letters::ink(place, |cell| grids[0].at(cell)),
                Field::Puff => {
                    let out = (place / self.cells as f32 - 0.5).length() * 2.0;
                    // The noise eats into the disc from its edge; nothing is left at a distance of 1.
                    let ball = (1.0 - out * out).max(0.0);
                    (ball * (0.4 + 1.2 * octaves(&grids, place)) - 0.1).max(0.0)
                }
                Field::Bands => {
                    let down = place.y / self.cells as f32;
                    let wave = 0.012 * (std::f32::consts::TAU * place.x).sin();
                    let bands = [0.22, 0.3, 0.62, 0.68f32];
                    let near = bands.map(|b| (down + wave - b).abs());
                    let nearest = near.into_iter().fold(1.0, f32::min);
                    1.0 - smoothstep(0.012, 0.016, nearest)
                }
            };
            ((raw - self.range[0]) / (self.range[1] - self.range[0])).clamp(0.0, 1.0)
        };
        fill([n, n], at)
    }

    fn grid(&self, period: u32, channel: u32) -> Grid {
        let (seed, texels) = (self.seed, self.size * self.size);
        let mut grid = Grid {
            seed,
            channel,
            period,
            numbers: Vec::new(),
        };
        // Of more nodes than texels, few are asked for.
        if period * period <= texels {
            let node = |i: u32| grid.number([i % period, i / period]);
            grid.numbers = (0..period * period).into_par_iter().map(node).collect();
        }
        grid
    }

    /// The texture that a key of a material makes of it, whose values are in range.
    pub fn texture(&self, key: &str) -> Texture {
        let values = self.values();
        let n = self.size;
        let at = |x: u32, y: u32| values[(y * n + x) as usize];
        let of = |name: &str, texel: &(dyn Fn(f32) -> [u8; 4] + Sync)| {
            Texture::of(name, [n, n], |x, y| texel(at(x, y)))
        };
        let between = |[a, b]: [f32; 2], t: f32| byte(a + t * (b - a));
        match key {
            "normal_map" => {
                let slope = self.height * n as f32 / self.cells as f32;
                normals_of("a pattern of heights", [n, n], slope, at)
            }
            "metallic_roughness_map" => of("a pattern of metal", &|t| {
                let ends = [self.roughness, self.metallic];
                let [roughness, metallic] = ends.map(|ends| between(ends, t));
                [255, roughness, metallic, 255]
            }),
            "occlusion_map" => of("a pattern of occlusion", &|t| {
                let share = between(self.occlusion, t);
                [share, share, share, 255]
            }),
            // The field itself, linear.
            "displacement_map" | "glossiness_map" => of("a pattern of grey", &|t| {
                let grey = byte(t);
                [grey, grey, grey, 255]
            }),
            // Colours in sRGB, with alpha where it is given.
            _ => of("a pattern of colours", &|t| {
                let channel = |k: usize| {
                    let at = |c: &Vec<f32>| c.get(k).copied().unwrap_or(1.0);
                    let [a, b] = [at(&self.colors[0]), at(&self.colors[1])];
                    a + t * (b - a)
                };
                let [r, g, b] = [0, 1, 2].map(|k| byte(srgb::encode(channel(k))));
                [r, g, b, byte(channel(3))]
            }),
        }
    }
}

/// Random numbers of 0 … 1 at the nodes of a grid that repeats after `period` of them.
struct Grid {
    seed: u32,
    channel: u32,
    period: u32,
    /// Of all nodes, or none.
    numbers: Vec<f32>,
}

impl Grid {
    /// By a hash, not by a generator: a node's number must not depend on the order.
    fn number(&self, [x, y]: [u32; 2]) -> f32 {
        pixel_hash(self.seed, self.channel, x, y) as f32 / u32::MAX as f32
    }

    fn at(&self, node: IVec2) -> f32 {
        let node = node.rem_euclid(IVec2::splat(self.period as i32));
        let [x, y] = node.to_array().map(|k| k as u32);
        let known = self.numbers.get((y * self.period + x) as usize);
        known.copied().unwrap_or_else(|| self.number([x, y]))
    }

    fn noise(&self, place: Vec2) -> f32 {
        let node = place.floor();
        let t = place - node;
        let t = t * t * (3.0 - 2.0 * t);
        let node = node.as_ivec2();
        let value = |x, y| self.at(node + IVec2::new(x, y));
        let across = |y| value(0, y) + t.x * (value(1, y) - value(0, y));
        across(0) + t.y * (across(1) - across(0))
    }
}

/// The sum of noises, each twice as fine and half as strong as the one before.
fn octaves(grids: &[Grid], place: Vec2) -> f32 {
    let (mut sum, mut weight, mut total) = (0.0, 1.0, 0.0);
    for (grid, octave) in grids.iter().zip(0..) {
        sum += weight * grid.noise(place * (1 << octave) as f32);
        total += weight;
        weight *= 0.5;
    }
    sum / total
}

/// Distance to the border between the two nearest cells' points, in cells (Worley 1996).
fn border(grids: &[Grid], place: Vec2) -> f32 {
    let cell = place.floor().as_ivec2();
    let around = (-2..=2).flat_map(|y| (-2..=2).map(move |x| IVec2::new(x, y)));
    let mut nearest = [(f32::INFINITY, Vec2::ZERO); 2];
    for offset in around {
        let own = cell + offset;
        let jitter = Vec2::new(grids[0].at(own), grids[1].at(own));
        let point = own.as_vec2() + jitter;
        let distance = (point - place).length_squared();
        if distance < nearest[0].0 {
            nearest = [(distance, point), nearest[0]];
        } else if distance < nearest[1].0 {
            nearest[1] = (distance, point);
        }
    }
    let [(_, a), (_, b)] = nearest;
    let apart = (b - a).normalize_or(Vec2::X);
    ((a + b) * 0.5 - place).dot(apart).abs()
}

fn smoothstep(a: f32, b: f32, x: f32) -> f32 {
    let t = ((x - a) / (b - a).max(1e-6)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

fn byte(x: f32) -> u8 {
    (x * 255.0).round().clamp(0.0, 255.0) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pattern(text: &str) -> Pattern {
        toml::from_str(text).expect("parses")
    }

    /// Fields stay in 0 … 1, use most of it, repeat without a seam (the step over the edge is no larger than the largest inside), and
    /// differ with the seed.
    #[test]
    fn fields_repeat_without_a_seam() {
        for name in ["noise", "cracks", "bands", "letters", "puff"] {
            let p = pattern(&format!("pattern = '{name}'\nsize = 128\nwidth = 0.3"));
            let v = p.values();
            let at = |x: u32, y: u32| v[(y * 128 + x % 128) as usize];
            let ends = |(a, b): (f32, f32), &x: &f32| (a.min(x), b.max(x));
            let (lo, hi) = v.iter().fold((1.0, 0.0), ends);
            assert!(lo >= 0.0 && hi <= 1.0 && hi - lo > 0.5, "{name}: {lo} {hi}");
            let step = |x: u32| {
                let steps = (0..128).map(|y| (at(x + 1, y) - at(x, y)).abs());
                steps.fold(0f32, f32::max)
            };
            let inside = (0..127).map(step).fold(0f32, f32::max);
            assert!(step(127) <= inside, "{name}: {} {inside}", step(127));
            if name != "bands" {
                let other = Pattern {
                    seed: 1,
                    ..p.clone()
                };
                assert_ne!(other.values(), v, "{name}");
            }
        }
    }

    /// Letters leave the edges of their cells free, and a puff the edges of the texture: quads with them show no border.
    #[test]
    fn nothing_reaches_the_edges_of_letters_and_puffs() {
        for name in ["letters", "puff"] {
            let p = pattern(&format!("pattern = '{name}'\ncells = 4\nsize = 128"));
            let v = p.values();
            let edges = (0..128).flat_map(|k| [k, 127 * 128 + k, 128 * k, 128 * k + 127]);
            for i in edges {
                assert_eq!(v[i], 0.0, "{name}: {i}");
            }
            // Neither nearly empty nor nearly full.
            let mean = v.iter().sum::<f32>() / v.len() as f32;
            assert!((0.1..0.5).contains(&mean), "{name}: {mean}");
        }
    }

    #[test]
    fn colours_and_factors_are_those_given() {
        let p = pattern(
            "pattern = 'checker'\ncells = 2\nsize = 4\ncolors = [[0, 0, 0, 0.2], [1, 0.5, 0]]\nroughness = [0.4, 1]\nmetallic = [1, 0]",
        );
        let color = p.texture("color_map");
        assert_eq!(color.texels[0], [0, 0, 0, 51]);
        assert_eq!(color.texels[2], [255, 188, 0, 255]);
        let values = p.texture("metallic_roughness_map");
        assert_eq!(values.texels[0], [255, 102, 255, 255]);
        assert_eq!(values.texels[2], [255, 255, 0, 255]);
        let e = pattern("pattern = 'noise'\nroughness = [0, 2]").check();
        assert!(e.is_err_and(|e| e.contains('2')));
    }
}
