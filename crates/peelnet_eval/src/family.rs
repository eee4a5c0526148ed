//! Families of methods, and which setting stands for each: the rule of docs/benchmarks.md ("Which setting stands for a family").
//!
//! The rule reads rows of *validation* scenes, which no table reports: the best of thirty settings on the scenes reported would owe part
//! of its lead to chance.

use crate::{
    Row,
    front::{self, Mean, Point},
};
use peelnet_render::MethodSpec;

/// A candidate may take so many times the time of its family's fastest.
pub const MOST_TIME: f64 = 2.0;

/// Methods of one idea.
#[derive(Debug, PartialEq, Eq)]
pub struct Family {
    /// What tables call it.
    pub name: &'static str,
    /// Names of methods; one that ends in `*` stands for all that begin like it.
    pub members: &'static [&'static str],
    /// Whether only settings that are exact are candidates: a cap on passes makes some of them approximate.
    pub exact: bool,
}

/// The families, in the order of tables. Methods that sort on the CPU belong to none.
pub const FAMILIES: [Family; 8] = [
    Family {
        exact: true,
        ..family(
            "exact",
            &["abuffer", "linked-list", "depth-peel", "dual-peel"],
        )
    },
    family(
        "weighted blending",
        &["weighted-sum", "weighted-average", "blended", "wboit-*"],
    ),
    family("moments", &["mboit4", "mboit6", "mboit8", "mboit-trig-*"]),
    family("intervals of depth", &["wavelet-*", "bins-*", "avboit*"]),
    family(
        "bounded exact",
        &["kbuffer-*", "hybrid-*", "stochastic-*", "mlab-*"],
    ),
    family("learned, published", &["deep-thesis", "nmt", "dfaoit"]),
    family("known layers, ours", &["slabs"]),
    family(
        "learned, ours",
        &[
            "deep-small",
            "deep-medium",
            "deep-large",
            "deep-anchored-small",
            "deep-anchored-medium",
        ],
    ),
];

