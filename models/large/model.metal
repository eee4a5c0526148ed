// A learned weight for order-independent transparency. Exported by peelnet 0.1.0.
// Licence of this generated text: MIT OR Apache-2.0.
// Metal 2.4. No Metal compiler was at hand: this text was translated from WGSL that was compiled and run, and has not been compiled itself.
// Network: 9-12-1 (Relu hidden, Sigmoid last), 133 parameters, 120 multiply-adds. Recipe large, seed 1, 80 epochs.
// Answers: transmittance of what lies between a slab's known ends, exp(-absorbance * share) with absorbance = root_absorbance^2 and share in share_low .. share_high.
// Input 0: root_absorbance (root of the absorbance between the slab's ends), 0.0 .. 21.107838 in training.
// Input 1: place_fraction (of the way between the slab's ends), 0.0 .. 1.0 in training.
// Input 2: mean_fraction (of the way between the slab's ends), 0.0 .. 1.0 in training.
// Input 3: share_low (of the absorbance between the slab's ends), 0.0 .. 1.0 in training.
// Input 4: share_high (of the absorbance between the slab's ends), 0.0 .. 1.0 in training.
// Input 5: root_own (root of the fragment's absorbance), 0.031630483 .. 2.4013393 in training.
// Input 6: half_extent (half of the way between the slab's ends, in slabs), 0.00052083336 .. 1.0 in training.
// Input 7: of_own (absorbance between the ends, of that and the fragment's), 0.0 .. 0.9999906 in training.
// Input 8: of_nearest (absorbance between the ends, of that and the nearer end's), 0.0 .. 1.0 in training.
// Trained on 21565798 rows of boxes, cups, foliage, intersecting, opaque-mix, panes, sixteen-025, sixteen-050, sixteen-075, sixteen-085, sixteen-random-alpha, sixteen-random-color, smoke-100, smoke-30, synthetic (dataset f0e6c4a7cca08d560f99a5be9cbd1514bf8be352632a347602bf08363695fd29+e22e844788a454658277e87e23685b5ffa00e3ad2d48cb833cc53130eaf4d8b7).
// Loss: training 0.000105, validation 0.000098, test 0.000103.
// Held-out error, mean |T - T_exact|: boxes-held 0.00160, cups-held 0.00136, foliage-held 0.00038, panes-held 0.00009, sixteen-held 0.00023, smoke-held 0.00333.
//
// Self-tests, to some roundings of 32 bits; weights and colours also to those of 16-bit targets.
// peelnet_weight(0.2954644, 0.13589168, 0.26682287, 0.7078695, 0.5534122, 0.8413221, 0.6951227, 0.3716183, 0.9624051) = 0.945929
// peelnet_weight(2.6873326, 0.2162394, 0.7240006, 0.37958002, 0.26558614, 1.9607327, 0.5804378, 0.90978944, 0.04841405) = 0.065241195
// peelnet_weight(1.176659, 0.55773175, 0.41844797, 0.7173642, 0.44993675, 1.6151378, 0.48404527, 0.3332267, 0.6325573) = 0.41662478
// Four fragments of a pixel, near 1.0, far 8.0, background 0.25, 0.5, 0.75:
//    z 1.0, alpha 0.5, rgb 1.0, 0.0, 0.0: zeta -1.0, weight 1.0
//    z 2.0, alpha 0.5, rgb 0.0, 1.0, 0.0: zeta -0.33333334, weight 0.5
//    z 4.0, alpha 0.5, rgb 0.0, 0.0, 1.0: zeta 0.33333334, weight 0.25
//    z 8.0, alpha 0.9, rgb 1.0, 1.0, 1.0: zeta 1.0, weight 0.125
//    target bins_front: 0.17254902, 0.0, 0.14509805, 0.02745098
//    target bins_back: 0.02745098, 0.14509805, 0.0, 0.5764706
//    target range: 1.0, 1.0
//    target absorbances: 0.6931472, 0.6931472, 0.6931472, 2.302585
//    target nearest: 64928.0, 0.0072517395, 0.033599854, -64768.0
//    target farthest: -65088.0, -0.007270813, -0.03375244, 65248.0
//    target firsts: -0.6931472, -0.15837766, -0.20979747, 2.302585
//    colour of the pixel: 0.615625, 0.36875, 0.246875
//
// How to draw with it. Targets may have 32 bits a channel wherever 16 are named.
// 0. zeta = peelnet_zeta(z, near, far): z is the distance along the view axis, near and far the range of z that the bounding boxes of the transparent objects in view span, clipped to the camera's. A tight range matters more than anything else you choose. Compute zeta with this function in all passes. Its range is the same for the whole frame: peelnet_zeta_in(z, peelnet_range(near, far)) is the same value, and the range may be passed in. Where boxes show that nothing lies between two depths, use peelnet_cut(zeta, gaps) for zeta in all passes: it leaves up to two such gaps out.
// 1. Pass "range": draw all transparent surfaces, in any order. PeelnetBins bins = peelnet_bins(alpha, zeta);
//    bins_front: rgba8unorm, cleared to 0, blending ADD, from bins.front
//    bins_back: rgba8unorm, cleared to 0, blending ADD, from bins.back
//    range: rg8unorm, cleared to 0, blending MAX, from bins.range
// 2. Pass "statistics": draw all transparent surfaces, in any order. PeelnetStatistics s = peelnet_statistics(alpha, peelnet_in_pixel(zeta, bins_front, bins_back, range));
//    absorbances: rgba16float, cleared to 0, blending ADD, from s.absorbances
//    nearest: rgba16float, cleared to -65504, blending MAX, from s.nearest
//    farthest: rgba16float, cleared to -65504, blending MAX, from s.farthest
//    firsts: rgba16float, cleared to 0, blending ADD, from s.firsts
// 3. Pass "weights": draw all transparent surfaces, in any order. float w = peelnet_fragment(alpha, peelnet_in_pixel(zeta, bins_front, bins_back, range), absorbances, nearest, farthest, firsts).x;
//    sums: rgba16float, cleared to 0, blending ADD, from float4(alpha * rgb, alpha) * w
// 4. Resolve: peelnet_resolve(sums, absorbances.x + absorbances.y + absorbances.z + absorbances.w, background) is the colour of the pixel, and its coverage in alpha.
// - alpha is opacity, rgb the linear colour that is not multiplied by it. Resolve before tone mapping and encoding.
// - Test depth against the opaque surfaces, do not write it: a depth prepass with transparent surfaces in it hides what lies behind.
// - z grows with distance, also where depth buffers are reversed.
// - With multisampling, gather and resolve the statistics per sample: averaged samples of them mean nothing.

