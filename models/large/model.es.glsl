// A learned weight for order-independent transparency. Exported by peelnet 0.1.0.
// Licence of this generated text: MIT OR Apache-2.0.
// GLSL ES 3.00, WebGL 2. Paste it below #version 300 es and precision highp float; and precision highp int;.
// Network: 9-12-1 (Relu hidden, Sigmoid last), 133 parameters, 120 multiply-adds. Recipe large, seed 1, 80 epochs.
// Answers: transmittance of what lies between a slab's known ends, exp(-absorbance * share) with absorbance = root_absorbance^2 and share in share_low .. share_high.
// Input 0: root_absorbance (root of the absorbance between the slab's ends), 0.0 .. 19.254885 in training.
// Input 1: place_fraction (of the way between the slab's ends), 0.0 .. 1.0 in training.
// Input 2: mean_fraction (of the way between the slab's ends), 0.0 .. 1.0 in training.
// Input 3: share_low (of the absorbance between the slab's ends), 0.0 .. 1.0 in training.
// Input 4: share_high (of the absorbance between the slab's ends), 0.0 .. 1.0 in training.
// Input 5: root_own (root of the fragment's absorbance), 0.031630483 .. 2.4013393 in training.
// Input 6: half_extent (half of the way between the slab's ends, in slabs), 0.00052083336 .. 1.0 in training.
// Input 7: of_own (absorbance between the ends, of that and the fragment's), 0.0 .. 0.99999064 in training.
// Input 8: of_nearest (absorbance between the ends, of that and the nearer end's), 0.0 .. 1.0 in training.
// Trained on 21565798 rows of boxes, cups, foliage, intersecting, opaque-mix, panes, sixteen-025, sixteen-050, sixteen-075, sixteen-085, sixteen-random-alpha, sixteen-random-color, smoke-100, smoke-30, synthetic (dataset f0e6c4a7cca08d560f99a5be9cbd1514bf8be352632a347602bf08363695fd29+e22e844788a454658277e87e23685b5ffa00e3ad2d48cb833cc53130eaf4d8b7).
// Loss: training 0.000133, validation 0.000122, test 0.000123.
// Held-out error, mean |T - T_exact|: boxes-held 0.00174, cups-held 0.00171, foliage-held 0.00056, panes-held 0.00012, sixteen-held 0.00027, smoke-held 0.00405.
//
// Self-tests, to some roundings of 32 bits; weights and colours also to those of 16-bit targets.
// peelnet_weight(0.43794915, 0.67085797, 0.16887921, 0.7373583, 0.19208878, 0.1129206, 0.12900263, 0.4358352, 0.7663156) = 0.87601495
// peelnet_weight(0.26952705, 0.13589168, 0.26682287, 0.7078695, 0.5534122, 0.8413221, 0.6951227, 0.3716183, 0.9624051) = 0.9499678
// peelnet_weight(2.451425, 0.2162394, 0.7240006, 0.37958002, 0.26558614, 1.9607327, 0.5804378, 0.9097895, 0.04841405) = 0.11457037
// Four fragments of a pixel, near 1.0, far 8.0, background 0.25, 0.5, 0.75:
//    z 1.0, alpha 0.5, rgb 1.0, 0.0, 0.0: zeta -1.0, weight 1.0
//    z 2.0, alpha 0.5, rgb 0.0, 1.0, 0.0: zeta -0.33333334, weight 0.5
//    z 4.0, alpha 0.5, rgb 0.0, 0.0, 1.0: zeta 0.33333334, weight 0.25
//    z 8.0, alpha 0.9, rgb 1.0, 1.0, 1.0: zeta 1.0, weight 0.125
//    target bins_front: 0.17254902, 0.0, 0.14509805, 0.02745098
//    target bins_back: 0.02745098, 0.14509805, 0.0, 0.5764706
//    target absorbances: 0.6931472, 0.6931472, 0.6931472, 2.302585
//    target nearest: 64928.0, 0.26879883, 0.005054474, -64768.0
//    target farthest: -65088.0, -0.27001953, -0.0050735474, 65248.0
//    target firsts: -0.6931472, -0.27881977, -0.14537315, 2.302585
//    colour of the pixel: 0.615625, 0.36875, 0.246875
//
// How to draw with it. Targets may have 32 bits a channel wherever 16 are named.
// 0. zeta = peelnet_zeta(z, near, far): z is the distance along the view axis, near and far the range of z that the bounding boxes of the transparent objects in view span, clipped to the camera's. A tight range matters more than anything else you choose. Compute zeta with this function in all passes. Its range is the same for the whole frame: peelnet_zeta_in(z, peelnet_range(near, far)) is the same value, and the range may be passed in.
// 1. Pass "range": draw all transparent surfaces, in any order. PeelnetBins bins = peelnet_bins(alpha, zeta);
//    bins_front: rgba8unorm, cleared to 0, blending ADD, from bins.front
//    bins_back: rgba8unorm, cleared to 0, blending ADD, from bins.back
// 2. Pass "statistics": draw all transparent surfaces, in any order. PeelnetStatistics s = peelnet_statistics(alpha, peelnet_in_pixel(zeta, bins_front, bins_back));
//    absorbances: rgba16float, cleared to 0, blending ADD, from s.absorbances
//    nearest: rgba16float, cleared to -65504, blending MAX, from s.nearest
//    farthest: rgba16float, cleared to -65504, blending MAX, from s.farthest
//    firsts: rgba16float, cleared to 0, blending ADD, from s.firsts
// 3. Pass "weights": draw all transparent surfaces, in any order. float w = peelnet_fragment(alpha, peelnet_in_pixel(zeta, bins_front, bins_back), absorbances, nearest, farthest, firsts).x;
//    sums: rgba16float, cleared to 0, blending ADD, from vec4(alpha * rgb, alpha) * w
// 4. Resolve: peelnet_resolve(sums, absorbances.x + absorbances.y + absorbances.z + absorbances.w, background) is the colour of the pixel, and its coverage in alpha.
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
struct PeelnetBins {
    vec4 front;
    vec4 back;
};
struct PeelnetStatistics {
    vec4 absorbances;
    vec4 nearest;
    vec4 farthest;
    vec4 firsts;
};
const float PEELNET_FAINT = 0.003921569;
const float PEELNET_LEAST_SEEN = 0.00390625;
const float PEELNET_BIN_LEVELS = 64.0;
const float PEELNET_BINS = 1920.0;
const float PEELNET_OPACITIES = 32.0;
const float PEELNET_EMPTY = -65504.0;
const float PEELNET_FIRST_END = 0.38;
const float PEELNET_SECOND_END = 0.685;
const float PEELNET_THIRD_END = 0.84;
const float PEELNET_LAST_SLAB = 3.0;


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

