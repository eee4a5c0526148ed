// Learned methods with anchors: the exported text's resolve. Its composite alone where sums have 32 bits, which do not end at the
// largest half, and where light takes a colour.
// Variants: none | separate_ends | tinted | separate_ends tinted | full_sums | full_sums separate_ends | full_sums tinted | full_sums separate_ends tinted
@if(tinted) import package::helpers::resolve::within;
@if(tinted || full_sums) import package::learned::weight::peelnet_composite;
@if(!tinted && !full_sums) import package::learned::weight::peelnet_resolve;

@group(0) @binding(0) var background: texture_2d<f32>;
@group(0) @binding(1) var sums: texture_2d<f32>;
@group(0) @binding(2) var moments: texture_2d<f32>;
@if(separate_ends)
@group(0) @binding(3) var ends: texture_2d<f32>;
@if(tinted) @group(0) @binding(4) var tinted: texture_2d<f32>;

@fragment
fn fragment_main(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2u(position.xy);
    let found = textureLoad(sums, pixel, 0);
    @if(separate_ends) let exact = textureLoad(ends, pixel, 0);
    let absorbance = textureLoad(moments, pixel, 0).x;
    let behind = textureLoad(background, pixel, 0).rgb;
    @if(tinted) {
        let transmittance = textureLoad(tinted, pixel, 0).rgb;
        let coverage = 1.0 - dot(transmittance, vec3f(1.0 / 3.0));
        @if(separate_ends) return peelnet_composite(within(found), within(exact), coverage, transmittance, behind);
        @else return peelnet_composite(within(found), coverage, transmittance, behind);
    }
    @if(!tinted && full_sums) {
        let transmittance = exp(-absorbance);
        @if(separate_ends) return peelnet_composite(found, exact, 1.0 - transmittance, vec3f(transmittance), behind);
        @else return peelnet_composite(found, 1.0 - transmittance, vec3f(transmittance), behind);
    }
    @if(!tinted && !full_sums && separate_ends) return peelnet_resolve(found, exact, absorbance, behind);
    @if(!tinted && !full_sums && !separate_ends) return peelnet_resolve(found, absorbance, behind);
}
