// S-buffer, pass 1: how many fragments each pixel has.
import package::scene::camera::camera;
import package::scene::surface::Surface;
import package::scene::visible::visible;

@group(1) @binding(0) var<storage, read_write> counts: array<atomic<u32>>;

@fragment
fn fragment_main(surface: Surface) {
    if !visible(surface) {
        discard;
    }
    let pixel = vec2u(surface.position.xy);
    atomicAdd(&counts[pixel.y * camera.frame_size.x + pixel.x], 1u);
}
