//! `dfaoit`: up to two fragments exact, the colour of more from a network (Tsopouridis, Vasilakis & Fudos 2024), drawn with the exported
//! text itself. Passes are those of the authors' shaders for portable hardware: two peels, and one pass of sums.

mod expectations;

use crate::methods::{depth_peel::Layers, prelude::*};
use crate::passes::{
    Allocated,
    peeling::{self, Peel as _},
};
use peelnet_core::methods::dfaoit;

pub(super) const METHOD: Method = Method {
    parameters: &[TARGETS],
    learned: true,
    expectations: expectations::METHOD,
    ..Method::own(
        "dfaoit",
        "Tsopouridis et al. 2024: up to two layers exact, the colour of more from a network",
        build,
    )
};

/// Layers that are composited exactly: an even number, so that the last pass over them leaves its key and its colour in the first of
/// two textures.
const FRONT: u32 = dfaoit::FRONT as u32;

#[derive(Debug)]
struct Dfaoit {
    front: Layers,
    /// The pass of sums and the resolve.
    rest: Box<dyn Compositor>,
}

fn build(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    let front = Layers::new(b, &peeling::found_buffer(b)?)?;
    let mut p = Passes::new(b.conditions());
    b.learned_weight()?.wgsl.clone_into(&mut p.network);
    // Sums over the fragments behind the front, over all fragments, and the number of those behind.
    let sums = p.targets([
        Target::half("behind", 4, Blend::Add),
        Target::half("all", 4, Blend::AddTransmit),
        Target::half("count", 1, Blend::Add),
    ]);
    let second_key = p.given("second", Allocated::Texture(front.peel.reached[0].clone()));
    let composited = p.given("front", Allocated::Texture(front.accumulated[0].clone()));
    p.geometry("methods::dfaoit::gather", Needs::COLOR | Needs::TRIANGLE)
        .reads([second_key])
        .writes(sums.iter().copied());
    p.resolve("methods::dfaoit::resolve", [composited])
        .reads(sums);
    let rest = p.build(b)?;
    Ok(Box::new(Dfaoit { front, rest }))
}

impl Compositor for Dfaoit {
    fn draw(&mut self, cx: &mut DrawContext<'_, '_>) -> Result<FrameStats, RenderError> {
        let front = &mut DrawContext {
            recorder: cx.recorder,
            counting: false,
            ..*cx
        };
        self.front.begin(front);
        for layer in 0..FRONT {
            self.front.pass(front, layer);
        }
        let stats = self.rest.draw(cx)?;
        Ok(FrameStats {
            geometry_passes: FRONT + stats.geometry_passes,
            // With what clears the layers before them.
            fullscreen_passes: FRONT + 2 + stats.fullscreen_passes,
            bytes_per_pixel: Layers::BYTES + stats.bytes_per_pixel,
            ..stats
        })
    }
}
