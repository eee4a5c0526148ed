//! The stress cases: small generated scenes, most of them stacks of quads whose every pixel is known.

use super::{
    Case, Work, network,
    trial::{Stack, Trial},
};
use crate::stage::rectangle;
use glam::Vec3;
use peelnet_core::{fragment::Fragment, guards::EMISSIVE_ALPHA, random::Random};
use peelnet_scene::{Camera, Light, Lighting, Material, Object, Source, suite};

/// Every stress case, in the order of the specification.
pub const CASES: &[Case] = &[
    Case {
        id: "alpha-zero",
        what: "fragments of α = 0, alone and mixed with α = 0.5",
        breaks: "0/0 in every normalisation",
        work: Work::Frames(|| {
            stacks(&[
                ("one of 0", &[(2.0, 0.0)]),
                ("three of 0", &[(2.0, 0.0), (3.0, 0.0), (4.0, 0.0)]),
                ("0 before 0.5", &[(2.0, 0.0), (3.0, 0.5)]),
                ("0 behind 0.5", &[(2.0, 0.5), (3.0, 0.0)]),
                ("0 between", &[(2.0, 0.5), (3.0, 0.0), (4.0, 0.5)]),
            ])
        }),
    },
    Case {
        id: "alpha-tiny",
        what: "10 layers of α = 1e-3, 4 of 1e-5, 256 of 0.005",
        breaks: "8-bit transmittance: 256 of 0.005 must cover 0.723",
        work: Work::Frames(|| {
            vec![trial(vec![
                stack("10 of 1e-3", even(10, 1.0, 10.0, |_| 1e-3)),
                stack("4 of 1e-5", even(4, 1.0, 10.0, |_| 1e-5)),
                stack("256 of 0.005", even(256, 1.0, 10.0, |_| 0.005)),
            ])]
        }),
    },
    Case {
        id: "alpha-one",
        what: "all α = 1; the front with 0.5 behind; the back behind 0.1",
        breaks: "−ln(0), division by 1 − α",
        work: Work::Frames(|| {
            stacks(&[
                ("one", &[(2.0, 1.0)]),
                ("all", &[(2.0, 1.0), (3.0, 1.0), (5.0, 1.0), (9.0, 1.0)]),
                ("front", &[(2.0, 1.0), (3.0, 0.5)]),
                ("back", &[(2.0, 0.1), (3.0, 1.0)]),
                ("middle", &[(2.0, 0.25), (3.0, 1.0), (4.0, 0.5)]),
            ])
        }),
    },
    Case {
        id: "alpha-near-one",
        what: "rectangles of α = 0.99, 0.999 and 1 − 2⁻²⁰ one behind the other",
        breaks: "weighted blending shows what is behind",
        work: Work::Frames(|| {
            let almost = 1.0 - 1.0 / 1_048_576.0;
            stacks(&[
                ("0.99 twice", &[(2.0, 0.99), (2.5, 0.99)]),
                ("0.99 thrice", &[(2.0, 0.99), (2.5, 0.99), (3.0, 0.99)]),
                (
                    "0.99 four times",
                    &[(2.0, 0.99), (2.1, 0.99), (2.2, 0.99), (2.3, 0.99)],
                ),
                ("growing", &[(2.0, 0.99), (3.0, 0.999), (4.0, almost)]),
                ("falling", &[(2.0, almost), (3.0, 0.999), (4.0, 0.99)]),
            ])
        }),
    },
    Case {
        id: "high-alpha",
        what: "sixteen models of α = 0.85 and 0.95",
        breaks: "black artefacts of learned weights (Papakostas 2022)",
        work: Work::Frames(|| [0.85, 0.95].map(sixteen).into()),
    },
    Case {
        id: "deep",
        what: "200 layers of α = 0.9, 300 of 0.02, 1024 of 0.01",
        breaks: "counters in half floats stop at 2048, pools overflow",
        work: Work::Frames(|| {
            vec![trial(vec![
                stack("200 of 0.9", even(200, 1.0, 20.0, |_| 0.9)),
                stack("300 of 0.02", even(300, 1.0, 20.0, |_| 0.02)),
                stack("1024 of 0.01", even(1024, 1.0, 20.0, |_| 0.01)),
            ])]
        }),
    },
    Case {
        id: "deep-2000",
        what: "2,000 layers, in one pixel of an otherwise empty frame and in all pixels of a small one",
        breaks: "loops as long as a pixel's list: a watchdog or a driver's limit ends them",
        work: Work::Deep(|| layers(2_000)),
    },
    Case {
        id: "deep-20000",
        what: "20,000 layers, in one pixel of an otherwise empty frame and in all pixels of a small one",
        breaks: "the same, and sums in 32 bits",
        work: Work::Deep(|| layers(20_000)),
    },
    Case {
        id: "deep-100000",
        what: "100,000 layers, in one pixel of an otherwise empty frame and in all pixels of a small one",
        breaks: "the same",
        work: Work::Deep(|| layers(100_000)),
    },
    Case {
        id: "near-overflow",
        what: "256 layers at the near plane, of equal α and of α from 0.001 to 1",
        breaks: "RGBA16F overflows after 22 layers of weight 3e3",
        work: Work::Frames(|| {
            vec![trial(vec![
                stack("of 0.5", even(256, 0.011, 0.012, |_| 0.5)),
                stack("rising", even(256, 0.011, 0.012, |t| 0.001 + 0.999 * t)),
                stack("falling", even(256, 0.011, 0.012, |t| 1.0 - 0.999 * t)),
            ])]
        }),
    },
    Case {
        id: "far",
        what: "layers at depths 500, 1e4 and 1e6",
        breaks: "weights underflow, moments lose bits",
        work: Work::Frames(|| {
            let all = vec![
                stack("500", vec![(500.0, 0.5)]),
                stack("1e4", vec![(1e4, 0.5)]),
                stack("1e6", vec![(1e6, 0.5)]),
                stack("all", vec![(500.0, 0.3), (1e4, 0.4), (1e6, 0.5)]),
            ];
            vec![Trial::of_stacks([0.1, 2e6], 2, all)]
        }),
    },
    Case {
        id: "wide-range",
        what: "depths from 1e-2 to 1e4 in one pixel",
        breaks: "the depth warp, moments",
        work: Work::Frames(|| {
            let decade = |t: f32| 0.0101 * (1e4f32 / 0.0101).powf(t);
            let layers = |n: usize, alpha: f32| {
                let at = move |i: usize| decade(i as f32 / (n - 1) as f32);
                (0..n).map(|i| (at(i), alpha)).collect::<Vec<_>>()
            };
            vec![trial(vec![
                stack("13 of 0.3", layers(13, 0.3)),
                stack("7 of 0.8", layers(7, 0.8)),
                stack("the ends", layers(2, 0.5)),
            ])]
        }),
    },
    Case {
        id: "coplanar",
        what: "2, 3 and 16 coincident layers, two coincident pairs",
        breaks: "peeling drops layers, flicker",
        work: Work::Frames(|| {
            // Eight red ones and eight blue ones, with layers before and behind whose transmittance shows what the sixteen
            // count for.
            let among = |name: &str, before: &[(f32, f32)], behind: &[(f32, f32)]| {
                let one = |i: usize| {
                    let color = [[0.9, 0.1, 0.1], [0.1, 0.1, 0.9]][i / 8];
                    Fragment::new(3.0, 0.1, color)
                };
                let sixteen = (0..16).map(one).collect();
                Stack::new(name, [rainbow(before), sixteen, rainbow(behind)].concat())
            };
            vec![trial(vec![
                among("sixteen and one", &[], &[(5.0, 0.5)]),
                among("sixteen before two", &[], &[(5.0, 0.5), (9.0, 0.5)]),
                among("sixteen between", &[(1.0, 0.3)], &[(5.0, 0.5), (9.0, 0.5)]),
                stack("two", vec![(3.0, 0.5); 2]),
                stack("three", vec![(3.0, 0.4); 3]),
                stack("sixteen", vec![(3.0, 0.1); 16]),
                stack(
                    "pairs",
                    vec![(2.0, 0.3), (2.0, 0.6), (5.0, 0.3), (5.0, 0.6)],
                ),
            ])]
        }),
    },
    Case {
        id: "thin-slab",
        what: "8 layers within 1e-5 of relative depth, alone and beside a deep scene",
        breaks: "the variance of the moments goes negative",
        work: Work::Frames(|| {
            let slab = || stack("slab", even(8, 3.0, 3.000_03, |_| 0.4));
            vec![
                trial(vec![slab()]),
                trial(vec![slab(), stack("range", vec![(0.5, 0.3), (300.0, 0.3)])]),
            ]
        }),
    },
    Case {
        id: "isolated",
        what: "one surface of α = 0.5 at 801 depths across the range",
        breaks: "moment solvers (bands of NaN)",
        work: Work::Frames(|| {
            let at = |i: usize| 0.5 * 200f32.powf(i as f32 / 800.0);
            let one = |i: usize| stack(&format!("depth {}", at(i)), vec![(at(i), 0.5)]);
            let all = (0..801).map(one).collect();
            vec![Trial::of_stacks(PLANES, 1, all)]
        }),
    },
    Case {
        id: "two-layers",
        what: "pairs at distances of 0.02 to 0.4 of the range",
        breaks: "moments blur",
        work: Work::Frames(|| {
            let mut all = vec![stack("range", vec![(1.0, 0.5), (11.0, 0.5)])];
            for i in 1..=20 {
                let apart = 0.02 * i as f32;
                for near in [1.0, 3.0, 6.0] {
                    let name = format!("{near} and {apart:.2} further");
                    all.push(stack(&name, vec![(near, 0.5), (near + 10.0 * apart, 0.5)]));
                }
            }
            vec![trial(all)]
        }),
    },
    Case {
        id: "apart",
        what: "a surface or two far before, between and behind twenty layers, as objects of their own and of the layers' mesh",
        breaks: "ranges of depth: all but the one surface falls into one slab",
        work: Work::Frames(|| {
            let places: [(&str, &[(f32, f32)]); 9] = [
                ("none", &[]),
                ("near", &[(0.4, 0.15)]),
                ("at a quarter", &[(1.25, 0.15)]),
                ("between", &[(16.0, 0.3)]),
                ("behind", &[(15.0, 0.3)]),
                ("far behind", &[(60.0, 0.3)]),
                ("two near", &[(0.25, 0.15), (1.25, 0.15)]),
                ("near and behind", &[(0.4, 0.15), (15.0, 0.3)]),
                ("very near", &[(0.1, 0.3)]),
            ];
            let own = places.map(|(name, apart)| {
                // Those behind a surface between begin far behind it.
                let split = if name == "between" { 10.0 } else { 1.0 };
                let mut trial = trial(twenty(split, apart));
                trial.scene.name = format!("{name}, own");
                trial
            });
            let joined = places[1..]
                .iter()
                .map(|(name, apart)| one_mesh(name, apart));
            own.into_iter().chain(joined).collect()
        }),
    },
    Case {
        id: "intersecting",
        what: "quads that reach through one another, three in a cycle",
        breaks: "sorting of objects and triangles",
        work: Work::Frames(|| vec![crossing(), cycle()]),
    },
    Case {
        id: "grazing",
        what: "slivers, degenerate triangles, zero normals, triangles through the near plane, lit",
        breaks: "normals that are NaN",
        work: Work::Frames(|| vec![grazing()]),
    },
    Case {
        id: "emissive",
        what: "surfaces that emit up to twenty times white, visible and invisible ones",
        breaks: "half floats, division of premultiplied colour by 0",
        work: Work::Frames(|| {
            let bright = |name: &str, layers: &[(f32, f32, f32)]| {
                let of = |&(depth, alpha, radiance): &(f32, f32, f32)| {
                    Fragment::new(depth, alpha, [radiance, 0.5 * radiance, 0.1])
                };
                Stack::new(name, layers.iter().map(of).collect())
            };
            vec![trial(vec![
                bright("lamp", &[(2.0, 0.1, 20.0)]),
                bright("invisible lamp", &[(2.0, EMISSIVE_ALPHA, 400.0)]),
                bright(
                    "one before a wall",
                    &[(2.0, EMISSIVE_ALPHA, 400.0), (3.0, 0.5, 0.5)],
                ),
                bright(
                    "lamp behind",
                    &[(2.0, 0.5, 0.2), (3.0, 0.3, 20.0), (4.0, 0.5, 0.4)],
                ),
                bright(
                    "lamp before",
                    &[(2.0, 0.02, 20.0), (3.0, 0.5, 0.3), (4.0, 0.9, 0.1)],
                ),
            ])]
        }),
    },
    Case {
        id: "opaque-mix",
        what: "opaque surfaces before, between and behind transparent layers",
        breaks: "fragments behind opaque surfaces count",
        work: Work::Frames(|| {
            let layers = || rainbow(&[(2.0, 0.5), (4.0, 0.5), (6.0, 0.5)]);
            let at = |name: &str, depth: f32| {
                let mut stack = Stack::new(name, layers());
                stack.opaque = Some((depth, [0.1, 0.7, 0.3]));
                stack
            };
            vec![trial(vec![
                at("before", 1.0),
                at("after one", 3.0),
                at("after two", 5.0),
                at("behind", 8.0),
                Stack::new("none", layers()),
            ])]
        }),
    },
    Case {
        id: "lines",
        what: "lines and labels of α = 1 and 0.99 over, between and below one to six translucent polygons close to them, a pixel wide and three",
        breaks: "what covers is shown translucent, and lines are missed by passes over a part of the pixels (Cesium 4170, 13722)",
        work: Work::Frames(|| {
            let of = |cover| Trial::of_stacks(PLANES, cover, lines());
            vec![of(1), of(3)]
        }),
    },
    Case {
        id: "empty",
        what: "no object in view, a mesh without triangles",
        breaks: "a prefix sum of nothing",
        work: Work::Frames(|| {
            let behind = Vec3::new(0.0, 0.0, 3.0);
            let triangle = [[behind, behind + Vec3::X, behind + Vec3::Y]];
            let hidden = object("behind", triangle, [1.0; 3], 0.5);
            let none = object("none", [], [1.0; 3], 0.5);
            vec![
                Trial::rasterised("behind the camera", PLANES, vec![hidden]),
                Trial::rasterised("no triangle", PLANES, vec![none]),
                Trial::rasterised("no object", PLANES, vec![]),
            ]
        }),
    },
    Case {
        id: "half-float",
        what: "every network in half floats, on inputs like those it was trained on",
        breaks: "overflow of exponentials, cancellation",
        work: Work::Network(network::in_half_floats),
    },
    Case {
        id: "hostile-inputs",
        what: "the exported function on any finite input: 0, denormals, 1e±30, random bits",
        breaks: "NaN out of the network",
        work: Work::Network(network::on_hostile_inputs),
    },
    Case {
        id: "moving-camera",
        what: "a camera that moves by a tenth of a pixel, eleven times",
        breaks: "noise that lives in the image",
        work: Work::Frames(|| {
            let mut trial = crossing();
            let base = trial.scene.views[0];
            // At distance 3 a frame of 90° is 6 units high.
            let tenth = 6.0 / trial.size[1] as f32 / 10.0;
            let view = |i: u8| {
                let step = Vec3::new(tenth * f32::from(i), 0.5 * tenth * f32::from(i), 0.0);
                Camera {
                    position: base.position + step,
                    target: base.target + step,
                    ..base
                }
            };
            trial.scene.views = (0..12).map(view).collect();
            trial.moves = true;
            vec![trial]
        }),
    },
    Case {
        id: "passing",
        what: "one surface passes through another between others, in steps of a thousandth of its depth",
        breaks: "popping: an order that flips at once for a whole object",
        work: Work::Frames(|| {
            let steps = (0..5).map(|i| {
                let t = (i as f32 - 2.0) * 0.003;
                // From one depth on the left to another on the right.
                let wall = |l: f32, r: f32| {
                    let vertex = |(x, depth): (f32, f32), y: f32| Vec3::new(x, y, -depth);
                    rectangle([(-2.0, l), (2.0, r)], [-2.0, 2.0], vertex)
                };
                // Leaning by a fifth of a unit, so that the line in which it meets the other one wanders over the frame.
                let leaning = wall(2.95 + t, 3.05 + t);
                vec![
                    object("near", wall(2.0, 2.0), [0.9, 0.9, 0.2], 0.2),
                    object("standing", wall(3.0, 3.0), [0.9, 0.1, 0.1], 0.6),
                    object("leaning", leaning, [0.1, 0.2, 0.9], 0.6),
                    object("far", wall(5.0, 5.0), [0.2, 0.9, 0.3], 0.5),
                ]
            });
            let frame = |objects| Trial {
                moves: true,
                ..Trial::rasterised("passing", NARROW, objects)
            };
            steps.map(frame).collect()
        }),
    },
];

