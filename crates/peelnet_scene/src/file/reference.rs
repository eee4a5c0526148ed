//! Values of a scene file that are a path or a table.

use crate::pattern::Pattern;
use serde::{Deserialize, Deserializer, de::Error as _};
use std::path::PathBuf;
use toml::Value;

/// A path relative to the scene file, or a table that describes something generated.
#[derive(Clone, Debug)]
pub(crate) enum Reference<T> {
    File(PathBuf),
    Made(Box<T>),
}

/// A texture: a path, or a table with `pattern = …`.
pub(crate) type MapRef = Reference<Pattern>;

/// What a table describes: the name of that, and the key that its table needs.
pub(crate) trait Described {
    const NAMES: [&str; 2];
}

impl Described for Pattern {
    const NAMES: [&str; 2] = ["map", "pattern"];
}

impl<'de, T: Described + Deserialize<'de>> Deserialize<'de> for Reference<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let [what, key] = T::NAMES;
        match Value::deserialize(deserializer)? {
            Value::String(path) => Ok(Self::File(path.into())),
            Value::Table(table) if table.contains_key(key) => T::deserialize(table)
                .map(|made| Self::Made(Box::new(made)))
                .map_err(|e| D::Error::custom(e.message())),
            other => Err(D::Error::custom(format!(
                "a {what} is a path or a table with {key} = …, not {}",
                other.type_str()
            ))),
        }
    }
}
