// A learned weight for order-independent transparency. Exported by peelnet 0.1.0.
// Licence of this generated text: MIT OR Apache-2.0.
// Metal 2.4. No Metal compiler was at hand: this text was translated from WGSL that was compiled and run, and has not been compiled itself.
// Network: 9-12-1 (Relu hidden, Sigmoid last), 133 parameters, 120 multiply-adds. Recipe one-wide, seed 1, 40 epochs.
// Answers: transmittance of the rest, exp(-rest * share) with rest = root_absorbance^2 and share in 0 .. 1.
// Input 0: root_absorbance (root of twice the absorbance in front, by the formula), 0.0000018556286 .. 21.501703 in training.
// Input 1: root_total (root of the absorbance of all sums), 0.028912654 .. 21.521168 in training.
// Input 2: share_before (of the absorbance of all sums), 0.0 .. 1.0 in training.
// Input 3: share_own (of the absorbance of all sums), 1.9267228e-14 .. 1.0 in training.
// Input 4: share_previous (of the absorbance of all sums), 0.0 .. 0.99244475 in training.
// Input 5: share_next (of the absorbance of all sums), 0.0 .. 0.9998849 in training.
// Input 6: nearest_alpha (1), 0.0007731032 .. 0.99905795 in training.
// Input 7: nearest_place (among the quantiles), 0.00012485312 .. 0.99942017 in training.
// Input 8: number (0 for the first, 1 for the last sum), 0.0 .. 1.0 in training.
// Trained on boxes, cups, foliage, intersecting, opaque-mix, panes, sixteen-025, sixteen-050, sixteen-075, sixteen-085, sixteen-random-alpha, sixteen-random-color, smoke-100, smoke-30, synthetic, of a dataset of 21565798 rows (f0e6c4a7cca08d560f99a5be9cbd1514bf8be352632a347602bf08363695fd29+e22e844788a454658277e87e23685b5ffa00e3ad2d48cb833cc53130eaf4d8b7).
// Loss: training 0.000413, validation 0.000399, test 0.000419.
// Held-out error, mean |T - T_exact|: boxes-held 0.01369, cups-held 0.01177, foliage-held 0.01188, panes-held 0.00442, sixteen-held 0.01003, smoke-held 0.01131.
//
// Self-tests, to some roundings of 32 bits; weights and colours also to those of 16-bit targets.
// peelnet_weight(0.48905447, 14.447163, 0.16887921, 0.7373583, 0.1906375, 0.034299895, 0.12910137, 0.435657, 0.7663156) = 0.78799194
// peelnet_weight(0.72185737, 19.51733, 0.6035249, 0.06334585, 0.067343876, 0.58069897, 0.2156773, 0.5069676, 0.19226718) = 0.6567044
// peelnet_weight(0.3009795, 2.949531, 0.26682287, 0.7078695, 0.54923105, 0.3416447, 0.69454503, 0.37148476, 0.9624051) = 0.9133934
// Four fragments of a pixel, near 1.0, far 8.0, background 0.25, 0.5, 0.75:
//    z 1.0, alpha 0.5, rgb 1.0, 0.0, 0.0: zeta -1.0, weight 1.0
//    z 2.0, alpha 0.5, rgb 0.0, 1.0, 0.0: zeta -0.33333334, weight 0.51124465
//    z 4.0, alpha 0.5, rgb 0.0, 0.0, 1.0: zeta 0.33333334, weight 0.26946592
//    z 8.0, alpha 0.9, rgb 1.0, 1.0, 1.0: zeta 1.0, weight 0.10838507
//    colour of the pixel: 0.6135939, 0.3594189, 0.24165452
//
// How to draw with it. Targets may have 32 bits a channel wherever 16 are named.
// 0. zeta = peelnet_zeta(z, near, far): z is the distance along the view axis, near and far the range of z that the bounding boxes of the transparent objects in view span, clipped to the camera's. The tighter the range, the less errs. Compute zeta with this function in all passes. Its range is the same for the whole frame: peelnet_zeta_in(z, peelnet_range(near, far)) is the same value, and the range may be passed in. Where boxes show that nothing lies between two depths, use peelnet_cut(zeta, gaps) for zeta in all passes: it leaves up to two such gaps out. quantiles says where among the depths around the pixel most is seen: peelnet_even() where nothing is known but near and far, with several times the error. noise is any number in 0 .. 1 that is the same for all of a pixel, such as peelnet_noise(pixel): it hides the steps of what is kept of the nearest fragment; 0.5 where that does not matter.
//    quantiles: rgba8unorm, a texture of one texel for 8 by 8 pixels, read with linear interpolation; peelnet_even() where it is not drawn.
//    At its size, draw all transparent surfaces, in any order. float4x4 bins = peelnet_tile_bins(alpha, zeta);
//    bins_a: rgba8unorm, cleared to 0, blending ADD, from bins[0]
//    bins_b: rgba8unorm, cleared to 0, blending ADD, from bins[1]
//    bins_c: rgba8unorm, cleared to 0, blending ADD, from bins[2]
//    bins_d: rg8unorm, cleared to 0, blending ADD, from bins[3].xy
//    bins_e: rg8unorm, cleared to 0, blending ADD, from bins[3].zw
//    tile_nearest: r16float, cleared to -65504, blending MAX, from peelnet_tile_nearest(alpha, zeta)
//    Then each of its texels is peelnet_quantiles(sum): sum adds, over the 3 by 3 texels around it, peelnet_tile_seen(float4x4(bins_a, bins_b, bins_c, float4(bins_d, bins_e)), tile_nearest).
//    Or make it without that pass from what the last frame kept of the pixel in the middle of each of them, of peelnet_last_seen(sum_a, sum_b, sum_c, sum_d, sum_e, sum_f, absorbances, absorbances_back, quantiles, noise), but for the first frame and after jumps of the camera.
// 1. Pass "gather": draw all transparent surfaces, in any order. PeelnetStatistics s = peelnet_statistics(alpha, rgb, zeta, quantiles, noise);
//    sum_a: rgba16float, cleared to 0, 0, 0, -65504, blending ADD for rgb, MAX for alpha, from s.sum_a
//    sum_b: rgba16float, cleared to 0, 0, 0, -65504, blending ADD for rgb, MAX for alpha, from s.sum_b
//    sum_c: rgba16float, cleared to 0, 0, 0, -65504, blending ADD for rgb, MAX for alpha, from s.sum_c
//    sum_d: rgba16float, cleared to 0, 0, 0, -65504, blending ADD for rgb, MAX for alpha, from s.sum_d
//    sum_e: rgba16float, cleared to 0, 0, 0, -65504, blending ADD for rgb, MAX for alpha, from s.sum_e
//    sum_f: rgba16float, cleared to 0, 0, 0, -65504, blending ADD for rgb, MAX for alpha, from s.sum_f
//    absorbances: rgba16float, cleared to 0, 0, 0, -65504, blending ADD for rgb, MAX for alpha, from s.absorbances
//    absorbances_back: rgba16float, cleared to 0, 0, 0, -65504, blending ADD for rgb, MAX for alpha, from s.absorbances_back
// 2. Resolve: peelnet_resolve(sum_a, sum_b, sum_c, sum_d, sum_e, sum_f, absorbances, absorbances_back, quantiles, noise, background) is the colour of the pixel, and its coverage in alpha.
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
    metal::packed_float3 color;
    float absorbance;
    float place;
    float coverage;
    float alpha;
    float left;
};
struct PeelnetStatistics {
    metal::float4 sum_a;
    metal::float4 sum_b;
    metal::float4 sum_c;
    metal::float4 sum_d;
    metal::float4 sum_e;
    metal::float4 sum_f;
    metal::float4 absorbances;
    metal::float4 absorbances_back;
};
struct PeelnetShares {
    metal::float3 front;
    metal::float3 back;
};
struct PeelnetRest {
    PeelnetNearest nearest;
    metal::float3x4 front;
    metal::float3x4 back;
};
constant float PEELNET_BIN_LEVELS = 64.0;
constant float PEELNET_TILE_DEPTHS = 240.0;
constant float PEELNET_TILE_OPACITIES = 256.0;
constant float PEELNET_DEPTHS = 480.0;
constant float PEELNET_VALUES = 128.0;
constant float PEELNET_MOST = 0.9411765;

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
    float kept = ((zeta + 1.0) - passed.x) - passed.y;
    return (kept * (2.0 / ((2.0 - lengths.x) - lengths.y))) - 1.0;
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
    metal::float4 levels_1 = metal::float4(before) + metal::float4(bins.x, two, two + bins.z, (two + bins.z) + bins.w);
    return metal::exp(levels_1 * -3.984375);
}

