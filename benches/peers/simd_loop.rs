//! What the processor could do: the thesis's network, 3-10-8-1, trained by a loop written for it alone, for the comparison of
//! `train.py`. It takes rows as they come, draws no order, checks nothing and saves nothing.
//!
//! `simd_loop FILE ROWS BATCH EPOCHS`: as `throughput`, on one thread. `train.py` compiles it for the processor at hand.

use std::error::Error;
use std::time::Instant;

/// Rows at a time: a vector of the widest registers.
const LANES: usize = 8;
type Vector = [f32; LANES];

const INPUTS: usize = 3;
const FIRST: usize = 10;
const SECOND: usize = 8;

/// Weights and bias of every neuron, the bias last, and the like for gradients and moments.
#[derive(Clone, Copy)]
struct Parameters<T> {
    first: [[T; INPUTS + 1]; FIRST],
    second: [[T; FIRST + 1]; SECOND],
    third: [T; SECOND + 1],
}

impl<T: Copy> Parameters<T> {
    fn of(value: T) -> Self {
        Self {
            first: [[value; INPUTS + 1]; FIRST],
            second: [[value; FIRST + 1]; SECOND],
            third: [value; SECOND + 1],
        }
    }

    fn all(&self) -> impl Iterator<Item = &T> {
        let hidden = self.first.as_flattened().iter();
        hidden.chain(self.second.as_flattened()).chain(&self.third)
    }

    fn all_mut(&mut self) -> impl Iterator<Item = &mut T> {
        let hidden = self.first.as_flattened_mut().iter_mut();
        hidden
            .chain(self.second.as_flattened_mut())
            .chain(&mut self.third)
    }
}

#[inline(always)]
fn fused(sum: Vector, weight: Vector, value: Vector) -> Vector {
    std::array::from_fn(|k| weight[k].mul_add(value[k], sum[k]))
}

#[inline(always)]
fn neuron<const N: usize, const M: usize>(weights: &[f32; M], inputs: &[Vector; N]) -> Vector {
    let start = [weights[N]; LANES];
    (0..N).fold(start, |sum, i| fused(sum, [weights[i]; LANES], inputs[i]))
}

#[inline(always)]
fn relu(x: Vector) -> Vector {
    x.map(|x| if x > 0.0 { x } else { 0.0 })
}

/// Adds a layer's gradient, and returns that by its inputs.
#[inline(always)]
fn back<const N: usize, const M: usize, const O: usize>(
    gradient: &mut [[Vector; M]; O],
    weights: &[[f32; M]; O],
    inputs: &[Vector; N],
    slopes: &[Vector; O],
) -> [Vector; N] {
    let mut before = [[0.0; LANES]; N];
    for o in 0..O {
        for i in 0..N {
            gradient[o][i] = fused(gradient[o][i], slopes[o], inputs[i]);
            before[i] = fused(before[i], [weights[o][i]; LANES], slopes[o]);
        }
        gradient[o][N] = fused(gradient[o][N], slopes[o], [1.0; LANES]);
    }
    before
}

/// The slopes where the inputs, which a ReLU has made, are above 0.
#[inline(always)]
fn through_relu<const N: usize>(slopes: [Vector; N], values: &[Vector; N]) -> [Vector; N] {
    std::array::from_fn(|i| {
        std::array::from_fn(|k| {
            if values[i][k] > 0.0 {
                slopes[i][k]
            } else {
                0.0
            }
        })
    })
}

/// One step of Adam on a batch, and its loss.
fn step(columns: [&[f32]; 4], state: &mut [Parameters<f32>; 3], t: i32) -> f32 {
    let mut gradient = Parameters::of([0.0; LANES]);
    let mut loss = [0.0; LANES];
    let rows = columns[0].len();
    for start in (0..rows).step_by(LANES) {
        let [x0, x1, x2, target] = columns
            .map(|c| -> Vector { c[start..start + LANES].try_into().expect("a whole vector") });
        let [parameters, ..] = &*state;
        let inputs = [x0, x1, x2];
        let first: [Vector; FIRST] =
            std::array::from_fn(|o| relu(neuron(&parameters.first[o], &inputs)));
        let second: [Vector; SECOND] =
            std::array::from_fn(|o| relu(neuron(&parameters.second[o], &first)));
        let answer = neuron(&parameters.third, &second);
        let error: Vector = std::array::from_fn(|k| answer[k] - target[k]);
        loss = fused(loss, error, error);
        let last = [error.map(|e| 2.0 * e)];
        let slopes = back(
            std::array::from_mut(&mut gradient.third),
            &[parameters.third],
            &second,
            &last,
        );
        let slopes = through_relu(slopes, &second);
        let slopes = back(&mut gradient.second, &parameters.second, &first, &slopes);
        let slopes = through_relu(slopes, &first);
        back(&mut gradient.first, &parameters.first, &inputs, &slopes);
    }
    let [parameters, first, second] = state;
    let (scale, rate) = (1.0 / rows as f32, 1e-4 / (1.0 - 0.9f32.powi(t)));
    let root = 1.0 / (1.0 - 0.999f32.powi(t)).sqrt();
    let moments = first.all_mut().zip(second.all_mut());
    for ((p, (m, v)), g) in parameters.all_mut().zip(moments).zip(gradient.all()) {
        let g = g.iter().sum::<f32>() * scale;
        *m = *m * 0.9 + g * 0.1;
        *v = *v * 0.999 + g * g * 0.001;
        *p -= *m * rate / (v.sqrt() * root + 1e-8);
    }
    loss.iter().sum()
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [file, rows, batch, epochs] = arguments.as_slice() else {
        return Err("usage: simd_loop FILE ROWS BATCH EPOCHS".into());
    };
    let [rows, batch, epochs]: [usize; 3] = [rows.parse()?, batch.parse()?, epochs.parse()?];
    let bytes = std::fs::read(file)?;
    let values = bytes
        .as_chunks::<4>()
        .0
        .iter()
        .map(|b| f32::from_le_bytes(*b));
    let mut values: Vec<f32> = values.collect();
    if rows == 0
        || batch == 0
        || values.len() != 4 * rows
        || !rows.is_multiple_of(batch)
        || !batch.is_multiple_of(LANES)
    {
        return Err("rows must be a multiple of the batch, and the batch of 8".into());
    }
    for column in values.chunks_exact_mut(rows).take(INPUTS) {
        let mean = column.iter().sum::<f32>() / rows as f32;
        let squares = column.iter().map(|v| (v - mean) * (v - mean)).sum::<f32>();
        let deviation = (squares / rows as f32).sqrt();
        column.iter_mut().for_each(|v| *v = (*v - mean) / deviation);
    }
    let mut state = [Parameters::of(0.0); 3];
    // Any numbers that differ: Weyl's sequence.
    for (k, weight) in (1u16..).zip(state[0].all_mut()) {
        *weight = (f32::from(k) * 0.618_034).fract() * 0.8 - 0.4;
    }
    let mut t = 0;
    for _ in 0..epochs {
        let begin = Instant::now();
        let mut loss = 0.0;
        for start in (0..rows).step_by(batch) {
            let mut columns = values.chunks_exact(rows).map(|c| &c[start..start + batch]);
            let columns = std::array::from_fn(|_| columns.next().expect("four columns"));
            t += 1;
            loss += f64::from(step(columns, &mut state, t));
        }
        let seconds = begin.elapsed().as_secs_f64();
        println!("{:.0} {:e}", rows as f64 / seconds, loss / rows as f64);
    }
    Ok(())
}
