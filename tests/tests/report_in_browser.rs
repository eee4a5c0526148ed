//! The bench's page in a real browser: headless Chromium, which `cargo xtask test --all` installs where it is missing.

use peelnet_eval::{Machine, Row, bench::Bench, compare::EXACT, front::BASE};
use peelnet_report::Results;
use std::{path::Path, process::Command};

fn row(method: &str, scene: &str, mse: f64, ms: f64) -> Row {
    Row {
        method: method.to_owned(),
        scene: scene.to_owned(),
        view: 0,
        width: 8,
        height: 8,
        samples: 1,
        fragments: Some(128),
        max_layers: Some(4),
        lost: None,
        mse_linear: mse,
        mse_linear_covered: Some(mse),
        mse255: mse * 65025.0,
        mse255_covered: None,
        psnr: None,
        ssim: Some(1.0 - mse),
        flip: Some(mse),
        transmittance_error: None,
        contour_pairs: None,
        p99_error: 0.0,
        max_error: 0.0,
        covered_pixels: 64,
        dark_pixels: 0,
        non_finite_pixels: 0,
        time_ms: Some(ms),
        time_ms_min: Some(ms),
        time_ms_p90: Some(ms),
        wall_ms: None,
        time_by_pass: format!("gather={ms}"),
        passes: 2,
        bytes_per_pixel: Some(24.0),
        adapter: "test".to_owned(),
    }
}

fn bench() -> Results<Bench> {
    let methods = [
        (EXACT, 0.0, 90.0),
        (BASE, 1e-2, 9.0),
        ("mboit4", 1e-4, 20.0),
        ("wboit-eq9", 1e-3, 10.0),
    ];
    let rows = ["first", "second"]
        .into_iter()
        .flat_map(|scene| methods.map(|(method, mse, ms)| row(method, scene, mse, ms)))
        .collect();
    let machine = Machine {
        os: "linux".into(),
        arch: "x86_64".into(),
        cpu: "test".into(),
        cores: 2,
        memory: 0,
        adapter: "test".into(),
        adapter_kind: "software".into(),
        backend: "vulkan".into(),
        driver: "test".into(),
        peelnet: "0".into(),
        build: "debug".into(),
    };
    let bench = Bench {
        load: [None; 2],
        settings: None,
        trained_on: Vec::new(),
        rows,
    };
    Results::new(machine, "peelnet bench", bench)
}

fn chromium() -> &'static str {
    ["chromium", "chromium-browser", "google-chrome", "chrome"]
        .into_iter()
        .find(|name| Command::new(name).arg("--version").output().is_ok_and(|o| o.status.success()))
        .expect("this test needs Chromium: install it (apt-get install chromium), or run cargo xtask test --all, which does")
}

/// What the page is after its scripts and ours have run.
fn dom(page: &Path) -> String {
    let profile = tempfile::tempdir().unwrap();
    let output = Command::new(chromium())
        .args([
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--disable-dev-shm-usage",
            "--dump-dom",
        ])
        .arg(format!("--user-data-dir={}", profile.path().display()))
        .arg(format!("file://{}", page.display()))
        .output()
        .unwrap();
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// No script fails, every method is a bubble in the chart, and a click on a heading sorts its table, by number, up and then
/// down.
#[test]
#[ignore = "long: cargo xtask test --all"]
fn the_page_works() {
    const CHECK: &str = "<script>
const found = [];
const table = document.querySelector('table.sortable');
const column = [...table.querySelectorAll('th')].findIndex(h => h.textContent.startsWith('ms'));
const values = () => [...table.tBodies[0].rows].map(r => r.cells[column].textContent).join(' ');
found.push('bubbles ' + document.querySelectorAll('circle.point title').length);
const box = document.querySelector('.chart svg').getBoundingClientRect();
found.push('drawn ' + (box.width > 300 && box.height > 100));
table.querySelectorAll('th')[column].click();
found.push('up ' + values());
table.querySelectorAll('th')[column].click();
found.push('down ' + values());
const name = [...table.querySelectorAll('th')][0];
name.click();
found.push('names ' + [...table.tBodies[0].rows].map(r => r.cells[0].textContent).join(' '));
document.body.dataset.found = found.join('; ');
</script>";
    let dir = tempfile::tempdir().unwrap();
    bench().write(dir.path()).unwrap();
    let page = std::fs::read_to_string(dir.path().join("report.html")).unwrap();
    let watched = page.replace(
        "<meta charset=\"utf-8\">",
        "<meta charset=\"utf-8\"><script>addEventListener('error', e => \
         document.documentElement.dataset.failed = e.message);</script>",
    );
    let path = dir.path().join("watched.html");
    std::fs::write(
        &path,
        watched.replace("</html>", &format!("{CHECK}</html>")),
    )
    .unwrap();
    let dom = dom(&path);
    assert!(
        !dom.contains("data-failed"),
        "a script failed: {}",
        &dom[..300.min(dom.len())]
    );
    let found = dom
        .split_once("data-found=\"")
        .and_then(|(_, rest)| rest.split_once('"'))
        .map(|(found, _)| found.to_owned())
        .unwrap_or_else(|| panic!("the check did not run: {}", &dom[..300.min(dom.len())]));
    // Four charts: all scenes in two means, and one a scene.
    assert_eq!(
        found,
        "bubbles 16; drawn true; up 9.00 10.00 20.00 90.00; down 90.00 20.00 10.00 9.00; \
         names abuffer mboit4 painter-object:sort=off wboit-eq9"
    );
}
