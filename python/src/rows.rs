//! Fragments as rows: in memory as Arrow, or a dataset's folder.

use crate::{
    argument::FromFile,
    failure::{raised, warn, wrong},
    gpu,
    render::sized,
    scene::loaded,
    watch::{Bar, Reporter, watch},
};
use arrow_array::{
    ArrayRef, ArrowPrimitiveType, Float32Array, RecordBatch, RecordBatchIterator, UInt32Array,
    cast::AsArray as _,
    ffi_stream::FFI_ArrowArrayStream,
    types::{Float32Type, UInt32Type},
};
use numpy::{Element, IntoPyArray as _};
use peelnet::{
    Failure, Gpu,
    dataset::{self, Column, ColumnKind, ColumnValues, FragmentBatch},
    peel::{self, ExtractOptions, ExtractReport, PeelError, Progress, items},
};
use peelnet_core::files::{counted, shown, thousands};
use pyo3::{
    prelude::*,
    types::{PyCapsule, PyDict},
};
use std::{
    path::{Path, PathBuf},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::Instant,
};

/// Rows of fragments in memory: whole pixels from the nearest fragment to the farthest.
///
/// Anything that reads Arrow streams takes it without a copy: `pyarrow.table(rows)`, `polars.DataFrame(rows)`,
/// `duckdb.sql("from rows")` of such a table. Columns, types (f32 is float32, u32 uint32) and units:
///
#[doc = dataset::column_docs!()]
#[pyclass(frozen, module = "peelnet")]
pub struct Rows {
    batches: Vec<RecordBatch>,
}

/// A batch whose columns become Arrow's without a copy.
fn record_batch(batch: FragmentBatch) -> Result<RecordBatch, Failure> {
    let columns = Column::ALL.into_iter().zip(batch.into_columns());
    let columns = columns.map(|(column, values)| {
        let array: ArrayRef = match values {
            ColumnValues::F32(values) => Arc::new(Float32Array::new(values.into(), None)),
            ColumnValues::U32(values) => Arc::new(UInt32Array::new(values.into(), None)),
        };
        (column.name(), array, false)
    });
    Ok(RecordBatch::try_from_iter_with_nullable(columns)?)
}

impl Rows {
    /// One array of a column: the batches' memory, one after the other.
    fn column<'py, T>(&self, py: Python<'py>, name: &str) -> Bound<'py, PyAny>
    where
        T: ArrowPrimitiveType<Native: Element>,
    {
        let values = py.detach(|| {
            let mut all = Vec::with_capacity(self.__len__());
            for batch in &self.batches {
                all.extend_from_slice(batch[name].as_primitive::<T>().values());
            }
            all
        });
        values.into_pyarray(py).into_any()
    }
}

#[pymethods]
impl Rows {
    fn __len__(&self) -> usize {
        self.batches.iter().map(RecordBatch::num_rows).sum()
    }

    /// Names of the columns, in order.
    #[getter]
    fn columns(&self) -> Vec<&'static str> {
        Column::ALL.map(Column::name).to_vec()
    }

    /// The rows as a stream of the Arrow C data interface, without a copy; may be called again.
    #[pyo3(signature = (requested_schema=None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        // The protocol lets a producer that cannot cast ignore it.
        let _ = requested_schema;
        let schema = record_batch(FragmentBatch::default())
            .map_err(raised)?
            .schema();
        let batches = self.batches.clone().into_iter().map(Ok);
        let reader = RecordBatchIterator::new(batches, schema);
        let stream = FFI_ArrowArrayStream::new(Box::new(reader));
        PyCapsule::new_with_value(py, stream, c"arrow_array_stream")
    }

    /// Columns as numpy arrays of shape (rows,), float32 or uint32.
    ///
    /// Args:
    ///     columns: Names of columns; all by default.
    #[pyo3(signature = (columns=None))]
    fn to_numpy<'py>(
        &self,
        py: Python<'py>,
        columns: Option<Vec<String>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let chosen: Vec<Column> = match columns {
            None => Column::ALL.to_vec(),
            Some(names) => names
                .iter()
                .map(|name| {
                    Column::from_name(name).ok_or_else(|| {
                        let all = Column::ALL.map(Column::name).join(", ");
                        wrong(format!("no column '{name}'; there are {all}"))
                    })
                })
                .collect::<PyResult<_>>()?,
        };
        let arrays = PyDict::new(py);
        for column in chosen {
            let name = column.name();
            let array = match column.kind() {
                ColumnKind::F32 => self.column::<Float32Type>(py, name),
                ColumnKind::U32 => self.column::<UInt32Type>(py, name),
            };
            arrays.set_item(name, array)?;
        }
        Ok(arrays)
    }

    fn __repr__(&self) -> String {
        format!(
            "Rows({} rows, {} columns)",
            thousands(self.__len__() as u64),
            Column::ALL.len()
        )
    }
}