/// Near and far plane of most cases.
const PLANES: [f32; 2] = [0.01, 2e4];

/// Those of scenes with surfaces very near and far.
const NARROW_TO_FAR: [f32; 2] = [0.02, 1e3];

/// Those of scenes whose surfaces are no stacks.
const NARROW: [f32; 2] = [0.1, 100.0];

/// (depth, α) with colours by a rule.
fn rainbow(layers: &[(f32, f32)]) -> Vec<Fragment> {
    let color = |i: usize| {
        let t = i as f32 * 0.37 + 0.1;
        [t.fract(), (2.3 * t).fract(), 1.0 - t.fract()]
    };
    let layers = layers.iter().enumerate();
    let fragments = layers.map(|(i, &(depth, alpha))| Fragment::new(depth, alpha, color(i)));
    fragments.collect()
}

fn stack(name: &str, layers: Vec<(f32, f32)>) -> Stack {
    Stack::new(name, rainbow(&layers))
}

/// `n` layers from one depth to another; `alpha` gets the position of each, 0 … 1.
fn even(n: usize, from: f32, to: f32, alpha: impl Fn(f32) -> f32) -> Vec<(f32, f32)> {
    let layer = |i: usize| {
        let t = i as f32 / (n - 1) as f32;
        (from + (to - from) * t, alpha(t))
    };
    (0..n).map(layer).collect()
}

