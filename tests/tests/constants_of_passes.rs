//! Every number in the passes of published methods, and a sample of those in exported texts: a tenth more or less of it fails the
//! comparison of a frame with the CPU twin. See `altered`.

#![allow(clippy::unwrap_used, reason = "a failing test may panic")]

use peelnet_core::{fragment::Fragment, random::Random};
use peelnet_render::{LearnedWeight, MethodSpec};
use peelnet_tests::{
    altered::{self, Columns, NEVER, Unseen, check},
    gpu, network_of,
};

/// Errors with 32-bit targets: sums of a few terms, logarithms and exponentials.
const FULL: f64 = 2e-6;

/// Bound for colours stored in bytes: where a root lies halfway between two, shader and twin may take either, which is a step of the
/// root, two of the colour, for each of a few fragments.
const BYTES: f64 = 6.0 / 255.0;

/// Errors with 16-bit targets: four roundings of half floats, 2^-11 each.
const HALF: f64 = 2e-3;

/// Errors of exported texts: ends are kept in levels of a ten-thousandth, and roots of cancelled sums taken.
const TEXT: f64 = 2e-5;

/// Why numbers of a range that is one depth do not show.
const ONE_DEPTH: &str = "no range here is nearly one depth: peelnet_core tests the twin's";

/// Pixels of one to six fragments, or of `many` up to fourteen, anywhere in the depths, of all opacities, and such as have one on either side of what counts as opaque.
fn columns(many: bool) -> Columns {
    let mut random = Random::new(23, &[]);
    let mut of = |n: usize, alpha: [f32; 2]| -> Vec<Fragment> {
        let mut one = || {
            let depth = random.log_between(1.0, 50.0);
            Fragment::new(depth, random.between(alpha[0], alpha[1]), random.color())
        };
        (0..n).map(|_| one()).collect()
    };
    let mut all: Vec<_> = (0..30).map(|i| of(1 + i % 6, [0.05, 0.95])).collect();
    all.extend((0..6).map(|_| of(4, [0.01, 0.2])));
    if many {
        all.extend((0..8).map(|i| of(7 + i, [0.02, 0.5])));
    }
    for alpha in [0.985, 0.995, 1.0] {
        for place in [2.0, 8.0] {
            let mut some = of(3, [0.3, 0.6]);
            some.push(Fragment::new(place, alpha, [0.9, 0.1, 0.5]));
            all.push(some);
        }
    }
    Columns::new(all)
}

/// Methods with the largest errors of their frames, the modules whose literals are changed, and what no method shows.
struct Passes<'a> {
    methods: &'a [(&'a str, f64)],
    modules: &'a [&'a str],
    unseen: &'a [Unseen<'a>],
}

impl Passes<'_> {
    fn check(&self) {
        let gpu = gpu();
        let columns = columns(true);
        let methods: Vec<(MethodSpec, f64)> = self
            .methods
            .iter()
            .map(|(text, tolerance)| (text.parse().unwrap(), *tolerance))
            .collect();
        // In tolerances.
        let error = || {
            let errors = methods
                .iter()
                .map(|(spec, tolerance)| columns.error(&gpu, spec, None) / tolerance);
            errors.fold(0.0, f64::max)
        };
        let texts = self
            .modules
            .iter()
            .map(|m| (*m, peelnet_shaders::source(m).unwrap()));
        let name = self.methods[0].0;
        let problem = altered::problem(name, texts, 1.0, self.unseen, |altered| match altered {
            Some((module, text)) => peelnet_shaders::with_altered(module, text, error),
            None => error(),
        });
        check([problem]);
    }
}

#[test]
fn bins_have_no_number_that_does_not_matter() {
    Passes {
        methods: &[
            ("bins-4:targets=f32", FULL),
            ("bins-8:targets=f32", FULL),
            ("bins-16:bounds=frame,targets=f32", FULL),
            ("bins-16:targets=f16", HALF),
        ],
        modules: &[
            "methods::bins::accumulate",
            "methods::bins::bin",
            "methods::bins::bounds",
            "methods::bins::gather",
            "helpers::range_of_pixel",
        ],
        unseen: &[
            ("1e-6", "let place = clamp(", ONE_DEPTH),
            ("1e-6", "return select(place, 0.0, extent", ONE_DEPTH),
        ],
    }
    .check();
}

