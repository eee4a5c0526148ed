// A learned weight for order-independent transparency. Exported by peelnet 0.1.0.
// Licence of this generated text: MIT OR Apache-2.0.
// GLSL ES 3.00, WebGL 2. Paste it below #version 300 es and precision highp float; and precision highp int;.
// Network: 5-1 (Relu hidden, Sigmoid last), 6 parameters, 5 multiply-adds. Recipe small, seed 1, 40 epochs.
// Answers: transmittance of what lies between a slab's known ends, exp(-absorbance * share) with absorbance = root_absorbance^2 and share in share_low .. share_high.
// Input 0: root_absorbance (root of the absorbance between the slab's ends), 0.0 .. 21.413115 in training.
// Input 1: place_fraction (of the way between the slab's ends), 0.0 .. 1.0 in training.
// Input 2: mean_fraction (of the way between the slab's ends), 0.0 .. 1.0 in training.
// Input 3: share_low (of the absorbance between the slab's ends), 0.0 .. 1.0 in training.
// Input 4: share_high (of the absorbance between the slab's ends), 0.0 .. 1.0 in training.
// Trained on boxes, cups, foliage, intersecting, opaque-mix, panes, sixteen-025, sixteen-050, sixteen-075, sixteen-085, sixteen-random-alpha, sixteen-random-color, smoke-100, smoke-30, synthetic, of a dataset of 21565798 rows (f0e6c4a7cca08d560f99a5be9cbd1514bf8be352632a347602bf08363695fd29+e22e844788a454658277e87e23685b5ffa00e3ad2d48cb833cc53130eaf4d8b7).
// Loss: training 0.000179, validation 0.000166, test 0.000172.
// Held-out error, mean |T - T_exact|: boxes-held 0.00404, cups-held 0.00393, foliage-held 0.00262, panes-held 0.00095, sixteen-held 0.00166, smoke-held 0.00442.
//
// Self-tests, to some roundings of 32 bits; weights and colours also to those of 16-bit targets.
// peelnet_weight(8.333773, 0.014353275, 0.21181071, 0.010463357, 0.22229642) = 0.28606492
// peelnet_weight(3.268195, 0.3421247, 0.95406777, 0.022867262, 0.49329907) = 0.42661902
// peelnet_weight(3.7688715, 0.5225114, 0.08770603, 0.111551285, 0.022744834) = 0.23633718
// Four fragments of a pixel, near 1.0, far 8.0, background 0.25, 0.5, 0.75:
//    z 1.0, alpha 0.5, rgb 1.0, 0.0, 0.0: zeta -1.0, weight 1.0
//    z 2.0, alpha 0.5, rgb 0.0, 1.0, 0.0: zeta -0.33333334, weight 0.5
//    z 4.0, alpha 0.5, rgb 0.0, 0.0, 1.0: zeta 0.33333334, weight 0.25
//    z 8.0, alpha 0.9, rgb 1.0, 1.0, 1.0: zeta 1.0, weight 0.125
//    target absorbances: 1.3862944, 0.6931472, 2.302585, -0.44323698
//    target nearest: 64928.0, -0.014541626, -64768.0, 0.11407471
//    target firsts: 0.18153855, 2.302585
//    colour of the pixel: 0.615625, 0.36875, 0.246875
//
// How to draw with it. Targets may have 32 bits a channel wherever 16 are named.
// 0. zeta = peelnet_zeta(z, near, far): z is the distance along the view axis, near and far the range of z that the bounding boxes of the transparent objects in view span, clipped to the camera's. The tighter the range, the less errs. Compute zeta with this function in all passes. Its range is the same for the whole frame: peelnet_zeta_in(z, peelnet_range(near, far)) is the same value, and the range may be passed in. Where boxes show that nothing lies between two depths, use peelnet_cut(zeta, gaps) for zeta in all passes: it leaves up to two such gaps out. quantiles says where among the depths around the pixel most is seen: peelnet_even() where nothing is known but near and far, with several times the error.
//    quantiles: rgba8unorm, a texture of one texel for 8 by 8 pixels, read with linear interpolation; peelnet_even() where it is not drawn.
//    At its size, draw all transparent surfaces, in any order. mat4 bins = peelnet_tile_bins(alpha, zeta);
//    bins_a: rgba8unorm, cleared to 0, blending ADD, from bins[0]
//    bins_b: rgba8unorm, cleared to 0, blending ADD, from bins[1]
//    bins_c: rgba8unorm, cleared to 0, blending ADD, from bins[2]
//    bins_d: rg8unorm, cleared to 0, blending ADD, from bins[3].xy
//    bins_e: rg8unorm, cleared to 0, blending ADD, from bins[3].zw
//    tile_nearest: r16float, cleared to -65504, blending MAX, from peelnet_tile_nearest(alpha, zeta)
//    Then each of its texels is peelnet_quantiles(sum): sum adds, over the 3 by 3 texels around it, peelnet_tile_seen(mat4(bins_a, bins_b, bins_c, vec4(bins_d, bins_e)), tile_nearest).
// 1. Pass "statistics": draw all transparent surfaces, in any order. PeelnetStatistics s = peelnet_statistics(alpha, zeta, quantiles);
//    absorbances: rgba16float, cleared to 0, blending ADD, from s.absorbances
//    nearest: rgba16float, cleared to -65504, blending MAX, from s.nearest
//    firsts: rg16float, cleared to 0, blending ADD, from s.firsts
// 2. Pass "weights": draw all transparent surfaces, in any order. float w = peelnet_fragment(alpha, zeta, quantiles, absorbances, nearest, firsts).x;
//    sums: rgba16float, cleared to 0, blending ADD, from vec4(alpha * rgb, alpha) * w
// 3. Resolve: peelnet_resolve(sums, absorbances.x + absorbances.y + absorbances.z, background) is the colour of the pixel, and its coverage in alpha.
// - alpha is opacity, rgb the linear colour that is not multiplied by it. Resolve before tone mapping and encoding.
// - Test depth against the opaque surfaces, do not write it: a depth prepass with transparent surfaces in it hides what lies behind.
// - z grows with distance, also where depth buffers are reversed.
// - With multisampling, gather and resolve the statistics per sample: averaged samples of them mean nothing.

