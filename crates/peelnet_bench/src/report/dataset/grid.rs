//! A view made of its rows: a grid of cells, each with one of its pixels.

use crate::EvalError;
use crate::report::Table;
use image::{Rgb, RgbImage};
use peelnet_core::{files::counted, srgb};
use peelnet_dataset::{Column, ColumnSlice, Dataset, FragmentBatch, Part, rounded};
use std::{collections::BTreeMap, ops::Range};

/// Cells of a side.
pub(super) const SIDE: u32 = 128;

/// Rows of a view that are read.
pub(super) const MOST_READ: u64 = 1 << 23;

/// Rows of a pixel that are shown.
pub(super) const MOST_SHOWN: usize = 64;

/// What is shown of a row.
const SHOWN: [Column; 7] = [
    Column::Layer,
    Column::LinearDepth,
    Column::OneMinusAlpha,
    Column::Transmittance,
    Column::R,
    Column::G,
    Column::B,
];

/// A pixel of the dataset.
pub struct Pixel {
    at: [u32; 2],
    /// Linear, over white.
    color: [f32; 3],
    count: usize,
    /// The first rows.
    rows: Vec<[f64; SHOWN.len()]>,
}

/// Cells of a view with a pixel each.
pub struct Grid {
    size: [u32; 2],
    /// Pixels of a cell's side.
    step: u32,
    /// By row and column.
    cells: BTreeMap<[u32; 2], Pixel>,
    pub rows_read: u64,
}

impl Grid {
    fn new(part: &Part) -> Self {
        Self {
            size: [part.width, part.height],
            step: part.width.max(part.height).div_ceil(SIDE),
            cells: BTreeMap::new(),
            rows_read: 0,
        }
    }

    /// Of the first rows of a part.
    ///
    /// # Errors
    /// Rows that cannot be read.
    pub fn read(dataset: &Dataset, part: &Part) -> Result<Self, EvalError> {
        let mut grid = Self::new(part);
        for batch in dataset.batches_where(1 << 16, |other| other.index == part.index) {
            grid.add(&batch?);
            if grid.rows_read >= MOST_READ {
                break;
            }
        }
        Ok(grid)
    }

    fn add(&mut self, batch: &FragmentBatch) {
        self.rows_read += batch.len() as u64;
        for rows in batch.pixels() {
            let at = [batch.x[rows.start], batch.y[rows.start]];
            let cell = [at[1] / self.step, at[0] / self.step];
            let cell = self.cells.entry(cell);
            cell.or_insert_with(|| Pixel::new(batch, rows, at));
        }
    }

    /// Joins cells until at most so many rows are shown in all.
    pub fn reduce(&mut self, most: usize) {
        let shown = |grid: &Self| grid.cells.values().map(|p| p.rows.len()).sum::<usize>();
        while shown(self) > most && self.cells.len() > 1 {
            self.step *= 2;
            for ([y, x], pixel) in std::mem::take(&mut self.cells) {
                self.cells.entry([y / 2, x / 2]).or_insert(pixel);
            }
        }
    }

    fn cells_a_side(&self) -> [u32; 2] {
        self.size.map(|side| side.div_ceil(self.step))
    }

    /// sRGB, a pixel for each cell; white where no row is.
    pub fn image(&self) -> RgbImage {
        let [width, height] = self.cells_a_side();
        let mut image = RgbImage::from_pixel(width, height, Rgb([255; 3]));
        for (&[y, x], pixel) in &self.cells {
            image.put_pixel(x, y, Rgb(pixel.color.map(srgb::encode8)));
        }
        image
    }

    /// The pixel of a cell: column and row, from the upper left.
    pub fn pixel(&self, [x, y]: [u32; 2]) -> Option<&Pixel> {
        self.cells.get(&[y, x])
    }

    /// The shown pixel with the most rows, the first of several.
    pub fn deepest(&self) -> Option<&Pixel> {
        self.cells.values().rev().max_by_key(|pixel| pixel.count)
    }

