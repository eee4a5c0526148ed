// A learned weight for order-independent transparency. Exported by peelnet 0.1.0.
// Licence of this generated text: MIT OR Apache-2.0.
// HLSL, shader model 6.0.
// Network: 7-32-16-1 (Relu hidden, Sigmoid last), 801 parameters, 752 multiply-adds. Recipe nmt, seed 1, 80 epochs.
// Answers: transmittance in front, kept in 0.000061035156 .. 1.0.
// Input 0: depth (exponentially, 0 .. 1 from the pixel's nearest to its farthest fragment), 0.0 .. 1.0 in training.
// Input 1: fragment_count (1), 1.0 .. 160.0 in training.
// Input 2: absorbance (1), 0.0010004875 .. 455.49112 in training.
// Input 3: moment_one (1), -143.64313 .. 338.6233 in training.
// Input 4: moment_two (1), 6.112143e-10 .. 330.70947 in training.
// Input 5: moment_three (1), -106.229095 .. 321.52313 in training.
// Input 6: moment_four (1), 1.4244082e-18 .. 314.09418 in training.
// Trained on boxes, cups, foliage, intersecting, opaque-mix, panes, sixteen-025, sixteen-050, sixteen-075, sixteen-085, sixteen-random-alpha, sixteen-random-color, smoke-100, smoke-30, synthetic, of a dataset of 21565796 rows, at most 6000000 of them (f0e6c4a7cca08d560f99a5be9cbd1514bf8be352632a347602bf08363695fd29+eb0fb0725f43962450fda44a06f4c27ba969a523c02d556c7eebdda5833c5318).
// Loss: training 0.012805, validation 0.012546, test 0.012829.
// Held-out error, mean |T - T_exact|: boxes-held 0.09400, cups-held 0.05945, foliage-held 0.06661, panes-held 0.03617, sixteen-held 0.05491, smoke-held 0.05293.
//
// Self-tests, to some roundings of 32 bits; weights and colours also to those of 16-bit targets.
// peelnet_weight(0.16887921, 118.23997, 87.495544, -127.09953, 42.512287, 80.20213, 240.69527) = 0.21611011
// peelnet_weight(0.6204604, 111.180595, 237.0823, 149.22989, 130.51941, 186.94867, 313.78238) = 0.9448792
// peelnet_weight(0.72062033, 3.2256587, 61.898315, -14.963409, 234.09915, 130.4942, 107.32097) = 0.7162363
// Four fragments of a pixel, near 1.0, far 8.0, background 0.25, 0.5, 0.75:
//    z 1.0, alpha 0.5, rgb 1.0, 0.0, 0.0: zeta -1.0, weight 0.9774332
//    z 2.0, alpha 0.5, rgb 0.0, 1.0, 0.0: zeta -0.33333334, weight 0.268496
//    z 4.0, alpha 0.5, rgb 0.0, 0.0, 1.0: zeta 0.33333334, weight 0.21380661
//    z 8.0, alpha 0.9, rgb 1.0, 1.0, 1.0: zeta 1.0, weight 0.11678442
//    colour of the pixel: 0.70542216, 0.28932717, 0.26011238
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

struct PeelnetRange {
    float inverse_near;
    float near;
    float scale;
};

struct PeelnetStatistics {
    float4 totals;
    float4 moments;
    float2 extent;
    int _end_pad_0;
    int _end_pad_1;
};

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

PeelnetStatistics ConstructPeelnetStatistics(float4 arg0, float4 arg1, float2 arg2) {
    PeelnetStatistics ret = (PeelnetStatistics)0;
    ret.totals = arg0;
    ret.moments = arg1;
    ret.extent = arg2;
    return ret;
}

PeelnetStatistics peelnet_statistics(float alpha_1, float zeta)
{
    const float _e2 = peelnet_absorbance(alpha_1);
    float b = min(_e2, 10.0);
    float square = (zeta * zeta);
    const PeelnetStatistics peelnetstatistics = ConstructPeelnetStatistics(float4(b, 1.0, 0.0, 0.0), (b * float4(zeta, square, (square * zeta), (square * square))), float2(-(zeta), zeta));
    return peelnetstatistics;
}

