// The range of depths that transparent objects span in this frame, for the functions of exported texts.
import package::learned::weight::PeelnetRange;
import package::scene::camera::camera;

fn transparent_range() -> PeelnetRange {
    return PeelnetRange(camera.warp_inverse_near, camera.warp_near, camera.warp_scale);
}
