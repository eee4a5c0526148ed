// A learned weight for order-independent transparency. Exported by peelnet 0.1.0.
// Licence of this generated text: MIT OR Apache-2.0.
// Metal 2.4. No Metal compiler was at hand: this text was translated from WGSL that was compiled and run, and has not been compiled itself.
// Network: 3-10-8-1 (Relu hidden, Identity last), 137 parameters, 118 multiply-adds. Recipe thesis, seed 1, 80 epochs.
// Answers: transmittance in front, kept in 0.000061035156 .. 1.0.
// Input 0: linear_depth (scene units), 0.0011571449 .. 194766.53 in training.
// Input 1: alpha_sum (1), 0.001 .. 148.18492 in training.
// Input 2: fragment_count (1), 1.0 .. 160.0 in training.
// Trained on boxes, cups, foliage, intersecting, opaque-mix, panes, sixteen-025, sixteen-050, sixteen-075, sixteen-085, sixteen-random-alpha, sixteen-random-color, smoke-100, smoke-30, synthetic, of a dataset of 21565796 rows, at most 2000000 of them (f0e6c4a7cca08d560f99a5be9cbd1514bf8be352632a347602bf08363695fd29+eb0fb0725f43962450fda44a06f4c27ba969a523c02d556c7eebdda5833c5318).
// Loss: training 0.048480, test 0.048988.
// Held-out error, mean |T - T_exact|: boxes-held 0.22977, cups-held 0.19223, foliage-held 0.26605, panes-held 0.20347, sixteen-held 0.26863, smoke-held 0.15948.
//
// Self-tests, to some roundings of 32 bits; weights and colours also to those of 16-bit targets.
// peelnet_weight(41253.637, 1.5515013, 36.34513) = 0.25922132
// peelnet_weight(126961.34, 1.5760642, 50.472134) = 0.56723166
// peelnet_weight(98322.69, 1.9755383, 156.7239) = 0.23705147
// Four fragments of a pixel, near 1.0, far 8.0, background 0.25, 0.5, 0.75:
//    z 1.0, alpha 0.5, rgb 1.0, 0.0, 0.0: zeta -1.0, weight 0.38920307
//    z 2.0, alpha 0.5, rgb 0.0, 1.0, 0.0: zeta -0.33333334, weight 0.38891518
//    z 4.0, alpha 0.5, rgb 0.0, 0.0, 1.0: zeta 0.33333334, weight 0.38833928
//    z 8.0, alpha 0.9, rgb 1.0, 1.0, 1.0: zeta 1.0, weight 0.38718748
//    colour of the pixel: 0.5787216, 0.581694, 0.5845138
//
// How to draw with it. Targets may have 32 bits a channel wherever 16 are named.
// 0. z is the distance along the view axis, in the unit of the scenes that the network was trained on.
// 1. Pass "statistics": draw all transparent surfaces, in any order.
//    statistics: rg16float, cleared to 0, blending ADD, from peelnet_statistics(alpha)
// 2. Pass "weights": draw all transparent surfaces, in any order. float w = peelnet_fragment(z, statistics);
//    sums: rgba16float, cleared to 0, blending ADD, from float4(alpha * rgb, alpha) * w
//    transmittance: r16float, cleared to 1, blending dst * (1 - src), from alpha
// 3. Resolve: peelnet_resolve(sums, transmittance, background) is the colour of the pixel, and its coverage in alpha.
// - alpha is opacity, rgb the linear colour that is not multiplied by it. Resolve before tone mapping and encoding.
// - Test depth against the opaque surfaces, do not write it: a depth prepass with transparent surfaces in it hides what lies behind.
// - z grows with distance, also where depth buffers are reversed.
// - With multisampling, gather and resolve the statistics per sample: averaged samples of them mean nothing.

// language: metal2.4
#include <metal_stdlib>
#include <simd/simd.h>

using metal::uint;


metal::float2 peelnet_statistics(
    float alpha
) {
    return metal::float2(alpha, 1.0);
}

