// A learned weight for order-independent transparency. Exported by peelnet 0.1.0.
// Licence of this generated text: MIT OR Apache-2.0.
// Metal 2.4. No Metal compiler was at hand: this text was translated from WGSL that was compiled and run, and has not been compiled itself.
// Network: 7-32-16-1 (Relu hidden, Sigmoid last), 801 parameters, 752 multiply-adds. Recipe nmt, seed 1, 80 epochs.
// Answers: transmittance in front, kept in 0.000061035156 .. 1.0.
// Input 0: depth (exponentially, 0 .. 1 from the pixel's nearest to its farthest fragment), 0.0 .. 1.0 in training.
// Input 1: fragment_count (1), 1.0 .. 160.0 in training.
// Input 2: absorbance (1), 0.0010004875 .. 462.76218 in training.
// Input 3: moment_one (1), -156.85178 .. 344.96152 in training.
// Input 4: moment_two (1), 2.9969298e-11 .. 336.7957 in training.
// Input 5: moment_three (1), -113.69556 .. 327.3688 in training.
// Input 6: moment_four (1), 5.2722755e-21 .. 319.71024 in training.
// Trained on boxes, cups, foliage, intersecting, opaque-mix, panes, sixteen-025, sixteen-050, sixteen-075, sixteen-085, sixteen-random-alpha, sixteen-random-color, smoke-100, smoke-30, synthetic, of a dataset of 21565798 rows (f0e6c4a7cca08d560f99a5be9cbd1514bf8be352632a347602bf08363695fd29+e22e844788a454658277e87e23685b5ffa00e3ad2d48cb833cc53130eaf4d8b7).
// Loss: training 0.813012, validation 0.812648, test 0.819429.
// Held-out error, mean |T - T_exact|: boxes-held 0.07054, cups-held 0.05326, foliage-held 0.05229, panes-held 0.03146, sixteen-held 0.04297, smoke-held 0.05503.
//
// Self-tests, to some roundings of 32 bits; weights and colours also to those of 16-bit targets.
// peelnet_weight(0.1751247, 90.53728, 203.79982, 154.7868, 82.86818, 146.23239, 50.64698) = 0.36637422
// peelnet_weight(0.19799167, 55.81248, 156.74356, 21.388565, 81.66175, 122.2854, 78.10765) = 0.7972657
// peelnet_weight(0.09411013, 96.51101, 62.104668, 231.24881, 333.4772, -49.77433, 117.94961) = 0.897091
// Four fragments of a pixel, near 1.0, far 8.0, background 0.25, 0.5, 0.75:
//    z 1.0, alpha 0.5, rgb 1.0, 0.0, 0.0: zeta -1.0, weight 0.997473
//    z 2.0, alpha 0.5, rgb 0.0, 1.0, 0.0: zeta -0.33333334, weight 0.5042587
//    z 4.0, alpha 0.5, rgb 0.0, 0.0, 1.0: zeta 0.33333334, weight 0.29176652
//    z 8.0, alpha 0.9, rgb 1.0, 1.0, 1.0: zeta 1.0, weight 0.076038785
//    colour of the pixel: 0.58340997, 0.33422598, 0.22864841
//
// How to draw with it. Targets may have 32 bits a channel wherever 16 are named.
// 0. zeta = peelnet_zeta(z, near, far): z is the distance along the view axis, near and far the range of z that the bounding boxes of the transparent objects in view span, clipped to the camera's. The tighter the range, the less errs. Compute zeta with this function in all passes. Its range is the same for the whole frame: peelnet_zeta_in(z, peelnet_range(near, far)) is the same value, and the range may be passed in.
// 1. Pass "statistics": draw all transparent surfaces, in any order. PeelnetStatistics s = peelnet_statistics(alpha, zeta);
//    totals: rgba32float, cleared to 0, blending ADD, from s.totals
//    moments: rgba32float, cleared to 0, blending ADD, from s.moments
//    extent: rg32float, cleared to -65504, blending MAX, from s.extent
// 2. Pass "weights": draw all transparent surfaces, in any order. float w = peelnet_fragment(zeta, totals, moments, extent);
//    sums: rgba32float, cleared to 0, blending ADD, from float4(alpha * rgb, alpha) * w
// 3. Resolve: peelnet_resolve(sums, totals.x, background) is the colour of the pixel, and its coverage in alpha.
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
struct PeelnetStatistics {
    metal::float4 totals;
    metal::float4 moments;
    metal::float2 extent;
    char _pad3[8];
};

