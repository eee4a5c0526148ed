// What the one vertex shader hands to every fragment shader. What is always there comes first: gaps between locations cost time.
struct Surface {
    @builtin(position) @invariant position: vec4f,
    // Linear depth: distance along the view axis in scene units. The sort key everywhere.
    @location(0) depth_linear: f32,
    @location(1) @interpolate(flat) material: u32,
    // Index in the scene's list of triangles, object by object: the tie rule.
    @if(numbered) @location(2) @interpolate(flat) triangle: u32,
    // Nothing is lit: nobody asks where it is and which way it faces.
    @if(lit) @location(3) world: vec3f,
    @if(lit) @location(4) normal: vec3f,
    @if(mapped) @location(5) uv: vec2f,
    // Direction of u; w: which way the second tangent points.
    @if(normal_map) @location(6) tangent: vec4f,
    @if(vertex_colors) @location(7) color: vec4f,
}
