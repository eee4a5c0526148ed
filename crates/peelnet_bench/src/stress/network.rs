//! Cases that evaluate a network without drawing.

use super::properties::Findings;
use peelnet_core::{random::Random, tolerance::EXPORT_F16};
use peelnet_export::ExportError;
use peelnet_model::Model;
use peelnet_render::gpu::Gpu;
use peelnet_render::{LearnedWeight, Property};

/// Inputs that are drawn at random.
const RANDOM: usize = 16_384;

/// Every operation rounded to 16 bits, against 64 bits. The function need not be exported in 16 bits for that.
pub(super) fn in_half_floats(
    _: &Gpu,
    (_, model): &(LearnedWeight, Model),
    findings: &mut Findings,
) -> Result<(), ExportError> {
    let mut random = Random::new(5, &[]);
    for _ in 0..RANDOM {
        let inputs = || model.meta.inputs.iter();
        let raw: Vec<f32> = inputs().map(|i| random.between(i.min, i.max)).collect();
        let normalised = inputs().zip(&raw).map(|(i, &x)| i.normalise(x));
        let normalised: Vec<f32> = normalised.collect();
        let wide: Vec<f64> = normalised.iter().map(|&x| f64::from(x)).collect();
        let limit = EXPORT_F16 * model.mlp.magnitude(&wide).max(1.0);
        let exact = model.mlp.forward(&wide);
        let place = || format!("inputs {raw:?}");
        for (half, exact) in model.mlp.forward_half(&normalised).iter().zip(exact) {
            findings.forbid(Property::Finite, !half.is_finite(), place);
            let error = (f64::from(*half) - exact).abs();
            findings.note(Property::Half, error, limit, place);
        }
    }
    Ok(())
}

/// Any bits that are a finite number, on the GPU.
pub(super) fn on_hostile_inputs(
    gpu: &Gpu,
    (text, model): &(LearnedWeight, Model),
    findings: &mut Findings,
) -> Result<(), ExportError> {
    let count = model.meta.inputs.len();
    let mut random = Random::new(6, &[]);
    let normal = f32::MIN_POSITIVE;
    let extremes = [
        0.0,
        -0.0,
        1e-45,
        -1e-45,
        normal,
        1e-30,
        -1e-30,
        1e30,
        -1e30,
        f32::MAX,
        f32::MIN,
        1.0,
        -1.0,
    ];
    let mut hostile = || {
        loop {
            let bits = (random.unit() * 16_777_216.0) as u32 | (random.below(256) as u32) << 24;
            let bits = f32::from_bits(bits);
            if random.below(4) == 0 {
                return extremes[random.below(extremes.len())];
            }
            if bits.is_finite() {
                return bits;
            }
        }
    };
    let mut sample = |_| (0..count).map(|_| hostile()).collect();
    let samples: Vec<Vec<f32>> = (0..RANDOM).map(&mut sample).collect();
    let answers = peelnet_export::evaluate(gpu, model, &text.wgsl, &samples)?;
    let answers = answers.chunks_exact(model.meta.output.count());
    for (sample, answer) in samples.iter().zip(answers) {
        // Transmittances and colours: a little more than 1 is a matter of rounding.
        let good = answer.iter().all(|x| (0.0..=1.0 + 1e-5).contains(x));
        findings.forbid(Property::Finite, !good, || {
            format!("inputs {sample:?} give {answer:?}")
        });
    }
    Ok(())
}
