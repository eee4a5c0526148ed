//! What must hold of a frame, each property with its limit and the reason for it.

use super::{
    Note,
    subject::Subject,
    trial::{Kind, Trial, Truth},
};
use peelnet_render::{Image, Property};

/// What was found of one property: the value that comes nearest to its limit, or goes farthest beyond it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Finding {
    /// The value; infinite where it is not a number.
    pub value: f64,
    /// The largest that passes.
    pub limit: f64,
    /// Where it is.
    pub place: String,
}

impl Finding {
    /// Whether the property holds.
    pub fn holds(&self) -> bool {
        self.value <= self.limit
    }

    fn excess(&self) -> f64 {
        if self.value <= 0.0 {
            0.0
        } else {
            self.value / self.limit
        }
    }

    /// Keeps the worse of two.
    pub(super) fn worsen(&mut self, value: f64, limit: f64, place: impl FnOnce() -> String) {
        // A NaN is beyond any limit.
        let value = if value.is_nan() { f64::INFINITY } else { value };
        let mut other = Self {
            value,
            limit,
            place: String::new(),
        };
        if self.place.is_empty() || other.excess() > self.excess() {
            other.place = place();
            *self = other;
        }
    }
}

/// A step of an 8-bit display, which the specification grants hulls, scales and what lies behind opaque layers.
const STEP: f64 = 1.0 / 255.0;

/// What a pixel with one fragment may err by, linear light.
const SINGLE: f64 = 1e-4;

/// What coverage may err by where its format allows.
const COVERAGE: f64 = 1.0 / 1024.0;

/// Errors of transmittance that a public harness for moment-based transparency passes: one surface, two layers, sixteen
/// coincident ones. The learned networks must stay within a fifth, two fifths and half of them.
const TRANSMITTANCE: [(&str, f64, f64); 3] = [
    ("isolated", 5e-3, 1e-3),
    ("two-layers", 0.05, 0.02),
    ("coplanar", 0.01, 5e-3),
];

/// The limit of [`Property::Transmittance`] in a case; `None` in cases without one.
pub(super) fn transmittance_limit(case: &str, subject: &Subject) -> Option<f64> {
    let close = subject.promises.close_estimate;
    let found = TRANSMITTANCE.iter().find(|(id, ..)| *id == case);
    found.map(|&(_, public, least)| if close { least } else { public })
}

impl Subject {
    /// Limit of the coverage's error: `n` products or sums round once each, and `T = e^−b` errs by the error of `b` times `T`.
    fn coverage_limit(&self, kind: &Kind) -> f64 {
        let n = kind.fragments.len() as f64;
        COVERAGE + (n + 1.0) * self.rounding() * kind.transmittance * kind.absorbance.max(1.0)
    }

    /// Limit of what the order of drawing may change: nothing where fragments are sorted or compared. Sums of `n` terms in
    /// another order differ by `2n` roundings; two of them are divided, and a third is the coverage. What is reconstructed from
    /// statistics adds its own: a share of the absorbance, and `e^−b·share` changes by `b` times as much at most.
    fn order_limit(&self, kind: &Kind) -> f64 {
        if self.promises.sorted {
            return 0.0;
        }
        let n = kind.fragments.len() as f64;
        let moved = self.reconstruction(n) * kind.absorbance.max(1.0);
        kind.peak * (6.0 * n * self.rounding() + moved)
    }
}

/// Judges what one frame shows.
pub(super) fn judge(
    subject: &Subject,
    case: &str,
    trial: &Trial,
    truth: &Truth,
    image: &Image,
    note: &mut Note<'_>,
) {
    let width = image.width as usize;
    let supports: Vec<Vec<[f64; 2]>> = truth.kinds.iter().map(extents).collect();
    for ((p, kind), i) in image.pixels.iter().zip(&truth.pixels).zip(0..) {
        let kind_index = kind.map(|k| k as usize);
        let place = || {
            let (x, y) = (i % width, i / width);
            let name = kind_index.map_or("no fragment", |k| truth.kinds[k].name.as_str());
            format!("{name}, pixel ({x}, {y})")
        };
        let finite = p.iter().all(|c| c.is_finite());
        note(Property::Finite, f64::from(u8::from(!finite)), 0.0, &place);
        if !subject.promises.per_pixel {
            continue;
        }
        let Some(k) = kind_index else {
            let same = p[..3] == trial.scene.background && p[3] == 0.0;
            note(
                Property::Background,
                f64::from(u8::from(!same)),
                0.0,
                &place,
            );
            continue;
        };
        let kind = &truth.kinds[k];
        let p64 = p.map(f64::from);
        let covered = 1.0 - kind.transmittance;
        let limit = subject.coverage_limit(kind);
        note(
            Property::Background,
            (p64[3] - covered).abs(),
            limit,
            &place,
        );
        let error = (0..3).fold(0.0, |e: f64, c| nan_max(e, (p64[c] - kind.exact[c]).abs()));
        if subject.promises.exact {
            let limit = peelnet_core::tolerance::EXACT * kind.peak;
            note(Property::Exact, error, limit, &place);
        }
        if kind.fragments.len() == 1 {
            // Two sums and a transmittance, each rounded once by the shader and once by the target.
            let limit = (SINGLE + 6.0 * subject.rounding()) * kind.peak;
            note(Property::Single, error, limit, &place);
        }
        if subject.promises.normalised {
            let outside = directions().zip(&supports[k]).map(|(d, &[least, most])| {
                let length = d.iter().map(|x| x * x).sum::<f64>().sqrt();
                let along = dot(d, &p64);
                nan_max(along - most, least - along) / length
            });
            let outside = outside.fold(f64::NEG_INFINITY, nan_max);
            note(Property::Hull, outside, STEP * kind.peak, &place);
        }
        let darkest = kind
            .fragments
            .iter()
            .map(|f| luminance(&f.color.map(f64::from)));
        let darkest = darkest.fold(luminance(&kind.background.map(f64::from)), f64::min);
        let darker = darkest - luminance(&p64);
        note(Property::Dark, darker, STEP * kind.peak, &place);
        if case == "alpha-near-one" {
            let steps = (0..3).map(|c| (display(p[c]) - display(kind.exact[c] as f32)).abs());
            let steps = steps.fold(0.0, nan_max);
            note(Property::Opaque, steps, 1.0, &place);
        }
    }
}

