//! A method's name with its parameters, parsed once.

use super::{
    method::{Method, Pixel, Promises},
    parameter::{Count, Number, Parameter, Precision, SCALE, Targets, Value, Whole, Word},
};
use crate::error::RenderError;
use peelnet_core::absorbance::DepthWarp;
use peelnet_model::Model;
use std::{cmp::Ordering, collections::BTreeMap, fmt};

/// A method's name with its parameters, such as `wboit-eq10:factor=3e4,targets=f32`. Every value in it is allowed.
#[derive(Clone, Debug)]
pub struct MethodSpec {
    pub(super) method: &'static Method,
    /// The number that the name ends in, where it ends in one.
    pub(super) number: Option<u32>,
    /// By name: the text as it was given, and its value.
    pub(super) values: BTreeMap<&'static str, (String, Value)>,
}

impl MethodSpec {
    /// The method with its parameters' defaults, or with a number in the middle of its curve.
    pub fn representative(method: &'static Method) -> Self {
        // Points of a curve are numbers where the name ends in one; a test parses them.
        let middle = method.curve[method.curve.len() / 2];
        Self {
            method,
            number: method
                .numbered
                .and_then(|_| middle[1..].split(':').next()?.parse().ok()),
            values: BTreeMap::new(),
        }
    }

    /// The method's name without number and parameters.
    pub const fn name(&self) -> &'static str {
        self.method.name
    }

    /// The method's declaration.
    pub const fn method(&self) -> &'static Method {
        self.method
    }

    /// Whether it draws with a trained network.
    pub const fn needs_model(&self) -> bool {
        self.method.learned
    }

    /// The number that the name ends in; 0 where it ends in none.
    pub fn number(&self) -> u32 {
        self.number.unwrap_or_default()
    }

    /// The precision that was asked for of all targets; `None` leaves it to the method.
    pub fn targets(&self) -> Option<Precision> {
        match self.value(Targets::NAME) {
            Some(Value::Targets(precision)) => Some(precision),
            _ => None,
        }
    }

    /// Whether transparency is drawn at a lower resolution: pixels then mix their neighbours' fragments.
    pub fn is_scaled(&self) -> bool {
        SCALE.of(self) < 1.0
    }

    /// What the method promises with these parameters.
    pub fn promises(&self) -> Promises {
        let own = (self.method.promises)(self);
        let scaled = self.is_scaled();
        Promises {
            exact: own.exact && !scaled,
            per_pixel: own.per_pixel && !scaled,
            normalised: own.normalised && !scaled,
            tinted: own.tinted && !scaled,
            sums: self.targets().unwrap_or(own.sums),
            statistics: self.targets().unwrap_or(own.statistics),
            ..own
        }
    }

    /// The colour that a pixel must have, by the method's CPU twin; `None` where it has none: at a lower resolution, and for a
    /// learned method without a model.
    pub fn twin(&self, pixel: &Pixel<'_>) -> Option<[f32; 3]> {
        let twin = self.method.twin.filter(|_| !self.is_scaled())?;
        twin(self, pixel)
    }

    /// The transmittance in front of each of a pixel's fragments that the method's weights stand for, in 64 bits by the CPU
    /// twin. Fragments are (linear depth, α), nearest first. `None` where the weights are no transmittance, at a lower
    /// resolution, and for a learned method without a model.
    pub fn transmittances(
        &self,
        fragments: &[(f32, f32)],
        warp: &DepthWarp,
        model: Option<&Model>,
    ) -> Option<Vec<f64>> {
        let estimate = self.method.transmittances.filter(|_| !self.is_scaled())?;
        estimate(self, fragments, warp, model)
    }

    /// The same method with one more parameter, or another value of it.
    ///
    /// # Errors
    /// A parameter that the method does not have, or a value it cannot take.
    pub fn with(&self, name: &str, value: &str) -> Result<Self, RenderError> {
        let mut changed = self.clone();
        changed.set(name, value)?;
        Ok(changed)
    }

    pub(super) fn value(&self, name: &str) -> Option<Value> {
        self.values.get(name).map(|(_, value)| *value)
    }

    pub(super) fn set(&mut self, name: &str, text: &str) -> Result<(), RenderError> {
        let all = || self.method.all_parameters();
        let Some(parameter) = all().find(|p| p.name() == name) else {
            let known: Vec<String> = all()
                .map(|p| format!("{} ({})", p.name(), p.about()))
                .collect();
            return Err(self.bad(format!(
                "there is no parameter '{name}'; there are: {}",
                known.join(", ")
            )));
        };
        let Some(value) = parameter.parse(text) else {
            let allowed = parameter.allowed();
            return Err(self.bad(format!("{name} must be {allowed}, not '{text}'")));
        };
        self.values
            .insert(parameter.name(), (text.to_owned(), value));
        Ok(())
    }

    pub(super) fn bad(&self, message: String) -> RenderError {
        RenderError::Parameter {
            method: self.name().to_owned(),
            message,
        }
    }

    /// What makes it itself: two specifications with the same text are the same.
    fn key(
        &self,
    ) -> (
        &'static str,
        Option<u32>,
        impl Iterator<Item = (&str, &str)>,
    ) {
        let values = self.values.iter();
        let texts = values.map(|(name, (text, _))| (*name, text.as_str()));
        (self.name(), self.number, texts)
    }
}

