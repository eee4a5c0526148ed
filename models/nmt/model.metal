// A learned weight for order-independent transparency. Exported by peelnet 0.1.0.
// Licence of this generated text: MIT OR Apache-2.0.
// Metal 2.4. No Metal compiler was at hand: this text was translated from WGSL that was compiled and run, and has not been compiled itself.
// Network: 7-32-16-1 (Relu hidden, Sigmoid last), 801 parameters, 752 multiply-adds. Recipe nmt, seed 1, 80 epochs.
// Answers: transmittance in front, kept in 0.000061035156 .. 1.0.
// Input 0: depth (exponentially, 0 .. 1 from the pixel's nearest to its farthest fragment), 0.0 .. 1.0 in training.
// Input 1: fragment_count (1), 1.0 .. 160.0 in training.
// Input 2: absorbance (1), 0.0010004875 .. 470.25098 in training.
// Input 3: moment_one (1), -80.85934 .. 150.97789 in training.
// Input 4: moment_two (1), 3.7754373e-11 .. 193.24498 in training.
// Input 5: moment_three (1), -57.520317 .. 95.6431 in training.
// Input 6: moment_four (1), 3.5329184e-20 .. 145.62552 in training.
// Trained on 21531714 rows of boxes, cups, foliage, intersecting, opaque-mix, panes, sixteen-025, sixteen-050, sixteen-075, sixteen-085, sixteen-random-alpha, sixteen-random-color, smoke-100, smoke-30, synthetic (dataset b7ad9cb0d2c09dc1638bcd9266d352a93f8e00bc73cd1e178a68bf55c7773289+ea59181067487e28a3ecbe45990ec58875bfc5212a817cbef25c5c9618a9c370).
// Loss: training 0.007198, validation 0.007181, test 0.007143.
// Held-out error, mean |T - T_exact|: boxes-held 0.08453, cups-held 0.06040, foliage-held 0.06456, panes-held 0.03089, sixteen-held 0.04972, smoke-held 0.05938.
//
// Self-tests, to some roundings of 32 bits; weights and colours also to those of 16-bit targets.
// peelnet_weight(0.018830061, 57.07815, 241.96938, -46.578133, 50.34723, 63.05597, 44.85323) = 0.8982961
// peelnet_weight(0.10960746, 26.60792, 32.12202, -53.79111, 29.232393, -44.68416, 47.719048) = 0.07236152
// peelnet_weight(0.32296264, 97.54397, 83.583275, 4.4620743, 20.028915, 80.53683, 13.9612255) = 0.59069395
// Four fragments of a pixel, near 1.0, far 8.0, background 0.25, 0.5, 0.75:
//    z 1.0, alpha 0.5, rgb 1.0, 0.0, 0.0: zeta -1.0, weight 0.9952261
//    z 2.0, alpha 0.5, rgb 0.0, 1.0, 0.0: zeta -0.33333334, weight 0.3993589
//    z 4.0, alpha 0.5, rgb 0.0, 0.0, 1.0: zeta 0.33333334, weight 0.29710189
//    z 8.0, alpha 0.9, rgb 1.0, 1.0, 1.0: zeta 1.0, weight 0.08558102
//    colour of the pixel: 0.61800605, 0.30233145, 0.25074708
//
// How to draw with it. Targets may have 32 bits a channel wherever 16 are named.
// 0. zeta = peelnet_zeta(z, near, far): z is the distance along the view axis, near and far the range of z that the bounding boxes of the transparent objects in view span, clipped to the camera's. A tight range matters more than anything else you choose. Compute zeta with this function in all passes. Its range is the same for the whole frame: peelnet_zeta_in(z, peelnet_range(near, far)) is the same value, and the range may be passed in.
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
    metal::float4 input_a = (metal::clamp(metal::float4(depth, fragment_count, absorbance, moment_one), metal::float4(-3183.5173, -492579.47, -883255.8, -203659.63), metal::float4(3184.3992, 492705.66, 883389.2, 203664.16)) - metal::float4(0.44081637, 63.098053, 66.66505, 2.260578)) * metal::float4(3.1407447, 0.020298693, 0.011320894, 0.049100988);
    metal::float4 input_b = (metal::clamp(metal::float4(moment_two, moment_three, moment_four, 0.0), metal::float4(-287082.2, -121406.4, -182767.77, 0.0), metal::float4(287123.75, 121409.1, 182791.67, 0.0)) - metal::float4(20.783371, 1.3493026, 11.960301, 0.0)) * metal::float4(0.034830708, 0.08236706, 0.054710664, 0.0);
    metal::float4 layer_a_a = metal::max((metal::float4(-1.8695929, 0.7841444, -1.3112181, -2.3941698) + (metal::float4x4(metal::float4(-0.11464748, 0.15449616, -0.20459181, -2.2917678), metal::float4(-0.32301733, 1.8893555, -0.3267142, 0.23187484), metal::float4(0.1862375, -2.204131, 1.9488918, 0.35208783), metal::float4(0.51522946, 0.3388845, -1.1946677, 0.121884204)) * input_a)) + (metal::float4x4(metal::float4(-0.04609765, -0.49407566, -0.4723313, 0.4847067), metal::float4(-0.5536558, -0.6927886, 0.16247988, -0.0025111346), metal::float4(0.19681911, 1.5805237, -1.9839406, -0.2824105), metal::float4(0.0, 0.0, 0.0, 0.0)) * input_b), metal::float4(0.0));
    metal::float4 layer_a_b = metal::max((metal::float4(-2.40667, -2.01164, -1.5503471, -1.138235) + (metal::float4x4(metal::float4(-0.18582623, -0.9576631, 0.29711178, 0.46859077), metal::float4(-0.9113542, 0.019967116, 0.007472591, 0.12476209), metal::float4(-1.7935585, -0.20905377, 0.6104998, -0.7537531), metal::float4(-0.20186402, -0.9793681, 0.082288444, 0.27682477)) * input_a)) + (metal::float4x4(metal::float4(-0.9043436, -0.9570866, -0.4001934, 0.36996353), metal::float4(0.18118973, 0.027437078, 0.11833875, -0.30231553), metal::float4(0.3468455, -1.3018897, -1.0443977, 0.13518412), metal::float4(0.0, 0.0, 0.0, 0.0)) * input_b), metal::float4(0.0));
    metal::float4 layer_a_c = metal::max((metal::float4(-1.8505937, 0.96317196, -1.6035477, -1.6946318) + (metal::float4x4(metal::float4(-1.4355125, 0.1139019, 0.7477315, 0.35725367), metal::float4(1.1480169, 2.0843256, -0.6672322, -0.2333436), metal::float4(-0.37019342, -1.0924547, 0.4479226, -2.7900198), metal::float4(-1.5593354, 0.38024592, -0.15437134, 0.11587399)) * input_a)) + (metal::float4x4(metal::float4(-0.03592723, -0.42450824, -0.093848154, -0.61454827), metal::float4(0.967494, 0.31532493, -1.2897731, 0.39143577), metal::float4(-1.2514666, -0.4608552, 0.68372387, 0.93583244), metal::float4(0.0, 0.0, 0.0, 0.0)) * input_b), metal::float4(0.0));
    metal::float4 layer_a_d = metal::max((metal::float4(2.3307762, -2.1756048, 1.6187346, -1.2609015) + (metal::float4x4(metal::float4(0.4473893, -0.50668603, 0.47589365, -2.1458967), metal::float4(0.9601686, -0.19838901, 0.8572607, 0.6862724), metal::float4(1.3359175, 0.25271425, 1.0684538, 0.4961955), metal::float4(0.30312213, 1.0253047, 1.1642284, -0.46936902)) * input_a)) + (metal::float4x4(metal::float4(0.55922264, 0.8516539, 0.5268041, -0.30259353), metal::float4(-0.7571526, 1.4279301, 0.49630037, 1.5756515), metal::float4(0.36297616, -2.0742493, -0.6084704, 0.023620322), metal::float4(0.0, 0.0, 0.0, 0.0)) * input_b), metal::float4(0.0));
    metal::float4 layer_a_e = metal::max((metal::float4(-3.440662, -1.3217826, -1.5680162, -0.43158308) + (metal::float4x4(metal::float4(1.3810902, 0.7576331, -0.028361624, -0.12220567), metal::float4(0.5398714, 0.8282675, 0.36926383, -1.9089171), metal::float4(-1.4330776, 0.11561748, -2.9430532, 3.0657082), metal::float4(1.2368752, -1.4470628, 2.2465203, 3.0797749)) * input_a)) + (metal::float4x4(metal::float4(0.08697827, -0.24790041, -0.7838479, -0.5696988), metal::float4(-0.29509258, 1.7192444, -0.6533781, -1.0185758), metal::float4(1.7388275, 0.66090834, 0.75112456, -0.60614663), metal::float4(0.0, 0.0, 0.0, 0.0)) * input_b), metal::float4(0.0));
    metal::float4 layer_a_f = metal::max((metal::float4(-2.42086, 1.2529311, -0.49403614, -0.8513759) + (metal::float4x4(metal::float4(0.3541671, 0.2755528, 1.3636101, 0.28193384), metal::float4(-0.5660933, -0.22412944, 2.0235448, 0.17047662), metal::float4(-1.872418, 2.7522352, -1.763591, 0.020510469), metal::float4(-0.6136249, -1.2092934, 1.1693498, -0.70686454)) * input_a)) + (metal::float4x4(metal::float4(-1.2443616, 0.17573364, -0.6045072, -0.043802753), metal::float4(-0.3320903, 1.7424084, -0.5384634, 0.7016471), metal::float4(0.23680587, -1.5185976, 0.47182813, -0.15448639), metal::float4(0.0, 0.0, 0.0, 0.0)) * input_b), metal::float4(0.0));
    metal::float4 layer_a_g = metal::max((metal::float4(-0.5713887, 0.094388366, -1.1386801, -1.2918698) + (metal::float4x4(metal::float4(0.21735676, 1.695347, -0.6383474, 1.0908921), metal::float4(0.15129769, 0.5820224, 0.98581064, -0.70677036), metal::float4(0.14804566, 2.6339355, -0.49127802, -0.76628363), metal::float4(-0.36114693, 1.4780087, 2.2939692, 1.9429334)) * input_a)) + (metal::float4x4(metal::float4(-0.3203061, 0.7519308, -1.7456017, 0.5058595), metal::float4(0.40837482, -1.306393, -1.2203088, 0.066061325), metal::float4(-0.017247416, -0.3016337, -1.775597, 1.4144423), metal::float4(0.0, 0.0, 0.0, 0.0)) * input_b), metal::float4(0.0));
    metal::float4 layer_a_h = metal::max((metal::float4(-0.8915655, -2.8962886, 1.8276528, 2.4756296) + (metal::float4x4(metal::float4(0.31431678, -2.1421444, 0.2008143, 0.31882417), metal::float4(0.1595402, -0.06799045, 0.47312984, 0.1662078), metal::float4(0.27301624, 0.1602955, 1.5324706, 1.37119), metal::float4(0.40540838, 0.013428687, 0.23580979, 0.33030462)) * input_a)) + (metal::float4x4(metal::float4(-0.4182008, -0.056243584, 1.1488734, 1.0913804), metal::float4(-0.52704334, -0.04869687, -0.2961436, 0.3277839), metal::float4(-0.26400125, 0.09870325, -0.67270094, -0.06596806), metal::float4(0.0, 0.0, 0.0, 0.0)) * input_b), metal::float4(0.0));
    metal::float4 layer_b_a = metal::max((((((((metal::float4(1.144577, 1.9384277, -0.575757, 0.6889332) + (metal::float4x4(metal::float4(0.6376484, -0.011524982, -0.5500013, 0.6015741), metal::float4(-0.41695723, 0.04576159, -1.2185221, -4.905954), metal::float4(0.6082992, -0.013222819, -0.53408986, -1.658258), metal::float4(-3.258881, -7.916356, 1.4100811, -2.2707996)) * layer_a_a)) + (metal::float4x4(metal::float4(-1.6512835, -1.7607664, 1.2293767, -2.3249528), metal::float4(0.8808873, -0.26690087, 0.70209795, -3.5961099), metal::float4(0.4988844, 0.09231804, -0.12773883, 0.38236937), metal::float4(-0.061378106, -0.39633355, -0.29779872, 0.026922947)) * layer_a_b)) + (metal::float4x4(metal::float4(-0.40458137, -0.8968525, 0.74480546, -1.8844997), metal::float4(0.71081406, -0.03379012, 0.92892665, -1.0136565), metal::float4(-1.4581655, 0.21996006, -1.0194324, -0.52425164), metal::float4(-1.396914, -1.0603694, 1.3107067, -0.77749264)) * layer_a_c)) + (metal::float4x4(metal::float4(-0.6628504, -0.1824307, -1.3639392, -0.22167738), metal::float4(0.1928865, 1.4798015, 1.6438117, 2.512858), metal::float4(0.13811292, 0.32266068, 0.75858545, 0.18762775), metal::float4(-0.7356165, -4.9314775, 0.73253226, -2.7005649)) * layer_a_d)) + (metal::float4x4(metal::float4(0.8218042, -0.79149985, -1.2811819, -0.07584577), metal::float4(0.68267053, 0.29502207, 2.5681915, 1.4750565), metal::float4(-5.8179097, -3.9467504, 1.2748445, -4.9971247), metal::float4(-0.22251101, -1.8920625, -0.4822936, -1.1324975)) * layer_a_e)) + (metal::float4x4(metal::float4(-1.8570274, -0.68452114, 2.6930642, -1.4866381), metal::float4(0.48945996, 0.5841525, -0.117036045, 1.393853), metal::float4(1.1826831, -0.15311246, -0.71870875, 0.14125276), metal::float4(-0.1525126, 0.027498905, 1.2410597, 0.19259542)) * layer_a_f)) + (metal::float4x4(metal::float4(-0.17006403, 0.2360572, 0.8344477, 0.59962547), metal::float4(-2.3173711, 2.3088727, -1.8648391, 0.16045934), metal::float4(-1.3574178, -1.0886831, 0.92892706, -1.3109374), metal::float4(-0.35220864, -0.18078056, 0.20457846, -0.09997306)) * layer_a_g)) + (metal::float4x4(metal::float4(1.4732468, 1.0399169, -0.1141152, 1.2135091), metal::float4(-5.9015255, -7.232137, 7.968234, -5.7220187), metal::float4(0.21946347, 0.33018485, -0.22223894, -0.11385838), metal::float4(0.76435524, 0.8220678, -0.33827633, 1.1500026)) * layer_a_h), metal::float4(0.0));
    metal::float4 layer_b_b = metal::max((((((((metal::float4(-0.17339174, -0.3526196, -0.42647672, -1.2356808) + (metal::float4x4(metal::float4(0.121351875, -0.18778883, 0.664006, 0.59563226), metal::float4(-0.19838575, -0.0564067, 1.9214332, -0.9724419), metal::float4(-0.18052962, 0.108728506, 1.3200294, 0.30513066), metal::float4(-0.23109995, -0.1598755, -1.0306207, 5.611964)) * layer_a_a)) + (metal::float4x4(metal::float4(0.025519935, -0.4131164, -1.465788, 1.7534494), metal::float4(-0.20269285, -0.47292167, 0.628246, 0.16489), metal::float4(-0.32444, 0.12791936, 0.30085868, -0.19590138), metal::float4(-0.013210488, -0.11748287, 0.11662041, -1.385658)) * layer_a_b)) + (metal::float4x4(metal::float4(-0.20870426, -0.12085229, -1.6287564, 0.21121599), metal::float4(-0.13152972, -0.35936862, -0.6119591, -0.8856585), metal::float4(0.02595305, 0.16590431, -0.4056747, -0.32340613), metal::float4(-0.13374217, -0.5075511, -1.1945976, 1.8718612)) * layer_a_c)) + (metal::float4x4(metal::float4(-0.17888476, -0.14478683, 0.64347565, -3.6709569), metal::float4(0.098206356, 0.070667736, -1.0401198, 0.310621), metal::float4(-0.035755053, -0.4734247, -1.0974325, -0.8068228), metal::float4(-0.10558863, -0.1681147, 0.41056904, 0.2558999)) * layer_a_d)) + (metal::float4x4(metal::float4(-0.0069868756, -0.044630185, 0.24920395, -0.5138749), metal::float4(0.0729101, -0.08566854, 1.068201, -0.3647454), metal::float4(-0.16448282, -0.34817678, 1.2192583, -1.1780471), metal::float4(-0.12577528, -0.47670797, 2.33599, 0.9400777)) * layer_a_e)) + (metal::float4x4(metal::float4(-0.019209025, -0.17207786, -2.7876117, -0.21067937), metal::float4(-0.062324528, -0.5076819, 0.53894764, -0.99181974), metal::float4(-0.39046916, -0.11086049, 0.6201279, -0.6023022), metal::float4(0.1471667, 0.071334556, -0.05880423, -0.08795607)) * layer_a_f)) + (metal::float4x4(metal::float4(-0.12826097, -0.11597658, 0.08132114, -0.6551133), metal::float4(0.04958384, 0.024370715, 6.57146, 0.31830075), metal::float4(-0.18191724, -0.4306941, -0.010156894, -0.5312628), metal::float4(-0.14718416, -0.012237984, 1.9929836, -1.5791068)) * layer_a_g)) + (metal::float4x4(metal::float4(-0.022319281, -0.07532063, 1.4008292, -0.045936815), metal::float4(-0.23739983, 0.15108758, -6.558266, 10.228046), metal::float4(-0.16535771, -0.50289756, -0.04215905, -0.5663489), metal::float4(-0.21341313, -0.3907615, -0.16539603, -1.1887869)) * layer_a_h), metal::float4(0.0));
    metal::float4 layer_b_c = metal::max((((((((metal::float4(1.1307231, 0.4533788, -1.2228439, 1.0085115) + (metal::float4x4(metal::float4(0.5632149, 0.3799257, -0.23984595, 0.19520293), metal::float4(0.74898505, -0.6080385, 0.2930123, -2.681468), metal::float4(0.48598227, -1.4085706, 0.77984965, 0.5346502), metal::float4(-2.6003413, -1.0111831, 1.3053184, -3.9969153)) * layer_a_a)) + (metal::float4x4(metal::float4(1.0401907, 0.95438737, 2.5353017, -3.2102058), metal::float4(0.13452958, 0.7339466, 0.91175514, 0.16852383), metal::float4(-0.5825516, -0.34452605, 0.10307344, -0.39778832), metal::float4(-0.2344651, -0.15706994, 0.61053205, -0.26090515)) * layer_a_b)) + (metal::float4x4(metal::float4(-1.2198845, -2.4956305, -1.4601156, -1.6004952), metal::float4(0.77651393, -2.7776508, 0.6935593, -2.7850535), metal::float4(-0.860372, 0.06059577, 0.9055293, -3.796712), metal::float4(-1.2753257, -4.8602114, 1.3837553, -4.340156)) * layer_a_c)) + (metal::float4x4(metal::float4(1.5010127, -0.852776, -0.49405208, -1.7225733), metal::float4(-0.34075785, -3.8645055, 1.0262777, -0.21192159), metal::float4(0.33116788, -3.947768, 0.36937279, 0.65104485), metal::float4(-1.1608706, 0.6981743, -0.9030687, -1.1970391)) * layer_a_d)) + (metal::float4x4(metal::float4(1.7168726, -0.2715466, 0.5425157, -0.30019855), metal::float4(0.12533467, -1.6766763, 1.874914, -0.89689785), metal::float4(-3.7485993, -4.0136714, 6.095555, -2.3728948), metal::float4(-0.89580053, 0.62362385, -2.3492837, 0.79854673)) * layer_a_e)) + (metal::float4x4(metal::float4(-0.8129765, -6.6763024, 1.9028196, 1.0379496), metal::float4(0.786844, 2.0022738, -1.2339373, 1.7271637), metal::float4(-1.9115119, -0.15595242, -0.20199925, 1.6099285), metal::float4(-0.011821134, 0.32100114, 0.23788226, -0.22962312)) * layer_a_f)) + (metal::float4x4(metal::float4(-1.2382822, -0.24864031, -0.42350772, 0.037813623), metal::float4(2.8953476, -0.133648, -9.3894415, -8.395255), metal::float4(0.19042851, -1.4412597, -0.51962274, -0.37711614), metal::float4(0.063034125, -0.16475673, 1.0520959, -2.4580414)) * layer_a_g)) + (metal::float4x4(metal::float4(1.8258967, 0.3802614, -0.504884, 0.54362476), metal::float4(-6.2152734, -5.1776266, 6.42141, -28.496748), metal::float4(-0.33366182, 0.9066754, -0.85564715, 0.07207871), metal::float4(0.54918015, -2.0369992, -1.7809962, 0.36731133)) * layer_a_h), metal::float4(0.0));
    metal::float4 layer_b_d = metal::max((((((((metal::float4(0.24132688, -1.8151368, -1.4529412, -1.1998365) + (metal::float4x4(metal::float4(0.35999143, 0.13472566, 0.30181876, 0.3436499), metal::float4(-1.1466273, 0.2975729, -0.16926944, 0.53174174), metal::float4(-0.30130246, 0.2924775, -0.9119243, 0.4231323), metal::float4(-8.920956, 6.7384205, -4.4314218, 6.117872)) * layer_a_a)) + (metal::float4x4(metal::float4(-0.5611941, 0.7088446, 2.3122785, 1.0301356), metal::float4(1.5274334, 0.648616, -2.4590497, 0.059074562), metal::float4(-0.43649307, 0.05712396, 0.0025550944, -0.56045043), metal::float4(-0.5017088, -0.14760728, 0.2339451, 0.11554254)) * layer_a_b)) + (metal::float4x4(metal::float4(-0.59873414, -0.41209278, 0.19425854, -0.17411), metal::float4(1.3474513, -0.17613174, 0.0018052359, -0.21674573), metal::float4(-1.8515619, -0.22528799, -2.9445806, -0.48447007), metal::float4(-0.66019446, 0.9583511, -0.6375644, 0.78837407)) * layer_a_c)) + (metal::float4x4(metal::float4(-1.5528045, -0.9963465, 1.9466574, -0.11235917), metal::float4(0.30430287, -0.6336322, -4.190879, -0.04382882), metal::float4(1.3062721, -0.38287684, -0.042316236, -0.082027994), metal::float4(-3.5796652, 0.84289783, -0.6459928, 0.35361353)) * layer_a_d)) + (metal::float4x4(metal::float4(-0.21705095, -0.57541716, -1.9798795, 0.47444627), metal::float4(-0.7951126, -0.13713124, -1.4689368, -0.06827307), metal::float4(-2.240207, 0.81039244, 0.10862444, 0.19736964), metal::float4(-3.3590693, 0.292985, 1.7552105, 0.17116623)) * layer_a_e)) + (metal::float4x4(metal::float4(-0.52665615, 2.1225572, -0.063350566, 0.8649032), metal::float4(2.1375573, -0.4507567, 1.6282008, -0.011429944), metal::float4(-7.4887, -1.9971735, -3.9419625, -0.9256356), metal::float4(-0.328333, -0.08341721, -0.1321744, -0.33653784)) * layer_a_f)) + (metal::float4x4(metal::float4(0.1935266, -0.15956396, -0.018236768, 0.099636406), metal::float4(-2.4124258, 0.53298956, 3.4609144, 2.2584515), metal::float4(-0.81090164, -0.28070298, 0.39034727, -0.09982047), metal::float4(-3.56364, 0.042302106, 0.4275108, 0.16471036)) * layer_a_g)) + (metal::float4x4(metal::float4(0.85451776, 1.9550371, 1.0251052, 1.2665476), metal::float4(-11.086424, 10.907745, -4.6173263, 10.493198), metal::float4(0.9655624, -0.21858035, -0.49802855, -0.99386376), metal::float4(-0.5003704, -1.2687509, -0.47326708, -1.2846743)) * layer_a_h), metal::float4(0.0));
    float layer_c_a = 1.0 / (1.0 + metal::exp(metal::min(-(((((-0.16186689 + metal::dot(metal::float4(-1.431948, -1.5780517, 0.6113929, -1.1009381), layer_b_a)) + metal::dot(metal::float4(0.206389, -0.30813402, -0.87207794, 5.548477), layer_b_b)) + metal::dot(metal::float4(-0.42414704, -1.2978364, 1.3186266, 1.3434389), layer_b_c)) + metal::dot(metal::float4(1.6187459, 4.589645, -0.80141175, 3.7544768), layer_b_d))), 80.0)));
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
