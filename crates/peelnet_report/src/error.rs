use std::path::PathBuf;

/// What can go wrong when results are written or read.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// The file system refused.
    #[error("{}: cannot {action}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What was tried: `read` or `write`.
        action: &'static str,
        /// The system's reason.
        source: std::io::Error,
    },
    /// A file is not the result that was expected.
    #[error("{}: not a result of this kind: {source}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// What does not fit.
        source: serde_json::Error,
    },
    /// A picture of a page could not be read or shrunk.
    #[error("{}: cannot {action} the picture: {source}", path.display())]
    Picture {
        /// The file.
        path: PathBuf,
        /// What was tried: `read` or `shrink`.
        action: &'static str,
        /// The decoder's reason.
        source: image::ImageError,
    },
}