/// A dataset's folder: a whole one, or one that holds all shards of a run.
#[pyclass(frozen, module = "peelnet")]
#[derive(Clone)]
pub struct Dataset {
    pub dataset: dataset::Dataset,
}

#[pymethods]
impl Dataset {
    #[new]
    fn new(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        Self::from_file(py, path)
    }

    /// The folder.
    #[getter]
    fn path(&self) -> &Path {
        self.dataset.path()
    }

    /// Hash over all parts: the same for the same rows in the same format, however they were sharded.
    #[getter]
    fn hash(&self) -> &str {
        &self.dataset.manifest().hash
    }

    /// Number of pixels that hold at least one row.
    #[getter]
    fn pixels(&self) -> u64 {
        self.dataset.manifest().pixels
    }

    /// The manifest, as its JSON says it. Its "statistics" are those of all rows, by column: name, min, max, mean, deviation (in the
    /// column's unit), and a histogram: edges and counts.
    #[getter]
    fn manifest<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        crate::json::to_python(py, self.dataset.manifest())
    }

    fn __len__(&self) -> usize {
        self.dataset.rows() as usize
    }

    /// Compares the SHA-256 of every file with the manifest's.
    fn verify(&self, py: Python<'_>) -> PyResult<()> {
        py.detach(|| self.dataset.verify()).map_err(raised)
    }

    /// All rows in memory, whatever the format of the files.
    fn read(&self, py: Python<'_>) -> PyResult<Rows> {
        watch(
            py,
            |stop, _: &Reporter<()>| {
                let batches = self.dataset.batches(BATCH_ROWS);
                let batches = batches.take_while(|_| !stop.load(Ordering::Relaxed));
                let batches = batches.map(|batch| record_batch(batch?));
                let batches = batches.collect::<Result<_, Failure>>()?;
                Ok::<_, Failure>(Rows { batches })
            },
            |_, ()| Ok(()),
        )
    }

    fn __repr__(&self) -> String {
        let rows = thousands(self.dataset.rows());
        format!(
            "Dataset({}: {rows} rows)",
            peelnet_core::files::shown(self.dataset.path())
        )
    }
}

/// Rows of a batch that is read from a folder.
const BATCH_ROWS: usize = 1 << 18;

fn in_memory(
    gpu: &Gpu,
    scenes: &[peelnet::Scene],
    options: &ExtractOptions,
    stop: &AtomicBool,
    reporter: &Reporter<Progress>,
) -> Result<Rows, Failure> {
    let start = Instant::now();
    let mine = items::shard_items(scenes, options)?;
    let (mut batches, mut rows) = (Vec::new(), 0);
    let say = |done: usize, rows: u64| {
        reporter.send(Progress {
            items_done: done as u32,
            items: mine.len() as u32,
            rows,
            seconds: start.elapsed().as_secs_f64(),
        });
    };
    for batch in peel::batches(gpu, scenes, options)? {
        if stop.load(Ordering::Relaxed) {
            return Err(PeelError::Interrupted.into());
        }
        let batch = batch?;
        rows += batch.len() as u64;
        let view = batch.view.first().copied().unwrap_or(0);
        say(mine.partition_point(|item| item.index < view), rows);
        batches.push(record_batch(batch)?);
    }
    say(mine.len(), rows);
    Ok(Rows { batches })
}

enum Done {
    Rows(Rows),
    Folder(Box<ExtractReport>),
}

