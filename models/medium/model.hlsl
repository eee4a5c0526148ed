// A learned weight for order-independent transparency. Exported by peelnet 0.1.0.
// Licence of this generated text: MIT OR Apache-2.0.
// HLSL, shader model 6.0.
// Network: 9-13-1 (Relu hidden, Sigmoid last), 144 parameters, 130 multiply-adds. Recipe medium, seed 1, 80 epochs.
// Answers: transmittance of what lies between a slab's known ends, exp(-absorbance * share) with absorbance = root_absorbance^2 and share in share_low .. share_high.
// Input 0: root_absorbance (root of the absorbance between the slab's ends), 0.0 .. 21.25096 in training.
// Input 1: place_fraction (of the way between the slab's ends), 0.0 .. 1.0 in training.
// Input 2: mean_fraction (of the way between the slab's ends), 0.0 .. 1.0 in training.
// Input 3: share_low (of the absorbance between the slab's ends), 0.0 .. 1.0 in training.
// Input 4: share_high (of the absorbance between the slab's ends), 0.0 .. 1.0 in training.
// Input 5: root_own (root of the fragment's absorbance), 0.031630483 .. 2.4013393 in training.
// Input 6: half_extent (half of the way between the slab's ends, in slabs), 0.00052083336 .. 1.0 in training.
// Input 7: of_own (absorbance between the ends, of that and the fragment's), 0.0 .. 0.9999915 in training.
// Input 8: of_nearest (absorbance between the ends, of that and the nearer end's), 0.0 .. 1.0 in training.
// Trained on 21565798 rows of boxes, cups, foliage, intersecting, opaque-mix, panes, sixteen-025, sixteen-050, sixteen-075, sixteen-085, sixteen-random-alpha, sixteen-random-color, smoke-100, smoke-30, synthetic (dataset f0e6c4a7cca08d560f99a5be9cbd1514bf8be352632a347602bf08363695fd29+e22e844788a454658277e87e23685b5ffa00e3ad2d48cb833cc53130eaf4d8b7).
// Loss: training 0.000147, validation 0.000138, test 0.000150.
// Held-out error, mean |T - T_exact|: boxes-held 0.00280, cups-held 0.00251, foliage-held 0.00075, panes-held 0.00025, sixteen-held 0.00059, smoke-held 0.00570.
//
// Self-tests, to some roundings of 32 bits; weights and colours also to those of 16-bit targets.
// peelnet_weight(0.48334956, 0.67085797, 0.16887921, 0.7373583, 0.19208878, 0.1129206, 0.12900263, 0.43583557, 0.7663156) = 0.8680153
// peelnet_weight(0.2974678, 0.13589168, 0.26682287, 0.7078695, 0.5534122, 0.8413221, 0.6951227, 0.37161863, 0.9624051) = 0.9411046
// peelnet_weight(2.7055542, 0.2162394, 0.7240006, 0.37958002, 0.26558614, 1.9607327, 0.5804378, 0.9097903, 0.04841405) = 0.066045314
// Four fragments of a pixel, near 1.0, far 8.0, background 0.25, 0.5, 0.75:
//    z 1.0, alpha 0.5, rgb 1.0, 0.0, 0.0: zeta -1.0, weight 1.0
//    z 2.0, alpha 0.5, rgb 0.0, 1.0, 0.0: zeta -0.33333334, weight 0.5
//    z 4.0, alpha 0.5, rgb 0.0, 0.0, 1.0: zeta 0.33333334, weight 0.25
//    z 8.0, alpha 0.9, rgb 1.0, 1.0, 1.0: zeta 1.0, weight 0.125
//    target bins_front: 0.17254902, 0.0, 0.14509805, 0.02745098
//    target bins_back: 0.02745098, 0.14509805, 0.0, 0.5764706
//    target range: 1.0, 1.0
//    target absorbances: 1.3862944, 0.6931472, 2.302585, -0.011217061
//    target nearest: 64928.0, -25.28125, -64768.0, 0.42932084
//    target farthest: 49568.0, 25.203125, 65248.0, 2.302585
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
//    nearest: rgba16float, cleared to -65504, -65504, -65504, 0, blending MAX for rgb, ADD for alpha, from s.nearest
//    farthest: rgba16float, cleared to -65504, -65504, -65504, 0, blending MAX for rgb, ADD for alpha, from s.farthest
// 3. Pass "weights": draw all transparent surfaces, in any order. float w = peelnet_fragment(alpha, peelnet_in_pixel(zeta, bins_front, bins_back, range), absorbances, nearest, farthest).x;
//    sums: rgba16float, cleared to 0, blending ADD, from float4(alpha * rgb, alpha) * w
// 4. Resolve: peelnet_resolve(sums, absorbances.x + absorbances.y + absorbances.z, background) is the colour of the pixel, and its coverage in alpha.
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
    float4 front;
    float4 back;
    float2 range;
    int _end_pad_0;
    int _end_pad_1;
};

