//! Every method: one home each, a module that declares a [`Method`] and draws it behind [`Compositor`].
//!
//! [`METHODS`] lists the declarations; names, help texts, benchmarks, hard cases and tests are made from them. [`MethodSpec`] is a
//! method's name with its parameters, parsed. CONTRIBUTING.md adds a method step by step.

pub mod abuffer;
mod anchored;
mod avboit;
mod bins;
mod blended;
mod commutative;
pub(crate) mod compositor;
mod deep_thesis;
pub mod depth_peel;
mod dfaoit;
pub mod dual_peel;
mod kbuffer;
pub mod layers;
mod learned;
mod linked_list;
mod low_resolution;
mod mboit;
mod mboit_trig;
pub(crate) mod method;
mod mlab;
mod nmt;
mod painter;
pub(crate) mod parameter;
mod peeling;
mod range;
mod slabs;
pub(crate) mod spec;
mod stochastic;
mod stored;
pub mod surfaces;
mod wavelet;
mod wboit;
mod weighted;
mod weighted_average;
mod weighted_sum;

pub use compositor::{Compositor, DrawContext, Fit, FrameStats, Learning};
pub use method::{Estimate, Method, Numbered, Pixel, Promises, Role, Twin};
pub use parameter::{Count, Number, Parameter, Precision, SCALE, Targets, Whole, Word};
pub use spec::MethodSpec;

use crate::error::RenderError;
use compositor::Build;
use std::{collections::BTreeMap, str::FromStr};

/// Every method, in the order of lists and reports.
pub const METHODS: &[Method] = &[
    abuffer::METHOD,
    linked_list::METHOD,
    depth_peel::METHOD,
    dual_peel::METHOD,
    painter::OBJECTS,
    painter::TRIANGLES,
    weighted_sum::METHOD,
    weighted_average::METHOD,
    blended::METHOD,
    wboit::EQ7,
    wboit::EQ8,
    wboit::EQ9,
    wboit::EQ10,
    wboit::PAPAKOSTAS,
    wboit::INVERSE_POWER,
    wboit::SMOKE,
    mboit::FOUR,
    mboit::SIX,
    mboit::EIGHT,
    mboit_trig::METHOD,
    wavelet::METHOD,
    bins::METHOD,
    avboit::METHOD,
    kbuffer::PLAIN,
    kbuffer::HYBRID,
    mlab::METHOD,
    slabs::METHOD,
    stochastic::METHOD,
    deep_thesis::METHOD,
    nmt::METHOD,
    dfaoit::METHOD,
    slabs::SMALL,
    slabs::MEDIUM,
    slabs::LARGE,
    anchored::SMALL,
    anchored::MEDIUM,
];

impl MethodSpec {
    /// Every method that draws on the GPU without a model, with its default parameters.
    pub fn all() -> Vec<Self> {
        METHODS
            .iter()
            .filter(|m| !m.learned && m.cpu_only.is_none())
            .filter_map(|m| Self::points(m).next())
            .collect()
    }

    /// Every method that draws on the GPU, with the parameters that belong to its curve of error against time.
    pub fn curve() -> Vec<Self> {
        let drawn = METHODS.iter().filter(|m| m.cpu_only.is_none());
        drawn.flat_map(Self::points).collect()
    }

    /// What a comparison of all methods measures: [`MethodSpec::curve`], and the methods of which only the error can be known.
    pub fn compared() -> Vec<Self> {
        METHODS.iter().flat_map(Self::points).collect()
    }

    /// The points of one method's curve, the default first.
    pub fn points(method: &'static Method) -> impl Iterator<Item = Self> {
        let name = method.name;
        // A test parses them all.
        method
            .curve
            .iter()
            .filter_map(move |ending| format!("{name}{ending}").parse().ok())
    }
}

impl FromStr for MethodSpec {
    type Err = RenderError;

    fn from_str(text: &str) -> Result<Self, RenderError> {
        let (name, parameters) = text.split_once(':').unwrap_or((text, ""));
        let of = |name: &str, numbered: bool| {
            METHODS
                .iter()
                .find(|m| m.name == name && m.numbered.is_some() == numbered)
        };
        let numbered = || {
            let (name, number) = name.rsplit_once('-')?;
            Some((of(name, true)?, number))
        };
        let (method, number) = match (of(name, false), numbered()) {
            (Some(method), _) => (method, None),
            (None, Some((method, number))) => (method, Some(number)),
            (None, None) => return Err(unknown(name)),
        };
        let mut spec = Self {
            method,
            number: None,
            values: BTreeMap::new(),
        };
        if let (Some(numbered), Some(text)) = (method.numbered, number) {
            spec.number = Some(numbered.parse(method.name, text).map_err(|e| spec.bad(e))?);
        }
        for pair in parameters.split(',').filter(|p| !p.is_empty()) {
            let (name, value) = pair.split_once('=').unwrap_or((pair, ""));
            if spec.values.contains_key(name) {
                return Err(spec.bad(format!("{name} is given twice; give it once")));
            }
            spec.set(name, value)?;
        }
        Ok(spec)
    }
}

fn unknown(name: &str) -> RenderError {
    let known: Vec<String> = METHODS.iter().map(Method::usage).collect();
    RenderError::UnknownMethod {
        name: name.to_owned(),
        known: known.join(", "),
    }
}

impl Role {
    /// The method that has it, with its parameters: the text of a [`MethodSpec`].
    ///
    /// # Panics
    /// If no method declares the role: then constants made of it do not compile.
    pub const fn method(self) -> &'static str {
        let mut i = 0;
        // Constants are computed with loops.
        while i < METHODS.len() {
            let mut k = 0;
            while k < METHODS[i].roles.len() {
                let (role, spec) = METHODS[i].roles[k];
                if role as u8 == self as u8 {
                    return spec;
                }
                k += 1;
            }
            i += 1;
        }
        panic!("a role that no method declares")
    }
}

/// The methods that draw light which takes a colour where it passes, for messages.
fn tinted() -> String {
    let tinted = METHODS.iter().filter(|m| m.is_tinted());
    tinted.map(Method::usage).collect::<Vec<_>>().join(", ")
}

/// Makes a method ready.
pub(crate) fn build(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    let spec = b.spec;
    let promises = (spec.method().promises)(spec);
    // A scene's scale concerns estimates; the methods that judge them stay exact unless they are asked for a scale themselves.
    let default = if spec.method().is_exact() {
        1.0
    } else {
        b.scene.transparency_scale
    };
    let scale = SCALE.given(spec).map_or(default, |s| s as f32);
    if b.scene.tinted && (!promises.tinted || scale < 1.0) {
        return Err(RenderError::OneTransmittance {
            method: spec.to_string(),
            tinted: tinted(),
        });
    }
    if scale < 1.0 {
        low_resolution::build(b, scale)
    } else {
        (spec.method().build)(b)
    }
}
