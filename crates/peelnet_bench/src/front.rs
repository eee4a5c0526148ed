//! Error against time: a point for every method and its parameters, and the Pareto front of them.

pub use crate::rows::EXACT_MSE;
use crate::{
    metrics::mark_front,
    rows::{Bytes, Rows, mean},
};
use peelnet_render::{MethodSpec, role};

/// What times are ratios to: hardware blending in the scene's order, without sorting.
pub const BASE: &str = role::HARDWARE_BLENDING;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mean {
    /// Every view counts by its ratio, however small its errors are.
    Geometric,
    /// Every view counts by its error: one bad scene is not outweighed by many good ones.
    Arithmetic,
    /// The view with the largest error, and the one that takes longest.
    Worst,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Point {
    pub method: String,
    /// Mean or largest of `mse_linear`, at least [`EXACT_MSE`].
    pub error: f64,
    /// Geometric mean of the frame time as a ratio to [`BASE`]'s; `None` where that was not drawn.
    pub time: Option<f64>,
    pub time_ms: f64,
    pub bytes: Bytes,
    /// Whether no other method is both faster and at least as accurate.
    pub on_front: bool,
    /// Its time over the front's at its error: 1 on the front.
    pub time_at_equal_error: f64,
    /// Its error over the front's at its time: 1 on the front; infinite where an exact method is as fast.
    pub error_at_equal_time: f64,
}

impl Point {
    /// Whether its error is no larger than that of exact methods.
    pub fn is_exact(&self) -> bool {
        self.error <= EXACT_MSE
    }

    pub fn error_text(&self) -> String {
        if self.is_exact() {
            return "exact".to_owned();
        }
        format!("MSE {:.2e}", self.error)
    }

    pub fn time_text(&self) -> String {
        match self.time {
            Some(ratio) => format!("{ratio:.2} x hardware blending"),
            None => format!("{:.2} ms", self.time_ms),
        }
    }

    /// Its error without the floor: 0 where it is exact.
    pub fn mse(&self) -> f64 {
        if self.is_exact() { 0.0 } else { self.error }
    }
}

/// Methods of which only errors are known, because they were composited on the CPU, each with the reason.
pub fn untimed<'a>(rows: &Rows<'a>) -> Vec<(&'a str, &'static str)> {
    let reason = |spec: MethodSpec| spec.method().cpu_only;
    // Rows of an older version may have names that are no longer there.
    let why = |method: &str| method.parse().ok().and_then(reason);
    let methods = rows.methods().into_iter();
    methods.filter_map(|m| Some((m, why(m)?))).collect()
}

/// The points of rows, by time, over the views that all methods have; times are geometric means, or those of the slowest view. Methods
/// without a time are left out.
pub fn points(rows: &Rows<'_>, kind: Mean) -> Vec<Point> {
    let rows = rows.common();
    let time = |of: &Rows<'_>| match kind {
        Mean::Worst => of.0.iter().filter_map(|r| r.frame_ms()).reduce(f64::max),
        Mean::Geometric | Mean::Arithmetic => of.time_ms(),
    };
    let base = time(&rows.of_method(BASE));
    let point = |method: &str| {
        let own = rows.of_method(method);
        let time_ms = time(&own)?;
        Some(Point {
            method: method.to_owned(),
            error: match kind {
                Mean::Geometric => own.error()?,
                Mean::Arithmetic => mean(own.errors())?,
                Mean::Worst => own.errors().reduce(f64::max)?,
            },
            time: base.map(|base| time_ms / base),
            time_ms,
            bytes: own.bytes().unwrap_or_default(),
            on_front: false,
            time_at_equal_error: 1.0,
            error_at_equal_time: 1.0,
        })
    };
    let mut points: Vec<Point> = rows.methods().into_iter().filter_map(point).collect();
    mark_front(
        &mut points,
        |p| [p.time_ms, p.error],
        |p, on| p.on_front = on,
    );
    measure_against_front(&mut points);
    points
}

