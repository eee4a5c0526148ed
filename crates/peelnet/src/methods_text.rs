//! The list of methods in help texts, made from their declarations.

use peelnet_render::{METHODS, methods::SCALE};
use std::fmt::Write as _;

/// Where descriptions begin.
const COLUMN: usize = 24;

/// The width that help texts are wrapped to.
const WIDTH: usize = 100;

/// Every method with its parameters, a line each.
pub fn methods() -> String {
    let mut text = "Methods, as NAME or NAME:parameter=value,parameter=value:\n".to_owned();
    let mut line = |indent: usize, name: &str, about: &str| {
        let (width, mut column) = (COLUMN - indent, COLUMN);
        // Writing to a string cannot fail.
        let _ = write!(text, "{:indent$}{name:width$}", "");
        for (i, word) in about.split(' ').enumerate() {
            if column + word.chars().count() >= WIDTH {
                let _ = write!(text, "\n{:COLUMN$}", "");
                column = COLUMN;
            } else if i > 0 {
                text.push(' ');
            }
            text.push_str(word);
            column += word.chars().count() + 1;
        }
        text.push('\n');
    };
    for method in METHODS {
        line(2, &method.usage(), method.about);
        for parameter in method.parameters {
            line(6, parameter.name, parameter.about);
        }
    }
    line(2, "any method", "");
    line(6, SCALE.name, SCALE.about);
    text
}
