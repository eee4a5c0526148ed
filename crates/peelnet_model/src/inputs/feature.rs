//! One input of a network: a name, a unit, and its value in Rust and in WGSL.

/// What several features have in common, computed once in the shader.
#[derive(Debug, PartialEq, Eq)]
pub struct Shared {
    /// The name that expressions refer to.
    pub name: &'static str,
    /// Its value, a WGSL expression.
    pub wgsl: &'static str,
    /// The shader module with the function that it calls.
    pub module: Option<&'static str>,
}

/// What a feature is, without its value in Rust.
#[derive(Debug, PartialEq, Eq)]
pub struct About {
    /// Name in the model file, and of the parameter of the exported function.
    pub name: &'static str,
    /// Unit, such as `scene units` or `1`.
    pub unit: &'static str,
    /// Its value, a WGSL expression of the kind's parameters and of [`About::shared`].
    pub wgsl: &'static str,
    /// What the expression needs beside the parameters.
    pub shared: Option<&'static Shared>,
}

/// One input of a network, a function of `C`: what is known of a fragment or a pixel.
#[derive(Debug)]
pub struct Feature<C: 'static> {
    /// Name, unit and WGSL.
    pub about: About,
    /// Its value on the CPU.
    pub value: fn(&C) -> f64,
}

impl<C> Feature<C> {
    /// A feature whose WGSL reads the kind's parameters alone.
    pub const fn new(
        name: &'static str,
        unit: &'static str,
        wgsl: &'static str,
        value: fn(&C) -> f64,
    ) -> Self {
        let about = About {
            name,
            unit,
            wgsl,
            shared: None,
        };
        Self { about, value }
    }

    /// One whose WGSL needs a value that several have in common.
    pub const fn sharing(mut self, shared: &'static Shared) -> Self {
        self.about.shared = Some(shared);
        self
    }
}

/// The values of features, in order.
pub fn values<C>(features: &[&Feature<C>], known: &C) -> Vec<f64> {
    features.iter().map(|f| (f.value)(known)).collect()
}

/// What features are, in order.
pub(super) fn about<C>(features: &'static [&'static Feature<C>]) -> Vec<&'static About> {
    features.iter().map(|feature| &feature.about).collect()
}
