//! What shows a view again: the command of the window, and the address of a page. Both name its parts by the same words.

use crate::app::App;
#[cfg(any(test, target_arch = "wasm32"))]
use crate::app::Start;
use peelnet_core::files;

/// Eye and target, and the field of view in degrees: six or seven numbers, as `--camera` gives them.
pub fn camera_numbers(text: &str) -> Result<Vec<f32>, String> {
    let numbers: Result<Vec<f32>, _> = text.split(',').map(|n| n.trim().parse::<f32>()).collect();
    let numbers = numbers.unwrap_or_default();
    let is_complete = matches!(numbers.len(), 6 | 7) && numbers.iter().all(|x| x.is_finite());
    let is_direction = is_complete && numbers[..3] != numbers[3..6];
    let is_angle = numbers.get(6).is_none_or(|x| *x > 0.0 && *x < 180.0);
    if is_direction && is_angle {
        return Ok(numbers);
    }
    Err("must be eye and target, and the field of view in degrees where it is another: X,Y,Z,X,Y,Z[,DEGREES]".into())
}

/// For a shell, on one line.
fn quoted(text: &str) -> String {
    shell_words::quote(&files::one_line(text)).into_owned()
}

impl App {
    /// What is shown of the scene: option and value.
    fn options(&self) -> Vec<(&'static str, String)> {
        let time = self.stage.as_ref().and_then(|stage| stage.time());
        let method = ("method", self.first.spec.to_string());
        let view = match self.view {
            Some(number) => ("view", number.to_string()),
            None => {
                let [p, t] = [self.camera.position, self.camera.target];
                let numbers = [p.x, p.y, p.z, t.x, t.y, t.z, self.camera.fov_y_degrees];
                ("camera", numbers.map(|x| x.to_string()).join(","))
            }
        };
        let time = time.map(|time| ("time", time.to_string()));
        [method, view].into_iter().chain(time).collect()
    }

    fn scene_path(&self) -> Option<String> {
        let path = &self.stage.as_ref()?.source.path;
        Some(path.to_string_lossy().into_owned())
    }

    /// The command that opens this view again; `None` without a scene.
    pub(crate) fn command(&self) -> Option<String> {
        let mut command = format!("peelnet view {}", quoted(&self.scene_path()?));
        let model = self.first.own_network().and_then(|n| n.path.as_ref());
        let model = model.map(|path| ("model", path.to_string_lossy().into_owned()));
        for (name, value) in self.options().into_iter().chain(model) {
            command += &format!(" --{name}={}", quoted(&value));
        }
        Some(command)
    }

    /// The query of an address that shows this view again; `None` without a scene.
    #[cfg(any(test, target_arch = "wasm32"))]
    pub(crate) fn query(&self) -> Option<String> {
        // An address may hold these two, and is easier to read with them.
        let encoded = |text: &str| {
            let all = urlencoding::encode(text);
            all.replace("%2C", ",").replace("%3A", ":")
        };
        let mut query = format!("?scene={}", encoded(&self.scene_path()?));
        for (name, value) in self.options() {
            query += &format!("&{name}={}", encoded(&value));
        }
        if self.panels.bare {
            query += "&bare=1";
        }
        Some(query)
    }
}

/// Reads `?scene=…&method=…` into what a page begins with; what is wrong in it is left out, with a message.
#[cfg(any(test, target_arch = "wasm32"))]
pub(crate) fn read(query: &str, start: &mut Start) -> Vec<String> {
    let mut take = |name: &str, value: &str| -> crate::task::Fallible<()> {
        match name {
            "scene" if !value.is_empty() => start.scene = value.into(),
            "method" => start.method = value.parse()?,
            "view" => start.view = value.parse().map_err(|_| "must be a whole number")?,
            "camera" => start.camera = Some(camera_numbers(value)?),
            "time" => {
                let time = value.parse::<f32>().ok().filter(|t| t.is_finite());
                start.time = Some(time.ok_or("must be a number")?);
            }
            "bare" => start.bare = value != "0",
            // Hosts and mail programs add words of their own.
            _ => {}
        }
        Ok(())
    };
    let mut wrong = Vec::new();
    for pair in query.trim_start_matches('?').split('&') {
        let (name, value) = pair.split_once('=').unwrap_or((pair, ""));
        let spaced = value.replace('+', " ");
        let value = urlencoding::decode_binary(spaced.as_bytes());
        let value = String::from_utf8_lossy(&value);
        if let Err(why) = take(name, &value) {
            let (value, why) = (files::printable(&value), crate::task::one_line(&*why));
            wrong.push(format!("the address says {name}={value}: {why}"));
        }
    }
    wrong
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cameras_are_checked() {
        assert_eq!(camera_numbers("1,2, 3,1,2,4").unwrap().len(), 6);
        for bad in [
            "",
            "1,2,3",
            "1,2,3,1,2,3",
            "1,2,3,4,5,nan",
            "1,2,3,4,5,6,0",
            "1,2,3,4,5,6,7,8",
            "a,2,3,4,5,6",
        ] {
            assert!(camera_numbers(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn what_is_wrong_is_said_and_left_out() {
        let mut start = Start::new("", "abuffer".parse().unwrap());
        let query = "?method=nonsense&view=-1&camera=1,2&time=inf&scene=%E4%&utm=1";
        let wrong = read(query, &mut start);
        assert_eq!(wrong.len(), 4, "{wrong:?}");
        assert_eq!(start.method.to_string(), "abuffer");
        assert_eq!(start.scene.to_str(), Some("\u{fffd}%"));
        assert_eq!(read("", &mut start), [""; 0]);
    }
}
