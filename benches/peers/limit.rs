//! The limit that a trainer can be measured against: the 3-10-8-1 network, its gradient and Adam written out by hand,
//! on one thread, sixteen rows side by side so that the compiler turns every loop over rows into vector instructions.
//!
//! Stand-alone: `rustc --edition 2024 -O -C target-cpu=native limit.rs`, then `limit FILE ROWS BATCH EPOCHS`. It prints
//! rows a second and the mean loss of each epoch.

use std::time::Instant;

const LANES: usize = 16;
type Lanes = [f32; LANES];
const A: usize = 3;
const B: usize = 10;
const C: usize = 8;
/// Weights then biases of each layer.
const PARAMETERS: usize = (A + 1) * B + (B + 1) * C + C + 1;
const LAYER2: usize = (A + 1) * B;
const LAYER3: usize = LAYER2 + (B + 1) * C;

/// `W x + b` of one output for all lanes.
#[inline(always)]
fn affine<const N: usize>(weights: &[f32], bias: f32, x: &[Lanes; N]) -> Lanes {
    let mut y = [bias; LANES];
    for (w, x) in weights.iter().zip(x) {
        for lane in 0..LANES {
            y[lane] = w.mul_add(x[lane], y[lane]);
        }
    }
    y
}

#[inline(always)]
fn relu(mut x: Lanes) -> Lanes {
    for v in &mut x {
        *v = v.max(0.0);
    }
    x
}

/// Adds the gradient of sixteen rows, kept apart by lane, and returns their summed squared error. Rows beyond `rows`
/// have weight zero.
#[inline(always)]
fn sixteen(p: &[f32; PARAMETERS], x: &[Lanes; A], target: &Lanes, rows: usize, g: &mut [Lanes; PARAMETERS]) -> f32 {
    let mut h1 = [[0.0; LANES]; B];
    for o in 0..B {
        h1[o] = relu(affine(&p[o * A..(o + 1) * A], p[A * B + o], x));
    }
    let mut h2 = [[0.0; LANES]; C];
    for o in 0..C {
        h2[o] = relu(affine(&p[LAYER2 + o * B..LAYER2 + (o + 1) * B], p[LAYER2 + B * C + o], &h1));
    }
    let y = affine(&p[LAYER3..LAYER3 + C], p[LAYER3 + C], &h2);
    let mut loss = 0.0;
    let mut dy = [0.0; LANES];
    for lane in 0..LANES {
        let weight = if lane < rows { 1.0 } else { 0.0 };
        let d = (y[lane] - target[lane]) * weight;
        loss += d * d;
        dy[lane] = 2.0 * d;
    }
    let mut d2 = [[0.0; LANES]; C];
    for i in 0..C {
        let w = p[LAYER3 + i];
        for lane in 0..LANES {
            g[LAYER3 + i][lane] = dy[lane].mul_add(h2[i][lane], g[LAYER3 + i][lane]);
            d2[i][lane] = if h2[i][lane] > 0.0 { w * dy[lane] } else { 0.0 };
        }
    }
    for lane in 0..LANES {
        g[LAYER3 + C][lane] += dy[lane];
    }
    let mut d1 = [[0.0; LANES]; B];
    for o in 0..C {
        for i in 0..B {
            let w = p[LAYER2 + o * B + i];
            let into = &mut g[LAYER2 + o * B + i];
            for lane in 0..LANES {
                into[lane] = d2[o][lane].mul_add(h1[i][lane], into[lane]);
                d1[i][lane] = w.mul_add(d2[o][lane], d1[i][lane]);
            }
        }
        let into = &mut g[LAYER2 + B * C + o];
        for lane in 0..LANES {
            into[lane] += d2[o][lane];
        }
    }
    for o in 0..B {
        let mut d = d1[o];
        for lane in 0..LANES {
            d[lane] = if h1[o][lane] > 0.0 { d[lane] } else { 0.0 };
        }
        for i in 0..A {
            let into = &mut g[o * A + i];
            for lane in 0..LANES {
                into[lane] = d[lane].mul_add(x[i][lane], into[lane]);
            }
        }
        let into = &mut g[A * B + o];
        for lane in 0..LANES {
            into[lane] += d[lane];
        }
    }
    loss
}

struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [file, rows, batch, epochs] = arguments.as_slice() else {
        return Err("usage: limit FILE ROWS BATCH EPOCHS".into());
    };
    let (n, batch, epochs): (usize, usize, usize) = (rows.parse()?, batch.parse()?, epochs.parse()?);
    let bytes = std::fs::read(file)?;
    let values: Vec<f32> = bytes.as_chunks::<4>().0.iter().map(|b| f32::from_le_bytes(*b)).collect();
    if n == 0 || batch == 0 || values.len() != 4 * n {
        return Err("the file is not four columns of that many rows".into());
    }
    let mut columns: Vec<Vec<f32>> = values.chunks_exact(n).map(<[f32]>::to_vec).collect();
    for column in &mut columns[..A] {
        let mean = column.iter().map(|&v| f64::from(v)).sum::<f64>() / n as f64;
        let variance = column.iter().map(|&v| (f64::from(v) - mean).powi(2)).sum::<f64>() / n as f64;
        for v in column.iter_mut() {
            *v = ((f64::from(*v) - mean) / variance.sqrt().max(1e-30)) as f32;
        }
    }
    let mut random = Random(1);
    let mut p = [0.0f32; PARAMETERS];
    for (i, v) in p.iter_mut().enumerate() {
        let inputs = if i < LAYER2 { A } else if i < LAYER3 { B } else { C };
        *v = ((random.next() >> 40) as f32 / 8_388_608.0 - 1.0) / (inputs as f32).sqrt();
    }
    let (mut m, mut v) = ([0.0f32; PARAMETERS], [0.0f32; PARAMETERS]);
    let (mut power1, mut power2) = (1.0f64, 1.0f64);
    let mut order: Vec<u32> = (0..n as u32).collect();
    let mut shuffled = columns.clone();
    for _ in 0..epochs {
        let begin = Instant::now();
        for i in (1..n).rev() {
            let j = ((u128::from(random.next()) * (i as u128 + 1)) >> 64) as usize;
            order.swap(i, j);
        }
        for (into, column) in shuffled.iter_mut().zip(&columns) {
            for (v, &row) in into.iter_mut().zip(&order) {
                *v = column[row as usize];
            }
        }
        let mut total = 0.0f64;
        let mut first = 0;
        while first < n {
            let end = (first + batch).min(n);
            let mut lanes = [[0.0; LANES]; PARAMETERS];
            let mut at = first;
            while at < end {
                let rows = LANES.min(end - at);
                let mut x = [[0.0; LANES]; A];
                let mut target = [0.0; LANES];
                for (lanes, column) in x.iter_mut().zip(&shuffled) {
                    lanes[..rows].copy_from_slice(&column[at..at + rows]);
                }
                target[..rows].copy_from_slice(&shuffled[A][at..at + rows]);
                total += f64::from(sixteen(&p, &x, &target, rows, &mut lanes));
                at += rows;
            }
            power1 *= 0.9;
            power2 *= 0.999;
            let scale = 1.0 / (end - first) as f32;
            let rate = (1e-4 / (1.0 - power1)) as f32;
            let root = (1.0 / (1.0 - power2).sqrt()) as f32;
            for i in 0..PARAMETERS {
                let g = lanes[i].iter().sum::<f32>() * scale;
                m[i] = 0.9 * m[i] + 0.1 * g;
                v[i] = 0.999 * v[i] + 0.001 * g * g;
                p[i] -= rate * m[i] / (v[i].sqrt() * root + 1e-8);
            }
            first = end;
        }
        println!("{:.0} {:e}", n as f64 / begin.elapsed().as_secs_f64(), total / n as f64);
    }
    Ok(())
}
