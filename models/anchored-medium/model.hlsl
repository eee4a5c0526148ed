// A learned weight for order-independent transparency. Exported by peelnet 0.1.0.
// Licence of this generated text: MIT OR Apache-2.0.
// HLSL, shader model 6.0.
// Network: 5-12-1 (Relu hidden, Sigmoid last), 85 parameters, 72 multiply-adds. Recipe anchored-medium, seed 1, 80 epochs.
// Answers: transmittance of the rest, exp(-rest * share) with rest = root_absorbance^2 and share in 0 .. 1.
// Input 0: root_absorbance (root of the rest's absorbance), 0.0 .. 21.672869 in training.
// Input 1: depth_fraction (of the pixel's depth range), 0.0 .. 1.0 in training.
// Input 2: mean_fraction (of the pixel's depth range), 0.0 .. 1.0 in training.
// Input 3: share_low (of the rest's absorbance), 0.0 .. 1.0 in training.
// Input 4: share_high (of the rest's absorbance), 0.0 .. 1.0 in training.
// Trained on boxes, cups, foliage, intersecting, opaque-mix, panes, sixteen-025, sixteen-050, sixteen-075, sixteen-085, sixteen-random-alpha, sixteen-random-color, smoke-100, smoke-30, synthetic, of a dataset of 21531714 rows (b7ad9cb0d2c09dc1638bcd9266d352a93f8e00bc73cd1e178a68bf55c7773289+ea59181067487e28a3ecbe45990ec58875bfc5212a817cbef25c5c9618a9c370).
// Loss: training 0.000286, validation 0.000283, test 0.000284.
// Held-out error, mean |T - T_exact|: boxes-held 0.01767, cups-held 0.01845, foliage-held 0.00934, panes-held 0.00575, sixteen-held 0.01032, smoke-held 0.01492.
//
// Self-tests, to some roundings of 32 bits; weights and colours also to those of 16-bit targets.
// peelnet_weight(8.434867, 0.014353275, 0.21181071, 0.010463357, 0.22229642) = 0.13616015
// peelnet_weight(12.38736, 0.06893927, 0.677021, 0.9734965, 0.49854618) = 0.07002933
// peelnet_weight(3.30784, 0.3421247, 0.95406777, 0.022867262, 0.49329907) = 0.13059078
// Four fragments of a pixel, near 1.0, far 8.0, background 0.25, 0.5, 0.75:
//    z 1.0, alpha 0.5, rgb 1.0, 0.0, 0.0: zeta -1.0, weight 1.0
//    z 2.0, alpha 0.5, rgb 0.0, 1.0, 0.0: zeta -0.33333334, weight 0.49881455
//    z 4.0, alpha 0.5, rgb 0.0, 0.0, 1.0: zeta 0.33333334, weight 0.25946447
//    z 8.0, alpha 0.9, rgb 1.0, 1.0, 1.0: zeta 1.0, weight 0.125
//    colour of the pixel: 0.615625, 0.3654342, 0.2501908
//
// How to draw with it. Targets may have 32 bits a channel wherever 16 are named.
// 0. zeta = peelnet_zeta(z, near, far): z is the distance along the view axis, near and far the range of z that the bounding boxes of the transparent objects in view span, clipped to the camera's. The tighter the range, the less errs. Compute zeta with this function in all passes. Its range is the same for the whole frame: peelnet_zeta_in(z, peelnet_range(near, far)) is the same value, and the range may be passed in.
// 1. Pass "statistics": draw all transparent surfaces, in any order. PeelnetStatistics s = peelnet_statistics(alpha, zeta);
//    moments: rgba16float, cleared to 0, blending ADD, from s.moments
//    extent: rgba16float, cleared to -65504, -65504, -65504, 0, blending MAX for rgb, ADD for alpha, from s.extent
// 2. Pass "weights": draw all transparent surfaces, in any order. float2 f = peelnet_fragment(alpha, zeta, moments, extent);
//    sums: rgba16float, cleared to 0, blending ADD, from float4(alpha * rgb, alpha) * (f.x * (1.0 - min(f.y, 1.0)))
//    ends: rgba16float, cleared to 0, blending ADD, from float4(alpha * rgb, alpha) * (f.x * min(f.y, 1.0))
// 3. Resolve: peelnet_resolve(sums, ends, moments.x, background) is the colour of the pixel, and its coverage in alpha.
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
    float4 moments;
    float4 extent;
};