impl PartialEq for MethodSpec {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for MethodSpec {}

impl PartialOrd for MethodSpec {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for MethodSpec {
    fn cmp(&self, other: &Self) -> Ordering {
        let ((name, number, values), (name_2, number_2, values_2)) = (self.key(), other.key());
        (name, number)
            .cmp(&(name_2, number_2))
            .then_with(|| values.cmp(values_2))
    }
}

impl fmt::Display for MethodSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())?;
        if let Some(number) = self.number {
            write!(f, "-{number}")?;
        }
        for (i, (name, (text, _))) in self.values.iter().enumerate() {
            write!(f, "{}{name}={text}", if i == 0 { ':' } else { ',' })?;
        }
        Ok(())
    }
}

impl Number {
    /// The value that was given.
    pub fn given(&self, spec: &MethodSpec) -> Option<f64> {
        match spec.value(self.name) {
            Some(Value::Number(x)) => Some(x),
            _ => None,
        }
    }

    /// The value, or the default.
    pub fn of(&self, spec: &MethodSpec) -> f64 {
        self.given(spec).unwrap_or(self.default)
    }
}

impl Whole {
    /// The value, or the default.
    pub fn of(&self, spec: &MethodSpec) -> u32 {
        match spec.value(self.name) {
            // Parsing checked that it is at most `most`.
            Some(Value::Whole(n)) => n as u32,
            _ => self.default,
        }
    }
}

impl Count {
    /// The value that was given.
    pub fn given(&self, spec: &MethodSpec) -> Option<u64> {
        match spec.value(self.name) {
            Some(Value::Whole(n)) => Some(n),
            _ => None,
        }
    }
}

impl Word {
    /// The word, or the default.
    pub fn of(&self, spec: &MethodSpec) -> &'static str {
        match spec.value(self.name) {
            Some(Value::Word(word)) => word,
            _ => self.words[0],
        }
    }
}

impl Method {
    /// Its parameters: its own, and those that every method has.
    pub fn all_parameters(&self) -> impl Iterator<Item = Parameter> {
        let own = self.parameters.iter().copied();
        own.chain([Parameter::Number(SCALE)])
    }

    /// Whether the precision of its targets can be chosen.
    pub fn has_targets(&self) -> bool {
        let mut all = self.parameters.iter();
        all.any(|p| matches!(p, Parameter::Targets(_)))
    }

