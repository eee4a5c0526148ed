//! The fourteen columns: names, order and types. Everything else in the crate asks this list.

use std::fmt;

use serde::{Deserialize, Serialize};

/// The type of a column's values.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ColumnKind {
    /// 32-bit float.
    F32,
    /// 32-bit unsigned integer.
    U32,
}

/// A column of the dataset. The discriminants are the order in every format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Column {
    /// 1 − α_i of the fragment itself, 0 … 1.
    OneMinusAlpha,
    /// z_i, distance along the view axis in scene units, positive.
    LinearDepth,
    /// Σ α over the pixel.
    AlphaSum,
    /// n, the number of fragments of the pixel.
    FragmentCount,
    /// T_i = ∏_{j<i}(1 − α_j), 0 … 1: the target of training.
    Transmittance,
    /// Index of the work item (scene × copy × view) in the whole dataset.
    View,
    /// Pixel column, 0 at the left.
    X,
    /// Pixel row, 0 at the top.
    Y,
    /// Rank of the fragment from the front, 0 for the nearest.
    Layer,
    /// Red radiance, un-premultiplied, linear.
    R,
    /// Green radiance, un-premultiplied, linear.
    G,
    /// Blue radiance, un-premultiplied, linear.
    B,
    /// Near clip distance of the view, scene units.
    Near,
    /// Far clip distance of the view, scene units.
    Far,
}

impl Column {
    /// All columns in the order of the files.
    pub const ALL: [Self; 14] = [
        Self::OneMinusAlpha,
        Self::LinearDepth,
        Self::AlphaSum,
        Self::FragmentCount,
        Self::Transmittance,
        Self::View,
        Self::X,
        Self::Y,
        Self::Layer,
        Self::R,
        Self::G,
        Self::B,
        Self::Near,
        Self::Far,
    ];

    /// The name in headers and file names.
    pub const fn name(self) -> &'static str {
        match self {
            Self::OneMinusAlpha => "one_minus_alpha",
            Self::LinearDepth => "linear_depth",
            Self::AlphaSum => "alpha_sum",
            Self::FragmentCount => "fragment_count",
            Self::Transmittance => "transmittance",
            Self::View => "view",
            Self::X => "x",
            Self::Y => "y",
            Self::Layer => "layer",
            Self::R => "r",
            Self::G => "g",
            Self::B => "b",
            Self::Near => "near",
            Self::Far => "far",
        }
    }

    /// The type of the values.
    pub const fn kind(self) -> ColumnKind {
        match self {
            Self::FragmentCount | Self::View | Self::X | Self::Y | Self::Layer => ColumnKind::U32,
            _ => ColumnKind::F32,
        }
    }

    /// Position in [`Column::ALL`].
    pub const fn index(self) -> usize {
        self as usize
    }

    /// The column of a name, if there is one.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|c| c.name() == name)
    }
}

impl fmt::Display for Column {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// The values of one column, owned.
#[derive(Clone, Debug, PartialEq)]
pub enum ColumnData {
    /// Values of a float column.
    F32(Vec<f32>),
    /// Values of an integer column.
    U32(Vec<u32>),
}

impl ColumnData {
    /// An empty column of the right type.
    pub fn with_capacity(column: Column, rows: usize) -> Self {
        match column.kind() {
            ColumnKind::F32 => Self::F32(Vec::with_capacity(rows)),
            ColumnKind::U32 => Self::U32(Vec::with_capacity(rows)),
        }
    }

    /// Number of values.
    pub fn len(&self) -> usize {
        match self {
            Self::F32(v) => v.len(),
            Self::U32(v) => v.len(),
        }
    }

    /// Whether there are no values.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The values of a float column; `None` for an integer column.
    pub fn as_f32(&self) -> Option<&[f32]> {
        match self {
            Self::F32(v) => Some(v),
            Self::U32(_) => None,
        }
    }

    /// The values of an integer column; `None` for a float column.
    pub fn as_u32(&self) -> Option<&[u32]> {
        match self {
            Self::U32(v) => Some(v),
            Self::F32(_) => None,
        }
    }

    /// A view of the values.
    pub fn as_slice(&self) -> ColumnSlice<'_> {
        match self {
            Self::F32(v) => ColumnSlice::F32(v),
            Self::U32(v) => ColumnSlice::U32(v),
        }
    }
}

/// The values of one column, borrowed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ColumnSlice<'a> {
    /// Values of a float column.
    F32(&'a [f32]),
    /// Values of an integer column.
    U32(&'a [u32]),
}

impl<'a> ColumnSlice<'a> {
    /// The values from `start` to `end` (not included).
    ///
    /// # Panics
    /// If the range is out of bounds.
    pub fn range(self, range: std::ops::Range<usize>) -> ColumnSlice<'a> {
        match self {
            Self::F32(v) => Self::F32(&v[range]),
            Self::U32(v) => Self::U32(&v[range]),
        }
    }

    /// Number of values.
    pub fn len(self) -> usize {
        match self {
            Self::F32(v) => v.len(),
            Self::U32(v) => v.len(),
        }
    }

    /// Whether there are no values.
    pub fn is_empty(self) -> bool {
        self.len() == 0
    }
}

/// The values of one column, for appending.
pub(crate) enum ColumnMut<'a> {
    F32(&'a mut Vec<f32>),
    U32(&'a mut Vec<u32>),
}
