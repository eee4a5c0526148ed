//! Methods by their names: parsing, and what a name with its parameters stands for.

use super::{
    METHODS,
    expectations::{Guarantees, Pixel},
    method::Method,
    spec::MethodSpec,
};
use crate::RenderError;
use peelnet_core::{absorbance::DepthWarp, files::known_names};
use peelnet_model::Model;
use std::{collections::BTreeMap, str::FromStr};

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
        let endings = method.curve.iter();
        // A test parses them all.
        endings.filter_map(|ending| format!("{}{ending}", method.name).parse().ok())
    }

    /// The method with its parameters' defaults, or with a number in the middle of its curve.
    pub fn representative(method: &'static Method) -> Self {
        // Points of a curve are numbers where the name ends in one; a test parses them.
        let middle = method.curve[method.curve.len() / 2];
        Self {
            name: method.name,
            number: method
                .numbered
                .and_then(|_| middle[1..].split(':').next()?.parse().ok()),
            values: BTreeMap::new(),
        }
    }

    /// The method's declaration.
    pub fn method(&self) -> &'static Method {
        let found = METHODS.iter().find(|m| m.name == self.name);
        found.expect("a specification has the name of a method")
    }

    /// Whether it draws with a trained network.
    pub fn needs_model(&self) -> bool {
        self.method().learned
    }

    /// What the method guarantees with these parameters.
    pub fn guarantees(&self) -> Guarantees {
        let own = (self.method().expectations.guarantees)(self);
        let scaled = self.is_scaled();
        Guarantees {
            exact: own.exact && !scaled,
            per_pixel: own.per_pixel && !scaled,
            normalised: own.normalised && !scaled,
            tinted: own.tinted && !scaled,
            sums: self.targets().unwrap_or(own.sums),
            statistics: self.targets().unwrap_or(own.statistics),
            ..own
        }
    }

    /// The colour that a pixel must have, by the method's CPU reference; `None` where it has none: at a lower resolution, and
    /// for a learned method without a model.
    pub fn reference(&self, pixel: &Pixel<'_>) -> Option<[f32; 3]> {
        let reference = self.method().expectations.reference;
        reference.filter(|_| !self.is_scaled())?(self, pixel)
    }

    /// The transmittance in front of each of a pixel's fragments that the method's weights stand for, in 64 bits by the CPU
    /// reference. Fragments are (linear depth, α), nearest first. `None` where the weights are no transmittance, at a lower
    /// resolution, and for a learned method without a model.
    pub fn transmittances(
        &self,
        fragments: &[(f32, f32)],
        warp: &DepthWarp,
        model: Option<&Model>,
    ) -> Option<Vec<f64>> {
        let estimate = self.method().expectations.estimate;
        let estimate = estimate.filter(|_| !self.is_scaled())?;
        estimate(self, fragments, warp, model)
    }

    /// Whether both are drawn alike, however their values are spelled and whether defaults are given.
    pub fn is_drawn_as(&self, other: &Self) -> bool {
        let mut parameters = self.method().all_parameters();
        (self.name, self.number) == (other.name, other.number)
            // Their precision.
            && self.guarantees() == other.guarantees()
            && parameters.all(|p| p.canonical(self) == p.canonical(other))
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

    /// The same method with another number at the end of its name; unchanged where it cannot have that.
    #[must_use]
    pub fn with_number(&self, number: u32) -> Self {
        let numbered = self.method().numbered;
        let allowed = numbered.and_then(|n| n.parse(self.name, &number.to_string()).ok());
        Self {
            number: allowed.or(self.number),
            ..self.clone()
        }
    }

    fn set(&mut self, name: &str, text: &str) -> Result<(), RenderError> {
        let all = || self.method().all_parameters();
        let Some(parameter) = all().find(|p| p.name == name) else {
            let known: Vec<String> = all().map(|p| format!("{} ({})", p.name, p.about)).collect();
            return Err(self.bad(format!(
                "there is no parameter '{name}'; there are: {}",
                known.join(", ")
            )));
        };
        if !parameter.allows(text) {
            let allowed = parameter.allowed();
            return Err(self.bad(format!("{name} must be {allowed}, not '{text}'")));
        }
        self.values.insert(parameter.name, text.to_owned());
        Ok(())
    }

    fn bad(&self, message: String) -> RenderError {
        RenderError::WrongValue(format!("method {}: {message}", self.name))
    }
}

impl FromStr for MethodSpec {
    type Err = RenderError;

