// What the one vertex shader hands to every fragment shader. What is always there comes first: gaps between locations cost time.
struct Surface {
    @builtin(position) @invariant position: vec4f,
    // Linear depth: distance along the view axis in scene units. The sort key everywhere.
    @location(0) depth_linear: f32,
    @if(material) @location(1) @interpolate(flat) material: u32,
    // Of the material: linear RGB and alpha.
    @if(material) @location(2) @interpolate(flat) material_color: vec4f,
    // Index in the scene's list of triangles, object by object: the tie rule.
    @if(numbered) @location(3) @interpolate(flat) triangle: u32,
    // Nothing is lit: nobody asks where it is, which way it faces and how it shines.
    @if(lit) @location(4) world: vec3f,
    @if(lit) @location(5) normal: vec3f,
    // Of the material: specular or metallic, and shininess or roughness.
    @if(lit) @location(6) @interpolate(flat) finish: vec2f,
    @if(mapped) @location(7) uv: vec2f,
    // Direction of u; w: which way the second tangent points.
    @if(normal_map) @location(8) tangent: vec4f,
    @if(vertex_colors) @location(9) color: vec4f,
    // From the centre of a splat, in standard deviations, times the depth: linear on the screen once divided by it. Not all rasterisers clip
    // what they should interpolate so.
    @if(splat) @location(10) gaussian: vec2f,
    // Colour of a splat, and its opacity in the middle.
    @if(splat) @location(11) @interpolate(flat) splat: vec4f,
}
