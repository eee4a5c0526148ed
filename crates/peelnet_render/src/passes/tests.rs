//! Passes against the shaders that they draw with.

use super::*;
use crate::{
    methods::METHODS,
    shaders::{Binding, PORTABLE, link, naga, source, validate},
    target::LearnedWeight,
};
use std::collections::BTreeSet;

/// A pass's names are those of the variables that its shader reads, and it writes as many targets as its shader has outputs: in every
/// setting of every method.
#[test]
fn shaders_and_passes_have_the_same_names() {
    let (mut faults, mut passes) = (BTreeSet::new(), 0);
    for method in METHODS.iter().filter(|m| m.cpu_only.is_none()) {
        let mut specs: Vec<_> = MethodSpec::points(method).collect();
        if method.has_targets() {
            let first = specs[0].clone();
            let words = Precision::WORDS.map(|word| first.with("targets", word));
            specs.extend(words.into_iter().flatten());
        }
        for spec in &specs {
            let learned = LearnedWeight::shipped(spec);
            assert_eq!(
                learned.is_some(),
                method.learned,
                "{spec} ships with its network"
            );
            let network = learned.as_ref().map_or("", |learned| &learned.wgsl);
            for (grey, tinted) in [(false, false), (true, false), (false, true)] {
                if tinted && !spec.guarantees().tinted {
                    continue;
                }
                let on = Conditions {
                    spec,
                    recipe: learned.as_ref().map(|learned| learned.recipe),
                    size: [640, 480],
                    grey,
                    tinted,
                    over: false,
                };
                let list = method.passes(on, network);
                for pass in &list.passes {
                    passes += 1;
                    // More than WebGPU promises is asked for by name, or what a method was published with.
                    let promised = 32;
                    let is_portable = list.sample_bytes(pass) <= promised;
                    let full = spec.guarantees().statistics == Precision::Full;
                    let asked = full || spec.name().ends_with("wide");
                    assert!(is_portable || asked, "{spec}, {}", pass.shader);
                    let found = compare(&list, pass);
                    faults.extend(found.map(|fault| format!("{spec}, {}: {fault}", pass.shader)));
                }
            }
        }
    }
    assert!(faults.is_empty(), "{faults:#?}");
    assert!(passes > 200, "{passes}");
}

/// What of a pass and of its shader is not the same.
fn compare(list: &Passes<'_>, pass: &Pass) -> Option<String> {
    let mut features = list.features(pass);
    if pass.draws == Draws::Surfaces {
        features.extend(pass.needs.features(&[]));
    }
    let shader = link(&pass.shader, &features, &list.modules(pass)).expect("links");
    // A geometry pass has the scene in group 0.
    let group = u32::from(matches!(pass.draws, Draws::Surfaces | Draws::Boxes));
    let is_own = |b: &&Binding| b.group == group;
    let always = |name: &&str| !["background", "bilinear", "camera", "frame"].contains(name);
    let variables = shader
        .bindings
        .iter()
        .filter(is_own)
        .map(|b| b.name.as_str());
    let variables: BTreeSet<_> = variables.filter(always).collect();
    let resource = |handle: &Handle| &list.resources[handle.0];
    let is_target = |r: &&Resource| {
        matches!(r, Resource::Target(_) | Resource::Again(..)) || r.name() == "output"
    };
    let written = || pass.writes.iter().map(resource);
    let storage = written().filter(|r| !is_target(r));
    let names = pass.reads.iter().map(resource).chain(storage);
    let names: BTreeSet<_> = names.map(Resource::name).collect();
    // What another feature makes superfluous is declared and not read.
    let text = source(&pass.shader).expect("it has a module");
    let is_declared = |name: &&&str| text.contains(&format!(" {name}: "));
    let superfluous = names.difference(&variables).filter(is_declared).count();
    if names.len() != variables.len() + superfluous || !variables.is_subset(&names) {
        return Some(format!("it reads {variables:?} and is given {names:?}"));
    }
    let (module, _) = validate(&pass.shader, &shader.text, PORTABLE).expect("valid");
    let mut entries = module.entry_points.iter();
    let fragment = entries.find(|e| e.stage == naga::ShaderStage::Fragment)?;
    let result = fragment.function.result.as_ref();
    let outputs = result.map_or(0, |result| match &module.types[result.ty].inner {
        naga::TypeInner::Struct { members, .. } => members.len(),
        _ => 1,
    });
    // A pass over pixels may write depth besides.
    let depth = usize::from(pass.depth.is_some() && pass.draws == Draws::Pixels);
    let targets = written().filter(is_target).count() + depth;
    (outputs != targets).then(|| format!("it has {outputs} outputs and {targets} targets"))
}
