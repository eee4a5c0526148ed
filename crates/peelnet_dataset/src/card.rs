//! The card of a sealed dataset: `README.md`, with the front matter that the Hugging Face hub and its `datasets` read, `croissant.json`
//! (Croissant 1.1), for other programs, and a picture of each scene.
//!
//! All follow from plan and manifest, so that every writer has the same bytes. Text from outside (names, paths, the command line) is
//! escaped: in Markdown all punctuation of it, in JSON by the serializer. The front matter has none but names of files.

use peelnet_core::files::{counted, one_line, printable, printable_json, thousands};
use serde_json::{Value, json};

use crate::column::{Column, ColumnKind};
use crate::formats::Format;
use crate::hash::sha256;
use crate::manifest::{FileEntry, Manifest, Part, to_json};
use crate::picture;
use crate::plan::Plan;
use crate::store::FRAGMENTS;

/// A name and what is in it.
pub(crate) type File = (String, Vec<u8>);

const NAMES: [&str; 2] = ["README.md", "croissant.json"];

/// Whether a card may have a file of this name.
pub(crate) fn is_name(name: &str) -> bool {
    NAMES.contains(&name) || (0..picture::SCENES).any(|scene| picture::name(scene) == name)
}

const PROJECT: &str = env!("CARGO_PKG_REPOSITORY");

/// The names of Croissant 1.1 and of PROV.
const CONTEXT: &str = include_str!("card/context.json");

/// The files of a whole dataset's card, with the pictures that scenes have by their numbers.
pub(crate) fn files(plan: &Plan, manifest: &Manifest, pictures: Vec<(u32, Vec<u8>)>) -> Vec<File> {
    let drawn: Vec<u32> = pictures.iter().map(|(scene, _)| *scene).collect();
    let croissant = to_json(&croissant(plan, manifest));
    let texts = [
        readme(plan, manifest, &drawn),
        printable_json(&croissant).into_owned(),
    ];
    let texts = NAMES.map(str::to_owned).into_iter().zip(texts);
    let texts = texts.map(|(name, text)| (name, text.into_bytes()));
    let name = |(scene, png)| (picture::name(scene), png);
    texts.chain(pictures.into_iter().map(name)).collect()
}

/// What a manifest says of these files.
pub(crate) fn entries(files: &[File]) -> Vec<FileEntry> {
    let entry = |(name, bytes): &File| FileEntry {
        name: name.clone(),
        bytes: bytes.len() as u64,
        sha256: sha256(bytes),
    };
    files.iter().map(entry).collect()
}

const fn media_type(format: Format) -> &'static str {
    match format {
        Format::Parquet => "application/x-parquet",
        Format::Csv => "text/csv",
        Format::Npy => "application/octet-stream",
    }
}

/// Whether a file has all columns: `datasets` and other readers of tables take it as it is.
fn is_table(format: Format) -> bool {
    format != Format::Npy
}

/// What reads the parts, in Python.
fn reading(format: Format) -> String {
    let pattern = pattern(format);
    let others = if is_table(format) {
        format!(
            "datasets.load_dataset(\"DATASET\")\n\
             duckdb.sql(\"from read_{format}('DATASET/{pattern}')\")\n\
             polars.scan_{format}(\"DATASET/{pattern}\")\n"
        )
    } else {
        format!("numpy.load(path)    # of each of DATASET/{pattern}, one column of one part\n")
    };
    others + "peelnet.Dataset(\"DATASET\").read()\n"
}

/// The pattern of the parts' files.
fn pattern(format: Format) -> String {
    format!("{FRAGMENTS}*.{format}")
}

/// Text from outside for a line of Markdown: all punctuation is escaped, so none of it is markup.
fn plain(text: &str) -> String {
    let mut plain = String::new();
    for c in one_line(text).chars() {
        if c.is_ascii_punctuation() {
            plain.push('\\');
        }
        plain.push(c);
    }
    plain
}

/// A number with six digits.
pub fn rounded(value: f64) -> String {
    let digits = match value.abs() {
        0.0 => return "0".to_owned(),
        size if (1e-4..1e7).contains(&size) => 5 - size.log10().floor() as i32,
        _ => return format!("{value:.5e}"),
    };
    let text = format!("{value:.*}", digits.max(0) as usize);
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

fn dtype(column: Column) -> &'static str {
    match column.kind() {
        ColumnKind::F32 => "float32",
        ColumnKind::U32 => "uint32",
    }
}

