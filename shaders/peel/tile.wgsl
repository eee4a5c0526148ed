// The run of pixels (row-major) whose fragments are in storage at one time.
struct Tile {
    // First pixel and one past the last.
    begin: u32,
    end: u32,
    // Fragments that storage holds.
    capacity: u32,
    // Groups along x of a dispatch over the tile's pixels.
    groups: u32,
}
