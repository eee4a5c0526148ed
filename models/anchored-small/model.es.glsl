// A learned weight for order-independent transparency. Exported by peelnet 0.1.0.
// Licence of this generated text: MIT OR Apache-2.0.
// GLSL ES 3.00, WebGL 2. Paste it below #version 300 es and precision highp float; and precision highp int;.
// Network: 5-8-1 (Relu hidden, Sigmoid last), 57 parameters, 48 multiply-adds. Recipe anchored-small, seed 1, 80 epochs.
// Answers: transmittance of the rest, exp(-rest * share) with rest = root_absorbance^2 and share in 0 .. 1.
// Input 0: root_absorbance (root of the rest's absorbance), 0.0 .. 21.672869 in training.
// Input 1: depth_fraction (of the pixel's depth range), 0.0 .. 1.0 in training.
// Input 2: mean_fraction (of the pixel's depth range), 0.0 .. 1.0 in training.
// Input 3: share_low (of the rest's absorbance), 0.0 .. 1.0 in training.
// Input 4: share_high (of the rest's absorbance), 0.0 .. 1.0 in training.
// Trained on boxes, cups, foliage, intersecting, opaque-mix, panes, sixteen-025, sixteen-050, sixteen-075, sixteen-085, sixteen-random-alpha, sixteen-random-color, smoke-100, smoke-30, synthetic, of a dataset of 21531714 rows (b7ad9cb0d2c09dc1638bcd9266d352a93f8e00bc73cd1e178a68bf55c7773289+ea59181067487e28a3ecbe45990ec58875bfc5212a817cbef25c5c9618a9c370).
// Loss: training 0.000335, validation 0.000332, test 0.000339.
// Held-out error, mean |T - T_exact|: boxes-held 0.01790, cups-held 0.01706, foliage-held 0.00944, panes-held 0.00577, sixteen-held 0.01053, smoke-held 0.01513.
//
// Self-tests, to some roundings of 32 bits; weights and colours also to those of 16-bit targets.
// peelnet_weight(8.434867, 0.014353275, 0.21181071, 0.010463357, 0.22229642) = 0.46031174
// peelnet_weight(3.30784, 0.3421247, 0.95406777, 0.022867262, 0.49329907) = 0.10362228
// peelnet_weight(1.6758143, 0.03032726, 0.24999762, 0.86636156, 0.7144345) = 0.07860307
// Four fragments of a pixel, near 1.0, far 8.0, background 0.25, 0.5, 0.75:
//    z 1.0, alpha 0.5, rgb 1.0, 0.0, 0.0: zeta -1.0, weight 1.0
//    z 2.0, alpha 0.5, rgb 0.0, 1.0, 0.0: zeta -0.33333334, weight 0.49863893
//    z 4.0, alpha 0.5, rgb 0.0, 0.0, 1.0: zeta 0.33333334, weight 0.2631069
//    z 8.0, alpha 0.9, rgb 1.0, 1.0, 1.0: zeta 1.0, weight 0.125
//    colour of the pixel: 0.61200386, 0.36593035, 0.25198558
//
// How to draw with it. Targets may have 32 bits a channel wherever 16 are named.
// 0. zeta = peelnet_zeta(z, near, far): z is the distance along the view axis, near and far the range of z that the bounding boxes of the transparent objects in view span, clipped to the camera's. The tighter the range, the less errs. Compute zeta with this function in all passes. Its range is the same for the whole frame: peelnet_zeta_in(z, peelnet_range(near, far)) is the same value, and the range may be passed in.
// 1. Pass "statistics": draw all transparent surfaces, in any order. PeelnetStatistics s = peelnet_statistics(alpha, zeta);
//    moments: rgba16float, cleared to 0, blending ADD, from s.moments
//    extent: rgba16float, cleared to -65504, -65504, -65504, 0, blending MAX for rgb, ADD for alpha, from s.extent
// 2. Pass "weights": draw all transparent surfaces, in any order. float w = peelnet_fragment(alpha, zeta, moments, extent).x;
//    sums: rgba16float, cleared to 0, blending ADD, from vec4(alpha * rgb, alpha) * w
// 3. Resolve: peelnet_resolve(sums, moments.x, background) is the colour of the pixel, and its coverage in alpha.
// - alpha is opacity, rgb the linear colour that is not multiplied by it. Resolve before tone mapping and encoding.
// - Test depth against the opaque surfaces, do not write it: a depth prepass with transparent surfaces in it hides what lies behind.
// - z grows with distance, also where depth buffers are reversed.
// - With multisampling, gather and resolve the statistics per sample: averaged samples of them mean nothing.

