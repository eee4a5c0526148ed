//! Rows of a bench, and what is averaged over them.

use crate::Row;
use peelnet_render::role;
use std::{
    collections::{BTreeMap, BTreeSet},
    sync::Arc,
};

/// Errors below count as this: a mean squared error of (1e-5)², the agreement that exact methods are held to, in linear
/// light. It keeps geometric means and logarithmic axes finite.
pub const EXACT_MSE: f64 = 1e-10;

/// The weighted blending that errors and times are compared with.
pub const WEIGHTED: &str = role::WEIGHTED_BLENDING;
/// The moment method that errors and times are compared with.
pub const MOMENTS: &str = role::MOMENT_BLENDING;

/// Arithmetic mean; `None` of nothing.
pub fn mean(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let values: Vec<f64> = values.into_iter().collect();
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// Geometric mean; `None` of nothing or if a value is not positive.
pub fn geometric_mean(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let values = values.into_iter().map(|v| (v > 0.0).then_some(v));
    let values: Vec<f64> = values.collect::<Option<_>>()?;
    let mean = mean(values.iter().map(|v| v.ln()))?.exp();
    // Rounding must not move a mean of equal values: one of [`EXACT_MSE`] is that of an exact method.
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let most = values.iter().copied().fold(0.0, f64::max);
    Some(mean.clamp(least, most))
}

/// Each name once, in the order of the first.
pub fn each_once<'a>(names: impl IntoIterator<Item = &'a str>) -> Vec<&'a str> {
    let mut found = Vec::new();
    for name in names {
        if !found.contains(&name) {
            found.push(name);
        }
    }
    found
}

/// The places, scenes or views of them, of which all methods have rows: means over others would not compare.
pub fn shared<'a, P: Ord>(rows: impl IntoIterator<Item = (&'a str, P)>) -> BTreeSet<P> {
    let mut methods = BTreeSet::new();
    let mut places: BTreeMap<P, BTreeSet<&str>> = BTreeMap::new();
    for (method, place) in rows {
        methods.insert(method);
        places.entry(place).or_default().insert(method);
    }
    let of_all = |(place, own): (P, BTreeSet<_>)| (own.len() == methods.len()).then_some(place);
    places.into_iter().filter_map(of_all).collect()
}

/// Bytes a pixel over several views: those of methods that store fragments differ from view to view.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bytes {
    pub mean: f64,
    /// Median; of an even number the lower one.
    pub median: f64,
    pub most: f64,
}

impl Bytes {
    /// Whether every view takes the same, up to rounding of the mean.
    pub fn is_one(&self) -> bool {
        self.mean.round() == self.most.round()
    }

    /// One number, or mean, median and most over the views.
    pub fn text(&self) -> String {
        if self.is_one() {
            return format!("{:.0}", self.most);
        }
        format!("{:.0}, {:.0}, {:.0}", self.mean, self.median, self.most)
    }
}

/// Some rows. Their means are `None` where a row lacks the value, and of no row.
#[derive(Clone, Debug)]
pub struct Rows<'a>(pub Vec<&'a Row>, Judged<'a>);

/// Scenes and views in which a method errs. Where none does, as of one layer, an error of 0 would take any mean of ratios down.
type Judged<'a> = Arc<BTreeSet<(&'a str, u32)>>;

fn place(row: &Row) -> (&str, u32) {
    (&row.scene, row.view)
}

impl<'a> Rows<'a> {
    pub fn new(rows: &'a [Row]) -> Self {
        let err = rows.iter().filter(|r| r.mse_linear > EXACT_MSE);
        let judged = err.map(place).collect();
        Self(rows.iter().collect(), Arc::new(judged))
    }

    fn filter(&self, keep: impl Fn(&Row) -> bool) -> Self {
        let kept = self.0.iter().copied().filter(|r| keep(r)).collect();
        Self(kept, Arc::clone(&self.1))
    }

    /// The rows of the views that all methods have.
    pub fn common(&self) -> Self {
        let places = self.0.iter().map(|r| (r.method.as_str(), place(r)));
        let shared = shared(places);
        self.filter(|r| shared.contains(&place(r)))
    }

    /// A sentence where [`Rows::common`] leaves views out.
    pub fn note(&self) -> Option<String> {
        let views = |rows: &Self| BTreeSet::from_iter(rows.0.iter().map(|r| place(r))).len();
        let [shared, all] = [views(&self.common()), views(self)];
        (shared < all).then(|| {
            format!(
                "Means are over {shared} of {all} views: some method was left out of the others."
            )
        })
    }

