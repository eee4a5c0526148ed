// Learned methods with anchors: eq 6's resolve, or the ends exact and the rest normalised to what they leave.
// Twin of peelnet_core::methods::anchored.
// Variants: none | separate_ends | tinted | separate_ends tinted
import package::helpers::guards::FILL_MAX;
import package::helpers::resolve::{divisor, normalised, normalised_by_channel, within};
import package::helpers::screen::screen_corner;

@group(0) @binding(0) var background: texture_2d<f32>;
@group(0) @binding(1) var between: texture_2d<f32>;
@group(0) @binding(2) var moments: texture_2d<f32>;
@if(separate_ends)
@group(0) @binding(3) var ends: texture_2d<f32>;
@if(tinted && !separate_ends) @group(0) @binding(3) var tinted: texture_2d<f32>;
@if(tinted && separate_ends) @group(0) @binding(4) var tinted: texture_2d<f32>;

@vertex
fn vertex_main(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return screen_corner(index);
}

@fragment
fn fragment_main(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2u(position.xy);
    let sums = textureLoad(between, pixel, 0);
    @if(!tinted) let transmittance = exp(-textureLoad(moments, pixel, 0).x);
    @if(tinted) let transmittance = textureLoad(tinted, pixel, 0).rgb;
    let behind = textureLoad(background, pixel, 0).rgb;
    @if(!separate_ends && !tinted)
    return normalised(sums, transmittance, behind);
    @if(!separate_ends && tinted)
    return normalised_by_channel(sums, transmittance, behind);
    @if(separate_ends) {
        @if(!tinted) let coverage = 1.0 - transmittance;
        @if(tinted) let coverage = 1.0 - dot(transmittance, vec3f(1.0 / 3.0));
        if coverage == 0.0 {
            return vec4f(behind, 0.0);
        }
        let rest = within(sums);
        let exact = within(textureLoad(ends, pixel, 0));
        // The ends never take more than there is, and what lies between no more than it can fill; what is then missing, all fill.
        let own = min(exact.a, coverage);
        let left = min(coverage - own, FILL_MAX * rest.a);
        let fill = coverage / divisor(own + left);
        let shares = fill * vec2f(own / divisor(exact.a), left / divisor(rest.a));
        let color = exact.rgb * shares.x + rest.rgb * shares.y + behind * transmittance;
        return vec4f(color, coverage);
    }
}
