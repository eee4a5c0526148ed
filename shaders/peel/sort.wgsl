// S-buffer: sorts each pixel's run of at most SHORT fragments by (linear depth, triangle), one thread a pixel. Longer ones: long_runs.
//
// Shell sort (Shell 1959, gaps of Ciura 2001): in place, no recursion, insertion sort for the few fragments that
// almost all pixels have.
// Loops: 5: SHORT fragments, and the gaps of their sort.
// Variants: none | tinted | long | tinted long
import package::parameters::SHORT;
import package::peel::faults::Faults;
import package::peel::tile::Tile;

@group(0) @binding(0) var<uniform> tile: Tile;
@group(0) @binding(1) var<storage, read> offsets: array<u32>;
@group(0) @binding(2) var<storage, read_write> depths: array<f32>;
@group(0) @binding(3) var<storage, read_write> triangles: array<u32>;
@group(0) @binding(4) var<storage, read_write> colors: array<vec4f>;
// Of each pixel, the fragments that are still to be stored.
@group(0) @binding(5) var<storage, read> counts: array<u32>;
@group(0) @binding(6) var<storage, read_write> faults: Faults;
// Slots in sorted order: a short run's own, once it is sorted in place.
@if(long) @group(0) @binding(7) var<storage, read_write> order: array<u32>;

// Colours of a fragment.
@if(!tinted) const COLORS: u32 = 1u;
@if(tinted) const COLORS: u32 = 2u;

// Fragments that are sorted by insertion alone.
const FEW: u32 = 24u;

fn next_gap(gap: u32) -> u32 {
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
    let is_short = end - begin <= SHORT;
    if is_short {
        sort(begin, end);
    }
    check(pixel, begin, select(begin, end, is_short));
}

fn sort(begin: u32, end: u32) {
    @if(long) {
        for (var i = begin; i < end; i++) {
            order[i] = i;
        }
    }
    var gap = next_gap(max(end - begin, 1u));
    // A short run is nearly free by insertion alone.
    if end - begin <= FEW {
        gap = 1u;
    }
    while gap > 0u {
        for (var i = begin + gap; i < end; i++) {
            let depth = depths[i];
            let previous = depths[i - gap];
            if previous < depth || (previous == depth && triangles[i - gap] < triangles[i]) {
                continue;
            }
            // Only a fragment out of place is moved, with its colour.
            let triangle = triangles[i];
            let color = colors[COLORS * i];
            @if(tinted) let second = colors[COLORS * i + 1u];
            var j = i;
            loop {
                depths[j] = depths[j - gap];
                triangles[j] = triangles[j - gap];
                colors[COLORS * j] = colors[COLORS * (j - gap)];
                @if(tinted) colors[COLORS * j + 1u] = colors[COLORS * (j - gap) + 1u];
                j -= gap;
                if j < begin + gap {
                    break;
                }
                let next = depths[j - gap];
                if next < depth || (next == depth && triangles[j - gap] < triangle) {
                    break;
                }
            }
            depths[j] = depth;
            triangles[j] = triangle;
            colors[COLORS * j] = color;
            @if(tinted) colors[COLORS * j + 1u] = second;
        }
        gap = next_gap(gap);
    }
}

// Counts what is wrong with a run, in other words than those that sort it: whether every fragment that was counted is stored once, and
// comes before the next.
fn check(pixel: u32, begin: u32, end: u32) {
    let left = bitcast<i32>(counts[pixel]);
    var unsorted = 0u;
    if begin < end {
        var nearest = depths[begin];
        for (var i = begin + 1u; i < end; i++) {
            let depth = depths[i];
            if depth <= nearest {
                unsorted += u32(depth < nearest || triangles[i] <= triangles[i - 1u]);
            }
            nearest = depth;
        }
    }
    if left != 0 || unsorted > 0u {
        atomicAdd(&faults.unsorted, unsorted);
        atomicAdd(&faults.lost, u32(max(left, 0)));
        atomicAdd(&faults.uncounted, u32(max(-left, 0)));
        atomicMax(&faults.pixel, pixel + 1u);
    }
}