metal::float4 peelnet_even(
) {
    return metal::float4(0.06, 0.35, 0.65, 0.94);
}

float peelnet_place_among(
    float depth,
    metal::float4 quantiles
) {
    metal::float4 begin = metal::float4(0.0, quantiles.xyz);
    metal::float4 parts = metal::clamp((metal::float4(depth) - begin) / metal::max(quantiles - begin, metal::float4(0.0001)), metal::float4(0.0), metal::float4(1.0));
    float last = metal::clamp((depth - quantiles.w) / metal::max(1.0 - quantiles.w, 0.0001), 0.0, 1.0);
    return metal::dot(parts, metal::float4(0.06, 0.29, 0.3, 0.29)) + (0.06 * last);
}

metal::float4x4 peelnet_tile_levels(
    float level_1,
    float depth_1
) {
    float place_3 = metal::clamp((depth_1 * 16.0) - 0.5, 0.0, 15.0);
    metal::float4 _e10 = peelnet_in_bins(level_1, place_3, 0.0);
    metal::float4 _e12 = peelnet_in_bins(level_1, place_3, 4.0);
    metal::float4 _e14 = peelnet_in_bins(level_1, place_3, 8.0);
    metal::float4 _e16 = peelnet_in_bins(level_1, place_3, 12.0);
    return metal::float4x4(_e10, _e12, _e14, _e16);
}

