//! The exported texts of the shipped networks: nothing in them that some shading language lacks, and no name in a model's file, which is a
//! stranger's, becomes code.

use naga::{
    Expression, Statement, TypeInner,
    front::wgsl::parse_str,
    valid::{Capabilities, ValidationFlags, Validator},
};
use peelnet_export::{verify, wgsl};
use peelnet_model::{DatasetRef, Model, Recipe};
use peelnet_render::gpu::{AdapterRequest, Gpu};
use std::collections::BTreeSet;

/// Ends a line in every way that WGSL knows, and in some that terminals know.
const HOSTILE: &str = "x\nfn stolen() -> f32 { return 1.0; }\r\u{b}\u{c}\u{85}\u{2028}\u{2029}const a = 1;\n*/ \u{1b}[2J\u{202e}\\";

/// A model whose every free text is this one.
fn hostile(recipe: Recipe, text: &str) -> Model {
    let mut model = Model::shipped(recipe).expect("ships");
    let meta = &mut model.meta;
    meta.tool_version = text.to_owned();
    for input in &mut meta.inputs {
        input.unit = text.to_owned();
    }
    meta.dataset = Some(DatasetRef {
        hash: text.to_owned(),
        rows: 1,
        set_aside: Vec::new(),
        scenes: vec![text.to_owned(); 1000],
        contents: Vec::new(),
    });
    meta.held_out = (0..1000).map(|k| (format!("{text}{k}"), 0.5)).collect();
    meta.config = serde_json::json!({ text: text });
    model
}

fn functions(text: &str) -> BTreeSet<String> {
    let module = parse_str(text).expect("parses");
    assert!(module.entry_points.is_empty() && module.global_variables.is_empty());
    let functions = module.functions.iter();
    functions.filter_map(|(_, f)| f.name.clone()).collect()
}

#[test]
fn names_of_a_model_never_become_code() {
    for recipe in Recipe::ALL {
        let shipped = Model::shipped(recipe).expect("ships");
        let clean = wgsl(&shipped).expect("exports");
        let text = wgsl(&hostile(recipe, HOSTILE)).expect("exports");
        assert_eq!(functions(&text), functions(&clean), "{recipe}");
        let header = |text: &str| text.lines().take_while(|l| l.starts_with("//")).count();
        assert_eq!(header(&text), header(&clean), "{recipe}");
        let hidden = text.chars().find(|c| c.is_control() && *c != '\n');
        assert_eq!(hidden, None, "{recipe}");
        // Twenty-four names of two hundred characters, escaped, twice.
        assert!(text.len() < clean.len() + 2 * 24 * 200 * 10, "{recipe}");
        assert!(text.contains("and 976 more"), "{recipe}");
    }
}

/// A text that has one more function than the model's is not the model's.
#[test]
fn a_text_with_more_declarations_is_refused() {
    let gpu = Gpu::open(&AdapterRequest::Auto).expect("an adapter");
    let model = Model::shipped(Recipe::SMALL).expect("ships");
    let text = wgsl(&model).expect("exports");
    assert!(verify(&gpu, &model, &text).is_ok());
    for more in [
        "fn stolen() -> f32 { return 1.0; }",
        "const stolen: f32 = 1.0;",
        "var<private> stolen: f32;",
        "@compute @workgroup_size(1) fn stolen() {}",
    ] {
        let error = verify(&gpu, &model, &format!("{text}\n{more}\n")).expect_err(more);
        assert!(error.to_string().contains("stolen"), "{error}");
    }
}

fn has_loop(block: &naga::Block) -> bool {
    block.iter().any(|statement| match statement {
        Statement::Loop { .. } => true,
        Statement::Block(block) => has_loop(block),
        Statement::If { accept, reject, .. } => has_loop(accept) || has_loop(reject),
        _ => false,
    })
}

/// Constants and functions alone, without arrays and loops. No `select` with a vector of conditions, which HLSL 2021 refuses in
/// the form that naga writes, and no name that ends in a digit, which naga changes.
#[test]
fn texts_are_portable() {
    for recipe in Recipe::ALL {
        let model = Model::shipped(recipe).expect("ships");
        let text = wgsl(&model).expect("exports");
        let module = parse_str(&text).expect("parses");
        let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
        let info = validator.validate(&module).expect("valid");
        assert!(module.global_variables.is_empty() && module.overrides.is_empty());
        let mut names: Vec<&String> = Vec::new();
        for (_, ty) in module.types.iter() {
            assert!(!matches!(ty.inner, TypeInner::Array { .. }), "{recipe}");
            names.extend(&ty.name);
            if let TypeInner::Struct { members, .. } = &ty.inner {
                names.extend(members.iter().filter_map(|m| m.name.as_ref()));
            }
        }
        names.extend(module.constants.iter().filter_map(|(_, c)| c.name.as_ref()));
        for (handle, function) in module.functions.iter() {
            names.extend(&function.name);
            names.extend(function.arguments.iter().filter_map(|a| a.name.as_ref()));
            let locals = function.local_variables.iter();
            names.extend(locals.filter_map(|(_, v)| v.name.as_ref()));
            names.extend(function.named_expressions.values());
            assert!(!has_loop(&function.body), "{recipe}: {:?}", function.name);
            for (_, expression) in function.expressions.iter() {
                if let Expression::Select { condition, .. } = expression {
                    let condition = info[handle][*condition].ty.inner_with(&module.types);
                    let is_one = matches!(condition, TypeInner::Scalar(_));
                    let name = &function.name;
                    assert!(
                        is_one,
                        "{recipe}: a select of {name:?} has a vector of conditions"
                    );
                }
            }
        }
        assert!(names.len() > 20, "{recipe}: {names:?}");
        for name in names {
            let ends_in_digit = name.ends_with(|c: char| c.is_ascii_digit());
            assert!(!ends_in_digit, "{recipe}: {name}");
        }
    }
}
