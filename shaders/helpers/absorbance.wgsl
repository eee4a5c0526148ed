// Absorbance and warped depth; twin of peelnet_core::absorbance.
import package::scene::camera::camera;

const ABSORBANCE_MAX: f32 = 16.0;
// The largest f32 below 1: an opaque fragment's absorbance is large, not infinite.
const ALPHA_CEILING: f32 = 0.99999994;

fn absorbance(alpha: f32) -> f32 {
    return min(-log(1.0 - min(alpha, ALPHA_CEILING)), ABSORBANCE_MAX);
}

// Linear depth to -1 .. 1 by its logarithm over the depth range of the frame's transparent objects.
fn warped_depth(depth_linear: f32) -> f32 {
    return clamp((log(depth_linear) - camera.depth_scale.y) * camera.depth_scale.z - 1.0, -1.0, 1.0);
}
