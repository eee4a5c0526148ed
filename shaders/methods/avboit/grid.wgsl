// The grid of voxels: columns of CELL x CELL pixels, each of SLICES intervals of warped depth; as peelnet_render::methods::avboit.
import package::parameters::{CELL, SLICES};

// Sums of absorbance are whole numbers of this share, so that atomics can add them in any order.
const UNIT: f32 = 0.00048828125;

// How many columns lie side by side, and above one another.
fn columns(size: vec2u) -> vec2u {
    return (size + CELL - 1u) / CELL;
}

// Place of a column's first slice.
fn first_slice(column: vec2u, size: vec2u) -> u32 {
    return (column.y * columns(size).x + column.x) * SLICES;
}
