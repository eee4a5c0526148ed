//! What must hold of a frame, each property with its limit and the reason for it.

use super::{
    subject::Subject,
    trial::{Content, Kind, Trial, Truth},
};
use glam::{DVec3, IVec3, Vec3};
use peelnet_render::{Image, MethodSpec, Property};
use std::collections::BTreeMap;

/// What was found of one property: the value that comes nearest to its limit, or goes farthest beyond it.
#[derive(Clone, Debug, Default)]
pub(super) struct Finding {
    /// The value; infinite where it is not a number.
    pub value: f64,
    pub limit: f64,
    pub place: String,
}

impl Finding {
    pub fn holds(&self) -> bool {
        self.value <= self.limit
    }
}

/// What a case found of every subject and property.
#[derive(Default)]
pub(super) struct Findings {
    pub all: BTreeMap<(usize, Property), Finding>,
    pub subject: usize,
    /// What every place begins with.
    pub scene: String,
}

impl Findings {
    /// Notes a value of a property, the largest that passes, and where it is; the worst is kept.
    pub fn note(
        &mut self,
        property: Property,
        value: f64,
        limit: f64,
        place: impl FnOnce() -> String,
    ) {
        // A NaN is beyond any limit.
        let value = if value.is_nan() { f64::INFINITY } else { value };
        let excess = |value: f64, limit| if value <= 0.0 { 0.0 } else { value / limit };
        let found = self.all.entry((self.subject, property)).or_default();
        if found.place.is_empty() || excess(value, limit) > excess(found.value, found.limit) {
            *found = Finding {
                value,
                limit,
                place: format!("{}{}", self.scene, place()),
            };
        }
    }

    /// Notes whether something is there that must not be.
    pub fn forbid(&mut self, property: Property, is_there: bool, place: impl FnOnce() -> String) {
        self.note(property, f64::from(u8::from(is_there)), 0.0, place);
    }
}

/// A step of an 8-bit display, which the specification grants hulls, scales and what lies behind opaque layers.
const STEP: f64 = 1.0 / 255.0;

/// Of a step of the nearest fragment's colour that one frame is off otherwise than the next, where noise that stands still hides steps: the mean
/// difference of two numbers that are evenly spread over a step is a third of it, and no more is seen of it than the opacity.
const UNSTEADY: f64 = 1.0 / 3.0;

/// Cases where something covers what lies behind it, and by how many steps of an 8-bit display a pixel may be off there: what is behind a nearly
/// opaque rectangle is as good as hidden, and a line among polygons has the two steps that nobody sees.
const OPAQUE_STEPS: [(&str, f64); 2] = [("alpha-near-one", 1.0), ("lines", 2.0)];

/// What a pixel with one fragment may err by, linear light.
const SINGLE: f64 = 1e-4;

/// What coverage may err by where its format allows.
const COVERAGE: f64 = 1.0 / 1024.0;

/// What the order of drawing may change at most, steps of an 8-bit display, whatever the rounding: a change that is larger is a failure to
/// be declared.
const ORDER_STEPS: f64 = 2.0;

/// What images erred by, steps of an 8-bit display, on Mesa's software rasteriser with the shipped networks: a line for each case, whose name is
/// followed by each method's. `PEELNET_UPDATE=1` and the tests of all methods in all cases make it again.
const ERRORS: &str = include_str!("errors.txt");

/// By how much more an image may err: networks that are trained again differ by a fifth, and scrambled ones err twice as much and more.
const MORE: f64 = 1.5;

/// What every image may err by besides, steps of an 8-bit display: roundings of half floats, which adapters do otherwise.
const LEAST_STEPS: f64 = 0.1;

