//! Values of flags that have a syntax of their own.

pub use peelnet_files::shown;
use peelnet_render::MethodSpec;
use std::fmt;
use std::path::Path;
use std::str::FromStr;

/// `WxH`: the size of a frame in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size(pub [u32; 2]);

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong =
            || format!("'{text}' is not a size; write WIDTHxHEIGHT in pixels, as in 1024x768");
        let (w, h) = text.split_once(['x', 'X', '×']).ok_or_else(wrong)?;
        let size: [u32; 2] = [
            w.parse().map_err(|_| wrong())?,
            h.parse().map_err(|_| wrong())?,
        ];
        if size.contains(&0) {
            return Err("a frame needs at least 1x1 pixels".to_owned());
        }
        Ok(Self(size))
    }
}

impl fmt::Display for Size {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}x{}", self.0[0], self.0[1])
    }
}

/// `N` or `all`: how many views of each scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ViewCount {
    /// Every view that the scene has.
    All,
    /// The first N.
    First(u32),
}

impl ViewCount {
    /// The number of views; `None` for all.
    pub const fn limit(self) -> Option<usize> {
        match self {
            Self::All => None,
            Self::First(n) => Some(n as usize),
        }
    }
}

impl FromStr for ViewCount {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match (text, text.parse()) {
            ("all", _) => Ok(Self::All),
            (_, Ok(n)) if n > 0 => Ok(Self::First(n)),
            _ => Err(format!(
                "'{text}' is not a number of views; write 1, 2, … or all"
            )),
        }
    }
}

impl fmt::Display for ViewCount {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::All => f.write_str("all"),
            Self::First(n) => write!(f, "{n}"),
        }
    }
}

/// A share in 0 < x ≤ 1.
pub fn fraction(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if x > 0.0 && x <= 1.0 => Ok(x),
        _ => Err(format!(
            "'{text}' is not a fraction; write a number above 0 and up to 1"
        )),
    }
}

/// Samples a pixel.
pub fn samples(text: &str) -> Result<u32, String> {
    match text {
        "1" => Ok(1),
        "4" => Ok(4),
        _ => Err(format!("a pixel has 1 or 4 samples, not '{text}'")),
    }
}

/// A positive number.
pub fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if x > 0.0 && x.is_finite() => Ok(x),
        _ => Err(format!("'{text}' is not a number above 0")),
    }
}

/// A path for JSON, which has no place for bytes that are no UTF-8.
pub fn json_path(path: &Path) -> String {
    path.to_string_lossy().into_owned()
}

/// The command line of this process, for provenance: the program's bare name and its arguments, quoted for a shell.
pub fn command_line() -> String {
    let arguments = std::env::args_os()
        .skip(1)
        .map(|a| a.to_string_lossy().into_owned());
    shell_words::join(std::iter::once("peelnet".to_owned()).chain(arguments))
}

/// Methods of a comparison.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum MethodList {
    /// Every method.
    All,
    /// These.
    These(Vec<MethodSpec>),
}

impl FromStr for MethodList {
    type Err = String;

    /// Commas stand between methods and between a method's parameters: a part with an equals sign and no colon is a parameter.
    fn from_str(text: &str) -> Result<Self, String> {
        if text == "all" {
            return Ok(Self::All);
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
        names
            .iter()
            .map(|name| name.parse().map_err(|e| format!("{e}")))
            .collect::<Result<_, _>>()
            .map(Self::These)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn method_lists_keep_parameters_together() {
        let list: MethodList = "mboit4:bias=1e-6,own=out,wboit-eq9"
            .parse()
            .expect("parses");
        let MethodList::These(methods) = list else {
            panic!("a list");
        };
        let names: Vec<_> = methods.iter().map(ToString::to_string).collect();
        assert_eq!(names, ["mboit4:bias=1e-6,own=out", "wboit-eq9"]);
        assert_eq!("all".parse(), Ok(MethodList::All));
        assert!("mboit4,nothing".parse::<MethodList>().is_err());
    }

    #[test]
    fn sizes() {
        assert_eq!("1024x768".parse(), Ok(Size([1024, 768])));
        assert_eq!("1X1".parse(), Ok(Size([1, 1])));
        assert_eq!(
            "1024x768".parse::<Size>().map(|s| s.to_string()),
            Ok("1024x768".to_owned())
        );
        for bad in [
            "",
            "12",
            "0x5",
            "5x0",
            "x",
            "-1x5",
            "1.5x2",
            "1x2x3",
            "99999999999x1",
        ] {
            assert!(bad.parse::<Size>().is_err(), "{bad}");
        }
    }

    #[test]
    fn view_counts() {
        assert_eq!("all".parse(), Ok(ViewCount::All));
        assert_eq!("3".parse(), Ok(ViewCount::First(3)));
        for bad in ["", "0", "-1", "some", "ALL"] {
            assert!(bad.parse::<ViewCount>().is_err(), "{bad}");
        }
    }

    #[test]
    fn fractions_and_positive_numbers() {
        assert_eq!(fraction("1"), Ok(1.0));
        assert_eq!(fraction("0.25"), Ok(0.25));
        for bad in ["0", "-0.1", "1.01", "NaN", "inf", "x"] {
            assert!(fraction(bad).is_err(), "{bad}");
        }
        assert_eq!(positive("1e-4"), Ok(1e-4));
        for bad in ["0", "-1", "NaN", "inf", ""] {
            assert!(positive(bad).is_err(), "{bad}");
        }
    }
}
