//! The error of the transmittance that a method's weights stand for, fragment by fragment.
//!
//! It is computed by the methods' CPU twins in 64 bits, over the fragments of a sample of pixels. It is the method's own error,
//! without that of its targets; only the learned methods' sums are rounded as the method rounds them.

use crate::EvalError;
use peelnet_core::{
    absorbance::DepthWarp, fragment::Fragment, hash::sample_threshold, methods::over,
};
use peelnet_gpu::Gpu;
use peelnet_model::Model;
use peelnet_peel::{Peel, harvest::Harvester, rows::RawTile};
use peelnet_render::{Frame, FrameStats, Image, MethodSpec, PixelSample, methods::Pixel};
use peelnet_scene::Scene;

/// The share of pixels that is sampled.
pub const SHARE: f64 = 0.02;

/// The fragments of a view's sampled pixels.
#[derive(Debug)]
pub struct Stacks {
    /// (linear depth, α), nearest first, pixel by pixel.
    pixels: Vec<Vec<(f32, f32)>>,
    warp: DepthWarp,
}

/// A scene made ready for peeling a sample of its views' pixels.
#[derive(Debug)]
pub struct Sample<'a> {
    scene: &'a Scene,
    harvester: Harvester,
}

impl<'a> Sample<'a> {
    /// Uploads a scene.
    ///
    /// # Errors
    /// If it cannot be drawn.
    pub fn new(gpu: &'a Gpu, scene: &'a Scene, size: [u32; 2]) -> Result<Self, EvalError> {
        let harvester = Harvester::new(gpu, scene, size, Peel::SBuffer, true, None)
            .map_err(EvalError::peel(&scene.name))?;
        Ok(Self { scene, harvester })
    }

    /// The fragments of a view's sampled pixels.
    ///
    /// # Errors
    /// If the view cannot be drawn.
    pub fn peel(&mut self, view: usize) -> Result<Stacks, EvalError> {
        let camera = &self.scene.views[view];
        let sample = PixelSample {
            seed: 0,
            view: view as u32,
            threshold: sample_threshold(SHARE),
        };
        let mut pixels = Vec::new();
        let mut take = |tile: RawTile| {
            for run in tile.offsets.windows(2) {
                let run = run[0] as usize..run[1] as usize;
                if !run.is_empty() {
                    let fragments = tile.depths[run.clone()].iter().zip(&tile.colors[run]);
                    pixels.push(fragments.map(|(&z, color)| (z, color[3])).collect());
                }
            }
            Ok(())
        };
        self.harvester
            .harvest(camera, sample, None, RawTile::default, &mut take)
            .map_err(EvalError::peel(&self.scene.name))?;
        Ok(Stacks {
            pixels,
            warp: self.harvester.depth_warp(camera),
        })
    }
}

impl Sample<'_> {
    /// The image of a method that is composited on the CPU, from all fragments of a view in the order of drawing. `exact` is the
    /// view's exact image: what it holds beside its fragments is `T_∞ C_0`.
    ///
    /// # Errors
    /// If the view cannot be drawn.
    pub fn composite(
        &mut self,
        view: usize,
        method: &MethodSpec,
        exact: &Image,
    ) -> Result<Frame, EvalError> {
        let camera = &self.scene.views[view];
        let warp = self.harvester.depth_warp(camera);
        let mut image = exact.clone();
        let mut take = |tile: RawTile| {
            for (run, pixel) in tile.offsets.windows(2).zip(tile.first_pixel..) {
                let run = run[0] as usize..run[1] as usize;
                let mut fragments: Vec<Fragment> = run
                    .map(|i| Fragment {
                        triangle: tile.triangles[i],
                        ..Fragment::new(
                            tile.depths[i],
                            tile.colors[i][3],
                            [tile.colors[i][0], tile.colors[i][1], tile.colors[i][2]],
                        )
                    })
                    .collect();
                let own = over::composite_f64(&fragments, [0.0; 3]);
                // Triangles are drawn by their numbers.
                fragments.sort_by_key(|f| f.triangle);
                let position = [pixel % image.width, pixel / image.width];
                let twin = method.twin(&Pixel {
                    fragments: &fragments,
                    background: [0.0; 3],
                    warp,
                    position,
                    model: None,
                });
                let shown = &mut image.pixels[pixel as usize];
                for (k, twin) in twin.unwrap_or_default().into_iter().enumerate() {
                    shown[k] = (f64::from(shown[k]) - own[k] + f64::from(twin)) as f32;
                }
            }
            Ok(())
        };
        self.harvester.keep_triangles(true);
        let harvested =
            self.harvester
                .harvest(camera, PixelSample::ALL, None, RawTile::default, &mut take);
        self.harvester.keep_triangles(false);
        harvested.map_err(EvalError::peel(&self.scene.name))?;
        Ok(Frame {
            image,
            times: Vec::new(),
            stats: FrameStats::default(),
            wall_micros: 0.0,
        })
    }
}

impl Stacks {
    /// Mean `|T̂_i − T_i|` over all fragments; `None` for a method whose weights are no transmittance, and of no fragment.
    pub fn error(&self, method: &MethodSpec, model: Option<&Model>) -> Option<f64> {
        let (mut sum, mut n) = (0.0, 0u64);
        for points in &self.pixels {
            let estimates = method.transmittances(points, &self.warp, model)?;
            let mut exact = 1.0;
            for (estimate, &(_, alpha)) in estimates.iter().zip(points) {
                sum += (estimate - exact).abs();
                exact *= 1.0 - f64::from(alpha);
                n += 1;
            }
        }
        (n > 0).then(|| sum / n as f64)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failing test may panic")]
    use super::*;

    fn stacks(pixels: &[&[(f32, f32)]]) -> Stacks {
        Stacks {
            pixels: pixels.iter().map(|p| p.to_vec()).collect(),
            warp: DepthWarp::new(1.0, 100.0),
        }
    }

    /// A lone fragment: T is 1, moments with their own share in say e^(−b/4), with it out 1.
    #[test]
    fn of_a_single_fragment() {
        let one = stacks(&[&[(10.0, 0.5)]]);
        let error = |name: &str| one.error(&name.parse().unwrap(), None);
        let quarter = 1.0 - 0.5f64.powf(0.25);
        assert!((error("mboit4").unwrap() - quarter).abs() < 1e-3);
        assert!((error("mboit6").unwrap() - quarter).abs() < 2e-3);
        assert!(error("mboit4:own=out").unwrap() < 1e-9);
        assert!(error("wavelet-3").unwrap() < 1e-9);
        assert!(error("mboit4:overestimation=0").unwrap() < error("mboit4").unwrap());
        assert_eq!(error("wboit-eq9"), None);
        assert_eq!(stacks(&[]).error(&"mboit4".parse().unwrap(), None), None);
    }
}