    /// For the script: columns and rows of the grid, and by cell the pixel's place, its number of rows, and the values of those shown.
    pub fn json(&self) -> String {
        let [width, height] = self.cells_a_side();
        let cells = self.cells.iter().map(|([y, x], pixel)| {
            let Pixel { at, count, .. } = pixel;
            let values: Vec<String> = pixel.rows.iter().flatten().map(|v| rounded(*v)).collect();
            let values = values.join(",");
            format!(
                "\"{}\":[{},{},{count},[{values}]]",
                y * width + x,
                at[0],
                at[1]
            )
        });
        let cells: Vec<String> = cells.collect();
        let cells = cells.join(",\n");
        format!(
            "{{\"width\":{width},\"height\":{height},\"columns\":{},\"cells\":{{\n{cells}}}}}",
            SHOWN.len()
        )
    }
}

impl Pixel {
    fn new(batch: &FragmentBatch, rows: Range<usize>, at: [u32; 2]) -> Self {
        let channels = [&batch.r, &batch.g, &batch.b];
        let mut color = [0.0; 3];
        let mut behind = 1.0;
        for i in rows.clone() {
            let (through, before) = (batch.one_minus_alpha[i], batch.transmittance[i]);
            let weight = before * (1.0 - through);
            color = std::array::from_fn(|k| color[k] + weight * channels[k][i]);
            behind = before * through;
        }
        let value = |i: usize, column| match batch.column(column) {
            ColumnSlice::F32(values) => f64::from(values[i]),
            ColumnSlice::U32(values) => f64::from(values[i]),
        };
        let shown = rows.clone().take(MOST_SHOWN);
        Self {
            at,
            color: color.map(|c| c + behind),
            count: rows.len(),
            rows: shown
                .map(|i| SHOWN.map(|column| value(i, column)))
                .collect(),
        }
    }

    /// Its place and how many rows it has.
    pub fn title(&self) -> String {
        let ([x, y], rows) = (self.at, counted(self.count as u64, "row"));
        let cut = match self.count > MOST_SHOWN {
            true => format!(", the first {MOST_SHOWN} below"),
            false => String::new(),
        };
        format!("Pixel ({x}, {y}): {rows}{cut}")
    }

    /// Its first rows.
    pub fn table(&self) -> Table {
        let lines = self.rows.iter().map(|row| row.map(rounded).to_vec());
        Table::new(SHOWN.map(Column::name), lines)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use peelnet_dataset::PeeledFragment;

    /// Pixels of two layers, red before blue, half of each: the colour over white is known, and joining cells keeps pixels with their rows.
    #[test]
    fn pixels_have_the_colour_of_their_rows() {
        let part = Part {
            width: 200,
            height: 100,
            ..Part::default()
        };
        let mut batch = FragmentBatch::default();
        let layer = |depth, color| PeeledFragment { depth, color };
        let two = [
            layer(1.0, [1.0, 0.0, 0.0, 0.5]),
            layer(2.0, [0.0, 0.0, 1.0, 0.5]),
        ];
        let deep = vec![layer(3.0, [0.0, 1.0, 0.0, 1.0]); MOST_SHOWN + 1];
        batch.push_pixel([0, 5, 2], [0.1, 9.0], two.into_iter());
        batch.push_pixel([0, 7, 2], [0.1, 9.0], deep.into_iter());
        batch.push_pixel([0, 199, 99], [0.1, 9.0], two.into_iter());
        let mut grid = Grid::new(&part);
        grid.add(&batch);
        let expected = [0.75, 0.25, 0.5].map(srgb::encode8);
        let image = grid.image();
        assert_eq!(image.dimensions(), (100, 50));
        assert_eq!(image.get_pixel(2, 1).0, expected);
        assert_eq!(image.get_pixel(3, 1).0, [0, 255, 0]);
        assert_eq!(image.get_pixel(99, 49).0, expected);
        assert_eq!(image.get_pixel(0, 0).0, [255; 3]);
        let title = grid.deepest().map(Pixel::title);
        let expected = "Pixel (7, 2): 65 rows, the first 64 below";
        assert_eq!(title.as_deref(), Some(expected));
        let json: serde_json::Value = serde_json::from_str(&grid.json()).expect("JSON");
        let rows = serde_json::json!([0, 1, 0.5, 1, 1, 0, 0, 1, 2, 0.5, 0.5, 0, 0, 1]);
        assert_eq!(json["cells"]["102"], serde_json::json!([5, 2, 2, rows]));
        grid.reduce(4);
        assert_eq!((grid.step, grid.cells.len()), (4, 2));
        let title = grid.deepest().map(Pixel::title);
        assert_eq!(title.as_deref(), Some("Pixel (5, 2): 2 rows"));
    }
}
