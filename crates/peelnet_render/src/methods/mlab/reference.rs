//! `mlab-K`: multi-layer alpha blending (Salvi & Vaidyanathan, "Multi-layer Alpha Blending", I3D 2014). There is no shader: every
//! fragment reads and writes its pixel's nodes in the order of drawing, and WebGPU has no ordered access to pixels.
//!
//! A pixel keeps K nodes, nearest first: depth, premultiplied colour and transmittance. A fragment is inserted by its depth; where
//! there are K + 1 nodes then, the two farthest are merged, and the merged node keeps the nearer one's depth. So the image is exact for
//! up to K fragments, and for fragments drawn in the order of depth, from either end; else it depends on the order of drawing.

use peelnet_core::fragment::Fragment;

/// What is kept of one or several fragments.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Node {
    depth: f32,
    /// Premultiplied.
    color: [f64; 3],
    transmittance: f64,
}

/// Composites fragments in the order in which they are given, that of drawing. `nodes` is at least 1.
pub fn composite(fragments: &[Fragment], background: [f32; 3], nodes: usize) -> [f32; 3] {
    let mut kept: Vec<Node> = Vec::with_capacity(nodes + 1);
    for f in fragments {
        let node = Node {
            depth: f.depth,
            color: f.premultiplied().map(f64::from),
            transmittance: 1.0 - f64::from(f.alpha),
        };
        // Behind nodes of the same depth: those were drawn before.
        let place = kept.partition_point(|n| n.depth <= f.depth);
        kept.insert(place, node);
        if kept.len() > nodes
            && let Some(far) = kept.pop()
            && let Some(near) = kept.last_mut()
        {
            near.color = over(near, far.color);
            near.transmittance *= far.transmittance;
        }
    }
    let behind = background.map(f64::from);
    let color = kept.iter().rev().fold(behind, |c, node| over(node, c));
    color.map(|c| c as f32)
}

/// A node over what is behind it.
fn over(node: &Node, behind: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| node.color[k] + node.transmittance * behind[k])
}

#[cfg(test)]
mod tests {
    use super::*;
    use peelnet_core::methods::over;

    const C0: [f32; 3] = [0.1, 0.2, 0.9];

    /// Front to back.
    fn layers(n: usize) -> Vec<Fragment> {
        (0..n)
            .map(|i| {
                let t = i as f32 / n as f32;
                let color = [t, 1.0 - t, (7.0 * t).fract()];
                Fragment {
                    triangle: i as u32,
                    ..Fragment::new(1.0 + i as f32, 0.3, color)
                }
            })
            .collect()
    }

    /// Compositing in 32 bits differs by ten roundings of values ≤ 1 for each layer.
    fn assert_exact(drawn: &[Fragment], nodes: usize) {
        let (found, exact) = (composite(drawn, C0, nodes), over::composite(drawn, C0));
        for k in 0..3 {
            let error = (found[k] - exact[k]).abs();
            assert!(error < 1e-6, "{found:?} {exact:?}");
        }
    }

    /// Sorted drawing is exact with a single node, from the front and from the back.
    #[test]
    fn sorted_drawing_is_exact() {
        let mut f = layers(20);
        for nodes in [1, 2, 4] {
            assert_exact(&f, nodes);
            f.reverse();
            assert_exact(&f, nodes);
        }
    }

    /// Two nodes, drawn at depths 1, 4, 3, 2. The third is inserted between, and merged in front of the one at 4: exact so far. The
    /// last belongs in front of that, and finds it merged: exact as well. Drawn 1, 2, 4, 3 the layer at 3 comes to lie behind the merged node of 2 and 4.
    #[test]
    fn a_layer_between_merged_ones_comes_behind_them() {
        let f = layers(4);
        assert_exact(&[f[0], f[3], f[2], f[1]], 2);
        let wrong = [f[0], f[1], f[3], f[2]];
        let found = composite(&wrong, C0, 2);
        // What is computed is the list with the last two in the order of drawing.
        let mut swapped = f.clone();
        (swapped[2].depth, swapped[3].depth) = (f[3].depth, f[2].depth);
        let want = over::composite(&swapped, C0);
        let exact = over::composite(&f, C0);
        assert!((0..3).all(|k| (found[k] - want[k]).abs() < 1e-6));
        assert!((0..3).any(|k| (found[k] - exact[k]).abs() > 1e-2));
    }
}
