//! UVs of generated shapes: u once around, v from the top down along the profile.

use glam::Vec2;

/// How a surface is unwrapped.
pub(super) enum Unwrap {
    /// A surface of revolution: its profile, and segments around.
    Revolved(Vec<(f32, f32)>, usize),
    /// A torus: segments around the tube.
    Torus(usize),
    /// Rectangles of four vertices, each with all of the texture.
    Faces,
    /// A UV for each vertex.
    Vertices(Vec<Vec2>),
}

impl Unwrap {
    /// UVs of each triangle's vertices.
    pub fn uvs(&self, triangles: &[[u32; 3]]) -> Vec<[Vec2; 3]> {
        match self {
            Self::Vertices(uvs) => triangles
                .iter()
                .map(|t| t.map(|i| uvs[i as usize]))
                .collect(),
            Self::Faces => triangles
                .iter()
                .map(|t| {
                    let uvs = [Vec2::new(0.0, 1.0), Vec2::ONE, Vec2::X, Vec2::ZERO];
                    t.map(|i| uvs[i as usize % 4])
                })
                .collect(),
            Self::Torus(around) => {
                let (n, along) = (*around, triangles.len() / 2 / around);
                let uv = |i: u32| {
                    let (i, j) = (i as usize / n, i as usize % n);
                    Vec2::new(i as f32 / along as f32, 1.0 - j as f32 / n as f32)
                };
                triangles.iter().map(|t| unseamed(t.map(uv))).collect()
            }
            Self::Revolved(profile, segments) => {
                // v goes with the length of the profile.
                let mut down = vec![0.0];
                for w in profile.windows(2) {
                    let step = (w[1].0 - w[0].0).hypot(w[1].1 - w[0].1);
                    down.push(down[down.len() - 1] + step);
                }
                let total = down[down.len() - 1];
                let poles = [0, (1 + (profile.len() - 2) * segments) as u32];
                let uv = |i: u32| {
                    if i == poles[0] {
                        return Vec2::new(0.0, 1.0);
                    } else if i == poles[1] {
                        return Vec2::ZERO;
                    }
                    let (ring, s) = ((i as usize - 1) / segments, (i as usize - 1) % segments);
                    Vec2::new(s as f32 / *segments as f32, 1.0 - down[ring + 1] / total)
                };
                let of = |t: &[u32; 3]| {
                    let Some(pole) = t.iter().position(|i| poles.contains(i)) else {
                        return unseamed(t.map(uv));
                    };
                    // A pole's u lies in the middle of its triangle.
                    let mut all = t.map(uv);
                    all[pole].x = all[(pole + 1) % 3].x;
                    all = unseamed(all);
                    all[pole].x = (all[(pole + 1) % 3].x + all[(pole + 2) % 3].x) / 2.0;
                    all
                };
                triangles.iter().map(of).collect()
            }
        }
    }
}

/// A triangle over the seam, where u or v jumps from 1 to 0, continues beyond 1.
fn unseamed(mut uvs: [Vec2; 3]) -> [Vec2; 3] {
    for axis in 0..2 {
        let most = uvs.iter().map(|c| c[axis]).fold(0.0, f32::max);
        for c in &mut uvs {
            if most - c[axis] > 0.5 {
                c[axis] += 1.0;
            }
        }
    }
    uvs
}