struct PeelnetStatistics {
    float4 absorbances;
    float4 nearest;
    float4 farthest;
};

static const float PEELNET_BIN_LEVELS = 64.0;
static const float PEELNET_FAINT = 0.003921569;
static const float PEELNET_BINS = 1920.0;
static const float PEELNET_OPACITIES = 32.0;
static const float PEELNET_EMPTY = -65504.0;
static const float PEELNET_FIRST_END = 0.475;
static const float PEELNET_SECOND_END = 0.81;
static const float PEELNET_THIRD_END = 1.0;
static const float PEELNET_LAST_SLAB = 2.0;

PeelnetRange ConstructPeelnetRange(float arg0, float arg1, float arg2) {
    PeelnetRange ret = (PeelnetRange)0;
    ret.inverse_near = arg0;
    ret.near = arg1;
    ret.scale = arg2;
    return ret;
}

PeelnetRange peelnet_range(float near, float far)
{
    bool linear_ = (near <= 0.0);
    float inverse_near = (linear_ ? 0.0 : (1.0 / max(near, 1.1754944e-38)));
    float extent = (linear_ ? (far - near) : log(max((far * inverse_near), 1.0)));
    bool flat = (extent <= (linear_ ? 0.0 : 1e-6));
    const PeelnetRange peelnetrange = ConstructPeelnetRange(inverse_near, near, (flat ? 0.0 : (2.0 / max(extent, 1e-30))));
    return peelnetrange;
}

float peelnet_zeta_in(float z, PeelnetRange range)
{
    float logarithmic = log(max((z * range.inverse_near), 1.0));
    float from_near = ((range.inverse_near == 0.0) ? (z - range.near) : logarithmic);
    return clamp(((from_near * range.scale) - 1.0), -1.0, 1.0);
}

float peelnet_zeta(float z_1, float near_1, float far_1)
{
    const PeelnetRange _e3 = peelnet_range(near_1, far_1);
    const float _e4 = peelnet_zeta_in(z_1, _e3);
    return _e4;
}

float peelnet_absorbance(float alpha)
{
    return -(log(max((1.0 - alpha), 1.1253517e-7)));
}

int3 naga_f2i32(float3 value) {
    return int3(clamp(value, -2147483600.0, 2147483500.0));
}

float3 peelnet_halves(float3 levels)
{
    float3 from_middle = (levels - (30719.5).xxx);
    return (sign(from_middle) * asfloat(naga_f2i32(((abs(from_middle) * 8192.0) + (947908600.0).xxx))));
}

float3 peelnet_levels(float3 halves)
{
    float3 from_middle_1 = ((float3(asint(abs(halves))) * 0.00012207031) - (115711.5).xxx);
    return ((30719.5).xxx + (sign(halves) * from_middle_1));
}

float peelnet_cut(float zeta, float4 gaps)
{
    float2 lengths = (gaps.yw - gaps.xz);
    float2 passed = clamp(((zeta).xx - gaps.xz), (0.0).xx, lengths);
    float kept_1 = (((zeta + 1.0) - passed.x) - passed.y);
    return ((kept_1 * (2.0 / ((2.0 - lengths.x) - lengths.y))) - 1.0);
}

float peelnet_level(float absorbance)
{
    return max(floor(((absorbance * PEELNET_BIN_LEVELS) + 0.5)), 1.0);
}

float4 peelnet_in_bins(float level, float place, float first)
{
    float4 middles = float4(first, (first + 1.0), (first + 2.0), (first + 3.0));
    float4 shares = max(((1.0).xxxx - abs(((place).xxxx - middles))), (0.0).xxxx);
    return (floor(((level * shares) + (0.5).xxxx)) / (255.0).xxxx);
}

