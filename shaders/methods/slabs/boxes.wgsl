// Slabs, pass 1 over boxes: the range of a pixel from where its ray enters a box to where it leaves it, in 8 bits under MAX blending: the
// level of depth counted from the far end, rounded down, and from the near end, rounded up.
import package::helpers::slabs::zeta_of;
import package::scene::box_vertex::BoxFace;

fn level(depth: f32) -> f32 {
    return 127.5 * (zeta_of(depth) + 1.0);
}

@fragment
fn fragment_main(face: BoxFace) -> @location(0) vec2f {
    let ray = face.inside - face.eye;
    // A ray along a side never crosses its planes; any large number says so.
    let along = select(ray, vec3f(1e-20), abs(ray) < vec3f(1e-20));
    let crossed = min(-face.eye / along, (1.0 - face.eye) / along);
    let enters = clamp(max(crossed.x, max(crossed.y, crossed.z)), 0.0, 1.0);
    return vec2f(255.0 - floor(level(enters * face.depth_linear)), ceil(level(face.depth_linear))) / 255.0;
}
