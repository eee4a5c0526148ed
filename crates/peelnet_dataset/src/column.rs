//! The fourteen columns: names, order and types, in one table. Everything else in the crate asks this list.

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

/// Makes [`Column`] and [`FragmentBatch`] of rows of documentation, variant, name and type.
macro_rules! columns {
    ($($(#[doc = $doc:literal])+ $variant:ident $name:ident $kind:ident $type:ty,)+) => {
        /// A column of the dataset. The discriminants are the order in every format.
        #[derive(
            Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
        )]
        #[serde(rename_all = "snake_case")]
        pub enum Column {
            $($(#[doc = $doc])+ $variant,)+
        }

        /// Some rows of the dataset as fourteen vectors of equal length.
        #[derive(Clone, Debug, Default, PartialEq)]
        pub struct FragmentBatch {
            $($(#[doc = $doc])+ pub $name: Vec<$type>,)+
        }

        impl Column {
            /// All columns in the order of the files.
            pub const ALL: [Self; 14] = [$(Self::$variant,)+];

            /// The name in headers and file names.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => stringify!($name),)+
                }
            }

            /// The type of the values.
            pub const fn kind(self) -> ColumnKind {
                match self {
                    $(Self::$variant => ColumnKind::$kind,)+
                }
            }
        }

        impl FragmentBatch {
            /// The values of a column.
            pub fn column(&self, column: Column) -> ColumnSlice<'_> {
                match column {
                    $(Column::$variant => ColumnSlice::$kind(&self.$name),)+
                }
            }

            pub(crate) fn column_mut(&mut self, column: Column) -> ColumnMut<'_> {
                match column {
                    $(Column::$variant => ColumnMut::$kind(&mut self.$name),)+
                }
            }
        }
    };
}

columns! {
    /// 1 − α_i of the fragment itself, 0 … 1.
    OneMinusAlpha one_minus_alpha F32 f32,
    /// z_i, distance along the view axis in scene units, positive.
    LinearDepth linear_depth F32 f32,
    /// Σ α over the pixel.
    AlphaSum alpha_sum F32 f32,
    /// n, the number of fragments of the pixel.
    FragmentCount fragment_count U32 u32,
    /// T_i = ∏_{j<i}(1 − α_j), 0 … 1: the target of training.
    Transmittance transmittance F32 f32,
    /// Index of the work item (scene × copy × view) in the whole dataset.
    View view U32 u32,
    /// Pixel column, 0 at the left.
    X x U32 u32,
    /// Pixel row, 0 at the top.
    Y y U32 u32,
    /// Rank of the fragment from the front, 0 for the nearest.
    Layer layer U32 u32,
    /// Red radiance, un-premultiplied, linear.
    R r F32 f32,
    /// Green radiance, un-premultiplied, linear.
    G g F32 f32,
    /// Blue radiance, un-premultiplied, linear.
    B b F32 f32,
    /// Near clip distance of the view, scene units.
    Near near F32 f32,
    /// Far clip distance of the view, scene units.
    Far far F32 f32,
}

impl Column {
    /// Position in [`Column::ALL`].
    pub const fn index(self) -> usize {
        self as usize
    }

    /// The column of a name, if there is one.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|c| c.name() == name)
    }

    /// Least and greatest value that a float column may have, and the rule in words.
    pub(crate) const fn float_range(self) -> (f32, f32, &'static str) {
        match self {
            Self::OneMinusAlpha | Self::Transmittance => {
                (0.0, 1.0, "it must be a number from 0 to 1")
            }
            Self::LinearDepth | Self::Near | Self::Far => {
                let least = f32::from_bits(1);
                (least, f32::MAX, "it must be a finite number above 0")
            }
            Self::AlphaSum => (0.0, f32::MAX, "it must be a finite number not below 0"),
            _ => (f32::MIN, f32::MAX, "it must be a finite number"),
        }
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
    pub(crate) fn empty(column: Column) -> Self {
        match column.kind() {
            ColumnKind::F32 => Self::F32(Vec::new()),
            ColumnKind::U32 => Self::U32(Vec::new()),
        }
    }

    pub(crate) fn extend(&mut self, values: ColumnSlice<'_>) {
        match (self, values) {
            (Self::F32(to), ColumnSlice::F32(from)) => to.extend_from_slice(from),
            (Self::U32(to), ColumnSlice::U32(from)) => to.extend_from_slice(from),
            _ => unreachable!("a column has one type"),
        }
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
