// linked-list: sorts each pixel's list by (linear depth, triangle) and composites it front to back over C_0.
// Loops: 5: LONGEST nodes, and log2 of that.
// Variants: none | tinted | half_colors | byte_colors | tinted half_colors
import package::helpers::stored::{Stored, restored};
import package::scene::camera::Camera;

@group(0) @binding(0) var background: texture_2d<f32>;
@group(0) @binding(1) var<uniform> camera: Camera;
@group(0) @binding(2) var<storage, read> heads: array<u32>;
@group(0) @binding(3) var<storage, read> depths: array<f32>;
@group(0) @binding(4) var<storage, read> triangles: array<u32>;
@group(0) @binding(5) var<storage, read> colors: array<Stored>;
@group(0) @binding(6) var<storage, read_write> next: array<u32>;
@group(0) @binding(7) var<storage, read_write> found: Found;

// What is found of a frame's lists. The first word is the number of nodes used, which `build` counts.
struct Found {
    used: u32,
    // Lists of more than LONGEST nodes: the frame is drawn again from the S-buffer.
    too_long: atomic<u32>,
    // Nodes that were composited: as many as were used.
    composited: atomic<u32>,
    // Nodes that do not come before the next one.
    unsorted: atomic<u32>,
    // The last pixel where a node is not in order, + 1.
    pixel: atomic<u32>,
}

// Nodes of a list at most: relinking passes each about 2 log2(LONGEST) times.
const LONGEST: u32 = 1024u;

// Whether one node comes before another; nodes are counted from 1.
fn before(a: u32, b: u32) -> bool {
    let near = depths[a - 1u];
    let far = depths[b - 1u];
    return near < far || (near == far && triangles[a - 1u] < triangles[b - 1u]);
}

// Merge sort from the bottom up by relinking: in place, n log n whatever the order. Returns the new first node, 0 of a list that is too long.
fn sorted(first: u32) -> u32 {
    var list = first;
    for (var width = 1u; width <= LONGEST; width *= 2u) {
        var rest = list;
        var tail = 0u;
        var merges = 0u;
        list = 0u;
        while rest != 0u {
            merges++;
            if merges * 2u * width > LONGEST {
                atomicAdd(&found.too_long, 1u);
                return 0u;
            }
            // Runs of `width` nodes: one from `left`, the next from `right`.
            var left = rest;
            var right = rest;
            var left_count = 0u;
            for (; left_count < width && right != 0u; left_count++) {
                right = next[right - 1u];
            }
            var right_count = width;
            while left_count > 0u || (right_count > 0u && right != 0u) {
                let right_empty = right_count == 0u || right == 0u;
                var node = right;
                if left_count > 0u && (right_empty || before(left, right)) {
                    node = left;
                    left = next[left - 1u];
                    left_count--;
                } else {
                    right = next[right - 1u];
                    right_count--;
                }
                if tail == 0u {
                    list = node;
                } else {
                    next[tail - 1u] = node;
                }
                tail = node;
            }
            rest = right;
        }
        if tail != 0u {
            next[tail - 1u] = 0u;
        }
        if merges <= 1u {
            break;
        }
    }
    return list;
}

// Whether a node does not come before the next, in other words than those that sort.
fn is_behind(node: u32, following: u32) -> bool {
    let depth = depths[node - 1u];
    let next_depth = depths[following - 1u];
    return depth > next_depth || (depth == next_depth && triangles[node - 1u] >= triangles[following - 1u]);
}

@fragment
fn fragment_main(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2u(position.xy);
    let index = pixel.y * camera.frame_size.x + pixel.x;
    var color = vec3f(0.0);
    @if(!tinted) var transmittance = 1.0;
    @if(tinted) var transmittance = vec3f(1.0);
    var node = sorted(heads[index]);
    var composited = 0u;
    var unsorted = 0u;
    while node != 0u && composited < LONGEST {
        @if(!tinted) {
            let fragment = restored(colors[node - 1u]);
            color += transmittance * fragment.rgb;
            transmittance *= 1.0 - fragment.a;
        }
        @if(tinted) {
            color += transmittance * restored(colors[2u * node - 2u]).rgb;
            transmittance *= 1.0 - restored(colors[2u * node - 1u]).rgb;
        }
        composited++;
        let following = next[node - 1u];
        unsorted += u32(following != 0u && is_behind(node, following));
        node = following;
    }
    if composited > 0u {
        atomicAdd(&found.composited, composited);
    }
    if unsorted > 0u {
        atomicAdd(&found.unsorted, unsorted);
        atomicMax(&found.pixel, index + 1u);
    }
    let behind = textureLoad(background, pixel, 0).rgb;
    @if(!tinted) let covered = 1.0 - transmittance;
    @if(tinted) let covered = 1.0 - dot(transmittance, vec3f(1.0 / 3.0));
    return vec4f(color + transmittance * behind, covered);
}
