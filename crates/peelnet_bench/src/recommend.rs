//! The best method within a budget.

use peelnet_render::MethodSpec;
use peelnet_scene::Scene;

use crate::{
    Row,
    front::{self, Mean, Point},
    rows::Rows,
};
use std::collections::{BTreeMap, BTreeSet};

/// What must hold; `None` sets no bound.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Budget {
    /// Frame time, milliseconds, in the view that takes longest.
    pub ms: Option<f64>,
    /// Mean squared error, linear light, in the view where it is largest.
    pub error: Option<f64>,
    /// Bytes a pixel, in the view that takes most.
    pub bytes: Option<f64>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Recommendation<'a> {
    pub best: &'a Point,
    pub runner_up: Option<&'a Point>,
    pub why: String,
}

/// What a method is chosen from.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidates {
    pub points: Vec<Point>,
    /// Whether they were measured with the scene itself.
    pub of_scene: bool,
    /// What their figures are not.
    pub warning: Option<String>,
}

/// The points of a scene among the rows, of its worst view; where it is not among them those over all scenes. Methods that cannot draw it,
/// or lack a view that others have, are left out.
pub fn points_for(rows: &[Row], scene: &Scene) -> Candidates {
    let draws = |row: &&Row| {
        let spec = row.method.parse::<MethodSpec>();
        spec.is_ok_and(|spec| spec.check_scene(scene).is_ok())
    };
    let rows: &[Row] = &rows.iter().filter(draws).cloned().collect::<Vec<_>>();
    // Rows of before there was a hash, and scenes that are built in code, have none.
    let is_own = |row: &&Row| row.scene_content == scene.content && !scene.content.is_empty();
    let own: Vec<Row> = rows.iter().filter(is_own).cloned().collect();
    let mut views_of: BTreeMap<&str, usize> = BTreeMap::new();
    for row in &own {
        *views_of.entry(&row.method).or_default() += 1;
    }
    let views: BTreeSet<u32> = own.iter().map(|row| row.view).collect();
    let views = views.len();
    let whole = own.iter().filter(|row| views_of[&*row.method] == views);
    let whole: Vec<Row> = whole.cloned().collect();
    let points = front::points(&Rows::new(&whole), Mean::Worst);
    if !points.is_empty() {
        let all = scene.views.len();
        let warning = (views < all).then(|| {
            format!("only {views} of the scene's {all} views were measured: another may be slower, and its error larger")
        });
        return Candidates {
            points,
            of_scene: true,
            warning,
        };
    }
    let name = &scene.name;
    let which = match rows.iter().any(|row| row.scene == *name) {
        true => format!("the results do not show that their scene '{name}' is this one"),
        false => format!("scene '{name}' is not among the results"),
    };
    let rows = Rows::new(rows);
    let mut warning = format!("{which}: judged by the geometric means over all scenes of them");
    if let Some(note) = rows.note() {
        warning += &format!(". {note}");
    }
    Candidates {
        points: front::points(&rows, Mean::Geometric),
        of_scene: false,
        warning: Some(warning),
    }
}

impl Budget {
    /// The limits that are set, each with what a point has of it.
    fn limits(&self, p: &Point) -> impl Iterator<Item = (f64, f64)> + use<> {
        let all = [
            (self.ms, p.time_ms),
            (self.error, p.mse()),
            // As tables print them: small textures are a part of a byte.
            (self.bytes, p.bytes.most.round()),
        ];
        all.into_iter()
            .filter_map(|(limit, value)| Some((limit?, value)))
    }

