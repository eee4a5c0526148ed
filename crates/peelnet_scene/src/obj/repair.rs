//! Statements that `tobj` would misread without an error, or panic on. All other faults are found in the values that `tobj` returns.

use std::collections::BTreeSet;

/// A text that `tobj` reads right.
pub(super) struct Repaired {
    pub text: String,
    /// Names behind `usemtl`: of a material that no library has, `tobj` returns nothing.
    pub materials: BTreeSet<String>,
}

/// Digits of the largest index: the largest file that is read has fewer than a billion vertices, and three times a billion fits 32 bits.
const INDEX_DIGITS: usize = 9;

/// Repairs [`super::text::statements`], line by line.
///
/// # Errors
/// A line that cannot be repaired, and why.
pub(super) fn repaired(text: &str) -> Result<Repaired, (usize, String)> {
    let count = |words: &str| words.split_whitespace().count();
    let is_vertex = |line: &str| line.strip_prefix("v ").map(count);
    let is_colored = text.lines().any(|line| is_vertex(line) == Some(6));
    let mut out = String::with_capacity(text.len());
    let mut materials = BTreeSet::new();
    for (line, number) in text.lines().zip(1..) {
        let (key, rest) = line.split_once(' ').unwrap_or((line, ""));
        match key {
            // tobj takes a line of three points for a triangle.
            "l" | "p" => {}
            "usemtl" => {
                materials.insert(rest.trim().to_owned());
                out.push_str(line);
                // tobj refuses a file for a missing name.
                if rest.is_empty() {
                    out.push_str(" none");
                }
            }
            // tobj multiplies indices before it checks them, and panics where the product overflows.
            "f" if rest
                .split(|c: char| !c.is_ascii_digit())
                .any(|n| n.len() > INDEX_DIGITS) =>
            {
                return Err((number, "an index is too large; repair the face".into()));
            }
            // tobj lists only the colours that it finds: a vertex without one, or with one that is not a number, shifts all that follow.
            "v" if is_colored => {
                out.push_str(line);
                let mut color = rest.split_whitespace().skip(3);
                match count(rest) {
                    3 => out.push_str(" 1 1 1"),
                    6 if color.all(|word| word.parse::<f32>().is_ok()) => {}
                    _ => {
                        let message =
                            "a vertex without a colour of 3 numbers among vertices that have one";
                        return Err((number, format!("{message}; repair the line")));
                    }
                }
            }
            _ => out.push_str(line),
        }
        out.push('\n');
    }
    Ok(Repaired {
        text: out,
        materials,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statements_that_tobj_misreads() {
        let repaired = |text: &str| repaired(text).map(|r| r.text);
        assert_eq!(
            repaired("v 0 0 0\nv 1 0 0 1 0 0\nl 1 2 3\nusemtl\n"),
            Ok("v 0 0 0 1 1 1\nv 1 0 0 1 0 0\n\nusemtl none\n".into())
        );
        assert_eq!(repaired("v 0 0 0 1\n"), Ok("v 0 0 0 1\n".into()));
        for bad in [
            "\nv 0 0 0 1 0 0\nv 0 0 0 1\n",
            "\nv 0 0 0 1 0 0\nv 0 0 0 1 0 x\n",
        ] {
            assert!(repaired(bad).is_err_and(|(line, _)| line == 3), "{bad}");
        }
        // An index whose triple overflows 64 bits.
        let bad = "f 1//1 1//1 1//6148914691236517206\n";
        assert!(repaired(bad).is_err_and(|(line, _)| line == 1));
    }
}
