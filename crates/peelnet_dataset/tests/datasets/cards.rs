//! The card of a sealed dataset, and the statistics in its manifest.

use super::*;

const CARD: [&str; 2] = ["README.md", "croissant.json"];
const MANIFEST: &str = "_peelnet/manifest.json";

fn read(folder: &Path, name: &str) -> String {
    fs::read_to_string(folder.join(name)).unwrap()
}

fn json(folder: &Path, name: &str) -> serde_json::Value {
    serde_json::from_str(&read(folder, name)).unwrap()
}

/// Against sums over all rows in 64 bits, about the mean: n roundings of 2⁻⁵³ each, of numbers up to the range.
#[test]
fn statistics_are_those_of_all_rows() {
    let folder = temporary();
    let manifest = write(folder.path(), Format::Csv).unwrap();
    let mut all = FragmentBatch::default();
    for index in 0..4 {
        let rows = rows_of(index);
        all.extend_from(&rows, 0..rows.len());
    }
    assert_eq!(manifest.statistics.len(), Column::ALL.len());
    for (column, s) in Column::ALL.into_iter().zip(&manifest.statistics) {
        let values: Vec<f64> = match all.column(column) {
            ColumnSlice::F32(v) => v.iter().map(|&x| x.into()).collect(),
            ColumnSlice::U32(v) => v.iter().map(|&x| x.into()).collect(),
        };
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n;
        let min = values.iter().copied().fold(f64::MAX, f64::min);
        let max = values.iter().copied().fold(f64::MIN, f64::max);
        assert_eq!((&*s.name, s.min, s.max), (column.name(), min, max));
        let tolerance = n * f64::EPSILON * (max - min).max(max.abs());
        assert!((s.mean - mean).abs() <= tolerance, "{column}: {s:?}");
        let error = (s.deviation - variance.sqrt()).abs();
        assert!(error <= tolerance, "{column}: {s:?}");
        assert!(min < max || (s.deviation == 0.0 && s.mean == min), "{s:?}");
        assert_eq!(s.edges.len(), s.counts.len() + 1);
        for (k, edges) in s.edges.windows(2).enumerate() {
            // The last bin of fractions has its upper edge as well.
            let is_last = edges[1] == 1.0 && column.name() != "alpha_sum" && max <= 1.0;
            let inside = |v: &&f64| **v >= edges[0] && (**v < edges[1] || is_last && **v == 1.0);
            let found = values.iter().filter(inside).count() as u64;
            assert_eq!(s.counts[k], found, "{column}, bin {edges:?}");
        }
        assert_eq!(
            s.counts.iter().sum::<u64>(),
            values.len() as u64,
            "{column}"
        );
    }
    // Neither cuts nor formats change them; rows of no part have none.
    for (format, batch_rows) in [(Format::Npy, 1), (Format::Parquet, 13)] {
        let folder = temporary();
        let other = write_by(folder.path(), header(format), batch_rows).unwrap();
        assert_eq!(other.statistics, manifest.statistics, "{format}");
    }
    let empty = write_one(temporary().path(), Format::Csv, &rows_of(3), 1);
    assert!(empty.statistics.is_empty() && empty.rows == 0);
}

/// Values at the edges of bins, below 0, and as large as they may be.
#[test]
fn every_value_has_a_bin() {
    let folder = temporary();
    let mut rows = FragmentBatch::default();
    let reds = [
        f32::MIN,
        -1.0,
        -0.0,
        0.0,
        1e-30,
        2f32.powi(-16),
        0.5,
        1.0,
        2.0,
        f32::MAX,
    ];
    let fragments = reds.map(|r| PeeledFragment {
        depth: 1.0,
        color: [r, 0.0, 0.0, 1.0],
    });
    rows.push_pixel([0, 0, 0], [0.1, 100.0], fragments.into_iter());
    let m = write_one(folder.path(), Format::Parquet, &rows, 3);
    let red = &m.statistics[Column::R as usize];
    assert_eq!((red.edges[0], red.edges[1]), (f32::MIN.into(), 0.0));
    assert_eq!(
        (red.edges[2], red.edges.last()),
        (2f64.powi(-16), Some(&2f64.powi(128)))
    );
    assert_eq!((red.counts[0], red.counts[1], red.counts[2]), (2, 3, 1));
    assert_eq!(red.counts.iter().sum::<u64>(), 10);
    let through = &m.statistics[0];
    assert_eq!(
        (&through.edges[..], &through.counts[..]),
        (&[0.0, 0.0625][..], &[10][..])
    );
    let transmittance = &m.statistics[Column::Transmittance as usize];
    assert_eq!(transmittance.edges.last(), Some(&1.0));
    assert_eq!(transmittance.counts.last(), Some(&1));
}

