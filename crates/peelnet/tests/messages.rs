//! Messages make sense: units, numbers and names are what they are, and wrong usage has its own exit code.
#![allow(clippy::unwrap_used, reason = "a failing test may panic")]

mod common;

use common::{SCENE, ends_with};

/// Without what a driver says by itself.
fn own(text: &str) -> Vec<&str> {
    let ours = |line: &&str| line.starts_with("error: ") && !line.contains("XDG_RUNTIME_DIR");
    text.lines().filter(ours).collect()
}

#[test]
fn messages_make_sense() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("two.toml"), SCENE).unwrap();
    std::fs::write(dir.path().join("cut.png"), b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR").unwrap();
    let textured = SCENE.to_owned() + "color_map = \"cut.png\"\n";
    std::fs::write(dir.path().join("cut.toml"), textured).unwrap();
    std::fs::create_dir(dir.path().join("folder.png")).unwrap();
    for (line, code, said, not) in [
        (
            "render two.toml --out a.png --view 1",
            2,
            "has 1 view,",
            "1 views",
        ),
        (
            "render two.toml --out a.png --size 100000x100000",
            1,
            "needs 100000 pixels a side",
            "100000 bytes",
        ),
        (
            "render two.toml --out two.toml/a.png",
            1,
            "two.toml/a.png",
            ".peelnet",
        ),
        (
            "render two.toml --out folder.png",
            1,
            "is a directory",
            ".peelnet",
        ),
        (
            "render two.toml --out a.png --highlight 3",
            2,
            "--highlight 3",
            "::",
        ),
        (
            "render two.toml --out a.png --adapter nothing",
            2,
            "nothing",
            "::",
        ),
        ("render two.toml --out a.png --time 3", 2, "timeline", "::"),
        ("render cut.toml --out a.png", 1, "cut.png", "Chunk"),
        (
            "extract two.toml --out d --size 8x8 --views 5",
            2,
            "1 of the 5 views",
            "1 views",
        ),
        ("bench two.toml two.toml --out b", 2, "two", ";;"),
        ("stress --cases nothing", 2, "nothing", ";;"),
    ] {
        let text = ends_with(dir.path(), line, code);
        let errors = own(&text);
        assert_eq!(errors.len(), 1, "{line}: {text}");
        assert!(errors[0].contains(said), "{line}: {text}");
        assert!(!text.contains(not), "{line}: {text}");
        // No path is named twice.
        for path in ["two.toml/a.png", "folder.png", "cut.png"] {
            assert!(text.matches(path).count() <= 1, "{line}: {text}");
        }
    }
    let extracted = ends_with(dir.path(), "extract two.toml --out d --size 8x8", 0);
    assert!(!extracted.contains("1 parts"), "{extracted}");
}
