//! Shading languages. The text is written once, in WGSL; naga translates it.

use crate::ExportError;
use naga::{
    ShaderStage,
    back::{glsl, hlsl, msl},
    proc::BoundsCheckPolicies,
};
use peelnet_model::inputs::{Value, ValueKind};
use std::{error::Error, fmt, path::Path};

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

/// What languages spell differently.
pub(crate) struct Spelling {
    name: &'static str,
    extension: &'static str,
    /// The version, and who has compiled and run such texts.
    pub(crate) about: &'static str,
    /// Types of a number, of two, three and four, and of four by four.
    types: [&'static str; 5],
    /// Whether texts of functions may compute in 16 bits.
    pub(crate) has_halves: bool,
}

/// In the order of [`Language`].
static SPELLINGS: [Spelling; 5] = [
    Spelling {
        name: "wgsl",
        extension: "wgsl",
        about: "WGSL, plain WebGPU. Compiled by naga, and run on a GPU against the network at every export.",
        types: ["f32", "vec2f", "vec3f", "vec4f", "mat4x4f"],
        has_halves: true,
    },
    Spelling {
        name: "glsl-es",
        extension: "es.glsl",
        about: "GLSL ES 3.00, WebGL 2. Paste it below #version 300 es and precision highp float; and precision highp int;.",
        types: ["float", "vec2", "vec3", "vec4", "mat4"],
        has_halves: false,
    },
    Spelling {
        name: "glsl",
        extension: "glsl",
        about: "GLSL 4.50.",
        types: ["float", "vec2", "vec3", "vec4", "mat4"],
        has_halves: false,
    },
    Spelling {
        name: "hlsl",
        extension: "hlsl",
        about: "HLSL, shader model 6.0.",
        types: ["float", "float2", "float3", "float4", "float4x4"],
        has_halves: true,
    },
    Spelling {
        name: "msl",
        extension: "metal",
        about: "Metal 2.4. No Metal compiler was at hand: this text was translated from WGSL that was compiled and run, and has not been compiled itself.",
        types: ["float", "float2", "float3", "float4", "float4x4"],
        has_halves: true,
    },
];

/// GLSL needs an entry point, which is cut off again.
const ENTRY: &str = "\n@fragment\nfn peelnet_entry() {\n}\n";

impl Language {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Wgsl, Self::GlslEs, Self::Glsl, Self::Hlsl, Self::Msl];

    pub(crate) const fn spelling(self) -> &'static Spelling {
        &SPELLINGS[self as usize]
    }

    /// Its name on the command line.
    pub const fn name(self) -> &'static str {
        self.spelling().name
    }

    /// The end of its files' names.
    pub const fn extension(self) -> &'static str {
        self.spelling().extension
    }

    /// The language that a file's name says: by [`Language::extension`], or `.msl`.
    pub fn from_ending(path: &Path) -> Option<Self> {
        let name = path.file_name()?.to_string_lossy().to_lowercase();
        let is_in = |ending: &str| name.strip_suffix(ending).is_some_and(|n| n.ends_with('.'));
        let mut all = Self::ALL.into_iter();
        // GLSL ES comes before GLSL.
        let found = all.find(|language| is_in(language.extension()));
        found.or(is_in("msl").then_some(Self::Msl))
    }

    /// The statement that computes a value.
    pub(crate) fn declare(self, value: &Value) -> String {
        let [number, pair, .., matrix] = self.spelling().types;
        let kind = match value.kind {
            _ if self == Self::Wgsl => return value.to_string(),
            ValueKind::Number => number,
            ValueKind::Pair => pair,
            ValueKind::Matrix => matrix,
            ValueKind::Statistics => "PeelnetStatistics",
        };
        format!("{kind} {} = {};", value.name, self.expression(value.call))
    }

    /// An expression of vectors.
    pub(crate) fn expression(self, wgsl: &str) -> String {
        let types = Self::Wgsl.spelling().types.iter();
        let types = types.zip(self.spelling().types).skip(1);
        types.fold(wgsl.to_owned(), |text, (from, to)| {
            text.replace(&format!("{from}("), &format!("{to}("))
        })
    }

    /// The text of WGSL functions.
    ///
    /// # Errors
    /// A text that the language cannot hold.
    pub(crate) fn translate(self, wgsl: &str) -> Result<String, ExportError> {
        if self == Self::Wgsl {
            return Ok(wgsl.to_owned());
        }
        let is_glsl = matches!(self, Self::GlslEs | Self::Glsl);
        let entry = if is_glsl { ENTRY } else { "" };
        let (module, info) = parsed(&format!("{wgsl}{entry}"))?;
        let mut text = String::new();
        let mut write = || -> Result<(), Box<dyn Error>> {
            if self == Self::Hlsl {
                let options = hlsl::Options {
                    // The first with 16-bit floats; the text needs no more than 6.0 without them.
                    shader_model: hlsl::ShaderModel::V6_2,
                    ..Default::default()
                };
                hlsl::Writer::new(&mut text, &options, &Default::default())
                    .write(&module, &info, None)?;
            } else if self == Self::Msl {
                let options = msl::Options {
                    lang_version: (2, 4),
                    ..Default::default()
                };
                text = msl::write_string(&module, &info, &options, &Default::default())?.0;
            } else {
                let options = glsl::Options {
                    version: match self {
                        Self::GlslEs => glsl::Version::new_gles(300),
                        _ => glsl::Version::Desktop(450),
                    },
                    writer_flags: glsl::WriterFlags::empty(),
                    ..Default::default()
                };
                let pipeline = glsl::PipelineOptions {
                    shader_stage: ShaderStage::Fragment,
                    entry_point: "peelnet_entry".into(),
                    multiview: None,
                };
                let policies = BoundsCheckPolicies::default();
                glsl::Writer::new(&mut text, &module, &info, &options, &pipeline, policies)?
                    .write()?;
            }
            Ok(())
        };
        write().map_err(|e| {
            ExportError::Refused(format!(
                "the text cannot be translated to {self}: {e}; nothing was written"
            ))
        })?;
        let mut text = text.as_str();
        if is_glsl {
            // The version and precisions in front are the renderer's, and so is the entry point.
            let front = text.split_inclusive('\n').take_while(|line| {
                let line = line.trim();
                line.is_empty() || line.starts_with('#') || line.starts_with("precision ")
            });
            let begin = front.map(str::len).sum();
            let end = text.rfind("void main()").unwrap_or(text.len());
            text = &text[begin..end];
        }
        Ok(text.trim().to_owned() + "\n")
    }
}

impl fmt::Display for Language {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A text, valid, whether it computes in 16 or in 32 bits.
pub(crate) fn parsed(wgsl: &str) -> Result<(naga::Module, naga::valid::ModuleInfo), ExportError> {
    let halves = naga::valid::Capabilities::SHADER_FLOAT16;
    let validated = peelnet_render::shaders::validate("exported network", wgsl, halves);
    Ok(validated?)
}