float4 peelnet_seen_behind(float before, float4 bins)
{
    float two = (bins.x + bins.y);
    float4 levels_3 = ((before).xxxx + float4(bins.x, two, (two + bins.z), ((two + bins.z) + bins.w)));
    return exp((levels_3 * -3.984375));
}

float2 peelnet_range_of(float zeta_1)
{
    float level_1 = (127.5 * (zeta_1 + 1.0));
    return (float2((255.0 - floor(level_1)), ceil(level_1)) / (255.0).xx);
}

float2 peelnet_ends_of(float2 range_1)
{
    float2 levels_4 = floor(((range_1 * 255.0) + (0.5).xx));
    float nearest_2 = (255.0 - levels_4.x);
    return float2(nearest_2, max(levels_4.y, (nearest_2 + 1.0)));
}

PeelnetBins ConstructPeelnetBins(float4 arg0, float4 arg1, float2 arg2) {
    PeelnetBins ret = (PeelnetBins)0;
    ret.front = arg0;
    ret.back = arg1;
    ret.range = arg2;
    return ret;
}

PeelnetBins peelnet_bins(float alpha_1, float zeta_2)
{
    float place_5 = clamp(((zeta_2 * 4.0) + 3.5), 0.0, 7.0);
    const float _e9 = peelnet_absorbance(alpha_1);
    const float _e10 = peelnet_level(_e9);
    const float4 _e12 = peelnet_in_bins(_e10, place_5, 0.0);
    const float4 _e14 = peelnet_in_bins(_e10, place_5, 4.0);
    const float2 _e15 = peelnet_range_of(zeta_2);
    const PeelnetBins peelnetbins = ConstructPeelnetBins(_e12, _e14, _e15);
    return peelnetbins;
}

float peelnet_up_to(float place_1, float4 front, float4 back)
{
    float4 a = abs(((place_1).xxxx - float4(0.0, 1.0, 2.0, 3.0)));
    float4 b = abs(((place_1).xxxx - float4(4.0, 5.0, 6.0, 7.0)));
    return (dot(front, (a - float4(a.yzw, b.x))) + dot(back, (b - float4(b.yzw, abs((place_1 - 8.0))))));
}

float peelnet_in_pixel(float zeta_3, float4 front_1, float4 back_1, float2 range_2)
{
    float place_6 = ((zeta_3 * 4.0) + 4.0);
    const float4 _e9 = peelnet_seen_behind(0.0, front_1);
    const float4 _e13 = peelnet_seen_behind(dot(front_1, (1.0).xxxx), back_1);
    float4 of_front = sqrt(abs((float4(1.0, _e9.xyz) - _e9)));
    float4 of_back = sqrt(abs((float4(_e9.w, _e13.xyz) - _e13)));
    const float2 _e26 = peelnet_ends_of(range_2);
    float2 ends_1 = (_e26 * 0.03137255);
    const float _e30 = peelnet_up_to(ends_1.x, of_front, of_back);
    const float _e32 = peelnet_up_to(ends_1.y, of_front, of_back);
    float all_ = (_e32 - _e30);
    const float _e34 = peelnet_up_to(place_6, of_front, of_back);
    float passed_1 = ((_e34 - _e30) / max(all_, 1e-6));
    return ((all_ == 0.0) ? sqrt((place_6 * 0.125)) : clamp(passed_1, 0.0, 1.0));
}

float peelnet_of_slab(float4 values, float slab)
{
    return ((slab >= 2.0) ? ((slab == 3.0) ? values.w : values.z) : ((slab == 1.0) ? values.y : values.x));
}

PeelnetPlace ConstructPeelnetPlace(float arg0, float arg1, float arg2, float arg3, float arg4, float arg5) {
    PeelnetPlace ret = (PeelnetPlace)0;
    ret.absorbance = arg0;
    ret.slab = arg1;
    ret.inside = arg2;
    ret.bin = arg3;
    ret.near = arg4;
    ret.far = arg5;
    return ret;
}

