//! `[camera]`, `[[view]]`, `[orbit]` and `[[light]]`.

use super::{
    loader::Loader,
    materials::check_color,
    raw::{RawCamera, RawLight, RawScene},
};
use crate::{
    budget::check_lights,
    camera::{Camera, FOV_Y},
    error::SceneError,
    scene::{Light, Source},
};
use glam::Vec3;

/// The views of a scene: its camera, all of its views, or an orbit of its camera.
pub(super) fn views(loader: &Loader<'_>, raw: &RawScene) -> Result<Vec<Camera>, SceneError> {
    let mut views = Vec::new();
    match (&raw.camera, raw.view.as_slice()) {
        (Some(_), [_, ..]) => {
            return Err(loader.value("camera", "give either [camera] or [[view]], not both"));
        }
        (None, []) => {
            return Err(loader.value("camera", "is missing: add a [camera] or some [[view]]"));
        }
        (Some(raw), []) => views.push(camera(loader, raw, "camera")?),
        (None, list) => {
            for (i, view) in list.iter().enumerate() {
                views.push(camera(loader, view, &format!("view {}", i + 1))?);
            }
        }
    }
    if let Some(orbit) = &raw.orbit {
        if views.len() > 1 {
            return Err(loader.value(
                "orbit",
                "turns one camera: give [camera], not several [[view]]",
            ));
        }
        if orbit.views == 0 || orbit.views > 10_000 {
            return Err(loader.value(
                "orbit.views",
                format!("{} must lie in 1 … 10000", orbit.views),
            ));
        }
        let first = views[0];
        views = (0..orbit.views)
            .map(|i| first.orbited(360.0 * i as f32 / orbit.views as f32))
            .collect();
    }
    Ok(views)
}

fn camera(loader: &Loader<'_>, raw: &RawCamera, field: &str) -> Result<Camera, SceneError> {
    let at = |key: &str| format!("{field}.{key}");
    for (key, v) in [
        ("position", raw.position),
        ("target", raw.target),
        ("up", raw.up),
    ] {
        if v.iter().any(|x| !x.is_finite()) {
            return Err(loader.value(&at(key), "must be finite"));
        }
    }
    let (near, far) = (raw.near, raw.far);
    if !(near > 0.0 && near < far && far.is_finite()) {
        return Err(loader.value(
            &at("near"),
            format!("near {near} must be positive and below far {far}"),
        ));
    }
    if !FOV_Y.contains(&raw.fov_y) {
        return Err(loader.value(
            &at("fov_y"),
            format!(
                "{} must lie between {} and {} degrees",
                raw.fov_y,
                FOV_Y.start(),
                FOV_Y.end()
            ),
        ));
    }
    let camera = Camera {
        position: raw.position.into(),
        target: raw.target.into(),
        up: raw.up.into(),
        fov_y_degrees: raw.fov_y,
        near,
        far,
    };
    let forward = camera.target - camera.position;
    if forward.length() == 0.0 {
        return Err(loader.value(&at("target"), "must differ from position"));
    }
    let side = forward
        .normalize()
        .cross(camera.up.normalize_or_zero())
        .length();
    if side < 1e-4 {
        return Err(loader.value(&at("up"), "must not be zero or along the line of sight"));
    }
    Ok(camera)
}

/// The lights of a scene.
pub(super) fn lights(loader: &Loader<'_>, raw: &[RawLight]) -> Result<Vec<Light>, SceneError> {
    check_lights(raw.len()).map_err(|e| loader.value("light", e))?;
    let lights = raw.iter().enumerate();
    lights
        .map(|(i, light)| {
            self::light(light).map_err(|e| loader.value(&format!("light {}", i + 1), e))
        })
        .collect()
}

fn light(raw: &RawLight) -> Result<Light, String> {
    let source = match (raw.position, raw.direction) {
        (Some(position), None) => Source::Point(position.into()),
        // The file gives the direction of the light, `Source` the direction towards it.
        (None, Some(direction)) => {
            let toward = (-Vec3::from(direction)).try_normalize();
            Source::Toward(toward.unwrap_or(Vec3::NAN))
        }
        _ => return Err("needs either a position or a direction".into()),
    };
    let (Source::Point(place) | Source::Toward(place)) = source;
    if !place.is_finite() || !raw.intensity.is_finite() || raw.intensity < 0.0 {
        return Err("must be finite, its intensity not negative, its direction not zero".into());
    }
    check_color(raw.color).map_err(|e| format!("color: {e}"))?;
    Ok(Light {
        source,
        color: raw.color,
        intensity: raw.intensity,
    })
}