#[test]
fn a_card_says_what_the_manifest_says() {
    for format in Format::ALL {
        let folder = temporary();
        let folder = folder.path();
        let m = write(folder, format).unwrap();
        let names: Vec<&str> = m.card.iter().map(|file| &*file.name).collect();
        let pictures = ["picture-00000.png", "picture-00001.png"];
        assert_eq!(names, [&CARD[..], &pictures].concat());
        for file in &m.card {
            let bytes = fs::read(folder.join(&file.name)).unwrap();
            assert_eq!(file.bytes, bytes.len() as u64);
            assert_eq!(file.sha256, sha256(&bytes));
        }
        let text = read(folder, "README.md");
        assert!(text.starts_with("---\n"));
        let rows = m.rows_by_scene();
        let held_out = rows["smoke in a box"];
        let mut words = vec![
            "license: unknown\n".to_owned(),
            format!("| `{}` | float32 | scene units |", Column::LinearDepth),
            "| cups | ![](picture-00000.png) | 2 |".to_owned(),
            "| smoke in a box | ![](picture-00001.png) | 2 | ".to_owned()
                + &peelnet_core::files::thousands(held_out),
            "    peelnet extract\n".to_owned(),
            "| adapter class | software |".to_owned(),
            "| size | 640x480 |".to_owned(),
            m.hash.clone(),
        ];
        if format != Format::Npy {
            words.extend([
                format!("  - split: train\n    path:\n    - fragments-00000-cups-v0.{format}\n"),
                format!("  - name: held_out\n    num_bytes: {}\n", 56 * held_out),
                format!("    num_examples: {held_out}\n"),
                "  - name: view\n    dtype: uint32\n".to_owned(),
            ]);
        }
        for word in words {
            assert!(text.contains(&word), "{format}: {word:?} is not in\n{text}");
        }
        let croissant = json(folder, "croissant.json");
        let files = croissant["distribution"].as_array().unwrap();
        let listed = m.parts.iter().flat_map(|p| &p.files);
        for (stated, file) in files.iter().zip(listed.clone()) {
            assert_eq!(stated["contentUrl"], *file.name);
            assert_eq!(stated["sha256"], *file.sha256);
        }
        assert_eq!(files.len(), listed.count() + 1);
        assert_eq!(croissant["@context"]["prov"], "http://www.w3.org/ns/prov#");
        assert_eq!(
            croissant["prov:wasDerivedFrom"][1]["prov:label"],
            "smoke in a box"
        );
        assert_eq!(croissant["recordSet"].is_null(), format == Format::Npy);
    }
    // Without scenes that are held out, a pattern does.
    let folder = temporary();
    write_one(folder.path(), Format::Csv, &rows_of(0), 1000);
    let text = read(folder.path(), "README.md");
    assert!(text.contains("  - split: train\n    path: fragments-*.csv\n"));
    assert!(!text.contains("held_out"));
}

