//! Shading languages. The text is written once, in WGSL; naga translates it.

use crate::{
    ExportError,
    description::{Kind, Value},
};
use naga::{
    ShaderStage,
    back::{glsl, hlsl, msl},
    proc::BoundsCheckPolicies,
};
use std::fmt;

/// A shading language that a model is exported to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Language {
    /// WebGPU: three.js, Babylon.js, PlayCanvas, Bevy.
    #[default]
    Wgsl,
    /// GLSL ES 3.00: WebGL 2.
    GlslEs,
    /// GLSL 4.50: OpenGL and Vulkan.
    Glsl,
    /// HLSL, shader model 6.0: Direct3D, Unity, Unreal.
    Hlsl,
    /// Metal 2.4.
    Msl,
}

impl Language {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Wgsl, Self::GlslEs, Self::Glsl, Self::Hlsl, Self::Msl];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        self.dialect().name()
    }

    /// The end of its files' names.
    pub fn extension(self) -> &'static str {
        self.dialect().extension()
    }

    pub(crate) fn dialect(self) -> &'static dyn Dialect {
        match self {
            Self::Wgsl => &WGSL,
            Self::GlslEs => &GLSL_ES,
            Self::Glsl => &GLSL,
            Self::Hlsl => &Hlsl,
            Self::Msl => &Msl,
        }
    }
}

impl fmt::Display for Language {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// How a language says what WGSL says.
pub(crate) trait Dialect: Sync {
    /// On the command line.
    fn name(&self) -> &'static str;

    /// Of files.
    fn extension(&self) -> &'static str;

    /// Its version, and who has compiled and run such texts.
    fn about(&self) -> &'static str;

    /// Types of a number, of two, three and four.
    fn types(&self) -> [&'static str; 4];

    /// Whether texts of functions may compute in 16 bits.
    fn has_halves(&self) -> bool {
        true
    }

    /// The text of WGSL functions.
    ///
    /// # Errors
    /// A text that the language cannot hold.
    fn translate(&self, wgsl: &str) -> Result<String, ExportError>;

    /// The statement that computes a value.
    fn declare(&self, value: &Value) -> String {
        let [number, pair, ..] = self.types();
        let kind = match value.kind {
            Kind::Number => number,
            Kind::Pair => pair,
            Kind::Statistics => "PeelnetStatistics",
        };
        format!("{kind} {} = {};", value.name, self.expression(value.call))
    }

    /// An expression of vectors.
    fn expression(&self, wgsl: &str) -> String {
        let [_, pair, triple, quad] = self.types();
        let of = [("vec2f(", pair), ("vec3f(", triple), ("vec4f(", quad)];
        of.iter().fold(wgsl.to_owned(), |text, (from, to)| {
            text.replace(from, &format!("{to}("))
        })
    }
}

pub(crate) struct Wgsl;

/// The language that the text is written in.
pub(crate) const WGSL: Wgsl = Wgsl;

impl Dialect for Wgsl {
    fn name(&self) -> &'static str {
        "wgsl"
    }

    fn extension(&self) -> &'static str {
        "wgsl"
    }

    fn about(&self) -> &'static str {
        "WGSL, plain WebGPU. Compiled by naga, and run on a GPU against the network at every export."
    }

    fn types(&self) -> [&'static str; 4] {
        ["f32", "vec2f", "vec3f", "vec4f"]
    }

    fn translate(&self, wgsl: &str) -> Result<String, ExportError> {
        Ok(wgsl.to_owned())
    }

    fn declare(&self, value: &Value) -> String {
        format!("let {} = {};", value.name, value.call)
    }
}

/// Both kinds of GLSL.
pub(crate) struct Glsl {
    es: bool,
}

const GLSL_ES: Glsl = Glsl { es: true };
const GLSL: Glsl = Glsl { es: false };

const GLSL_TYPES: [&str; 4] = ["float", "vec2", "vec3", "vec4"];

/// GLSL needs an entry point, which is cut off again.
const ENTRY: &str = "\n@fragment\nfn peelnet_entry() {\n}\n";

