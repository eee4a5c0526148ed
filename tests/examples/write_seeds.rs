//! Writes the readers' seeds where cargo-fuzz looks for its corpus: `fuzz/corpus/<target>/seed-<n>`.

use peelnet_tests::readers::READERS;
use std::{fs, io, path::Path};

fn main() -> io::Result<()> {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz/corpus");
    for (name, _, seeds) in READERS {
        let folder = corpus.join(name);
        fs::create_dir_all(&folder)?;
        for (seed, k) in seeds().iter().zip(0..) {
            fs::write(folder.join(format!("seed-{k}")), seed)?;
        }
    }
    Ok(())
}
