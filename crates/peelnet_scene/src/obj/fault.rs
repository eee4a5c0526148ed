//! Which line of an OBJ file is wrong. `tobj`'s errors have no line, and it takes NaN for a number; this scan runs only once a file is
//! known to be bad.

/// The first line whose numbers or indices make no sense, and a message.
pub(super) fn first(text: &str) -> Option<(usize, String)> {
    // A positive index may point ahead, so the totals come first.
    let total = |key: &str| text.lines().filter(|l| key_of(l) == Some(key)).count() as i64;
    let totals = KEYS.map(total);
    let mut seen = [0i64; 3];
    text.lines().zip(1..).find_map(|(line, number)| {
        let words: Vec<&str> = line.split_whitespace().skip(1).collect();
        let message = match key_of(line)? {
            "f" => face(&words, seen, totals),
            key => {
                let kind = KEYS.iter().position(|&k| k == key)?;
                seen[kind] += 1;
                numbers(key, &words)
            }
        };
        message.map(|message| (number, message))
    })
}

/// Vertices, texture coordinates and normals, in the order in which a face refers to them.
const KEYS: [&str; 3] = ["v", "vt", "vn"];

fn key_of(line: &str) -> Option<&str> {
    line.split_whitespace().next()
}

/// What is wrong with the numbers of a vertex, texture coordinate or normal.
fn numbers(key: &str, words: &[&str]) -> Option<String> {
    let (needed, what) = match key {
        "v" => (3, "position"),
        "vt" => (2, "texture coordinate"),
        _ => (3, "normal"),
    };
    if words.len() < needed {
        return Some(format!(
            "'{key}' has {} numbers instead of {needed}; is the file cut off?",
            words.len()
        ));
    }
    // tobj reads two numbers of a texture coordinate, and NaN there is a warning elsewhere.
    let read = if key == "vt" { &words[..2] } else { words };
    for word in read {
        match word.parse::<f32>() {
            Err(_) => return Some(format!("'{word}' is not a number; repair the line")),
            Ok(x) if x.is_finite() || key == "vt" => {}
            Ok(_) => {
                return Some(format!(
                    "{what} '{word}' is not finite; repair the mesh and export it again"
                ));
            }
        }
    }
    if key != "v" {
        return None;
    }
    // Behind a position's three numbers stands its w, or a colour.
    match words.len() {
        3 | 6 => None,
        4 => {
            let number = |k: usize| words[k].parse::<f32>().unwrap_or(f32::NAN);
            let is_far = (0..3).any(|k| !(number(k) / number(3)).is_finite());
            is_far.then(|| {
                format!(
                    "a position with w = {} lies at infinity; repair the line",
                    words[3]
                )
            })
        }
        n => Some(format!(
            "a vertex of {n} numbers; a position has 3, with w 4, with a colour 6: repair the line"
        )),
    }
}

/// What is wrong with a face, where `seen` elements of each kind stand before it, and `totals` are in the file.
fn face(words: &[&str], seen: [i64; 3], totals: [i64; 3]) -> Option<String> {
    if words.len() < 3 {
        return Some(format!(
            "a face of {} vertices; is the file cut off?",
            words.len()
        ));
    }
    for word in words {
        for (kind, field) in word.split('/').enumerate() {
            if field.is_empty() && kind == 1 {
                continue;
            }
            let Ok(index) = field.parse::<i64>() else {
                return Some(format!("'{word}' is not an index; repair the line"));
            };
            let Some(&total) = totals.get(kind) else {
                return Some(format!("'{word}' has more than 3 indices; repair the face"));
            };
            if !(1..=total).contains(&index) && !(-seen[kind]..0).contains(&index) {
                let what = ["vertices", "texture coordinates", "normals"][kind];
                return Some(format!(
                    "index {index} points at none of the {total} {what}; repair the face"
                ));
            }
        }
    }
    None
}
