//! Meshes and textures as a scene file names them: a path, or a table that describes a generated one.

use crate::{pattern::Pattern, shapes::Shape};
use serde::{Deserialize, Deserializer, de::Error as _};
use std::path::PathBuf;

/// A mesh in a scene file: a path, or a table with `shape = …`.
#[derive(Clone, Debug, PartialEq)]
pub enum MeshRef {
    /// A file, relative to the scene file.
    File(PathBuf),
    /// A generated shape.
    Shape(Shape),
}

impl<'de> Deserialize<'de> for MeshRef {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        match toml::Value::deserialize(deserializer)? {
            toml::Value::String(path) => Ok(Self::File(path.into())),
            table @ toml::Value::Table(_) => Shape::deserialize(table)
                .map(Self::Shape)
                .map_err(|e| D::Error::custom(e.message())),
            other => Err(D::Error::custom(format!(
                "a mesh is a path or a table with shape = …, not {}",
                other.type_str()
            ))),
        }
    }
}

/// A texture in a scene file: a path, or a table with `pattern = …`.
#[derive(Clone, Debug, PartialEq)]
pub enum MapRef {
    /// A file, relative to the scene file.
    File(PathBuf),
    /// A generated pattern.
    Pattern(Box<Pattern>),
}

impl<'de> Deserialize<'de> for MapRef {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        match toml::Value::deserialize(deserializer)? {
            toml::Value::String(path) => Ok(Self::File(path.into())),
            table @ toml::Value::Table(_) => Pattern::deserialize(table)
                .map(|pattern| Self::Pattern(Box::new(pattern)))
                .map_err(|e| D::Error::custom(e.message())),
            other => Err(D::Error::custom(format!(
                "a map is a path or a table with pattern = …, not {}",
                other.type_str()
            ))),
        }
    }
}