/// The limit of [`Property::Image`]; the largest error there can be of a method that has none in the list.
fn image_limit(method: &MethodSpec, case: &str) -> f64 {
    let mut lines = ERRORS.lines().map(|line| line.split(' '));
    let errors = lines.find_map(|mut line| (line.next() == Some(case)).then_some(line));
    let method = method.to_string();
    let mut errors = errors
        .into_iter()
        .flatten()
        .filter_map(|e| e.rsplit_once('='));
    let found = errors.find_map(|(name, error)| (name == method).then(|| error.parse().ok()));
    found
        .flatten()
        .map_or(255.0, |error: f64| MORE * error + LEAST_STEPS)
}

/// Errors of transmittance that a public harness for moment-based transparency passes: one surface, two layers, sixteen
/// coincident ones. A published method is held to them against the value that its own formula has for exact statistics. The learned
/// networks are held to a fifth, two fifths and half of them, against the exact transmittance.
const TRANSMITTANCE: [(&str, f64, f64); 3] = [
    ("isolated", 5e-3, 1e-3),
    ("two-layers", 0.05, 0.02),
    ("coplanar", 0.01, 5e-3),
];

/// The limit of [`Property::Transmittance`] in a case; `None` in cases without one.
pub(super) fn transmittance_limit(case: &str, subject: &Subject) -> Option<f64> {
    let close = subject.guarantees.close_estimate;
    let found = TRANSMITTANCE.iter().find(|(id, ..)| *id == case);
    let (_, public, least) = found?;
    // It is read from a sum of one term, which rounds as its target does, towards zero on some adapters.
    Some(if close { least } else { public } + 2.0 * subject.rounding())
}

impl Subject {
    /// Limit of the coverage's error: `n` products or sums round once each, and `T = e^−b` errs by the error of `b` times `T`.
    fn coverage_limit(&self, kind: &Kind) -> f64 {
        let n = kind.fragments.len() as f64;
        COVERAGE + (n + 1.0) * self.rounding() * kind.transmittance * kind.absorbance.max(1.0)
    }

    /// What the nearest fragment's colour may be off where it is kept in steps: one of them, of which its opacity is seen.
    fn nearest_step(&self, kind: &Kind) -> f64 {
        let nearest = kind.fragments.first();
        let nearest = nearest.filter(|_| self.guarantees.nearest_in_steps);
        nearest.map_or(0.0, |f| {
            let brightest = f.color.into_iter().fold(0.0, f32::max);
            peelnet_core::methods::one::step(brightest.into()) * f64::from(f.alpha)
        })
    }

    /// Limits of what the order of drawing may change of a colour whose largest component is `shown`, and of the coverage: nothing
    /// where fragments are sorted or compared.
    ///
    /// A sum of `n` terms that are not negative errs by `n` roundings of itself, and so does a product, whatever their order: two
    /// orders differ by twice as much. The colour is a quotient of two sums times `1 − T`, plus `T C_0`: its first part changes by
    /// four times `n` roundings of what it shows, and an error of `T` moves both parts. `1 − T` rounds once more, in 32 bits.
    /// What is reconstructed from statistics adds its own: a share of the absorbance, and `e^−b·share` changes by `b` times as much at most.
    fn order_limits(&self, kind: &Kind, shown: f64) -> [f64; 2] {
        if self.guarantees.sorted {
            return [0.0; 2];
        }
        let n = kind.fragments.len() as f64;
        if !self.guarantees.normalised {
            // A difference of sums, which may be larger than itself.
            return [4.0 * n * self.rounding() * kind.terms(); 2];
        }
        let b = kind.absorbance.max(1.0);
        let one_less = peelnet_core::tolerance::UNIT_ROUNDOFF;
        let product = 2.0 * (n + 1.0) * self.rounding() * kind.transmittance * b + one_less;
        let moved = self.reconstruction(n) * b;
        let color = (4.0 * n * self.rounding() + moved) * shown + product * (kind.mean + shown);
        [color, product]
    }
}