// language: metal2.4
#include <metal_stdlib>
#include <simd/simd.h>

using metal::uint;

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
    metal::float4 front;
    metal::float4 back;
    metal::float2 range;
    char _pad3[8];
};
struct PeelnetStatistics {
    metal::float4 absorbances;
    metal::float4 nearest;
    metal::float4 farthest;
    metal::float4 firsts;
};
constant float PEELNET_BIN_LEVELS = 64.0;
constant float PEELNET_FAINT = 0.003921569;
constant float PEELNET_BINS = 1920.0;
constant float PEELNET_OPACITIES = 32.0;
constant float PEELNET_EMPTY = -65504.0;
constant float PEELNET_FIRST_END = 0.34;
constant float PEELNET_SECOND_END = 0.68;
constant float PEELNET_THIRD_END = 0.87;
constant float PEELNET_LAST_SLAB = 3.0;

PeelnetRange peelnet_range(
    float near,
    float far
) {
    bool linear = near <= 0.0;
    float inverse_near = linear ? 0.0 : (1.0 / metal::max(near, 0.000000000000000000000000000000000000011754944));
    float extent = linear ? (far - near) : metal::log(metal::max(far * inverse_near, 1.0));
    bool flat = extent <= (linear ? 0.0 : 0.000001);
    return PeelnetRange {inverse_near, near, flat ? 0.0 : (2.0 / metal::max(extent, 0.000000000000000000000000000001))};
}

float peelnet_zeta_in(
    float z,
    PeelnetRange range
) {
    float logarithmic = metal::log(metal::max(z * range.inverse_near, 1.0));
    float from_near = (range.inverse_near == 0.0) ? (z - range.near) : logarithmic;
    return metal::clamp((from_near * range.scale) - 1.0, -1.0, 1.0);
}

float peelnet_zeta(
    float z_1,
    float near_1,
    float far_1
) {
    PeelnetRange _e3 = peelnet_range(near_1, far_1);
    float _e4 = peelnet_zeta_in(z_1, _e3);
    return _e4;
}