struct PeelnetRange {
    float inverse_near;
    float near;
    float scale;
};
struct PeelnetPlace {
    float absorbance;
    float slab;
    float inside;
    float bin;
    float near;
    float far;
};
struct PeelnetBetween {
    float absorbance;
    float place;
    float mean;
    float low;
    float high;
    float extent;
    float own;
    float nearest;
};
struct PeelnetStatistics {
    vec4 absorbances;
    vec4 nearest;
    vec2 firsts;
};
const float PEELNET_BIN_LEVELS = 64.0;
const float PEELNET_TILE_DEPTHS = 240.0;
const float PEELNET_TILE_OPACITIES = 256.0;
const float PEELNET_FAINT = 0.003921569;
const float PEELNET_BINS = 1920.0;
const float PEELNET_OPACITIES = 32.0;
const float PEELNET_EMPTY = -65504.0;
const float PEELNET_FIRST_END = 0.49;
const float PEELNET_SECOND_END = 0.77;
const float PEELNET_THIRD_END = 1.0;
const float PEELNET_LAST_SLAB = 2.0;


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
    float kept_1 = (((zeta + 1.0) - passed.x) - passed.y);
    return ((kept_1 * (2.0 / ((2.0 - lengths.x) - lengths.y))) - 1.0);
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
    vec4 levels_3 = (vec4(before) + vec4(bins.x, two, (two + bins.z), ((two + bins.z) + bins.w)));
    return exp((levels_3 * -3.984375));
}

vec4 peelnet_even() {
    return vec4(0.06, 0.35, 0.65, 0.94);
}

float peelnet_place_among(float depth, vec4 quantiles) {
    vec4 begin_1 = vec4(0.0, quantiles.xyz);
    vec4 parts = clamp(((vec4(depth) - begin_1) / max((quantiles - begin_1), vec4(0.0001))), vec4(0.0), vec4(1.0));
    float last = clamp(((depth - quantiles.w) / max((1.0 - quantiles.w), 0.0001)), 0.0, 1.0);
    return (dot(parts, vec4(0.06, 0.29, 0.3, 0.29)) + (0.06 * last));
}