struct PeelnetPlace {
    float end;
    float in_front;
    int _pad2_0;
    int _pad2_1;
    float3 taken;
    int _pad3_0;
    float3 zeta;
    int _end_pad_0;
};

struct PeelnetRest {
    float root_absorbance;
    float place;
    int _pad2_0;
    int _pad2_1;
    float4 means;
    float bias;
    int _end_pad_0;
    int _end_pad_1;
    int _end_pad_2;
};

static const float PEELNET_FAINT = 0.003921569;
static const float PEELNET_TOP = 61439.0;
static const float2 PEELNET_BINS = float2(240.0, 1920.0);
static const float2 PEELNET_OPACITIES = float2(256.0, 32.0);
static const float2 PEELNET_OPACITY_STEP = float2(0.003921569, 0.032258064);
static const float4 PEELNET_MEANS_MAX = float4(1.0, 65536.0, 65536.0, 65536.0);

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
    float extent_3 = (linear_ ? (far - near) : log(max((far * inverse_near), 1.0)));
    bool flat = (extent_3 <= (linear_ ? 0.0 : 1e-6));
    const PeelnetRange peelnetrange = ConstructPeelnetRange(inverse_near, near, (flat ? 0.0 : (2.0 / max(extent_3, 1e-30))));
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

float peelnet_level(float zeta)
{
    return floor(((((zeta * 0.5) + 0.5) * PEELNET_TOP) + 0.5));
}

float2 peelnet_ends(float b, float zeta_1)
{
    float2 bins = min(floor((((zeta_1 * 0.5) + 0.5) * PEELNET_BINS)), float2(239.0, 1919.0));
    float2 opacity = floor((((b / (b + 1.0)) * float2(270.9375, 32.9375)) + (0.5).xx));
    return ((float2((239.0 - bins.x), bins.y) * PEELNET_OPACITIES) + opacity);
}

PeelnetStatistics ConstructPeelnetStatistics(float4 arg0, float4 arg1) {
    PeelnetStatistics ret = (PeelnetStatistics)0;
    ret.moments = arg0;
    ret.extent = arg1;
    return ret;
}

PeelnetStatistics peelnet_statistics(float alpha_1, float zeta_2)
{
    const float _e2 = peelnet_absorbance(alpha_1);
    float square = (zeta_2 * zeta_2);
    const float _e5 = peelnet_level(zeta_2);
    const float2 _e7 = peelnet_ends(_e2, zeta_2);
    const float3 _e9 = peelnet_halves(float3((PEELNET_TOP - _e5), _e7));
    const PeelnetStatistics peelnetstatistics = ConstructPeelnetStatistics((_e2 * float4(1.0, zeta_2, square, (square * zeta_2))), float4(((alpha_1 < PEELNET_FAINT) ? (-65504.0).xxx : _e9), ((_e2 * square) * square)));
    return peelnetstatistics;
}

PeelnetPlace ConstructPeelnetPlace(float arg0, float arg1, float3 arg2, float3 arg3) {
    PeelnetPlace ret = (PeelnetPlace)0;
    ret.end = arg0;
    ret.in_front = arg1;
    ret.taken = arg2;
    ret.zeta = arg3;
    return ret;
}

PeelnetPlace peelnet_place(float alpha_2, float zeta_3, float4 moments, float4 extent)
{
    bool local = (bool)0;

    const float _e4 = peelnet_absorbance(alpha_2);
    const float _e5 = peelnet_level(zeta_3);
    const float3 _e7 = peelnet_levels(extent.xyz);
    float first = (PEELNET_TOP - _e7.x);
    float2 ends_2 = _e7.yz;
    const float2 _e12 = peelnet_ends(_e4, zeta_3);
    float at_end = ((_e5 <= (first + 1.0)) ? 1.0 : ((_e12.y == ends_2.y) ? 2.0 : 0.0));
    float end = ((alpha_2 < PEELNET_FAINT) ? 0.0 : at_end);
    float2 bins_1 = floor((ends_2 / PEELNET_OPACITIES));
    float2 share = ((ends_2 - (bins_1 * PEELNET_OPACITIES)) * PEELNET_OPACITY_STEP);
    float2 known = (share / ((1.0625).xx - share));
    if ((_e5 > first)) {
        local = (_e12.x != ends_2.x);
    } else {
        local = false;
    }
    bool _e48 = local;
    float nearest = (_e48 ? known.x : 0.0);
    float farthest = ((_e12.y < ends_2.y) ? known.y : 0.0);
    float others = max((moments.x - _e4), 0.0);
    const PeelnetPlace peelnetplace = ConstructPeelnetPlace(end, ((end == 1.0) ? 0.0 : ((end == 2.0) ? others : nearest)), float3(_e4, nearest, farthest), float3(zeta_3, ((first * 3.2552613e-5) - 1.0), (((bins_1.y + 0.5) * 0.0010416667) - 1.0)));
    return peelnetplace;
}