float peelnet_absorbance(
    float alpha
) {
    return -(metal::log(metal::max(1.0 - alpha, 0.00000011253517)));
}

metal::int3 naga_f2i32(metal::float3 value) {
    return static_cast<metal::int3>(metal::clamp(value, -2147483600.0, 2147483500.0));
}

metal::float3 peelnet_halves(
    metal::float3 levels
) {
    metal::float3 from_middle = levels - metal::float3(30719.5);
    return metal::sign(from_middle) * as_type<metal::float3>(naga_f2i32((metal::abs(from_middle) * 8192.0) + metal::float3(947908600.0)));
}

metal::float3 peelnet_levels(
    metal::float3 halves
) {
    metal::float3 from_middle_1 = (static_cast<metal::float3>(as_type<metal::int3>(metal::abs(halves))) * 0.00012207031) - metal::float3(115711.5);
    return metal::float3(30719.5) + (metal::sign(halves) * from_middle_1);
}

float peelnet_cut(
    float zeta,
    metal::float4 gaps
) {
    metal::float2 lengths = gaps.yw - gaps.xz;
    metal::float2 passed = metal::clamp(metal::float2(zeta) - gaps.xz, metal::float2(0.0), lengths);
    float kept_1 = ((zeta + 1.0) - passed.x) - passed.y;
    return (kept_1 * (2.0 / ((2.0 - lengths.x) - lengths.y))) - 1.0;
}

float peelnet_level(
    float absorbance
) {
    return metal::max(metal::floor((absorbance * PEELNET_BIN_LEVELS) + 0.5), 1.0);
}

metal::float4 peelnet_in_bins(
    float level,
    float place,
    float first
) {
    metal::float4 middles = metal::float4(first, first + 1.0, first + 2.0, first + 3.0);
    metal::float4 shares = metal::max(metal::float4(1.0) - metal::abs(metal::float4(place) - middles), metal::float4(0.0));
    return metal::floor((level * shares) + metal::float4(0.5)) / metal::float4(255.0);
}

metal::float4 peelnet_seen_behind(
    float before,
    metal::float4 bins
) {
    float two = bins.x + bins.y;
    metal::float4 levels_3 = metal::float4(before) + metal::float4(bins.x, two, two + bins.z, (two + bins.z) + bins.w);
    return metal::exp(levels_3 * -3.984375);
}

metal::float2 peelnet_range_of(
    float zeta_1
) {
    float level_1 = 127.5 * (zeta_1 + 1.0);
    return metal::float2(255.0 - metal::floor(level_1), metal::ceil(level_1)) / metal::float2(255.0);
}

metal::float2 peelnet_ends_of(
    metal::float2 range_1
) {
    metal::float2 levels_4 = metal::floor((range_1 * 255.0) + metal::float2(0.5));
    float nearest_2 = 255.0 - levels_4.x;
    return metal::float2(nearest_2, metal::max(levels_4.y, nearest_2 + 1.0));
}

PeelnetBins peelnet_bins(
    float alpha_1,
    float zeta_2
) {
    float place_5 = metal::clamp((zeta_2 * 4.0) + 3.5, 0.0, 7.0);
    float _e9 = peelnet_absorbance(alpha_1);
    float _e10 = peelnet_level(_e9);
    metal::float4 _e12 = peelnet_in_bins(_e10, place_5, 0.0);
    metal::float4 _e14 = peelnet_in_bins(_e10, place_5, 4.0);
    metal::float2 _e15 = peelnet_range_of(zeta_2);
    return PeelnetBins {_e12, _e14, _e15};
}

float peelnet_up_to(
    float place_1,
    metal::float4 front,
    metal::float4 back
) {
    metal::float4 a = metal::abs(metal::float4(place_1) - metal::float4(0.0, 1.0, 2.0, 3.0));
    metal::float4 b = metal::abs(metal::float4(place_1) - metal::float4(4.0, 5.0, 6.0, 7.0));
    return metal::dot(front, a - metal::float4(a.yzw, b.x)) + metal::dot(back, b - metal::float4(b.yzw, metal::abs(place_1 - 8.0)));
}