float peelnet_depth(float zeta_1, float2 extent)
{
    float2 beyond = (exp((0.5 * (float2(zeta_1, extent.y) + (extent.x).xx))) - (1.0).xx);
    return clamp((beyond.x / max(beyond.y, 1.5258789e-5)), 0.0, 1.0);
}

float peelnet_weight(float depth, float fragment_count, float absorbance, float moment_one, float moment_two, float moment_three, float moment_four)
{
    float4 input_a = ((clamp(float4(depth, fragment_count, absorbance, moment_one), float4(-3389.2058, -487811.38, -836424.8, -485857.66), float4(3390.2078, 487934.56, 836552.8, 485883.1)) - float4(0.5009997, 61.60385, 63.98777, 12.710525)) * float4(2.9501076, 0.02049714, 0.011954732, 0.020581622));
    float4 input_b = ((clamp(float4(moment_two, moment_three, moment_four, 0.0), float4(-440367.66, -406931.16, -381423.2, 0.0), float4(440420.1, 406950.66, 381459.25, 0.0)) - float4(26.232529, 9.746877, 18.037842, 0.0)) * float4(0.022706946, 0.024573592, 0.02621636, 0.0));
    float4 layer_a_a = max(((float4(-0.56379926, -2.5030277, 1.4801457, -2.5059981) + mul(input_a, float4x4(float4(0.052247707, -0.38384253, 0.23784702, -1.9542586), float4(-0.6583952, 0.55670863, 1.0169737, -0.0075987256), float4(1.9574382, 0.35710236, 1.2070669, 0.31280795), float4(0.6868923, -2.1530032, -0.44507584, 0.15810557)))) + mul(input_b, float4x4(float4(0.17087919, -1.2144897, 0.20723198, 0.3973147), float4(-0.7055892, 1.0673869, -0.9163429, -0.062159773), float4(-2.1695893, -2.4707444, -0.4617276, -0.23223951), float4(0.0, 0.0, 0.0, 0.0)))), (0.0).xxxx);
    float4 layer_a_b = max(((float4(-2.2542686, -1.871615, -1.3645804, -1.9090456) + mul(input_a, float4x4(float4(-0.07274247, -1.3665652, -0.21026427, -0.3818754), float4(-1.8740106, 1.0517554, 0.8368542, 0.15677093), float4(-0.2789981, -0.18346062, 0.90850925, -1.9012918), float4(0.82456905, 1.023913, -0.08853474, 2.802164)))) + mul(input_b, float4x4(float4(-0.2969242, -1.3641392, 0.42218232, -1.0011398), float4(-0.19190043, 0.9295901, 0.044068266, 0.92121786), float4(0.09281398, -0.2814055, 1.0580204, -0.7921928), float4(0.0, 0.0, 0.0, 0.0)))), (0.0).xxxx);
    float4 layer_a_c = max(((float4(-0.85832304, 1.0454777, -2.2396226, -1.7302164) + mul(input_a, float4x4(float4(-0.111886665, 1.0010142, 1.5720115, 0.58483016), float4(-0.33122396, 0.71208024, 0.11102162, -0.23502201), float4(0.30905318, -1.0271434, -0.40960747, -2.2317924), float4(0.09718903, -0.413811, -0.4957275, 0.49715433)))) + mul(input_b, float4x4(float4(0.003489439, 0.13264184, -0.07205385, -0.9213272), float4(-0.26240242, 0.6661379, 0.20692751, -1.4510618), float4(-0.44382897, 1.3134518, 0.8899936, 0.10748394), float4(0.0, 0.0, 0.0, 0.0)))), (0.0).xxxx);
    float4 layer_a_d = max(((float4(0.9752381, -1.0982977, 1.6363719, -1.9020205) + mul(input_a, float4x4(float4(0.10008493, 0.6847998, 0.39845434, -1.9280045), float4(0.6619956, -0.2870266, 0.6766298, 0.34128416), float4(0.7758124, -2.6167004, 1.0436245, 0.42951384), float4(-0.05978622, 2.24315, 0.4946582, -0.098347634)))) + mul(input_b, float4x4(float4(0.48636496, -1.0096147, 0.46307707, -0.13390572), float4(-1.3333263, 0.3575348, 1.0826781, 0.6063468), float4(0.9531826, 0.6458003, -0.6431546, 0.0068879193), float4(0.0, 0.0, 0.0, 0.0)))), (0.0).xxxx);
    float4 layer_a_e = max(((float4(-2.0294921, -0.7150936, -1.3330227, -2.7566392) + mul(input_a, float4x4(float4(-0.35793123, 0.476471, -0.2952133, -1.9451891), float4(1.0379027, 0.061700698, 0.23576675, -0.8845869), float4(-0.15035899, 0.35264668, -2.056485, 1.1811292), float4(1.0539132, -0.12154812, 1.5595396, -0.55575275)))) + mul(input_b, float4x4(float4(-0.43178806, -0.20119083, -1.1531249, 0.3237628), float4(0.21274835, -0.020350052, -0.06266417, 0.7374508), float4(-0.61740935, 0.03644901, -0.5969608, -0.46533385), float4(0.0, 0.0, 0.0, 0.0)))), (0.0).xxxx);
    float4 layer_a_f = max(((float4(0.8687189, 1.744056, -0.35401666, 0.024595344) + mul(input_a, float4x4(float4(0.16518588, 0.42683095, -0.06803181, 0.029755266), float4(-0.8546373, -0.29864243, 1.5794884, 0.24603179), float4(2.0494647, 2.1152606, -1.4369419, -2.6549726), float4(2.7884855, -0.28402036, 1.2071083, 3.5067081)))) + mul(input_b, float4x4(float4(0.4125121, 0.3370522, -0.9191235, -0.39865395), float4(3.0364816, 1.305115, -1.7094411, 3.638376), float4(-1.265478, -1.0990691, -0.02042811, 0.56280047), float4(0.0, 0.0, 0.0, 0.0)))), (0.0).xxxx);
    float4 layer_a_g = max(((float4(0.77448547, 0.14249268, -0.08075042, -0.23196554) + mul(input_a, float4x4(float4(0.5049221, 1.3818462, -0.23622656, 0.3919414), float4(-0.20289609, -0.063743055, -0.025076807, -0.9937547), float4(-0.51346284, 2.573256, 1.5512407, -1.1915625), float4(3.7592921, 2.0969284, 3.9284358, 6.8919115)))) + mul(input_b, float4x4(float4(0.9388337, 0.7815046, -1.7692584, 1.1949828), float4(4.192569, -0.92689496, -0.9679706, 0.30467573), float4(1.7674973, -1.0715235, -2.3428156, 0.24759959), float4(0.0, 0.0, 0.0, 0.0)))), (0.0).xxxx);
    float4 layer_a_h = max(((float4(-0.32185364, -2.4495435, 1.8855995, 2.4768665) + mul(input_a, float4x4(float4(0.58140016, -1.6073581, 0.5057816, 0.6842459), float4(0.20814995, -0.095935225, 0.24389338, 0.031987976), float4(1.3064685, -0.13729662, 1.0423299, 0.9714987), float4(1.8693992, 0.3743351, -0.17521243, 0.07557276)))) + mul(input_b, float4x4(float4(0.10780215, -0.18680108, 1.3690058, 0.86635476), float4(-1.8632488, -0.39698198, -1.1161964, 0.9305006), float4(-0.59567946, 0.30277044, 0.49823514, -0.12712397), float4(0.0, 0.0, 0.0, 0.0)))), (0.0).xxxx);
    float4 layer_b_a = max(((((((((float4(0.5858553, 1.0291642, -0.006151314, 0.73090214) + mul(layer_a_a, float4x4(float4(-0.5231026, -0.5164437, 0.26011023, -0.1655313), float4(-1.212836, -1.1008769, 0.8508305, 2.4962168), float4(1.4676784, -0.40706575, -1.5478635, 1.0212862), float4(-8.031965, -7.8058987, 6.9331007, -5.2471642)))) + mul(layer_a_b, float4x4(float4(0.83209914, -5.1055684, -0.44185787, 0.9869824), float4(-0.010231013, 1.4902964, 0.8483418, -0.534654), float4(1.0939554, -5.246081, -1.1388216, -3.259246), float4(1.1663587, 0.001199229, -0.4123629, 0.15117764)))) + mul(layer_a_c, float4x4(float4(0.34003899, 0.014400219, 0.566295, 0.07040125), float4(0.18058258, 0.6161813, 0.3564641, -6.877825), float4(-0.55076593, 1.6467707, 0.8810425, 0.13492267), float4(-0.9106898, -0.85680246, 1.2816488, -3.210152)))) + mul(layer_a_d, float4x4(float4(0.4258338, -0.4715706, -0.2640025, -0.13267374), float4(-1.3305964, -1.2723957, 1.9104803, -1.7859572), float4(0.6135797, 0.49739334, -0.20377553, -0.30767715), float4(-0.6723997, -1.1951424, 1.076334, -2.9007947)))) + mul(layer_a_e, float4x4(float4(0.27734983, -1.9822263, 1.157797, 0.9626025), float4(1.3680114, -1.6622423, -0.0713734, 0.3714018), float4(0.14959286, -0.10894956, 0.836988, -0.318296), float4(0.4424481, -1.5645972, -0.121191636, -0.2516055)))) + mul(layer_a_f, float4x4(float4(0.88683105, 1.3531587, -0.0072875754, -0.86912006), float4(0.5231587, 0.62024057, 0.15376058, -3.721589), float4(0.13680838, -0.35431498, 0.7570829, 0.17790766), float4(-0.2529435, -2.2372003, -0.30067018, -0.8937239)))) + mul(layer_a_g, float4x4(float4(-1.04406, 0.113086306, 1.2243097, -0.26058784), float4(1.1933284, 3.9342403, -1.0712603, 0.59464145), float4(0.44757625, -3.0330951, 0.35752144, -3.871565), float4(1.4638833, -2.369973, -1.5762119, 0.052958857)))) + mul(layer_a_h, float4x4(float4(0.74569505, -1.0502756, 0.38245636, 0.55131125), float4(-1.0894864, -2.2973158, 0.2697769, 0.011511003), float4(0.0017693237, 0.7480329, 1.2139002, -0.03963973), float4(1.1422688, 1.3093201, -0.0334112, -0.12488002)))), (0.0).xxxx);
    float4 layer_b_b = max(((((((((float4(-0.31871253, -0.49973282, 0.15995534, -1.0781273) + mul(layer_a_a, float4x4(float4(-0.095050454, -0.19134536, 2.3921752, 0.72876966), float4(-0.24337728, -0.040958025, -3.2133973, 0.25714865), float4(-0.19519056, -0.28543112, -1.4491202, -1.9286743), float4(-0.43788964, -0.6210679, -6.0280004, 6.3570466)))) + mul(layer_a_b, float4x4(float4(0.12799273, -0.5183035, 0.70261294, 3.070534), float4(-0.25059718, -0.4193847, -1.7424585, -0.44387272), float4(-0.17574163, 0.121602975, -0.33877128, -0.4172771), float4(-0.04970245, -0.09935725, -0.51168936, 0.36594325)))) + mul(layer_a_c, float4x4(float4(-0.10467195, -0.13082802, 0.11727485, -0.22622073), float4(-0.3571574, -0.44215617, -0.75537485, -1.7878535), float4(0.14171478, 0.2150056, -0.16396199, -0.26385048), float4(-0.039198846, 0.41627228, -0.5546495, 0.37409994)))) + mul(layer_a_d, float4x4(float4(-0.035374355, -0.29974005, 0.33215216, -1.1107692), float4(-0.071634226, 0.18311356, 0.20079766, -0.9309799), float4(-0.3655221, -0.41582912, 0.51683754, -1.4500879), float4(-0.33934936, -0.62276, -1.016001, 0.3028068)))) + mul(layer_a_e, float4x4(float4(-0.44927487, -0.04781897, 0.05164408, -0.47749916), float4(0.067730315, -0.092261046, 1.3026766, -0.023874171), float4(-0.2065283, -0.51091594, -0.45854542, -0.65090775), float4(-0.29323074, -0.61522, 2.247021, 3.2886424)))) + mul(layer_a_f, float4x4(float4(-0.15787712, -0.28484148, -1.3876814, -0.37440425), float4(-0.3708926, -0.5803782, 0.6727947, -1.440385), float4(-0.46013755, -0.56968284, 1.550762, 0.22366524), float4(-0.15647149, -0.39048654, -2.351654, 0.33228156)))) + mul(layer_a_g, float4x4(float4(-0.4313037, -0.15645373, -0.26988602, -0.8339804), float4(0.24371046, 0.01744151, -5.861328, -0.67501503), float4(-0.26098818, -0.42392594, -1.5491148, 0.005727448), float4(-0.33818772, 0.018098507, -1.9028776, 1.2416052)))) + mul(layer_a_h, float4x4(float4(-0.113918565, -0.0827013, -0.35913038, -0.39050636), float4(-0.28301546, -0.30014738, 0.86585504, 1.06667), float4(-0.3879024, -0.6641427, -0.58052593, -0.79699016), float4(-0.41839737, -0.4217042, 1.0769695, -2.0703752)))), (0.0).xxxx);
    float4 layer_b_c = max(((((((((float4(0.28439975, 0.9377011, 0.07532766, -1.1659105) + mul(layer_a_a, float4x4(float4(-0.519175, -1.5367926, 0.4755571, -1.2871475), float4(0.4876859, 1.2133893, -0.9736042, -0.055227898), float4(0.72568303, 0.4344259, -1.0650314, -2.8829489), float4(-8.242795, -19.022913, 0.5875693, -0.8627624)))) + mul(layer_a_b, float4x4(float4(1.0952617, -3.7800593, 1.0008913, 4.500461), float4(1.5732051, 1.8267893, 2.874644, 3.1961505), float4(-2.1759818, -5.956905, 0.630164, 0.1782044), float4(1.6325363, -8.459196, -4.2463884, 0.1773668)))) + mul(layer_a_c, float4x4(float4(-0.65176105, 0.061518, 0.7380686, 0.0028600302), float4(-0.13373633, -2.5937998, 1.9243667, -3.3126504), float4(0.9371629, -4.4735217, -0.14248535, -1.350944), float4(-1.0062447, -1.1722078, 1.5670308, -0.6271081)))) + mul(layer_a_d, float4x4(float4(0.60054976, 0.1982239, -2.8520758, 0.47333238), float4(-1.4648991, -2.3658507, 1.2363904, -10.272382), float4(0.57451713, 1.2855226, 0.39175075, 0.6869975), float4(-1.8458303, -0.33026177, -1.5088465, 0.76955485)))) + mul(layer_a_e, float4x4(float4(0.19832167, -2.841577, -4.3551693, -2.708611), float4(2.2771115, -0.605746, 0.15326464, -0.16397941), float4(-0.099437386, -1.0415382, 1.719041, -1.3632281), float4(2.4819121, -0.18094079, -2.4731565, 0.7182066)))) + mul(layer_a_f, float4x4(float4(2.041003, 2.178578, -4.0779753, 0.30650938), float4(1.2546368, 1.8052592, -2.547367, -1.0512286), float4(-1.500359, -1.0508238, -0.701036, -4.106536), float4(-0.032712277, -0.20137979, 1.679308, 1.9754535)))) + mul(layer_a_g, float4x4(float4(-2.5571623, -2.082352, -3.4452767, -1.6518023), float4(1.6200353, 3.005034, -10.782131, 0.863846), float4(1.1255687, -0.4124309, 0.32586363, 0.04000386), float4(1.5748066, 1.3212429, -4.670909, 0.99978465)))) + mul(layer_a_h, float4x4(float4(1.7487289, -6.477047, -0.22396718, -4.567641), float4(-1.4744189, -1.7397727, -5.3405223, 1.3966949), float4(-0.0012261018, -0.2579309, -0.47369528, 0.46384823), float4(1.3754091, 1.1579055, -2.2208521, -0.8839394)))), (0.0).xxxx);
    float4 layer_b_d = max(((((((((float4(1.6518204, -1.56046, 0.25909308, -1.7608413) + mul(layer_a_a, float4x4(float4(0.17031892, -0.3945059, -1.0622574, -0.29939795), float4(-0.84652346, -0.3096234, -2.4318202, 0.02264744), float4(-1.2259448, 0.1305895, 0.94230497, 0.3285234), float4(-2.4311447, 8.443692, -7.332728, 8.730588)))) + mul(layer_a_b, float4x4(float4(-0.19133621, 0.36784467, 2.5933924, -0.7806287), float4(-0.8949949, 0.8370298, 1.1188375, 0.014542138), float4(-0.2736248, -0.13279153, 0.90349466, -0.046347946), float4(0.038486406, -0.46536383, -5.051716, -0.21869606)))) + mul(layer_a_c, float4x4(float4(0.20444651, -0.047949366, 0.26021212, 0.21872035), float4(-0.22322297, -0.55362195, -0.117634214, -0.49556485), float4(0.39102006, 0.0294981, 2.4710891, 0.7803038), float4(-2.3909774, -0.7741265, -0.57371384, 3.415288)))) + mul(layer_a_d, float4x4(float4(-0.70777744, -0.024815809, 0.6936542, 0.041379876), float4(-1.3727162, 2.1198413, -1.0014215, 2.0621414), float4(-0.78531206, -0.23898974, 0.19729747, -0.17080407), float4(-1.0521555, 4.1204815, -1.2743688, 4.268466)))) + mul(layer_a_e, float4x4(float4(0.043604594, 0.891734, -1.2246281, -1.2792408), float4(0.24786182, 0.35972047, 0.9984746, 1.2975782), float4(-3.0525928, 0.4641716, -0.31548378, 0.5810654), float4(-3.4575815, 2.0341983, 1.5853463, 2.1611419)))) + mul(layer_a_f, float4x4(float4(-2.3896377, 0.24447607, 0.51778793, 0.31403205), float4(-3.8520658, -1.5206528, 0.7310214, -1.4529774), float4(0.00054977793, -1.2347206, -0.38662755, -1.0056373), float4(-0.6866406, 0.22719263, -2.3117836, -0.36970496)))) + mul(layer_a_g, float4x4(float4(0.03202851, -0.23425958, 0.06790589, -0.34772554), float4(0.37599173, 0.39199463, -0.036638353, 0.46199042), float4(-3.4006505, -0.33691403, -1.0553725, 0.32049602), float4(-0.16407356, -0.006629616, 1.0421735, 0.6166052)))) + mul(layer_a_h, float4x4(float4(0.7659061, 0.04172246, -0.30954766, -0.14000927), float4(0.93683946, 1.4040238, -0.076610036, 1.9486494), float4(-0.5443222, -0.64096767, -0.14980245, -0.4736609), float4(-1.275025, -2.157847, 1.0469267, -2.6273391)))), (0.0).xxxx);
    float layer_c_a = (1.0 / (1.0 + exp(min(-(((((0.1989624 + dot(float4(-0.2548042, -1.7579329, 0.61826926, -1.8699272), layer_b_a)) + dot(float4(-0.13445777, -0.4359869, -1.010118, 6.2015476), layer_b_b)) + dot(float4(-0.9905232, 1.0900788, 0.9383397, 1.0293864), layer_b_c)) + dot(float4(-1.4331044, 4.673985, -0.45437443, 4.1818285), layer_b_d))), 80.0))));
    return clamp(layer_c_a, 6.1035156e-5, 1.0);
}

