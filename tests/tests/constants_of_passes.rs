//! Every number in the passes of published methods, and a sample of those in exported texts: a tenth more or less of it fails the
//! comparison of a frame with the CPU twin. See `altered`.

#![allow(clippy::unwrap_used, reason = "a failing test may panic")]

use peelnet_core::{fragment::Fragment, random::Random};
use peelnet_render::{LearnedWeight, MethodSpec};
use peelnet_tests::{
    altered::{self, Columns, Unseen, check},
    gpu, network_of,
};

/// Errors of 32-bit targets: sums of a few terms, logarithms and exponentials, which llvmpipe has to 1e-6.
const FULL: f64 = 2e-5;

/// Pixels of one to six fragments anywhere in the depths, of all opacities, and such as have one on either side of what counts as opaque.
fn columns() -> Columns {
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
    for alpha in [0.985, 0.995, 1.0] {
        for place in [2.0, 8.0] {
            let mut some = of(3, [0.3, 0.6]);
            some.push(Fragment::new(place, alpha, [0.9, 0.1, 0.5]));
            all.push(some);
        }
    }
    Columns::new(all)
}

/// A method, the modules whose literals are changed, and what does not show.
type Passes<'a> = (&'a str, &'a [&'a str], &'a [Unseen<'a>]);

fn check_passes(passes: &[Passes<'_>]) {
    let gpu = gpu();
    let columns = columns();
    check(passes.iter().map(|(method, modules, unseen)| {
        let spec: MethodSpec = method.parse().unwrap();
        let error = || columns.error(&gpu, &spec, None);
        let texts = modules
            .iter()
            .map(|m| (*m, peelnet_shaders::source(m).unwrap()));
        altered::problem(method, texts, FULL, unseen, |altered| match altered {
            Some((module, text)) => peelnet_shaders::with_altered(module, text, error),
            None => error(),
        })
    }));
}

#[test]
fn bins_have_no_number_that_does_not_matter() {
    let modules = [
        "methods::bins::accumulate",
        "methods::bins::bin",
        "methods::bins::bounds",
        "methods::bins::gather",
        "helpers::range_of_pixel",
    ];
    check_passes(&[
        ("bins-4:targets=f32", &modules, &[]),
        ("bins-16:bounds=frame,targets=f32", &modules, &[]),
    ]);
}

#[test]
fn wavelets_have_no_number_that_does_not_matter() {
    let modules = [
        "methods::wavelet::coefficients",
        "methods::wavelet::gather",
        "methods::wavelet::haar",
        "helpers::range_of_pixel",
    ];
    check_passes(&[
        ("wavelet-2:bounds=pixel,targets=f32", &modules, &[]),
        ("wavelet-3:targets=f32", &modules, &[]),
    ]);
}

/// Of blocks of one pixel, which its neighbours do not reach.
#[test]
fn voxels_have_no_number_that_does_not_matter() {
    check_passes(&[(
        "avboit:cell=1,targets=f32",
        &[
            "methods::avboit::gather",
            "methods::avboit::grid",
            "methods::avboit::integrate",
            "methods::avboit::voxels",
        ],
        &[],
    )]);
}

#[test]
fn samples_have_no_number_that_does_not_matter() {
    check_passes(&[(
        "stochastic-4:targets=f32",
        &[
            "methods::stochastic::depths",
            "methods::stochastic::gather",
            "methods::stochastic::samples",
        ],
        &[],
    )]);
}

/// Of methods that keep fragments.
#[test]
fn lists_have_no_number_that_does_not_matter() {
    check_passes(&[
        (
            "linked-list",
            &["methods::linked_list::composite", "helpers::stored"],
            &[],
        ),
        (
            "kbuffer-2:targets=f32",
            &["methods::kbuffer::gather", "methods::kbuffer::resolve"],
            &[],
        ),
    ]);
}

/// Of exported texts, every seventh literal: some units of a network never fire in these pixels, and some numbers are guards, but most
/// must show. Texts change with every training, so no list would stay true.
#[test]
fn most_numbers_of_exported_texts_show() {
    let gpu = gpu();
    let columns = columns();
    let mut problems = Vec::new();
    for method in [
        "deep-small:targets=f32",
        "deep-medium:targets=f32",
        "deep-large:targets=f32",
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
        if plain > FULL {
            problems.push(Some(format!("{method}: {plain:.2e}")));
            continue;
        }
        let texts = [("learned::weight", shipped.wgsl.as_str())];
        let (unseen, changed) = altered::unseen(method, texts, 7, FULL, |_, text| error(text));
        println!("{method}: {} of {changed} do not show", unseen.len());
        let most = changed > 10 && 4 * unseen.len() < changed;
        problems.push((!most).then(|| format!("{method}: of {changed} do not show {unseen:#?}")));
    }
    check(problems);
}