const fn family(name: &'static str, members: &'static [&'static str]) -> Family {
    Family {
        name,
        members,
        exact: false,
    }
}

impl Family {
    /// Whether a method belongs to it, with any parameters.
    pub fn has(&self, method: &MethodSpec) -> bool {
        let text = method.to_string();
        let name = text.split(':').next().unwrap_or_default();
        self.members.iter().any(|m| match m.strip_suffix('*') {
            Some(beginning) => name.starts_with(beginning),
            None => *m == name,
        })
    }

    /// Whether a method may stand for it: one of its members at full resolution.
    fn admits(&self, method: &MethodSpec) -> bool {
        self.has(method) && !method.is_scaled() && (!self.exact || method.promises().exact)
    }
}

/// What stands for a family.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// The family.
    pub family: &'static Family,
    /// The method with its parameters, as the rule's means over the rows have it; `None` where no candidate was timed.
    pub chosen: Option<Point>,
    /// Settings that were timed on every view.
    pub candidates: usize,
    /// Members of which only errors are known, because they were composited on the CPU, each with the reason. They cannot be chosen.
    pub untimed: Vec<(String, &'static str)>,
}

/// Applies the rule: of a family's candidates that take at most [`MOST_TIME`] times the time of its fastest, the one with the least
/// geometric mean of `mse_linear` over the rows; of equal ones the faster. Errors below [`front::EXACT_MSE`] are equal. A method that
/// was not drawn or not timed on every view is no candidate.
pub fn choose(rows: &[Row]) -> Vec<Choice> {
    let drawn = |method: &str| rows.iter().filter(|r| r.method == method).count();
    let views = rows.iter().map(|r| drawn(&r.method)).max().unwrap_or(0);
    // By time, the faster first.
    let points = front::points(rows, None, Mean::Geometric);
    let parsed: Vec<(MethodSpec, Point)> = points
        .into_iter()
        .filter(|p| drawn(&p.method) == views)
        .filter_map(|p| Some((p.method.parse().ok()?, p)))
        .collect();
    let untimed = front::untimed(rows);
    let choice = |family: &'static Family| {
        let candidates: Vec<&Point> = parsed
            .iter()
            .filter(|(spec, _)| family.admits(spec))
            .map(|(_, point)| point)
            .collect();
        let fastest = candidates.first().map_or(0.0, |p| p.time_ms);
        let fast = candidates
            .iter()
            .filter(|p| p.time_ms <= MOST_TIME * fastest);
        // The first of equal ones is the faster.
        let chosen = fast.min_by(|a, b| a.error.total_cmp(&b.error));
        let own = |method: &str| method.parse().is_ok_and(|spec| family.has(&spec));
        Choice {
            family,
            chosen: chosen.map(|&p| p.clone()),
            candidates: candidates.len(),
            untimed: untimed
                .iter()
                .filter(|(method, _)| own(method))
                .map(|&(method, why)| (method.to_owned(), why))
                .collect(),
        }
    };
    FAMILIES.iter().map(choice).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failing test may panic")]
    use super::*;
    use crate::{front::BASE, row::tests::row};

    /// Rows of two scenes: the second is harder and slower by factors that are the same for all, which change no choice.
    fn rows(of: &[(&str, f64, Option<f64>)]) -> Vec<Row> {
        let mut rows = Vec::new();
        for (scene, factor) in [("a", 1.0), ("b", 9.0)] {
            for &(method, mse, ms) in of {
                let mut r = row(scene, 0, method, 0.0);
                r.mse_linear = mse * factor;
                r.time_ms = ms.map(|ms| ms * factor);
                rows.push(r);
            }
        }
        rows
    }

    fn chosen(rows: &[Row], family: &str) -> Option<String> {
        let of = choose(rows).into_iter().find(|c| c.family.name == family);
        of.unwrap().chosen.map(|p| p.method)
    }

    #[test]
    fn the_least_error_within_twice_the_fastest_is_chosen() {
        // The fastest is worse, the best is too slow.
        let all = rows(&[
            (BASE, 1.0, Some(0.5)),
            ("mboit4", 4e-3, Some(1.0)),
            ("mboit6", 1e-3, Some(1.9)),
            ("mboit8", 1e-4, Some(2.1)),
            ("mboit4:own=out", 2e-3, Some(1.5)),
        ]);
        assert_eq!(chosen(&all, "moments").as_deref(), Some("mboit6"));
        // What takes longer than all that was drawn of another family does not count here.
        assert_eq!(chosen(&all, "learned, ours"), None);
    }

    /// One bad scene does not choose for all: 1 · 8 is less than 3 · 3, although 1 + 8 is more than 3 + 3.
    #[test]
    fn means_are_geometric() {
        let mut all = Vec::new();
        for (method, errors) in [("nmt", [3e-3, 3e-3]), ("dfaoit", [1e-3, 8e-3])] {
            for (scene, error) in ["a", "b"].into_iter().zip(errors) {
                let mut r = row(scene, 0, method, 0.0);
                (r.mse_linear, r.time_ms) = (error, Some(1.0));
                all.push(r);
            }
        }
        let published = chosen(&all, "learned, published");
        assert_eq!(published.as_deref(), Some("dfaoit"));
    }

    #[test]
    fn of_equal_errors_the_faster_is_chosen() {
        let all = rows(&[
            ("bins-8", 1e-3, Some(1.5)),
            ("wavelet-3", 1e-3, Some(1.25)),
            ("avboit", 1e-2, Some(1.0)),
            // Exact to the floor of errors: the one is not better than the other.
            ("abuffer", 0.0, Some(3.0)),
            ("linked-list", 1e-13, Some(2.0)),
        ]);
        let intervals = chosen(&all, "intervals of depth");
        assert_eq!(intervals.as_deref(), Some("wavelet-3"));
        assert_eq!(chosen(&all, "exact").as_deref(), Some("linked-list"));
    }

    /// A cap on passes is fast and no longer exact, so that it neither is chosen nor says what is fast.
    #[test]
    fn only_exact_settings_stand_for_exact_methods() {
        let all = rows(&[
            ("depth-peel:passes=2", 1e-3, Some(1.0)),
            ("linked-list:colors=u8", 1e-6, Some(4.0)),
            ("linked-list", 0.0, Some(5.0)),
        ]);
        let choices = choose(&all);
        assert_eq!(choices[0].candidates, 1);
        assert_eq!(chosen(&all, "exact").as_deref(), Some("linked-list"));
    }

    #[test]
    fn lower_resolutions_are_no_candidates() {
        let all = rows(&[
            ("deep-medium:scale=0.5", 1e-5, Some(0.5)),
            ("deep-medium", 1e-4, Some(1.2)),
            ("deep-small", 1e-3, Some(1.0)),
        ]);
        assert_eq!(
            chosen(&all, "learned, ours").as_deref(),
            Some("deep-medium")
        );
    }

    /// `mlab-4` has no time: it cannot be chosen, and stands beside its family with the reason. A method that was not timed on one
    /// view, or left out of it, has means of something else.
    #[test]
    fn what_was_not_timed_everywhere_cannot_be_chosen() {
        let mut all = rows(&[
            ("mlab-4", 1e-9, None),
            ("kbuffer-4", 1e-4, Some(1.0)),
            ("hybrid-4", 1e-5, Some(1.0)),
            ("kbuffer-8", 1e-6, Some(1.0)),
        ]);
        all.retain(|r| !(r.method == "kbuffer-8" && r.scene == "b"));
        let untimed = all.iter_mut().find(|r| r.method == "hybrid-4");
        untimed.unwrap().time_ms = None;
        let choices = choose(&all);
        let bounded = choices.iter().find(|c| c.family.name == "bounded exact");
        let bounded = bounded.unwrap();
        let method = bounded.chosen.as_ref().map(|p| p.method.as_str());
        assert_eq!((method, bounded.candidates), (Some("kbuffer-4"), 1));
        let (method, why) = &bounded.untimed[0];
        assert!(method == "mlab-4" && why.contains("order"));
        let others = choices.iter().filter(|c| c.family.name != "bounded exact");
        assert_eq!(others.map(|c| c.untimed.len()).sum::<usize>(), 0);
    }

    /// Every method but those that sort on the CPU belongs to one family.
    #[test]
    fn families_are_disjoint_and_hold_all_methods() {
        for spec in MethodSpec::compared() {
            let families = FAMILIES.iter().filter(|f| f.has(&spec)).count();
            let sorts = spec.to_string().starts_with("painter-");
            assert_eq!(families, usize::from(!sorts), "{spec}");
        }
        for member in FAMILIES.iter().flat_map(|f| f.members) {
            let family = family("", std::slice::from_ref(member));
            let mut all = MethodSpec::compared().into_iter();
            assert!(all.any(|spec| family.has(&spec)), "{member}");
        }
    }
}