/// What another order of drawing changed.
pub(super) fn compare_orders(
    subject: &Subject,
    truth: &Truth,
    [one, other]: [&Image; 2],
    note: &mut Note<'_>,
) {
    for (i, (a, b)) in one.pixels.iter().zip(&other.pixels).enumerate() {
        let kind = truth.pixels[i].map(|k| &truth.kinds[k as usize]);
        let limit = kind.map_or(0.0, |k| subject.order_limit(k));
        let place = || {
            let name = kind.map_or("no fragment", |k| k.name.as_str());
            format!("{name}, pixel {i}")
        };
        // The colour, as it is displayed.
        let change = (0..3).fold(0.0, |d, c| nan_max(d, f64::from((a[c] - b[c]).abs())));
        note(Property::Order, change, limit, &place);
    }
}

/// What another scale changed, where the exact image is the same in both.
pub(super) fn compare_scales([one, other]: [&Image; 2], exact: [&Image; 2], note: &mut Note<'_>) {
    for i in 0..one.pixels.len() {
        let change = |of: [&Image; 2]| {
            (0..3).fold(0.0, |d, c| {
                let [a, b] = of.map(|image| display(image.pixels[i][c]));
                nan_max(d, (a - b).abs())
            })
        };
        // At a silhouette a scaled triangle may miss a pixel's centre.
        if change(exact) <= 0.1 {
            note(Property::Scale, change([one, other]), 1.0, &|| {
                format!("pixel {i}")
            });
        }
    }
}

/// How much more a frame's pixels jump than the exact image's, on average over those that hold the same surfaces before and
/// after: their exact coverage shows it. Popping is a jump of many pixels at once, where the exact image changes along a line only.
pub(super) fn compare_frames(
    [before, after]: [&Image; 2],
    exact: [&Image; 2],
    note: &mut Note<'_>,
) {
    let (mut excess, mut pixels) = (0.0, 0);
    for i in 0..before.pixels.len() {
        let jump = |of: [&Image; 2]| {
            (0..3).fold(0.0, |d, c| {
                let [a, b] = of.map(|image| f64::from(image.pixels[i][c]));
                nan_max(d, (a - b).abs())
            })
        };
        let [was, is] = exact.map(|image| image.pixels[i][3]);
        if was > 0.0 && (was - is).abs() < 1e-6 {
            excess += jump([before, after]) - jump(exact);
            pixels += 1;
        }
    }
    let mean = excess / f64::from(pixels.max(1));
    note(Property::Steady, mean, STEP, &|| format!("{pixels} pixels"));
}

/// The larger one, and NaN where either is.
fn nan_max(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() {
        f64::NAN
    } else {
        a.max(b)
    }
}

fn display(linear: f32) -> f64 {
    f64::from(peelnet_core::srgb::encode(linear)) * 255.0
}

/// Rec. 709.
fn luminance(c: &[f64]) -> f64 {
    0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]
}

fn dot(d: [f64; 3], c: &[f64]) -> f64 {
    d[0] * c[0] + d[1] * c[1] + d[2] * c[2]
}

/// The thirteen axes of a cube through its faces, edges and corners: a hull is tested from both sides of each.
fn directions() -> impl Iterator<Item = [f64; 3]> {
    // Half of the 26 directions: those whose number lies above that of none.
    (14..27).map(|i: i32| [i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1].map(f64::from))
}

/// Least and largest extent of a pixel's colours along every axis.
fn extents(kind: &Kind) -> Vec<[f64; 2]> {
    let colors = || {
        let seen = kind.fragments.iter().filter(|f| f.alpha > 0.0);
        seen.map(|f| f.color).chain([kind.background])
    };
    directions()
        .map(|d| {
            let along = colors().map(|c| dot(d, &c.map(f64::from)));
            along.fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], x| {
                [lo.min(x), hi.max(x)]
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hull_has_thirteen_axes() {
        let all: Vec<_> = directions().collect();
        assert_eq!(all.len(), 13);
        assert!(all.iter().all(|d| d.iter().any(|x| *x != 0.0)));
        for (i, a) in all.iter().enumerate() {
            assert!(all[..i].iter().all(|b| a != b && *a != b.map(|x| -x)));
        }
    }

    #[test]
    fn the_worst_is_kept_and_a_nan_is_worst() {
        let mut f = Finding::default();
        f.worsen(0.0, 0.0, || "a".into());
        assert!(f.holds() && f.place == "a");
        f.worsen(0.5, 1.0, || "b".into());
        f.worsen(0.2, 1.0, || "c".into());
        assert!(f.holds() && f.place == "b");
        f.worsen(f64::NAN, 1.0, || "d".into());
        f.worsen(3.0, 1.0, || "e".into());
        assert!(!f.holds() && f.place == "d");
        assert_eq!(f.value, f64::INFINITY);
        let mut none_allowed = Finding::default();
        none_allowed.worsen(1e-9, 0.0, || "a".into());
        assert!(!none_allowed.holds());
    }
}
