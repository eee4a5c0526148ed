//! Object stores: `s3://`, `gs://` and `az://`, by the crate `object_store`.
//!
//! Settings come from the environment, under the names that the services' own tools read: `AWS_…`, `GOOGLE_…`, `AZURE_…`. Every object is
//! created by one conditional request. No error has a text of the server in it but its error code, because such texts quote credentials.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use object_store::aws::AmazonS3Builder;
use object_store::azure::MicrosoftAzureBuilder;
use object_store::gcp::GoogleCloudStorageBuilder;
use object_store::path::Path as Key;
use object_store::{
    ObjectStore, ObjectStoreExt as _, PutMode, PutOptions, PutPayload, RetryConfig,
};
use tokio::runtime::Runtime;

use peelnet_core::files::error_line;

use super::{Fetched, Store};
use crate::error::DatasetError;

/// Bytes of one object that one request may create.
const MAX_OBJECT: u64 = 5 << 30;

/// How often a request is tried whose connection was cut. Answers that ask for patience are retried by `object_store` itself.
const TRIES: u32 = 5;

/// A prefix of a bucket.
#[derive(Debug)]
pub(crate) struct Remote {
    /// The address, for messages.
    path: PathBuf,
    prefix: Key,
    store: Box<dyn ObjectStore>,
    runtime: Runtime,
}

impl Remote {
    /// The store at an address. Nothing is asked of the server yet.
    pub(crate) fn open(url: &str) -> Result<Arc<dyn Store>, DatasetError> {
        let (scheme, rest) = url.split_once("://").unwrap_or_default();
        let (bucket, prefix) = rest.split_once('/').unwrap_or((rest, ""));
        // Without what could be a password.
        let shown = PathBuf::from(format!("{scheme}://…"));
        let refused = |reason: &str| DatasetError::invalid(&shown, reason);
        if bucket.is_empty() {
            return Err(refused(
                "the address has no bucket; write scheme://bucket/prefix",
            ));
        }
        if rest.contains(['@', '?', '#']) {
            return Err(refused(
                "an address is scheme://bucket/prefix, without credentials and options; set these in the environment",
            ));
        }
        let prefix = Key::parse(prefix.trim_end_matches('/'))
            .map_err(|_| refused("the prefix is not one of an object store"))?;
        let retry = RetryConfig {
            max_retries: 8,
            retry_timeout: Duration::from_mins(2),
            ..RetryConfig::default()
        };
        let address = format!("{scheme}://{bucket}");
        macro_rules! built {
            ($builder:ident) => {{
                let builder = $builder::from_env().with_url(address).with_retry(retry);
                builder.build().map(|s| Box::new(s) as Box<dyn ObjectStore>)
            }};
        }
        let built = match scheme {
            "s3" => built!(AmazonS3Builder),
            "gs" => built!(GoogleCloudStorageBuilder),
            "az" => built!(MicrosoftAzureBuilder),
            _ => return Err(refused("expected s3://, gs://, az:// or file://")),
        };
        let path = PathBuf::from(url.trim_end_matches('/'));
        let store = built.map_err(|e| fault(&path, "reach", &e))?;
        let runtime = tokio::runtime::Builder::new_multi_thread()
            .worker_threads(1)
            .enable_all()
            .build()
            .map_err(DatasetError::io(&path, "start the network of"))?;
        Ok(Arc::new(Self {
            path,
            prefix,
            store,
            runtime,
        }))
    }

    fn key(&self, name: &str) -> Key {
        let parts = name.split('/').filter(|part| !part.is_empty());
        parts.fold(self.prefix.clone(), |key, part| key.join(part))
    }

    /// Does a request, again where its connection was cut.
    fn retried<T>(
        &self,
        request: impl AsyncFn() -> object_store::Result<T>,
    ) -> Result<T, object_store::Error> {
        let mut tried = 1;
        loop {
            match self.runtime.block_on(request()) {
                Err(e) if tried < TRIES && is_cut(&e) => {
                    std::thread::sleep(Duration::from_millis(100 << tried));
                    tried += 1;
                }
                other => return other,
            }
        }
    }

    fn put(&self, name: &str, bytes: Vec<u8>) -> Result<bool, DatasetError> {
        let key = self.key(name);
        let payload = PutPayload::from(bytes);
        let create = async || {
            let options = PutOptions::from(PutMode::Create);
            self.store.put_opts(&key, payload.clone(), options).await
        };
        match self.retried(create) {
            Ok(_) => Ok(true),
            // The object may be ours, of an earlier try whose answer was lost: callers compare the bytes that are there.
            Err(
                object_store::Error::AlreadyExists { .. }
                | object_store::Error::Precondition { .. },
            ) => Ok(false),
            Err(e) => Err(fault(&self.shown(name), "write", &e)),
        }
    }
}

impl Store for Remote {
    fn path(&self) -> &Path {
        &self.path
    }

    fn list(&self, prefix: &str) -> Result<BTreeMap<String, u64>, DatasetError> {
        let key = self.key(prefix);
        let list = async || self.store.list_with_delimiter(Some(&key)).await;
        let found = self
            .retried(list)
            .map_err(|e| fault(&self.shown(prefix), "list", &e))?;
        let objects = found.objects.iter();
        Ok(objects
            .filter_map(|o| Some((o.location.filename()?.to_owned(), o.size)))
            .collect())
    }