/// Nine stacks of twenty layers at depths from 4 to 6, the farther ten of them so many times as far, and what lies apart.
fn twenty(split: f32, apart: &[(f32, f32)]) -> Vec<Stack> {
    let stack = |seed: u64| {
        let mut random = Random::new(seed, &[]);
        let mut layers: Vec<Fragment> = Vec::new();
        for i in 0..20 {
            let times = if i < 10 { 1.0 } else { split };
            let depth = times * (4.0 + 0.1 * (i as f32 + 0.8 * random.unit()));
            layers.push(Fragment::new(
                depth,
                random.between(0.03, 0.4),
                random.color(),
            ));
        }
        let far = apart
            .iter()
            .map(|&(depth, alpha)| Fragment::new(depth, alpha, [0.9, 0.8, 0.3]));
        layers.extend(far);
        Stack::new(&format!("stack {seed}"), layers)
    };
    (0..9).map(stack).collect()
}

/// Five meshes of four walls that lean in many ways, and what lies apart in the first of them: boxes around objects know nothing of the gap.
fn one_mesh(name: &str, apart: &[(f32, f32)]) -> Trial {
    let mut random = Random::new(17, &[]);
    let mesh = |k: usize| {
        let mut walls = Vec::new();
        for i in 0..4 {
            let depth = 4.0 + 0.1 * (5 * i + k) as f32;
            let [l, r] = [(); 2].map(|()| depth + random.between(-0.3, 0.3));
            let vertex = |(x, depth): (f32, f32), y: f32| Vec3::new(x, y, -depth);
            walls.extend(rectangle([(-9.0, l), (9.0, r)], [-7.0, 7.0], vertex));
        }
        for &(depth, _) in apart.iter().filter(|_| k == 0) {
            let side = 2.0 * depth;
            let vertex = |x: f32, y: f32| Vec3::new(x, y, -depth);
            walls.extend(rectangle([-side, side], [-side, side], vertex));
        }
        let (color, alpha) = (random.color(), random.between(0.1, 0.3));
        Object::of_triangles("walls", &walls, Material::unlit(color, alpha))
    };
    let meshes = (0..5).map(mesh).collect();
    Trial::rasterised(&format!("{name}, one mesh"), NARROW_TO_FAR, meshes)
}

