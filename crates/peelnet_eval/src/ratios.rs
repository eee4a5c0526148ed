//! Methods against one another: the errors of each as ratios to those of two references, over scenes and views.

use crate::{
    Row,
    front::{BASE, EXACT_MSE},
    geometric_mean, methods_of,
};
use peelnet_render::Role;
use std::collections::BTreeMap;

/// The weighted blending that errors are compared with.
pub const WEIGHTED: &str = Role::WeightedBlending.method();
/// The moment method that errors and times are compared with.
pub const MOMENTS: &str = Role::MomentBlending.method();

/// A method's figures over all scenes and views.
#[derive(Clone, Debug, PartialEq)]
pub struct Ratios {
    /// The method's name with its parameters.
    pub method: String,
    /// Geometric mean of `mse_linear` over scenes and views, each at least [`EXACT_MSE`]; `None` where none is above that.
    pub mse_linear: Option<f64>,
    /// The same as a ratio to [`WEIGHTED`]'s.
    pub to_weighted: Option<f64>,
    /// The same as a ratio to [`MOMENTS`]'s.
    pub to_moments: Option<f64>,
    /// The scene with the largest ratio of mean error to [`MOMENTS`]'s, and that ratio.
    pub worst: Option<(String, f64)>,
    /// Geometric mean of the median frame times as a ratio to [`BASE`]'s.
    pub time_to_base: Option<f64>,
    /// Geometric mean of the median frame times as a ratio to [`MOMENTS`]'s.
    pub time_to_moments: Option<f64>,
    /// The same to [`WEIGHTED`]'s.
    pub time_to_weighted: Option<f64>,
    /// Bytes a pixel over scenes and views; `None` where none are known.
    pub bytes_per_pixel: Option<Bytes>,
    /// Pixels that are not finite, in all views.
    pub non_finite_pixels: u64,
}

/// Bytes a pixel over several views: those of methods that store fragments differ from view to view.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bytes {
    /// Arithmetic mean.
    pub mean: f64,
    /// Median; of an even number the lower one.
    pub median: f64,
    /// The largest.
    pub most: f64,
}

impl Bytes {
    /// Over the rows that know them; `None` where none does.
    pub fn of<'a>(rows: impl IntoIterator<Item = &'a Row>) -> Option<Self> {
        let mut all: Vec<f64> = rows.into_iter().filter_map(|r| r.bytes_per_pixel).collect();
        all.sort_by(f64::total_cmp);
        let most = all.last().copied()?;
        Some(Self {
            mean: all.iter().sum::<f64>() / all.len() as f64,
            median: all[(all.len() - 1) / 2],
            most,
        })
    }

    /// Whether every view takes the same.
    pub fn is_one(&self) -> bool {
        self.mean == self.most
    }
}

/// The figures of every method, in the order of the rows.
pub fn ratios(rows: &[Row]) -> Vec<Ratios> {
    let methods = methods_of(rows);
    let of = |method: &str| -> Vec<&Row> { rows.iter().filter(|r| r.method == method).collect() };
    let mean = |method: &str, value: &dyn Fn(&Row) -> Option<f64>| {
        let values: Option<Vec<f64>> = of(method).into_iter().map(value).collect();
        geometric_mean(values?)
    };
    let error = |r: &Row| Some(r.mse_linear.max(EXACT_MSE));
    let time = |r: &Row| r.time_ms;
    let by_scene = |method: &str| {
        let mut sums: BTreeMap<&str, f64> = BTreeMap::new();
        for row in of(method) {
            *sums.entry(&row.scene).or_default() += row.mse_linear;
        }
        sums
    };
    let ratio = |a: Option<f64>, b: Option<f64>| Some(a? / b?);
    let reference = by_scene(MOMENTS);
    methods
        .iter()
        .map(|&method| {
            let exact = of(method).iter().all(|r| r.mse_linear <= EXACT_MSE);
            let mse = mean(method, &error).filter(|_| !exact);
            let worst = by_scene(method)
                .into_iter()
                .filter_map(|(scene, sum)| {
                    let base = *reference.get(scene)?;
                    (base > 0.0).then(|| (scene.to_owned(), sum / base))
                })
                .max_by(|a, b| a.1.total_cmp(&b.1));
            Ratios {
                method: method.to_owned(),
                mse_linear: mse,
                to_weighted: ratio(mse, mean(WEIGHTED, &error)),
                to_moments: ratio(mse, mean(MOMENTS, &error)),
                worst,
                time_to_base: ratio(mean(method, &time), mean(BASE, &time)),
                time_to_moments: ratio(mean(method, &time), mean(MOMENTS, &time)),
                time_to_weighted: ratio(mean(method, &time), mean(WEIGHTED, &time)),
                bytes_per_pixel: Bytes::of(of(method)),
                non_finite_pixels: of(method).iter().map(|r| r.non_finite_pixels).sum(),
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::row::tests::row;

    #[test]
    fn bytes_over_views_have_a_mean_a_median_and_a_largest() {
        let rows = [5.0, 1.0, 3.0, 7.0].map(|bytes| Row {
            bytes_per_pixel: Some(bytes),
            ..row("a", 0, "x", 0.0)
        });
        let bytes = Bytes::of(&rows).expect("rows");
        assert_eq!((bytes.mean, bytes.median, bytes.most), (4.0, 3.0, 7.0));
        assert!(!bytes.is_one());
        assert_eq!(Bytes::of(&[]), None);
    }

    /// Two scenes with ratios 1/4 and 1 to the moments: geometric mean ½, worst 1.
    #[test]
    fn means_are_geometric_and_the_worst_scene_is_named() {
        let mut rows = Vec::new();
        for (scene, mine) in [("a", 1.0), ("b", 4.0)] {
            for (method, mse, ms) in [(WEIGHTED, 16.0, 1.0), (MOMENTS, 4.0, 2.0), ("x", mine, 3.0)]
            {
                let mut r = row(scene, 0, method, 65025.0 * mse);
                r.time_ms = Some(ms);
                rows.push(r);
            }
        }
        let all = ratios(&rows);
        let x = &all[2];
        assert!(x.bytes_per_pixel.is_some_and(|b| b.is_one()));
        let close = |a: Option<f64>, b: f64| (a.expect("measured") - b).abs() < 1e-12;
        assert!(close(x.to_moments, 0.5) && close(x.to_weighted, 0.125));
        assert_eq!(x.worst, Some(("b".to_owned(), 1.0)));
        assert!(close(x.time_to_moments, 1.5) && close(x.time_to_weighted, 3.0));
    }
}