PeelnetPlace peelnet_place(float alpha_2, float t)
{
    const float _e2 = peelnet_absorbance(alpha_2);
    float first_2 = ((t >= PEELNET_FIRST_END) ? 1.0 : 0.0);
    float passed_2 = ((first_2 + ((t >= PEELNET_SECOND_END) ? 1.0 : 0.0)) + ((t >= PEELNET_THIRD_END) ? 1.0 : 0.0));
    float slab_2 = min(passed_2, PEELNET_LAST_SLAB);
    const float _e27 = peelnet_of_slab(float4(0.0, 0.475, 0.81, 1.0), slab_2);
    const float _e33 = peelnet_of_slab(float4(0.475, 0.81, 1.0, 1.0), slab_2);
    float inside = ((t - _e27) / (_e33 - _e27));
    float bin_1 = min(floor((inside * PEELNET_BINS)), 1919.0);
    float opacity = floor((((_e2 / (_e2 + 1.0)) * 32.9375) + 0.5));
    float near_2 = (((1919.0 - bin_1) * PEELNET_OPACITIES) + opacity);
    const PeelnetPlace peelnetplace = ConstructPeelnetPlace(_e2, slab_2, ((2.0 * inside) - 1.0), bin_1, near_2, ((bin_1 * PEELNET_OPACITIES) + opacity));
    return peelnetplace;
}

float2 peelnet_records(float alpha_3, PeelnetPlace place_2)
{
    const float3 _e6 = peelnet_halves(float3(place_2.near, place_2.far, place_2.far));
    float2 levels_5 = _e6.xy;
    return ((alpha_3 < PEELNET_FAINT) ? (-65504.0).xx : levels_5);
}

float2 peelnet_absorbances_of(float2 levels_1)
{
    float2 share = ((levels_1 - (floor((levels_1 * 0.03125)) * PEELNET_OPACITIES)) * 0.032258064);
    return (share / ((1.0625).xx - share));
}

float peelnet_middle_of(float bin)
{
    return (((bin + 0.5) * 0.0010416667) - 1.0);
}

float4 peelnet_in_slab(float value, float slab_1, float elsewhere)
{
    return float4(((slab_1 == 0.0) ? value : elsewhere), ((slab_1 == 1.0) ? value : elsewhere), ((slab_1 == 2.0) ? value : elsewhere), ((slab_1 == 3.0) ? value : elsewhere));
}

PeelnetBetween ConstructPeelnetBetween(float arg0, float arg1, float arg2, float arg3, float arg4, float arg5, float arg6, float arg7) {
    PeelnetBetween ret = (PeelnetBetween)0;
    ret.absorbance = arg0;
    ret.place = arg1;
    ret.mean = arg2;
    ret.low = arg3;
    ret.high = arg4;
    ret.extent = arg5;
    ret.own = arg6;
    ret.nearest = arg7;
    return ret;
}

PeelnetBetween peelnet_between(PeelnetPlace place_3, float total, float first_1, float2 levels_2)
{
    bool local = (bool)0;
    bool local_1 = (bool)0;
    float begin = (float)0;
    float end = (float)0;

    float b_1 = place_3.absorbance;
    float others = max((total - b_1), 0.0);
    float noise_ = max((total * 0.0009765625), 1e-6);
    float near_back = floor((levels_2.x * 0.03125));
    float near_bin = (1919.0 - near_back);
    float near_level = (levels_2.x + ((near_bin - near_back) * PEELNET_OPACITIES));
    const float2 _e23 = peelnet_absorbances_of(levels_2);
    bool all_1 = (_e23.x > (others - (((0.019354839 * (1.0 + _e23.x)) * (1.0 + _e23.x)) + noise_)));
    float near_3 = ((near_bin > place_3.bin) ? 0.0 : (all_1 ? others : _e23.x));
    float far_bin = floor((levels_2.y * 0.03125));
    if (!((levels_2.y == near_level))) {
        local = (levels_2.y < 0.0);
    } else {
        local = true;
    }
    bool is_one = local;
    if (!(is_one)) {
        local_1 = (far_bin < place_3.bin);
    } else {
        local_1 = true;
    }
    bool _e64 = local_1;
    float far_2 = (_e64 ? 0.0 : _e23.y);
    const float _e67 = peelnet_middle_of(near_bin);
    begin = _e67;
    const float _e69 = peelnet_middle_of(far_bin);
    end = (is_one ? 1.0 : _e69);
    float rest = (((total - b_1) - near_3) - far_2);
    float _e79 = begin;
    float _e82 = end;
    float moment = (((first_1 - (b_1 * place_3.inside)) - (near_3 * _e79)) - (far_2 * _e82));
    float _e85 = begin;
    float _e86 = begin;
    begin = ((_e86 > place_3.inside) ? -1.0 : _e85);
    float _e91 = end;
    float _e92 = end;
    end = ((_e92 < place_3.inside) ? 1.0 : _e91);
    float in_front = ((near_3 * ((near_bin == place_3.bin) ? 0.5 : 1.0)) + (far_2 * ((far_bin == place_3.bin) ? 0.5 : 0.0)));
    float _e110 = end;
    float _e111 = begin;
    float extent_1 = max((_e110 - _e111), 0.0010416667);
    float per_extent = (1.0 / extent_1);
    float _e118 = begin;
    float x = clamp(((place_3.inside - _e118) * per_extent), 0.0, 1.0);
    float _e126 = begin;
    float _e127 = end;
    float depth = clamp((moment / max(rest, noise_)), _e126, _e127);
    float _e129 = begin;
    float mean = clamp(((depth - _e129) * per_extent), 0.0, 1.0);
    bool before_1 = (x < mean);
    float bound = ((before_1 ? (1.0 - mean) : (x - mean)) / max((before_1 ? (1.0 - x) : x), 1e-6));
    float low = (before_1 ? 0.0 : bound);
    float high = (before_1 ? bound : 1.0);
    const PeelnetBetween peelnetbetween = ConstructPeelnetBetween(max(rest, 0.0), x, mean, low, high, (0.5 * extent_1), b_1, in_front);
    return peelnetbetween;
}

