//! The header of a PLY file.

use super::{Fault, elements::Skipped};
use peelnet_files::{counted, printable};
use ply_rs_bw::{
    parser::{Parser, Reader},
    ply::{ElementDef, Encoding, KeyMap, PropertyType, ScalarType},
};

/// Most bytes of a header.
const MAX_HEADER: usize = 1 << 20;

const END: &[u8] = b"end_header";

/// A header whose counts the file can hold.
pub(super) struct Head {
    pub encoding: Encoding,
    /// In the order of the file.
    pub elements: KeyMap<ElementDef>,
    /// Where the elements begin, bytes.
    pub length: usize,
    /// How many lines it has.
    pub lines: usize,
    /// Whether it names a texture.
    pub has_texture: bool,
}

impl Head {
    /// Reads and checks a file's header.
    pub fn read(bytes: &[u8]) -> Result<Self, Fault> {
        let (text, length) = text(bytes)?;
        let header = Parser::<Skipped>::new().read_header(&mut Reader::new(text.as_bytes()));
        let header = header.map_err(|e| {
            let Some(line) = e.line() else {
                let message = "its header has no line such as 'format ascii 1.0'; export it again";
                return Fault::new(message);
            };
            let shown = text.lines().nth(line - 1).unwrap_or_default();
            let message = format!("no header of PLY has '{}'; repair it", printable(shown));
            Fault::at(line, message)
        })?;
        // Of two of the same name, the crate keeps one, and would read the wrong bytes.
        let counted = |word: &str| text.lines().filter(|l| l.starts_with(word)).count();
        let elements = header.elements.len();
        let properties = header.elements.values().map(|e| e.properties.len());
        if counted("element") != elements || counted("property") != properties.sum::<usize>() {
            let message = "its header names an element or a property twice; export it again";
            return Err(Fault::new(message));
        }
        let is_texture = |c: &String| c.trim_start().starts_with("TextureFile");
        let head = Self {
            encoding: header.encoding,
            elements: header.elements,
            length,
            lines: text.lines().count(),
            has_texture: header.comments.iter().any(is_texture),
        };
        head.check_counts((bytes.len() - length) as u64)?;
        Ok(head)
    }

    /// Checks that the bytes behind the header can hold as many elements as it says, before anything is made of them.
    fn check_counts(&self, held: u64) -> Result<(), Fault> {
        let mut needed = 0u64;
        for element in self.elements.values() {
            let types = element.properties.values().map(|p| &p.data_type);
            let least: u64 = types.map(|t| least_bytes(t, self.encoding)).sum();
            needed = needed.saturating_add(least.saturating_mul(element.count as u64));
            // The last number needs no space behind it.
            if needed > held + 1 {
                return Err(Fault::new(format!(
                    "its header says that it has {} of '{}', which take {} at least, and {} follow it; is the file cut off?",
                    element.count,
                    printable(&element.name),
                    counted(needed, "byte"),
                    held
                )));
            }
        }
        Ok(())
    }
}

/// The header's text, and where the elements begin.
fn text(bytes: &[u8]) -> Result<(String, usize), Fault> {
    if !bytes.starts_with(b"ply") {
        let message = "does not begin with 'ply': is it a PLY file? Export it again";
        return Err(Fault::at(1, message));
    }
    let start = &bytes[..bytes.len().min(MAX_HEADER)];
    let is_end = |w: &[u8]| matches!(w[0], b'\n' | b'\r') && &w[1..] == END;
    let Some(at) = start.windows(END.len() + 1).position(is_end) else {
        let message = format!(
            "has no 'end_header' in its first {}; is the file cut off?",
            counted(start.len() as u64, "byte")
        );
        return Err(Fault::new(message));
    };
    let end = at + 1 + END.len();
    let text = String::from_utf8_lossy(&bytes[..end]);
    let text = text.replace("\r\n", "\n").replace('\r', "\n");
    let is_blank = |b: &&u8| matches!(b, b' ' | b'\t');
    let mut length = end + bytes[end..].iter().take_while(is_blank).count();
    // The first byte of the elements may look like a line break, so there are two only where the line before has two.
    let has_two = start[at] == b'\n' && start[at - 1] == b'\r';
    length += match &bytes[length..] {
        [b'\r', b'\n', ..] if has_two => 2,
        [b'\r' | b'\n', ..] => 1,
        [] => 0,
        _ => {
            let message = "has more than 'end_header' on that line; export it again";
            return Err(Fault::at(text.lines().count(), message));
        }
    };
    Ok((text + "\n", length))
}

/// The fewest bytes that a property takes.
fn least_bytes(property: &PropertyType, encoding: Encoding) -> u64 {
    // A digit and a blank.
    if encoding == Encoding::Ascii {
        return 2;
    }
    let (PropertyType::Scalar(first) | PropertyType::List(first, _)) = property;
    match first {
        ScalarType::Char | ScalarType::UChar => 1,
        ScalarType::Short | ScalarType::UShort => 2,
        ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
        ScalarType::Double => 8,
    }
}
