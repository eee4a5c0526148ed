//! Values of flags that have a syntax of their own.

use clap::builder::{PossibleValuesParser, TypedValueParser};
use peelnet_render::MethodSpec;

/// `WxH`: the size of a frame in pixels.
pub fn size(text: &str) -> Result<[u32; 2], String> {
    let wrong = || format!("'{text}' is not a size; write WIDTHxHEIGHT in pixels, as in 1024x768");
    let (w, h) = text.split_once(['x', 'X', '×']).ok_or_else(wrong)?;
    match (w.parse(), h.parse()) {
        (Ok(0), Ok(_)) | (Ok(_), Ok(0)) => Err("a frame needs at least 1x1 pixels".to_owned()),
        (Ok(w), Ok(h)) => Ok([w, h]),
        _ => Err(wrong()),
    }
}

/// `N` or `all`: how many views of each scene, none for all.
pub fn views(text: &str) -> Result<Option<u32>, String> {
    match (text, text.parse()) {
        ("all", _) => Ok(None),
        (_, Ok(n)) if n > 0 => Ok(Some(n)),
        _ => Err(format!(
            "'{text}' is not a number of views; write 1, 2, … or all"
        )),
    }
}

/// A share in 0 < x ≤ 1.
pub fn fraction(text: &str) -> Result<f64, String> {
    positive(text)
        .ok()
        .filter(|x| *x <= 1.0)
        .ok_or_else(|| format!("'{text}' is not a fraction; write a number above 0 and up to 1"))
}

pub const SAMPLES: [(&str, u32); 2] = [("1", 1), ("4", 4)];

pub fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if x > 0.0 && x.is_finite() => Ok(x),
        _ => Err(format!("'{text}' is not a number above 0")),
    }
}

/// Methods of a comparison, none for all. Commas stand between methods and between a method's parameters: a part with an equals sign and
/// no colon is a parameter.
pub fn methods(text: &str) -> Result<Option<Vec<MethodSpec>>, String> {
    if text == "all" {
        return Ok(None);
    }
    let mut names: Vec<String> = Vec::new();
    for part in text.split(',') {
        match names.last_mut() {
            Some(last) if part.contains('=') && !part.contains(':') => {
                last.push(',');
                last.push_str(part);
            }
            _ => names.push(part.to_owned()),
        }
    }
    let methods = names.iter().map(|name| name.parse());
    let methods: Result<Vec<MethodSpec>, peelnet_render::RenderError> = methods.collect();
    let methods = methods.map_err(|e| e.to_string())?;
    for (k, method) in methods.iter().enumerate() {
        match methods[..k].iter().find(|other| other.is_drawn_as(method)) {
            None => {}
            Some(same) if same == method => {
                return Err(format!("{method} is named twice; name it once"));
            }
            Some(other) => {
                return Err(format!(
                    "{other} and {method} are one method; name one of them"
                ));
            }
        }
    }
    Ok(Some(methods))
}

/// The value of one of these names.
pub fn one_of<T: Copy + Send + Sync + 'static>(
    values: impl IntoIterator<Item = (&'static str, T)>,
) -> impl TypedValueParser<Value = T> {
    let (names, values): (Vec<&str>, Vec<T>) = values.into_iter().unzip();
    PossibleValuesParser::new(names.clone()).map(move |name: String| {
        let found = names.iter().position(|known| *known == name);
        values[found.expect("the parser takes these names alone")]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_checked() {
        assert_eq!(size("1024x768"), Ok([1024, 768]));
        assert_eq!(size("1X1"), Ok([1, 1]));
        assert_eq!((views("all"), views("3")), (Ok(None), Ok(Some(3))));
        assert_eq!((fraction("1"), fraction("0.25")), (Ok(1.0), Ok(0.25)));
        assert_eq!(positive("1e-4"), Ok(1e-4));
        let all = "12 0x5 5x0 x -1x5 1.5x2 1x2x3 99999999999x1 0 -1 NaN inf some ALL";
        for bad in all.split(' ').chain([""]) {
            assert!(size(bad).is_err() && fraction(bad).is_err(), "{bad}");
            let is_count = bad == "12";
            assert_eq!(views(bad).is_ok(), is_count, "{bad}");
            assert_eq!(positive(bad).is_ok(), is_count, "{bad}");
        }
    }

    #[test]
    fn method_lists_keep_parameters_together() {
        let list = methods("mboit4:bias=1e-6,own=out,wboit-eq9").expect("parses");
        let names = list.iter().flatten().map(ToString::to_string);
        assert!(names.eq(["mboit4:bias=1e-6,own=out", "wboit-eq9"]));
        assert_eq!(methods("all"), Ok(None));
        assert!(methods("mboit4,nothing").is_err());
        assert!(methods("mboit4,wboit-eq9,mboit4").is_err());
    }
}