fn readme(plan: &Plan, m: &Manifest, drawn: &[u32]) -> String {
    let front_matter = if is_table(m.format) {
        front_matter(m)
    } else {
        String::new()
    };
    let reading = reading(m.format);
    let version = plain(&m.tool_version);
    let mut text = format!(
        "---\n\
         # The licence is that of the scenes, which peelnet does not know: write it here, and in croissant.json.\n\
         license: unknown\n\
         pretty_name: Fragments of transparent surfaces\n\
         tags:\n\
         - order-independent-transparency\n\
         - peelnet\n\
         {front_matter}---\n\
         \n\
         # Fragments of transparent surfaces\n\
         \n\
         {} of {} in {}, written by [peelnet]({PROJECT}) {version}. A row is one fragment: a transparent surface at one pixel of one view.\n\
         Rows of one pixel are adjacent and go from the nearest fragment to the farthest; `transmittance` is what a network learns.\n\
         (`view`, `x`, `y`) is unique to a pixel, (`view`, `x`, `y`, `layer`) to a row.\n\
         \n\
         ```python\n\
         {reading}```\n\
         \n\
         ## Scenes\n\
         \n\
         | scene | picture | parts | rows | held out | effects | file |\n\
         |---|---|---:|---:|---|---|---|\n",
        counted(m.rows, "row"),
        counted(m.pixels, "pixel"),
        counted(m.parts.len() as u64, "part"),
    );
    let rows = m.rows_by_scene();
    for (k, scene) in m.scenes.iter().enumerate() {
        let parts = m
            .parts
            .iter()
            .filter(|part| part.scene as usize == k)
            .count();
        let shown = match drawn.contains(&(k as u32)) {
            true => format!("![]({})", picture::name(k as u32)),
            false => String::new(),
        };
        let row = [
            plain(&printable(&scene.name)),
            shown,
            thousands(parts as u64),
            thousands(rows.get(&*scene.name).copied().unwrap_or(0)),
            if scene.held_out { "yes" } else { "no" }.to_owned(),
            plain(&scene.effects.join(", ")),
            plain(&scene.file),
        ];
        text += &format!("| {} |\n", row.join(" | "));
    }
    text += "\nPictures are of the rows of a scene's first view: its transparent surfaces, before nothing.\n\
         A part is one view of one scene, or of a varied copy of it, and `view` is its number. Scenes that are held out must not be trained on.\n\
         `peelnet render FILE --view K --out picture.png` draws a scene; cameras are in `_peelnet/manifest.json`.\n\
         \n\
         ## Columns\n\
         \n\
         | column | type | unit | meaning |\n\
         |---|---|---|---|\n";
    text + &columns(m) + &made(plan, m)
}

/// The rows of the columns' table, and the section of statistics.
fn columns(m: &Manifest) -> String {
    let mut text = String::new();
    for column in Column::ALL {
        let (unit, meaning) = (column.unit(), column.meaning());
        text += &format!("| `{column}` | {} | {unit} | {meaning} |\n", dtype(column));
    }
    if !m.statistics.is_empty() {
        text += "\n## Statistics\n\
             \n\
             | column | minimum | maximum | mean | standard deviation |\n\
             |---|---:|---:|---:|---:|\n";
    }
    for s in &m.statistics {
        let numbers = [s.min, s.max, s.mean, s.deviation].map(rounded).join(" | ");
        text += &format!("| `{}` | {numbers} |\n", s.name);
    }
    if !m.statistics.is_empty() {
        text += "\nOf all rows, held-out scenes among them. `_peelnet/manifest.json` has all digits and histograms.\n";
    }
    text
}

/// The last sections.
fn made(plan: &Plan, m: &Manifest) -> String {
    let hash = &m.hash;
    let mut text = format!(
        "\n## How it was made\n\
         \n    {}\n\
         \n\
         | | |\n\
         |---|---|\n",
        one_line(&m.command)
    );
    let numbers = [m.seed.to_string(), m.pixels_fraction.to_string()];
    let copies = m.augment.to_string();
    let class = &plan.header.adapter_class;
    let made = [
        ("version", &m.tool_version),
        ("adapter", &m.adapter),
        ("adapter class", class),
        ("peeling", &m.peel),
        ("seed", &numbers[0]),
        ("fraction of the pixels", &numbers[1]),
        ("varied copies of each scene", &copies),
    ];
    let settings = m
        .settings
        .iter()
        .map(|(name, value)| (name.as_str(), value));
    for (name, value) in made.into_iter().chain(settings) {
        text += &format!(
            "| {} | {} |\n",
            plain(&printable(name)),
            plain(&printable(value))
        );
    }
    text + &format!(
        "\nPeeling left out {} and found {} at one depth. The hash of the rows is `{hash}`:\n\
         the same scenes, settings, version and adapter class give the same rows.\n\
         \n\
         ## How to cite\n\
         \n\
         {}",
        counted(m.lost_fragments, "fragment"),
        counted(m.coplanar_ties, "pair"),
        citation(m)
            .lines()
            .map(|line| format!("    {line}\n"))
            .collect::<String>()
    )
}

/// BibTeX.
fn citation(m: &Manifest) -> String {
    let (id, hash) = (&m.hash[..12], &m.hash);
    // Braces and backslashes have a meaning there.
    let is_number = |c: &char| c.is_ascii_alphanumeric() || matches!(c, '.' | '-' | '+');
    let version: String = m.tool_version.chars().filter(is_number).collect();
    format!(
        "@misc{{peelnet-{id},\n  title = {{Fragments of transparent surfaces}},\n  note = {{Extracted by peelnet {version}, hash {hash}}},\n  howpublished = {{\\url{{{PROJECT}}}}}\n}}"
    )
}

