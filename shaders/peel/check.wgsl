// S-buffer: whether every fragment of a pixel was stored once, and every short run is sorted. Its text shares nothing with the sort's.
// Variants: none | long
import package::peel::faults::Faults;
import package::peel::tile::Tile;
import package::parameters::SHORT;

@group(0) @binding(0) var<uniform> tile: Tile;
@group(0) @binding(1) var<storage, read> offsets: array<u32>;
@group(0) @binding(2) var<storage, read> depths: array<f32>;
@group(0) @binding(3) var<storage, read> triangles: array<u32>;
// Of each pixel, the fragments that are still to be stored.
@group(0) @binding(4) var<storage, read> counts: array<u32>;
@group(0) @binding(5) var<storage, read_write> faults: Faults;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let pixel = tile.begin + id.y * tile.groups * 64u + id.x;
    if pixel >= tile.end {
        return;
    }
    let left = bitcast<i32>(counts[pixel]);
    if left > 0 {
        atomicAdd(&faults.lost, u32(left));
    }
    if left < 0 {
        atomicAdd(&faults.uncounted, u32(-left));
    }
    let base = offsets[tile.begin];
    let begin = min(offsets[pixel] - base, tile.capacity);
    let end = min(offsets[pixel + 1u] - base, tile.capacity);
    var unsorted = 0u;
    // check_long looks at the others.
    if end - begin <= SHORT {
        for (var i = begin + 1u; i < end; i++) {
            let is_sorted = depths[i - 1u] < depths[i] || (depths[i - 1u] == depths[i] && triangles[i - 1u] < triangles[i]);
            unsorted += u32(!is_sorted);
        }
    }
    if unsorted > 0u {
        atomicAdd(&faults.unsorted, unsorted);
    }
    if left != 0 || unsorted > 0u {
        atomicMax(&faults.pixel, pixel + 1u);
    }
}