metal::float4x4 peelnet_tile_bins(
    float alpha_1,
    float zeta_1
) {
    float _e2 = peelnet_absorbance(alpha_1);
    float _e3 = peelnet_level(_e2);
    metal::float4x4 _e8 = peelnet_tile_levels(_e3, (0.5 * zeta_1) + 0.5);
    return _e8;
}

float peelnet_tile_nearest(
    float alpha_2,
    float zeta_2
) {
    float _e2 = peelnet_absorbance(alpha_2);
    float bin = metal::min(metal::floor(((0.5 * zeta_2) + 0.5) * PEELNET_TILE_DEPTHS), 239.0);
    float opacity = metal::floor(((_e2 / (_e2 + 1.0)) * 270.9375) + 0.5);
    metal::float3 _e26 = peelnet_halves(metal::float3(((239.0 - bin) * PEELNET_TILE_OPACITIES) + opacity));
    return _e26.x;
}

metal::float4 peelnet_before(
    metal::float4x4 bins_1
) {
    metal::float4 all = metal::float4(1.0) * bins_1;
    return metal::float4(0.0, all.x, all.x + all.y, (all.x + all.y) + all.z);
}

metal::float4 peelnet_seen(
    metal::float4 bins_2,
    metal::float4 taken,
    float before_1
) {
    metal::float4 _e3 = peelnet_seen_behind(before_1, bins_2);
    metal::float4 seen_4 = metal::float4(metal::exp(before_1 * -3.984375), _e3.xyz) - _e3;
    return (seen_4 * metal::max(bins_2 - taken, metal::float4(0.0))) / metal::max(bins_2, metal::float4(0.003921569));
}

metal::float4x4 peelnet_tile_seen(
    metal::float4x4 bins_3,
    float nearest
) {
    metal::float3 _e3 = peelnet_levels(metal::float3(nearest));
    float level_2 = metal::max(_e3.x, 0.0);
    float back = metal::floor(level_2 * 0.00390625);
    float opacity_1 = (level_2 - (back * PEELNET_TILE_OPACITIES)) * 0.003921569;
    float depth_3 = ((PEELNET_TILE_DEPTHS - back) - 0.5) / PEELNET_TILE_DEPTHS;
    float _e24 = peelnet_level(opacity_1 / (1.0625 - opacity_1));
    metal::float4x4 _e25 = peelnet_tile_levels(_e24, depth_3);
    metal::float4 _e26 = peelnet_before(bins_3);
    metal::float4 _e30 = peelnet_seen(bins_3[0], _e25[0], _e26.x);
    metal::float4 _e34 = peelnet_seen(bins_3[1], _e25[1], _e26.y);
    metal::float4 _e38 = peelnet_seen(bins_3[2], _e25[2], _e26.z);
    metal::float4 _e42 = peelnet_seen(bins_3[3], _e25[3], _e26.w);
    return metal::float4x4(_e30, _e34, _e38, _e42);
}

float peelnet_passed(
    float share,
    float before_2,
    metal::float4 bins_4
) {
    float two_1 = bins_4.x + bins_4.y;
    metal::float4 begin_1 = metal::float4(before_2) + metal::float4(0.0, bins_4.x, two_1, two_1 + bins_4.z);
    return metal::dot(metal::clamp((metal::float4(share) - begin_1) / metal::max(bins_4, metal::float4(0.000000001)), metal::float4(0.0), metal::float4(1.0)), metal::float4(1.0));
}

float peelnet_depth_at(
    float share_1,
    metal::float4x4 bins_5,
    metal::float4 before_3
) {
    float _e5 = peelnet_passed(share_1, before_3.x, bins_5[0]);
    float _e8 = peelnet_passed(share_1, before_3.y, bins_5[1]);
    float front = _e5 + _e8;
    float _e12 = peelnet_passed(share_1, before_3.z, bins_5[2]);
    float _e16 = peelnet_passed(share_1, before_3.w, bins_5[3]);
    return 0.0625 * ((front + _e12) + _e16);
}

