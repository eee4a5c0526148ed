//! `[camera]`, `[[view]]`, `[orbit]` and `[[light]]`.

use super::{
    loader::Loader,
    raw::{RawLight, RawScene},
};
use crate::{
    budget::{self, MAX_LIGHTS},
    camera::Camera,
    error::{SceneError, check_color},
    scene::{Light, Source},
};
use glam::Vec3;

/// The views of a scene: its camera, all of its views, or an orbit of its camera.
pub(super) fn views(loader: &Loader<'_>, raw: &RawScene) -> Result<Vec<Camera>, SceneError> {
    let fail = |key: &str, message: &str| Err(loader.value(key, message));
    let views = match (raw.camera, raw.view.as_slice()) {
        (Some(camera), []) => vec![camera],
        (None, views @ [_, ..]) => views.to_vec(),
        (Some(_), _) => return fail("camera", "give either [camera] or [[view]], not both"),
        (None, []) => return fail("camera", "is missing: add a [camera] or some [[view]]"),
    };
    for (view, i) in views.iter().zip(1..) {
        let number = format!("view {i}");
        let table = raw.camera.map_or(&*number, |_| "camera");
        view.check().map_err(|e| loader.fault(table, e))?;
    }
    let Some(orbit) = &raw.orbit else {
        return Ok(views);
    };
    let n = orbit.views;
    if views.len() > 1 {
        let message = "turns one camera: give [camera], not several [[view]]";
        return fail("orbit", message);
    }
    if !(1..=10_000).contains(&n) {
        return fail("orbit.views", &format!("{n} must lie in 1 … 10000"));
    }
    Ok(views[0].orbit(n))
}

pub(super) fn lights(loader: &Loader<'_>, raw: &[RawLight]) -> Result<Vec<Light>, SceneError> {
    budget::check(raw.len() as u64, MAX_LIGHTS as u64, "lights")
        .map_err(|e| loader.value("light", e))?;
    let lights = raw.iter().map(light).zip(1..);
    lights
        .map(|(light, i)| light.map_err(|e| loader.value(&format!("light {i}"), e)))
        .collect()
}

fn light(raw: &RawLight) -> Result<Light, String> {
    let source = match (raw.position, raw.direction) {
        (Some(position), None) => Source::Point(position.into()),
        // The file gives the direction of the light, `Source` the direction towards it.
        (None, Some(direction)) => {
            // In 64 bits, where squares of all 32-bit numbers are finite, and none but that of 0 is 0.
            let toward = (-Vec3::from(direction).as_dvec3()).try_normalize();
            Source::Toward(toward.map_or(Vec3::NAN, |toward| toward.as_vec3()))
        }
        _ => return Err("needs either a position or a direction".into()),
    };
    let (Source::Point(place) | Source::Toward(place)) = source;
    if !place.is_finite() || !raw.intensity.is_finite() || raw.intensity < 0.0 {
        return Err("must be finite, its intensity not negative, its direction not zero".into());
    }
    check_color(raw.color).map_err(|(key, e)| format!("{key}: {e}"))?;
    Ok(Light {
        source,
        color: raw.color,
        intensity: raw.intensity,
    })
}
