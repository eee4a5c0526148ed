// Tiles, pass 1: the exported text's bins of depth and nearest fragment of one pixel in 64, without shading.
// Variants: tiles
import package::helpers::quantiles::zeta_of;
import package::learned::weight::{peelnet_tile_bins, peelnet_tile_nearest};
import package::scene::shade::opacity;
import package::scene::surface::Surface;
import package::scene::visible::visible;

struct Tile {
    @location(0) a: vec4f,
    @location(1) b: vec4f,
    @location(2) c: vec4f,
    // In two: four channels of 8 bits count as eight bytes of the 32 that a pass may write, two as two.
    @location(3) d: vec2f,
    @location(4) e: vec2f,
    @location(5) nearest: f32,
}

@fragment
fn fragment_main(surface: Surface) -> Tile {
    if !visible(surface) {
        discard;
    }
    let alpha = opacity(surface);
    let zeta = zeta_of(surface.depth_linear);
    let bins = peelnet_tile_bins(alpha, zeta);
    return Tile(bins[0], bins[1], bins[2], bins[3].xy, bins[3].zw, peelnet_tile_nearest(alpha, zeta));
}
