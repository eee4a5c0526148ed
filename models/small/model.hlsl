// A learned weight for order-independent transparency. Exported by peelnet 0.1.0.
// Licence of this generated text: MIT OR Apache-2.0.
// HLSL, shader model 6.0.
// Network: 5-1 (Relu hidden, Sigmoid last), 6 parameters, 5 multiply-adds. Recipe small, seed 1, 40 epochs.
// Answers: transmittance of what lies between a slab's known ends, exp(-absorbance * share) with absorbance = root_absorbance^2 and share in share_low .. share_high.
// Input 0: root_absorbance (root of the absorbance between the slab's ends), 0.0 .. 18.285723 in training.
// Input 1: depth_fraction (of the depth between the slab's ends), 0.0 .. 1.0 in training.
// Input 2: mean_fraction (of the depth between the slab's ends), 0.0 .. 1.0 in training.
// Input 3: share_low (of the absorbance between the slab's ends), 0.0 .. 1.0 in training.
// Input 4: share_high (of the absorbance between the slab's ends), 0.0 .. 1.0 in training.
// Trained on 21531714 rows of boxes, cups, foliage, intersecting, opaque-mix, panes, sixteen-025, sixteen-050, sixteen-075, sixteen-085, sixteen-random-alpha, sixteen-random-color, smoke-100, smoke-30, synthetic (dataset b7ad9cb0d2c09dc1638bcd9266d352a93f8e00bc73cd1e178a68bf55c7773289+ea59181067487e28a3ecbe45990ec58875bfc5212a817cbef25c5c9618a9c370).
// Loss: training 0.000240, validation 0.000233, test 0.000223.
// Held-out error, mean |T - T_exact|: boxes-held 0.01103, cups-held 0.00539, foliage-held 0.00253, panes-held 0.00058, sixteen-held 0.00294, smoke-held 0.00818.
//
// Self-tests, to some roundings of 32 bits; weights and colours also to those of 16-bit targets.
// peelnet_weight(7.116623, 0.014353275, 0.21181071, 0.010463357, 0.22229642) = 0.059675418
// peelnet_weight(2.7908742, 0.3421247, 0.95406777, 0.022867262, 0.49329907) = 0.6849483
// peelnet_weight(3.2184267, 0.5225114, 0.08770603, 0.111551285, 0.022744834) = 0.6955632
// Four fragments of a pixel, near 1.0, far 8.0, background 0.25, 0.5, 0.75:
//    z 1.0, alpha 0.5, rgb 1.0, 0.0, 0.0: zeta -1.0, weight 1.0
//    z 2.0, alpha 0.5, rgb 0.0, 1.0, 0.0: zeta -0.33333334, weight 0.5
//    z 4.0, alpha 0.5, rgb 0.0, 0.0, 1.0: zeta 0.33333334, weight 0.25
//    z 8.0, alpha 0.9, rgb 1.0, 1.0, 1.0: zeta 1.0, weight 0.125
//    target range: 1.0, 1.0
//    target absorbances: 0.6931472, 0.6931472, 2.995732, -0.6931472
//    target nearest: 64928.0, -0.00017380714, 0.061920166, -65088.0
//    target firsts: 0.033007007, 2.0715358
//    colour of the pixel: 0.615625, 0.36875, 0.246875
//
// How to draw with it. Targets may have 32 bits a channel wherever 16 are named.
// 0. zeta = peelnet_zeta(z, near, far): z is the distance along the view axis, near and far the range of z that the bounding boxes of the transparent objects in view span, clipped to the camera's. A tight range matters more than anything else you choose. Compute zeta with this function in all passes. Its range is the same for the whole frame: peelnet_zeta_in(z, peelnet_range(near, far)) is the same value, and the range may be passed in.
// 1. Pass "range": draw all transparent surfaces, in any order. float2 r = peelnet_pixel_range(zeta);
//    range: rg8unorm, cleared to 0, blending MAX, from r
// 2. Pass "statistics": draw all transparent surfaces, in any order. PeelnetStatistics s = peelnet_statistics(alpha, zeta, range);
//    absorbances: rgba16float, cleared to 0, blending ADD, from s.absorbances
//    nearest: rgba16float, cleared to -65504, blending MAX, from s.nearest
//    firsts: rg16float, cleared to 0, blending ADD, from s.firsts
// 3. Pass "weights": draw all transparent surfaces, in any order. float w = peelnet_fragment(alpha, zeta, range, absorbances, nearest, firsts).x;
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

struct PeelnetStatistics {
    float4 absorbances;
    float4 nearest;
    float2 firsts;
    int _end_pad_0;
    int _end_pad_1;
};

static const float PEELNET_FAINT = 0.003921569;
static const float PEELNET_RANGE_TOP = 255.0;
static const float PEELNET_BINS = 1920.0;
static const float PEELNET_OPACITIES = 32.0;
static const float PEELNET_EMPTY = -65504.0;
static const float PEELNET_FIRST_END = 0.15;
static const float PEELNET_SECOND_END = 0.5;
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