struct PeelnetRange {
    float inverse_near;
    float near;
    float scale;
};
struct PeelnetStatistics {
    vec4 moments;
    vec4 extent;
};
struct PeelnetPlace {
    float end;
    float in_front;
    vec3 taken;
    vec3 zeta;
};
struct PeelnetRest {
    float root_absorbance;
    float place;
    vec4 means;
    float bias;
};
const float PEELNET_FAINT = 0.003921569;
const float PEELNET_TOP = 61439.0;
const vec2 PEELNET_BINS = vec2(240.0, 1920.0);
const vec2 PEELNET_OPACITIES = vec2(256.0, 32.0);
const vec2 PEELNET_OPACITY_STEP = vec2(0.003921569, 0.032258064);
const vec4 PEELNET_MEANS_MAX = vec4(1.0, 65536.0, 65536.0, 65536.0);


PeelnetRange peelnet_range(float near, float far) {
    bool linear = (near <= 0.0);
    float inverse_near = (linear ? 0.0 : (1.0 / max(near, 1.1754944e-38)));
    float extent_3 = (linear ? (far - near) : log(max((far * inverse_near), 1.0)));
    bool flat_ = (extent_3 <= (linear ? 0.0 : 1e-6));
    return PeelnetRange(inverse_near, near, (flat_ ? 0.0 : (2.0 / max(extent_3, 1e-30))));
}

float peelnet_zeta_in(float z, PeelnetRange range) {
    float logarithmic = log(max((z * range.inverse_near), 1.0));
    float from_near = ((range.inverse_near == 0.0) ? (z - range.near) : logarithmic);
    return clamp(((from_near * range.scale) - 1.0), -1.0, 1.0);
}

float peelnet_zeta(float z_1, float near_1, float far_1) {
    PeelnetRange _e3 = peelnet_range(near_1, far_1);
    float _e4 = peelnet_zeta_in(z_1, _e3);
    return _e4;
}

float peelnet_absorbance(float alpha) {
    return -(log(max((1.0 - alpha), 1.1253517e-7)));
}

vec3 peelnet_halves(vec3 levels) {
    vec3 from_middle = (levels - vec3(30719.5));
    return (sign(from_middle) * intBitsToFloat(ivec3(((abs(from_middle) * 8192.0) + vec3(947908600.0)))));
}

vec3 peelnet_levels(vec3 halves) {
    vec3 from_middle_1 = ((vec3(floatBitsToInt(abs(halves))) * 0.00012207031) - vec3(115711.5));
    return (vec3(30719.5) + (sign(halves) * from_middle_1));
}

float peelnet_level(float zeta) {
    return floor(((((zeta * 0.5) + 0.5) * PEELNET_TOP) + 0.5));
}

vec2 peelnet_ends(float b, float zeta_1) {
    vec2 bins = min(floor((((zeta_1 * 0.5) + 0.5) * PEELNET_BINS)), vec2(239.0, 1919.0));
    vec2 opacity = floor((((b / (b + 1.0)) * vec2(270.9375, 32.9375)) + vec2(0.5)));
    return ((vec2((239.0 - bins.x), bins.y) * PEELNET_OPACITIES) + opacity);
}

PeelnetStatistics peelnet_statistics(float alpha_1, float zeta_2) {
    float _e2 = peelnet_absorbance(alpha_1);
    float square = (zeta_2 * zeta_2);
    float _e5 = peelnet_level(zeta_2);
    vec2 _e7 = peelnet_ends(_e2, zeta_2);
    vec3 _e9 = peelnet_halves(vec3((PEELNET_TOP - _e5), _e7));
    return PeelnetStatistics((_e2 * vec4(1.0, zeta_2, square, (square * zeta_2))), vec4(((alpha_1 < PEELNET_FAINT) ? vec3(-65504.0) : _e9), ((_e2 * square) * square)));
}