mat4x4 peelnet_tile_levels(float level_1, float depth_1) {
    float place_4 = clamp(((depth_1 * 16.0) - 0.5), 0.0, 15.0);
    vec4 _e10 = peelnet_in_bins(level_1, place_4, 0.0);
    vec4 _e12 = peelnet_in_bins(level_1, place_4, 4.0);
    vec4 _e14 = peelnet_in_bins(level_1, place_4, 8.0);
    vec4 _e16 = peelnet_in_bins(level_1, place_4, 12.0);
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
    float bin_1 = min(floor((((0.5 * zeta_2) + 0.5) * PEELNET_TILE_DEPTHS)), 239.0);
    float opacity = floor((((_e2 / (_e2 + 1.0)) * 270.9375) + 0.5));
    vec3 _e26 = peelnet_halves(vec3((((239.0 - bin_1) * PEELNET_TILE_OPACITIES) + opacity)));
    return _e26.x;
}

vec4 peelnet_before(mat4x4 bins_1) {
    vec4 all_ = (vec4(1.0) * bins_1);
    return vec4(0.0, all_.x, (all_.x + all_.y), ((all_.x + all_.y) + all_.z));
}

vec4 peelnet_seen(vec4 bins_2, vec4 taken, float before_1) {
    vec4 _e3 = peelnet_seen_behind(before_1, bins_2);
    vec4 seen_1 = (vec4(exp((before_1 * -3.984375)), _e3.xyz) - _e3);
    return ((seen_1 * max((bins_2 - taken), vec4(0.0))) / max(bins_2, vec4(0.003921569)));
}

mat4x4 peelnet_tile_seen(mat4x4 bins_3, float nearest) {
    vec3 _e3 = peelnet_levels(vec3(nearest));
    float level_2 = max(_e3.x, 0.0);
    float back = floor((level_2 * 0.00390625));
    float opacity_1 = ((level_2 - (back * PEELNET_TILE_OPACITIES)) * 0.003921569);
    float depth_2 = (((PEELNET_TILE_DEPTHS - back) - 0.5) / PEELNET_TILE_DEPTHS);
    float _e24 = peelnet_level((opacity_1 / (1.0625 - opacity_1)));
    mat4x4 _e25 = peelnet_tile_levels(_e24, depth_2);
    vec4 _e26 = peelnet_before(bins_3);
    vec4 _e30 = peelnet_seen(bins_3[0], _e25[0], _e26.x);
    vec4 _e34 = peelnet_seen(bins_3[1], _e25[1], _e26.y);
    vec4 _e38 = peelnet_seen(bins_3[2], _e25[2], _e26.z);
    vec4 _e42 = peelnet_seen(bins_3[3], _e25[3], _e26.w);
    return mat4x4(_e30, _e34, _e38, _e42);
}