impl Dialect for Glsl {
    fn name(&self) -> &'static str {
        if self.es { "glsl-es" } else { "glsl" }
    }

    fn extension(&self) -> &'static str {
        if self.es { "es.glsl" } else { "glsl" }
    }

    fn has_halves(&self) -> bool {
        false
    }

    fn about(&self) -> &'static str {
        if self.es {
            "GLSL ES 3.00, WebGL 2. Paste it below #version 300 es and precision highp float; and precision highp int;."
        } else {
            "GLSL 4.50."
        }
    }

    fn types(&self) -> [&'static str; 4] {
        GLSL_TYPES
    }

    fn translate(&self, wgsl: &str) -> Result<String, ExportError> {
        let (module, info) = parsed(&format!("{wgsl}{ENTRY}"))?;
        let version = if self.es {
            glsl::Version::new_gles(300)
        } else {
            glsl::Version::Desktop(450)
        };
        let options = glsl::Options {
            version,
            writer_flags: glsl::WriterFlags::empty(),
            ..Default::default()
        };
        let pipeline = glsl::PipelineOptions {
            shader_stage: ShaderStage::Fragment,
            entry_point: "peelnet_entry".into(),
            multiview: None,
        };
        let mut text = String::new();
        let policies = BoundsCheckPolicies::default();
        glsl::Writer::new(&mut text, &module, &info, &options, &pipeline, policies)
            .and_then(|mut writer| writer.write())
            .map_err(|e| self.refused(&e))?;
        // The version and precisions in front are the renderer's, and so is the entry point.
        let front = text.split_inclusive('\n').take_while(|line| {
            let line = line.trim();
            line.is_empty() || line.starts_with('#') || line.starts_with("precision ")
        });
        let begin = front.map(str::len).sum();
        let end = text.rfind("void main()").unwrap_or(text.len());
        Ok(text[begin..end].trim_end().to_owned() + "\n")
    }
}

pub(crate) struct Hlsl;

impl Dialect for Hlsl {
    fn name(&self) -> &'static str {
        "hlsl"
    }

    fn extension(&self) -> &'static str {
        "hlsl"
    }

    fn about(&self) -> &'static str {
        "HLSL, shader model 6.0."
    }

    fn types(&self) -> [&'static str; 4] {
        ["float", "float2", "float3", "float4"]
    }

    fn translate(&self, wgsl: &str) -> Result<String, ExportError> {
        let (module, info) = parsed(wgsl)?;
        let options = hlsl::Options {
            // The first with 16-bit floats; the text needs no more than 6.0 without them.
            shader_model: hlsl::ShaderModel::V6_2,
            ..Default::default()
        };
        let pipeline = hlsl::PipelineOptions::default();
        let mut text = String::new();
        hlsl::Writer::new(&mut text, &options, &pipeline)
            .write(&module, &info, None)
            .map_err(|e| self.refused(&e))?;
        Ok(text.trim().to_owned() + "\n")
    }
}

pub(crate) struct Msl;

impl Dialect for Msl {
    fn name(&self) -> &'static str {
        "msl"
    }

    fn extension(&self) -> &'static str {
        "metal"
    }

    fn about(&self) -> &'static str {
        "Metal 2.4. No Metal compiler was at hand: this text was translated from WGSL that was compiled and run, and has not been compiled itself."
    }

    fn types(&self) -> [&'static str; 4] {
        ["float", "float2", "float3", "float4"]
    }

    fn translate(&self, wgsl: &str) -> Result<String, ExportError> {
        let (module, info) = parsed(wgsl)?;
        let options = msl::Options {
            lang_version: (2, 4),
            ..Default::default()
        };
        let pipeline = msl::PipelineOptions::default();
        let (text, _) =
            msl::write_string(&module, &info, &options, &pipeline).map_err(|e| self.refused(&e))?;
        Ok(text.trim().to_owned() + "\n")
    }
}

/// An error of a translation.
trait Refused: Dialect {
    fn refused(&self, error: &dyn fmt::Display) -> ExportError {
        ExportError::Language {
            language: self.name(),
            reason: error.to_string(),
        }
    }
}

impl<T: Dialect> Refused for T {}

/// A text, valid, whether it computes in 16 or in 32 bits.
pub(crate) fn parsed(wgsl: &str) -> Result<(naga::Module, naga::valid::ModuleInfo), ExportError> {
    let halves = naga::valid::Capabilities::SHADER_FLOAT16;
    Ok(peelnet_shaders::validate("exported network", wgsl, halves)?)
}
