// The view of one frame. Layout checked against peelnet_render's `CameraUniform`.
struct Camera {
    clip_from_world: mat4x4f,
    // World-space position of the eye; w unused.
    eye: vec4f,
    // x, y: frame size in pixels. z: number of lights. w: seed of the pixel sample.
    frame: vec4u,
    // x: view number and y: threshold of the pixel sample.
    sample: vec4u,
    // x: 2^-k with 2^k > far, which maps linear depth to 0..1 without rounding. y, z: the depth warp, 1 / near and
    // 2 / (ln(far) - ln(near)) of the range that transparent objects span. w: far / (far - near), which less the window depth is proportional to 1 / z.
    depth_scale: vec4f,
}

@group(0) @binding(0) var<uniform> camera: Camera;
