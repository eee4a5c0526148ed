//! Finds the numbers in a shader's text, for tests that change them.

/// Where a module's decimal literals stand, other than zero. Comments and names do not count.
pub fn literals(text: &str) -> Vec<std::ops::Range<usize>> {
    let bytes = text.as_bytes();
    let (mut found, mut i) = (Vec::new(), 0);
    while i < bytes.len() {
        if text[i..].starts_with("//") {
            i += text[i..].find('\n').unwrap_or(text.len() - i);
        } else if bytes[i].is_ascii_alphabetic() || bytes[i] == b'_' {
            let name = |b: &u8| b.is_ascii_alphanumeric() || *b == b'_';
            i += bytes[i..].iter().take_while(|b| name(b)).count();
        } else if bytes[i].is_ascii_digit() {
            let start = i;
            while i < bytes.len() {
                let sign = matches!(bytes[i], b'-' | b'+') && bytes[i - 1] == b'e';
                if !(bytes[i].is_ascii_digit() || matches!(bytes[i], b'.' | b'e') || sign) {
                    break;
                }
                i += 1;
            }
            let literal = &text[start..i];
            let decimal = literal.contains(['.', 'e']);
            if decimal && literal.parse::<f64>().is_ok_and(|x| x != 0.0) {
                found.push(start..i);
            }
        } else {
            i += 1;
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::literals;

    #[test]
    fn literals_are_found() {
        let text = "// 1.5\nlet a1 = 2.5 * x - 1e-4; // 7.0\nlet b = vec4f(0.0, 1u, 3.0e+2) - 4;";
        let found: Vec<&str> = literals(text).into_iter().map(|r| &text[r]).collect();
        assert_eq!(found, ["2.5", "1e-4", "3.0e+2"]);
    }
}