/// The front matter's description of files and columns, in YAML.
fn front_matter(m: &Manifest) -> String {
    let is_held_out = |part: &&Part| m.scenes[part.scene as usize].held_out;
    let (held_out, train): (Vec<&Part>, Vec<&Part>) = m.parts.iter().partition(is_held_out);
    let mut data_files = String::new();
    let mut splits = String::new();
    for (split, parts) in [("train", &train), ("held_out", &held_out)] {
        if parts.is_empty() {
            continue;
        }
        data_files += &format!("  - split: {split}\n    path:");
        if parts.len() == m.parts.len() {
            data_files += &format!(" {}\n", pattern(m.format));
        } else {
            // Names of parts have letters, digits, `-`, `_` and `.` only.
            let names = parts.iter().flat_map(|part| &part.files);
            let names: String = names.map(|file| format!("    - {}\n", file.name)).collect();
            data_files += &format!("\n{names}");
        }
        let rows = parts
            .iter()
            .fold(0u64, |sum, part| sum.saturating_add(part.rows));
        let bytes = rows.saturating_mul(4 * Column::ALL.len() as u64);
        splits += &format!("  - name: {split}\n    num_bytes: {bytes}\n    num_examples: {rows}\n");
    }
    let features = Column::ALL.map(|c| format!("  - name: {c}\n    dtype: {}\n", dtype(c)));
    let features = features.concat();
    let files = m.parts.iter().flat_map(|part| &part.files);
    let download = files.fold(0u64, |sum, file| sum.saturating_add(file.bytes));
    let size = m.rows.saturating_mul(4 * Column::ALL.len() as u64);
    format!(
        "configs:\n\
         - config_name: default\n  data_files:\n{data_files}\
         dataset_info:\n  features:\n{features}  splits:\n{splits}  download_size: {download}\n  dataset_size: {size}\n"
    )
}

fn croissant(plan: &Plan, m: &Manifest) -> Value {
    let media_type = media_type(m.format);
    let files = m.parts.iter().flat_map(|part| &part.files).map(|file| {
        json!({
            "@type": "cr:FileObject",
            "@id": file.name,
            "name": file.name,
            "contentUrl": file.name,
            "contentSize": format!("{} B", file.bytes),
            "encodingFormat": media_type,
            "sha256": file.sha256,
        })
    });
    let mut distribution: Vec<Value> = files.collect();
    distribution.push(json!({
        "@type": "cr:FileSet",
        "@id": "parts",
        "name": "parts",
        "encodingFormat": media_type,
        "includes": pattern(m.format),
    }));
    let fields = Column::ALL.map(|column| {
        json!({
            "@type": "cr:Field",
            "@id": format!("fragments/{column}"),
            "name": column.name(),
            "description": format!("{} Unit: {}.", column.meaning(), column.unit()),
            "dataType": match column.kind() {
                ColumnKind::F32 => "cr:Float32",
                ColumnKind::U32 => "cr:UInt32",
            },
            "source": {"fileSet": {"@id": "parts"}, "extract": {"column": column.name()}},
        })
    });
    let key = ["view", "x", "y", "layer"].map(|name| json!({"@id": format!("fragments/{name}")}));
    let records = json!([{
        "@type": "cr:RecordSet",
        "@id": "fragments",
        "name": "fragments",
        "description": "One record for each fragment.",
        "key": key,
        "field": fields,
    }]);
    let scenes = m.scenes.iter().map(|scene| {
        json!({
            "@type": "prov:Entity",
            "@id": format!("urn:sha256:{}", scene.sha256),
            "prov:label": scene.name,
            "prov:atLocation": scene.file,
        })
    });
    let mut croissant = json!({
        "@context": serde_json::from_str::<Value>(CONTEXT).expect("a test reads it"),
        "@type": "sc:Dataset",
        "conformsTo": "http://mlcommons.org/croissant/1.1",
        "name": format!("peelnet-fragments-{}", &m.hash[..12]),
        "description": format!(
            "{} of {}: every transparent surface of every pixel, from the nearest to the farthest.",
            counted(m.rows, "fragment"),
            counted(m.pixels, "pixel")
        ),
        // As in the README: what licence scenes have is not known here.
        "license": "unknown",
        "url": PROJECT,
        "creator": {"@type": "sc:Organization", "name": "peelnet", "url": PROJECT},
        "version": "1.0.0",
        "keywords": ["order-independent transparency", "fragments", "peelnet"],
        "citeAs": citation(m),
        "prov:wasGeneratedBy": {
            "@type": "prov:Activity",
            "prov:label": m.command,
            "description": format!(
                "peelnet {}, seed {}, {} peeling, adapter {} of class {}, plan {}",
                m.tool_version, m.seed, m.peel, m.adapter, plan.header.adapter_class, m.plan
            ),
        },
        "prov:wasAttributedTo": {
            "@type": "prov:SoftwareAgent",
            "prov:label": format!("peelnet {}", m.tool_version),
        },
        "prov:wasDerivedFrom": scenes.collect::<Value>(),
        "distribution": distribution,
    });
    if is_table(m.format) {
        croissant["recordSet"] = records;
    }
    croissant
}