PeelnetRest ConstructPeelnetRest(float arg0, float arg1, float4 arg2, float arg3) {
    PeelnetRest ret = (PeelnetRest)0;
    ret.root_absorbance = arg0;
    ret.place = arg1;
    ret.means = arg2;
    ret.bias = arg3;
    return ret;
}

PeelnetRest peelnet_rest(PeelnetPlace place, float4 moments_1, float4 extent_1)
{
    float3 z_2 = place.zeta;
    float3 square_1 = (z_2 * z_2);
    float4 left = (moments_1 - float4(((place.taken.x + place.taken.y) + place.taken.z), dot(place.taken, z_2), dot(place.taken, square_1), dot(place.taken, (square_1 * z_2))));
    float absorbance_1 = max(left.x, 0.0);
    float inverse_total = (1.0 / max(max(absorbance_1, (moments_1.x * 0.0009765625)), 1e-6));
    float4 mean = (float4(left.yzw, (extent_1.w - dot(place.taken, (square_1 * square_1)))) * inverse_total);
    float middle = (0.5 * (z_2.y + z_2.z));
    float scale = (2.0 / max((z_2.z - z_2.y), 3.2552613e-5));
    float scale_square = (scale * scale);
    float4 means = float4(((mean.x - middle) * scale), ((mean.y - (middle * ((2.0 * mean.x) - middle))) * scale_square), (((mean.z - (middle * ((3.0 * mean.y) - (middle * ((3.0 * mean.x) - middle))))) * scale) * scale_square), (((mean.w - (middle * ((4.0 * mean.z) - (middle * ((6.0 * mean.y) - (middle * ((4.0 * mean.x) - middle))))))) * scale_square) * scale_square));
    const PeelnetRest peelnetrest = ConstructPeelnetRest(sqrt(absorbance_1), clamp(((z_2.x - middle) * scale), -1.0, 1.0), clamp(means, float4(-1.0, -65536.0, -65536.0, -65536.0), PEELNET_MEANS_MAX), min((0.0009765625 + ((scale_square * scale_square) * 1.5258789e-5)), 0.25));
    return peelnetrest;
}

float2 peelnet_moment_bounds(PeelnetRest rest)
{
    float x = rest.place;
    float4 m = lerp(rest.means, float4(0.0, 0.375, 0.0, 0.375), rest.bias);
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
    float inverse = (((half_ >= 0.0) ? -1.0 : 1.0) / max((abs(half_) + root), 1e-20));
    float p = (ka * inverse);
    float q = (kc * inverse);
    float apart = (1.0 - (p * q));
    float at_p = clamp((((1.0 - own) - (q * (m.x - (own * x)))) / ((apart == 0.0) ? 1e-20 : apart)), -10000.0, 10000.0);
    float at_q = ((1.0 - own) - at_p);
    float low = (((p < x) ? at_p : 0.0) + ((((1.0 - (x * q)) * q) < 0.0) ? at_q : 0.0));
    return clamp(float2(low, (low + own)), (0.0).xx, (1.0).xx);
}