float peelnet_in_pixel(
    float zeta_3,
    metal::float4 front_1,
    metal::float4 back_1,
    metal::float2 range_2
) {
    float place_6 = (zeta_3 * 4.0) + 4.0;
    metal::float4 _e9 = peelnet_seen_behind(0.0, front_1);
    metal::float4 _e13 = peelnet_seen_behind(metal::dot(front_1, metal::float4(1.0)), back_1);
    metal::float4 of_front = metal::sqrt(metal::abs(metal::float4(1.0, _e9.xyz) - _e9));
    metal::float4 of_back = metal::sqrt(metal::abs(metal::float4(_e9.w, _e13.xyz) - _e13));
    metal::float2 _e26 = peelnet_ends_of(range_2);
    metal::float2 ends_1 = _e26 * 0.03137255;
    float _e30 = peelnet_up_to(ends_1.x, of_front, of_back);
    float _e32 = peelnet_up_to(ends_1.y, of_front, of_back);
    float all = _e32 - _e30;
    float _e34 = peelnet_up_to(place_6, of_front, of_back);
    float passed_1 = (_e34 - _e30) / metal::max(all, 0.000001);
    return (all == 0.0) ? metal::sqrt(place_6 * 0.125) : metal::clamp(passed_1, 0.0, 1.0);
}

float peelnet_of_slab(
    metal::float4 values,
    float slab
) {
    return (slab >= 2.0) ? ((slab == 3.0) ? values.w : values.z) : ((slab == 1.0) ? values.y : values.x);
}

PeelnetPlace peelnet_place(
    float alpha_2,
    float t
) {
    float _e2 = peelnet_absorbance(alpha_2);
    float first_2 = (t >= PEELNET_FIRST_END) ? 1.0 : 0.0;
    float passed_2 = (first_2 + ((t >= PEELNET_SECOND_END) ? 1.0 : 0.0)) + ((t >= PEELNET_THIRD_END) ? 1.0 : 0.0);
    float slab_2 = metal::min(passed_2, PEELNET_LAST_SLAB);
    float _e27 = peelnet_of_slab(metal::float4(0.0, 0.34, 0.68, 0.87), slab_2);
    float _e33 = peelnet_of_slab(metal::float4(0.34, 0.68, 0.87, 1.0), slab_2);
    float inside = (t - _e27) / (_e33 - _e27);
    float bin_1 = metal::min(metal::floor(inside * PEELNET_BINS), 1919.0);
    float opacity = metal::floor(((_e2 / (_e2 + 1.0)) * 32.9375) + 0.5);
    float near_2 = ((1919.0 - bin_1) * PEELNET_OPACITIES) + opacity;
    return PeelnetPlace {_e2, slab_2, (2.0 * inside) - 1.0, bin_1, near_2, (bin_1 * PEELNET_OPACITIES) + opacity};
}

metal::float2 peelnet_records(
    float alpha_3,
    PeelnetPlace place_2
) {
    metal::float3 _e6 = peelnet_halves(metal::float3(place_2.near, place_2.far, place_2.far));
    metal::float2 levels_5 = _e6.xy;
    return (alpha_3 < PEELNET_FAINT) ? metal::float2(-65504.0) : levels_5;
}

metal::float2 peelnet_absorbances_of(
    metal::float2 levels_1
) {
    metal::float2 share = (levels_1 - (metal::floor(levels_1 * 0.03125) * PEELNET_OPACITIES)) * 0.032258064;
    return share / (metal::float2(1.0625) - share);
}

float peelnet_middle_of(
    float bin
) {
    return ((bin + 0.5) * 0.0010416667) - 1.0;
}

metal::float4 peelnet_in_slab(
    float value,
    float slab_1,
    float elsewhere
) {
    return metal::float4((slab_1 == 0.0) ? value : elsewhere, (slab_1 == 1.0) ? value : elsewhere, (slab_1 == 2.0) ? value : elsewhere, (slab_1 == 3.0) ? value : elsewhere);
}