metal::float4 peelnet_quantiles(
    metal::float4x4 seen
) {
    metal::float4 even = metal::float4(0.00125);
    metal::float4x4 bins_6 = seen + metal::float4x4(even, even, even, even);
    metal::float4 _e5 = peelnet_before(bins_6);
    metal::float4 _e6 = peelnet_even();
    metal::float4 shares_1 = _e6 * (_e5.w + metal::dot(bins_6[3], metal::float4(1.0)));
    float _e15 = peelnet_depth_at(shares_1.x, bins_6, _e5);
    float _e17 = peelnet_depth_at(shares_1.y, bins_6, _e5);
    float _e19 = peelnet_depth_at(shares_1.z, bins_6, _e5);
    float _e21 = peelnet_depth_at(shares_1.w, bins_6, _e5);
    return metal::float4(_e15, _e17, _e19, _e21);
}

float peelnet_noise(
    metal::uint2 pixel
) {
    return static_cast<float>(((pixel.x * 12664746u) + (pixel.y * 9560334u)) & 16777215u) * 0.000000059604645;
}

metal::float4 peelnet_to_unit(
    metal::float4 values
) {
    metal::float4 kept_1 = metal::max(values, metal::float4(0.0));
    return metal::sqrt(metal::min((kept_1 / (metal::float4(1.0) + kept_1)) * 1.0625, metal::float4(1.0)));
}

metal::float4 peelnet_from_unit(
    metal::float4 units
) {
    metal::float4 shares_2 = (units * units) * PEELNET_MOST;
    return shares_2 / (metal::float4(1.0) - shares_2);
}

metal::float4 peelnet_record(
    float b,
    metal::float3 rgb,
    float depth_2,
    float place_1,
    float noise
) {
    float bin_1 = metal::clamp(metal::floor((0.5 * (depth_2 + place_1)) * PEELNET_DEPTHS), 0.0, 479.0);
    metal::float4 _e16 = peelnet_to_unit(metal::float4(rgb, b));
    metal::float4 values_1 = metal::min(metal::floor((_e16 * 127.0) + metal::float4(noise)), metal::float4(127.0));
    metal::float4 levels_2 = values_1 + metal::float4((479.0 - bin_1) * PEELNET_VALUES);
    metal::float3 _e30 = peelnet_halves(levels_2.xyz);
    metal::float3 _e32 = peelnet_halves(levels_2.www);
    return metal::float4(_e30, _e32.x);
}

PeelnetNearest peelnet_nearest(
    metal::float4 halves_1,
    metal::float4 sums,
    metal::float4 quantiles_1,
    float noise_1
) {
    metal::float3 _e5 = peelnet_levels(halves_1.xyz);
    metal::float3 _e7 = peelnet_levels(halves_1.www);
    metal::float4 levels_3 = metal::max(metal::float4(_e5, _e7.x), metal::float4(0.0));
    metal::float4 back_1 = metal::floor(levels_3 * 0.0078125);
    metal::float4 steps = (levels_3 - (back_1 * PEELNET_VALUES)) + metal::float4(0.5 - noise_1);
    metal::float4 units_1 = metal::clamp(steps / metal::float4(127.0), metal::float4(0.0), metal::float4(1.0));
    metal::float4 _e31 = peelnet_from_unit(units_1);
    float on_scale = ((PEELNET_DEPTHS - back_1.w) - 0.5) / PEELNET_DEPTHS;
    metal::float4 _e39 = peelnet_even();
    float _e43 = peelnet_place_among(on_scale, 0.5 * (quantiles_1 + _e39));
    float one = 1.0 + _e31.w;
    metal::float4 _e48 = peelnet_to_unit(_e31.wwww);
    float slack = ((((2.0 * _e48.x) * PEELNET_MOST) * one) * one) / 127.0;
    bool alone = (sums.w - _e31.w) <= (slack + (sums.w * 0.0009765625));
    metal::float3 color = alone ? (sums.xyz / metal::float3(metal::max(sums.w, 0.000001))) : _e31.xyz;
    float absorbance_1 = alone ? sums.w : _e31.w;
    float coverage = 1.0 - metal::exp(-(sums.w));
    float alpha_4 = metal::min(1.0 - metal::exp(-(absorbance_1)), coverage);
    return PeelnetNearest {color, absorbance_1, _e43, coverage, alpha_4, coverage - alpha_4};
}

