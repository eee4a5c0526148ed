//! Text of OBJ and MTL files, prepared for `tobj`.
//!
//! `tobj` reads UTF-8, a statement a line. Comments behind a statement, lines continued by a backslash, lines that end in a carriage return
//! alone, and tabs in place of blanks are not supported by it. They are rewritten here without interpreting statements, and every statement
//! keeps its line number.

use crate::error::{SceneError, shown};
use encoding_rs::UTF_8;
use std::path::Path;

/// A file's text, and a warning where its encoding is a guess: by its byte order mark, else UTF-8, else Latin-1 as old exporters write it.
pub(super) fn decode(path: &Path, bytes: &[u8]) -> Result<(String, Option<String>), SceneError> {
    let lines = |text: &str| text.replace("\r\n", "\n").replace('\r', "\n");
    let (text, _, is_broken) = UTF_8.decode(bytes);
    if !is_broken {
        return Ok((lines(&text), None));
    }
    let valid = encoding_rs::Encoding::utf8_valid_up_to(bytes);
    let line = 1 + bytes[..valid].iter().filter(|&&b| b == b'\n').count();
    // No text has these: it is UTF-16 without a byte order mark, or not text.
    if bytes.contains(&0) {
        return Err(SceneError::Mesh {
            path: path.to_owned(),
            line: Some(line),
            message: "is not UTF-8 text; is it an OBJ file? Save it as plain text".into(),
        });
    }
    let warning = format!(
        "{}:{line}: is not UTF-8 and is read as Latin-1; save it as UTF-8 where names look wrong",
        shown(path)
    );
    // In Latin-1 a byte order mark would be three letters before the first statement.
    let marked = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let text = encoding_rs::mem::decode_latin1(marked);
    Ok((lines(&text), Some(warning)))
}

/// The text without comments, with continued lines joined, and with blanks for all other white space. Every statement stays on its line.
pub(super) fn statements(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut joined = 0;
    for line in text.lines() {
        // Files that were joined have byte order marks inside.
        let line = line.trim_start_matches('\u{feff}');
        let line = line.split('#').next().unwrap_or("").trim();
        let (part, is_continued) = match line.strip_suffix('\\') {
            Some(part) => (part, true),
            None => (line, false),
        };
        out.extend(
            part.chars()
                .map(|c| if c.is_whitespace() { ' ' } else { c }),
        );
        if is_continued {
            out.push(' ');
            joined += 1;
        } else {
            out.extend(std::iter::repeat_n('\n', joined + 1));
            joined = 0;
        }
    }
    out
}

/// The line that `tobj` read last, from 1: it stops reading where it fails.
pub(super) fn last_line(text: &str, unread: &[u8]) -> usize {
    let read = &text.as_bytes()[..text.len() - unread.len()];
    read.iter().filter(|&&b| b == b'\n').count().max(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statements_keep_their_lines() {
        let text = "# a\nf 1 2 \\\n3 # b\n\tvn\t0 0 1\n";
        assert_eq!(statements(text), "\nf 1 2  3\n\nvn 0 0 1\n");
        assert_eq!(statements("v 0\n\u{feff}v 1\n"), "v 0\nv 1\n");
    }

    #[test]
    fn encodings() {
        let decoded = |bytes: &[u8]| decode(Path::new("a.obj"), bytes).expect("text");
        assert_eq!(decoded(b"\xef\xbb\xbfv 0\r\n"), ("v 0\n".to_owned(), None));
        // UTF-16, little-endian, by its byte order mark.
        assert_eq!(
            decoded(b"\xff\xfeo\0\xe9\0\r\0"),
            ("o é\n".replace(' ', ""), None)
        );
        let (text, warning) = decoded(b"\xef\xbb\xbfv 0\n# caf\xe9\x80");
        assert_eq!(text, "v 0\n# caf\u{e9}\u{80}");
        assert!(warning.is_some_and(|w| w.contains("a.obj:2")));
    }
}
