// Runs of more than SHORT fragments, sorted by many threads. What is sorted are numbers of slots: depths, triangles and colours stay
// where they are, and `order` says which slot is the first, the second, … of its run.
//
// A thread works on a *window* of WINDOW slots of storage. A run is cut, from its first slot on, into chunks of as many; a thread owns the
// chunks that begin in its window. Those are two at most: one of the run that holds the window's first slot, and one of the run that
// holds its last, since a run is longer than a window. So no thread loops over more than WINDOW fragments, whatever the scene.
import package::peel::tile::Tile;
import package::parameters::SHORT;

@group(0) @binding(0) var<uniform> tile: Tile;
@group(0) @binding(1) var<storage, read> offsets: array<u32>;
@group(0) @binding(2) var<storage, read> depths: array<f32>;
@group(0) @binding(3) var<storage, read> triangles: array<u32>;
// The two pixels of each window whose runs are long; NO_PIXEL for none.
@group(0) @binding(4) var<storage, read_write> windows: array<vec2u>;

// Slots of a window.
const WINDOW: u32 = 32u;

const NO_PIXEL: u32 = 0xffffffffu;

// Slots of a run, and those of the chunk of it that a thread owns; none where begin = end.
struct Chunk {
    run_begin: u32,
    run_end: u32,
    begin: u32,
    end: u32,
}

fn slot_of(pixel: u32) -> u32 {
    return min(offsets[pixel] - offsets[tile.begin], tile.capacity);
}

fn is_long(pixel: u32) -> bool {
    return slot_of(pixel + 1u) - slot_of(pixel) > SHORT;
}

fn chunk_of(pixel: u32, window: u32) -> Chunk {
    if pixel == NO_PIXEL {
        return Chunk(0u, 0u, 0u, 0u);
    }
    let run_begin = slot_of(pixel);
    let run_end = slot_of(pixel + 1u);
    let first = max(window * WINDOW, run_begin);
    let begin = run_begin + (first - run_begin + WINDOW - 1u) / WINDOW * WINDOW;
    if begin >= min(run_end, window * WINDOW + WINDOW) {
        return Chunk(run_begin, run_end, 0u, 0u);
    }
    return Chunk(run_begin, run_end, begin, min(begin + WINDOW, run_end));
}

// Whether the fragment in one slot comes before that in another: by linear depth, then by triangle. Never both ways.
fn before(a: u32, b: u32) -> bool {
    return depths[a] < depths[b] || (depths[a] == depths[b] && triangles[a] < triangles[b]);
}
