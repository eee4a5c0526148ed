// PCG's output permutation (Jarzynski & Olano 2020); as peelnet_core::hash.
fn pcg(v: u32) -> u32 {
    let state = v * 747796405u + 2891336453u;
    let word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

fn pixel_hash(seed: u32, view: u32, x: u32, y: u32) -> u32 {
    return pcg(pcg(pcg(pcg(seed) ^ view) ^ x) ^ y);
}