    /// Its name as it is written, `-N` where a number follows.
    pub fn usage(&self) -> String {
        let ending = if self.numbered.is_some() { "-N" } else { "" };
        format!("{}{ending}", self.name)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failing test may panic")]
    use super::*;
    use crate::methods::METHODS;

    #[test]
    fn names_and_parameters_round_trip() {
        for text in [
            "abuffer",
            "wboit-eq10:factor=3e4,targets=f32",
            "deep-thesis:targets=f32",
            "kbuffer-8",
            "hybrid-4:weight=eq7",
        ] {
            assert_eq!(text.parse::<MethodSpec>().unwrap().to_string(), text);
        }
    }

    #[test]
    fn unknown_names_and_parameters_are_refused_with_those_there_are() {
        let e = "wbiot".parse::<MethodSpec>().unwrap_err().to_string();
        assert!(e.contains("wboit-eq9"), "{e}");
        let e = "abuffer:targets=f32".parse::<MethodSpec>().unwrap_err();
        assert!(e.to_string().contains("budget"), "{e}");
    }

    /// A value that is not allowed is refused when it is parsed; the message names parameter, value and what is allowed.
    #[test]
    fn values_are_checked() {
        for (text, allowed) in [
            ("depth-peel:passes=0", "a whole number from 1 to 1048576"),
            ("blended:targets=f64", "f16 or f32"),
            ("mboit4:own=maybe", "in or out"),
            ("wavelet-3:own=", "out or in"),
            (
                "depth-peel:passes=1048577",
                "a whole number from 1 to 1048576",
            ),
            (
                "abuffer:budget=4294967297",
                "a whole number from 1 to 4294967296",
            ),
            (
                "wboit-eq10:factor=inf",
                "a number above 0 and at most 1000000000",
            ),
            (
                "wboit-eq10:factor=-1",
                "a number above 0 and at most 1000000000",
            ),
            (
                "wboit-inverse-power:epsilon=0",
                "a number above 0 and at most 1000000000",
            ),
            ("mboit4:bias=1e30", "a number from 0 to 1"),
            ("mboit6:bias=-1e-9", "a number from 0 to 1"),
            ("mboit4:overestimation=-5", "a number from 0 to 1"),
            ("mboit4:overestimation=NaN", "a number from 0 to 1"),
            ("wboit-inverse-power:k=17", "a whole number from 0 to 16"),
            ("abuffer:scale=0", "a number above 0 and at most 1"),
            ("abuffer:scale=nan", "a number above 0 and at most 1"),
        ] {
            let e = text.parse::<MethodSpec>().unwrap_err().to_string();
            let (name, value) = text.split_once(':').unwrap().1.split_once('=').unwrap();
            let want = format!("{name} must be {allowed}, not '{value}'");
            assert!(e.ends_with(&want), "{e} does not end with {want}");
        }
    }

    #[test]
    fn a_parameter_that_is_given_twice_is_refused() {
        for text in [
            "mboit4:bias=1e-6,bias=2",
            "mboit4:bias=1e-6,own=out,bias=1e-6",
        ] {
            let e = text.parse::<MethodSpec>().unwrap_err().to_string();
            assert!(
                e.contains("mboit4") && e.contains("bias is given twice"),
                "{e}"
            );
        }
    }

    /// Promises and flaws belong to what a name resolves to, not to how it is spelled.
    #[test]
    fn a_bare_name_and_its_explicit_spelling_declare_the_same_flaws() {
        let mut compared = 0;
        for method in METHODS {
            let bare = MethodSpec::representative(method);
            let mut spellings = Vec::new();
            for parameter in method.all_parameters() {
                let values = match parameter {
                    Parameter::Number(p) => vec![p.default.to_string()],
                    Parameter::Whole(p) => vec![p.default.to_string()],
                    Parameter::Word(p) => vec![p.words[0].to_owned()],
                    Parameter::Targets(_) => Targets::WORDS.map(|(word, _)| word.to_owned()).into(),
                    // Without a value there is no limit.
                    Parameter::Count(_) => continue,
                };
                let with = |value: &String| bare.with(parameter.name(), value).unwrap();
                spellings.extend(values.iter().map(with));
            }
            for spelled in spellings {
                // Of the precisions, one or none is the default.
                if spelled.targets().is_some() && spelled.promises() != bare.promises() {
                    continue;
                }
                assert_eq!(spelled.promises(), bare.promises(), "{spelled}");
                for flaw in method.flaws {
                    assert_eq!(
                        (flaw.when)(&spelled),
                        (flaw.when)(&bare),
                        "{spelled}: {}",
                        flaw.reason
                    );
                }
                compared += 1;
            }
        }
        assert!(compared > METHODS.len());
    }

    #[test]
    fn every_point_of_every_curve_parses() {
        let points: usize = METHODS.iter().map(|m| m.curve.len()).sum();
        assert_eq!(MethodSpec::compared().len(), points);
        for method in METHODS {
            let one = MethodSpec::representative(method).to_string();
            assert_eq!(one.parse::<MethodSpec>().unwrap().to_string(), one);
        }
    }

    #[test]
    fn numbers_are_checked() {
        for bad in ["kbuffer", "kbuffer-", "kbuffer-0", "kbuffer-65", "mboit4-2"] {
            assert!(bad.parse::<MethodSpec>().is_err(), "{bad}");
        }
        let e = "kbuffer-900".parse::<MethodSpec>().unwrap_err().to_string();
        assert!(e.contains("1 to 64"), "{e}");
        let e = "stochastic-9".parse::<MethodSpec>().unwrap_err();
        assert!(e.to_string().contains("8 or 16"), "{e}");
    }

    /// Parameters have one name, and their defaults are allowed values.
    #[test]
    fn declarations_are_sound() {
        let mut names: Vec<_> = METHODS.iter().map(|m| m.name).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), METHODS.len());
        for method in METHODS {
            let mut names: Vec<_> = method.all_parameters().map(|p| p.name()).collect();
            names.sort_unstable();
            names.dedup();
            assert_eq!(names.len(), method.parameters.len() + 1, "{}", method.name);
            for parameter in method.all_parameters() {
                let default = match parameter {
                    Parameter::Number(p) => p.default.to_string(),
                    Parameter::Whole(p) => p.default.to_string(),
                    Parameter::Word(p) => p.words[0].to_owned(),
                    Parameter::Count(_) | Parameter::Targets(_) => continue,
                };
                let at = format!("{} of {}", parameter.name(), method.name);
                assert!(parameter.parse(&default).is_some(), "{at}: {default}");
            }
        }
    }

    /// What a parameter changes of the promises.
    #[test]
    fn promises_depend_on_parameters() {
        let of = |text: &str| text.parse::<MethodSpec>().unwrap().promises();
        assert!(of("depth-peel").exact && !of("depth-peel:passes=2").exact);
        assert!(of("abuffer").tinted && !of("abuffer:scale=0.5").exact);
        assert!(of("painter-object").sorted && !of("painter-object:sort=off").order_independent);
        assert_eq!(of("mboit4").statistics, Precision::Full);
        assert_eq!(of("mboit4").sums, Precision::Half);
        assert_eq!(of("mboit4:targets=f16").statistics, Precision::Half);
        assert_eq!(of("blended:targets=f32").sums, Precision::Full);
    }
}
