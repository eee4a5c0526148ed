// The faces of boxes, one instance each: a box is the unit cube, moved to where it stands.
import package::scene::camera::camera;

// What a fragment shader is given: a point on the far side of a box, and the eye, both where the box is the unit cube.
struct BoxFace {
    @builtin(position) position: vec4f,
    @location(0) inside: vec3f,
    // Linear depth of the point.
    @location(1) depth_linear: f32,
    @location(2) @interpolate(flat) eye: vec3f,
}

// Rows from the unit cube to world space, and back.
struct Box {
    @location(0) world_x: vec4f,
    @location(1) world_y: vec4f,
    @location(2) world_z: vec4f,
    @location(3) unit_x: vec4f,
    @location(4) unit_y: vec4f,
    @location(5) unit_z: vec4f,
}

@vertex
fn vertex_main(@builtin(vertex_index) index: u32, box: Box) -> BoxFace {
    // Corners by bits x, y, z; faces counter-clockwise from outside.
    var corners = array<u32, 36>(
        0u, 4u, 6u, 0u, 6u, 2u, 1u, 3u, 7u, 1u, 7u, 5u, 0u, 1u, 5u, 0u, 5u, 4u,
        2u, 6u, 7u, 2u, 7u, 3u, 0u, 2u, 3u, 0u, 3u, 1u, 4u, 5u, 7u, 4u, 7u, 6u,
    );
    let corner = corners[index];
    let inside = vec3f(f32(corner & 1u), f32((corner >> 1u) & 1u), f32(corner >> 2u));
    let unit = vec4f(inside, 1.0);
    let world = vec3f(dot(box.world_x, unit), dot(box.world_y, unit), dot(box.world_z, unit));
    let eye = vec4f(camera.eye, 1.0);
    var out: BoxFace;
    out.position = camera.clip_from_world * vec4f(world, 1.0);
    out.depth_linear = out.position.w;
    // What lies beyond the far plane bounds what lies before it.
    out.position.z = 0.5 * out.position.w;
    out.inside = inside;
    out.eye = vec3f(dot(box.unit_x, eye), dot(box.unit_y, eye), dot(box.unit_z, eye));
    return out;
}
