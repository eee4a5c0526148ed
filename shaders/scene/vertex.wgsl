// The only vertex shader of surfaces: every pass shares it, so that depth comes out bit-identical in all of them.
// Variants: none | splat splat_color | splat splat_color display
import package::scene::camera::camera;
@if(material) import package::scene::material::materials;
@if(splat_color) import package::scene::splat::splat_color;
@if(splat) import package::scene::splat::{splat_corner, splats};
import package::scene::surface::Surface;

struct Vertex {
    @location(0) position: vec3f,
    @if(material) @location(1) material: u32,
    @if(mapped) @location(2) uv: vec2f,
    @if(normal_map) @location(3) tangent: vec4f,
    @if(vertex_colors) @location(4) color: vec4f,
    @if(lit) @location(5) normal: vec3f,
    // Its number.
    @if(splat) @location(6) splat: u32,
}

@vertex
fn vertex_main(vertex: Vertex, @if(numbered || splat) @builtin(vertex_index) index: u32) -> Surface {
    var out: Surface;
    @if(splat) {
        let splat = splats[vertex.splat];
        let corner = splat_corner(splat, vertex.position, index % 3u);
        out.position = corner.position;
        out.gaussian = corner.gaussian * corner.position.w;
        out.splat = vec4f(1.0, 1.0, 1.0, corner.opacity);
        @if(splat_color) out.splat = vec4f(splat_color(splat, vertex.position), corner.opacity);
    }
    @else {
        out.position = camera.clip_from_world * vec4f(vertex.position, 1.0);
    }
    @if(lit) {
        out.world = vertex.position;
        out.normal = vertex.normal;
    }
    @if(mapped) out.uv = vertex.uv;
    @if(normal_map) out.tangent = vertex.tangent;
    @if(vertex_colors) out.color = vertex.color;
    // A perspective projection puts the distance along the view axis into w.
    out.depth_linear = out.position.w;
    @if(numbered) out.triangle = index / 3u;
    @if(material) out.material = vertex.material;
    @if(material) let material = materials[vertex.material];
    @if(material) out.material_color = material.color;
    @if(lit) out.finish = vec2f(material.specular_or_metallic, material.shininess_or_roughness);
    return out;
}