PeelnetBins peelnet_bins(float alpha_1, float zeta_1) {
    vec4 place_3 = vec4(clamp(((zeta_1 * 4.0) + 3.5), 0.0, 7.0));
    float _e10 = peelnet_absorbance(alpha_1);
    float level = max(floor(((_e10 * PEELNET_BIN_LEVELS) + 0.5)), 1.0);
    vec4 front_1 = max((vec4(1.0) - abs((place_3 - vec4(0.0, 1.0, 2.0, 3.0)))), vec4(0.0));
    vec4 back_1 = max((vec4(1.0) - abs((place_3 - vec4(4.0, 5.0, 6.0, 7.0)))), vec4(0.0));
    return PeelnetBins((floor(((level * front_1) + vec4(0.5))) / vec4(255.0)), (floor(((level * back_1) + vec4(0.5))) / vec4(255.0)));
}

vec4 peelnet_passing(float before, vec4 bins) {
    float two = (bins.x + bins.y);
    vec4 absorbances_2 = vec4(bins.x, two, (two + bins.z), ((two + bins.z) + bins.w));
    return exp(((vec4(before) + absorbances_2) * -3.984375));
}

vec4 peelnet_shares(vec4 before_1, vec4 behind, vec4 bins_1) {
    vec4 has_any = min((bins_1 * 255.0), vec4(1.0));
    return (sqrt(max((before_1 - behind), vec4(0.00390625))) * has_any);
}