    /// The best of the points within the budget: the fastest where an error is asked for, else the most accurate (the faster
    /// of equally accurate ones). `Err` says which point comes nearest where none is within it.
    ///
    /// # Errors
    /// A sentence for the user.
    pub fn choose<'a>(&self, points: &'a [Point]) -> Result<Recommendation<'a>, String> {
        let allows = |p: &&Point| self.limits(p).all(|(limit, value)| value <= limit);
        let mut within: Vec<&Point> = points.iter().filter(allows).collect();
        within.sort_by(|a, b| {
            let by_time = a.time_ms.total_cmp(&b.time_ms);
            let by_error = a.error.total_cmp(&b.error);
            match self.error {
                Some(_) => by_time.then(by_error),
                None => by_error.then(by_time),
            }
        });
        let Some((&best, others)) = within.split_first() else {
            return Err(self.nearest(points));
        };
        let ties = if points.len() == within.len() {
            "of all"
        } else {
            "within the budget"
        };
        let what = if self.error.is_some() {
            "the fastest"
        } else if best.is_exact() {
            "the fastest exact one"
        } else {
            "the most accurate"
        };
        let mut why = format!(
            "{what} of the {} methods and settings {ties} ({} were measured)",
            within.len(),
            points.len()
        );
        let runner_up = others.first().copied();
        if let Some(next) = runner_up {
            why.push_str(&format!(
                "; {} takes {:.2} x its time{}",
                next.method,
                next.time_ms / best.time_ms,
                match (best.is_exact(), next.is_exact()) {
                    (true, true) => " and is exact as well".to_owned(),
                    (true, false) => format!(" and has an MSE of {:.2e}", next.error),
                    (false, _) => format!(" and has {:.2} x its error", next.mse() / best.error),
                }
            ));
        }
        Ok(Recommendation {
            best,
            runner_up,
            why,
        })
    }

    /// What to say where nothing is within the budget.
    fn nearest(&self, points: &[Point]) -> String {
        // The largest factor by which a limit is exceeded.
        let excess = |p: &Point| {
            let ratios = self.limits(p).map(|(limit, value)| value / limit);
            ratios.fold(0.0, f64::max)
        };
        let nearest = |a: &&Point, b: &&Point| excess(a).total_cmp(&excess(b));
        let Some(p) = points.iter().min_by(nearest) else {
            return "there is no timed method to choose from".to_owned();
        };
        format!(
            "no method is within the budget; the nearest is {}: {:.2} ms, error {:.2e}, {:.0} bytes a pixel",
            p.method,
            p.time_ms,
            p.mse(),
            p.bytes.most
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rows::{Bytes, tests::row};
    use peelnet_render::role;

    /// A view that was not measured is said to be missing; a method without one that others have is no candidate.
    #[test]
    fn views_that_are_missing_are_no_candidates() {
        let shipped = peelnet_scene::suite::find("cups").unwrap();
        let mut scene = peelnet_scene::suite::load_file(shipped, None).unwrap();
        scene.views.truncate(2);
        let of_view = |view, method| Row {
            view,
            time_ms_min: Some(1.0),
            scene_content: scene.content.clone(),
            ..row(&scene.name, method, 1.0)
        };
        let (whole, half) = (role::WEIGHTED_BLENDING, role::MOMENT_BLENDING);
        let mut rows = vec![of_view(0, whole), of_view(0, half)];
        let found = points_for(&rows, &scene);
        assert_eq!((found.points.len(), found.of_scene), (2, true));
        let warning = found.warning.unwrap();
        assert!(warning.contains("only 1 of the scene's 2 views"));
        rows.push(of_view(1, whole));
        let found = points_for(&rows, &scene);
        assert_eq!((found.points.len(), found.warning), (1, None));
        assert_eq!(found.points[0].method, whole);
    }

    /// Without a bound the most accurate, with an error the fastest; where nothing is within the budget, the nearest is named.
    #[test]
    fn budgets_choose() {
        let points = [
            ("fast", 1e-2, 1.0, 8.0),
            ("good", 1e-4, 2.0, 24.34),
            ("fat", 1e-5, 2.5, 200.0),
            ("exact", 1e-10, 5.0, 400.0),
        ];
        let points = points.map(|(method, error, time_ms, most)| Point {
            method: method.to_owned(),
            error,
            time_ms,
            bytes: Bytes {
                most,
                ..Bytes::default()
            },
            ..Point::default()
        });
        for (ms, error, bytes, want) in [
            (None, None, None, Ok(("exact", Some("fat")))),
            (Some(3.0), None, None, Ok(("fat", Some("good")))),
            (None, Some(1e-3), None, Ok(("good", Some("fat")))),
            (None, None, Some(50.0), Ok(("good", Some("fast")))),
            (None, None, Some(24.0), Ok(("good", Some("fast")))),
            (Some(1.0), None, None, Ok(("fast", None))),
            (Some(1.5), Some(1e-4), None, Err("nearest is good")),
        ] {
            let chosen = Budget { ms, error, bytes }.choose(&points);
            match want {
                Ok(want) => {
                    let r = chosen.unwrap();
                    let runner_up = r.runner_up.map(|p| p.method.as_str());
                    assert_eq!((r.best.method.as_str(), runner_up), want);
                }
                Err(text) => assert!(chosen.unwrap_err().contains(text)),
            }
        }
        let none = Budget::default().choose(&[]).unwrap_err();
        assert!(none.contains("no timed method"));
    }
}
