use std::path::PathBuf;

/// What can go wrong when results are written or read.
#[allow(missing_docs, reason = "the message of each error names its fields")]
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// The file system refused.
    #[error("{}: cannot {action}: {source}", path.display())]
    Io {
        path: PathBuf,
        action: &'static str,
        source: std::io::Error,
    },
    /// A file is not the result that was expected.
    #[error("{}: not a result of this kind: {source}", path.display())]
    Format {
        path: PathBuf,
        source: serde_json::Error,
    },
    /// A picture of a page could not be read or shrunk.
    #[error("{}: cannot {action} the picture: {source}", path.display())]
    Picture {
        path: PathBuf,
        action: &'static str,
        source: image::ImageError,
    },
}