/// The root of the mean squared error of pixels whose fragments are known, steps of an 8-bit display: beyond white nothing differs. `None` where
/// there is none.
fn error(truth: &Truth, image: &Image) -> Option<f64> {
    let (mut squares, mut count) = (0.0, 0);
    for (content, shown) in truth.pixels.iter().zip(&image.pixels) {
        let Content::Kind(k) = *content else { continue };
        let exact = truth.kinds[k as usize].exact;
        for (shown, exact) in shown.iter().zip(exact) {
            squares += (display(*shown) - display(exact as f32)).powi(2);
        }
        count += 3;
    }
    (count > 0).then(|| (squares / f64::from(count)).sqrt())
}

pub(super) fn check(
    subject: &Subject,
    case: &str,
    trial: &Trial,
    truth: &Truth,
    image: &Image,
    findings: &mut Findings,
) {
    let width = image.width as usize;
    let supports: Vec<Vec<[f64; 2]>> = truth.kinds.iter().map(extents).collect();
    if let Some(error) = error(truth, image) {
        let limit = image_limit(&subject.method, case);
        findings.note(Property::Image, error, limit, String::new);
    }
    for ((p, content), i) in image.pixels.iter().zip(&truth.pixels).zip(0..) {
        let place = || {
            let (x, y) = (i % width, i / width);
            format!("{}, pixel ({x}, {y})", truth.name(*content))
        };
        let is_finite = p.iter().all(|c| c.is_finite());
        findings.forbid(Property::Finite, !is_finite, place);
        if !subject.guarantees.per_pixel {
            continue;
        }
        match *content {
            Content::Unjudged => {}
            Content::Nothing => {
                let same = p[..3] == trial.scene.background && p[3] == 0.0;
                findings.forbid(Property::Background, !same, place);
            }
            Content::Kind(k) => {
                let k = k as usize;
                let kind = (&truth.kinds[k], supports[k].as_slice());
                check_pixel(subject, case, kind, p, &place, findings);
            }
        }
    }
}

/// Checks a pixel that holds fragments, each on the scale of what it shows: a bright fragment elsewhere, or one of little opacity,
/// widens no limit. `supports` are the extents of its fragments' colours.
fn check_pixel(
    subject: &Subject,
    case: &str,
    (kind, supports): (&Kind, &[[f64; 2]]),
    p: &[f32; 4],
    place: &dyn Fn() -> String,
    findings: &mut Findings,
) {
    let p64 = p.map(f64::from);
    let covered = 1.0 - kind.transmittance;
    let limit = subject.coverage_limit(kind);
    findings.note(Property::Background, (p64[3] - covered).abs(), limit, place);
    let error = (0..3).fold(0.0, |e: f64, c| nan_max(e, (p64[c] - kind.exact[c]).abs()));
    if subject.guarantees.exact {
        let limit = peelnet_core::tolerance::EXACT * kind.scale() + kind.uncertainty;
        findings.note(Property::Exact, error, limit, place);
    }
    if kind.fragments.len() == 1 {
        // Two sums and a transmittance, each rounded once by the shader and once by the target.
        let limit = (SINGLE + 6.0 * subject.rounding()) * kind.scale() + kind.uncertainty;
        findings.note(Property::Single, error, limit, place);
    }
    if subject.guarantees.normalised {
        // What the fragments show is a mean of their colours times the coverage; C_0 shows through the rest.
        let behind = Vec3::from(kind.background).as_dvec3();
        let own = DVec3::new(p64[0], p64[1], p64[2]) - (1.0 - p64[3]) * behind;
        let outside = directions().zip(supports).map(|(d, &[least, most])| {
            let along = d.dot(own);
            nan_max(along - p64[3] * most, p64[3] * least - along) / d.length()
        });
        let outside = outside.fold(f64::NEG_INFINITY, nan_max);
        let shown = p64[..3].iter().fold(kind.scale(), |m, &c| m.max(c));
        let limit = STEP * shown + subject.nearest_step(kind) + kind.uncertainty;
        findings.note(Property::Hull, outside, limit, place);
    }
    let colors = kind.fragments.iter().map(|f| f.color);
    let luminances = colors.chain([kind.background]);
    let luminances = luminances.map(|c| luminance(&c.map(f64::from)));
    let darkest = luminances.fold(f64::INFINITY, f64::min);
    let limit = STEP * darkest.max(1.0) + kind.uncertainty;
    findings.note(Property::Dark, darkest - luminance(&p64), limit, place);
    if let Some((_, most)) = OPAQUE_STEPS.iter().find(|(id, _)| *id == case) {
        let steps = (0..3).map(|c| (display(p[c]) - display(kind.exact[c] as f32)).abs());
        findings.note(Property::Opaque, steps.fold(0.0, nan_max), *most, place);
    }
}