float2 peelnet_pixel_range(float zeta)
{
    float level = (PEELNET_RANGE_TOP * ((zeta * 0.5) + 0.5));
    return (float2((PEELNET_RANGE_TOP - floor(level)), ceil(level)) / (255.0).xx);
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

PeelnetPlace peelnet_place(float alpha_1, float zeta_1, float2 range_1)
{
    float2 ends_1 = floor(((range_1 * PEELNET_RANGE_TOP) + (0.5).xx));
    float low = (PEELNET_RANGE_TOP - ends_1.x);
    float t = clamp((((PEELNET_RANGE_TOP * ((zeta_1 * 0.5) + 0.5)) - low) / max((ends_1.y - low), 1.0)), 0.0, 1.0);
    const float _e27 = peelnet_absorbance(alpha_1);
    float first_1 = ((t >= PEELNET_FIRST_END) ? 1.0 : 0.0);
    float passed = ((first_1 + ((t >= PEELNET_SECOND_END) ? 1.0 : 0.0)) + ((t >= PEELNET_THIRD_END) ? 1.0 : 0.0));
    float slab_2 = min(passed, PEELNET_LAST_SLAB);
    const float _e52 = peelnet_of_slab(float4(0.0, 0.15, 0.5, 1.0), slab_2);
    const float _e58 = peelnet_of_slab(float4(0.15, 0.5, 1.0, 1.0), slab_2);
    float inside = ((t - _e52) / (_e58 - _e52));
    float bin_1 = min(floor((inside * PEELNET_BINS)), 1919.0);
    float opacity = floor((((_e27 / (_e27 + 1.0)) * 32.9375) + 0.5));
    float near_2 = (((1919.0 - bin_1) * PEELNET_OPACITIES) + opacity);
    const PeelnetPlace peelnetplace = ConstructPeelnetPlace(_e27, slab_2, ((2.0 * inside) - 1.0), bin_1, near_2, ((bin_1 * PEELNET_OPACITIES) + opacity));
    return peelnetplace;
}

float2 peelnet_records(float alpha_2, PeelnetPlace place)
{
    const float3 _e6 = peelnet_halves(float3(place.near, place.far, place.far));
    float2 levels_3 = _e6.xy;
    return ((alpha_2 < PEELNET_FAINT) ? (-65504.0).xx : levels_3);
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

PeelnetBetween peelnet_between(PeelnetPlace place_1, float total, float first, float2 levels_2)
{
    bool local = (bool)0;
    bool local_1 = (bool)0;
    float begin = (float)0;
    float end = (float)0;

    float b = place_1.absorbance;
    float others = max((total - b), 0.0);
    float noise_ = max((total * 0.0009765625), 1e-6);
    float near_back = floor((levels_2.x * 0.03125));
    float near_bin = (1919.0 - near_back);
    float near_level = (levels_2.x + ((near_bin - near_back) * PEELNET_OPACITIES));
    const float2 _e23 = peelnet_absorbances_of(levels_2);
    bool all_ = (_e23.x > (others - (((0.019354839 * (1.0 + _e23.x)) * (1.0 + _e23.x)) + noise_)));
    float near_3 = ((near_bin > place_1.bin) ? 0.0 : (all_ ? others : _e23.x));
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
    const float _e67 = peelnet_middle_of(near_bin);
    begin = _e67;
    const float _e69 = peelnet_middle_of(far_bin);
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
    float depth = clamp((moment / max(rest, noise_)), _e126, _e127);
    float _e129 = begin;
    float mean = clamp(((depth - _e129) * per_extent), 0.0, 1.0);
    bool before = (x < mean);
    float bound = ((before ? (1.0 - mean) : (x - mean)) / max((before ? (1.0 - x) : x), 1e-6));
    float low_1 = (before ? 0.0 : bound);
    float high = (before ? bound : 1.0);
    const PeelnetBetween peelnetbetween = ConstructPeelnetBetween(max(rest, 0.0), x, mean, low_1, high, (0.5 * extent_1), b, in_front);
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

float peelnet_share(float root_absorbance, float depth_fraction, float mean_fraction, float share_low, float share_high)
{
    float4 input_a = float4(root_absorbance, depth_fraction, mean_fraction, share_low);
    float4 input_b = float4(share_high, 0.0, 0.0, 0.0);
    float layer_a_a = (1.0 / (1.0 + exp(min(-(((0.43235356 + dot(float4(-0.1127578, 4.0526285, -4.443778, 0.32174426), input_a)) + (-0.24770096 * input_b.x))), 80.0))));
    return layer_a_a;
}

float peelnet_network(PeelnetBetween between)
{
    const float _e7 = peelnet_share(sqrt(between.absorbance), between.place, between.mean, between.low, between.high);
    return _e7;
}

float2 peelnet_weigh(PeelnetPlace place_2, bool counts, float4 absorbances, float4 firsts, float4 nearest, float4 farthest, float ends)
{
    bool local_3 = (bool)0;
    bool local_4 = (bool)0;
    bool local_5 = (bool)0;
    bool local_6 = (bool)0;
    bool local_7 = (bool)0;

    float4 sums_2 = min(absorbances, (65504.0).xxxx);
    const float _e11 = peelnet_of_slab(sums_2, place_2.slab);
    const float _e13 = peelnet_of_slab(firsts, place_2.slab);
    float first_2 = clamp(_e13, -65504.0, 65504.0);
    const float _e18 = peelnet_of_slab(nearest, place_2.slab);
    const float _e20 = peelnet_of_slab(farthest, place_2.slab);
    float2 halves_1 = float2(_e18, _e20);
    const float3 _e24 = peelnet_levels(float3(halves_1, halves_1.y));
    float2 decoded = _e24.xy;
    float2 levels_4 = ((place_2.slab < ends) ? decoded : float2(decoded.x, -1.0));
    float before_1 = ((((place_2.slab > 0.0) ? sums_2.x : 0.0) + ((place_2.slab > 1.0) ? sums_2.y : 0.0)) + ((place_2.slab > 2.0) ? sums_2.z : 0.0));
    if (counts) {
        const bool _e56 = peelnet_is_kept(place_2.near, levels_4.x);
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
        const bool _e70 = peelnet_is_kept(place_2.far, levels_4.y);
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
    const PeelnetBetween _e83 = peelnet_between(place_2, _e11, first_2, levels_4);
    const float _e88 = peelnet_network(_e83);
    float share_1 = (_e83.low + ((_e83.high - _e83.low) * _e88));
    float at_end = (is_far ? max((_e11 - place_2.absorbance), 0.0) : 0.0);
    float inside_1 = (known ? at_end : (_e83.nearest + (_e83.absorbance * share_1)));
    return float2(exp(-((before_1 + inside_1))), (known ? 1.0 : 0.0));
}

PeelnetStatistics ConstructPeelnetStatistics(float4 arg0, float4 arg1, float2 arg2) {
    PeelnetStatistics ret = (PeelnetStatistics)0;
    ret.absorbances = arg0;
    ret.nearest = arg1;
    ret.firsts = arg2;
    return ret;
}

PeelnetStatistics peelnet_statistics(float alpha_3, float zeta_2, float2 range_2)
{
    const PeelnetPlace _e3 = peelnet_place(alpha_3, zeta_2, range_2);
    const float2 _e4 = peelnet_records(alpha_3, _e3);
    const float4 _e8 = peelnet_in_slab(_e3.absorbance, _e3.slab, 0.0);
    const float4 _e12 = peelnet_in_slab(_e4.x, _e3.slab, PEELNET_EMPTY);
    const float4 _e18 = peelnet_in_slab((_e3.absorbance * _e3.inside), _e3.slab, 0.0);
    float farthest_1 = ((_e3.slab > 0.0) ? PEELNET_EMPTY : _e4.y);
    const PeelnetStatistics peelnetstatistics = ConstructPeelnetStatistics(float4(_e8.xyz, _e18.x), float4(_e12.xyz, farthest_1), _e18.yz);
    return peelnetstatistics;
}

float2 peelnet_fragment(float alpha_4, float zeta_3, float2 range_3, float4 absorbances_1, float4 nearest_1, float2 firsts_1)
{
    const PeelnetPlace _e6 = peelnet_place(alpha_4, zeta_3, range_3);
    float4 means = float4(absorbances_1.w, firsts_1, 0.0);
    float4 last = float4(nearest_1.w, (-65504.0).xxx);
    const float2 _e17 = peelnet_weigh(_e6, (alpha_4 >= PEELNET_FAINT), absorbances_1, means, nearest_1, last, 1.0);
    return _e17;
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

float4 peelnet_resolve(float4 sums_1, float absorbance, float3 background_1)
{
    float transmittance_1 = exp(-(absorbance));
    const float4 _e11 = peelnet_composite(min(sums_1, (65504.0).xxxx), (1.0 - transmittance_1), (transmittance_1).xxx, background_1);
    return _e11;
}

float peelnet_weight(float root_absorbance_1, float depth_fraction_1, float mean_fraction_1, float share_low_1, float share_high_1)
{
    float root = clamp(root_absorbance_1, 0.0, 256.0);
    const float _e23 = peelnet_share(clamp(root_absorbance_1, -34088.613, 34097.582), clamp(depth_fraction_1, -3009.4707, 3010.5063), clamp(mean_fraction_1, -1503.4812, 1504.4995), clamp(share_low_1, -2239.6372, 2239.9868), clamp(share_high_1, -2294.1284, 2295.7822));
    float2 bounds = clamp(float2(share_low_1, share_high_1), (0.0).xx, (1.0).xx);
    return exp(((-(root) * root) * lerp(bounds.x, bounds.y, _e23)));
}