/// Layers of which all together cover 0.95, drawn in an order that says nothing of their depths.
fn layers(n: usize) -> Vec<Trial> {
    // A prime that does not divide n: every place comes once.
    let shuffled = |i: usize| i * 7_919 % n;
    let all = even(n, 2.0, 6.0, |_| 3.0 / n as f32);
    let drawn: Vec<_> = (0..n).map(|i| all[shuffled(i)]).collect();
    let of = |cover: u32| {
        let stack = vec![stack(&format!("{n} layers"), drawn.clone())];
        Trial::of_stacks(PLANES, cover, stack)
    };
    vec![of(1), of(3)]
}

/// A line over, between or below polygons, and a label before a line.
fn lines() -> Vec<Stack> {
    let mut all = Vec::new();
    for (n, alpha) in [1, 2, 4, 6].into_iter().flat_map(|n| [(n, 1.0), (n, 0.99)]) {
        let polygons = (0..n).map(|i| (4.0 + 0.02 * i as f32, 0.25 + 0.1 * i as f32));
        for (place, line) in [("over", 0), ("between", n / 2), ("below", n)] {
            let mut layers: Vec<_> = polygons.clone().collect();
            layers.push((3.99 + 0.02 * line as f32, alpha));
            all.push(stack(&format!("{alpha} {place} {n}"), layers.clone()));
            layers.push((3.5, 0.99));
            all.push(stack(&format!("label, {alpha} {place} {n}"), layers));
        }
    }
    all
}