PeelnetBetween peelnet_between(
    PeelnetPlace place_3,
    float total,
    float first_1,
    metal::float2 levels_2
) {
    bool local = {};
    bool local_1 = {};
    float begin = {};
    float end = {};
    float b_1 = place_3.absorbance;
    float others = metal::max(total - b_1, 0.0);
    float noise = metal::max(total * 0.0009765625, 0.000001);
    float near_back = metal::floor(levels_2.x * 0.03125);
    float near_bin = 1919.0 - near_back;
    float near_level = levels_2.x + ((near_bin - near_back) * PEELNET_OPACITIES);
    metal::float2 _e23 = peelnet_absorbances_of(levels_2);
    bool all_1 = _e23.x > (others - (((0.019354839 * (1.0 + _e23.x)) * (1.0 + _e23.x)) + noise));
    float near_3 = (near_bin > place_3.bin) ? 0.0 : (all_1 ? others : _e23.x);
    float far_bin = metal::floor(levels_2.y * 0.03125);
    if (!((levels_2.y == near_level))) {
        local = levels_2.y < 0.0;
    } else {
        local = true;
    }
    bool is_one = local;
    if (!(is_one)) {
        local_1 = far_bin < place_3.bin;
    } else {
        local_1 = true;
    }
    bool _e64 = local_1;
    float far_2 = _e64 ? 0.0 : _e23.y;
    float _e67 = peelnet_middle_of(near_bin);
    begin = _e67;
    float _e69 = peelnet_middle_of(far_bin);
    end = is_one ? 1.0 : _e69;
    float rest = ((total - b_1) - near_3) - far_2;
    float _e79 = begin;
    float _e82 = end;
    float moment = ((first_1 - (b_1 * place_3.inside)) - (near_3 * _e79)) - (far_2 * _e82);
    float _e85 = begin;
    float _e86 = begin;
    begin = (_e86 > place_3.inside) ? -1.0 : _e85;
    float _e91 = end;
    float _e92 = end;
    end = (_e92 < place_3.inside) ? 1.0 : _e91;
    float in_front = (near_3 * ((near_bin == place_3.bin) ? 0.5 : 1.0)) + (far_2 * ((far_bin == place_3.bin) ? 0.5 : 0.0));
    float _e110 = end;
    float _e111 = begin;
    float extent_1 = metal::max(_e110 - _e111, 0.0010416667);
    float per_extent = 1.0 / extent_1;
    float _e118 = begin;
    float x = metal::clamp((place_3.inside - _e118) * per_extent, 0.0, 1.0);
    float _e126 = begin;
    float _e127 = end;
    float depth = metal::clamp(moment / metal::max(rest, noise), _e126, _e127);
    float _e129 = begin;
    float mean = metal::clamp((depth - _e129) * per_extent, 0.0, 1.0);
    bool before_1 = x < mean;
    float bound = (before_1 ? (1.0 - mean) : (x - mean)) / metal::max(before_1 ? (1.0 - x) : x, 0.000001);
    float low = before_1 ? 0.0 : bound;
    float high = before_1 ? bound : 1.0;
    return PeelnetBetween {metal::max(rest, 0.0), x, mean, low, high, 0.5 * extent_1, b_1, in_front};
}

bool peelnet_is_kept(
    float own,
    float kept
) {
    bool local_2 = {};
    float apart = metal::abs(own - kept);
    if (!((apart == 0.0))) {
        local_2 = apart == PEELNET_OPACITIES;
    } else {
        local_2 = true;
    }
    bool _e12 = local_2;
    return _e12;
}

