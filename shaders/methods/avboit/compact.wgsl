// avboit, between its passes: the intervals that have slices. By one thread: it is little.
// Loops: 5: constants.
import package::methods::avboit::grid::{INTERVALS, Used, WORDS};
import package::parameters::SLICES;

@group(0) @binding(0) var<uniform> frame: vec4u;
@group(0) @binding(1) var<storage, read> occupied: array<u32, WORDS>;
@group(0) @binding(2) var<storage, read_write> used: Used;

// The sixteen pairs of a word, joined.
fn joined(word: u32) -> u32 {
    var x = (word | (word >> 1u)) & 0x55555555u;
    x = (x | (x >> 1u)) & 0x33333333u;
    x = (x | (x >> 2u)) & 0x0f0f0f0fu;
    x = (x | (x >> 4u)) & 0x00ff00ffu;
    return (x | (x >> 8u)) & 0xffffu;
}

@compute @workgroup_size(64)
fn main(@builtin(local_invocation_index) lane: u32) {
    if lane > 0u {
        return;
    }
    var bits: array<u32, WORDS>;
    for (var k = 0u; k < WORDS; k++) {
        bits[k] = occupied[k];
    }
    for (var intervals = INTERVALS; intervals >= 32u; intervals /= 2u) {
        let words = intervals / 32u;
        var slices = 0u;
        for (var k = 0u; k < words; k++) {
            // Three on either side: what is found in one pixel of 64 lies beside it in others, and a fragment looks up from two in front.
            let own = bits[k];
            let before = select(0u, bits[max(k, 1u) - 1u], k > 0u);
            let after = select(0u, bits[min(k + 1u, WORDS - 1u)], k + 1u < words);
            var wide = own;
            for (var n = 1u; n <= 3u; n++) {
                wide |= (own << n) | (own >> n) | (before >> (32u - n)) | (after << (32u - n));
            }
            used.bits[k] = wide;
            used.before[k] = slices;
            slices += countOneBits(wide);
        }
        used.intervals = intervals;
        // One more ends the last.
        if slices < SLICES {
            return;
        }
        for (var k = 0u; k < words / 2u; k++) {
            bits[k] = joined(bits[2u * k]) | (joined(bits[2u * k + 1u]) << 16u);
        }
    }
}
