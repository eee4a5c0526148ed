// Blocks of 256 keys, four for each thread of a workgroup.
struct Extent {
    // Keys, and blocks of them.
    count: u32,
    blocks: u32,
    pad: vec2u,
}