PeelnetRange peelnet_range(
    float near,
    float far
) {
    bool linear = near <= 0.0;
    float inverse_near = linear ? 0.0 : (1.0 / metal::max(near, 0.000000000000000000000000000000000000011754944));
    float extent_3 = linear ? (far - near) : metal::log(metal::max(far * inverse_near, 1.0));
    bool flat = extent_3 <= (linear ? 0.0 : 0.000001);
    return PeelnetRange {inverse_near, near, flat ? 0.0 : (2.0 / metal::max(extent_3, 0.000000000000000000000000000001))};
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

PeelnetStatistics peelnet_statistics(
    float alpha_1,
    float zeta
) {
    float _e2 = peelnet_absorbance(alpha_1);
    float b = metal::min(_e2, 10.0);
    float square = zeta * zeta;
    return PeelnetStatistics {metal::float4(b, 1.0, 0.0, 0.0), b * metal::float4(zeta, square, square * zeta, square * square), metal::float2(-(zeta), zeta)};
}

float peelnet_depth(
    float zeta_1,
    metal::float2 extent
) {
    metal::float2 beyond = metal::exp(0.5 * (metal::float2(zeta_1, extent.y) + metal::float2(extent.x))) - metal::float2(1.0);
    return metal::clamp(beyond.x / metal::max(beyond.y, 0.000015258789), 0.0, 1.0);
}

float peelnet_weight(
    float depth,
    float fragment_count,
    float absorbance,
    float moment_one,
    float moment_two,
    float moment_three,
    float moment_four
) {
    metal::float4 input_a = (metal::clamp(metal::float4(depth, fragment_count, absorbance, moment_one), metal::float4(-3389.2798, -488909.25, -835848.3, -491297.1), metal::float4(3390.2827, 489032.8, 835976.2, 491322.78)) - metal::float4(0.501444, 61.792065, 63.91746, 12.852431)) * metal::float4(2.950043, 0.02045111, 0.011962978, 0.020353751);
    metal::float4 input_b = (metal::clamp(metal::float4(moment_two, moment_three, moment_four, 0.0), metal::float4(-445723.34, -412735.66, -387254.2, 0.0), metal::float4(445776.1, 412755.47, 387290.56, 0.0)) - metal::float4(26.371828, 9.899777, 18.199278, 0.0)) * metal::float4(0.022434114, 0.024228001, 0.02582162, 0.0);
    metal::float4 layer_a_a = metal::max((metal::float4(-3.592941, -1.2559811, -2.7467747, -3.3785114) + (metal::float4x4(metal::float4(-0.83506614, -0.22276415, 0.9841813, -1.2538111), metal::float4(-3.323496, 1.4562287, 0.3174395, -0.42667428), metal::float4(0.9398312, -0.9604354, 0.3658308, -0.33952385), metal::float4(2.1453767, 0.41883147, 0.13601612, 0.28469568)) * input_a)) + (metal::float4x4(metal::float4(3.4403188, -2.590569, -0.35407397, 0.15499836), metal::float4(-3.986829, 1.1744475, -0.4495932, -0.42724657), metal::float4(1.8964103, -1.9111178, -0.21703586, 0.059154473), metal::float4(0.0, 0.0, 0.0, 0.0)) * input_b), metal::float4(0.0));
    metal::float4 layer_a_b = metal::max((metal::float4(-2.292158, -4.082672, 2.5777133, -3.3293636) + (metal::float4x4(metal::float4(-0.2882521, -0.19244438, 0.005596878, 3.4912097), metal::float4(-0.06646166, 2.2455816, -0.16431399, 2.3955905), metal::float4(0.0027962343, -0.44909182, 2.0802383, -0.16758871), metal::float4(1.5508057, 1.8308289, -0.3967934, 1.1351979)) * input_a)) + (metal::float4x4(metal::float4(-2.8654494, -2.8377588, 1.7030294, 0.7132829), metal::float4(-0.2943585, 0.9300847, -1.1661801, -2.691783), metal::float4(-2.3246937, -2.675964, 1.1706309, 0.24022791), metal::float4(0.0, 0.0, 0.0, 0.0)) * input_b), metal::float4(0.0));
    metal::float4 layer_a_c = metal::max((metal::float4(-6.0582685, 0.071703844, -6.644025, -2.3566966) + (metal::float4x4(metal::float4(-4.1196632, -0.057584286, 4.8446636, 0.32017657), metal::float4(0.008857606, 1.0856137, -0.11100713, -0.1447179), metal::float4(0.0064842957, 5.6722865, -0.90126324, -2.8072653), metal::float4(0.036267407, 2.1041884, -0.028005859, 0.85268795)) * input_a)) + (metal::float4x4(metal::float4(0.048658628, -2.169404, 0.99223906, -0.5344999), metal::float4(-0.063973464, 0.7389437, -0.60046536, -1.5282086), metal::float4(-0.033820074, -2.861401, 1.5477144, -0.048571143), metal::float4(0.0, 0.0, 0.0, 0.0)) * input_b), metal::float4(0.0));
    metal::float4 layer_a_d = metal::max((metal::float4(2.3266902, -1.7105882, -5.1085525, -1.3574784) + (metal::float4x4(metal::float4(0.46957853, 0.061224326, -3.4677196, -4.1848903), metal::float4(1.025234, -0.05415133, -0.11132763, 0.5050352), metal::float4(2.358727, -3.6185074, -1.1859872, 3.7355905), metal::float4(0.18320991, 0.31059298, -0.3545789, -1.5612853)) * input_a)) + (metal::float4x4(metal::float4(0.5406245, 0.2085216, 1.9980458, 0.31629506), metal::float4(-3.2949734, 1.2934533, 1.1872768, 6.041666), metal::float4(0.2954167, 1.0250587, -0.15270048, -1.4496956), metal::float4(0.0, 0.0, 0.0, 0.0)) * input_b), metal::float4(0.0));
    metal::float4 layer_a_e = metal::max((metal::float4(-2.0559886, -4.593814, -5.544627, -3.899631) + (metal::float4x4(metal::float4(0.2867262, 2.0739279, -1.3958248, -3.9333966), metal::float4(0.82912177, 2.3241487, 1.228594, 0.11684933), metal::float4(-4.1785088, 1.78666, 0.2534643, 3.310829), metal::float4(-1.3355628, 0.19066767, 2.9382062, -1.9437747)) * input_a)) + (metal::float4x4(metal::float4(-0.367026, 0.37342146, -0.80426174, 3.105593), metal::float4(1.598373, -0.7479142, 2.39233, -1.921577), metal::float4(1.5160427, 0.65475106, -0.37236342, -2.375993), metal::float4(0.0, 0.0, 0.0, 0.0)) * input_b), metal::float4(0.0));
    metal::float4 layer_a_f = metal::max((metal::float4(-4.746938, -1.8181075, 2.2504573, -4.3820977) + (metal::float4x4(metal::float4(-3.4118898, 1.5820951, -0.097776406, -2.6576033), metal::float4(-0.13359463, 0.41692016, 1.3381968, 0.45230743), metal::float4(-2.890177, 1.011956, -0.51970476, -3.536847), metal::float4(1.6924312, 1.106737, -1.6491486, 7.255562)) * input_a)) + (metal::float4x4(metal::float4(1.1239861, -0.06424348, 1.6186097, -1.0012686), metal::float4(1.7473792, -0.22418919, -2.2239234, 4.0941234), metal::float4(2.9428504, -0.49193555, 2.373575, 0.5170592), metal::float4(0.0, 0.0, 0.0, 0.0)) * input_b), metal::float4(0.0));
    metal::float4 layer_a_g = metal::max((metal::float4(-2.3252559, 2.1180289, -0.62233764, 1.2658082) + (metal::float4x4(metal::float4(1.8953658, 1.4404739, -0.1156854, -0.11159646), metal::float4(0.07755828, 1.1458684, 0.100420706, 0.6048202), metal::float4(-2.926418, 2.964085, -3.128958, -4.7000723), metal::float4(7.7386274, 1.8128313, 8.643714, 4.1751075)) * input_a)) + (metal::float4x4(metal::float4(0.5135093, 0.5821582, -0.07808471, 0.835642), metal::float4(3.2514741, -0.35249895, -5.986036, 11.433368), metal::float4(0.6976316, -0.35367787, 1.7349124, 2.4729054), metal::float4(0.0, 0.0, 0.0, 0.0)) * input_b), metal::float4(0.0));
    metal::float4 layer_a_h = metal::max((metal::float4(-3.6651616, -2.1963227, 1.8521855, -3.0912442) + (metal::float4x4(metal::float4(0.30053905, -0.5166352, -1.2267945, -0.032750957), metal::float4(0.5330755, -0.37390292, 0.40624705, -4.838783), metal::float4(0.15451619, -2.0131779, 1.0976602, 3.8161817), metal::float4(1.1863164, 1.0221006, 1.2432201, -0.7744267)) * input_a)) + (metal::float4x4(metal::float4(-1.0772957, -1.4839433, 2.7004633, 0.5539554), metal::float4(0.13470276, -1.1709794, 1.2809552, 1.5053821), metal::float4(-1.0768387, -0.3002995, 2.9974396, -1.5249768), metal::float4(0.0, 0.0, 0.0, 0.0)) * input_b), metal::float4(0.0));
    metal::float4 layer_b_a = metal::max((((((((metal::float4(0.9786026, -0.8337578, -1.1692648, 0.28682196) + (metal::float4x4(metal::float4(0.13913232, -4.243221, -1.0665591, -4.151318), metal::float4(-0.36208573, -10.514028, 1.6339943, -0.452374), metal::float4(-0.19195536, -3.163076, -1.7963235, -0.90505284), metal::float4(0.8713983, 1.1734929, -1.6124947, 3.9271743)) * layer_a_a)) + (metal::float4x4(metal::float4(1.4141093, 0.49077788, 1.7299143, -0.93626034), metal::float4(-1.3016136, -3.3095708, -3.4361544, -0.94041693), metal::float4(2.1711934, -5.3106284, 1.77, 0.3190314), metal::float4(-7.427047, 3.3281143, -4.222833, 0.12940662)) * layer_a_b)) + (metal::float4x4(metal::float4(-60.101624, -35.87233, -27.117441, -47.429073), metal::float4(1.2959683, -2.8649702, -7.3939714, -0.6826867), metal::float4(-0.79323626, 1.7900051, 3.599744, 2.5001616), metal::float4(-0.4204024, -2.5050838, 1.1341769, -0.9389565)) * layer_a_c)) + (metal::float4x4(metal::float4(0.2704493, -2.8197649, -0.6449255, -1.5031246), metal::float4(-3.5715075, 0.55384636, 3.5632312, 0.6593913), metal::float4(-4.158131, -4.5760345, -0.18597725, 1.7532617), metal::float4(0.49979258, -0.84475625, -0.36157018, 0.2619513)) * layer_a_d)) + (metal::float4x4(metal::float4(2.1408546, 2.4437244, 1.5570416, 1.9572284), metal::float4(1.7706817, -14.1111965, -4.38211, -1.1246116), metal::float4(-1.7000561, -2.5814738, -0.84444183, -3.4224498), metal::float4(-1.3254676, -3.50416, 0.2776598, 0.18455026)) * layer_a_e)) + (metal::float4x4(metal::float4(1.8515707, -2.427056, -0.44169432, 0.18023437), metal::float4(0.4239348, -0.9852741, 1.2676984, -1.5317844), metal::float4(-0.2815506, -6.802933, -1.8544303, 0.7137559), metal::float4(1.0369562, 1.7619655, -0.7421495, -1.6436723)) * layer_a_f)) + (metal::float4x4(metal::float4(-0.16388345, -0.5161793, 1.2869122, 0.75888485), metal::float4(-1.6450562, 9.805837, 6.6059566, 2.7563665), metal::float4(-3.3735049, 6.263107, 0.9127021, -2.5138555), metal::float4(-0.036161114, -1.5922551, -1.9861698, -1.7604103)) * layer_a_g)) + (metal::float4x4(metal::float4(1.1634917, -2.0251787, 0.8585597, -0.6351736), metal::float4(-0.22623837, -0.93386817, 0.90277153, 0.4720238), metal::float4(0.06609391, -0.6663569, -0.546716, -0.66738987), metal::float4(-0.9270881, 4.8962626, 2.526454, 2.9784133)) * layer_a_h), metal::float4(0.0));
    metal::float4 layer_b_b = metal::max((((((((metal::float4(-4.399031, -0.3655941, 2.5759757, -2.8039634) + (metal::float4x4(metal::float4(0.5860728, -0.41312113, -0.5339778, -2.5436523), metal::float4(-3.2123442, -0.35545105, 0.90952164, -0.9042172), metal::float4(-1.397227, -0.32570934, -1.4847938, 0.28359863), metal::float4(-0.029215327, -0.22666773, -1.2774813, 0.29181546)) * layer_a_a)) + (metal::float4x4(metal::float4(-1.4130111, -0.29844972, -1.9168285, 0.08717027), metal::float4(-1.1824931, -0.22710557, -1.1436272, -1.6768844), metal::float4(-5.976181, -0.16594656, -0.5360137, -1.0057794), metal::float4(-1.9563335, -0.5148606, -0.7034845, -0.20813742)) * layer_a_b)) + (metal::float4x4(metal::float4(45.56299, -0.22754142, -8.477289, 12.713284), metal::float4(1.2968478, -0.37371632, -5.320148, -1.1286782), metal::float4(0.4401303, -0.16822267, 1.5254971, -0.58488405), metal::float4(0.9805979, -0.46895415, -2.4513922, 1.8558638)) * layer_a_c)) + (metal::float4x4(metal::float4(-5.4192657, -0.4878423, -0.019184124, -1.2458792), metal::float4(-5.2175937, -0.3145961, -3.4966452, 9.336349), metal::float4(1.4686542, -0.4892903, 0.38078305, -1.4287267), metal::float4(3.1642385, -0.50660026, -60.32193, 0.24552904)) * layer_a_d)) + (metal::float4x4(metal::float4(1.5209091, -0.4676479, -1.6171503, 2.5074162), metal::float4(0.8638263, -0.2678482, -2.2277749, -0.69721615), metal::float4(-2.0822492, -0.38530192, 0.5922393, 0.03272635), metal::float4(1.2159762, -0.35885495, -12.301306, -2.2484314)) * layer_a_e)) + (metal::float4x4(metal::float4(1.3158994, -0.06749839, -0.12175901, 2.355424), metal::float4(0.23173174, -0.23088315, 0.7190362, 0.998652), metal::float4(1.3136766, -0.4303654, -1.2832055, 1.2822025), metal::float4(0.56278986, -0.26768142, 1.0536687, 0.84258807)) * layer_a_f)) + (metal::float4x4(metal::float4(-2.688075, -0.40681085, 0.79594034, 1.8326598), metal::float4(-4.57594, -0.40672067, 3.7195706, -4.708064), metal::float4(0.52766514, -0.29420477, -3.892407, 1.5762448), metal::float4(-1.3205037, -0.42056003, -1.0349307, -3.5742004)) * layer_a_g)) + (metal::float4x4(metal::float4(1.4545207, -0.40808782, 3.0716052, 2.7057772), metal::float4(1.7919858, -0.08009634, -1.2410463, 1.475636), metal::float4(0.3668509, -0.5201906, 0.8440753, 1.7558445), metal::float4(0.7682841, -0.40036586, -3.6236672, 1.3215802)) * layer_a_h), metal::float4(0.0));
    metal::float4 layer_b_c = metal::max((((((((metal::float4(-0.1298123, 2.0114899, -3.920499, 1.0784788) + (metal::float4x4(metal::float4(2.5167649, -0.4504233, -0.7371465, 2.4515252), metal::float4(2.1188233, 1.2752025, -2.0041087, 0.041754108), metal::float4(0.12232026, 0.45539692, -1.2092777, -0.94222677), metal::float4(2.152558, 0.8678625, -0.7956089, -0.29867724)) * layer_a_a)) + (metal::float4x4(metal::float4(2.647554, -2.0137887, -0.10578411, 0.43230012), metal::float4(-1.8052481, -0.40389818, -3.3037148, 2.133153), metal::float4(4.148494, 1.3500324, 0.95268095, -0.11156802), metal::float4(0.7563734, -2.6249006, -1.9897444, 0.7905821)) * layer_a_b)) + (metal::float4x4(metal::float4(12.880659, -52.865803, 16.896587, -73.68142), metal::float4(0.8256779, 0.005927399, 0.25391442, -2.4196832), metal::float4(1.9614295, 2.2657404, 2.1207542, 2.769689), metal::float4(1.2791903, -1.1316236, 1.5648323, -0.4922412)) * layer_a_c)) + (metal::float4x4(metal::float4(-1.5357984, 2.040068, -12.62448, 1.5091299), metal::float4(-7.1879683, -6.044005, 10.719704, -1.3918175), metal::float4(2.434496, 0.59703976, 0.33984438, -1.215056), metal::float4(2.4738138, -1.7866142, 0.669919, 0.6869074)) * layer_a_d)) + (metal::float4x4(metal::float4(3.258704, -3.9084678, -2.3752847, -6.5027885), metal::float4(-0.098349825, 1.7224265, -4.54496, -2.2242904), metal::float4(4.3867645, -0.44982064, -1.6597608, 4.4001956), metal::float4(-1.195773, -1.7928994, -0.31101957, 0.17846584)) * layer_a_e)) + (metal::float4x4(metal::float4(1.9368596, 5.5493836, 0.6947717, 0.379318), metal::float4(0.5654151, 0.69413114, 0.979331, 2.1723378), metal::float4(-1.7967491, 0.44440806, 0.51094484, -2.0406775), metal::float4(2.6821158, 3.8866014, 1.6215081, -1.334442)) * layer_a_f)) + (metal::float4x4(metal::float4(-3.8066175, -2.6484005, -0.9141631, -0.6281587), metal::float4(-0.49211407, 2.6169283, 4.024865, 2.8854337), metal::float4(-9.5702, -3.8132222, -0.11924985, -2.4443092), metal::float4(1.2557336, 0.39884526, -8.672953, 0.88396764)) * layer_a_g)) + (metal::float4x4(metal::float4(0.37285385, 0.11943968, 2.336689, -0.5076986), metal::float4(0.13728103, -2.3031478, 1.9437703, -0.40294617), metal::float4(-1.2039738, -1.9109086, -1.2568574, -0.4207217), metal::float4(-1.7593293, 0.75200456, 0.6114165, 2.1757648)) * layer_a_h), metal::float4(0.0));
    metal::float4 layer_b_d = metal::max((((((((metal::float4(1.1045655, -2.2081864, 1.7100037, -4.010171) + (metal::float4x4(metal::float4(-0.41236833, -0.80252755, 3.6228285, 0.79372257), metal::float4(-4.5915337, 0.29702947, 0.57977176, -2.2223241), metal::float4(-1.6297262, -0.998293, 0.3294796, -0.48678723), metal::float4(3.4397, 1.0088896, 1.3964089, 3.4572668)) * layer_a_a)) + (metal::float4x4(metal::float4(4.3263755, 2.0925548, -3.269233, -1.1675082), metal::float4(1.3882362, -2.2725008, -1.3166416, -1.3036383), metal::float4(-4.419009, -5.3920608, -1.2069099, -6.0700107), metal::float4(-19.001667, 1.0076998, 2.1017144, -2.6077592)) * layer_a_b)) + (metal::float4x4(metal::float4(-35.780003, 13.636623, 8.946084, 7.955274), metal::float4(0.57051635, -2.1722765, -2.3155196, -1.8109045), metal::float4(-5.3173046, 1.9548016, 0.54744, 1.2565329), metal::float4(-3.2724285, 1.682076, -0.1347996, -2.0934076)) * layer_a_c)) + (metal::float4x4(metal::float4(3.7278905, -0.25179222, -3.6983192, -4.3130364), metal::float4(6.5837216, 4.2556, -1.2606128, 1.4332665), metal::float4(-19.358643, -0.7239488, -8.900311, 0.15547659), metal::float4(-0.1683221, -0.39615023, -1.0786211, 2.4312003)) * layer_a_d)) + (metal::float4x4(metal::float4(-1.0363424, 3.1689353, 1.4636093, -2.6331446), metal::float4(-2.5531652, -2.9768162, -2.0414543, -0.47896895), metal::float4(-0.45827043, -1.0305113, -1.2893544, -1.1872928), metal::float4(-4.063683, -2.09375, -2.9692638, 1.178977)) * layer_a_e)) + (metal::float4x4(metal::float4(0.79249626, -0.80591697, -1.5300795, -2.2011023), metal::float4(-0.75769603, 1.3458482, -5.4326606, -1.9628452), metal::float4(1.3198189, 0.39204168, 1.798289, -4.5912504), metal::float4(-0.066744454, 2.705991, -0.013765329, -0.5923006)) * layer_a_f)) + (metal::float4x4(metal::float4(-1.269043, 0.594874, 0.12917712, -1.1173776), metal::float4(-2.2923887, -1.4799731, -3.255735, -2.1768992), metal::float4(4.8605223, -3.2926273, -0.011712195, -1.3787501), metal::float4(-0.23515476, 0.22610134, -0.77391917, 0.11813974)) * layer_a_g)) + (metal::float4x4(metal::float4(-0.89762634, -0.80920446, 3.0342827, 0.7948012), metal::float4(-3.0538828, 1.70562, -0.53257924, -1.55921), metal::float4(-1.1070861, 0.13097396, 3.3215525, -2.0132258), metal::float4(-0.061637282, -1.6530105, -6.3517966, 0.73836786)) * layer_a_h), metal::float4(0.0));
    float layer_c_a = 1.0 / (1.0 + metal::exp(metal::min(-(((((1.2284304 + metal::dot(metal::float4(-1.3643482, -1.5379357, 0.5703205, -0.69099027), layer_b_a)) + metal::dot(metal::float4(3.4361737, -0.3381907, -1.4897796, 2.2529972), layer_b_b)) + metal::dot(metal::float4(0.7103709, -0.3289794, 10.216331, -0.9627859), layer_b_c)) + metal::dot(metal::float4(-0.74268967, 1.0548358, -0.48424667, -0.70350206), layer_b_d))), 80.0)));
    return metal::clamp(layer_c_a, 0.000061035156, 1.0);
}

float peelnet_network(
    float zeta_2,
    metal::float2 extent_1,
    metal::float4 totals,
    metal::float4 moments
) {
    float _e4 = peelnet_depth(zeta_2, extent_1);
    float _e11 = peelnet_weight(_e4, totals.y, totals.x, moments.x, moments.y, moments.z, moments.w);
    return _e11;
}

float peelnet_fragment(
    float zeta_3,
    metal::float4 totals_1,
    metal::float4 moments_1,
    metal::float2 extent_2
) {
    float _e4 = peelnet_network(zeta_3, extent_2, totals_1, moments_1);
    return _e4;
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
    float absorbance_1,
    metal::float3 background_1
) {
    float transmittance_1 = metal::exp(-(absorbance_1));
    metal::float4 _e11 = peelnet_composite(metal::min(sums_1, metal::float4(65504.0)), 1.0 - transmittance_1, metal::float3(transmittance_1), background_1);
    return _e11;
}
