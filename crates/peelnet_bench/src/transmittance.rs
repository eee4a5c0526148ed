//! The fragments of a view's pixels, and what the methods' CPU references make of them: images of methods without passes, and the error of
//! the transmittance that a method's weights stand for, fragment by fragment.
//!
//! The latter is computed in 64 bits, over the fragments of a sample of pixels. It is the method's own error, without that of its targets;
//! only the learned methods' sums are rounded as the method rounds them.

use crate::EvalError;
use peelnet_core::{
    absorbance::DepthWarp, fragment::Fragment, hash::sample_threshold, methods::over,
};
use peelnet_model::Model;
use peelnet_peel::{
    Peel,
    read_back::{FragmentReader, RawTile},
};
use peelnet_render::gpu::Gpu;
use peelnet_render::{Frame, FrameStats, Image, MethodSpec, PixelSample, methods::Pixel};
use peelnet_scene::{Camera, Scene};

/// The share of pixels that is sampled.
pub const SHARE: f64 = 0.02;

/// The fragments of a view's sampled pixels.
pub(crate) struct Stacks {
    /// (linear depth, α), nearest first, pixel by pixel.
    pixels: Vec<Vec<(f32, f32)>>,
    warp: DepthWarp,
}

pub(crate) struct Peeled<'a> {
    scene: &'a Scene,
    reader: FragmentReader,
}

impl<'a> Peeled<'a> {
    /// Uploads a scene; `sampled` where some pixels may be left out.
    pub fn new(
        gpu: &Gpu,
        scene: &'a Scene,
        size: [u32; 2],
        sampled: bool,
    ) -> Result<Self, EvalError> {
        let reader = FragmentReader::new(gpu, scene, size, Peel::SBuffer, sampled, None)
            .map_err(EvalError::at(format!("scene '{}'", scene.name)))?;
        Ok(Self { scene, reader })
    }

    pub fn depth_warp(&self, camera: &Camera) -> DepthWarp {
        self.reader.depth_warp(camera)
    }

    /// Takes the number and the fragments, nearest first, of every pixel of a sample that has any.
    pub fn each_pixel(
        &mut self,
        camera: &Camera,
        sample: PixelSample,
        mut take: impl FnMut(usize, Vec<Fragment>),
    ) -> Result<(), EvalError> {
        self.reader.keep_triangles(true);
        let tile = |tile: &mut RawTile| {
            for (run, pixel) in tile.offsets.windows(2).zip(tile.first_pixel..) {
                let run = run[0] as usize..run[1] as usize;
                let fragment = |i: usize| {
                    let [r, g, b, a] = tile.colors[i];
                    Fragment {
                        triangle: tile.triangles[i],
                        ..Fragment::new(tile.depths[i], a, [r, g, b])
                    }
                };
                if !run.is_empty() {
                    take(pixel as usize, run.map(fragment).collect());
                }
            }
            Ok(())
        };
        let failed = EvalError::at(format!("scene '{}'", self.scene.name));
        let read = self.reader.read_view(camera, sample, None, tile);
        read.map(drop).map_err(failed)
    }

    pub fn stacks(&mut self, view: usize) -> Result<Stacks, EvalError> {
        let sample = PixelSample {
            seed: 0,
            view: view as u32,
            threshold: sample_threshold(SHARE),
        };
        let mut pixels = Vec::new();
        let camera = &self.scene.views[view];
        self.each_pixel(camera, sample, |_, fragments| {
            pixels.push(fragments.iter().map(|f| (f.depth, f.alpha)).collect());
        })?;
        let warp = self.depth_warp(camera);
        Ok(Stacks { pixels, warp })
    }

    /// The image of a method that is composited on the CPU, from all fragments of a view in the order of drawing. `exact` is the
    /// view's exact image: what it holds beside its fragments is `T_∞ C_0`.
    pub fn composite(
        &mut self,
        view: usize,
        method: &MethodSpec,
        exact: &Image,
    ) -> Result<Frame, EvalError> {
        let camera = &self.scene.views[view];
        let warp = self.depth_warp(camera);
        let mut image = exact.clone();
        self.each_pixel(camera, PixelSample::ALL, |pixel, mut fragments| {
            let own = over::composite_f64(&fragments, [0.0; 3]);
            // Triangles are drawn by their numbers.
            fragments.sort_by_key(|f| f.triangle);
            let width = image.width as usize;
            let reference = method.reference(&Pixel {
                fragments: &fragments,
                background: [0.0; 3],
                warp,
                position: [pixel % width, pixel / width].map(|x| x as u32),
                model: None,
            });
            let shown = &mut image.pixels[pixel];
            for (k, x) in reference.unwrap_or_default().into_iter().enumerate() {
                shown[k] = (f64::from(shown[k]) - own[k] + f64::from(x)) as f32;
            }
        })?;
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
