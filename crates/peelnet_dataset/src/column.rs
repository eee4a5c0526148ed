//! The columns of a dataset, in one table: name, type, unit, allowed values, and what a value says. Files,
//! readers, summaries, documentation and the Python package iterate over it. How peeled fragments become
//! rows follows it.

use std::fmt;
use std::ops::Range;
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::error::DatasetError;
use crate::manifest::Part;

/// The type of a column's values.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ColumnKind {
    /// 32-bit float.
    F32,
    /// 32-bit unsigned integer.
    U32,
}

/// Which values a column may have. No float is NaN or infinite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Allowed {
    Any,
    AboveZero,
    NotNegative,
    ZeroToOne,
    /// The index of the part that the row is in.
    PartIndex,
    /// Below the width of its frames.
    BelowWidth,
    /// Below their height.
    BelowHeight,
}

impl Allowed {
    /// Least and greatest value of a float column, and the rule in words.
    const fn floats(self) -> (f32, f32, &'static str) {
        match self {
            Self::ZeroToOne => (0.0, 1.0, "it must be a number from 0 to 1"),
            Self::AboveZero => {
                let least = f32::from_bits(1);
                (least, f32::MAX, "it must be a finite number above 0")
            }
            Self::NotNegative => (0.0, f32::MAX, "it must be a finite number not below 0"),
            _ => (f32::MIN, f32::MAX, "it must be a finite number"),
        }
    }
}