fn trial(stacks: Vec<Stack>) -> Trial {
    Trial::of_stacks(PLANES, 3, stacks)
}

fn stacks(of: &[(&str, &[(f32, f32)])]) -> Vec<Trial> {
    let all = of.iter().map(|(name, layers)| stack(name, layers.to_vec()));
    vec![trial(all.collect())]
}

fn sixteen(alpha: f32) -> Trial {
    let mut scene = suite::load("sixteen-050").expect("it ships");
    for material in scene.objects.iter_mut().flat_map(|o| &mut o.materials) {
        material.alpha = alpha;
    }
    scene.name = format!("sixteen at {alpha}");
    scene.views.truncate(1);
    Trial {
        scene,
        ..Trial::rasterised("", PLANES, Vec::new())
    }
}

fn object<const N: usize>(
    name: &str,
    triangles: [[Vec3; 3]; N],
    color: [f32; 3],
    alpha: f32,
) -> Object {
    Object::of_triangles(name, &triangles, Material::unlit(color, alpha))
}

/// Five quads that stand across one another like the leaves of a book, before a sixth.
fn crossing() -> Trial {
    let leaf = |i: u8| {
        let i = f32::from(i);
        let (sin, cos) = (0.3 + 0.6 * i).sin_cos();
        let v = |s: f32, y: f32| Vec3::new(1.6 * s * cos, 1.4 * y, -3.0 + 1.6 * s * sin);
        let leaf = rectangle([-1.0, 1.0], [-1.0, 1.0], v);
        let t = i / 5.0;
        let (color, alpha) = ([t, 1.0 - t, (3.0 * t).fract()], 0.3 + 0.12 * i);
        object(&format!("leaf {i}"), leaf, color, alpha)
    };
    let mut objects: Vec<Object> = (0..5).map(leaf).collect();
    let v = |x: f32, y: f32| Vec3::new(x, y, -6.0);
    let wall = [[v(-4.0, -5.0), v(5.0, -4.0), v(0.0, 5.0)]];
    objects.push(object("wall", wall, [0.9, 0.8, 0.1], 0.7));
    Trial::rasterised("crossing", NARROW, objects)
}

