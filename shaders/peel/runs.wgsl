// The sorted runs of a tile's pixels, for passes over them that composite each over C_0. Their scissor is the tile.
//
// An invocation goes through at most PIECE fragments. Of a longer run, peel::fold composites all pieces but the last beforehand and leaves
// what it carries in `order`, in place of the first slots of the run, which are used up by then.
import package::parameters::SHORT;
import package::peel::tile::Tile;
import package::scene::camera::Camera;

@group(0) @binding(0) var<uniform> tile: Tile;
@group(0) @binding(1) var<uniform> camera: Camera;
@group(0) @binding(2) var<storage, read> offsets: array<u32>;
@group(0) @binding(3) var<storage, read> fragments: array<vec4f>;
@group(0) @binding(4) var background: texture_2d<f32>;
// Slots in sorted order; without long runs, storage itself is sorted.
@if(long) @group(0) @binding(5) var<storage, read_write> order: array<u32>;

// Fragments that an invocation goes through at most.
const PIECE: u32 = 16384u;

// Fragments of a pixel, front to back.
struct Run {
    begin: u32,
    end: u32,
}

fn run_at(index: u32) -> Run {
    let base = offsets[tile.begin];
    return Run(
        min(offsets[index] - base, tile.capacity),
        min(offsets[index + 1u] - base, tile.capacity),
    );
}

fn run_of(pixel: vec2u) -> Run {
    return run_at(pixel.y * camera.frame_size.x + pixel.x);
}

fn is_in_pieces(run: Run) -> bool {
    return run.end - run.begin > PIECE;
}

// The fragments that peel::fold left.
fn last_piece(run: Run) -> Run {
    @if(long) return Run(run.begin + (max(run.end - run.begin, 1u) - 1u) / PIECE * PIECE, run.end);
    // A frame with longer ones counts as too small, and is drawn again.
    @if(!long) return Run(run.begin, min(run.end, run.begin + SHORT));
}

// Where the i-th fragment lies.
fn slot_at(i: u32) -> u32 {
    @if(long) return order[i];
    @if(!long) return i;
}

@if(long)
fn carry(run: Run, i: u32, value: vec3f) {
    let begin = run.begin + 3u * i;
    order[begin] = bitcast<u32>(value.x);
    order[begin + 1u] = bitcast<u32>(value.y);
    order[begin + 2u] = bitcast<u32>(value.z);
}

@if(long)
fn carried(run: Run, i: u32) -> vec3f {
    let begin = run.begin + 3u * i;
    return bitcast<vec3f>(vec3u(order[begin], order[begin + 1u], order[begin + 2u]));
}