float peelnet_share(
    float root_absorbance,
    float place_fraction,
    float mean_fraction,
    float share_low,
    float share_high,
    float root_own,
    float half_extent,
    float of_own,
    float of_nearest
) {
    metal::float4 input_a = metal::float4(root_absorbance, place_fraction, mean_fraction, share_low);
    metal::float4 input_b = metal::float4(share_high, root_own, half_extent, of_own);
    metal::float4 input_c = metal::float4(of_nearest, 0.0, 0.0, 0.0);
    metal::float4 layer_a_a = metal::max(((metal::float4(2.5333376, 0.070135444, 6.55761, 9.338499) + (metal::float4x4(metal::float4(0.06938627, -0.18546443, -0.16126896, -0.0978224), metal::float4(-2.8618555, 1.1962174, -2.2454934, -1.967748), metal::float4(-1.3940566, -3.5056498, -1.1702229, -1.1813458), metal::float4(-1.0886809, -0.014783437, -3.0635908, -1.4621649)) * input_a)) + (metal::float4x4(metal::float4(-0.6980536, 1.7846111, 0.25155202, -0.0022205736), metal::float4(-0.17082416, -0.13570544, 0.13718012, -0.7164993), metal::float4(-0.059486482, 1.4970536, -1.5278703, -3.0911248), metal::float4(-0.45216277, 0.646417, -0.11476041, -1.99819)) * input_b)) + (metal::float4(-0.2150367, 0.05851872, -1.1947396, -1.0811282) * input_c.x), metal::float4(0.0));
    metal::float4 layer_a_b = metal::max(((metal::float4(8.595566, -2.1603658, -4.6171513, 4.446983) + (metal::float4x4(metal::float4(0.046490982, -0.021122804, -0.0967739, -0.05729483), metal::float4(-2.5474672, 1.0714152, -1.9551623, 2.394742), metal::float4(-5.0801864, 3.263625, -0.07937207, -2.860324), metal::float4(-4.577743, 1.0223571, 6.441565, 4.304795)) * input_a)) + (metal::float4x4(metal::float4(-2.6261086, 1.7954695, 1.8110046, 0.93702084), metal::float4(0.53599936, 0.5783657, 0.38734752, -1.5262477), metal::float4(-1.0452762, -3.8572392, 2.4509215, -1.5024484), metal::float4(-0.32625282, 0.08800727, 4.724238, -0.42166162)) * input_b)) + (metal::float4(0.3956092, -0.30297762, -2.0267947, -1.7356248) * input_c.x), metal::float4(0.0));
    metal::float4 layer_a_c = metal::max(((metal::float4(4.4543576, -2.973365, -7.652848, 0.42543393) + (metal::float4x4(metal::float4(0.029131893, 0.18631081, 0.13666841, 0.16539651), metal::float4(-0.26469445, 1.1132456, 0.82761866, -1.2643151), metal::float4(-0.783623, -0.6680362, -1.178817, 0.2704268), metal::float4(-1.805566, 0.664728, -5.7957106, -4.446497)) * input_a)) + (metal::float4x4(metal::float4(-2.092326, 5.091627, 1.0575033, -2.1673481), metal::float4(0.5481401, -0.061678205, 1.246126, -0.46817154), metal::float4(1.2582825, 0.33472043, 0.6918554, 1.199201), metal::float4(-3.7064905, -4.3939705, 3.915088, -4.182435)) * input_b)) + (metal::float4(-1.6668515, -0.2672489, 2.1147249, 4.4725013) * input_c.x), metal::float4(0.0));
    float layer_b_a = 1.0 / (1.0 + metal::exp(metal::min(-((((-0.5501553 + metal::dot(metal::float4(-1.4394537, 0.49696675, -0.45589456, -0.36356), layer_a_a)) + metal::dot(metal::float4(0.51607615, 0.32655874, -0.5143021, 0.58047265), layer_a_b)) + metal::dot(metal::float4(-0.9152549, 1.665513, -0.56657845, -0.7014192), layer_a_c))), 80.0)));
    return layer_b_a;
}

float peelnet_network(
    PeelnetBetween between
) {
    float _e24 = peelnet_share(metal::sqrt(between.absorbance), between.place, between.mean, between.low, between.high, metal::sqrt(between.own), between.extent, between.absorbance / ((between.absorbance + between.own) + 0.000001), between.absorbance / ((between.absorbance + between.nearest) + 0.000001));
    return _e24;
}

