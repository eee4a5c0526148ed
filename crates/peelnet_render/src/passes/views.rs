//! What pixels show of their sorted fragments in place of a method's colours: these composite by themselves, from the S-buffer, and are no
//! methods of transparency.
//!
//! *Layers*: one layer of a nested object highlighted, the others around it as a veil.
//!
//! *Surfaces*: which transparent surfaces each pixel shows, as numbers in place of colours. A surface is one side, front or back, of a part
//! of an object with one material. Red and green of a pixel are two hashes of the list of its surfaces, nearest first; alpha is the number
//! of its fragments. Opacity is not read: a fragment that lets all light through counts, the hole of a cut-out and what an opaque object
//! hides do not. Two pixels with the same surfaces in the same order have the same numbers. Two with others have the same with a
//! probability of 2⁻⁴⁴: each hash is 22 bits. So the sum of four samples is a whole number below 2²⁴, which 32-bit floats hold, and their
//! mean is exact.

/// The fraction of a pixel that the highlighted fragment takes among others.
const HIGHLIGHT_SHARE: f32 = 0.5;

/// Which fragments of a pixel are seen besides the highlighted one, the nearest of its layer, and what each of them weighs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LayerFormula {
    /// Those in front of it share `1 − v` in equal parts, with v = 0.5; those behind it are hidden. Without any in front the highlighted
    /// one takes the whole pixel. Weights add up to 1.
    #[default]
    Front,
    /// All of them, as the formula of the ageing renderer (Adamopoulos 2018) is printed: the highlighted one weighs v, and each other one,
    /// in front of it or behind, `(1 − v) / n` with n the number of all fragments. Weights add up to `1 − (1 − v) / n`.
    Printed,
}

/// What is seen of the layers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LayerView {
    /// The layer that is highlighted; 0 is the outermost.
    pub highlight: u32,
    /// Whether fragments count only where the number of their layer increases: then an object's own far side is not seen.
    pub increasing: bool,
    /// Which fragments are seen, and what they weigh.
    pub formula: LayerFormula,
}

/// What pixels show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shows {
    /// The method's colours.
    Colors,
    /// The sums of weighted, premultiplied colour and opacity that a method blends, instead of the colour that it makes of them. Of
    /// methods that blend weighted sums with a fixed number of passes; others draw as usual.
    Sums,
    /// Layers, of the exact method.
    Layers(LayerView),
    /// Surfaces, of the exact method.
    Surfaces,
}

/// The pass that composites sorted fragments.
#[derive(Debug)]
pub(crate) struct Composite {
    pub shader: &'static str,
    /// The feature of `peel::fold` that stands for it.
    pub name: &'static str,
    /// The feature of the passes that store fragments.
    pub stored: Option<&'static str>,
    pub features: Vec<&'static str>,
    /// The text of its module `parameters`.
    pub parameters: String,
}

impl Shows {
    pub(crate) fn composite(self, tinted: bool) -> Composite {
        let mut parameters = String::new();
        let (shader, name, stored, features) = match self {
            Self::Colors | Self::Sums => {
                let tinted = tinted.then_some("tinted");
                (
                    "methods::abuffer::composite",
                    "abuffer",
                    tinted,
                    Vec::from_iter(tinted),
                )
            }
            Self::Layers(view) => {
                parameters = format!(
                    "const HIGHLIGHT: f32 = {:?};\nconst HIGHLIGHT_SHARE: f32 = {HIGHLIGHT_SHARE:?};\n",
                    view.highlight as f32
                );
                let printed = (view.formula == LayerFormula::Printed).then_some("printed");
                let increasing = view.increasing.then_some("increasing");
                let features = increasing.into_iter().chain(printed);
                (
                    "passes::layers::composite",
                    "layers",
                    Some("layered"),
                    features.collect(),
                )
            }
            Self::Surfaces => (
                "passes::surfaces::composite",
                "surfaces",
                Some("named"),
                Vec::new(),
            ),
        };
        Composite {
            shader,
            name,
            stored,
            features,
            parameters,
        }
    }
}
