//! The comment at the beginning of an exported text.

use crate::{
    Options, Precision,
    description::Description,
    language::Language,
    literal::{float, identifier},
    network::function_name,
    self_test::SelfTest,
    text::{RANDOM, multiply_adds},
};
use peelnet_core::files::{printable, printable_lines};
use peelnet_core::tolerance::EXPORT_F16;
use peelnet_model::{DatasetRef, Model, Output};
use std::borrow::Cow;

/// Says in a text who wrote it.
pub(crate) const EXPORTED_BY: &str = "Exported by peelnet";

/// Scenes that are named in a header.
const MAX_NAMES: usize = 24;

/// Names from a file for a line of a comment: each without what could end the line, and of many the first ones.
fn names<'a>(all: impl ExactSizeIterator<Item = Cow<'a, str>>) -> String {
    let more = all.len().saturating_sub(MAX_NAMES);
    let shown: Vec<Cow<'_, str>> = all.take(MAX_NAMES).collect();
    let shown = shown.join(", ");
    match more {
        0 => shown,
        _ => format!("{shown} and {more} more"),
    }
}

/// What the text is, where it comes from, how to check it and what a renderer must do around it, as comments.
pub(crate) fn header(model: &Model, options: &Options) -> String {
    let language = options.language;
    let mut lines = about(model, language);
    if options.precision == Precision::F16 {
        lines.push(format!(
            "Layers in 16 bits, the last one in 32: answers differ from the network's by {EXPORT_F16} at most, on {RANDOM} random inputs of the range seen in training."
        ));
    }
    lines.extend(provenance(model));
    lines.push(String::new());
    lines.extend(SelfTest::new(model).lines(function_name(model.meta.output)));
    lines.push(String::new());
    lines.extend(Description::new(model.meta.recipe).lines(language));
    let mut text: String = lines
        .iter()
        // Names were bounded; whatever else a line holds, it must not end it.
        .map(|line| printable_lines(&line.replace('\n', " ")).into_owned())
        .map(|line| format!("{}\n", format!("// {line}").trim_end()))
        .collect();
    text.push('\n');
    text
}

/// The network, what it answers and what it reads.
fn about(model: &Model, language: Language) -> Vec<String> {
    let meta = &model.meta;
    let (low, high) = meta.output.range();
    let answer = match meta.output {
        Output::Transmittance => {
            let [low, high] = [low, high].map(float);
            format!("transmittance in front, kept in {low} .. {high}")
        }
        Output::AnchoredShare | Output::AnchoredShareSeparateEnds => {
            "transmittance of the rest, exp(-rest * share) with rest = root_absorbance^2 and share in 0 .. 1"
                .into()
        }
        Output::BoundedShare => {
            "transmittance of what lies between a slab's known ends, exp(-absorbance * share) with absorbance = root_absorbance^2 and share \
             in share_low .. share_high"
                .into()
        }
        Output::Color => "linear RGB of all transparent fragments over black, kept in 0 .. 1".into(),
    };
    let (mlp, version) = (&model.mlp, env!("CARGO_PKG_VERSION"));
    let (topology, parameters, adds) = (mlp.topology(), mlp.parameters(), multiply_adds(mlp));
    let (recipe, seed, epochs) = (meta.recipe, meta.seed, meta.epochs);
    let mut lines = vec![
        format!("A learned weight for order-independent transparency. {EXPORTED_BY} {version}."),
        "Licence of this generated text: MIT OR Apache-2.0.".into(),
        language.spelling().about.into(),
        format!(
            "Network: {topology} ({:?} hidden, {:?} last), {parameters} parameters, {adds} multiply-adds. Recipe {recipe}, seed {seed}, {epochs} epochs.",
            mlp.hidden, mlp.output
        ),
        format!("Answers: {answer}."),
    ];
    for (i, input) in meta.inputs.iter().enumerate() {
        let (name, unit) = (identifier(&input.name), printable(&input.unit));
        let [min, max] = [input.min, input.max].map(float);
        lines.push(format!(
            "Input {i}: {name} ({unit}), {min} .. {max} in training."
        ));
    }
    lines
}

/// The data that it was trained on, and its errors.
fn provenance(model: &Model) -> [String; 3] {
    let meta = &model.meta;
    let mut data = "Trained on: unknown.".to_owned();
    if let Some(DatasetRef {
        rows, hash, scenes, ..
    }) = &meta.dataset
    {
        let (hash, scenes) = (printable(hash), scenes.iter().map(|scene| printable(scene)));
        let scenes = names(scenes);
        let most = meta.config["max_rows"].as_u64().filter(|most| most < rows);
        let most = most.filter(|_| meta.config["buffer_rows"].is_null());
        let most = most.map_or_else(String::new, |most| format!(", at most {most} of them"));
        data = format!("Trained on {scenes}, of a dataset of {rows} rows{most} ({hash}).");
    }
    let losses = [
        ("training", meta.losses.train),
        ("validation", meta.losses.validation),
        ("test", meta.losses.test),
    ];
    let losses = losses.into_iter();
    let losses = losses.filter_map(|(name, loss)| Some(format!("{name} {:.6}", loss?)));
    let losses = match losses.collect::<Vec<_>>() {
        none if none.is_empty() => "unknown".to_owned(),
        losses => losses.join(", "),
    };
    let errors = meta.held_out.iter();
    let errors = errors.map(|(scene, e)| format!("{} {e:.5}", printable(scene)).into());
    let errors = match names(errors).as_str() {
        "" => "Held-out error: not measured.".into(),
        errors => format!("Held-out error, mean |T - T_exact|: {errors}."),
    };
    [data, format!("Loss: {losses}."), errors]
}
