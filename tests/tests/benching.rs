//! The comparison of methods as a library: what is drawn again after an interruption, and how memory grows.

use peelnet_bench::{
    Partial, Row,
    bench::{Progress, bench_watched},
    compare::Plan,
    scaling::{self, Series},
};
use peelnet_core::{
    fragment::{Fragment, worked_example},
    methods::over,
};
use peelnet_render::{MethodSpec, methods::mlab};
use peelnet_scene::Scene;
use peelnet_tests::{gpu, specs, walls};
use std::sync::atomic::AtomicBool;

static NEVER: AtomicBool = AtomicBool::new(false);

/// The rows of a comparison that goes on from `done`, and how many frames it draws.
fn rows(scene: &Scene, methods: &[MethodSpec], done: &[Row]) -> (Vec<Row>, usize) {
    let plan = Plan {
        frames: 2,
        ..Plan::new([16, 12], methods)
    };
    let mut partial = Partial::new(None, serde_json::Value::Null);
    partial.push(done.to_vec()).unwrap();
    let mut drawn = 0;
    let mut report = |event| match event {
        Progress::Drawn { .. } => drawn += 1,
        Progress::LeftOut(what) => panic!("{what}"),
    };
    let scenes = std::slice::from_ref(scene);
    let bench = bench_watched(&gpu(), scenes, &plan, partial, &NEVER, &mut report).unwrap();
    (bench.rows, drawn)
}

/// A method without passes is composited on the CPU, in the order of drawing: its row has the error that follows from the walls, and neither
/// time nor bytes.
#[test]
fn a_method_on_the_cpu_has_an_error_and_no_time() {
    let wall = |depth, color| Fragment::new(depth, 0.5, color);
    let (red, green, blue) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    let drawn = [wall(1.0, red), wall(3.0, green), wall(2.0, blue)];
    let c0 = [0.25, 0.5, 0.75];
    let methods = specs(["mlab-1", "mlab-4"]);
    let scene = walls(&drawn, c0);
    let (rows, _) = rows(&scene, &methods, &[]);
    let exact = over::composite_f64(&drawn, c0);
    for (nodes, row) in [(1, &rows[1]), (4, &rows[2])] {
        let reference = mlab::reference::composite(&drawn, c0, nodes);
        let squares = (0..3).map(|k| (f64::from(reference[k]) - exact[k]).powi(2));
        let want = squares.sum::<f64>() / 3.0;
        assert_eq!(row.method, format!("mlab-{nodes}"));
        // Twice the error of an exact image, 1e-5, times the error itself.
        let slack = 2e-5 * want.sqrt() + 1e-10;
        let found = row.mse_linear;
        assert!((found - want).abs() < slack, "{nodes}: {found} for {want}");
        assert_eq!((row.time_ms, row.wall_ms, row.passes), (None, None, 0));
        assert_eq!((row.bytes_per_pixel, row.time_by_pass.as_str()), (None, ""));
        assert_eq!(row.flip.is_some(), rows[0].flip.is_some());
    }
    assert!(rows[1].mse_linear > 1e-3 && rows[2].mse_linear < 1e-10);
}

/// Views that are done are not drawn again; the others have the rows that they would have had.
#[test]
fn a_resumed_comparison_draws_what_is_left() {
    let methods = specs(["mboit4", "dual-peel"]);
    let mut scene = walls(&worked_example(), [0.0; 3]);
    scene.views = vec![scene.views[0]; 3];
    let (all, drawn) = rows(&scene, &methods, &[]);
    // The exact method and two others, on three views: one compared frame and two timed ones each.
    assert_eq!((all.len(), drawn), (9, 27));
    let done: Vec<Row> = all.iter().filter(|r| r.view != 1).cloned().collect();
    let (resumed, drawn) = rows(&scene, &methods, &done);
    assert_eq!((resumed.len(), drawn), (9, 9));
    for (a, b) in all.iter().filter(|r| r.view == 1).zip(&resumed[6..]) {
        assert_eq!((&a.method, a.view), (&b.method, b.view));
        // Errors agree to the bit.
        assert_eq!(a.mse_linear.to_bits(), b.mse_linear.to_bits());
        let [a, b] = [a, b].map(|r| (r.ssim, r.flip, r.transmittance_error));
        assert_eq!(a, b);
    }
    for row in &all {
        let is_moments = row.method == "mboit4";
        assert_eq!(row.transmittance_error.is_some(), is_moments);
        assert!(row.lost.unwrap_or_default() == 0 && row.flip.is_some());
    }
    assert_eq!(rows(&scene, &methods, &all).1, 0);
}

/// A method whose storage the adapter does not allow is reported where all are asked for, and ends the comparison where it was
/// asked for itself; the others have their rows either way.
#[test]
fn what_is_too_large_is_left_out_and_told() {
    let gpu = gpu();
    let scene = walls(&worked_example(), [0.0; 3]);
    let methods = specs(["kbuffer-64", "wboit-eq9"]);
    // 16 bytes of colour in each of 64 places: more than the binding holds by a row of pixels.
    let height = gpu.limits.max_storage_buffer_binding_size / (64 * 16 * 2048) + 1;
    let run = |lenient| {
        let plan = Plan {
            lenient,
            frames: 0,
            ..Plan::new([2048, height as u32], &methods)
        };
        let mut left_out = Vec::new();
        let mut report = |event| {
            if let Progress::LeftOut(what) = event {
                left_out.push(what);
            }
        };
        let partial = Partial::new(None, serde_json::Value::Null);
        let scenes = std::slice::from_ref(&scene);
        let done = bench_watched(&gpu, scenes, &plan, partial, &NEVER, &mut report);
        let rows = done.map(|bench| bench.rows.into_iter().map(|r| r.method));
        (rows.map(Iterator::collect::<Vec<_>>), left_out)
    };
    let (rows, left_out) = run(true);
    assert_eq!(rows.unwrap(), ["abuffer", "wboit-eq9"]);
    assert_eq!(left_out.len(), 1, "{left_out:?}");
    assert!(left_out[0].starts_with("kbuffer-64 is left out"));
    assert!(left_out[0].contains("allows"), "{left_out:?}");
    run(false).0.unwrap_err();
}

/// Bytes follow from what is allocated: per-fragment storage grows with the fragments, targets do not.
#[test]
#[ignore = "long: cargo xtask test --all"]
fn memory_grows_as_it_is_allocated() {
    let methods = specs(["abuffer", "wboit-eq9", "kbuffer-4"]);
    let plan = Plan {
        frames: 1,
        ..Plan::new([16, 12], &methods)
    };
    let measured = scaling::measure(&gpu(), &plan, &NEVER, &mut |_| ());
    let measured = measured.unwrap();
    assert!(measured.left_out.is_empty(), "{:?}", measured.left_out);
    let rows = measured.rows;
    let of = |method: &str, series: Series, value: u64| {
        let mut rows = rows.iter();
        let found = rows.find(|r| r.method == method && r.series == series && r.value == value);
        found.map(|row| row.bytes_per_pixel)
    };
    // RGBA16F and R16F; and four depths, triangles and colours with an attachment that nothing is written to.
    assert_eq!(of("wboit-eq9", Series::Fragments, 256), Some(10.0));
    let four = 10.0 + 4.0 * 24.0 + 1.0;
    assert_eq!(of("kbuffer-4", Series::Fragments, 1), Some(four));
    // Count, offset, attachment, and 24 bytes a fragment.
    let stored = 9.0 + 64.0 * 24.0;
    assert_eq!(of("abuffer", Series::Fragments, 64), Some(stored));
}