/// What another order of drawing changed: of the colour in linear light and on the display, and of the coverage.
pub(super) fn compare_orders(
    subject: &Subject,
    truth: &Truth,
    images: [&Image; 2],
    findings: &mut Findings,
) {
    for (i, &content) in truth.pixels.iter().enumerate() {
        let [a, b] = images.map(|image| image.pixels[i]);
        let colors = a[..3].iter().chain(&b[..3]);
        let shown = colors.fold(0.0f32, |m, c| m.max(c.abs()));
        let place = || format!("{}, pixel {i}", truth.name(content));
        // Differences are those of 32-bit numbers.
        let coverage = f64::from((a[3] - b[3]).abs());
        let steps = nan_max(change(images, i, display), 255.0 * coverage);
        findings.note(Property::Order, steps, ORDER_STEPS, place);
        let limits = match content {
            Content::Kind(k) => subject.order_limits(&truth.kinds[k as usize], shown.into()),
            Content::Unjudged if !subject.guarantees.sorted => continue,
            Content::Nothing | Content::Unjudged => [0.0; 2],
        };
        let linear = change(images, i, f64::from);
        for (value, limit) in [linear, coverage].into_iter().zip(limits) {
            findings.note(Property::Order, value, limit, place);
        }
    }
}

/// What another scale changed, where the exact image is the same in both.
pub(super) fn compare_scales(images: [&Image; 2], exact: [&Image; 2], findings: &mut Findings) {
    for i in 0..images[0].pixels.len() {
        // At a silhouette a scaled triangle may miss a pixel's centre.
        if change(exact, i, display) <= 0.1 {
            let steps = change(images, i, display);
            findings.note(Property::Scale, steps, 1.0, || format!("pixel {i}"));
        }
    }
}

/// How much more a frame's pixels jump than the exact image's, on average over those that hold the same surfaces before and
/// after: their exact coverage shows it. Popping is a jump of many pixels at once, where the exact image changes along a line only.
pub(super) fn compare_frames(
    subject: &Subject,
    frames: [&Image; 2],
    exact: [&Image; 2],
    findings: &mut Findings,
) {
    let (mut excess, mut pixels) = (0.0, 0);
    for i in 0..frames[0].pixels.len() {
        let [was, is] = exact.map(|image| image.pixels[i][3]);
        if was > 0.0 && (was - is).abs() < 1e-6 {
            excess += change(frames, i, f64::from) - change(exact, i, f64::from);
            pixels += 1;
        }
    }
    let mean = excess / f64::from(pixels.max(1));
    let mut limit = STEP;
    if subject.guarantees.nearest_in_steps {
        limit += UNSTEADY * peelnet_core::methods::one::step(1.0);
    }
    findings.note(Property::Steady, mean, limit, || format!("{pixels} pixels"));
}

/// The largest change of a channel of a pixel.
fn change(images: [&Image; 2], pixel: usize, value: fn(f32) -> f64) -> f64 {
    (0..3).fold(0.0, |d, c| {
        let [a, b] = images.map(|image| value(image.pixels[pixel][c]));
        nan_max(d, (a - b).abs())
    })
}