/// Peels scenes: every transparent fragment of every pixel becomes a row.
///
/// Args:
///     scenes: A scene or a list of scenes (Scene, path, or name of a shipped scene).
///     out: Folder of the dataset. Without it the rows stay in memory (4 bytes a row and column).
///     size: (width, height), pixels.
///     views: The first N views of each scene; all by default.
///     pixels: Fraction of the pixels to keep, above 0 and at most 1.
///     augment: Varied copies of each scene, in addition to the scene itself.
///     seed: Seed of sampling and variation.
///     peel: "sbuffer", "dual" or "single".
///     max_passes: Stop peeling after N passes.
///     format: "parquet", "csv" or "npy", of the folder's files.
///     shard: "I/N": only every Nth view, beginning with the Ith. All shards write into the same folder, in any order or at once.
///     resume: Do only what is missing of the same extraction in `out`.
///     adapter: "auto", "software", or a part of an adapter's name.
///     progress: A progress bar of the tqdm protocol, or True for tqdm's own; it counts views.
///
/// Returns:
///     Rows without `out`, otherwise the Dataset in it; None of a shard while views of others are missing. After Ctrl-C finished
///     views stay, and `resume` goes on.
#[pyfunction]
#[pyo3(name = "extract", signature = (scenes, *, out=None, size=(1024, 768), views=None, pixels=1.0, augment=0, seed=1, peel="sbuffer", max_passes=None, format="parquet", shard=None, resume=false, adapter="auto", progress=None))]
#[allow(clippy::too_many_arguments, reason = "keyword arguments of Python")]
pub fn extract_rows<'py>(
    py: Python<'py>,
    scenes: &Bound<'py, PyAny>,
    out: Option<PathBuf>,
    size: (u32, u32),
    views: Option<u32>,
    pixels: f64,
    augment: u32,
    seed: u64,
    peel: &str,
    max_passes: Option<u32>,
    format: &str,
    shard: Option<&str>,
    resume: bool,
    adapter: &str,
    progress: Option<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let shard = shard.map(str::parse::<dataset::Shard>).transpose();
    if views == Some(0) {
        return Err(wrong("'0' is not a number of views; write 1, 2, … or None"));
    }
    if max_passes == Some(0) {
        return Err(wrong("max_passes must be at least 1"));
    }
    let options = ExtractOptions {
        size: sized(size)?,
        views,
        format: format
            .parse()
            .map_err(|e: dataset::DatasetError| wrong(e.to_string()))?,
        peel: peel.parse().map_err(|e: String| wrong(e))?,
        max_passes,
        pixels,
        augment,
        seed,
        shard: shard.map_err(|e| wrong(e.to_string()))?,
        resume,
        command: "peelnet.extract of the Python package".to_owned(),
        ..ExtractOptions::new(out.clone().unwrap_or_default())
    };
    let scenes = loaded(scenes)?;
    let gpu = gpu::open(py, adapter)?;
    let mut bar = Bar::new(progress)?;
    let result = watch(
        py,
        |stop, reporter| {
            if out.is_none() {
                return in_memory(&gpu, &scenes, &options, stop, reporter).map(Done::Rows);
            }
            let mut say = |p: &Progress| reporter.send(*p);
            let report = peel::extract(&gpu, &scenes, &options, stop, &mut say)?;
            Ok(Done::Folder(Box::new(report)))
        },
        |_, progress| {
            let (done, total) = (progress.items_done, progress.items);
            bar.set(done.into(), total.into(), &progress.text())
        },
    );
    match bar.close(result)? {
        Done::Rows(rows) => Ok(Bound::new(py, rows)?.into_any()),
        Done::Folder(report) => {
            if report.lost > 0 {
                let lost = counted(report.lost, "fragment");
                let text = format!(
                    "left out by {peel} peeling: {lost}; sbuffer peeling without max_passes keeps all"
                );
                warn(py, &text)?;
            }
            if !report.manifest.is_whole() {
                return Ok(py.None().into_bound(py));
            }
            warn_of_foreign_card(py, &options.out)?;
            let dataset = Dataset::from_file(py, options.out)?;
            Ok(Bound::new(py, dataset)?.into_any())
        }
    }
}

/// Seals a dataset of which several writers finished all parts: checks the parts and writes the manifest. A sealed one stays as it is.
///
/// Args:
///     path: The dataset's folder.
///
/// Returns:
///     The Dataset.
#[pyfunction]
pub fn seal(py: Python<'_>, path: PathBuf) -> PyResult<Dataset> {
    py.detach(|| dataset::seal(&path)).map_err(raised)?;
    warn_of_foreign_card(py, &path)?;
    Dataset::from_file(py, path)
}

/// Warns as the command line does.
fn warn_of_foreign_card(py: Python<'_>, path: &Path) -> PyResult<()> {
    let foreign = py.detach(|| dataset::foreign_card(path));
    for file in foreign.map_err(raised)? {
        warn(py, &format!("{} {}", shown(&file), dataset::FOREIGN_CARD))?;
    }
    Ok(())
}

impl FromFile for Dataset {
    const IS: &str = "data is a Dataset or a dataset's folder: extract(…, out=folder) makes one";

    fn from_file(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let dataset = py.detach(|| dataset::Dataset::open(path));
        dataset.map(|dataset| Self { dataset }).map_err(raised)
    }
}
