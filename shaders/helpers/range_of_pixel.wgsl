// Where in a range of warped depths a fragment lies, 0 .. 1; as peelnet_render::methods::bins::range.
import package::helpers::absorbance::warped_depth;

// `bounds` holds what methods::bins::bounds keeps of the pixel. A range that is hardly one is one depth.
fn place_in_pixel(depth_linear: f32, bounds: vec2f) -> f32 {
    let extent = bounds.x + bounds.y;
    let place = clamp((warped_depth(depth_linear) + bounds.x) / max(extent, 1e-6), 0.0, 1.0);
    return select(place, 0.0, extent < 1e-6);
}

// In the range that transparent objects span in this frame.
fn place_in_frame(depth_linear: f32) -> f32 {
    return warped_depth(depth_linear) * 0.5 + 0.5;
}