/// The larger one, and NaN where either is.
fn nan_max(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() {
        f64::NAN
    } else {
        a.max(b)
    }
}

/// Steps of an 8-bit display, on which nothing differs beyond white.
fn display(linear: f32) -> f64 {
    f64::from(peelnet_core::srgb::encode(linear.clamp(0.0, 1.0))) * 255.0
}

/// Rec. 709.
fn luminance(c: &[f64]) -> f64 {
    0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]
}

/// The thirteen axes of a cube through its faces, edges and corners: a hull is tested from both sides of each.
fn directions() -> impl Iterator<Item = DVec3> {
    // Half of the 26 directions: those whose number lies above that of none.
    (14..27).map(|i: i32| IVec3::new(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1).as_dvec3())
}

/// Least and largest extent of the colours of a pixel's fragments along every axis; 0 of a pixel of which nothing is covered.
fn extents(kind: &Kind) -> Vec<[f64; 2]> {
    let seen = kind.fragments.iter().filter(|f| f.alpha > 0.0);
    let colors = seen.map(|f| Vec3::from(f.color).as_dvec3());
    let extent = |d: DVec3| {
        let along = colors.clone().map(|c| [d.dot(c); 2]);
        let extent = along.reduce(|[lo, hi], [x, _]| [lo.min(x), hi.max(x)]);
        extent.unwrap_or_default()
    };
    directions().map(extent).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use peelnet_core::fragment::Fragment;

    #[test]
    fn limits_of_the_order_are_roundings_and_nothing_where_it_is_sorted() {
        let subject = |method: &str| Subject::new(method.parse().unwrap(), None);
        let kind = |n: usize, radiance: f32| {
            let layers = vec![Fragment::new(2.0, 0.5, [radiance; 3]); n];
            Kind::new(String::new(), layers, [0.5; 3])
        };
        let limits = |method: &str| subject(method).order_limits(&kind(256, 400.0), 400.0);
        let [full, half] = ["f32", "f16"].map(|t| limits(&format!("wboit-eq7:targets={t}"))[0]);
        assert!(half > 100.0 * full, "{half} {full}");
        assert_eq!(limits("abuffer"), [0.0; 2]);
        // Four roundings of what is shown and four of the statistics, four of a transmittance of one half that moves 1 and 1 of light, and so does one
        // of its difference from 1.
        let full = subject("wboit-eq7:targets=f32").order_limits(&kind(1, 1.0), 1.0)[0];
        let expected =
            (4.0 + 4.0 + (4.0 * 0.5 + 1.0) * 2.0) * peelnet_core::tolerance::UNIT_ROUNDOFF;
        assert!((full - expected).abs() < 1e-12, "{full}");
    }

    #[test]
    fn the_worst_is_kept_and_a_nan_is_worst() {
        let mut findings = Findings::default();
        let mut worst = |value, limit, place: &str| {
            findings.note(Property::Hull, value, limit, || place.to_owned());
            let found = &findings.all[&(0, Property::Hull)];
            (found.holds(), found.place.clone(), found.value)
        };
        assert_eq!(worst(0.0, 0.0, "a"), (true, "a".to_owned(), 0.0));
        assert_eq!(worst(0.5, 1.0, "b"), (true, "b".to_owned(), 0.5));
        assert_eq!(worst(0.2, 1.0, "c"), (true, "b".to_owned(), 0.5));
        let nan = (false, "d".to_owned(), f64::INFINITY);
        assert_eq!(worst(f64::NAN, 1.0, "d"), nan);
        assert_eq!(worst(3.0, 1.0, "e"), nan);
        findings.subject = 1;
        findings.note(Property::Hull, 1e-9, 0.0, || "none allowed".to_owned());
        assert!(!findings.all[&(1, Property::Hull)].holds());
    }
}
