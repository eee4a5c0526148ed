//! The exported texts of the shipped networks can be translated: nothing in them that some shading language lacks.

#![allow(clippy::unwrap_used, reason = "a failing test may panic")]

use naga::{
    Expression, Statement, TypeInner,
    valid::{Capabilities, ValidationFlags, Validator},
};
use peelnet_model::{Model, Recipe};

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
        let model = Model::shipped(recipe).unwrap();
        let text = peelnet_export::wgsl(&model).unwrap();
        let module =
            naga::front::wgsl::parse_str(&text).unwrap_or_else(|e| panic!("{recipe}: {e}"));
        let info = Validator::new(ValidationFlags::all(), Capabilities::empty())
            .validate(&module)
            .unwrap_or_else(|e| panic!("{recipe}: {e}"));
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
            names.extend(
                function
                    .local_variables
                    .iter()
                    .filter_map(|(_, v)| v.name.as_ref()),
            );
            names.extend(function.named_expressions.values());
            assert!(!has_loop(&function.body), "{recipe}: {:?}", function.name);
            for (_, expression) in function.expressions.iter() {
                if let Expression::Select { condition, .. } = expression {
                    let condition = info[handle][*condition].ty.inner_with(&module.types);
                    assert!(
                        matches!(condition, TypeInner::Scalar(_)),
                        "{recipe}: a select of {:?} has a vector of conditions",
                        function.name
                    );
                }
            }
        }
        assert!(names.len() > 20, "{recipe}: {names:?}");
        for name in names {
            assert!(
                !name.ends_with(|c: char| c.is_ascii_digit()),
                "{recipe}: {name}"
            );
        }
    }
}