/// Three bars that overlap in a cycle: no order of the triangles is right.
fn cycle() -> Trial {
    let bar = |i: usize| {
        let turn = glam::Quat::from_rotation_z(i as f32 * std::f32::consts::TAU / 3.0);
        // One end in front, the other behind.
        let ends = [(-1.6, 2.6), (1.6, 3.4)];
        let bar = rectangle(ends, [-0.9, -0.2], |(x, depth), y| {
            turn * Vec3::new(x, y, 0.0) - Vec3::Z * depth
        });
        let color = [[0.9, 0.1, 0.1], [0.1, 0.8, 0.2], [0.1, 0.2, 0.9]][i];
        object(&format!("bar {i}"), bar, color, 0.6)
    };
    Trial::rasterised("cycle", NARROW, (0..3).map(bar).collect())
}

/// Triangles that break normals and clipping, lit.
fn grazing() -> Trial {
    let phong = |color: [f32; 3], alpha: f32| Material {
        lighting: Lighting::Phong,
        specular: 0.5,
        shininess: 40.0,
        ..Material::unlit(color, alpha)
    };
    let v = Vec3::new;
    // Each an object, so that the reference knows one from the next.
    let slivers = (0..40).map(|i| {
        let x = -1.5 + 0.075 * i as f32;
        let sliver = [
            v(x, -1.5, -3.0),
            v(x + 1e-4, 1.5, -3.0),
            v(x + 0.05, 1.5, -3.1),
        ];
        Object::of_triangles("sliver", &[sliver], phong([0.9, 0.5, 0.2], 0.4))
    });
    let point = v(0.2, 0.1, -2.0);
    let degenerate = [
        [point; 3],
        [point, point + Vec3::X, point],
        [point, point + Vec3::X, point + 2.0 * Vec3::X],
    ];
    // Seen along its own plane, but for a hair's breadth.
    let edge_on = [[v(-2.0, 1e-4, -1.0), v(2.0, 1e-4, -1.0), v(0.0, -1e-3, -8.0)]];
    let through = [
        [v(-3.0, -1.0, 2.0), v(3.0, -1.0, 2.0), v(0.0, 0.5, -6.0)],
        [v(-1.0, 3.0, 1.0), v(0.0, -0.5, -4.0), v(1.0, 3.0, 1.0)],
    ];
    let mut objects: Vec<Object> = slivers.collect();
    objects.extend([
        Object::of_triangles("degenerate", &degenerate, phong([0.2, 0.9, 0.5], 0.5)),
        Object::of_triangles("edge-on", &edge_on, phong([0.9; 3], 0.5)),
        Object::of_triangles("through", &through, phong([0.3, 0.4, 0.9], 0.5)),
    ]);
    let mut flat = Object::of_triangles(
        "no normal",
        &[[v(-2.0, -1.0, -4.0), v(2.0, -1.0, -4.0), v(0.0, 1.5, -4.0)]],
        phong([0.7, 0.2, 0.6], 0.5),
    );
    let mut mesh = (*flat.mesh).clone();
    mesh.normals.fill(Vec3::ZERO);
    flat.mesh = mesh.into();
    objects.push(flat);
    let mut trial = Trial::rasterised("grazing", NARROW, objects);
    trial.scene.lights.push(Light {
        source: Source::Point(v(1.0, 2.0, 1.0)),
        color: [1.0; 3],
        intensity: 1.0,
    });
    trial
}