#[test]
fn wavelets_have_no_number_that_does_not_matter() {
    Passes {
        methods: &[
            ("wavelet-2:bounds=pixel,targets=f32", FULL),
            ("wavelet-3:targets=f32", FULL),
        ],
        modules: &[
            "methods::wavelet::coefficients",
            "methods::wavelet::gather",
            "methods::wavelet::haar",
            "helpers::range_of_pixel",
        ],
        unseen: &[
            ("1e-6", "let place = clamp(", ONE_DEPTH),
            ("1e-6", "return select(place, 0.0, extent", ONE_DEPTH),
        ],
    }
    .check();
}

/// Of blocks of one pixel, which its neighbours do not reach.
#[test]
fn voxels_have_no_number_that_does_not_matter() {
    Passes {
        methods: &[("avboit:cell=1,targets=f32", FULL)],
        modules: &[
            "methods::avboit::gather",
            "methods::avboit::grid",
            "methods::avboit::integrate",
            "methods::avboit::voxels",
        ],
        unseen: &[],
    }
    .check();
}

#[test]
fn samples_have_no_number_that_does_not_matter() {
    Passes {
        methods: &[("stochastic-4:targets=f32", FULL)],
        modules: &[
            "methods::stochastic::depths",
            "methods::stochastic::gather",
            "methods::stochastic::samples",
        ],
        unseen: &[("1e-6", "return vec4f(color.rgb / max(color.a, 1e-6)", NEVER)],
    }
    .check();
}

#[test]
fn lists_have_no_number_that_does_not_matter() {
    const TINTED: &str = "of light that takes a colour, which these fragments do not give it";
    Passes {
        methods: &[("linked-list", FULL), ("linked-list:colors=u8", BYTES)],
        modules: &["methods::linked_list::composite", "helpers::stored"],
        unseen: &[
            ("1.0", "@if(tinted) var transmittance", TINTED),
            ("1.0", "transmittance *= 1.0 - restored(colors[2u", TINTED),
            ("1.0", "@if(tinted) let covered", TINTED),
            ("1.0", "@if(tinted) let covered", TINTED),
            ("3.0", "@if(tinted) let covered", TINTED),
            (
                "1.0",
                "let bytes",
                "where bytes end: no light here is beyond 1",
            ),
            ("0.5", "let bytes", "half a byte, within the bound"),
        ],
    }
    .check();
}

#[test]
fn places_have_no_number_that_does_not_matter() {
    Passes {
        methods: &[
            ("kbuffer-2:targets=f32", FULL),
            ("hybrid-2:targets=f32", FULL),
        ],
        modules: &["methods::kbuffer::gather", "methods::kbuffer::resolve"],
        unseen: &[(
            "1.0",
            "@if(unweighted) let weight = 1.0;",
            "a factor of all weights",
        )],
    }
    .check();
}

/// Of exported texts, every seventh literal: some units of a network never fire in these pixels, and some numbers are guards, but two
/// fifths must show. In slabs so much is known that a tenth of a weight hardly shows: those texts are compared with the core function by
/// function, in `exported_slabs`. Texts change with every training, so no list would stay true.
#[test]
fn numbers_of_exported_texts_show() {
    let gpu = gpu();
    // Of many fragments roots of cancelled sums err by more.
    let columns = columns(false);
    let mut problems = Vec::new();
    for method in [
        "deep-anchored-small:targets=f32",
        "deep-anchored-medium:targets=f32",
    ] {
        let spec: MethodSpec = method.parse().unwrap();
        let (shipped, model) = network_of(&spec).unwrap();
        let error = |wgsl: &str| {
            let recipe = shipped.recipe;
            let wgsl = wgsl.to_owned();
            let learned = LearnedWeight { recipe, wgsl };
            columns.error(&gpu, &spec, Some((&learned, &model)))
        };
        let plain = error(&shipped.wgsl);
        println!("{method}: {plain:.2e}");
        if plain > TEXT {
            problems.push(Some(format!("{method}: {plain:.2e}")));
            continue;
        }
        let texts = [("learned::weight", shipped.wgsl.as_str())];
        let (unseen, changed) = altered::unseen(method, texts, 7, TEXT, |_, text| error(text));
        println!("{method}: {} of {changed} do not show", unseen.len());
        let enough = changed > 10 && 5 * unseen.len() <= 3 * changed;
        problems.push((!enough).then(|| format!("{method}: of {changed} do not show {unseen:#?}")));
    }
    check(problems);
}
