// A learned weight for order-independent transparency. Exported by peelnet 0.1.0.
// Licence of this generated text: MIT OR Apache-2.0.
// GLSL ES 3.00, WebGL 2. Paste it below #version 300 es and precision highp float; and precision highp int;.
// Network: 9-12-1 (Relu hidden, Sigmoid last), 133 parameters, 120 multiply-adds. Recipe one, seed 1, 40 epochs.
// Answers: transmittance of the rest, exp(-rest * share) with rest = root_absorbance^2 and share in 0 .. 1.
// Input 0: root_absorbance (root of twice the absorbance in front, by the formula), 0.000093077906 .. 15.9079275 in training.
// Input 1: root_total (root of the absorbance of all sums), 0.02891372 .. 21.513378 in training.
// Input 2: share_before (of the absorbance of all sums), 0.0 .. 0.9999994 in training.
// Input 3: share_own (of the absorbance of all sums), 1.7657054e-9 .. 1.0 in training.
// Input 4: share_previous (of the absorbance of all sums), 0.0 .. 0.97727245 in training.
// Input 5: share_next (of the absorbance of all sums), 0.0 .. 0.99999946 in training.
// Input 6: nearest_alpha (1), 0.0007731032 .. 0.99905795 in training.
// Input 7: nearest_place (among the quantiles), 0.00012485312 .. 0.99942017 in training.
// Input 8: number (0 for the first, 1 for the last sum), 0.0 .. 1.0 in training.
// Trained on boxes, cups, foliage, intersecting, opaque-mix, panes, sixteen-025, sixteen-050, sixteen-075, sixteen-085, sixteen-random-alpha, sixteen-random-color, smoke-100, smoke-30, synthetic, of a dataset of 21565798 rows (f0e6c4a7cca08d560f99a5be9cbd1514bf8be352632a347602bf08363695fd29+e22e844788a454658277e87e23685b5ffa00e3ad2d48cb833cc53130eaf4d8b7).
// Loss: training 0.000611, validation 0.000593, test 0.000615.
// Held-out error, mean |T - T_exact|: boxes-held 0.02373, cups-held 0.02206, foliage-held 0.01878, panes-held 0.00820, sixteen-held 0.01624, smoke-held 0.01757.
//
// Self-tests, to some roundings of 32 bits; weights and colours also to those of 16-bit targets.
// peelnet_weight(0.36191413, 14.441937, 0.1688791, 0.7373583, 0.18772307, 0.034303825, 0.12910137, 0.435657, 0.7663156) = 0.8772337
// peelnet_weight(3.9770136, 18.642227, 0.7144341, 0.43257523, 0.14753379, 0.62058616, 0.794909, 0.9875111, 0.36102802) = 0.47685304
// peelnet_weight(1.9873397, 0.5672196, 0.37864107, 0.595821, 0.2760697, 0.3106894, 0.6235468, 0.40476447, 0.91731685) = 0.052649572
// Four fragments of a pixel, near 1.0, far 8.0, background 0.25, 0.5, 0.75:
//    z 1.0, alpha 0.5, rgb 1.0, 0.0, 0.0: zeta -1.0, weight 1.0
//    z 2.0, alpha 0.5, rgb 0.0, 1.0, 0.0: zeta -0.33333334, weight 0.49703375
//    z 4.0, alpha 0.5, rgb 0.0, 0.0, 1.0: zeta 0.33333334, weight 0.2812811
//    z 8.0, alpha 0.9, rgb 1.0, 1.0, 1.0: zeta 1.0, weight 0.108837925
//    colour of the pixel: 0.61373997, 0.352721, 0.24796969
//
// How to draw with it. Targets may have 32 bits a channel wherever 16 are named.
// 0. zeta = peelnet_zeta(z, near, far): z is the distance along the view axis, near and far the range of z that the bounding boxes of the transparent objects in view span, clipped to the camera's. The tighter the range, the less errs. Compute zeta with this function in all passes. Its range is the same for the whole frame: peelnet_zeta_in(z, peelnet_range(near, far)) is the same value, and the range may be passed in. Where boxes show that nothing lies between two depths, use peelnet_cut(zeta, gaps) for zeta in all passes: it leaves up to two such gaps out. quantiles says where among the depths around the pixel most is seen: peelnet_even() where nothing is known but near and far, with several times the error. noise is any number in 0 .. 1 that is the same for all of a pixel, such as peelnet_noise(pixel): it hides the steps of what is kept of the nearest fragment; 0.5 where that does not matter.
//    quantiles: rgba8unorm, a texture of one texel for 8 by 8 pixels, read with linear interpolation; peelnet_even() where it is not drawn.
//    At its size, draw all transparent surfaces, in any order. mat4 bins = peelnet_tile_bins(alpha, zeta);
//    bins_a: rgba8unorm, cleared to 0, blending ADD, from bins[0]
//    bins_b: rgba8unorm, cleared to 0, blending ADD, from bins[1]
//    bins_c: rgba8unorm, cleared to 0, blending ADD, from bins[2]
//    bins_d: rg8unorm, cleared to 0, blending ADD, from bins[3].xy
//    bins_e: rg8unorm, cleared to 0, blending ADD, from bins[3].zw
//    tile_nearest: r16float, cleared to -65504, blending MAX, from peelnet_tile_nearest(alpha, zeta)
//    Then each of its texels is peelnet_quantiles(sum): sum adds, over the 3 by 3 texels around it, peelnet_tile_seen(mat4(bins_a, bins_b, bins_c, vec4(bins_d, bins_e)), tile_nearest).
//    Or make it without that pass from what the last frame kept of the pixel in the middle of each of them, of peelnet_last_seen(sum_a, sum_b, sum_c, absorbances, quantiles, noise), but for the first frame and after jumps of the camera.
// 1. Pass "gather": draw all transparent surfaces, in any order. PeelnetStatistics s = peelnet_statistics(alpha, rgb, zeta, quantiles, noise);
//    sum_a: rgba16float, cleared to 0, 0, 0, -65504, blending ADD for rgb, MAX for alpha, from s.sum_a
//    sum_b: rgba16float, cleared to 0, 0, 0, -65504, blending ADD for rgb, MAX for alpha, from s.sum_b
//    sum_c: rgba16float, cleared to 0, 0, 0, -65504, blending ADD for rgb, MAX for alpha, from s.sum_c
//    absorbances: rgba16float, cleared to 0, 0, 0, -65504, blending ADD for rgb, MAX for alpha, from s.absorbances
// 2. Resolve: peelnet_resolve(sum_a, sum_b, sum_c, absorbances, quantiles, noise, background) is the colour of the pixel, and its coverage in alpha.
// - alpha is opacity, rgb the linear colour that is not multiplied by it. Resolve before tone mapping and encoding.
// - Test depth against the opaque surfaces, do not write it: a depth prepass with transparent surfaces in it hides what lies behind.
// - z grows with distance, also where depth buffers are reversed.
// - With multisampling, gather and resolve the statistics per sample: averaged samples of them mean nothing.