bool peelnet_is_kept(float own, float kept)
{
    bool local_2 = (bool)0;

    float apart = abs((own - kept));
    if (!((apart == 0.0))) {
        local_2 = (apart == PEELNET_OPACITIES);
    } else {
        local_2 = true;
    }
    bool _e12 = local_2;
    return _e12;
}

float peelnet_share(float root_absorbance, float place_fraction, float mean_fraction, float share_low, float share_high, float root_own, float half_extent, float of_own, float of_nearest)
{
    float4 input_a = float4(root_absorbance, place_fraction, mean_fraction, share_low);
    float4 input_b = float4(share_high, root_own, half_extent, of_own);
    float4 input_c = float4(of_nearest, 0.0, 0.0, 0.0);
    float4 layer_a_a = max((((float4(-1.4641386, -3.3562605, 8.56328, 7.9295816) + mul(input_a, float4x4(float4(-0.062875085, -0.044414904, -0.045489606, -0.07379496), float4(1.703964, 1.899293, -1.2000672, -2.6386976), float4(1.8144727, -1.7142202, -0.8144927, -0.71155626), float4(0.47746012, 0.9861568, 0.8539375, 2.5413916)))) + mul(input_b, float4x4(float4(1.5533057, 1.7421483, 0.85063446, -1.2913522), float4(0.5555127, 0.8219148, -0.012739913, -1.4782242), float4(-0.5184329, 4.586603, 2.1503766, -2.4249082), float4(1.1940901, -3.0581594, -1.1037587, -1.0768601)))) + (float4(-1.8912773, 0.5968488, -8.25149, -0.740267) * input_c.x)), (0.0).xxxx);
    float4 layer_a_b = max((((float4(-3.435276, -3.0695794, 3.38485, -9.666815) + mul(input_a, float4x4(float4(0.1240001, 0.050277658, -0.054266352, 0.15960346), float4(-1.4091853, 1.1852088, 2.4092836, 4.852766), float4(-1.7622716, -1.6526178, -3.9796207, 4.484973), float4(2.2075722, 3.8548405, 0.8623253, 3.6745415)))) + mul(input_b, float4x4(float4(2.202639, 5.9497824, -0.058958687, 2.6287017), float4(1.348361, -0.5333857, -1.5144511, -0.18664494), float4(1.7184564, -0.055434026, -0.22081658, -0.3716273), float4(-0.40209323, -3.8325782, 1.8777025, 0.19611548)))) + (float4(1.7847227, 0.8313226, -2.1540985, -1.1985334) * input_c.x)), (0.0).xxxx);
    float4 layer_a_c = max((((float4(1.0071908, 3.4967759, 5.591461, 4.5318055) + mul(input_a, float4x4(float4(-0.26753965, 0.06484478, -0.018652525, 0.08553129), float4(1.6324673, -2.843409, -0.45813456, -0.0043214555), float4(-3.7041008, -1.7365564, 2.6887474, -0.5723574), float4(-3.1260092, -1.8425844, -6.1553755, -7.8002076)))) + mul(input_b, float4x4(float4(1.7835314, -1.1375017, -2.9750838, -1.3568959), float4(1.0672754, 0.076174654, 0.44796503, -0.3170386), float4(-0.4925571, -1.0347719, -2.3352869, 0.3858673), float4(-0.33531374, 0.28107768, -1.2299383, -4.0824766)))) + (float4(1.068785, -0.8180279, -1.8280076, -0.27818996) * input_c.x)), (0.0).xxxx);
    float4 layer_a_d = max((((float4(12.364563, 0.0, 0.0, 0.0) + mul(input_a, float4x4(float4(0.010403197, 0.0, 0.0, 0.0), float4(0.14919655, 0.0, 0.0, 0.0), float4(-0.22271577, 0.0, 0.0, 0.0), float4(-5.0166383, 0.0, 0.0, 0.0)))) + mul(input_b, float4x4(float4(-1.8775809, 0.0, 0.0, 0.0), float4(0.008815818, 0.0, 0.0, 0.0), float4(-1.6784344, 0.0, 0.0, 0.0), float4(-0.2517419, 0.0, 0.0, 0.0)))) + (float4(-9.882709, 0.0, 0.0, 0.0) * input_c.x)), (0.0).xxxx);
    float layer_b_a = (1.0 / (1.0 + exp(min(-(((((-0.037035838 + dot(float4(-0.68024015, 0.36019412, -0.42563558, -0.44534072), layer_a_a)) + dot(float4(-0.47680685, 1.0096582, 0.43886814, 1.5624919), layer_a_b)) + dot(float4(0.45026985, -0.9147628, -0.380483, -1.3764257), layer_a_c)) + (0.6037574 * layer_a_d.x))), 80.0))));
    return layer_b_a;
}

