// One pass, before it: the exported text's bins of depth and nearest fragment of one pixel in 64, without shading.
// Variants: tiles
import package::helpers::slabs::zeta_of;
import package::learned::weight::{peelnet_tile_bins, peelnet_tile_nearest};
import package::scene::shade::opacity;
import package::scene::surface::Surface;
import package::scene::visible::visible;

struct Tile {
    @location(0) a: vec4f,
    @location(1) b: vec4f,
    @location(2) c: vec4f,
    @location(3) d: vec4f,
    @location(4) nearest: f32,
}

@fragment
fn fragment_main(surface: Surface) -> Tile {
    if !visible(surface) {
        discard;
    }
    let alpha = opacity(surface);
    let zeta = zeta_of(surface.depth_linear);
    let bins = peelnet_tile_bins(alpha, zeta);
    return Tile(bins[0], bins[1], bins[2], bins[3], peelnet_tile_nearest(alpha, zeta));
}
