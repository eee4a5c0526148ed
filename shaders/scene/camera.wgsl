// The view of one frame; as peelnet_render's `CameraUniform`.
struct Camera {
    clip_from_world: mat4x4f,
    // World-space position of the eye.
    eye: vec3f,
    light_count: u32,
    // In pixels.
    frame_size: vec2u,
    // The sample of pixels that are kept: its seed, the number of the view, and the largest hash.
    sample_seed: u32,
    sample_view: u32,
    sample_threshold: u32,
    // 2^-k with 2^k > far, which maps linear depth to 0..1 without rounding.
    unit_from_depth: f32,
    // The depth warp: 1 / near, near, and 2 / (ln(far) - ln(near)) of the range that transparent objects span.
    warp_inverse_near: f32,
    warp_near: f32,
    warp_scale: f32,
    // far / (far - near): window depth is this less a multiple of 1 / z.
    window_depth_at_infinity: f32,
    // Ends of two stretches of the depth warp without transparent objects.
    gaps: vec4f,
}

@group(0) @binding(0) var<uniform> camera: Camera;
