//! What a renderer must do around an exported text: the one source of the text's header and of the documents.

use crate::language::Language;
use peelnet_model::Recipe;
use peelnet_model::inputs::{Blend, Pass, SmallTexture, Target};
use serde::Serialize;

/// What a renderer must do around an exported text.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Description {
    /// What comes before the passes.
    pub before: &'static str,
    /// What the passes read of each pixel's surroundings.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub around: Option<&'static SmallTexture>,
    /// The passes, in order.
    pub passes: &'static [Pass],
    /// The call that resolves each pixel.
    pub resolve: &'static str,
    /// The targets that it reads.
    pub resolve_reads: Vec<&'static str>,
    /// What holds in all passes, and what breaks the result.
    pub rules: &'static [&'static str],
}

const RULES: &[&str] = &[
    "alpha is opacity, rgb the linear colour that is not multiplied by it. Resolve before tone mapping and encoding.",
    "Test depth against the opaque surfaces, do not write it: a depth prepass with transparent surfaces in it hides what lies behind.",
    "z grows with distance, also where depth buffers are reversed.",
    "With multisampling, gather and resolve the statistics per sample: averaged samples of them mean nothing.",
];

impl Description {
    /// Of the networks of a recipe.
    pub fn new(recipe: Recipe) -> Self {
        let surroundings = recipe.inputs.surroundings();
        let (passes, resolve) = (surroundings.passes, surroundings.resolve);
        let targets = passes.iter().flat_map(|pass| pass.targets);
        let mut names: Vec<&str> = targets.map(|target| target.name).collect();
        names.extend(passes.iter().flat_map(|pass| pass.reads));
        let mut resolve_reads = Vec::new();
        for word in resolve.split(|c: char| !c.is_alphanumeric() && c != '_') {
            if names.contains(&word) && !resolve_reads.contains(&word) {
                resolve_reads.push(word);
            }
        }
        Self {
            before: surroundings.before,
            around: surroundings.around,
            passes,
            resolve,
            resolve_reads,
            rules: RULES,
        }
    }

    /// As lines of a comment in a language, without their marks.
    pub(crate) fn lines(&self, language: Language) -> Vec<String> {
        let mut lines = vec![
            "How to draw with it. Targets may have 32 bits a channel wherever 16 are named."
                .to_owned(),
            format!("0. {}", self.before),
        ];
        if let Some(around) = self.around {
            let SmallTexture {
                name,
                format,
                every,
                ..
            } = around;
            let calls = [around.sum, around.write, around.otherwise];
            let [sum, write, otherwise] = calls.map(|call| language.expression(call));
            lines.push(format!(
                "   {name}: {format}, a texture of one texel for {every} by {every} pixels, read with linear interpolation; {otherwise} where it is not drawn."
            ));
            lines.push(format!("   At its size, {}", drawn(&around.pass, language)));
            lines.extend(target_lines(&around.pass, language));
            lines.push(format!(
                "   Then each of its texels is {write}: sum adds, over the 3 by 3 texels around it, {sum}."
            ));
            let last = around.last.map(|call| language.expression(call));
            lines.extend(last.map(|last| format!(
                "   Or make it without that pass from what the last frame kept of the pixel in the middle of each of them, of {last}, but for the first frame and after jumps of the camera."
            )));
        }
        for (k, pass) in (1..).zip(self.passes) {
            let (name, drawn) = (pass.name, drawn(pass, language));
            lines.push(format!("{k}. Pass \"{name}\": {drawn}"));
            lines.extend(target_lines(pass, language));
        }
        let (last, call) = (self.passes.len() + 1, language.expression(self.resolve));
        lines.push(format!(
            "{last}. Resolve: {call} is the colour of the pixel, and its coverage in alpha."
        ));
        lines.extend(self.rules.iter().map(|rule| format!("- {rule}")));
        lines
    }
}

fn drawn(pass: &Pass, language: Language) -> String {
    let compute = pass.compute.map(|value| language.declare(&value));
    let compute = compute.unwrap_or_default();
    format!("draw all transparent surfaces, in any order. {compute}")
}

fn target_lines(pass: &Pass, language: Language) -> impl Iterator<Item = String> {
    let targets = pass.targets.iter();
    targets.map(move |target| target_line(target, language))
}

fn target_line(target: &Target, language: Language) -> String {
    let (mut clear, last) = (&target.clear[..], &target.clear[3..]);
    if clear.iter().all(|c| *c == last[0]) {
        clear = last;
    }
    let clear: Vec<String> = clear.iter().map(f32::to_string).collect();
    let [color, alpha] = [target.color, target.alpha].map(|blend| match blend {
        Blend::Add => "ADD",
        Blend::Max => "MAX",
        Blend::Transmit => "dst * (1 - src)",
    });
    let blending = if color == alpha {
        color.to_owned()
    } else {
        format!("{color} for rgb, {alpha} for alpha")
    };
    let (name, format, clear) = (target.name, target.format, clear.join(", "));
    let write = language.expression(target.write);
    format!("   {name}: {format}, cleared to {clear}, blending {blending}, from {write}")
}