metal::float4 peelnet_behind(
    metal::float3 rgb_1,
    float b_1,
    float share_2,
    PeelnetNearest nearest_1
) {
    float taken_1 = nearest_1.absorbance * share_2;
    return metal::float4(metal::max(metal::min(rgb_1, metal::float3(65504.0)) - (taken_1 * nearest_1.color), metal::float3(0.0)), metal::max(b_1 - taken_1, 0.0));
}

float peelnet_inside(
    float b_2
) {
    float some = metal::max(b_2, 0.02);
    return (b_2 < 0.02) ? (b_2 * (0.5 - (b_2 / 24.0))) : metal::log(some / (1.0 - metal::exp(-(some))));
}

float peelnet_share(
    float root_absorbance,
    float root_total,
    float share_before,
    float share_own,
    float share_previous,
    float share_next,
    float nearest_alpha,
    float nearest_place,
    float number
) {
    metal::float4 input_a = metal::float4(root_absorbance, root_total, share_before, share_own);
    metal::float4 input_b = metal::float4(share_previous, share_next, nearest_alpha, nearest_place);
    metal::float4 input_c = metal::float4(number, 0.0, 0.0, 0.0);
    metal::float4 layer_a_a = metal::max(((metal::float4(0.4666205, -0.11575089, -0.029181149, 1.8437698) + (metal::float4x4(metal::float4(0.3547842, 0.039882265, -0.3105391, -0.18115288), metal::float4(-0.34781784, 0.006398668, 0.018371975, 0.11330409), metal::float4(0.2559351, -7.810839, -4.0731845, -1.8063126), metal::float4(1.8923279, 0.12605865, -7.0934877, 1.2109178)) * input_a)) + (metal::float4x4(metal::float4(0.19472857, 7.354236, 4.370808, 0.2715109), metal::float4(-3.0465987, -0.055315677, -0.2180793, 0.73340905), metal::float4(0.3802175, 0.09960899, 0.28415978, -0.8623496), metal::float4(-0.7813807, 0.06559046, 0.122198105, -3.6882675)) * input_b)) + (metal::float4(-0.49502563, 0.04803964, 1.0847343, -2.0858264) * input_c.x), metal::float4(0.0));
    metal::float4 layer_a_b = metal::max(((metal::float4(0.6841537, -1.283513, 0.01808118, -2.7702737) + (metal::float4x4(metal::float4(-0.27815422, 0.2784779, 0.04891465, 0.6194494), metal::float4(-0.026438346, 0.10748321, -0.009076034, 0.31701574), metal::float4(-1.9829249, 2.0580642, -8.987123, -2.6037), metal::float4(-5.465318, 2.613381, 0.029313307, 1.6462734)) * input_a)) + (metal::float4x4(metal::float4(3.325333, -3.2342646, 8.94207, 5.303125), metal::float4(-3.145362, 1.1029466, -0.038704406, 1.7081681), metal::float4(0.16217414, 0.4731318, 0.0766495, 0.44500396), metal::float4(0.57896876, 0.10999332, 0.03734211, 0.048228577)) * input_b)) + (metal::float4(0.39946175, -0.64154, 0.02344602, -0.31209108) * input_c.x), metal::float4(0.0));
    metal::float4 layer_a_c = metal::max(((metal::float4(0.93011147, -0.29465568, 0.6689869, 2.431103) + (metal::float4x4(metal::float4(-0.6942789, 0.09865242, -0.07241759, -0.14728548), metal::float4(-0.2459893, 0.05392831, 0.0044569764, -0.14052507), metal::float4(-0.79780096, -1.0737534, -0.63217336, -0.65091354), metal::float4(-5.361806, 1.187457, -7.802415, -0.96311826)) * input_a)) + (metal::float4x4(metal::float4(-0.5452086, 7.839788, 0.8022129, -2.4772303), metal::float4(1.918296, -1.648276, 1.0332565, -3.8952055), metal::float4(0.30027014, -0.8653171, 0.011285074, 1.3065099), metal::float4(-0.06556393, -0.48770645, 0.15395866, 0.1755579)) * input_b)) + (metal::float4(-0.3574266, 0.47350645, 0.042817708, -0.42319676) * input_c.x), metal::float4(0.0));
    float layer_b_a = 1.0 / (1.0 + metal::exp(metal::min(-((((-0.22486302 + metal::dot(metal::float4(-0.37063545, 8.715594, -3.8145647, -0.19707212), layer_a_a)) + metal::dot(metal::float4(2.7676816, 0.3040865, 7.2079797, 0.32819167), layer_a_b)) + metal::dot(metal::float4(-3.7903945, 0.3103553, -0.5123967, 0.36474672), layer_a_c))), 80.0)));
    return layer_b_a;
}

