//! A 64-bit scan-line A-buffer: the reference of what the GPU peels.
//!
//! Deliberately another algorithm than the GPU's (Carpenter's A-buffer over a scan-line walk rather than passes over
//! the whole frame) and another arithmetic: triangles are clipped in homogeneous coordinates, each is walked row by
//! row between its edges' crossings, and every pixel keeps all of its fragments. There is no sub-pixel grid, so a
//! GPU differs where an edge passes within its snapping distance of a pixel centre; [`stable_pixels`] are
//! all others.

#[derive(Clone, Copy, Debug)]
pub struct Triangle {
    /// Clip-space vertices `(x, y, z, w)`, depth range 0 ≤ z ≤ w.
    pub clip: [[f64; 4]; 3],
    /// Index in the scene's list; ties of depth are broken by it.
    pub id: u32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Linear depth `z` (clip-space w of a perspective camera).
    pub depth: f64,
    /// Window depth 0 … 1.
    pub window_depth: f64,
    pub id: u32,
}

#[derive(Clone, Debug)]
pub struct Frame {
    pub width: usize,
    pub height: usize,
    /// Row-major pixels, each front to back.
    pub pixels: Vec<Vec<Hit>>,
}

/// Rasterises triangles; the sample sits at the pixel centre plus `offset` (in pixels).
///
/// Row 0 is the top of the image. Nothing is culled.
pub fn rasterise(triangles: &[Triangle], width: usize, height: usize, offset: [f64; 2]) -> Frame {
    let mut frame = Frame {
        width,
        height,
        pixels: vec![Vec::new(); width * height],
    };
    for triangle in triangles {
        let polygon = clip_depth(&triangle.clip);
        for i in 1..polygon.len().saturating_sub(1) {
            let corners = [polygon[0], polygon[i], polygon[i + 1]];
            walk(&mut frame, corners, triangle.id, offset);
        }
    }
    for pixel in &mut frame.pixels {
        pixel.sort_by(|a, b| a.depth.total_cmp(&b.depth).then(a.id.cmp(&b.id)));
    }
    frame
}

/// Which pixels see the same triangles when the sample moves by `radius` pixels in any of eight directions: the others lie
/// on an edge for a rasteriser that snaps vertices to a grid no coarser than `radius`.
pub fn stable_pixels(
    triangles: &[Triangle],
    width: usize,
    height: usize,
    radius: f64,
) -> Vec<bool> {
    let centre = rasterise(triangles, width, height, [0.0; 2]);
    let mut stable = vec![true; width * height];
    let ids = |pixel: &[Hit]| {
        let mut ids: Vec<_> = pixel.iter().map(|h| h.id).collect();
        ids.sort_unstable();
        ids
    };
    let steps = [-radius, 0.0, radius];
    for offset in steps.into_iter().flat_map(|x| steps.map(|y| [x, y])) {
        let moved = rasterise(triangles, width, height, offset);
        let pairs = centre.pixels.iter().zip(&moved.pixels);
        for (s, (a, b)) in stable.iter_mut().zip(pairs) {
            *s &= ids(a) == ids(b);
        }
    }
    stable
}

/// Clips a triangle against the near (z ≥ 0) and far (z ≤ w) planes: Sutherland & Hodgman 1974.
fn clip_depth(vertices: &[[f64; 4]; 3]) -> Vec<[f64; 4]> {
    let mut polygon = vertices.to_vec();
    for plane in [|p: &[f64; 4]| p[2], |p: &[f64; 4]| p[3] - p[2]] {
        let mut kept = Vec::with_capacity(polygon.len() + 1);
        for (i, b) in polygon.iter().enumerate() {
            let a = &polygon[(i + polygon.len() - 1) % polygon.len()];
            let (da, db) = (plane(a), plane(b));
            if (da >= 0.0) != (db >= 0.0) {
                let s = da / (da - db);
                kept.push(std::array::from_fn(|k| a[k] + s * (b[k] - a[k])));
            }
            if db >= 0.0 {
                kept.push(*b);
            }
        }
        polygon = kept;
    }
    polygon
}