PeelnetPlace peelnet_place(float alpha_2, float zeta_3, vec4 moments, vec4 extent) {
    bool local = false;
    float _e4 = peelnet_absorbance(alpha_2);
    float _e5 = peelnet_level(zeta_3);
    vec3 _e7 = peelnet_levels(extent.xyz);
    float first = (PEELNET_TOP - _e7.x);
    vec2 ends = _e7.yz;
    vec2 _e12 = peelnet_ends(_e4, zeta_3);
    float at_end = ((_e5 <= (first + 1.0)) ? 1.0 : ((_e12.y == ends.y) ? 2.0 : 0.0));
    float end = ((alpha_2 < PEELNET_FAINT) ? 0.0 : at_end);
    vec2 bins_1 = floor((ends / PEELNET_OPACITIES));
    vec2 share = ((ends - (bins_1 * PEELNET_OPACITIES)) * PEELNET_OPACITY_STEP);
    vec2 known = (share / (vec2(1.0625) - share));
    if ((_e5 > first)) {
        local = (_e12.x != ends.x);
    } else {
        local = false;
    }
    bool _e48 = local;
    float nearest = (_e48 ? known.x : 0.0);
    float farthest = ((_e12.y < ends.y) ? known.y : 0.0);
    float others = max((moments.x - _e4), 0.0);
    return PeelnetPlace(end, ((end == 1.0) ? 0.0 : ((end == 2.0) ? others : nearest)), vec3(_e4, nearest, farthest), vec3(zeta_3, ((first * 3.2552613e-5) - 1.0), (((bins_1.y + 0.5) * 0.0010416667) - 1.0)));
}

PeelnetRest peelnet_rest(PeelnetPlace place, vec4 moments_1, vec4 extent_1) {
    vec3 z_2 = place.zeta;
    vec3 square_1 = (z_2 * z_2);
    vec4 left = (moments_1 - vec4(((place.taken.x + place.taken.y) + place.taken.z), dot(place.taken, z_2), dot(place.taken, square_1), dot(place.taken, (square_1 * z_2))));
    float absorbance_1 = max(left.x, 0.0);
    float inverse_total = (1.0 / max(max(absorbance_1, (moments_1.x * 0.0009765625)), 1e-6));
    vec4 mean = (vec4(left.yzw, (extent_1.w - dot(place.taken, (square_1 * square_1)))) * inverse_total);
    float middle = (0.5 * (z_2.y + z_2.z));
    float scale = (2.0 / max((z_2.z - z_2.y), 3.2552613e-5));
    float scale_square = (scale * scale);
    vec4 means = vec4(((mean.x - middle) * scale), ((mean.y - (middle * ((2.0 * mean.x) - middle))) * scale_square), (((mean.z - (middle * ((3.0 * mean.y) - (middle * ((3.0 * mean.x) - middle))))) * scale) * scale_square), (((mean.w - (middle * ((4.0 * mean.z) - (middle * ((6.0 * mean.y) - (middle * ((4.0 * mean.x) - middle))))))) * scale_square) * scale_square));
    return PeelnetRest(sqrt(absorbance_1), clamp(((z_2.x - middle) * scale), -1.0, 1.0), clamp(means, vec4(-1.0, -65536.0, -65536.0, -65536.0), PEELNET_MEANS_MAX), min((0.0009765625 + ((scale_square * scale_square) * 1.5258789e-5)), 0.25));
}

vec2 peelnet_moment_bounds(PeelnetRest rest) {
    float x = rest.place;
    vec4 m = mix(rest.means, vec4(0.0, 0.375, 0.0, 0.375), rest.bias);
    float variance = (m.y - (m.x * m.x));
    float third = (m.z - (m.x * m.y));
    float d = ((variance * (m.w - (m.y * m.y))) - (third * third));
    float linear_1 = (x - m.x);
    float quadratic = ((((x * x) - m.y) * variance) - (third * linear_1));
    float determinant_ = (variance * d);
    float kc = (quadratic * variance);
    float kb = ((linear_1 * d) - (third * quadratic));
    float ka = ((determinant_ - (m.x * kb)) - (m.y * kc));
    float whole = ((determinant_ + ((linear_1 * linear_1) * d)) + (quadratic * quadratic));
    float own = clamp((determinant_ / ((abs(whole) < 1e-20) ? 1e-20 : whole)), -10000.0, 10000.0);
    float half_ = (0.5 * kb);
    float root = sqrt(max(((half_ * half_) - (ka * kc)), 0.0));
    float inverse_ = (((half_ >= 0.0) ? -1.0 : 1.0) / max((abs(half_) + root), 1e-20));
    float p = (ka * inverse_);
    float q = (kc * inverse_);
    float apart = (1.0 - (p * q));
    float at_p = clamp((((1.0 - own) - (q * (m.x - (own * x)))) / ((apart == 0.0) ? 1e-20 : apart)), -10000.0, 10000.0);
    float at_q = ((1.0 - own) - at_p);
    float low = (((p < x) ? at_p : 0.0) + ((((1.0 - (x * q)) * q) < 0.0) ? at_q : 0.0));
    return clamp(vec2(low, (low + own)), vec2(0.0), vec2(1.0));
}

