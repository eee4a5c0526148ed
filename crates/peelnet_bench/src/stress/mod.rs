//! Stress cases: every method drawn where transparency is known to break, and what must hold of it there.
//!
//! [`CASES`] makes the scenes, [`Property`] says what must hold, with its limit, and each method's declaration what is known not to ([`KnownFailure`]).
//! [`stress`] draws a case with a list of methods and gives a [`Row`] for each method and property.
//!
//! ```text
//! case ─► trials (scene, and the fragments of its pixels: known, or found by the 64-bit reference)
//!           ├─► exact frames
//!           └─► each method's frames: as listed, reversed, shuffled, scaled, moved ─► findings ─► rows
//! ```

mod catalogue;
pub mod ground_truth;
mod network;
mod properties;
mod subject;
mod trial;

pub use catalogue::CASES;
pub use peelnet_render::Property;
pub use subject::Subject;

pub use crate::records::{Outcome, StressRow as Row, Stressed};

use crate::{
    EvalError,
    compare::{EXACT, image_name},
    stage::{Stage, exact_method},
};
use peelnet_core::files::counted;
use peelnet_export::ExportError;
use peelnet_model::Model;
use peelnet_render::gpu::{
    Gpu,
    wgpu::{AdapterInfo, Backend, DeviceType},
};
use peelnet_render::{Image, KnownFailure, LearnedWeight, MethodOptions, MethodSpec, Submission};
use peelnet_scene::Scene;
use properties::Findings;
use std::path::Path;
use trial::{Content, Trial, Truth};

#[derive(Debug)]
pub struct Case {
    pub id: &'static str,
    pub what: &'static str,
    pub breaks: &'static str,
    work: Work,
}

#[derive(Debug)]
enum Work {
    Frames(fn() -> Vec<Trial>),
    /// Scenes are drawn, by exact methods that take a fixed number of passes.
    Deep(fn() -> Vec<Trial>),
    /// The network itself is evaluated, of learned methods only.
    Network(Examine),
}

type Examine = fn(&Gpu, &(LearnedWeight, Model), &mut Findings) -> Result<(), ExportError>;

impl Case {
    pub fn applies_to(&self, method: &MethodSpec) -> bool {
        match self.work {
            Work::Frames(_) => true,
            Work::Deep(_) => method.guarantees().exact && !method.guarantees().peels,
            Work::Network(_) => method.needs_model(),
        }
    }
}

impl Stressed {
    pub fn rows_with(&self, result: Outcome) -> impl Iterator<Item = &Row> {
        self.rows.iter().filter(move |r| r.result == result)
    }

    pub fn summary(&self) -> String {
        let count = |outcome| self.rows_with(outcome).count() as u64;
        let pass = match count(Outcome::Pass) {
            1 => "1 property holds".to_owned(),
            n => format!("{n} properties hold"),
        };
        let declared = counted(count(Outcome::Declared), "known failure");
        let fail = counted(count(Outcome::Fail), "failure");
        format!("{pass}, {declared}, {fail}")
    }
}

/// Orders of drawing beside the scene's own.
const ORDERS: [Submission; 2] = [Submission::Reversed, Submission::Shuffled(7)];

/// Factors of [`Property::Scale`].
const SCALES: [f32; 2] = [1e-3, 1e3];

