//! The bench's page in a real browser: headless Chromium, which `cargo xtask test --all` installs where it is missing.

use peelnet_bench::report::Results;
use peelnet_bench::{Machine, bench, bench::Bench, compare::Plan};
use peelnet_core::fragment::worked_example;
use peelnet_tests::{gpu, specs, walls};
use std::{path::Path, process::Command};

fn write_report(folder: &Path) {
    let gpu = gpu();
    let methods = specs(["painter-object:sort=off", "mboit4", "wboit-eq9"]);
    let scenes = ["first", "second"].map(|name| {
        let mut scene = walls(&worked_example(), [0.0; 3]);
        scene.name = name.to_owned();
        scene
    });
    let rows = bench(&gpu, &scenes, &Plan::new([8, 8], &methods)).unwrap();
    let bench = Bench {
        rows,
        ..Bench::default()
    };
    let results = Results::new(Machine::describe(&gpu), "peelnet bench", bench);
    results.write(folder).unwrap();
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
    let options = "--headless --no-sandbox --disable-gpu --disable-dev-shm-usage --dump-dom";
    let output = Command::new(chromium())
        .args(options.split(' '))
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
const values = () => [...table.tBodies[0].rows].map(r => Number(r.cells[column].textContent));
found.push('bubbles ' + document.querySelectorAll('circle.point title').length);
const box = document.querySelector('.chart svg').getBoundingClientRect();
found.push('drawn ' + (box.width > 300 && box.height > 100));
table.querySelectorAll('th')[column].click();
const up = values();
table.querySelectorAll('th')[column].click();
const down = values();
found.push('sorted ' + (up.length === 4 && up.every((x, i) => i === 0 || up[i - 1] <= x) && down.join() === up.reverse().join()));
const name = [...table.querySelectorAll('th')][0];
name.click();
found.push('names ' + [...table.tBodies[0].rows].map(r => r.cells[0].textContent).join(' '));
document.body.dataset.found = found.join('; ');
</script>";
    let dir = tempfile::tempdir().unwrap();
    write_report(dir.path());
    let page = std::fs::read_to_string(dir.path().join("report.html")).unwrap();
    let watched = page.replace(
        "<meta charset=\"utf-8\">",
        "<meta charset=\"utf-8\"><script>addEventListener('error', e => \
         document.documentElement.dataset.failed = e.message);</script>",
    );
    let path = dir.path().join("watched.html");
    let checked = watched.replace("</html>", &format!("{CHECK}</html>"));
    std::fs::write(&path, checked).unwrap();
    let dom = dom(&path);
    let begin = &dom[..300.min(dom.len())];
    assert!(!dom.contains("data-failed"), "a script failed: {begin}");
    let found = dom.split_once("data-found=\"");
    let (found, _) = found
        .and_then(|(_, rest)| rest.split_once('"'))
        .unwrap_or_else(|| panic!("the check did not run: {begin}"));
    // Four charts: all scenes in two means, and one a scene.
    assert_eq!(
        found,
        "bubbles 16; drawn true; sorted true; names abuffer mboit4 painter-object:sort=off wboit-eq9"
    );
}