metal::float2 peelnet_weigh(
    PeelnetPlace place_4,
    bool counts,
    metal::float4 absorbances,
    metal::float4 firsts,
    metal::float4 nearest,
    metal::float4 farthest,
    float ends
) {
    bool local_3 = {};
    bool local_4 = {};
    bool local_5 = {};
    bool local_6 = {};
    bool local_7 = {};
    metal::float4 sums_2 = metal::min(absorbances, metal::float4(65504.0));
    float _e11 = peelnet_of_slab(sums_2, place_4.slab);
    float _e13 = peelnet_of_slab(firsts, place_4.slab);
    float first_3 = metal::clamp(_e13, -65504.0, 65504.0);
    float _e18 = peelnet_of_slab(nearest, place_4.slab);
    float _e20 = peelnet_of_slab(farthest, place_4.slab);
    metal::float2 halves_1 = metal::float2(_e18, _e20);
    metal::float3 _e24 = peelnet_levels(metal::float3(halves_1, halves_1.y));
    metal::float2 decoded = _e24.xy;
    metal::float2 levels_6 = (place_4.slab < ends) ? decoded : metal::float2(decoded.x, -1.0);
    float before_2 = (((place_4.slab > 0.0) ? sums_2.x : 0.0) + ((place_4.slab > 1.0) ? sums_2.y : 0.0)) + ((place_4.slab > 2.0) ? sums_2.z : 0.0);
    if (counts) {
        bool _e56 = peelnet_is_kept(place_4.near, levels_6.x);
        local_3 = _e56;
    } else {
        local_3 = false;
    }
    bool is_near = local_3;
    if (counts) {
        local_4 = levels_6.y >= 0.0;
    } else {
        local_4 = false;
    }
    bool _e65 = local_4;
    if (_e65) {
        bool _e70 = peelnet_is_kept(place_4.far, levels_6.y);
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
    PeelnetBetween _e83 = peelnet_between(place_4, _e11, first_3, levels_6);
    float _e88 = peelnet_network(_e83);
    float share_1 = _e83.low + ((_e83.high - _e83.low) * _e88);
    float at_end = is_far ? metal::max(_e11 - place_4.absorbance, 0.0) : 0.0;
    float inside_1 = known ? at_end : (_e83.nearest + (_e83.absorbance * share_1));
    return metal::float2(metal::exp(-((before_2 + inside_1))), known ? 1.0 : 0.0);
}

PeelnetStatistics peelnet_statistics(
    float alpha_4,
    float t_1
) {
    PeelnetPlace _e2 = peelnet_place(alpha_4, t_1);
    metal::float2 _e3 = peelnet_records(alpha_4, _e2);
    metal::float4 _e7 = peelnet_in_slab(_e2.absorbance, _e2.slab, 0.0);
    metal::float4 _e11 = peelnet_in_slab(_e3.x, _e2.slab, PEELNET_EMPTY);
    metal::float4 _e17 = peelnet_in_slab(_e2.absorbance * _e2.inside, _e2.slab, 0.0);
    metal::float4 _e21 = peelnet_in_slab(_e3.y, _e2.slab, PEELNET_EMPTY);
    return PeelnetStatistics {_e7, _e11, _e21, _e17};
}

metal::float2 peelnet_fragment(
    float alpha_5,
    float t_2,
    metal::float4 absorbances_1,
    metal::float4 nearest_1,
    metal::float4 farthest_1,
    metal::float4 firsts_1
) {
    PeelnetPlace _e6 = peelnet_place(alpha_5, t_2);
    metal::float2 _e10 = peelnet_weigh(_e6, alpha_5 >= PEELNET_FAINT, absorbances_1, firsts_1, nearest_1, farthest_1, 4.0);
    return _e10;
}

metal::float4 peelnet_composite(
    metal::float4 sums,
    float coverage,
    metal::float3 transmittance,
    metal::float3 background
) {
    bool local_8 = {};
    if (sums.w > 0.0) {
        local_8 = coverage > 0.0;
    } else {
        local_8 = false;
    }
    bool _e20 = local_8;
    metal::float3 average = _e20 ? (sums.xyz / metal::float3(metal::max(sums.w, 0.000000000000000000000000000000000000011754944))) : metal::float3(0.0);
    return metal::float4((average * coverage) + (background * transmittance), coverage);
}

metal::float4 peelnet_resolve(
    metal::float4 sums_1,
    float absorbance_1,
    metal::float3 background_1
) {
    float transmittance_1 = metal::exp(-(absorbance_1));
    metal::float4 _e11 = peelnet_composite(metal::min(sums_1, metal::float4(65504.0)), 1.0 - transmittance_1, metal::float3(transmittance_1), background_1);
    return _e11;
}

float peelnet_weight(
    float root_absorbance_1,
    float place_fraction_1,
    float mean_fraction_1,
    float share_low_1,
    float share_high_1,
    float root_own_1,
    float half_extent_1,
    float of_own_1,
    float of_nearest_1
) {
    float root = metal::clamp(root_absorbance_1, 0.0, 256.0);
    float _e39 = peelnet_share(metal::clamp(root_absorbance_1, -46650.96, 46662.758), metal::clamp(place_fraction_1, -3139.3584, 3140.751), metal::clamp(mean_fraction_1, -2176.8862, 2178.2773), metal::clamp(share_low_1, -1791.4802, 1791.7402), metal::clamp(share_high_1, -2751.7651, 2753.417), metal::clamp(root_own_1, -5687.959, 5689.5596), metal::clamp(half_extent_1, -2164.8708, 2166.4324), metal::clamp(of_own_1, -1736.1511, 1737.9824), metal::clamp(of_nearest_1, -1725.541, 1727.3652));
    metal::float2 bounds = metal::clamp(metal::float2(share_low_1, share_high_1), metal::float2(0.0), metal::float2(1.0));
    return metal::exp((-(root) * root) * metal::mix(bounds.x, bounds.y, _e39));
}