/// Draws a case with every subject and checks what is seen; `notify` gets the name of every subject before it is drawn, and may end the
/// run. With `strict`, a failure that is known and does not occur is a failure: meant for shipped networks, not for a user's own,
/// and for Mesa's software rasteriser, where failures were listed; other adapters round otherwise. Pictures of what fails are saved in the folder `images`, beside the exact ones.
pub fn stress(
    gpu: &Gpu,
    case: &Case,
    subjects: &[Subject],
    strict: bool,
    images: Option<&Path>,
    notify: &mut dyn FnMut(&str) -> Result<(), EvalError>,
) -> Result<Vec<Row>, EvalError> {
    let checked = subjects.iter().filter(|s| case.applies_to(&s.method));
    let subjects: Vec<&Subject> = checked.collect();
    let mut findings = Findings::default();
    // Of every trial its name, the exact image, and every subject's.
    let mut drawn: Vec<(String, Vec<Image>)> = Vec::new();
    let names: Vec<String> = subjects.iter().map(|s| s.method.to_string()).collect();
    let mut trials = Vec::new();
    match case.work {
        Work::Frames(make) | Work::Deep(make) => trials = make(),
        Work::Network(examine) => {
            for (i, subject) in subjects.iter().enumerate() {
                notify(&names[i])?;
                findings.subject = i;
                if let Some(network) = &subject.learned {
                    let examined = examine(gpu, network, &mut findings);
                    examined.map_err(EvalError::at(format!("the network of {}", names[i])))?;
                }
            }
        }
    }
    for (trial, number) in trials.iter().zip(0..) {
        let scaled = SCALES.map(|s| trial.scene.scaled(s));
        let mut stand = Stand::new(gpu, trial, &scaled)?;
        let scene = format!("{}-{number}-{}", case.id, trial.scene.name);
        findings.scene = format!("{}: ", trial.scene.name);
        let mut frames = vec![stand.exact[0].clone()];
        for (i, subject) in subjects.iter().enumerate() {
            notify(&names[i])?;
            findings.subject = i;
            let image = stand.draw(subject, case, &mut findings)?;
            // Trials that move are a sequence.
            let moves = trial.moves && subject.guarantees.per_pixel;
            if let (true, Some((_, before))) = (moves, drawn.last()) {
                let moved = [&before[1 + i], &image];
                properties::compare_frames(
                    subject,
                    moved,
                    [&before[0], &stand.exact[0]],
                    &mut findings,
                );
            }
            frames.push(image);
        }
        drawn.push((scene, frames));
    }
    let rows = rows(case, &subjects, &findings, strict, &gpu.info);
    let Some(folder) = images else {
        return Ok(rows);
    };
    for (scene, frames) in &drawn {
        let methods = [EXACT].into_iter().chain(names.iter().map(String::as_str));
        for (k, (method, image)) in methods.zip(frames).enumerate() {
            // The exact image where any method fails.
            let fails = |r: &Row| r.result == Outcome::Fail && (k == 0 || r.method == method);
            if rows.iter().any(fails) {
                let saved = image.save(&folder.join(image_name(scene, method)));
                saved.map_err(EvalError::render(scene, method))?;
            }
        }
    }
    Ok(rows)
}

fn rows(
    case: &Case,
    subjects: &[&Subject],
    findings: &Findings,
    strict: bool,
    adapter: &AdapterInfo,
) -> Vec<Row> {
    let all = findings.all.iter();
    all.map(|(&(i, property), finding)| {
        let method = &subjects[i].method;
        let failure = KnownFailure::find(method, case.id, property, is_llvmpipe(adapter));
        let (result, reason) = match (finding.holds(), failure) {
            (true, Some(failure)) if strict && is_llvmpipe(adapter) => {
                let reason = format!("holds, but is a known failure: {}", failure.reason);
                (Outcome::Fail, Some(reason))
            }
            (true, _) => (Outcome::Pass, None),
            (false, Some(failure)) => (Outcome::Declared, Some(failure.reason.to_owned())),
            (false, None) => (Outcome::Fail, None),
        };
        Row {
            method: method.to_string(),
            case: case.id.to_owned(),
            property,
            result,
            value: finding.value.is_finite().then_some(finding.value),
            limit: finding.limit,
            place: finding.place.clone(),
            reason,
        }
    })
    .collect()
}

fn is_llvmpipe(info: &AdapterInfo) -> bool {
    let kind = (info.backend, info.device_type);
    let driver = format!("{} {}", info.driver, info.driver_info).to_lowercase();
    kind == (Backend::Vulkan, DeviceType::Cpu) && driver.contains("llvmpipe")
}

/// A trial made ready to be drawn with any method.
struct Stand<'a> {
    trial: &'a Trial,
    truth: Truth,
    stage: Stage<'a>,
    /// Of every view.
    exact: Vec<Image>,
    /// The scene at other scales, with the exact image.
    scaled: Vec<(Stage<'a>, Image)>,
    gpu: &'a Gpu,
}

impl<'a> Stand<'a> {
    fn new(gpu: &'a Gpu, trial: &'a Trial, scaled: &'a [Scene]) -> Result<Self, EvalError> {
        let options = MethodOptions::sized(trial.size);
        let scaled = scaled.iter().map(|scene| {
            let stage = Stage::new(gpu, scene)?;
            let exact = stage.draw(&exact_method(), options.clone(), &scene.views[0])?;
            Ok((stage, exact))
        });
        let scaled = scaled.collect::<Result<_, EvalError>>()?;
        let stage = Stage::new(gpu, &trial.scene)?;
        let mut ready = stage.ready(&exact_method(), options)?;
        let exact = trial.scene.views.iter();
        let exact = exact.map(|camera| Ok(stage.image(&mut ready, camera)?.image));
        let exact = exact.collect::<Result<_, EvalError>>()?;
        Ok(Self {
            truth: trial.truth(),
            exact,
            stage,
            scaled,
            trial,
            gpu,
        })
    }