float peelnet_network(
    PeelnetAhead ahead
) {
    float _e14 = peelnet_share(metal::sqrt(2.0 * ahead.absorbance), metal::sqrt(ahead.total), ahead.before, ahead.own, ahead.previous, ahead.next, ahead.alpha, ahead.place, ahead.number);
    return _e14;
}

float peelnet_part(
    float own,
    float before_4,
    float previous,
    float next,
    float total,
    float number_1,
    PeelnetNearest nearest_2
) {
    float _e7 = peelnet_inside(own);
    float ahead_1 = before_4 + _e7;
    float scale = 1.0 / metal::max(total, 0.000001);
    PeelnetAhead known = PeelnetAhead {ahead_1, total, before_4 * scale, own * scale, previous * scale, next * scale, nearest_2.alpha, nearest_2.place, number_1};
    float _e22 = peelnet_network(known);
    return metal::exp((-2.0 * ahead_1) * _e22);
}

metal::float3 peelnet_seen_of(
    metal::float3 b_3,
    float before_5
) {
    float _e3 = peelnet_inside(b_3.x);
    float _e8 = peelnet_inside(b_3.y);
    float _e15 = peelnet_inside(b_3.z);
    metal::float3 ahead_2 = metal::float3(before_5 + _e3, (before_5 + b_3.x) + _e8, ((before_5 + b_3.x) + b_3.y) + _e15);
    return b_3 * metal::exp(-(ahead_2));
}

metal::float4 peelnet_until(
    metal::float4 depths,
    metal::float3 seen_1,
    metal::float3 begins,
    metal::float3 ends,
    metal::float4 quantiles_2
) {
    metal::float3 scale_1 = metal::float3(1.0) / (ends - begins);
    float _e10 = peelnet_place_among(depths.x, quantiles_2);
    float _e21 = peelnet_place_among(depths.y, quantiles_2);
    float _e32 = peelnet_place_among(depths.z, quantiles_2);
    float _e43 = peelnet_place_among(depths.w, quantiles_2);
    return metal::float4(metal::dot(seen_1, metal::clamp((metal::float3(_e10) - begins) * scale_1, metal::float3(0.0), metal::float3(1.0))), metal::dot(seen_1, metal::clamp((metal::float3(_e21) - begins) * scale_1, metal::float3(0.0), metal::float3(1.0))), metal::dot(seen_1, metal::clamp((metal::float3(_e32) - begins) * scale_1, metal::float3(0.0), metal::float3(1.0))), metal::dot(seen_1, metal::clamp((metal::float3(_e43) - begins) * scale_1, metal::float3(0.0), metal::float3(1.0))));
}

metal::float4x4 peelnet_spread(
    metal::float3 seen_2,
    metal::float3 begins_1,
    metal::float3 ends_1,
    metal::float4 quantiles_3
) {
    metal::float4 depths_1 = metal::float4(0.0625, 0.125, 0.1875, 0.25);
    metal::float4 _e9 = peelnet_until(depths_1, seen_2, begins_1, ends_1, quantiles_3);
    metal::float4 _e13 = peelnet_until(depths_1 + metal::float4(0.25), seen_2, begins_1, ends_1, quantiles_3);
    metal::float4 _e17 = peelnet_until(depths_1 + metal::float4(0.5), seen_2, begins_1, ends_1, quantiles_3);
    metal::float4 _e21 = peelnet_until(depths_1 + metal::float4(0.75), seen_2, begins_1, ends_1, quantiles_3);
    return metal::float4x4(_e9 - metal::float4(0.0, _e9.xyz), _e13 - metal::float4(_e9.w, _e13.xyz), _e17 - metal::float4(_e13.w, _e17.xyz), _e21 - metal::float4(_e17.w, _e21.xyz));
}

metal::float4 peelnet_over_black(
    PeelnetNearest nearest_3,
    metal::float4 seen_3
) {
    metal::float3 rest = (seen_3.w > 0.0) ? (seen_3.xyz / metal::float3(metal::max(seen_3.w, 0.000000000000000000000000000000000000011754944))) : nearest_3.color;
    return metal::float4((nearest_3.alpha * nearest_3.color) + (nearest_3.left * rest), nearest_3.coverage);
}

PeelnetShares peelnet_shares(
    float place_2
) {
    metal::float3 off_front = (metal::float3(place_2) - metal::float3(0.199, 0.315, 0.495)) * metal::float3(14.492754, 13.513514, 13.888889);
    metal::float3 off_back = (metal::float3(place_2) - metal::float3(0.635, 0.784, 0.948)) * metal::float3(17.24138, 14.705881, 10.752687);
    metal::float3 front_1 = metal::exp((-0.5 * off_front) * off_front);
    metal::float3 back_2 = metal::exp((-0.5 * off_back) * off_back);
    metal::float3 all_1 = front_1 + back_2;
    float scale_2 = 1.0 / ((all_1.x + all_1.y) + all_1.z);
    return PeelnetShares {front_1 * scale_2, back_2 * scale_2};
}