/// Makes [`Column`], [`FragmentBatch`] and `column_docs!` of rows of what a value says, variant, name, type,
/// unit and allowed values.
macro_rules! columns {
    ($($(#[doc = $doc:literal])+ $variant:ident $name:ident $kind:ident $type:ident $unit:literal $allowed:ident,)+) => {
        /// A column of the dataset. The discriminants are the order in every format.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        pub enum Column {
            $($(#[doc = $doc])+ $variant,)+
        }

        /// Some rows of the dataset as a vector of each column, all of equal length.
        #[derive(Clone, Debug, Default, PartialEq)]
        pub struct FragmentBatch {
            $($(#[doc = $doc])+ pub $name: Vec<$type>,)+
        }

        impl Column {
            /// All columns in the order of the files.
            pub const ALL: [Self; [$(Self::$variant),+].len()] = [$(Self::$variant),+];

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

            /// The unit of the values: `1`, `pixels` or `scene units`.
            pub const fn unit(self) -> &'static str {
                match self {
                    $(Self::$variant => $unit,)+
                }
            }

            /// What a value says, as one sentence of Markdown.
            pub fn meaning(self) -> &'static str {
                match self {
                    $(Self::$variant => concat!($($doc),+).trim_ascii(),)+
                }
            }

            const fn allowed(self) -> Allowed {
                match self {
                    $(Self::$variant => Allowed::$allowed,)+
                }
            }
        }

        /// The columns as a list in Markdown, as a literal: name, type, unit, what a value says.
        #[macro_export]
        macro_rules! column_docs {
            () => {
                concat!($(
                    "- `", stringify!($name), "`: ", stringify!($type), ", ", $unit, ".", $($doc,)+ "\n",
                )+)
            };
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

            /// The vectors of all columns, in their order.
            pub fn into_columns(self) -> [ColumnValues; Column::ALL.len()] {
                [$(ColumnValues::$kind(self.$name)),+]
            }

            /// Appends some rows of another batch.
            ///
            /// # Panics
            /// If the range is out of bounds.
            pub fn extend_from(&mut self, other: &Self, rows: Range<usize>) {
                $(self.$name.extend_from_slice(&other.$name[rows.clone()]);)+
            }

            /// Appends all values of another batch, of which columns may be empty.
            pub(crate) fn append(&mut self, other: &Self) {
                $(self.$name.extend_from_slice(&other.$name);)+
            }

            /// Drops all rows from `rows` on.
            pub fn truncate(&mut self, rows: usize) {
                $(self.$name.truncate(rows);)+
            }

            /// Checks that all columns have the same length.
            ///
            /// # Errors
            /// Names the first column that differs.
            pub fn check(&self) -> Result<(), DatasetError> {
                let rows = self.len();
                let columns = [$((Column::$variant, self.$name.len()),)+];
                match columns.into_iter().find(|(_, found)| *found != rows) {
                    None => Ok(()),
                    Some((column, found)) => Err(DatasetError::Setting(format!(
                        "column {column} has {found} values where the others have {rows}"
                    ))),
                }
            }
        }
    };
}

columns! {
    /// 1 − α_i of the fragment itself.
    OneMinusAlpha one_minus_alpha F32 f32 "1" ZeroToOne,
    /// z_i, distance along the view axis.
    LinearDepth linear_depth F32 f32 "scene units" AboveZero,
    /// Σ α over the pixel.
    AlphaSum alpha_sum F32 f32 "1" NotNegative,
    /// n, the number of fragments of the pixel.
    FragmentCount fragment_count U32 u32 "1" AboveZero,
    /// T_i = ∏_{j<i}(1 − α_j): the target of training.
    Transmittance transmittance F32 f32 "1" ZeroToOne,
    /// Index of the work item (scene × copy × view) in the whole dataset.
    View view U32 u32 "1" PartIndex,
    /// Pixel column, 0 at the left.
    X x U32 u32 "pixels" BelowWidth,
    /// Pixel row, 0 at the top.
    Y y U32 u32 "pixels" BelowHeight,
    /// Rank of the fragment from the front, 0 for the nearest.
    Layer layer U32 u32 "1" Any,
    /// Red radiance, un-premultiplied, linear.
    R r F32 f32 "1" Any,
    /// Green radiance, un-premultiplied, linear.
    G g F32 f32 "1" Any,
    /// Blue radiance, un-premultiplied, linear.
    B b F32 f32 "1" Any,
    /// Near clip distance of the view.
    Near near F32 f32 "scene units" AboveZero,
    /// Far clip distance of the view.
    Far far F32 f32 "scene units" AboveZero,
}

/// A fragment as it was peeled: what no other column of its row implies.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PeeledFragment {
    /// Linear depth, scene units; 0 of a fragment that peeling lost, which makes no row.
    pub depth: f32,
    /// Un-premultiplied linear radiance and alpha.
    pub color: [f32; 4],
}

/// Fragments of a pixel beyond which sums and products are formed in 64 bits: `n` factors formed in 32 bits err by up to `2n` roundings
/// of 2⁻²⁴, a hundredth at 100,000. Rows of shorter runs keep the bits that they have always had.
const LONG: usize = 1500;

impl FragmentBatch {
    /// Appends the rows of a pixel of part `view`, of fragments from the nearest to the farthest; returns how
    /// many. `near` and `far` are the view's clip distances, scene units.
    pub fn push_pixel(
        &mut self,
        [view, x, y]: [u32; 3],
        [near, far]: [f32; 2],
        fragments: impl ExactSizeIterator<Item = PeeledFragment> + Clone,
    ) -> u32 {
        let is_long = fragments.len() > LONG;
        let found = fragments.filter(|f| f.depth > 0.0);
        let (mut alpha_sum, mut long_sum) = (0.0f32, 0.0f64);
        let (mut transmittance, mut long_product) = (1.0f32, 1.0f64);
        let mut count = 0;
        for fragment in found {
            let [r, g, b, alpha] = fragment.color;
            let through = 1.0 - alpha;
            self.one_minus_alpha.push(through);
            self.linear_depth.push(fragment.depth);
            self.transmittance.push(transmittance);
            self.layer.push(count);
            self.r.push(r);
            self.g.push(g);
            self.b.push(b);
            count += 1;
            alpha_sum += alpha;
            transmittance *= through;
            if is_long {
                long_sum += f64::from(alpha);
                long_product *= 1.0 - f64::from(alpha);
                transmittance = long_product as f32;
            }
        }
        if is_long {
            alpha_sum = long_sum as f32;
        }
        let rows = self.len();
        self.alpha_sum.resize(rows, alpha_sum);
        self.fragment_count.resize(rows, count);
        self.view.resize(rows, view);
        self.x.resize(rows, x);
        self.y.resize(rows, y);
        self.near.resize(rows, near);
        self.far.resize(rows, far);
        count
    }
}

impl Column {
    /// Whether all values are from 0 to 1.
    pub(crate) fn is_fraction(self) -> bool {
        self.allowed() == Allowed::ZeroToOne
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

/// The values of one column, by their type.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Typed<F, U> {
    /// Values of a float column.
    F32(F),
    /// Values of an integer column.
    U32(U),
}

/// The values of one column of a batch.
pub type ColumnSlice<'a> = Typed<&'a [f32], &'a [u32]>;
/// The values of one column, taken out of a batch.
pub type ColumnValues = Typed<Vec<f32>, Vec<u32>>;
pub(crate) type ColumnMut<'a> = Typed<&'a mut Vec<f32>, &'a mut Vec<u32>>;

impl FragmentBatch {
    /// Number of rows.
    pub fn len(&self) -> usize {
        self.one_minus_alpha.len()
    }

    /// Whether there are no rows.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Removes all rows and keeps the memory.
    pub fn clear(&mut self) {
        self.truncate(0);
    }

    pub(crate) fn same_pixel(&self, a: usize, b: usize) -> bool {
        self.x[a] == self.x[b] && self.y[a] == self.y[b] && self.view[a] == self.view[b]
    }

    /// The rows of each pixel, in order.
    pub fn pixels(&self) -> impl Iterator<Item = Range<usize>> + '_ {
        let mut start = 0;
        std::iter::from_fn(move || {
            let mut behind = start + 1..self.len();
            let end = behind.find(|&i| !self.same_pixel(start, i));
            let pixel = start..end.unwrap_or(self.len());
            start = pixel.end;
            (!pixel.is_empty()).then_some(pixel)
        })
    }

    /// Finds the first value of a column, from row `start` on, that is not allowed. `first_row` is the number of that row in its part,
    /// counted from 0; the `view` column must repeat the part's index, and places lie in its frame. `path` is named in the error.
    pub(crate) fn check_column(
        &self,
        path: &Path,
        column: Column,
        start: usize,
        first_row: u64,
        part: &Part,
    ) -> Result<(), DatasetError> {
        let allowed = column.allowed();
        let (bad, allowed) = match self.column(column) {
            ColumnSlice::F32(values) => {
                let (least, most, allowed) = allowed.floats();
                let good = |v| v >= least && v <= most;
                (first_bad(&values[start..], good), allowed)
            }
            ColumnSlice::U32(values) => {
                let (least, end, allowed) = match allowed {
                    Allowed::PartIndex => (
                        part.index,
                        part.index.saturating_add(1),
                        "it must be the index of the part",
                    ),
                    Allowed::AboveZero => (1, u32::MAX, "it must be at least 1"),
                    Allowed::BelowWidth => (0, part.width, "it must be below the frame's width"),
                    Allowed::BelowHeight => (0, part.height, "it must be below the frame's height"),
                    _ => return Ok(()),
                };
                let good = |v| v >= least && v < end;
                (first_bad(&values[start..], good), allowed)
            }
        };
        let Some((i, value)) = bad else { return Ok(()) };
        let row = first_row + i as u64 + 1;
        let reason = format!(
            "row {row}, column {column}: {value} is not allowed, {allowed}; fix or remove the whole pixel, or write the dataset again"
        );
        Err(DatasetError::invalid(path, reason))
    }
}

/// The place and the text of the first value that is not good.
fn first_bad<T: Copy + fmt::Display>(
    values: &[T],
    good: impl Fn(T) -> bool,
) -> Option<(usize, String)> {
    // Without leaving early, so that it becomes vector instructions; only a failure searches.
    if values.iter().fold(true, |all, &v| all & good(v)) {
        return None;
    }
    let i = values.iter().position(|&v| !good(v))?;
    Some((i, values[i].to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Names and order are the format: other programs read files by them.
    #[test]
    fn names_and_order_are_the_format() {
        assert_eq!(
            Column::ALL.map(Column::name).join(","),
            "one_minus_alpha,linear_depth,alpha_sum,fragment_count,transmittance,view,x,y,layer,r,g,b,near,far"
        );
        let last = "- `far`: f32, scene units. Far clip distance of the view.\n";
        assert!(column_docs!().ends_with(last));
    }
}