    fn get(&self, name: &str, most: u64) -> Result<Option<Vec<u8>>, DatasetError> {
        let key = self.key(name);
        let shown = self.shown(name);
        let get = async || {
            let found = self.store.get(&key).await?;
            match peelnet_core::files::check_size(found.meta.size, most) {
                Ok(()) => found.bytes().await.map(Ok),
                Err(larger) => Ok(Err(larger)),
            }
        };
        match self.retried(get) {
            Ok(Ok(bytes)) => Ok(Some(bytes.into())),
            Ok(Err(larger)) => Err(DatasetError::io(&shown, "read")(larger)),
            Err(e @ object_store::Error::NotFound { .. }) if !lacks_bucket(&e) => Ok(None),
            Err(e) => Err(fault(&shown, "read", &e)),
        }
    }

    fn put_if_absent(&self, name: &str, bytes: &[u8]) -> Result<bool, DatasetError> {
        self.put(name, bytes.to_vec())
    }

    fn put_file_if_absent(&self, name: &str, file: &Path) -> Result<bool, DatasetError> {
        let io = |e| DatasetError::io(&self.shown(name), "send")(e);
        let length = fs::metadata(file).map_err(io)?.len();
        peelnet_core::files::check_size(length, MAX_OBJECT).map_err(io)?;
        self.put(name, fs::read(file).map_err(io)?)
    }

    fn fetch(&self, name: &str) -> Result<Fetched, DatasetError> {
        let Some(bytes) = self.get(name, MAX_OBJECT)? else {
            return Err(DatasetError::io(&self.shown(name), "read")(
                std::io::ErrorKind::NotFound.into(),
            ));
        };
        let write = || -> std::io::Result<Fetched> {
            let file = tempfile::Builder::new().prefix("peelnet-").tempfile()?;
            fs::write(file.path(), &bytes)?;
            let copy = file.into_temp_path();
            let unfinished = peelnet_core::files::Unfinished::new(&copy);
            Ok(Fetched {
                path: copy.to_path_buf(),
                shown: self.shown(name),
                _copy: Some((copy, unfinished)),
            })
        };
        write().map_err(DatasetError::io(&self.shown(name), "keep a copy of"))
    }

    fn remove(&self, name: &str) -> Result<(), DatasetError> {
        let key = self.key(name);
        match self.retried(async || self.store.delete(&key).await) {
            Ok(()) | Err(object_store::Error::NotFound { .. }) => Ok(()),
            Err(e) => Err(fault(&self.shown(name), "remove", &e)),
        }
    }
}

/// The server's code of an error, whose text is never printed: letters, such as `NoSuchBucket`.
fn code(text: &str) -> Option<&str> {
    let xml = text
        .split_once("<Code>")
        .and_then(|(_, rest)| rest.split_once("</Code>"))
        .map(|(code, _)| code);
    xml.filter(|c| c.len() < 64 && c.bytes().all(|b| b.is_ascii_alphanumeric()))
}

fn status(text: &str) -> Option<&str> {
    let (_, rest) = text.split_once("status code: ")?;
    rest.get(..3)
        .filter(|s| s.bytes().all(|b| b.is_ascii_digit()))
}

fn lacks_bucket(error: &object_store::Error) -> bool {
    let text = error_line(error);
    matches!(code(&text), Some("NoSuchBucket" | "ContainerNotFound"))
}

/// Whether no answer came, so that nobody knows what the server did.
fn is_cut(error: &object_store::Error) -> bool {
    let object_store::Error::Generic { .. } = error else {
        return false;
    };
    let text = error_line(error);
    status(&text).is_none() && text.contains("HTTP error")
}

fn fault(path: &Path, action: &'static str, error: &object_store::Error) -> DatasetError {
    let text = error_line(error);
    let code = code(&text);
    let status = status(&text);
    let cut = format!(
        "the server does not answer, or its connection was cut {TRIES} times; check the address and the network, and resume"
    );
    let why = match (code, error) {
        (Some("NoSuchBucket" | "ContainerNotFound"), _) => {
            "the bucket does not exist; create it, or correct the address"
        }
        (Some("QuotaExceeded" | "XMinioStorageFull" | "InsufficientCapacity"), _) => {
            "the bucket is full; make room, and resume"
        }
        (Some("RequestTimeTooSkewed" | "RequestExpired"), _) => {
            "the clock of this machine is off by minutes; set it"
        }
        (
            Some("InvalidAccessKeyId" | "SignatureDoesNotMatch" | "InvalidToken" | "ExpiredToken"),
            _,
        )
        | (_, object_store::Error::Unauthenticated { .. }) => {
            "the server refused the credentials; set those of an account that may use the bucket in the environment"
        }
        (_, object_store::Error::PermissionDenied { .. }) => {
            "the account may not do this; give it the right to read, list and write this prefix"
        }
        (_, object_store::Error::NotFound { .. }) => "there is no such object or bucket",
        (Some("SlowDown" | "ServerBusy" | "RequestLimitExceeded"), _) => {
            "the server asked for fewer requests again and again; start fewer workers, and resume"
        }
        _ if is_cut(error) => &cut,
        _ if status.is_none() => {
            "the settings in the environment are incomplete, or no credentials were found there"
        }
        _ => "the server refused the request",
    };
    let details: Vec<&str> = [status, code].into_iter().flatten().collect();
    let details = match details.join(" ") {
        none if none.is_empty() => none,
        details => format!(" ({details})"),
    };
    DatasetError::io(path, action)(std::io::Error::other(format!("{why}{details}")))
}
