// Where a fragment lies in its pixel.
import package::helpers::range::transparent_range;
import package::learned::weight::{peelnet_cut, peelnet_ends_of, peelnet_zeta_in};
import package::scene::camera::camera;

// A depth on the scale of the frame without the gaps between boxes, -1 .. 1.
fn zeta_of(depth: f32) -> f32 {
    return peelnet_cut(peelnet_zeta_in(depth, transparent_range()), camera.gaps);
}

// Of which no opacities are known, 0 .. 1: what is in front is seen most.
fn in_frame(zeta: f32) -> f32 {
    return sqrt(0.5 * zeta + 0.5);
}

// range: of the pixel, as the pass over boxes left it.
fn in_boxes(zeta: f32, range: vec2f) -> f32 {
    let ends = peelnet_ends_of(range);
    return sqrt(clamp((127.5 * (zeta + 1.0) - ends.x) / (ends.y - ends.x), 0.0, 1.0));
}