struct PeelnetRange {
    float inverse_near;
    float near;
    float scale;
};
struct PeelnetAhead {
    float absorbance;
    float total;
    float before;
    float own;
    float previous;
    float next;
    float alpha;
    float place;
    float number;
};
struct PeelnetNearest {
    vec3 color;
    float absorbance;
    float place;
    float coverage;
    float alpha;
    float left;
};
struct PeelnetStatistics {
    vec4 sum_a;
    vec4 sum_b;
    vec4 sum_c;
    vec4 absorbances;
};
struct PeelnetRest {
    PeelnetNearest nearest;
    vec4 first;
    vec4 second;
    vec4 third;
};
const float PEELNET_BIN_LEVELS = 64.0;
const float PEELNET_TILE_DEPTHS = 240.0;
const float PEELNET_TILE_OPACITIES = 256.0;
const float PEELNET_DEPTHS = 480.0;
const float PEELNET_VALUES = 128.0;
const float PEELNET_MOST = 0.9411765;


PeelnetRange peelnet_range(float near, float far) {
    bool linear = (near <= 0.0);
    float inverse_near = (linear ? 0.0 : (1.0 / max(near, 1.1754944e-38)));
    float extent = (linear ? (far - near) : log(max((far * inverse_near), 1.0)));
    bool flat_ = (extent <= (linear ? 0.0 : 1e-6));
    return PeelnetRange(inverse_near, near, (flat_ ? 0.0 : (2.0 / max(extent, 1e-30))));
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

float peelnet_cut(float zeta, vec4 gaps) {
    vec2 lengths = (gaps.yw - gaps.xz);
    vec2 passed = clamp((vec2(zeta) - gaps.xz), vec2(0.0), lengths);
    float kept = (((zeta + 1.0) - passed.x) - passed.y);
    return ((kept * (2.0 / ((2.0 - lengths.x) - lengths.y))) - 1.0);
}

float peelnet_level(float absorbance) {
    return max(floor(((absorbance * PEELNET_BIN_LEVELS) + 0.5)), 1.0);
}

vec4 peelnet_in_bins(float level, float place, float first) {
    vec4 middles = vec4(first, (first + 1.0), (first + 2.0), (first + 3.0));
    vec4 shares = max((vec4(1.0) - abs((vec4(place) - middles))), vec4(0.0));
    return (floor(((level * shares) + vec4(0.5))) / vec4(255.0));
}

vec4 peelnet_seen_behind(float before, vec4 bins) {
    float two = (bins.x + bins.y);
    vec4 levels_1 = (vec4(before) + vec4(bins.x, two, (two + bins.z), ((two + bins.z) + bins.w)));
    return exp((levels_1 * -3.984375));
}

vec4 peelnet_even() {
    return vec4(0.06, 0.35, 0.65, 0.94);
}

float peelnet_place_among(float depth, vec4 quantiles) {
    vec4 begin = vec4(0.0, quantiles.xyz);
    vec4 parts = clamp(((vec4(depth) - begin) / max((quantiles - begin), vec4(0.0001))), vec4(0.0), vec4(1.0));
    float last = clamp(((depth - quantiles.w) / max((1.0 - quantiles.w), 0.0001)), 0.0, 1.0);
    return (dot(parts, vec4(0.06, 0.29, 0.3, 0.29)) + (0.06 * last));
}

mat4x4 peelnet_tile_levels(float level_1, float depth_1) {
    float place_3 = clamp(((depth_1 * 16.0) - 0.5), 0.0, 15.0);
    vec4 _e10 = peelnet_in_bins(level_1, place_3, 0.0);
    vec4 _e12 = peelnet_in_bins(level_1, place_3, 4.0);
    vec4 _e14 = peelnet_in_bins(level_1, place_3, 8.0);
    vec4 _e16 = peelnet_in_bins(level_1, place_3, 12.0);
    return mat4x4(_e10, _e12, _e14, _e16);
}

mat4x4 peelnet_tile_bins(float alpha_1, float zeta_1) {
    float _e2 = peelnet_absorbance(alpha_1);
    float _e3 = peelnet_level(_e2);
    mat4x4 _e8 = peelnet_tile_levels(_e3, ((0.5 * zeta_1) + 0.5));
    return _e8;
}

float peelnet_tile_nearest(float alpha_2, float zeta_2) {
    float _e2 = peelnet_absorbance(alpha_2);
    float bin = min(floor((((0.5 * zeta_2) + 0.5) * PEELNET_TILE_DEPTHS)), 239.0);
    float opacity = floor((((_e2 / (_e2 + 1.0)) * 270.9375) + 0.5));
    vec3 _e26 = peelnet_halves(vec3((((239.0 - bin) * PEELNET_TILE_OPACITIES) + opacity)));
    return _e26.x;
}

vec4 peelnet_before(mat4x4 bins_1) {
    vec4 all_ = (vec4(1.0) * bins_1);
    return vec4(0.0, all_.x, (all_.x + all_.y), ((all_.x + all_.y) + all_.z));
}

vec4 peelnet_seen(vec4 bins_2, vec4 taken, float before_1) {
    vec4 _e3 = peelnet_seen_behind(before_1, bins_2);
    vec4 seen_4 = (vec4(exp((before_1 * -3.984375)), _e3.xyz) - _e3);
    return ((seen_4 * max((bins_2 - taken), vec4(0.0))) / max(bins_2, vec4(0.003921569)));
}

mat4x4 peelnet_tile_seen(mat4x4 bins_3, float nearest) {
    vec3 _e3 = peelnet_levels(vec3(nearest));
    float level_2 = max(_e3.x, 0.0);
    float back = floor((level_2 * 0.00390625));
    float opacity_1 = ((level_2 - (back * PEELNET_TILE_OPACITIES)) * 0.003921569);
    float depth_3 = (((PEELNET_TILE_DEPTHS - back) - 0.5) / PEELNET_TILE_DEPTHS);
    float _e24 = peelnet_level((opacity_1 / (1.0625 - opacity_1)));
    mat4x4 _e25 = peelnet_tile_levels(_e24, depth_3);
    vec4 _e26 = peelnet_before(bins_3);
    vec4 _e30 = peelnet_seen(bins_3[0], _e25[0], _e26.x);
    vec4 _e34 = peelnet_seen(bins_3[1], _e25[1], _e26.y);
    vec4 _e38 = peelnet_seen(bins_3[2], _e25[2], _e26.z);
    vec4 _e42 = peelnet_seen(bins_3[3], _e25[3], _e26.w);
    return mat4x4(_e30, _e34, _e38, _e42);
}

float peelnet_passed(float share, float before_2, vec4 bins_4) {
    float two_1 = (bins_4.x + bins_4.y);
    vec4 begin_1 = (vec4(before_2) + vec4(0.0, bins_4.x, two_1, (two_1 + bins_4.z)));
    return dot(clamp(((vec4(share) - begin_1) / max(bins_4, vec4(1e-9))), vec4(0.0), vec4(1.0)), vec4(1.0));
}

float peelnet_depth_at(float share_1, mat4x4 bins_5, vec4 before_3) {
    float _e5 = peelnet_passed(share_1, before_3.x, bins_5[0]);
    float _e8 = peelnet_passed(share_1, before_3.y, bins_5[1]);
    float front = (_e5 + _e8);
    float _e12 = peelnet_passed(share_1, before_3.z, bins_5[2]);
    float _e16 = peelnet_passed(share_1, before_3.w, bins_5[3]);
    return (0.0625 * ((front + _e12) + _e16));
}

vec4 peelnet_quantiles(mat4x4 seen) {
    vec4 even = vec4(0.00125);
    mat4x4 bins_6 = (seen + mat4x4(even, even, even, even));
    vec4 _e5 = peelnet_before(bins_6);
    vec4 _e6 = peelnet_even();
    vec4 shares_1 = (_e6 * (_e5.w + dot(bins_6[3], vec4(1.0))));
    float _e15 = peelnet_depth_at(shares_1.x, bins_6, _e5);
    float _e17 = peelnet_depth_at(shares_1.y, bins_6, _e5);
    float _e19 = peelnet_depth_at(shares_1.z, bins_6, _e5);
    float _e21 = peelnet_depth_at(shares_1.w, bins_6, _e5);
    return vec4(_e15, _e17, _e19, _e21);
}

float peelnet_noise(uvec2 pixel) {
    return (float((((pixel.x * 12664746u) + (pixel.y * 9560334u)) & 16777215u)) * 5.9604645e-8);
}

vec4 peelnet_to_unit(vec4 values) {
    vec4 kept_1 = max(values, vec4(0.0));
    return sqrt(min(((kept_1 / (vec4(1.0) + kept_1)) * 1.0625), vec4(1.0)));
}

vec4 peelnet_from_unit(vec4 units) {
    vec4 shares_2 = ((units * units) * PEELNET_MOST);
    return (shares_2 / (vec4(1.0) - shares_2));
}

vec4 peelnet_record(float b, vec3 rgb, float depth_2, float place_1, float noise) {
    float bin_1 = clamp(floor(((0.5 * (depth_2 + place_1)) * PEELNET_DEPTHS)), 0.0, 479.0);
    vec4 _e16 = peelnet_to_unit(vec4(rgb, b));
    vec4 values_1 = min(floor(((_e16 * 127.0) + vec4(noise))), vec4(127.0));
    vec4 levels_2 = (values_1 + vec4(((479.0 - bin_1) * PEELNET_VALUES)));
    vec3 _e30 = peelnet_halves(levels_2.xyz);
    vec3 _e32 = peelnet_halves(levels_2.www);
    return vec4(_e30, _e32.x);
}

PeelnetNearest peelnet_nearest(vec4 halves_1, vec4 sums, vec4 quantiles_1, float noise_1) {
    vec3 _e5 = peelnet_levels(halves_1.xyz);
    vec3 _e7 = peelnet_levels(halves_1.www);
    vec4 levels_3 = max(vec4(_e5, _e7.x), vec4(0.0));
    vec4 back_1 = floor((levels_3 * 0.0078125));
    vec4 steps = ((levels_3 - (back_1 * PEELNET_VALUES)) + vec4((0.5 - noise_1)));
    vec4 units_1 = clamp((steps / vec4(127.0)), vec4(0.0), vec4(1.0));
    vec4 _e31 = peelnet_from_unit(units_1);
    float on_scale = (((PEELNET_DEPTHS - back_1.w) - 0.5) / PEELNET_DEPTHS);
    vec4 _e39 = peelnet_even();
    float _e43 = peelnet_place_among(on_scale, (0.5 * (quantiles_1 + _e39)));
    float one = (1.0 + _e31.w);
    vec4 _e48 = peelnet_to_unit(_e31.wwww);
    float slack = (((((2.0 * _e48.x) * PEELNET_MOST) * one) * one) / 127.0);
    bool alone = ((sums.w - _e31.w) <= (slack + (sums.w * 0.0009765625)));
    vec3 color = (alone ? (sums.xyz / vec3(max(sums.w, 1e-6))) : _e31.xyz);
    float absorbance_1 = (alone ? sums.w : _e31.w);
    float coverage = (1.0 - exp(-(sums.w)));
    float alpha_4 = min((1.0 - exp(-(absorbance_1))), coverage);
    return PeelnetNearest(color, absorbance_1, _e43, coverage, alpha_4, (coverage - alpha_4));
}

vec4 peelnet_behind(vec3 rgb_1, float b_1, float share_2, PeelnetNearest nearest_1) {
    float taken_1 = (nearest_1.absorbance * share_2);
    return vec4(max((min(rgb_1, vec3(65504.0)) - (taken_1 * nearest_1.color)), vec3(0.0)), max((b_1 - taken_1), 0.0));
}

float peelnet_inside(float b_2) {
    float some = max(b_2, 0.02);
    return ((b_2 < 0.02) ? (b_2 * (0.5 - (b_2 / 24.0))) : log((some / (1.0 - exp(-(some))))));
}

float peelnet_share(float root_absorbance, float root_total, float share_before, float share_own, float share_previous, float share_next, float nearest_alpha, float nearest_place, float number) {
    vec4 input_a = vec4(root_absorbance, root_total, share_before, share_own);
    vec4 input_b = vec4(share_previous, share_next, nearest_alpha, nearest_place);
    vec4 input_c = vec4(number, 0.0, 0.0, 0.0);
    vec4 layer_a_a = max((((vec4(-0.3643585, -1.6444997, 2.879028, 3.969859) + (mat4x4(vec4(-0.035856757, -0.06817013, -0.18471625, -0.73033863), vec4(0.077753864, 0.097871795, 0.19670647, -0.3498375), vec4(-1.0399143, -3.8017354, -0.4186011, -1.4764334), vec4(0.34179458, 2.3682005, 0.757651, 0.8526551)) * input_a)) + (mat4x4(vec4(-2.1066976, 6.9736977, -1.2470212, -1.7055901), vec4(-2.6102562, 2.377847, 0.67324764, -0.75044966), vec4(0.08623841, 0.060396902, -0.1687638, 0.9640445), vec4(4.040672, 0.270934, -4.6773195, -2.5334377)) * input_b)) + (vec4(0.1935029, -0.73336715, -3.3349328, -1.212692) * input_c.x)), vec4(0.0));
    vec4 layer_a_b = max((((vec4(0.21330349, -0.02656817, -0.16447073, 1.1548687) + (mat4x4(vec4(0.02052927, -0.92279875, -0.089854464, -0.646571), vec4(0.0017290202, 0.022043811, 0.070165455, 0.2522591), vec4(-7.6991463, 0.83759165, -8.330793, -10.267181), vec4(0.248631, 0.7580159, 0.82532406, 2.7728171)) * input_a)) + (mat4x4(vec4(7.0652976, -2.2109723, 9.127621, -3.1035454), vec4(1.6437272, 0.1328044, 0.10455265, -0.36131564), vec4(-0.13505335, 1.3599367, -0.112846546, 2.5116642), vec4(-0.5268424, -1.7431964, 0.059136257, 2.7708263)) * input_b)) + (vec4(-0.097574115, 2.234713, -0.41646186, -3.6041784) * input_c.x)), vec4(0.0));
    vec4 layer_a_c = max((((vec4(0.23459977, 1.5284905, -0.33104283, -0.90826887) + (mat4x4(vec4(-1.4310397, 0.50795686, -1.1753677, 0.30261093), vec4(0.24343121, -0.11405239, 0.2738383, 0.5665453), vec4(0.67151386, -3.5867555, -0.616056, -1.4708247), vec4(-3.8027723, -0.91791475, -2.1488001, -1.4649061)) * input_a)) + (mat4x4(vec4(1.8115171, 2.7251132, 0.99894553, 3.4080665), vec4(1.7032629, -0.6312258, 2.37076, -1.3196673), vec4(1.8095148, 0.7401302, 0.91098684, -1.0051945), vec4(2.2262223, -4.9366107, 3.2235591, 2.1454048)) * input_b)) + (vec4(-2.0792654, -1.3673354, -0.037428267, 0.11669109) * input_c.x)), vec4(0.0));
    float layer_b_a = (1.0 / (1.0 + exp(min(-((((-0.050200883 + dot(vec4(-0.33934435, 2.134865, -1.0937227, -0.56847894), layer_a_a)) + dot(vec4(0.91362965, 0.58325267, 4.8532796, 2.4492927), layer_a_b)) + dot(vec4(-2.5263038, 0.6588748, -0.92443925, 0.5552326), layer_a_c))), 80.0))));
    return layer_b_a;
}

float peelnet_network(PeelnetAhead ahead) {
    float _e14 = peelnet_share(sqrt((2.0 * ahead.absorbance)), sqrt(ahead.total), ahead.before, ahead.own, ahead.previous, ahead.next, ahead.alpha, ahead.place, ahead.number);
    return _e14;
}

float peelnet_part(float own, float before_4, float previous, float next, float total, float number_1, PeelnetNearest nearest_2) {
    float _e7 = peelnet_inside(own);
    float ahead_1 = (before_4 + _e7);
    float scale = (1.0 / max(total, 1e-6));
    PeelnetAhead known = PeelnetAhead(ahead_1, total, (before_4 * scale), (own * scale), (previous * scale), (next * scale), nearest_2.alpha, nearest_2.place, number_1);
    float _e22 = peelnet_network(known);
    return exp(((-2.0 * ahead_1) * _e22));
}

vec3 peelnet_seen_of(vec3 b_3, float before_5) {
    float _e3 = peelnet_inside(b_3.x);
    float _e8 = peelnet_inside(b_3.y);
    float _e15 = peelnet_inside(b_3.z);
    vec3 ahead_2 = vec3((before_5 + _e3), ((before_5 + b_3.x) + _e8), (((before_5 + b_3.x) + b_3.y) + _e15));
    return (b_3 * exp(-(ahead_2)));
}

vec4 peelnet_until(vec4 depths, vec3 seen_1, vec3 begins, vec3 ends, vec4 quantiles_2) {
    vec3 scale_1 = (vec3(1.0) / (ends - begins));
    float _e10 = peelnet_place_among(depths.x, quantiles_2);
    float _e21 = peelnet_place_among(depths.y, quantiles_2);
    float _e32 = peelnet_place_among(depths.z, quantiles_2);
    float _e43 = peelnet_place_among(depths.w, quantiles_2);
    return vec4(dot(seen_1, clamp(((vec3(_e10) - begins) * scale_1), vec3(0.0), vec3(1.0))), dot(seen_1, clamp(((vec3(_e21) - begins) * scale_1), vec3(0.0), vec3(1.0))), dot(seen_1, clamp(((vec3(_e32) - begins) * scale_1), vec3(0.0), vec3(1.0))), dot(seen_1, clamp(((vec3(_e43) - begins) * scale_1), vec3(0.0), vec3(1.0))));
}

mat4x4 peelnet_spread(vec3 seen_2, vec3 begins_1, vec3 ends_1, vec4 quantiles_3) {
    vec4 depths_1 = vec4(0.0625, 0.125, 0.1875, 0.25);
    vec4 _e9 = peelnet_until(depths_1, seen_2, begins_1, ends_1, quantiles_3);
    vec4 _e13 = peelnet_until((depths_1 + vec4(0.25)), seen_2, begins_1, ends_1, quantiles_3);
    vec4 _e17 = peelnet_until((depths_1 + vec4(0.5)), seen_2, begins_1, ends_1, quantiles_3);
    vec4 _e21 = peelnet_until((depths_1 + vec4(0.75)), seen_2, begins_1, ends_1, quantiles_3);
    return mat4x4((_e9 - vec4(0.0, _e9.xyz)), (_e13 - vec4(_e9.w, _e13.xyz)), (_e17 - vec4(_e13.w, _e17.xyz)), (_e21 - vec4(_e17.w, _e21.xyz)));
}

vec4 peelnet_over_black(PeelnetNearest nearest_3, vec4 seen_3) {
    vec3 rest = ((seen_3.w > 0.0) ? (seen_3.xyz / vec3(max(seen_3.w, 1.1754944e-38))) : nearest_3.color);
    return vec4(((nearest_3.alpha * nearest_3.color) + (nearest_3.left * rest)), nearest_3.coverage);
}

vec3 peelnet_shares(float place_2) {
    vec3 off = ((vec3(place_2) - vec3(0.224, 0.485, 1.028)) * vec3(6.3291135, 5.952381, 5.235602));
    vec3 bumps = exp(((-0.5 * off) * off));
    return (bumps * (1.0 / ((bumps.x + bumps.y) + bumps.z)));
}

PeelnetStatistics peelnet_statistics(float alpha_3, vec3 rgb_2, float zeta_3, vec4 quantiles_4, float noise_2) {
    float _e5 = peelnet_absorbance(alpha_3);
    float depth_4 = ((0.5 * zeta_3) + 0.5);
    float _e10 = peelnet_place_among(depth_4, quantiles_4);
    vec4 _e11 = peelnet_record(_e5, rgb_2, depth_4, _e10, noise_2);
    vec3 _e12 = peelnet_shares(_e10);
    vec3 shares_3 = (_e5 * _e12);
    return PeelnetStatistics(vec4((rgb_2 * shares_3.x), _e11.x), vec4((rgb_2 * shares_3.y), _e11.y), vec4((rgb_2 * shares_3.z), _e11.z), vec4(shares_3, _e11.w));
}

PeelnetRest peelnet_rest(vec4 sum_a, vec4 sum_b, vec4 sum_c, vec4 absorbances, vec4 quantiles_5, float noise_3) {
    vec3 b_4 = min(absorbances.xyz, vec3(65504.0));
    vec4 all_1 = vec4(((sum_a.xyz + sum_b.xyz) + sum_c.xyz), ((b_4.x + b_4.y) + b_4.z));
    PeelnetNearest _e26 = peelnet_nearest(vec4(sum_a.w, sum_b.w, sum_c.w, absorbances.w), all_1, quantiles_5, noise_3);
    vec3 _e28 = peelnet_shares(_e26.place);
    vec4 _e32 = peelnet_behind(sum_a.xyz, b_4.x, _e28.x, _e26);
    vec4 _e36 = peelnet_behind(sum_b.xyz, b_4.y, _e28.y, _e26);
    vec4 _e40 = peelnet_behind(sum_c.xyz, b_4.z, _e28.z, _e26);
    return PeelnetRest(_e26, _e32, _e36, _e40);
}

vec4 peelnet_pixel(vec4 sum_a_1, vec4 sum_b_1, vec4 sum_c_1, vec4 absorbances_1, vec4 quantiles_6, float noise_4) {
    PeelnetRest _e6 = peelnet_rest(sum_a_1, sum_b_1, sum_c_1, absorbances_1, quantiles_6, noise_4);
    float two_2 = (_e6.first.w + _e6.second.w);
    float total_1 = (two_2 + _e6.third.w);
    float _e24 = peelnet_part(_e6.first.w, 0.0, 0.0, _e6.second.w, total_1, 0.0, _e6.nearest);
    float _e37 = peelnet_part(_e6.second.w, _e6.first.w, _e6.first.w, _e6.third.w, total_1, 0.5, _e6.nearest);
    float _e48 = peelnet_part(_e6.third.w, two_2, _e6.second.w, 0.0, total_1, 1.0, _e6.nearest);
    vec4 seen_5 = (((_e6.first * _e24) + (_e6.second * _e37)) + (_e6.third * _e48));
    vec4 _e52 = peelnet_over_black(_e6.nearest, seen_5);
    return _e52;
}

mat4x4 peelnet_last_seen(vec4 sum_a_2, vec4 sum_b_2, vec4 sum_c_2, vec4 absorbances_2, vec4 quantiles_7, float noise_5) {
    PeelnetRest _e6 = peelnet_rest(sum_a_2, sum_b_2, sum_c_2, absorbances_2, quantiles_7, noise_5);
    vec3 b_5 = vec3(_e6.first.w, _e6.second.w, _e6.third.w);
    vec3 _e15 = peelnet_seen_of(b_5, 0.0);
    float scale_2 = (_e6.nearest.left / max(dot(_e15, vec3(1.0)), 1.1754944e-38));
    vec3 begins_2 = vec3(0.0, 0.345, 0.738);
    mat4x4 _e33 = peelnet_spread((_e15 * scale_2), begins_2, vec3(0.345, 0.738, 1.0), quantiles_7);
    return _e33;
}

vec4 peelnet_resolve(vec4 sum_a_3, vec4 sum_b_3, vec4 sum_c_3, vec4 absorbances_3, vec4 quantiles_8, float noise_6, vec3 background) {
    vec4 _e7 = peelnet_pixel(sum_a_3, sum_b_3, sum_c_3, absorbances_3, quantiles_8, noise_6);
    return vec4((_e7.xyz + ((1.0 - _e7.w) * background)), _e7.w);
}

float peelnet_weight(float root_absorbance_1, float root_total_1, float share_before_1, float share_own_1, float share_previous_1, float share_next_1, float nearest_alpha_1, float nearest_place_1, float number_2) {
    float root = clamp(root_absorbance_1, 0.0, 256.0);
    float _e39 = peelnet_share(clamp(root_absorbance_1, -13561.853, 13564.8545), clamp(root_total_1, -30128.404, 30134.768), clamp(share_before_1, -2667.907, 2668.264), clamp(share_own_1, -3112.036, 3112.7146), clamp(share_previous_1, -2008.2643, 2008.5392), clamp(share_next_1, -3296.4385, 3297.0293), clamp(nearest_alpha_1, -3215.6423, 3216.4802), clamp(nearest_place_1, -1974.1545, 1974.4336), clamp(number_2, -4064.0708, 4065.088));
    return exp(((-(root) * root) * _e39));
}
