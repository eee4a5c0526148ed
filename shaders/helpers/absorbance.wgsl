// Absorbance and warped depth; as peelnet_core::absorbance.
import package::scene::camera::camera;

// exp(-16): an opaque fragment's absorbance is large, not infinite.
const TRANSMITTANCE_FLOOR: f32 = 1.1253517e-7;

fn absorbance(alpha: f32) -> f32 {
    return -log(max(1.0 - alpha, TRANSMITTANCE_FLOOR));
}

// Linear depth to -1 .. 1 by its logarithm over the depth range of the frame's transparent objects. The logarithm of a
// ratio: the difference of two would depend on the scene's unit by their rounding.
fn warped_depth(depth_linear: f32) -> f32 {
    return clamp(log(depth_linear * camera.warp_inverse_near) * camera.warp_scale - 1.0, -1.0, 1.0);
}