    fn from_str(text: &str) -> Result<Self, RenderError> {
        let (name, parameters) = text.split_once(':').unwrap_or((text, ""));
        let numbered = name.rsplit_once('-');
        let is_named = |m: &&'static Method| match m.numbered {
            None => m.name == name,
            Some(_) => numbered.is_some_and(|(name, _)| name == m.name),
        };
        let Some(method) = METHODS.iter().find(is_named) else {
            let known: Vec<String> = METHODS.iter().map(Method::usage).collect();
            let known: Vec<&str> = known.iter().map(String::as_str).collect();
            return Err(RenderError::WrongValue(format!(
                "there is no method '{name}'; {}",
                known_names(name, &known)
            )));
        };
        let mut spec = Self {
            name: method.name,
            number: None,
            values: BTreeMap::new(),
        };
        if let (Some(allowed), Some((_, text))) = (method.numbered, numbered) {
            spec.number = Some(allowed.parse(method.name, text).map_err(|e| spec.bad(e))?);
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

#[cfg(test)]
mod tests {
    use super::{
        super::{Parameter, Precision},
        *,
    };

    #[test]
    fn names_and_parameters_round_trip() {
        for text in [
            "abuffer",
            "wboit-eq10:factor=3e4,targets=f32",
            "deep-thesis:targets=f32",
            "hybrid-4:weight=eq7",
        ] {
            assert_eq!(text.parse::<MethodSpec>().unwrap().to_string(), text);
        }
        let of = |text: &str| text.parse::<MethodSpec>().unwrap();
        let one = of("wboit-eq10:factor=3e4,targets=f32").without("factor");
        assert_eq!(one, of("wboit-eq10:targets=f32"));
        assert!(!one.is_drawn_as(&of("wboit-eq10")) && !one.is_drawn_as(&of("wboit-eq9")));
        assert!(of("wboit-eq10:factor=3e4").is_drawn_as(&of("wboit-eq10:factor=30000.0")));
        assert_eq!(of("kbuffer-4").with_number(8), of("kbuffer-8"));
        assert_eq!(of("kbuffer-4").with_number(0), of("kbuffer-4"));
        let points: usize = METHODS.iter().map(|m| m.curve.len()).sum();
        assert_eq!(MethodSpec::compared().len(), points);
        for method in METHODS {
            let one = MethodSpec::representative(method).to_string();
            assert_eq!(one.parse::<MethodSpec>().unwrap().to_string(), one);
        }
    }

    /// What is not allowed is refused when it is parsed; the message says what is.
    #[test]
    fn names_and_values_are_checked() {
        let refused = |text: &str| text.parse::<MethodSpec>().unwrap_err().to_string();
        for (text, said) in [
            ("wbiot", "wboit-eq9"),
            ("mboit4-2", "mboit4"),
            ("kbuffer", "kbuffer-N"),
            ("kbuffer-", "1 to 64"),
            ("kbuffer-0", "1 to 64"),
            ("kbuffer-900", "1 to 64"),
            ("stochastic-9", "8 or 16"),
            ("abuffer:targets=f32", "budget"),
            ("mboit4:bias=0,own=out,bias=0", "bias is given twice"),
        ] {
            assert!(refused(text).contains(said), "{}", refused(text));
        }
        let of_factor = "a number above 0 and at most 1000000000";
        let of_passes = "a whole number from 1 to 1048576";
        for (text, allowed) in [
            ("depth-peel:passes=0", of_passes),
            ("depth-peel:passes=1048577", of_passes),
            ("blended:targets=f64", "f16 or f32"),
            ("mboit4:own=maybe", "in or out"),
            ("wavelet-3:own=", "out or in"),
            ("wboit-eq10:factor=inf", of_factor),
            ("wboit-eq10:factor=0", of_factor),
            ("wboit-eq10:factor=-1", of_factor),
            ("mboit4:bias=1e30", "a number from 0 to 1"),
            ("mboit6:bias=-1e-9", "a number from 0 to 1"),
            ("mboit4:overestimation=NaN", "a number from 0 to 1"),
            ("wboit-inverse-power:k=17", "a whole number from 0 to 16"),
            ("abuffer:scale=0", "a number above 0 and at most 1"),
            ("abuffer:scale=nan", "a number above 0 and at most 1"),
        ] {
            let (name, value) = text.split_once(':').unwrap().1.split_once('=').unwrap();
            let want = format!("{name} must be {allowed}, not '{value}'");
            assert!(refused(text).ends_with(&want), "{}", refused(text));
        }
    }

    /// Names are unique, defaults are allowed, and guarantees and known failures belong to what a name resolves to, not to how it is spelled.
    #[test]
    fn a_bare_name_and_its_explicit_spelling_declare_the_same() {
        let mut names: Vec<_> = METHODS.iter().map(|m| m.name).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), METHODS.len());
        for method in METHODS {
            let bare = MethodSpec::representative(method);
            let mut spelled = vec![];
            for parameter in method.all_parameters() {
                let named = |p: &&Parameter| p.name == parameter.name;
                assert_eq!(method.all_parameters().filter(named).count(), 1);
                let default = parameter.default();
                spelled.extend(default.map(|text| bare.with(parameter.name, &text).unwrap()));
            }
            if method.has_targets() {
                let words = Precision::WORDS.into_iter();
                let precisions = words.map(|word| bare.with("targets", word).unwrap());
                // One or none of them is the default.
                spelled.extend(precisions.filter(|s| s.guarantees() == bare.guarantees()));
            }
            for spelled in spelled {
                assert_eq!(spelled.guarantees(), bare.guarantees(), "{spelled}");
                assert!(spelled.is_drawn_as(&bare), "{spelled}");
                for failure in method.expectations.known_failures {
                    let (at, when) = (format!("{spelled}: {}", failure.reason), failure.when);
                    assert_eq!(when(&spelled), when(&bare), "{at}");
                }
            }
        }
    }
}
