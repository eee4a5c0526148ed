//! The list of methods in help texts, made from their declarations.

use peelnet_render::{METHODS, methods::SCALE};
use std::fmt::Write as _;

/// Every method with its parameters, a line each.
pub fn methods() -> String {
    let mut text = "Methods, as NAME or NAME:parameter=value,parameter=value:\n".to_owned();
    let mut line = |indent: usize, name: &str, about: &str| {
        let width = 24 - indent;
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{:indent$}{name:width$}{about}", "");
    };
    for method in METHODS {
        line(2, &method.usage(), method.about);
        for parameter in method.parameters {
            line(6, parameter.name(), parameter.about());
        }
    }
    line(2, "any method", "");
    line(6, SCALE.name, SCALE.about);
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_method_has_its_line() {
        let text = methods();
        for method in METHODS {
            let named = text
                .lines()
                .any(|l| l.trim_start().starts_with(&method.usage()));
            assert!(named && text.contains(method.about), "{}", method.name);
        }
        assert!(text.lines().all(|l| l.chars().count() <= 140));
    }
}
