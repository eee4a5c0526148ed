// The run of pixels (row-major) whose fragments are in storage at one time.
struct Tile {
    // First pixel and one past the last.
    begin: u32,
    end: u32,
    // Offset of the first pixel's first fragment: subtracted from every offset.
    base: u32,
    // Groups along x of a dispatch over the tile's pixels.
    groups: u32,
}