    /// Errors that count, each at least [`EXACT_MSE`].
    pub fn errors(&self) -> impl Iterator<Item = f64> {
        let is_judged = |r: &&&Row| self.1.is_empty() || self.1.contains(&place(r));
        let judged = self.0.iter().filter(is_judged);
        judged.map(|r| r.mse_linear.max(EXACT_MSE))
    }

    pub fn of_method(&self, method: &str) -> Self {
        self.filter(|r| r.method == method)
    }

    pub fn of_scene(&self, scene: &str) -> Self {
        self.filter(|r| r.scene == scene)
    }

    pub fn methods(&self) -> Vec<&'a str> {
        each_once(self.0.iter().map(|r| r.method.as_str()))
    }

    pub fn scenes(&self) -> Vec<&'a str> {
        each_once(self.0.iter().map(|r| r.scene.as_str()))
    }

    fn values(&self, value: impl Fn(&Row) -> Option<f64>) -> Option<Vec<f64>> {
        self.0.iter().map(|r| value(r)).collect()
    }

    pub fn mean(&self, value: impl Fn(&Row) -> Option<f64>) -> Option<f64> {
        mean(self.values(value)?)
    }

    /// Geometric mean of the frame times.
    pub fn time_ms(&self) -> Option<f64> {
        geometric_mean(self.values(Row::frame_ms)?)
    }

    /// Geometric mean of `mse_linear`, each at least [`EXACT_MSE`], of the views in which any method errs.
    pub fn error(&self) -> Option<f64> {
        geometric_mean(self.errors())
    }

    /// The error of a method; 0 of an exact one.
    pub fn error_of(&self, method: &str) -> Option<f64> {
        let own = self.of_method(method);
        if own.0.iter().any(|r| r.mse_linear > EXACT_MSE) {
            return own.error();
        }
        (!own.0.is_empty()).then_some(0.0)
    }

    /// The error of a method as a ratio to that of another; `None` of an exact one.
    pub fn error_ratio(&self, method: &str, reference: &str) -> Option<f64> {
        let error = self.error_of(method).filter(|e| *e > 0.0)?;
        Some(error / self.of_method(reference).error()?)
    }

    pub fn time_ratio(&self, method: &str, reference: &str) -> Option<f64> {
        Some(self.of_method(method).time_ms()? / self.of_method(reference).time_ms()?)
    }

    /// The scene with the largest ratio of a method's mean error to [`MOMENTS`]'s, and that ratio.
    pub fn worst_scene(&self, method: &str) -> Option<(&'a str, f64)> {
        let by_scene = |method: &str| {
            let mut sums: BTreeMap<&str, f64> = BTreeMap::new();
            for row in self.of_method(method).0 {
                *sums.entry(&row.scene).or_default() += row.mse_linear;
            }
            sums
        };
        let reference = by_scene(MOMENTS);
        let ratios = by_scene(method).into_iter().filter_map(|(scene, sum)| {
            let base = *reference.get(scene)?;
            (base > 0.0).then_some((scene, sum / base))
        });
        ratios.max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Bytes a pixel over the rows that know them; `None` where none does.
    pub fn bytes(&self) -> Option<Bytes> {
        let known = self.0.iter().filter_map(|r| r.bytes_per_pixel);
        let mut all: Vec<f64> = known.collect();
        all.sort_by(f64::total_cmp);
        Some(Bytes {
            mean: mean(all.iter().copied())?,
            median: all[(all.len() - 1) / 2],
            most: all[all.len() - 1],
        })
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::front::BASE;

    pub(crate) fn row(scene: &str, method: &str, mse255: f64) -> Row {
        Row {
            method: method.to_owned(),
            scene: scene.to_owned(),
            mse_linear: mse255 / 65025.0,
            mse255,
            bytes_per_pixel: Some(10.0),
            ..Row::default()
        }
    }

    /// The logarithms of 7 to 14 equal errors of 1e-10 have a mean whose exponential is above that.
    #[test]
    fn a_mean_of_equal_values_is_that_value() {
        for count in 1..50 {
            let mean = geometric_mean(vec![EXACT_MSE; count]);
            assert_eq!(mean, Some(EXACT_MSE), "{count}");
        }
        assert_eq!(geometric_mean([1.0, 0.0]), None);
        assert_eq!(geometric_mean([1.0, f64::NAN]), None);
        assert_eq!(geometric_mean([]), None);
    }

    #[test]
    fn bytes_over_views_have_a_mean_a_median_and_a_largest() {
        let rows = [5.0, 1.0, 3.0, 7.0].map(|bytes| Row {
            bytes_per_pixel: Some(bytes),
            ..row("a", "x", 0.0)
        });
        let bytes = Rows::new(&rows).bytes().unwrap();
        assert_eq!((bytes.mean, bytes.median, bytes.most), (4.0, 3.0, 7.0));
        assert!(!bytes.is_one());
        assert_eq!(Rows::new(&[]).bytes(), None);
    }

    /// Two scenes with ratios 1/4 and 1 to the moments: geometric mean ½, worst 1.
    #[test]
    fn means_are_geometric_and_the_worst_scene_is_named() {
        let mut rows = Vec::new();
        for (scene, mine) in [("a", 1.0), ("b", 4.0)] {
            for (method, mse, ms) in [(WEIGHTED, 16.0, 1.0), (MOMENTS, 4.0, 2.0), ("x", mine, 3.0)]
            {
                let mut r = row(scene, method, 65025.0 * mse);
                r.time_ms_min = Some(ms);
                rows.push(r);
            }
        }
        let all = Rows::new(&rows);
        assert!(all.of_method("x").bytes().is_some_and(|b| b.is_one()));
        let close = |a: Option<f64>, b: f64| (a.unwrap() - b).abs() < 1e-12;
        assert!(close(all.error_ratio("x", MOMENTS), 0.5));
        assert!(close(all.error_ratio("x", WEIGHTED), 0.125));
        assert_eq!(all.worst_scene("x"), Some(("b", 1.0)));
        assert!(close(all.time_ratio("x", MOMENTS), 1.5));
        assert!(close(all.time_ratio("x", WEIGHTED), 3.0));
        assert_eq!(all.time_ratio("x", BASE), None);
    }

    /// Of a scene that one method lacks no mean knows: neither errors nor times of other scenes are compared.
    #[test]
    fn means_are_over_the_views_that_all_methods_have() {
        let mut rows = Vec::new();
        for (scene, method, mse, ms) in [
            ("a", BASE, 8.0, 1.0),
            ("a", MOMENTS, 4.0, 2.0),
            ("a", "x", 8.0, 3.0),
            ("tinted", MOMENTS, 100.0, 0.1),
            ("tinted", "x", 1.0, 0.1),
        ] {
            rows.push(Row {
                time_ms_min: Some(ms),
                ..row(scene, method, mse)
            });
        }
        let all = Rows::new(&rows);
        assert!(all.note().unwrap().contains("1 of 2 views"));
        let common = all.common();
        assert_eq!((common.scenes(), common.note()), (vec!["a"], None));
        for p in crate::front::points(&all, crate::front::Mean::Geometric) {
            assert_eq!(p.time, Some(p.time_ms), "{p:?}");
            let ratio = common.error_ratio(&p.method, MOMENTS).unwrap();
            assert!((p.error * 65025.0 - 4.0 * ratio).abs() < 1e-9, "{p:?}");
        }
        // Without hardware blending there is no ratio to it.
        let others = all.filter(|r| r.method != BASE);
        let points = crate::front::points(&others, crate::front::Mean::Geometric);
        assert!(points.len() == 2 && points.iter().all(|p| p.time.is_none()));
        let text = points[0].time_text();
        assert!(text.ends_with(" ms"), "{text}");
    }

    /// A view that all methods draw exactly takes no mean of errors down.
    #[test]
    fn views_without_errors_do_not_count() {
        let mut rows = Vec::new();
        for (view, errors) in [(0, [4.0, 16.0]), (1, [0.0, 0.0])] {
            let methods = [MOMENTS, "other"].into_iter().zip(errors);
            rows.extend(methods.map(|(method, mse)| Row {
                view,
                ..row("s", method, mse)
            }));
        }
        let rows = Rows::new(&rows);
        assert_eq!(rows.of_method("other").0.len(), 2);
        assert!((rows.error_ratio("other", MOMENTS).unwrap() - 4.0).abs() < 1e-9);
    }
}