float peelnet_share(float root_absorbance, float depth_fraction, float mean_fraction, float share_low, float share_high)
{
    float4 input_a = float4(root_absorbance, depth_fraction, mean_fraction, share_low);
    float4 input_b = float4(share_high, 0.0, 0.0, 0.0);
    float4 layer_a_a = max(((float4(0.7271213, -0.2522731, -6.2262597, 1.3489159) + mul(input_a, float4x4(float4(-0.022978364, 0.041489735, -0.026803136, -0.0038914087), float4(-8.930611, 2.5493624, -7.9762807, 1.8994282), float4(-0.070468575, -2.5054536, 9.861962, -1.4394459), float4(0.075987875, -6.393223, 6.827041, -12.16021)))) + (float4(-0.5287007, -2.4133942, -1.0519068, -1.7369345) * input_b.x)), (0.0).xxxx);
    float4 layer_a_b = max(((float4(-0.4029816, 2.673338, 4.5243855, 1.244728) + mul(input_a, float4x4(float4(0.1187417, -0.01221438, -0.19914894, 0.19657665), float4(5.5338125, 0.9974758, 7.7009387, 0.6825083), float4(-6.2322464, -2.2639256, -8.831479, 1.6443881), float4(-3.0740392, -7.791208, 1.0749248, -9.23326)))) + (float4(1.7366083, -4.3891034, -4.030473, -2.4510674) * input_b.x)), (0.0).xxxx);
    float4 layer_a_c = max(((float4(-9.847884, -0.55330116, -0.6435262, 1.858057) + mul(input_a, float4x4(float4(-0.16843866, -0.20134947, 0.0016715517, -0.023076097), float4(1.4405842, 5.2241726, -2.7744648, 0.3580333), float4(-2.748782, -5.586635, 0.60922533, -1.2142211), float4(-0.5700685, 6.842048, 0.26273173, -4.6382055)))) + (float4(11.166643, 1.4586995, 0.065701395, -6.3878007) * input_b.x)), (0.0).xxxx);
    float layer_b_a = (1.0 / (1.0 + exp(min(-((((-0.55472857 + dot(float4(-2.1254504, -3.0775745, -0.6885362, -1.0587276), layer_a_a)) + dot(float4(-0.15840325, -0.6901868, -0.3667487, -0.40382), layer_a_b)) + dot(float4(1.1485423, 0.47336403, -1.2541678, -1.6893119), layer_a_c))), 80.0))));
    return layer_b_a;
}

float peelnet_network(PeelnetRest rest_1)
{
    const float2 _e1 = peelnet_moment_bounds(rest_1);
    const float _e16 = peelnet_share(rest_1.root_absorbance, ((0.5 * rest_1.place) + 0.5), ((0.5 * rest_1.means.x) + 0.5), _e1.x, _e1.y);
    return _e16;
}

float2 peelnet_fragment(float alpha_3, float zeta_4, float4 moments_2, float4 extent_2)
{
    float4 finite_moments = clamp(moments_2, (-65504.0).xxxx, (65504.0).xxxx);
    float4 finite_extent = float4(extent_2.xyz, min(extent_2.w, 65504.0));
    const PeelnetPlace _e14 = peelnet_place(alpha_3, zeta_4, finite_moments, finite_extent);
    const PeelnetRest _e15 = peelnet_rest(_e14, finite_moments, finite_extent);
    const float _e16 = peelnet_network(_e15);
    float between = ((_e14.end > 0.0) ? 0.0 : ((_e15.root_absorbance * _e15.root_absorbance) * _e16));
    return float2(exp(-((_e14.in_front + between))), _e14.end);
}

float4 peelnet_composite(float4 sums, float4 ends, float coverage, float3 transmittance, float3 background)
{
    float own_1 = min(ends.w, coverage);
    float left_1 = min((coverage - own_1), (16.0 * sums.w));
    float fill = (coverage / max((own_1 + left_1), 1.1754944e-38));
    float2 shares = (fill * float2((own_1 / max(ends.w, 1.1754944e-38)), (left_1 / max(sums.w, 1.1754944e-38))));
    return float4((((ends.xyz * shares.x) + (sums.xyz * shares.y)) + (background * transmittance)), coverage);
}

float4 peelnet_resolve(float4 sums_1, float4 ends_1, float absorbance, float3 background_1)
{
    float transmittance_1 = exp(-(absorbance));
    float4 most = (65504.0).xxxx;
    const float4 _e13 = peelnet_composite(min(sums_1, most), min(ends_1, most), (1.0 - transmittance_1), (transmittance_1).xxx, background_1);
    return _e13;
}

float peelnet_weight(float root_absorbance_1, float depth_fraction_1, float mean_fraction_1, float share_low_1, float share_high_1)
{
    float root_1 = clamp(root_absorbance_1, 0.0, 256.0);
    const float _e23 = peelnet_share(clamp(root_absorbance_1, -46960.414, 46974.063), clamp(depth_fraction_1, -2907.894, 2908.9092), clamp(mean_fraction_1, -1211.0835, 1212.094), clamp(share_low_1, -2969.3333, 2969.953), clamp(share_high_1, -2983.678, 2985.068));
    return exp(((-(root_1) * root_1) * _e23));
}