float peelnet_network(float zeta_2, float2 extent_1, float4 totals, float4 moments)
{
    const float _e4 = peelnet_depth(zeta_2, extent_1);
    const float _e11 = peelnet_weight(_e4, totals.y, totals.x, moments.x, moments.y, moments.z, moments.w);
    return _e11;
}

float peelnet_fragment(float zeta_3, float4 totals_1, float4 moments_1, float2 extent_2)
{
    const float _e4 = peelnet_network(zeta_3, extent_2, totals_1, moments_1);
    return _e4;
}

float4 peelnet_composite(float4 sums, float coverage, float3 transmittance, float3 background)
{
    bool local = (bool)0;

    if ((sums.w > 0.0)) {
        local = (coverage > 0.0);
    } else {
        local = false;
    }
    bool _e20 = local;
    float3 average = (_e20 ? (sums.xyz / (max(sums.w, 1.1754944e-38)).xxx) : (0.0).xxx);
    return float4(((average * coverage) + (background * transmittance)), coverage);
}

float4 peelnet_resolve(float4 sums_1, float absorbance_1, float3 background_1)
{
    float transmittance_1 = exp(-(absorbance_1));
    const float4 _e11 = peelnet_composite(min(sums_1, (65504.0).xxxx), (1.0 - transmittance_1), (transmittance_1).xxx, background_1);
    return _e11;
}
