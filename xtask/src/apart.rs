//! Scenes with a surface apart from all others, and one table of what that does to methods.

use crate::root;
use std::fs;

/// Names of the kinds, how far the surface is from the eye, of the distance to what the first view looks at, and its opacity; none at 0.
pub const KINDS: [(&str, f64, f64); 4] = [
    ("none", 0.0, 0.0),
    ("near", 0.08, 0.15),
    ("quarter", 0.25, 0.15),
    ("backdrop", 3.0, 0.3),
];

/// Numbers of the first line `field = ...`, which is a view's: cameras come first in the scenes that ship.
fn numbers(text: &str, field: &str) -> Option<Vec<f64>> {
    let mut lines = text.lines();
    let value = lines.find_map(|line| line.strip_prefix(&format!("{field} = ")))?;
    let value = value.split('#').next()?.trim().trim_matches(['[', ']']);
    value.split(',').map(|n| n.trim().parse().ok()).collect()
}

/// The text of a scene with a square across the first view, so far away, that covers the frame.
fn with_square(text: &str, kind: &str, share: f64, alpha: f64) -> Option<String> {
    let (position, target) = (numbers(text, "position")?, numbers(text, "target")?);
    let ahead: Vec<f64> = (0..3).map(|k| target[k] - position[k]).collect();
    let length = ahead.iter().map(|x| x * x).sum::<f64>().sqrt();
    let at: Vec<f64> = (0..3).map(|k| position[k] + share * ahead[k]).collect();
    let yaw = (-ahead[0]).atan2(-ahead[2]).to_degrees();
    let pitch = (ahead[1] / length).asin().to_degrees();
    let distance = share * length;
    let fov_y = numbers(text, "fov_y").map_or(45.0, |n| n[0]);
    let height = 2.6 * distance * (fov_y.to_radians() / 2.0).tan();
    let square = format!(
        "\n[[object]]\nmesh = {{ shape = \"quad\", size = [{}, {height}] }}\ntranslate = {at:?}\nrotate = [{pitch}, {yaw}, 0.0]\n\
         material = {{ color = [0.55, 0.75, 0.9], alpha = {alpha} }}\n",
        1.5 * height
    );
    // The planes of all views let the square be seen.
    let line = |line: &str| {
        let plane = |name: &str| line.strip_prefix(name)?.trim().parse::<f64>().ok();
        if let Some(near) = plane("near = ") {
            format!("near = {}\n", near.min(distance / 2.0))
        } else if let Some(far) = plane("far = ") {
            format!("far = {:?}\n", far.max(3.0 * distance))
        } else if let Some(name) = line.strip_prefix("name = \"") {
            format!("name = \"{kind}-{name}\n")
        } else {
            format!("{line}\n")
        }
    };
    Some(text.lines().map(line).collect::<String>() + &square)
}

/// Writes scenes with a surface of this kind; their paths from the root.
pub fn scenes(kind: &str, files: Vec<String>) -> Result<Vec<String>, String> {
    let found = KINDS.iter().find(|(name, ..)| *name == kind);
    let &(_, share, alpha) = found.ok_or_else(|| format!("no surface apart is called {kind}"))?;
    if alpha == 0.0 {
        return Ok(files);
    }
    let folder = format!("out/measure/scenes-{kind}");
    let io = |e: std::io::Error| format!("{folder}: {e}");
    fs::create_dir_all(root().join(&folder)).map_err(io)?;
    let mut written = Vec::new();
    for file in files {
        let text = fs::read_to_string(root().join(&file)).map_err(io)?;
        let text = with_square(&text, kind, share, alpha);
        let text = text.ok_or_else(|| format!("{file}: its first view is not understood"))?;
        let to = format!("{folder}/{}", file.trim_start_matches("data/scenes/"));
        fs::write(root().join(&to), text).map_err(io)?;
        written.push(to);
    }
    Ok(written)
}

/// One table of the tables of all kinds: each method's mean error and that of its worst scene, over mboit4's.
pub fn table(tables: &[String]) -> Result<String, String> {
    let cells = |line: &str| -> Vec<String> {
        let cells = line.trim_matches('|').split(" | ");
        cells.map(|cell| cell.trim().to_owned()).collect()
    };
    let mut all: Vec<Vec<String>> = Vec::new();
    for (text, (kind, ..)) in tables.iter().zip(KINDS) {
        let lines: Vec<_> = text.lines().take_while(|l| l.starts_with('|')).collect();
        let head = cells(lines.first().ok_or("a table is empty")?);
        let column = |name: &str| head.iter().position(|cell| cell == name);
        let columns = [column("/ mboit4"), column("worst scene / mboit4")];
        let [Some(mean), Some(worst)] = columns else {
            return Err("a table has no errors over mboit4".into());
        };
        let rows = lines.iter().skip(2).map(|line| cells(line));
        let rows: Vec<_> = std::iter::once(head.clone()).chain(rows).collect();
        if all.is_empty() {
            all = rows.iter().map(|row| vec![row[0].clone()]).collect();
        }
        for (row, cells) in all.iter_mut().zip(rows) {
            let of_head = cells == head;
            let shown = |cell: usize, what: &str| match of_head {
                true => format!("{kind}: {what}"),
                false => cells[cell].clone(),
            };
            row.extend([shown(mean, "mean"), shown(worst, "worst scene")]);
        }
    }
    let line = |row: &Vec<String>| format!("| {} |\n", row.join(" | "));
    let rule = format!("|---{}|\n", "|---:".repeat(2 * KINDS.len()));
    let (head, rows) = all.split_first().ok_or("no table")?;
    Ok(line(head) + &rule + &rows.iter().map(line).collect::<String>())
}
