//! Numbers as shader text.

/// The shortest decimal text that reads back to the same bits, as a WGSL `f32` literal without suffix.
pub(crate) fn float(x: f32) -> String {
    ryu::Buffer::new().format_finite(x).to_owned()
}

/// `vec4f(a, b, c, d)`, padded with zeros.
pub(crate) fn vec4(values: &[f32]) -> String {
    let value = |k: usize| float(values.get(k).copied().unwrap_or(0.0));
    format!("vec4f({})", [0, 1, 2, 3].map(value).join(", "))
}

/// A name that no translator renames: naga changes those that end in a digit.
pub(crate) fn identifier(name: &str) -> String {
    const DIGITS: [&str; 10] = [
        "zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine",
    ];
    match name.char_indices().last() {
        Some((at, last)) if last.is_ascii_digit() => {
            let digit = DIGITS[usize::from(last as u8 - b'0')];
            format!("{}{digit}", &name[..at])
        }
        _ => name.to_owned(),
    }
}

/// A number as letters: a, b … z, ba, bb ….
pub(crate) fn letters(k: usize) -> String {
    let last = char::from(b'a' + (k % 26) as u8);
    match k / 26 {
        0 => last.to_string(),
        more => letters(more) + &last.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn literals_read_back() {
        for x in [0.0, -0.0, 1.0, -1.5, 1e-45, f32::MAX, 0.1, 1e18, 6.1e-5] {
            let text = float(x);
            let read: f32 = text.parse().expect("a number");
            assert_eq!(read.to_bits(), f32::to_bits(x));
            // WGSL reads a literal without point or exponent as an integer.
            assert!(text.contains(['.', 'e']), "{text}");
        }
        assert_eq!(vec4(&[1.0, 2.5]), "vec4f(1.0, 2.5, 0.0, 0.0)");
    }

    #[test]
    fn names_end_in_letters() {
        assert_eq!(identifier("moment_1"), "moment_one");
        assert_eq!(identifier("share_low"), "share_low");
        assert_eq!([0, 25, 26, 53].map(letters), ["a", "z", "ba", "cb"]);
    }
}
