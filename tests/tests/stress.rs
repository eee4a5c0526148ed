//! The hard cases: every method and every shipped network, case by case.

use peelnet_eval::stress::{CASES, Outcome, Row, Subject, stress};
use peelnet_tests::{gpu, network_of};

/// Every method with its precisions, learned ones with the shipped network.
fn subjects() -> Vec<Subject> {
    let with_network = |method| {
        let network = network_of(&method);
        Subject::new(method, network)
    };
    Subject::all_methods()
        .into_iter()
        .map(with_network)
        .collect()
}

fn run(id: &str) {
    let gpu = gpu();
    let case = CASES.iter().find(|c| c.id == id).unwrap();
    let rows = stress(&gpu, case, &subjects(), true, None, &mut |_| Ok(())).unwrap();
    let failed: Vec<&Row> = rows.iter().filter(|r| r.result == Outcome::Fail).collect();
    for r in &failed {
        println!(
            "{} {} {}: {:?} > {:.3e} at {} {}",
            r.method,
            r.case,
            r.property,
            r.value,
            r.limit,
            r.place,
            r.reason.as_deref().unwrap_or_default()
        );
    }
    assert!(
        failed.is_empty(),
        "{} of {} rows fail",
        failed.len(),
        rows.len()
    );
    for s in subjects().iter().filter(|s| case.judges(&s.method)) {
        let method = s.method.to_string();
        assert!(
            rows.iter().any(|r| r.method == method),
            "{method} is judged"
        );
    }
}

macro_rules! cases {
    ($($test:ident = $id:literal),* $(,)?) => {
        $(#[test] fn $test() { run($id); })*

        /// Every case of the catalogue has its test, so that they run side by side.
        #[test]
        fn every_case_has_its_test() {
            let ids: Vec<&str> = CASES.iter().map(|c| c.id).collect();
            assert_eq!(ids, [$($id),*]);
        }
    };
}

cases! {
    alpha_zero = "alpha-zero",
    alpha_tiny = "alpha-tiny",
    alpha_one = "alpha-one",
    alpha_near_one = "alpha-near-one",
    high_alpha = "high-alpha",
    deep = "deep",
    deep_2000 = "deep-2000",
    deep_20000 = "deep-20000",
    deep_100000 = "deep-100000",
    near_overflow = "near-overflow",
    far = "far",
    wide_range = "wide-range",
    coplanar = "coplanar",
    thin_slab = "thin-slab",
    isolated = "isolated",
    two_layers = "two-layers",
    intersecting = "intersecting",
    grazing = "grazing",
    emissive = "emissive",
    opaque_mix = "opaque-mix",
    empty = "empty",
    half_float = "half-float",
    hostile_inputs = "hostile-inputs",
    moving_camera = "moving-camera",
    passing = "passing",
}
