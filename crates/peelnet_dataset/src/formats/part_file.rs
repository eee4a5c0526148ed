//! What every format does: a sink and a source of one part's rows.

use std::path::Path;

use crate::column::{Column, FragmentBatch};
use crate::error::DatasetError;

/// Writes one part's rows. What has been given must not depend on the cuts between calls.
pub(crate) trait PartSink: Send {
    /// Appends rows, which are valid and of equal length.
    fn write(&mut self, rows: &FragmentBatch) -> Result<(), DatasetError>;

    /// Ends the files, which have so many rows.
    fn finish(self: Box<Self>, rows: u64) -> Result<(), DatasetError>;
}

/// Reads one part's rows.
pub(crate) trait PartSource: Send {
    /// Appends up to `max` rows to the chosen columns of `rows` and says how many; 0 at the end.
    fn read(&mut self, max: usize, rows: &mut FragmentBatch) -> Result<usize, DatasetError>;
}

/// Compares a file's column names with the schema's.
pub(super) fn check_names(path: &Path, place: &str, found: &[String]) -> Result<(), DatasetError> {
    let expected = Column::ALL.map(Column::name);
    let missing = expected.iter().find(|c| !found.iter().any(|n| n == *c));
    let wanted = |k: usize| expected.get(k).copied().unwrap_or("no column");
    let problem = if let Some(missing) = missing {
        format!("column {missing} is missing")
    } else if let Some(k) = (0..found.len()).find(|&k| found[k] != wanted(k)) {
        let (number, name, wanted) = (k + 1, &found[k], wanted(k));
        format!("column {number} is {name:?} where {wanted} is expected")
    } else {
        return Ok(());
    };
    let expected = expected.join(", ");
    let reason = format!("{place}: {problem}; the columns must be {expected}, in this order");
    Err(DatasetError::invalid(path, reason))
}