float peelnet_share(float root_absorbance, float depth_fraction, float mean_fraction, float share_low, float share_high) {
    vec4 input_a = vec4(root_absorbance, depth_fraction, mean_fraction, share_low);
    vec4 input_b = vec4(share_high, 0.0, 0.0, 0.0);
    vec4 layer_a_a = max(((vec4(1.1047144, 1.849467, 3.5545483, 2.0796857) + (mat4x4(vec4(-0.12509356, -0.27134025, 0.075288974, 0.016902275), vec4(-2.9145207, -0.025625823, 6.2353363, 1.2241778), vec4(3.008156, -2.4777772, -8.993284, -1.8112226), vec4(9.307116, -1.7964908, 4.3009157, -8.272783)) * input_a)) + (vec4(-1.2236272, 1.9222177, -10.95059, -3.7833261) * input_b.x)), vec4(0.0));
    vec4 layer_a_b = max(((vec4(1.1297419, 0.39706963, 2.291806, 4.6951375) + (mat4x4(vec4(-0.036108997, 0.009941574, -0.037984435, -0.11034864), vec4(-0.123014845, -9.519223, -1.2102827, -2.6268826), vec4(-1.6250517, 0.17467181, -0.5107002, 3.9925249), vec4(8.911847, -0.42574108, 5.523802, 1.2091862)) * input_a)) + (vec4(-0.8865982, -0.08184909, -10.109496, -4.2235417) * input_b.x)), vec4(0.0));
    float layer_b_a = (1.0 / (1.0 + exp(min(-(((0.04898545 + dot(vec4(1.1670002, 0.15222679, 1.1740011, -1.21545), layer_a_a)) + dot(vec4(-0.70567125, -2.6497583, -1.2541972, -0.7573858), layer_a_b))), 80.0))));
    return layer_b_a;
}

float peelnet_network(PeelnetRest rest_1) {
    vec2 _e1 = peelnet_moment_bounds(rest_1);
    float _e16 = peelnet_share(rest_1.root_absorbance, ((0.5 * rest_1.place) + 0.5), ((0.5 * rest_1.means.x) + 0.5), _e1.x, _e1.y);
    return _e16;
}

vec2 peelnet_fragment(float alpha_3, float zeta_4, vec4 moments_2, vec4 extent_2) {
    vec4 finite_moments = clamp(moments_2, vec4(-65504.0), vec4(65504.0));
    vec4 finite_extent = vec4(extent_2.xyz, min(extent_2.w, 65504.0));
    PeelnetPlace _e14 = peelnet_place(alpha_3, zeta_4, finite_moments, finite_extent);
    PeelnetRest _e15 = peelnet_rest(_e14, finite_moments, finite_extent);
    float _e16 = peelnet_network(_e15);
    float between = ((_e14.end > 0.0) ? 0.0 : ((_e15.root_absorbance * _e15.root_absorbance) * _e16));
    return vec2(exp(-((_e14.in_front + between))), _e14.end);
}

vec4 peelnet_composite(vec4 sums, float coverage, vec3 transmittance, vec3 background) {
    bool local_1 = false;
    if ((sums.w > 0.0)) {
        local_1 = (coverage > 0.0);
    } else {
        local_1 = false;
    }
    bool _e20 = local_1;
    vec3 average = (_e20 ? (sums.xyz / vec3(max(sums.w, 1.1754944e-38))) : vec3(0.0));
    return vec4(((average * coverage) + (background * transmittance)), coverage);
}

vec4 peelnet_resolve(vec4 sums_1, float absorbance, vec3 background_1) {
    float transmittance_1 = exp(-(absorbance));
    vec4 _e11 = peelnet_composite(min(sums_1, vec4(65504.0)), (1.0 - transmittance_1), vec3(transmittance_1), background_1);
    return _e11;
}

float peelnet_weight(float root_absorbance_1, float depth_fraction_1, float mean_fraction_1, float share_low_1, float share_high_1) {
    float root_1 = clamp(root_absorbance_1, 0.0, 256.0);
    float _e23 = peelnet_share(clamp(root_absorbance_1, -47025.832, 47039.44), clamp(depth_fraction_1, -2908.215, 2909.2307), clamp(mean_fraction_1, -1233.0591, 1234.0698), clamp(share_low_1, -2971.1763, 2971.7954), clamp(share_high_1, -2989.8162, 2991.2053));
    return exp(((-(root_1) * root_1) * _e23));
}
