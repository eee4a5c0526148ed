// S-buffer: sorts each pixel's run of at most SHORT fragments by (linear depth, triangle), one thread a pixel. Longer ones: long_runs.
//
// Shell sort (Shell 1959, gaps of Ciura 2001): in place, no recursion, insertion sort for the short runs that
// almost all pixels have. Depths are positive, so comparing their bits compares them.
// Variants: none | tinted | long | tinted long
import package::parameters::SHORT;
import package::peel::tile::Tile;

@group(0) @binding(0) var<uniform> tile: Tile;
@group(0) @binding(1) var<storage, read> offsets: array<u32>;
@group(0) @binding(2) var<storage, read_write> depths: array<f32>;
@group(0) @binding(3) var<storage, read_write> triangles: array<u32>;
@group(0) @binding(4) var<storage, read_write> colors: array<vec4f>;
// Slots in sorted order: a short run's own, once it is sorted in place.
@if(long) @group(0) @binding(5) var<storage, read_write> order: array<u32>;

// Colours of a fragment.
@if(!tinted) const COLORS: u32 = 1u;
@if(tinted) const COLORS: u32 = 2u;

fn next_gap(gap: u32) -> u32 {
    if gap > 132u { return 132u; }
    if gap > 57u { return 57u; }
    if gap > 23u { return 23u; }
    if gap > 10u { return 10u; }
    if gap > 4u { return 4u; }
    if gap > 1u { return 1u; }
    return 0u;
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let pixel = tile.begin + id.y * tile.groups * 64u + id.x;
    if pixel >= tile.end {
        return;
    }
    let base = offsets[tile.begin];
    let begin = min(offsets[pixel] - base, tile.capacity);
    let end = min(offsets[pixel + 1u] - base, tile.capacity);
    if end - begin > SHORT {
        return;
    }
    @if(long) {
        for (var i = begin; i < end; i++) {
            order[i] = i;
        }
    }
    var gap = next_gap(max(end - begin, 1u));
    // A short run is nearly free by insertion alone.
    if end - begin <= 24u {
        gap = 1u;
    }
    while gap > 0u {
        for (var i = begin + gap; i < end; i++) {
            let depth = depths[i];
            let triangle = triangles[i];
            var j = i;
            while j >= begin + gap {
                let before = depths[j - gap];
                if before < depth || (before == depth && triangles[j - gap] < triangle) {
                    break;
                }
                j -= gap;
            }
            // Only a fragment out of place is moved, with its colour.
            if j != i {
                let color = colors[COLORS * i];
                @if(tinted) let second = colors[COLORS * i + 1u];
                for (var k = i; k > j; k -= gap) {
                    depths[k] = depths[k - gap];
                    triangles[k] = triangles[k - gap];
                    colors[COLORS * k] = colors[COLORS * (k - gap)];
                    @if(tinted) colors[COLORS * k + 1u] = colors[COLORS * (k - gap) + 1u];
                }
                depths[j] = depth;
                triangles[j] = triangle;
                colors[COLORS * j] = color;
                @if(tinted) colors[COLORS * j + 1u] = second;
            }
        }
        gap = next_gap(gap);
    }
}
