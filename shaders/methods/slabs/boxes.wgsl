// Slabs, before them, over boxes: the range of a pixel from where its ray enters a box to where it leaves it, in 8 bits under MAX blending.
import package::helpers::quantiles::{range_of, zeta_of};
import package::scene::box_vertex::BoxFace;

@fragment
fn fragment_main(face: BoxFace) -> @location(0) vec2f {
    let ray = face.inside - face.eye;
    // A ray along a side never crosses its planes; any large number says so.
    let along = select(ray, vec3f(1e-20), abs(ray) < vec3f(1e-20));
    let crossed = min(-face.eye / along, (1.0 - face.eye) / along);
    let enters = clamp(max(crossed.x, max(crossed.y, crossed.z)), 0.0, 1.0);
    let nearest = range_of(zeta_of(enters * face.depth_linear));
    let farthest = range_of(zeta_of(face.depth_linear));
    return vec2f(nearest.x, farthest.y);
}
