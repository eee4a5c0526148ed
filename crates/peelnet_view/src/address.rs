//! What the address of a page says of the view: a link shows the same again.

use crate::output::{camera_numbers, camera_text};
use peelnet_files::printable;
use peelnet_render::MethodSpec;
use peelnet_scene::Camera;

/// A view, as far as an address names it.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Address {
    pub scene: Option<String>,
    pub method: Option<MethodSpec>,
    pub view: Option<usize>,
    /// As [`camera_numbers`] returns them.
    pub camera: Option<Vec<f32>>,
    pub time: Option<f32>,
    pub bare: bool,
}

impl Address {
    /// Reads `?scene=…&method=…`; what is wrong in it is left out, with a message.
    pub fn read(query: &str) -> (Self, Vec<String>) {
        let (mut address, mut wrong) = (Self::default(), Vec::new());
        for pair in query.trim_start_matches('?').split('&') {
            let (name, value) = pair.split_once('=').unwrap_or((pair, ""));
            let value = decoded(value);
            if let Err(why) = address.take(name, &value) {
                let value = printable(&value).to_string();
                wrong.push(format!("the address says {name}={value}: {why}"));
            }
        }
        (address, wrong)
    }

    fn take(&mut self, name: &str, value: &str) -> Result<(), String> {
        match name {
            "scene" if !value.is_empty() => self.scene = Some(value.to_owned()),
            "method" => {
                let method = value.parse::<MethodSpec>();
                self.method = Some(method.map_err(|e| crate::stage::one_line(&e))?);
            }
            "view" => self.view = Some(value.parse().map_err(|_| "must be a whole number")?),
            "camera" => self.camera = Some(camera_numbers(value)?),
            "time" => {
                let time = value.parse::<f32>().ok().filter(|t| t.is_finite());
                self.time = Some(time.ok_or("must be a number")?);
            }
            "bare" => self.bare = value != "0",
            // Hosts and mail programs add words of their own.
            _ => {}
        }
        Ok(())
    }

    /// The query of this view.
    pub fn query(
        scene: &str,
        method: &MethodSpec,
        (view, camera): (Option<usize>, &Camera),
        time: Option<f32>,
        bare: bool,
    ) -> String {
        let mut query = format!(
            "?scene={}&method={}",
            encoded(scene),
            encoded(&method.to_string())
        );
        match view {
            Some(number) => query += &format!("&view={number}"),
            None => query += &format!("&camera={}", camera_text(camera)),
        }
        if let Some(time) = time {
            query += &format!("&time={time}");
        }
        if bare {
            query += "&bare=1";
        }
        query
    }
}

/// Bytes that an address may not have as `%XX`.
fn encoded(text: &str) -> String {
    let plain = |b: u8| b.is_ascii_alphanumeric() || b"-_.~:,".contains(&b);
    let one = |b: u8| match plain(b) {
        true => char::from(b).to_string(),
        false => format!("%{b:02X}"),
    };
    text.bytes().map(one).collect()
}

fn decoded(text: &str) -> String {
    let spaced = text.replace('+', " ");
    String::from_utf8_lossy(&urlencoding::decode_binary(spaced.as_bytes())).into_owned()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failing test may panic")]
    use super::*;

    #[test]
    fn a_link_shows_the_same_again() {
        let camera = Camera {
            position: glam::Vec3::new(0.1, -2.5, 1e-3),
            target: glam::Vec3::new(3.0, 4.0, 5.0),
            up: glam::Vec3::Y,
            fov_y_degrees: 33.3,
            near: 0.1,
            far: 9.0,
        };
        let method: MethodSpec = "wboit-eq10:factor=3e4,targets=f32".parse().unwrap();
        for (scene, view) in [("cups", Some(2)), ("meine Szene & mehr=ä+.glb", None)] {
            let query = Address::query(scene, &method, (view, &camera), Some(1.5), true);
            let (address, wrong) = Address::read(&query);
            assert_eq!(wrong, [""; 0], "{query}");
            let numbers = vec![0.1, -2.5, 1e-3, 3.0, 4.0, 5.0, 33.3];
            let wanted = Address {
                scene: Some(scene.to_owned()),
                method: Some(method.clone()),
                view,
                camera: view.is_none().then_some(numbers),
                time: Some(1.5),
                bare: true,
            };
            assert_eq!(address, wanted, "{query}");
        }
    }

    #[test]
    fn what_is_wrong_is_said_and_left_out() {
        let (address, wrong) =
            Address::read("?method=nonsense&view=-1&camera=1,2&time=inf&scene=%E4%&utm=1");
        assert_eq!(wrong.len(), 4, "{wrong:?}");
        assert_eq!(address.method, None);
        assert_eq!(address.scene.as_deref(), Some("\u{fffd}%"));
        assert_eq!(Address::read(""), (Address::default(), Vec::new()));
    }
}