    fn options(&self, subject: &Subject) -> MethodOptions {
        let learned = subject.learned.as_ref().map(|(text, _)| text);
        MethodOptions::sized(self.trial.size).with(learned)
    }

    /// Draws a subject in every way that its properties ask for; gives the first view's frame.
    fn draw(
        &mut self,
        subject: &Subject,
        case: &Case,
        findings: &mut Findings,
    ) -> Result<Image, EvalError> {
        let views = &self.trial.scene.views;
        let (method, options) = (&subject.method, self.options(subject));
        let mut ready = self.stage.ready(method, options.clone())?;
        let first = self.stage.image(&mut ready, &views[0])?.image;
        properties::check(subject, case.id, self.trial, &self.truth, &first, findings);
        let mut last = first.clone();
        for (k, camera) in views.iter().enumerate().skip(1) {
            let next = self.stage.image(&mut ready, camera)?.image;
            if subject.guarantees.per_pixel {
                let exact = [&self.exact[k - 1], &self.exact[k]];
                properties::compare_frames(subject, [&last, &next], exact, findings);
            }
            last = next;
        }
        if subject.guarantees.order_independent && subject.guarantees.per_pixel {
            for order in ORDERS {
                self.stage.renderer.submit(order);
                let other = self.stage.image(&mut ready, &views[0])?.image;
                properties::compare_orders(subject, &self.truth, [&first, &other], findings);
            }
            self.stage.renderer.submit(Submission::Listed);
        }
        if subject.guarantees.per_pixel {
            for (stage, exact_scaled) in &self.scaled {
                let other = stage.draw(method, options.clone(), &stage.scene.views[0])?;
                let exact = [&self.exact[0], exact_scaled];
                properties::compare_scales([&first, &other], exact, findings);
            }
        }
        self.transmittance(subject, case, findings)?;
        Ok(first)
    }

    /// The transmittance that the weights stand for, as the shaders draw it: a frame of the sums that they blend, in which fragments are
    /// red, green or blue, holds `α T̂` of each.
    fn transmittance(
        &self,
        subject: &Subject,
        case: &Case,
        findings: &mut Findings,
    ) -> Result<(), EvalError> {
        let limit = properties::transmittance_limit(case.id, subject);
        let is_estimate = subject.method.method().expectations.estimate.is_some();
        let (Some(limit), true, Some((scene, shown))) = (limit, is_estimate, self.trial.probe())
        else {
            return Ok(());
        };
        let stage = Stage::new(self.gpu, &scene)?;
        let mut options = self.options(subject);
        options.shows = peelnet_render::passes::views::Shows::Sums;
        let sums = stage.draw(&subject.method, options, &scene.views[0])?;
        for (content, sum) in self.truth.pixels.iter().zip(&sums.pixels) {
            let Content::Kind(k) = *content else {
                continue;
            };
            let kind = &self.truth.kinds[k as usize];
            for (i, sum) in shown[k as usize].iter().zip(sum) {
                let Some(i) = *i else { continue };
                let found = f64::from(*sum) / f64::from(kind.fragments[i].alpha);
                let error = (found - kind.transmittance_at(i, subject.guarantees.own_share)).abs();
                findings.note(Property::Transmittance, error, limit, || {
                    format!("{}, at depth {}", kind.name, kind.fragments[i].depth)
                });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    /// Every known failure names cases that exist, and belongs to at least one of the methods that run.
    #[test]
    fn known_failures_are_of_cases_and_methods_that_run() {
        // Those of a full run, and points of curves, which `peelnet stress --methods` draws.
        let mut run = Subject::all_methods();
        run.extend(peelnet_render::MethodSpec::curve());
        for method in peelnet_render::METHODS {
            for failure in method.expectations.known_failures {
                let at = format!("{} of {}", failure.property, method.name);
                for case in failure.cases() {
                    assert!(CASES.iter().any(|c| c.id == case), "{at}: {case}");
                }
                let mut of_method = run.iter().filter(|m| m.name() == method.name);
                assert!(of_method.any(failure.when), "{at} is never seen");
                assert!(failure.reason.len() > 10, "{at}");
            }
        }
    }
}