PeelnetStatistics peelnet_statistics(
    float alpha_3,
    metal::float3 rgb_2,
    float zeta_3,
    metal::float4 quantiles_4,
    float noise_2
) {
    float _e5 = peelnet_absorbance(alpha_3);
    float depth_4 = (0.5 * zeta_3) + 0.5;
    float _e10 = peelnet_place_among(depth_4, quantiles_4);
    metal::float4 _e11 = peelnet_record(_e5, rgb_2, depth_4, _e10, noise_2);
    PeelnetShares _e12 = peelnet_shares(_e10);
    metal::float3 front_2 = _e5 * _e12.front;
    metal::float3 back_3 = _e5 * _e12.back;
    return PeelnetStatistics {metal::float4(rgb_2 * front_2.x, _e11.x), metal::float4(rgb_2 * front_2.y, _e11.y), metal::float4(rgb_2 * front_2.z, _e11.z), metal::float4(rgb_2 * back_3.x, -65504.0), metal::float4(rgb_2 * back_3.y, -65504.0), metal::float4(rgb_2 * back_3.z, -65504.0), metal::float4(front_2, _e11.w), metal::float4(back_3, -65504.0)};
}

PeelnetRest peelnet_rest(
    metal::float4 sum_a,
    metal::float4 sum_b,
    metal::float4 sum_c,
    metal::float4 sum_d,
    metal::float4 sum_e,
    metal::float4 sum_f,
    metal::float4 absorbances,
    metal::float4 absorbances_back,
    metal::float4 quantiles_5,
    float noise_3
) {
    metal::float3 front_3 = metal::min(absorbances.xyz, metal::float3(65504.0));
    metal::float3 back_4 = metal::min(absorbances_back.xyz, metal::float3(65504.0));
    metal::float3 both = front_3 + back_4;
    metal::float3 colors = ((((sum_a.xyz + sum_b.xyz) + sum_c.xyz) + sum_d.xyz) + sum_e.xyz) + sum_f.xyz;
    metal::float4 all_2 = metal::float4(colors, (both.x + both.y) + both.z);
    PeelnetNearest _e41 = peelnet_nearest(metal::float4(sum_a.w, sum_b.w, sum_c.w, absorbances.w), all_2, quantiles_5, noise_3);
    PeelnetShares _e43 = peelnet_shares(_e41.place);
    metal::float4 _e48 = peelnet_behind(sum_a.xyz, front_3.x, _e43.front.x, _e41);
    metal::float4 _e53 = peelnet_behind(sum_b.xyz, front_3.y, _e43.front.y, _e41);
    metal::float4 _e58 = peelnet_behind(sum_c.xyz, front_3.z, _e43.front.z, _e41);
    metal::float4 _e64 = peelnet_behind(sum_d.xyz, back_4.x, _e43.back.x, _e41);
    metal::float4 _e69 = peelnet_behind(sum_e.xyz, back_4.y, _e43.back.y, _e41);
    metal::float4 _e74 = peelnet_behind(sum_f.xyz, back_4.z, _e43.back.z, _e41);
    return PeelnetRest {_e41, metal::float3x4(_e48, _e53, _e58), metal::float3x4(_e64, _e69, _e74)};
}

metal::float4 peelnet_pixel(
    metal::float4 sum_a_1,
    metal::float4 sum_b_1,
    metal::float4 sum_c_1,
    metal::float4 sum_d_1,
    metal::float4 sum_e_1,
    metal::float4 sum_f_1,
    metal::float4 absorbances_1,
    metal::float4 absorbances_back_1,
    metal::float4 quantiles_6,
    float noise_4
) {
    PeelnetRest _e10 = peelnet_rest(sum_a_1, sum_b_1, sum_c_1, sum_d_1, sum_e_1, sum_f_1, absorbances_1, absorbances_back_1, quantiles_6, noise_4);
    metal::float3 front_4 = metal::float3(_e10.front[0].w, _e10.front[1].w, _e10.front[2].w);
    metal::float3 back_5 = metal::float3(_e10.back[0].w, _e10.back[1].w, _e10.back[2].w);
    float to_c = front_4.x + front_4.y;
    float to_d = to_c + front_4.z;
    float to_e = to_d + back_5.x;
    float to_f = to_e + back_5.y;
    float total_1 = to_f + back_5.z;
    float _e50 = peelnet_part(front_4.x, 0.0, 0.0, front_4.y, total_1, 0.0, _e10.nearest);
    float _e60 = peelnet_part(front_4.y, front_4.x, front_4.x, front_4.z, total_1, 0.2, _e10.nearest);
    float _e70 = peelnet_part(front_4.z, to_c, front_4.y, back_5.x, total_1, 0.4, _e10.nearest);
    float _e80 = peelnet_part(back_5.x, to_d, front_4.z, back_5.y, total_1, 0.6, _e10.nearest);
    float _e90 = peelnet_part(back_5.y, to_e, back_5.x, back_5.z, total_1, 0.8, _e10.nearest);
    float _e100 = peelnet_part(back_5.z, to_f, back_5.y, 0.0, total_1, 1.0, _e10.nearest);
    metal::float4 seen_5 = (((((_e10.front[0] * _e50) + (_e10.front[1] * _e60)) + (_e10.front[2] * _e70)) + (_e10.back[0] * _e80)) + (_e10.back[1] * _e90)) + (_e10.back[2] * _e100);
    metal::float4 _e104 = peelnet_over_black(_e10.nearest, seen_5);
    return _e104;
}

