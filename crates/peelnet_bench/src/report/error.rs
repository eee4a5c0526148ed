use std::path::{Path, PathBuf};

#[derive(Debug, thiserror::Error)]
#[error("{}: {what}: {source}", path.display())]
pub struct ReportError {
    path: PathBuf,
    what: &'static str,
    source: Box<dyn std::error::Error + Send + Sync>,
}

impl ReportError {
    pub(crate) fn at<E>(path: &Path, what: &'static str) -> impl FnOnce(E) -> Self
    where
        E: std::error::Error + Send + Sync + 'static,
    {
        move |source| Self {
            path: path.to_owned(),
            what,
            source: source.into(),
        }
    }
}
