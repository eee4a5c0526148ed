// How a stored colour and its alpha lie in memory: 16, 8 or 4 bytes.
@if(!half_colors && !byte_colors) alias Stored = vec4f;
@if(half_colors) alias Stored = vec2u;
@if(byte_colors) alias Stored = u32;

// `color` is premultiplied. Bytes hold its square root, which spends them on dark colours; light beyond 1 is cut off there.
fn stored(color: vec4f) -> Stored {
    @if(half_colors) return vec2u(pack2x16float(color.rg), pack2x16float(color.ba));
    @if(byte_colors) {
        // pack4x8unorm may round halves either way.
        let bytes = vec4u(clamp(vec4f(sqrt(max(color.rgb, vec3f(0.0))), color.a), vec4f(0.0), vec4f(1.0)) * 255.0 + 0.5);
        return bytes.x | (bytes.y << 8u) | (bytes.z << 16u) | (bytes.w << 24u);
    }
    @if(!half_colors && !byte_colors) return color;
}

fn restored(color: Stored) -> vec4f {
    @if(half_colors) return vec4f(unpack2x16float(color.x), unpack2x16float(color.y));
    @if(byte_colors) {
        let roots = unpack4x8unorm(color);
        return vec4f(roots.rgb * roots.rgb, roots.a);
    }
    @if(!half_colors && !byte_colors) return color;
}