metal::float4x4 peelnet_last_seen(
    metal::float4 sum_a_2,
    metal::float4 sum_b_2,
    metal::float4 sum_c_2,
    metal::float4 sum_d_2,
    metal::float4 sum_e_2,
    metal::float4 sum_f_2,
    metal::float4 absorbances_2,
    metal::float4 absorbances_back_2,
    metal::float4 quantiles_7,
    float noise_5
) {
    PeelnetRest _e10 = peelnet_rest(sum_a_2, sum_b_2, sum_c_2, sum_d_2, sum_e_2, sum_f_2, absorbances_2, absorbances_back_2, quantiles_7, noise_5);
    metal::float3 front_5 = metal::float3(_e10.front[0].w, _e10.front[1].w, _e10.front[2].w);
    metal::float3 back_6 = metal::float3(_e10.back[0].w, _e10.back[1].w, _e10.back[2].w);
    metal::float3 _e32 = peelnet_seen_of(front_5, 0.0);
    metal::float3 _e36 = peelnet_seen_of(back_6, metal::dot(front_5, metal::float3(1.0)));
    float scale_3 = _e10.nearest.left / metal::max(metal::dot(_e32 + _e36, metal::float3(1.0)), 0.000000000000000000000000000000000000011754944);
    metal::float3 begins_2 = metal::float3(0.0, 0.25, 0.408);
    metal::float3 begins_back = metal::float3(0.576, 0.702, 0.848);
    metal::float4x4 _e59 = peelnet_spread(_e32 * scale_3, begins_2, metal::float3(0.25, 0.408, 0.576), quantiles_7);
    metal::float4x4 _e65 = peelnet_spread(_e36 * scale_3, begins_back, metal::float3(0.702, 0.848, 1.0), quantiles_7);
    return _e59 + _e65;
}

metal::float4 peelnet_resolve(
    metal::float4 sum_a_3,
    metal::float4 sum_b_3,
    metal::float4 sum_c_3,
    metal::float4 sum_d_3,
    metal::float4 sum_e_3,
    metal::float4 sum_f_3,
    metal::float4 absorbances_3,
    metal::float4 absorbances_back_3,
    metal::float4 quantiles_8,
    float noise_6,
    metal::float3 background
) {
    metal::float4 _e11 = peelnet_pixel(sum_a_3, sum_b_3, sum_c_3, sum_d_3, sum_e_3, sum_f_3, absorbances_3, absorbances_back_3, quantiles_8, noise_6);
    return metal::float4(_e11.xyz + ((1.0 - _e11.w) * background), _e11.w);
}

float peelnet_weight(
    float root_absorbance_1,
    float root_total_1,
    float share_before_1,
    float share_own_1,
    float share_previous_1,
    float share_next_1,
    float nearest_alpha_1,
    float nearest_place_1,
    float number_2
) {
    float root = metal::clamp(root_absorbance_1, 0.0, 256.0);
    float _e39 = peelnet_share(metal::clamp(root_absorbance_1, -14583.727, 14586.654), metal::clamp(root_total_1, -29725.627, 29732.018), metal::clamp(share_before_1, -2963.0286, 2963.4841), metal::clamp(share_own_1, -2498.6606, 2499.0288), metal::clamp(share_previous_1, -1548.4214, 1548.6111), metal::clamp(share_next_1, -2496.274, 2496.6147), metal::clamp(nearest_alpha_1, -3192.155, 3192.9812), metal::clamp(nearest_place_1, -1795.963, 1796.2181), metal::clamp(number_2, -3346.1912, 3347.2424));
    return metal::exp((-(root) * root) * _e39);
}
