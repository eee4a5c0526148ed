// The grid of voxels: columns of 8 x 8 pixels, each of SLICES slices of depth; as peelnet_render::methods::avboit.
import package::helpers::range_of_pixel::place_in_frame;
import package::parameters::SLICES;

// Sums of absorbance are whole numbers of this share, so that atomics can add them in any order.
const UNIT: f32 = 0.00048828125;

// Intervals of warped depth that the slices are taken from, and words that hold a bit of each.
const INTERVALS: u32 = 2048u;
const WORDS: u32 = 64u;

// Which intervals have slices: those where something is, and three on either side.
struct Used {
    // Intervals there are: pairs are joined until the slices are enough.
    intervals: u32,
    // A bit of each.
    bits: array<u32, WORDS>,
    // How many are used before those of a word.
    before: array<u32, WORDS>,
}

// How many columns lie side by side, and above one another.
fn columns(size: vec2u) -> vec2u {
    return (size + 7u) / 8u;
}

// Place of a column's first slice.
fn first_slice(column: vec2u, size: vec2u) -> u32 {
    return (column.y * columns(size).x + column.x) * SLICES;
}

// A depth in intervals.
fn interval_of(depth_linear: f32, intervals: u32) -> f32 {
    return min(place_in_frame(depth_linear) * f32(intervals), f32(intervals) - 0.001);
}

// A depth in intervals as one in slices; less than 0 in front of all intervals. `bits` and `before` are those of its word. An interval without a
// slice is where the slice before it ends.
fn place_of(depth: f32, bits: u32, before: u32) -> f32 {
    let bit = 1u << (u32(max(depth, 0.0)) % 32u);
    let slices = f32(before + countOneBits(bits & (bit - 1u))) + select(0.0, fract(depth), (bits & bit) != 0u);
    return select(slices, -1.0, depth < 0.0);
}

fn word_of(depth: f32) -> u32 {
    return u32(max(depth, 0.0)) / 32u;
}