float peelnet_passed(float share, float before_2, vec4 bins_4) {
    float two_1 = (bins_4.x + bins_4.y);
    vec4 begin_2 = (vec4(before_2) + vec4(0.0, bins_4.x, two_1, (two_1 + bins_4.z)));
    return dot(clamp(((vec4(share) - begin_2) / max(bins_4, vec4(1e-9))), vec4(0.0), vec4(1.0)), vec4(1.0));
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

float peelnet_of_slab(vec4 values, float slab) {
    return ((slab >= 2.0) ? ((slab == 3.0) ? values.w : values.z) : ((slab == 1.0) ? values.y : values.x));
}

PeelnetPlace peelnet_place(float alpha_3, float zeta_3, vec4 quantiles_1) {
    float _e3 = peelnet_absorbance(alpha_3);
    float _e8 = peelnet_place_among(((0.5 * zeta_3) + 0.5), quantiles_1);
    float first_2 = ((_e8 >= PEELNET_FIRST_END) ? 1.0 : 0.0);
    float passed_1 = ((first_2 + ((_e8 >= PEELNET_SECOND_END) ? 1.0 : 0.0)) + ((_e8 >= PEELNET_THIRD_END) ? 1.0 : 0.0));
    float slab_2 = min(passed_1, PEELNET_LAST_SLAB);
    float _e33 = peelnet_of_slab(vec4(0.0, 0.49, 0.77, 1.0), slab_2);
    float _e39 = peelnet_of_slab(vec4(0.49, 0.77, 1.0, 1.0), slab_2);
    float inside = ((_e8 - _e33) / (_e39 - _e33));
    float bin_2 = min(floor((inside * PEELNET_BINS)), 1919.0);
    float opacity_2 = floor((((_e3 / (_e3 + 1.0)) * 32.9375) + 0.5));
    float near_2 = (((1919.0 - bin_2) * PEELNET_OPACITIES) + opacity_2);
    return PeelnetPlace(_e3, slab_2, ((2.0 * inside) - 1.0), bin_2, near_2, ((bin_2 * PEELNET_OPACITIES) + opacity_2));
}

vec2 peelnet_records(float alpha_4, PeelnetPlace place_1) {
    vec3 _e6 = peelnet_halves(vec3(place_1.near, place_1.far, place_1.far));
    vec2 levels_4 = _e6.xy;
    return ((alpha_4 < PEELNET_FAINT) ? vec2(-65504.0) : levels_4);
}

vec2 peelnet_absorbances_of(vec2 levels_1) {
    vec2 share_2 = ((levels_1 - (floor((levels_1 * 0.03125)) * PEELNET_OPACITIES)) * 0.032258064);
    return (share_2 / (vec2(1.0625) - share_2));
}

float peelnet_middle_of(float bin) {
    return (((bin + 0.5) * 0.0010416667) - 1.0);
}

vec4 peelnet_in_slab(float value, float slab_1, float elsewhere) {
    return vec4(((slab_1 == 0.0) ? value : elsewhere), ((slab_1 == 1.0) ? value : elsewhere), ((slab_1 == 2.0) ? value : elsewhere), ((slab_1 == 3.0) ? value : elsewhere));
}

PeelnetBetween peelnet_between(PeelnetPlace place_2, float total, float first_1, vec2 levels_2) {
    bool local = false;
    bool local_1 = false;
    float begin = 0.0;
    float end = 0.0;
    float b = place_2.absorbance;
    float others = max((total - b), 0.0);
    float noise = max((total * 0.0009765625), 1e-6);
    float near_back = floor((levels_2.x * 0.03125));
    float near_bin = (1919.0 - near_back);
    float near_level = (levels_2.x + ((near_bin - near_back) * PEELNET_OPACITIES));
    vec2 _e23 = peelnet_absorbances_of(levels_2);
    bool all_1 = (_e23.x > (others - (((0.019354839 * (1.0 + _e23.x)) * (1.0 + _e23.x)) + noise)));
    float near_3 = ((near_bin > place_2.bin) ? 0.0 : (all_1 ? others : _e23.x));
    float far_bin = floor((levels_2.y * 0.03125));
    if (!((levels_2.y == near_level))) {
        local = (levels_2.y < 0.0);
    } else {
        local = true;
    }
    bool is_one = local;
    if (!(is_one)) {
        local_1 = (far_bin < place_2.bin);
    } else {
        local_1 = true;
    }
    bool _e64 = local_1;
    float far_2 = (_e64 ? 0.0 : _e23.y);
    float _e67 = peelnet_middle_of(near_bin);
    begin = _e67;
    float _e69 = peelnet_middle_of(far_bin);
    end = (is_one ? 1.0 : _e69);
    float rest = (((total - b) - near_3) - far_2);
    float _e79 = begin;
    float _e82 = end;
    float moment = (((first_1 - (b * place_2.inside)) - (near_3 * _e79)) - (far_2 * _e82));
    float _e85 = begin;
    float _e86 = begin;
    begin = ((_e86 > place_2.inside) ? -1.0 : _e85);
    float _e91 = end;
    float _e92 = end;
    end = ((_e92 < place_2.inside) ? 1.0 : _e91);
    float in_front = ((near_3 * ((near_bin == place_2.bin) ? 0.5 : 1.0)) + (far_2 * ((far_bin == place_2.bin) ? 0.5 : 0.0)));
    float _e110 = end;
    float _e111 = begin;
    float extent_1 = max((_e110 - _e111), 0.0010416667);
    float per_extent = (1.0 / extent_1);
    float _e118 = begin;
    float x = clamp(((place_2.inside - _e118) * per_extent), 0.0, 1.0);
    float _e126 = begin;
    float _e127 = end;
    float depth_3 = clamp((moment / max(rest, noise)), _e126, _e127);
    float _e129 = begin;
    float mean = clamp(((depth_3 - _e129) * per_extent), 0.0, 1.0);
    bool before_4 = (x < mean);
    float bound = ((before_4 ? (1.0 - mean) : (x - mean)) / max((before_4 ? (1.0 - x) : x), 1e-6));
    float low = (before_4 ? 0.0 : bound);
    float high = (before_4 ? bound : 1.0);
    return PeelnetBetween(max(rest, 0.0), x, mean, low, high, (0.5 * extent_1), b, in_front);
}

bool peelnet_is_kept(float own, float kept) {
    bool local_2 = false;
    float apart = abs((own - kept));
    if (!((apart == 0.0))) {
        local_2 = (apart == PEELNET_OPACITIES);
    } else {
        local_2 = true;
    }
    bool _e12 = local_2;
    return _e12;
}

float peelnet_share(float root_absorbance, float place_fraction, float mean_fraction, float share_low, float share_high) {
    vec4 input_a = vec4(root_absorbance, place_fraction, mean_fraction, share_low);
    vec4 input_b = vec4(share_high, 0.0, 0.0, 0.0);
    float layer_a_a = (1.0 / (1.0 + exp(min(-(((-2.3941505 + dot(vec4(-0.1540126, 0.85447216, -0.4019599, 4.09488), input_a)) + (1.8473954 * input_b.x))), 80.0))));
    return layer_a_a;
}

float peelnet_network(PeelnetBetween between) {
    float _e7 = peelnet_share(sqrt(between.absorbance), between.place, between.mean, between.low, between.high);
    return _e7;
}

vec2 peelnet_weigh(PeelnetPlace place_3, bool counts, vec4 absorbances, vec4 firsts, vec4 nearest_1, vec4 farthest, float ends) {
    bool local_3 = false;
    bool local_4 = false;
    bool local_5 = false;
    bool local_6 = false;
    bool local_7 = false;
    vec4 sums_2 = min(absorbances, vec4(65504.0));
    float _e11 = peelnet_of_slab(sums_2, place_3.slab);
    float _e13 = peelnet_of_slab(firsts, place_3.slab);
    float first_3 = clamp(_e13, -65504.0, 65504.0);
    float _e18 = peelnet_of_slab(nearest_1, place_3.slab);
    float _e20 = peelnet_of_slab(farthest, place_3.slab);
    vec2 halves_1 = vec2(_e18, _e20);
    vec3 _e24 = peelnet_levels(vec3(halves_1, halves_1.y));
    vec2 decoded = _e24.xy;
    vec2 levels_5 = ((place_3.slab < ends) ? decoded : vec2(decoded.x, -1.0));
    float before_5 = ((((place_3.slab > 0.0) ? sums_2.x : 0.0) + ((place_3.slab > 1.0) ? sums_2.y : 0.0)) + ((place_3.slab > 2.0) ? sums_2.z : 0.0));
    if (counts) {
        bool _e56 = peelnet_is_kept(place_3.near, levels_5.x);
        local_3 = _e56;
    } else {
        local_3 = false;
    }
    bool is_near = local_3;
    if (counts) {
        local_4 = (levels_5.y >= 0.0);
    } else {
        local_4 = false;
    }
    bool _e65 = local_4;
    if (_e65) {
        bool _e70 = peelnet_is_kept(place_3.far, levels_5.y);
        local_5 = _e70;
    } else {
        local_5 = false;
    }
    bool _e72 = local_5;
    if (_e72) {
        local_6 = !(is_near);
    } else {
        local_6 = false;
    }
    bool is_far = local_6;
    if (!(is_near)) {
        local_7 = is_far;
    } else {
        local_7 = true;
    }
    bool known = local_7;
    PeelnetBetween _e83 = peelnet_between(place_3, _e11, first_3, levels_5);
    float _e88 = peelnet_network(_e83);
    float share_3 = (_e83.low + ((_e83.high - _e83.low) * _e88));
    float at_end = (is_far ? max((_e11 - place_3.absorbance), 0.0) : 0.0);
    float inside_1 = (known ? at_end : (_e83.nearest + (_e83.absorbance * share_3)));
    return vec2(exp(-((before_5 + inside_1))), (known ? 1.0 : 0.0));
}

PeelnetStatistics peelnet_statistics(float alpha_5, float zeta_4, vec4 quantiles_2) {
    PeelnetPlace _e3 = peelnet_place(alpha_5, zeta_4, quantiles_2);
    vec2 _e4 = peelnet_records(alpha_5, _e3);
    vec4 _e8 = peelnet_in_slab(_e3.absorbance, _e3.slab, 0.0);
    vec4 _e12 = peelnet_in_slab(_e4.x, _e3.slab, PEELNET_EMPTY);
    vec4 _e18 = peelnet_in_slab((_e3.absorbance * _e3.inside), _e3.slab, 0.0);
    float farthest_1 = ((_e3.slab > 0.0) ? PEELNET_EMPTY : _e4.y);
    return PeelnetStatistics(vec4(_e8.xyz, _e18.x), vec4(_e12.xyz, farthest_1), _e18.yz);
}

vec2 peelnet_fragment(float alpha_6, float zeta_5, vec4 quantiles_3, vec4 absorbances_1, vec4 nearest_2, vec2 firsts_1) {
    PeelnetPlace _e6 = peelnet_place(alpha_6, zeta_5, quantiles_3);
    vec4 means = vec4(absorbances_1.w, firsts_1, 0.0);
    vec4 last_1 = vec4(nearest_2.w, vec3(-65504.0));
    vec2 _e17 = peelnet_weigh(_e6, (alpha_6 >= PEELNET_FAINT), absorbances_1, means, nearest_2, last_1, 1.0);
    return _e17;
}

vec4 peelnet_composite(vec4 sums, float coverage, vec3 transmittance, vec3 background) {
    bool local_8 = false;
    if ((sums.w > 0.0)) {
        local_8 = (coverage > 0.0);
    } else {
        local_8 = false;
    }
    bool _e20 = local_8;
    vec3 average = (_e20 ? (sums.xyz / vec3(max(sums.w, 1.1754944e-38))) : vec3(0.0));
    return vec4(((average * coverage) + (background * transmittance)), coverage);
}

vec4 peelnet_resolve(vec4 sums_1, float absorbance_1, vec3 background_1) {
    float transmittance_1 = exp(-(absorbance_1));
    vec4 _e11 = peelnet_composite(min(sums_1, vec4(65504.0)), (1.0 - transmittance_1), vec3(transmittance_1), background_1);
    return _e11;
}

float peelnet_weight(float root_absorbance_1, float place_fraction_1, float mean_fraction_1, float share_low_1, float share_high_1) {
    float root = clamp(root_absorbance_1, 0.0, 256.0);
    float _e23 = peelnet_share(clamp(root_absorbance_1, -47076.56, 47088.934), clamp(place_fraction_1, -2684.1946, 2685.5208), clamp(mean_fraction_1, -1983.4043, 1984.7168), clamp(share_low_1, -1842.8657, 1843.1003), clamp(share_high_1, -2216.2056, 2217.918));
    vec2 bounds = clamp(vec2(share_low_1, share_high_1), vec2(0.0), vec2(1.0));
    return exp(((-(root) * root) * mix(bounds.x, bounds.y, _e23)));
}