/// Four pixels of 640 by 480 are one of the picture: the mean of what is seen of them, un-premultiplied. A record with another picture is
/// sealed without one.
#[test]
fn a_picture_shows_the_first_view() {
    let folder = temporary();
    let folder = folder.path();
    let mut rows = FragmentBatch::default();
    let fragment = |r, g, alpha| PeeledFragment {
        depth: 1.0,
        color: [r, g, 0.0, alpha],
    };
    // Half red before opaque green, and beside it a quarter of red.
    let clip = [0.1, 100.0];
    let both = [fragment(1.0, 0.0, 0.5), fragment(0.0, 1.0, 1.0)];
    rows.push_pixel([0, 4, 0], clip, both.into_iter());
    rows.push_pixel([0, 9, 1], clip, [fragment(1.0, 0.0, 0.25)].into_iter());
    let m = write_one(folder, Format::Csv, &rows, 1);
    let file = fs::File::open(folder.join("picture-00000.png")).unwrap();
    let mut reader = png::Decoder::new(std::io::BufReader::new(file))
        .read_info()
        .unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    assert_eq!((info.width, info.height), (160, 120));
    let pixels: Vec<_> = bytes.as_chunks::<4>().0.iter().collect();
    // sRGB of ½ is 188; a sixteenth of 255 is 15.9.
    assert_eq!(pixels[1], &[188, 188, 0, 16]);
    assert_eq!(pixels[2], &[255, 0, 0, 4]);
    assert!(pixels[3..].iter().all(|pixel| pixel[3] == 0));
    assert!(m.parts[0].picture.is_none());
    let name = "_peelnet/parts/00000.json";
    let mut record = json(folder, name);
    record["part"]["picture"] = "PHNjcmlwdD4=".into();
    fs::write(folder.join(name), record.to_string()).unwrap();
    for name in [MANIFEST, "picture-00000.png"] {
        fs::remove_file(folder.join(name)).unwrap();
    }
    let card = seal(folder).unwrap().card;
    assert_eq!(card.len(), CARD.len());
    assert!(!folder.join("picture-00000.png").exists());
}

/// Names, paths, settings and the command line are data: neither Markdown, nor front matter, nor HTML.
#[test]
fn text_from_outside_is_escaped() {
    let hostile = "a\n---\nlicense: mit | <script>[x](http://x.org) `*_\u{202e}\\\"";
    let folder = temporary();
    let folder = folder.path();
    let mut header = header(Format::Csv);
    header.work_items = 1;
    let scene = &mut header.scenes[0];
    for text in [
        &mut scene.name,
        &mut scene.file,
        &mut scene.effects[0],
        &mut header.command,
        &mut header.adapter,
        &mut header.adapter_class,
        &mut header.peel,
        &mut header.tool_version,
    ] {
        hostile.clone_into(text);
    }
    header.settings = [(hostile.to_owned(), hostile.to_owned())].into();
    let writer = DatasetWriter::create(folder, header).unwrap();
    part(&writer, 0, &rows_of(0), 1000).unwrap();
    writer.finish().unwrap();
    let text = read(folder, "README.md");
    assert!(!text.contains('\u{202e}'));
    assert_eq!(text.lines().filter(|line| *line == "---").count(), 2);
    assert_eq!(
        text.lines()
            .filter(|line| line.starts_with("license:"))
            .count(),
        1
    );
    // Blocks of code are as they are; a table's row ends where it should.
    for line in text.lines().filter(|line| !line.starts_with("    ")) {
        let plain = line
            .replace("\\\\", "")
            .replace("\\<", "")
            .replace("\\[", "");
        assert!(
            !plain.contains("<script") && !plain.contains("[x"),
            "{line}"
        );
    }
    let row = text
        .lines()
        .find(|line| line.starts_with("| adapter class"));
    let unescaped = row.unwrap().replace("\\\\", "").replace("\\|", "");
    assert_eq!(unescaped.matches('|').count(), 3, "{unescaped}");
    let text = read(folder, "croissant.json");
    assert!(!text.contains('\u{202e}'));
    let croissant = json(folder, "croissant.json");
    assert_eq!(croissant["prov:wasDerivedFrom"][0]["prov:label"], hostile);
    assert_eq!(croissant["prov:wasGeneratedBy"]["prov:label"], hostile);
    Dataset::open(folder).unwrap();
}