float peelnet_network(PeelnetBetween between)
{
    const float _e24 = peelnet_share(sqrt(between.absorbance), between.place, between.mean, between.low, between.high, sqrt(between.own), between.extent, (between.absorbance / ((between.absorbance + between.own) + 1e-6)), (between.absorbance / ((between.absorbance + between.nearest) + 1e-6)));
    return _e24;
}

float2 peelnet_weigh(PeelnetPlace place_4, bool counts, float4 absorbances, float4 firsts, float4 nearest, float4 farthest, float ends)
{
    bool local_3 = (bool)0;
    bool local_4 = (bool)0;
    bool local_5 = (bool)0;
    bool local_6 = (bool)0;
    bool local_7 = (bool)0;

    float4 sums_2 = min(absorbances, (65504.0).xxxx);
    const float _e11 = peelnet_of_slab(sums_2, place_4.slab);
    const float _e13 = peelnet_of_slab(firsts, place_4.slab);
    float first_3 = clamp(_e13, -65504.0, 65504.0);
    const float _e18 = peelnet_of_slab(nearest, place_4.slab);
    const float _e20 = peelnet_of_slab(farthest, place_4.slab);
    float2 halves_1 = float2(_e18, _e20);
    const float3 _e24 = peelnet_levels(float3(halves_1, halves_1.y));
    float2 decoded = _e24.xy;
    float2 levels_6 = ((place_4.slab < ends) ? decoded : float2(decoded.x, -1.0));
    float before_2 = ((((place_4.slab > 0.0) ? sums_2.x : 0.0) + ((place_4.slab > 1.0) ? sums_2.y : 0.0)) + ((place_4.slab > 2.0) ? sums_2.z : 0.0));
    if (counts) {
        const bool _e56 = peelnet_is_kept(place_4.near, levels_6.x);
        local_3 = _e56;
    } else {
        local_3 = false;
    }
    bool is_near = local_3;
    if (counts) {
        local_4 = (levels_6.y >= 0.0);
    } else {
        local_4 = false;
    }
    bool _e65 = local_4;
    if (_e65) {
        const bool _e70 = peelnet_is_kept(place_4.far, levels_6.y);
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
    const PeelnetBetween _e83 = peelnet_between(place_4, _e11, first_3, levels_6);
    const float _e88 = peelnet_network(_e83);
    float share_1 = (_e83.low + ((_e83.high - _e83.low) * _e88));
    float at_end = (is_far ? max((_e11 - place_4.absorbance), 0.0) : 0.0);
    float inside_1 = (known ? at_end : (_e83.nearest + (_e83.absorbance * share_1)));
    return float2(exp(-((before_2 + inside_1))), (known ? 1.0 : 0.0));
}

PeelnetStatistics ConstructPeelnetStatistics(float4 arg0, float4 arg1, float4 arg2) {
    PeelnetStatistics ret = (PeelnetStatistics)0;
    ret.absorbances = arg0;
    ret.nearest = arg1;
    ret.farthest = arg2;
    return ret;
}

PeelnetStatistics peelnet_statistics(float alpha_4, float t_1)
{
    const PeelnetPlace _e2 = peelnet_place(alpha_4, t_1);
    const float2 _e3 = peelnet_records(alpha_4, _e2);
    const float4 _e7 = peelnet_in_slab(_e2.absorbance, _e2.slab, 0.0);
    const float4 _e11 = peelnet_in_slab(_e3.x, _e2.slab, PEELNET_EMPTY);
    const float4 _e17 = peelnet_in_slab((_e2.absorbance * _e2.inside), _e2.slab, 0.0);
    const float4 _e21 = peelnet_in_slab(_e3.y, _e2.slab, PEELNET_EMPTY);
    const PeelnetStatistics peelnetstatistics = ConstructPeelnetStatistics(float4(_e7.xyz, _e17.x), float4(_e11.xyz, _e17.y), float4(_e21.xyz, _e17.z));
    return peelnetstatistics;
}

float2 peelnet_fragment(float alpha_5, float t_2, float4 absorbances_1, float4 nearest_1, float4 farthest_1)
{
    const PeelnetPlace _e5 = peelnet_place(alpha_5, t_2);
    float4 firsts_1 = float4(absorbances_1.w, nearest_1.w, farthest_1.w, 0.0);
    const float2 _e14 = peelnet_weigh(_e5, (alpha_5 >= PEELNET_FAINT), absorbances_1, firsts_1, nearest_1, farthest_1, 3.0);
    return _e14;
}

float4 peelnet_composite(float4 sums, float coverage, float3 transmittance, float3 background)
{
    bool local_8 = (bool)0;

    if ((sums.w > 0.0)) {
        local_8 = (coverage > 0.0);
    } else {
        local_8 = false;
    }
    bool _e20 = local_8;
    float3 average = (_e20 ? (sums.xyz / (max(sums.w, 1.1754944e-38)).xxx) : (0.0).xxx);
    return float4(((average * coverage) + (background * transmittance)), coverage);
}

float4 peelnet_resolve(float4 sums_1, float absorbance_1, float3 background_1)
{
    float transmittance_1 = exp(-(absorbance_1));
    const float4 _e11 = peelnet_composite(min(sums_1, (65504.0).xxxx), (1.0 - transmittance_1), (transmittance_1).xxx, background_1);
    return _e11;
}

float peelnet_weight(float root_absorbance_1, float place_fraction_1, float mean_fraction_1, float share_low_1, float share_high_1, float root_own_1, float half_extent_1, float of_own_1, float of_nearest_1)
{
    float root = clamp(root_absorbance_1, 0.0, 256.0);
    const float _e39 = peelnet_share(clamp(root_absorbance_1, -46549.746, 46561.754), clamp(place_fraction_1, -3128.1426, 3129.5498), clamp(mean_fraction_1, -2148.7454, 2150.152), clamp(share_low_1, -1742.304, 1742.5583), clamp(share_high_1, -2759.7317, 2761.3855), clamp(root_own_1, -5650.0513, 5651.64), clamp(half_extent_1, -2216.933, 2218.4595), clamp(of_own_1, -1664.0962, 1665.9397), clamp(of_nearest_1, -1659.8347, 1661.6699));
    float2 bounds = clamp(float2(share_low_1, share_high_1), (0.0).xx, (1.0).xx);
    return exp(((-(root) * root) * lerp(bounds.x, bounds.y, _e39)));
}
