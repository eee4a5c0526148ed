// Where a pixel's K places begin, and what they are ordered by.
import package::parameters::K;
import package::scene::camera::camera;
import package::scene::surface::Surface;

fn first_place(surface: Surface) -> u32 {
    let pixel = vec2u(surface.position.xy);
    return (pixel.y * camera.frame_size.x + pixel.x) * K;
}

// Larger for smaller depths: positive floats order as their bits do. Never 0, which stands for no fragment.
fn nearness(surface: Surface) -> u32 {
    return ~bitcast<u32>(surface.depth_linear);
}
