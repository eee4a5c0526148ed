// Slabs: the exported text's resolve; its composite alone where light takes a colour. The transmittance of the whole pixel is exp(-total absorbance).
// Variants: none | three | tinted | three tinted
@if(tinted) import package::helpers::resolve::within;
@if(tinted) import package::learned::weight::peelnet_composite;
@if(!tinted) import package::learned::weight::peelnet_resolve;

@group(0) @binding(0) var background: texture_2d<f32>;
@group(0) @binding(1) var sums: texture_2d<f32>;
@group(0) @binding(2) var absorbances: texture_2d<f32>;
@if(tinted) @group(0) @binding(3) var tinted: texture_2d<f32>;

@fragment
fn fragment_main(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2u(position.xy);
    let behind = textureLoad(background, pixel, 0).rgb;
    let found = textureLoad(sums, pixel, 0);
    @if(tinted) {
        let passing = textureLoad(tinted, pixel, 0).rgb;
        let coverage = 1.0 - dot(passing, vec3f(1.0 / 3.0));
        return peelnet_composite(within(found), coverage, passing, behind);
    }
    @else {
        let slabs = textureLoad(absorbances, pixel, 0);
        @if(three) let absorbance = slabs.x + slabs.y + slabs.z;
        @else let absorbance = slabs.x + slabs.y + slabs.z + slabs.w;
        return peelnet_resolve(found, absorbance, behind);
    }
}
