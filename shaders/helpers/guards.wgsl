// Constants that keep results finite; as peelnet_core::guards, where the reasons stand.
const SUM_FLOOR: f32 = 5.9604645e-8;
const HALF_MAX: f32 = 65504.0;
const WEIGHT_FLOOR: f32 = 6.1035156e-5;
const FILL_MAX: f32 = 16.0;
const EMISSIVE_ALPHA: f32 = 0.0009765625;