fn walk(frame: &mut Frame, vertices: [[f64; 4]; 3], id: u32, offset: [f64; 2]) {
    let (w, h) = (frame.width as f64, frame.height as f64);
    // Screen position, then the two quantities that are linear on the screen: 1/w and z/w.
    let p: [[f64; 4]; 3] = vertices.map(|c| {
        [
            (c[0] / c[3] * 0.5 + 0.5) * w,
            (0.5 - c[1] / c[3] * 0.5) * h,
            1.0 / c[3],
            c[2] / c[3],
        ]
    });
    let from_first = |x: f64, y: f64| [x - p[0][0], y - p[0][1]];
    let cross = |u: [f64; 2], v: [f64; 2]| u[0] * v[1] - v[0] * u[1];
    let [u, v] = [p[1], p[2]].map(|p| from_first(p[0], p[1]));
    let area = cross(u, v);
    if area == 0.0 || !area.is_finite() {
        return;
    }
    let top = p.iter().map(|p| p[1]).fold(f64::INFINITY, f64::min);
    let bottom = p.iter().map(|p| p[1]).fold(f64::NEG_INFINITY, f64::max);
    // A row's sample is at y + ½ + offset; a row belongs to [top, bottom), a column to [left, right).
    let first = |edge: f64, off: f64| (edge - 0.5 - off).ceil().max(0.0) as usize;
    for y in first(top, offset[1])..first(bottom, offset[1]).min(frame.height) {
        let sy = y as f64 + 0.5 + offset[1];
        let mut crossings = [0.0; 3];
        let mut count = 0;
        for i in 0..3 {
            let (a, b) = (p[i], p[(i + 1) % 3]);
            if (a[1] <= sy) != (b[1] <= sy) {
                crossings[count] = a[0] + (sy - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
                count += 1;
            }
        }
        if count != 2 {
            continue;
        }
        let [a, b, _] = crossings;
        let (left, right) = (a.min(b), a.max(b));
        for x in first(left, offset[0])..first(right, offset[0]).min(frame.width) {
            let at = from_first(x as f64 + 0.5 + offset[0], sy);
            let (l1, l2) = (cross(at, v) / area, cross(u, at) / area);
            let linear = |k: usize| p[0][k] + l1 * (p[1][k] - p[0][k]) + l2 * (p[2][k] - p[0][k]);
            frame.pixels[y * frame.width + x].push(Hit {
                depth: 1.0 / linear(2),
                window_depth: linear(3),
                id,
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A quad of two triangles that fills the frame at depth `z`, half its size in x.
    fn quad(z: f64, x0: f64, x1: f64, id: u32) -> [Triangle; 2] {
        let v = |x: f64, y: f64| [x * z, y * z, 0.5 * z, z];
        let (a, b, c, d) = (v(x0, -1.0), v(x1, -1.0), v(x1, 1.0), v(x0, 1.0));
        [[a, b, c], [a, c, d]].map(|clip| Triangle { clip, id })
    }

    #[test]
    fn layers_come_sorted_and_half_covers_half() {
        let mut t = quad(5.0, -1.0, 0.0, 1).to_vec();
        t.extend(quad(2.0, -1.0, 1.0, 2));
        let frame = rasterise(&t, 8, 4, [0.0; 2]);
        for (i, p) in frame.pixels.iter().enumerate() {
            let ids: Vec<_> = p.iter().map(|h| h.id).collect();
            assert_eq!(ids, if i % 8 < 4 { vec![2, 1] } else { vec![2] });
        }
    }

    #[test]
    fn near_and_far_cut() {
        // A plane from behind the camera to beyond far; z = 2·(depth − 1), so 0 ≤ z ≤ w keeps 1 ≤ depth ≤ 2.
        let v = |x: f64, depth: f64| [x, depth - 1.5, 2.0 * (depth - 1.0), depth];
        let t = [Triangle {
            clip: [v(-9.0, -1.0), v(9.0, -1.0), v(0.0, 4.0)],
            id: 0,
        }];
        let frame = rasterise(&t, 16, 16, [0.0; 2]);
        let depths: Vec<_> = frame.pixels.iter().flatten().map(|h| h.depth).collect();
        assert!(!depths.is_empty());
        assert!(depths.iter().all(|&d| (1.0..=2.0).contains(&d)));
    }
}