float peelnet_in_pixel(float zeta_2, vec4 front, vec4 back) {
    float place_4 = ((zeta_2 * 4.0) + 4.0);
    vec4 none = vec4(0.0);
    vec4 one = vec4(1.0);
    vec4 _e12 = peelnet_passing(0.0, front);
    vec4 _e14 = peelnet_passing(dot(front, one), back);
    vec4 _e18 = peelnet_shares(vec4(1.0, _e12.xyz), _e12, front);
    vec4 _e22 = peelnet_shares(vec4(_e12.w, _e14.xyz), _e14, back);
    float passed_1 = (dot(_e18, clamp((vec4(place_4) - vec4(0.0, 1.0, 2.0, 3.0)), none, one)) + dot(_e22, clamp((vec4(place_4) - vec4(4.0, 5.0, 6.0, 7.0)), none, one)));
    float all_ = dot((_e18 + _e22), one);
    return ((all_ == 0.0) ? sqrt((place_4 * 0.125)) : min((passed_1 / max(all_, 1e-6)), 1.0));
}

float peelnet_of_slab(vec4 values, float slab) {
    return ((slab >= 2.0) ? ((slab == 3.0) ? values.w : values.z) : ((slab == 1.0) ? values.y : values.x));
}

PeelnetPlace peelnet_place(float alpha_2, float t) {
    float _e2 = peelnet_absorbance(alpha_2);
    float first_1 = ((t >= PEELNET_FIRST_END) ? 1.0 : 0.0);
    float passed_2 = ((first_1 + ((t >= PEELNET_SECOND_END) ? 1.0 : 0.0)) + ((t >= PEELNET_THIRD_END) ? 1.0 : 0.0));
    float slab_2 = min(passed_2, PEELNET_LAST_SLAB);
    float _e27 = peelnet_of_slab(vec4(0.0, 0.38, 0.685, 0.84), slab_2);
    float _e33 = peelnet_of_slab(vec4(0.38, 0.685, 0.84, 1.0), slab_2);
    float inside = ((t - _e27) / (_e33 - _e27));
    float bin_1 = min(floor((inside * PEELNET_BINS)), 1919.0);
    float opacity = floor((((_e2 / (_e2 + 1.0)) * 32.9375) + 0.5));
    float near_2 = (((1919.0 - bin_1) * PEELNET_OPACITIES) + opacity);
    return PeelnetPlace(_e2, slab_2, ((2.0 * inside) - 1.0), bin_1, near_2, ((bin_1 * PEELNET_OPACITIES) + opacity));
}

vec2 peelnet_records(float alpha_3, PeelnetPlace place) {
    vec3 _e6 = peelnet_halves(vec3(place.near, place.far, place.far));
    vec2 levels_3 = _e6.xy;
    return ((alpha_3 < PEELNET_FAINT) ? vec2(-65504.0) : levels_3);
}

vec2 peelnet_absorbances_of(vec2 levels_1) {
    vec2 share = ((levels_1 - (floor((levels_1 * 0.03125)) * PEELNET_OPACITIES)) * 0.032258064);
    return (share / (vec2(1.0625) - share));
}

float peelnet_middle_of(float bin) {
    return (((bin + 0.5) * 0.0010416667) - 1.0);
}

vec4 peelnet_in_slab(float value, float slab_1, float elsewhere) {
    return vec4(((slab_1 == 0.0) ? value : elsewhere), ((slab_1 == 1.0) ? value : elsewhere), ((slab_1 == 2.0) ? value : elsewhere), ((slab_1 == 3.0) ? value : elsewhere));
}