/// Fills in how far each point is behind the front, which is interpolated between its neighbours in the logarithms of time and error. No
/// method errs half as an exact one does: between the last point with an error and the exact one the front stays at that error.
fn measure_against_front(points: &mut [Point]) {
    // By time, and so from the largest error to the smallest.
    let logarithms = |p: &Point| [p.time_ms.ln(), p.error.ln()];
    let front = points.iter().filter(|p| p.on_front);
    let front: Vec<[f64; 2]> = front.map(logarithms).collect();
    for p in points.iter_mut().filter(|p| !p.on_front) {
        let [time, error] = logarithms(p);
        // No point is faster than the front's first, or more accurate than its last.
        let times = front.iter().map(|&[t, e]| [-e, t]);
        p.time_at_equal_error = (time - interpolated(times, -error)).exp();
        let is_exact = |e: f64| e <= EXACT_MSE.ln();
        let errors = front.iter().copied().filter(|&[_, e]| !is_exact(e));
        let exact = front.iter().any(|&[t, e]| is_exact(e) && t <= time);
        p.error_at_equal_time = match (exact, is_exact(error)) {
            (true, true) => 1.0,
            (true, false) => f64::INFINITY,
            (false, _) => (error - interpolated(errors, time)).exp(),
        };
    }
}

/// The value at `x` of a line through points of increasing x; that of the nearest end outside of them.
fn interpolated(points: impl IntoIterator<Item = [f64; 2]>, x: f64) -> f64 {
    let mut before: Option<[f64; 2]> = None;
    for [x1, y1] in points {
        if x <= x1 {
            return match before {
                Some([x0, y0]) if x1 > x0 => y0 + (y1 - y0) * (x - x0) / (x1 - x0),
                _ => y1,
            };
        }
        before = Some([x1, y1]);
    }
    before.map_or(x, |[_, y]| y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rows::tests::row;

    fn points_of(of: &[(&str, f64, f64)], kind: Mean) -> Vec<Point> {
        let mut rows = Vec::new();
        for (k, scene) in ["a", "b"].into_iter().enumerate() {
            for &(method, mse, ms) in of {
                let mut r = row(scene, method, 0.0);
                // Another factor on every scene leaves ratios of geometric means as they are.
                r.mse_linear = mse * [1.0, 4.0][k];
                r.time_ms_min = Some(ms * [1.0, 9.0][k]);
                rows.push(r);
            }
        }
        points(&Rows::new(&rows), kind)
    }

    /// On a front of slope −2 in logarithms: a point off it is so many times as slow at its error, and the square as wrong at its time. From
    /// the last method with an error to the exact one the front's error is that of the former; from then on there is none.
    #[test]
    fn points_are_measured_against_the_front() {
        let of = [
            (BASE, 1e-2, 1.0, [1.0, 1.0]),
            ("middle", 1e-4, 10.0, [1.0, 1.0]),
            ("as good, slower", 1e-4, 30.0, [3.0, 9.0]),
            // The front's first point has that error, and less.
            ("worse than all", 1.0, 5.0, [5.0, 2500.0]),
            ("last", 1e-6, 100.0, [1.0, 1.0]),
            ("before", 3e-6, 990.0, [9.9 * 3f64.sqrt(), 3.0]),
            ("exact", 0.0, 1000.0, [1.0, 1.0]),
            ("after", 3e-6, 1010.0, [10.1 * 3f64.sqrt(), f64::INFINITY]),
            ("exact and slow", 0.0, 2000.0, [2.0, 1.0]),
        ];
        let all = points_of(&of.map(|(m, mse, ms, _)| (m, mse, ms)), Mean::Geometric);
        for (method, mse, ms, ratios) in of {
            let p = all.iter().find(|p| p.method == method).unwrap();
            let found = [p.time_at_equal_error, p.error_at_equal_time];
            for (found, want) in found.into_iter().zip(ratios) {
                assert!(found == want || (found / want - 1.0).abs() < 1e-9, "{p:?}");
            }
            let on_front = [BASE, "middle", "last", "exact"].contains(&method);
            assert_eq!((p.on_front, p.is_exact()), (on_front, mse == 0.0));
            let time = p.time.unwrap();
            assert!((time / ms - 1.0).abs() < 1e-12 && (p.time_ms / ms - 3.0).abs() < 1e-12);
        }
    }

    /// Errors 1 and 4 of the two scenes: 2 by ratio, 2.5 by size.
    #[test]
    fn means_differ() {
        let error = |kind| points_of(&[("x", 1.0, 1.0)], kind)[0].error;
        assert!((error(Mean::Geometric) - 2.0).abs() < 1e-12);
        assert!((error(Mean::Arithmetic) - 2.5).abs() < 1e-12);
    }
}