/// A README of the user's stays, whoever seals; an edited one is the user's. Reading never looks at it.
#[test]
fn a_card_of_others_stays_and_is_reported() {
    let folder = temporary();
    let folder = folder.path();
    let readme = folder.join("README.md");
    let writer = DatasetWriter::create(folder, header(Format::Csv)).unwrap();
    for index in 0..4 {
        part(&writer, index, &rows_of(index), 1000).unwrap();
    }
    fs::write(&readme, "mine").unwrap();
    let manifest = writer.finish().unwrap();
    let is_foreign = |names: &[&str]| {
        let names: Vec<_> = names.iter().map(|name| folder.join(name)).collect();
        assert_eq!(foreign_card(folder).unwrap(), names);
        Dataset::open(folder).unwrap().verify().unwrap();
        assert_eq!(seal(folder).unwrap(), manifest);
    };
    is_foreign(&["README.md"]);
    assert_eq!(read(folder, "README.md"), "mine");
    // Another dataset would replace it.
    let error = write(folder, Format::Npy).unwrap_err();
    has(&error, &["README.md", "move that file away"]);
    assert_eq!(read(folder, "README.md"), "mine");
    // No file at all, damaged ones, a folder.
    fs::remove_file(&readme).unwrap();
    is_foreign(&[]);
    fs::write(folder.join("croissant.json"), [0xff; 100]).unwrap();
    fs::create_dir(&readme).unwrap();
    is_foreign(&CARD);
    fs::remove_dir(&readme).unwrap();
    fs::remove_file(folder.join("croissant.json")).unwrap();
    // As it was written, it goes with its dataset; gone, it is not missed.
    write(folder, Format::Npy).unwrap();
    is_npy_alone(folder);
    write(folder, Format::Csv).unwrap();
    assert!(CARD.iter().all(|name| folder.join(name).is_file()));
    // A manifest that lists another file does not make that one removable.
    fs::write(folder.join("notes.txt"), "mine").unwrap();
    let edited = read(folder, MANIFEST).replace("\"README.md\"", "\"notes.txt\"");
    fs::write(folder.join(MANIFEST), edited).unwrap();
    opening_fails(folder, &["notes.txt", "no file of a card"]);
}

fn is_npy_alone(folder: &Path) {
    let names = contents(folder).into_iter().map(|(name, _)| name);
    assert!(names.into_iter().all(|name| !name.ends_with(".csv")));
}

/// A writer that is killed between card and manifest: going on gives the same bytes, and a new dataset takes its place.
#[test]
fn a_card_without_a_seal_is_known() {
    for replaced in [false, true] {
        let folder = temporary();
        let folder = folder.path();
        write(folder, Format::Csv).unwrap();
        let whole = contents(folder);
        for gone in [&["README.md"][..], &["croissant.json"], &[]] {
            for name in gone.iter().chain(&[MANIFEST]) {
                fs::remove_file(folder.join(name)).unwrap();
            }
            match replaced {
                false => drop(seal(folder).unwrap()),
                true => drop(write(folder, Format::Csv).unwrap()),
            }
            assert!(contents(folder) == whole);
        }
    }
}

/// Datasets of earlier versions have neither card nor statistics.
#[test]
fn datasets_without_a_card_are_read_sealed_and_replaced() {
    let folder = temporary();
    let folder = folder.path();
    write(folder, Format::Csv).unwrap();
    for name in CARD {
        fs::remove_file(folder.join(name)).unwrap();
    }
    for k in 0..4 {
        let name = format!("_peelnet/parts/{k:05}.json");
        let mut record = json(folder, &name);
        record["part"].as_object_mut().unwrap().remove("statistics");
        fs::write(folder.join(name), record.to_string()).unwrap();
    }
    let mut manifest = json(folder, MANIFEST);
    for field in ["card", "statistics"] {
        manifest.as_object_mut().unwrap().remove(field).unwrap();
    }
    fs::write(folder.join(MANIFEST), manifest.to_string()).unwrap();
    Dataset::open(folder)
        .unwrap()
        .read_columns(&Column::ALL)
        .unwrap();
    assert!(seal(folder).unwrap().card.is_empty());
    assert!(foreign_card(folder).unwrap().is_empty());
    // Sealed by this version: with a card that says nothing of statistics.
    fs::remove_file(folder.join(MANIFEST)).unwrap();
    assert!(seal(folder).unwrap().statistics.is_empty());
    assert!(!read(folder, "README.md").contains("Statistics"));
    // And where records have impossible ones.
    for (from, to) in [
        ("\"min\": ", "\"min\": -1e308, \"x\": "),
        ("\"edges\": [", "\"edges\": [3.0, "),
    ] {
        let folder = temporary();
        let folder = folder.path();
        write(folder, Format::Csv).unwrap();
        let record = folder.join("_peelnet/parts/00001.json");
        let edited = fs::read_to_string(&record).unwrap().replace(from, to);
        fs::write(&record, edited).unwrap();
        fs::remove_file(folder.join(MANIFEST)).unwrap();
        for name in CARD {
            fs::remove_file(folder.join(name)).unwrap();
        }
        let sealed = seal(folder).unwrap();
        assert_eq!(sealed.statistics.is_empty(), to.contains("3.0"));
        Dataset::open(folder).unwrap();
    }
    write(folder, Format::Csv).unwrap();
}