PeelnetBetween peelnet_between(PeelnetPlace place_1, float total, float first, vec2 levels_2) {
    bool local = false;
    bool local_1 = false;
    float begin = 0.0;
    float end = 0.0;
    float b = place_1.absorbance;
    float others = max((total - b), 0.0);
    float noise = max((total * 0.0009765625), 1e-6);
    float near_back = floor((levels_2.x * 0.03125));
    float near_bin = (1919.0 - near_back);
    float near_level = (levels_2.x + ((near_bin - near_back) * PEELNET_OPACITIES));
    vec2 _e23 = peelnet_absorbances_of(levels_2);
    bool all_1 = (_e23.x > (others - (((0.019354839 * (1.0 + _e23.x)) * (1.0 + _e23.x)) + noise)));
    float near_3 = ((near_bin > place_1.bin) ? 0.0 : (all_1 ? others : _e23.x));
    float far_bin = floor((levels_2.y * 0.03125));
    if (!((levels_2.y == near_level))) {
        local = (levels_2.y < 0.0);
    } else {
        local = true;
    }
    bool is_one = local;
    if (!(is_one)) {
        local_1 = (far_bin < place_1.bin);
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
    float moment = (((first - (b * place_1.inside)) - (near_3 * _e79)) - (far_2 * _e82));
    float _e85 = begin;
    float _e86 = begin;
    begin = ((_e86 > place_1.inside) ? -1.0 : _e85);
    float _e91 = end;
    float _e92 = end;
    end = ((_e92 < place_1.inside) ? 1.0 : _e91);
    float in_front = ((near_3 * ((near_bin == place_1.bin) ? 0.5 : 1.0)) + (far_2 * ((far_bin == place_1.bin) ? 0.5 : 0.0)));
    float _e110 = end;
    float _e111 = begin;
    float extent_1 = max((_e110 - _e111), 0.0010416667);
    float per_extent = (1.0 / extent_1);
    float _e118 = begin;
    float x = clamp(((place_1.inside - _e118) * per_extent), 0.0, 1.0);
    float _e126 = begin;
    float _e127 = end;
    float depth = clamp((moment / max(rest, noise)), _e126, _e127);
    float _e129 = begin;
    float mean = clamp(((depth - _e129) * per_extent), 0.0, 1.0);
    bool before_2 = (x < mean);
    float bound = ((before_2 ? (1.0 - mean) : (x - mean)) / max((before_2 ? (1.0 - x) : x), 1e-6));
    float low = (before_2 ? 0.0 : bound);
    float high = (before_2 ? bound : 1.0);
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

float peelnet_share(float root_absorbance, float place_fraction, float mean_fraction, float share_low, float share_high, float root_own, float half_extent, float of_own, float of_nearest) {
    vec4 input_a = vec4(root_absorbance, place_fraction, mean_fraction, share_low);
    vec4 input_b = vec4(share_high, root_own, half_extent, of_own);
    vec4 input_c = vec4(of_nearest, 0.0, 0.0, 0.0);
    vec4 layer_a_a = max((((vec4(3.2462375, -3.2699733, 2.0795698, 8.754615) + (mat4x4(vec4(0.03195625, 0.06991469, -0.11084325, 0.050414875), vec4(-1.1103786, 0.44438714, -2.7028003, -2.6733677), vec4(0.6288057, 0.13087533, 2.6067007, -0.48397854), vec4(-3.6312008, 3.8734055, -6.387105, 4.470367)) * input_a)) + (mat4x4(vec4(-0.9691928, 5.442423, -0.4443696, 0.7165438), vec4(0.43283042, -0.1484769, -0.84573996, -0.7849737), vec4(0.5805953, -0.1903229, 1.7457689, -0.23753698), vec4(-2.720782, -4.0996428, 0.90138376, -4.9847393)) * input_b)) + (vec4(-1.8213676, 0.116678245, -1.9264252, -2.9728286) * input_c.x)), vec4(0.0));
    vec4 layer_a_b = max((((vec4(10.510607, -3.8923492, 3.072055, 6.000249) + (mat4x4(vec4(-0.09647166, 0.20310876, -0.028520348, 0.0021476196), vec4(-2.9062073, 0.22728884, -3.1631322, 3.4483242), vec4(-4.67893, 4.058475, -2.4258206, -1.5965548), vec4(-6.36753, 5.93288, 0.41062704, -1.1512088)) * input_a)) + (mat4x4(vec4(-1.2040421, 0.76668143, -2.31968, -0.87386155), vec4(0.5476562, 0.57502145, -0.10347233, -2.3200312), vec4(-0.97067636, -1.7821109, -0.008641228, 1.2771134), vec4(-1.3998032, 0.182419, 0.1342523, -1.691575)) * input_b)) + (vec4(-1.8134261, -0.19351593, -0.058829058, -3.1290808) * input_c.x)), vec4(0.0));
    vec4 layer_a_c = max((((vec4(0.49121752, -9.50615, -2.9425182, 5.1307487) + (mat4x4(vec4(-0.06508959, 0.2179142, 0.25738588, 0.16194177), vec4(0.30774269, 0.5832492, -0.8073733, -1.8338085), vec4(0.819847, -1.8208967, -4.6793585, 2.1063526), vec4(-1.0088379, 1.1399693, -4.8758698, -3.7558901)) * input_a)) + (mat4x4(vec4(-1.8062855, 6.626333, 0.573116, -0.8338889), vec4(0.8915273, -0.21221328, 1.2831217, -0.5544597), vec4(-1.7439699, -1.3883057, -0.48767817, -3.5469673), vec4(-3.2215645, -1.8292199, 1.8131012, -2.175973)) * input_b)) + (vec4(4.4010983, 6.5133114, 2.5301306, 0.5209779) * input_c.x)), vec4(0.0));
    float layer_b_a = (1.0 / (1.0 + exp(min(-((((-0.92924744 + dot(vec4(-1.1672554, 1.4368079, -0.66805565, -0.59655744), layer_a_a)) + dot(vec4(0.56415296, 0.4231643, -2.3594532, 0.6463365), layer_a_b)) + dot(vec4(-0.26553136, 0.63752025, -0.7536124, -0.28365612), layer_a_c))), 80.0))));
    return layer_b_a;
}

float peelnet_network(PeelnetBetween between) {
    float _e24 = peelnet_share(sqrt(between.absorbance), between.place, between.mean, between.low, between.high, sqrt(between.own), between.extent, (between.absorbance / ((between.absorbance + between.own) + 1e-6)), (between.absorbance / ((between.absorbance + between.nearest) + 1e-6)));
    return _e24;
}

vec2 peelnet_weigh(PeelnetPlace place_2, bool counts, vec4 absorbances, vec4 firsts, vec4 nearest, vec4 farthest, float ends) {
    bool local_3 = false;
    bool local_4 = false;
    bool local_5 = false;
    bool local_6 = false;
    bool local_7 = false;
    vec4 sums_2 = min(absorbances, vec4(65504.0));
    float _e11 = peelnet_of_slab(sums_2, place_2.slab);
    float _e13 = peelnet_of_slab(firsts, place_2.slab);
    float first_2 = clamp(_e13, -65504.0, 65504.0);
    float _e18 = peelnet_of_slab(nearest, place_2.slab);
    float _e20 = peelnet_of_slab(farthest, place_2.slab);
    vec2 halves_1 = vec2(_e18, _e20);
    vec3 _e24 = peelnet_levels(vec3(halves_1, halves_1.y));
    vec2 decoded = _e24.xy;
    vec2 levels_4 = ((place_2.slab < ends) ? decoded : vec2(decoded.x, -1.0));
    float before_3 = ((((place_2.slab > 0.0) ? sums_2.x : 0.0) + ((place_2.slab > 1.0) ? sums_2.y : 0.0)) + ((place_2.slab > 2.0) ? sums_2.z : 0.0));
    if (counts) {
        bool _e56 = peelnet_is_kept(place_2.near, levels_4.x);
        local_3 = _e56;
    } else {
        local_3 = false;
    }
    bool is_near = local_3;
    if (counts) {
        local_4 = (levels_4.y >= 0.0);
    } else {
        local_4 = false;
    }
    bool _e65 = local_4;
    if (_e65) {
        bool _e70 = peelnet_is_kept(place_2.far, levels_4.y);
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
    PeelnetBetween _e83 = peelnet_between(place_2, _e11, first_2, levels_4);
    float _e88 = peelnet_network(_e83);
    float share_1 = (_e83.low + ((_e83.high - _e83.low) * _e88));
    float at_end = (is_far ? max((_e11 - place_2.absorbance), 0.0) : 0.0);
    float inside_1 = (known ? at_end : (_e83.nearest + (_e83.absorbance * share_1)));
    return vec2(exp(-((before_3 + inside_1))), (known ? 1.0 : 0.0));
}

PeelnetStatistics peelnet_statistics(float alpha_4, float t_1) {
    PeelnetPlace _e2 = peelnet_place(alpha_4, t_1);
    vec2 _e3 = peelnet_records(alpha_4, _e2);
    vec4 _e7 = peelnet_in_slab(_e2.absorbance, _e2.slab, 0.0);
    vec4 _e11 = peelnet_in_slab(_e3.x, _e2.slab, PEELNET_EMPTY);
    vec4 _e17 = peelnet_in_slab((_e2.absorbance * _e2.inside), _e2.slab, 0.0);
    vec4 _e21 = peelnet_in_slab(_e3.y, _e2.slab, PEELNET_EMPTY);
    return PeelnetStatistics(_e7, _e11, _e21, _e17);
}

vec2 peelnet_fragment(float alpha_5, float t_2, vec4 absorbances_1, vec4 nearest_1, vec4 farthest_1, vec4 firsts_1) {
    PeelnetPlace _e6 = peelnet_place(alpha_5, t_2);
    vec2 _e10 = peelnet_weigh(_e6, (alpha_5 >= PEELNET_FAINT), absorbances_1, firsts_1, nearest_1, farthest_1, 4.0);
    return _e10;
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

vec4 peelnet_resolve(vec4 sums_1, float absorbance, vec3 background_1) {
    float transmittance_1 = exp(-(absorbance));
    vec4 _e11 = peelnet_composite(min(sums_1, vec4(65504.0)), (1.0 - transmittance_1), vec3(transmittance_1), background_1);
    return _e11;
}

float peelnet_weight(float root_absorbance_1, float place_fraction_1, float mean_fraction_1, float share_low_1, float share_high_1, float root_own_1, float half_extent_1, float of_own_1, float of_nearest_1) {
    float root = clamp(root_absorbance_1, 0.0, 256.0);
    float _e39 = peelnet_share(clamp(root_absorbance_1, -40224.133, 40234.547), clamp(place_fraction_1, -2924.509, 2925.556), clamp(mean_fraction_1, -1657.5375, 1658.5785), clamp(share_low_1, -2087.3262, 2087.65), clamp(share_high_1, -2262.9114, 2264.5842), clamp(root_own_1, -5813.1367, 5814.793), clamp(half_extent_1, -2003.8801, 2005.4695), clamp(of_own_1, -1717.3046, 1719.1232), clamp(of_nearest_1, -1720.3542, 1722.1699));
    vec2 bounds = clamp(vec2(share_low_1, share_high_1), vec2(0.0), vec2(1.0));
    return exp(((-(root) * root) * mix(bounds.x, bounds.y, _e39)));
}
