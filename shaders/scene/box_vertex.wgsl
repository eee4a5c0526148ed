// The faces of boxes whose sides lie along the axes of world space, one instance each.
import package::scene::camera::camera;

// What a fragment shader is given: a point on the far side, and the box.
struct BoxFace {
    @builtin(position) position: vec4f,
    @location(0) world: vec3f,
    // Linear depth of the point.
    @location(1) depth_linear: f32,
    @location(2) @interpolate(flat) low: vec3f,
    @location(3) @interpolate(flat) high: vec3f,
}

@vertex
fn vertex_main(@builtin(vertex_index) index: u32, @location(0) low: vec3f, @location(1) high: vec3f) -> BoxFace {
    // Corners by bits x, y, z; faces counter-clockwise from outside.
    var corners = array<u32, 36>(
        0u, 4u, 6u, 0u, 6u, 2u, 1u, 3u, 7u, 1u, 7u, 5u, 0u, 1u, 5u, 0u, 5u, 4u,
        2u, 6u, 7u, 2u, 7u, 3u, 0u, 2u, 3u, 0u, 3u, 1u, 4u, 5u, 7u, 4u, 7u, 6u,
    );
    let corner = corners[index];
    let upper = vec3f(f32(corner & 1u), f32((corner >> 1u) & 1u), f32(corner >> 2u));
    let world = mix(low, high, upper);
    var out: BoxFace;
    out.position = camera.clip_from_world * vec4f(world, 1.0);
    out.depth_linear = out.position.w;
    // What lies beyond the far plane bounds what lies before it.
    out.position.z = 0.5 * out.position.w;
    out.world = world;
    out.low = low;
    out.high = high;
    return out;
}