float peelnet_weight(
    float linear_depth,
    float alpha_sum,
    float fragment_count
) {
    metal::float4 input_a = (metal::clamp(metal::float4(linear_depth, alpha_sum, fragment_count, 0.0), metal::float4(-26708884.0, -301407.88, -491100.8, 0.0), metal::float4(26709172.0, 301463.5, 491225.38, 0.0)) - metal::float4(143.32695, 27.802132, 62.27086, 0.0)) * metal::float4(0.00037440524, 0.03317457, 0.020359837, 0.0);
    metal::float4 layer_a_a = metal::max(metal::float4(0.17202352, -0.33861655, -0.65111166, -0.27873367) + (metal::float4x4(metal::float4(-1.6443841, 0.663666, -0.008266653, -0.48788655), metal::float4(-0.4833601, 0.09646811, -0.8575291, -0.50334036), metal::float4(-0.1063327, -0.37545523, 0.0024932898, 0.009476901), metal::float4(0.0, 0.0, 0.0, 0.0)) * input_a), metal::float4(0.0));
    metal::float4 layer_a_b = metal::max(metal::float4(0.477309, -0.30417722, -0.22065732, -0.70301634) + (metal::float4x4(metal::float4(-0.019981772, 0.49252462, -0.11415353, 0.0016808453), metal::float4(0.5947388, 0.05620626, -0.3157088, -0.8182039), metal::float4(0.12933101, -0.22014493, -0.20121585, -0.009877927), metal::float4(0.0, 0.0, 0.0, 0.0)) * input_a), metal::float4(0.0));
    metal::float4 layer_a_c = metal::max(metal::float4(-0.23660204, -0.8502839, 0.0, 0.0) + (metal::float4x4(metal::float4(0.29050222, 0.0021981478, 0.0, 0.0), metal::float4(0.24772064, -0.37803575, 0.0, 0.0), metal::float4(-0.33890298, -0.43394318, 0.0, 0.0), metal::float4(0.0, 0.0, 0.0, 0.0)) * input_a), metal::float4(0.0));
    metal::float4 layer_b_a = metal::max(((metal::float4(-0.0084845545, 0.42816752, -0.32803348, -0.28952906) + (metal::float4x4(metal::float4(-0.059178717, 0.22865772, 0.037750244, 0.1582013), metal::float4(0.4395608, 0.27477077, 0.10929301, -0.24932279), metal::float4(-0.25992158, 0.5148496, -0.24853711, -0.24025589), metal::float4(-0.3217418, 0.44356298, 0.15429734, -0.30899996)) * layer_a_a)) + (metal::float4x4(metal::float4(0.43135795, 0.20659286, 0.38355634, -0.26679063), metal::float4(0.054677207, -0.39168513, -0.11667288, 0.017381579), metal::float4(0.0769263, 0.08616657, 0.203744, -0.14451589), metal::float4(-1.9393139, 2.4382305, -0.18290214, 0.25198883)) * layer_a_b)) + (metal::float4x4(metal::float4(0.17664729, 0.0373914, -0.05247746, -0.26905248), metal::float4(0.009172653, 0.4882104, 0.04909207, -0.13056067), metal::float4(0.0, 0.0, 0.0, 0.0), metal::float4(0.0, 0.0, 0.0, 0.0)) * layer_a_c), metal::float4(0.0));
    metal::float4 layer_b_b = metal::max(((metal::float4(0.35484096, 0.21908818, -0.073437445, 0.14249358) + (metal::float4x4(metal::float4(0.07197324, -0.067884125, -0.0941368, 0.5163238), metal::float4(-0.31694415, -0.1365081, 0.06978265, 0.5680203), metal::float4(-0.99926215, -0.32455721, -0.059331723, 0.86185443), metal::float4(-0.17198667, -0.40941536, -0.20125546, 0.49218035)) * layer_a_a)) + (metal::float4x4(metal::float4(-0.11582308, -0.27367878, -0.26192462, -0.14678575), metal::float4(0.39480117, 0.3613033, -0.10526723, -0.053946372), metal::float4(-0.083543114, 0.1317247, 0.0835788, 0.095977366), metal::float4(-2.5733252, -1.4414519, -0.016961027, 2.9784467)) * layer_a_b)) + (metal::float4x4(metal::float4(0.055101722, 0.33804154, -0.22381483, -0.079337716), metal::float4(-3.0615366, -0.307949, -0.2030369, 1.6325569), metal::float4(0.0, 0.0, 0.0, 0.0), metal::float4(0.0, 0.0, 0.0, 0.0)) * layer_a_c), metal::float4(0.0));
    float layer_c_a = (0.15580891 + metal::dot(metal::float4(-0.24034645, 0.43125758, -0.34120706, 0.032047004), layer_b_a)) + metal::dot(metal::float4(-1.2109938, -0.24511446, -0.136315, 0.4103327), layer_b_b);
    return metal::clamp(layer_c_a, 0.000061035156, 1.0);
}

float peelnet_network(
    float linear_depth_1,
    metal::float2 statistics
) {
    float _e4 = peelnet_weight(linear_depth_1, statistics.x, statistics.y);
    return _e4;
}

float peelnet_fragment(
    float linear_depth_2,
    metal::float2 statistics_1
) {
    float _e2 = peelnet_network(linear_depth_2, statistics_1);
    return _e2;
}

metal::float4 peelnet_composite(
    metal::float4 sums,
    float coverage,
    metal::float3 transmittance,
    metal::float3 background
) {
    bool local = {};
    if (sums.w > 0.0) {
        local = coverage > 0.0;
    } else {
        local = false;
    }
    bool _e20 = local;
    metal::float3 average = _e20 ? (sums.xyz / metal::float3(metal::max(sums.w, 0.000000000000000000000000000000000000011754944))) : metal::float3(0.0);
    return metal::float4((average * coverage) + (background * transmittance), coverage);
}

metal::float4 peelnet_resolve(
    metal::float4 sums_1,
    float transmittance_1,
    metal::float3 background_1
) {
    metal::float4 _e9 = peelnet_composite(metal::min(sums_1, metal::float4(65504.0)), 1.0 - transmittance_1, metal::float3(transmittance_1), background_1);
    return _e9;
}
