//! Shading in 64 bits: the same as `shaders/scene/shade.wgsl`, which cites the sources.

use glam::DVec3;
use std::f64::consts::PI;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// A place in world space, or the direction of a light without one.
    pub source: Source,
    pub color: DVec3,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Source {
    Point(DVec3),
    /// A direction, of length 1.
    Toward(DVec3),
}

impl Light {
    /// The direction to it, and what falls off its light by the square law.
    fn seen_from(&self, position: DVec3) -> (DVec3, f64) {
        match self.source {
            Source::Toward(direction) => (direction, 1.0),
            Source::Point(place) => {
                let apart = place - position;
                let squared = apart.length_squared().max(1e-8);
                (apart / squared.sqrt(), squared)
            }
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    pub position: DVec3,
    /// Unit normal, either side.
    pub normal: DVec3,
    pub eye: DVec3,
    /// Share of the ambient light that arrives.
    pub ambient: f64,
}

/// View direction, and the normal on its side.
fn frame(at: &Point) -> (DVec3, DVec3) {
    let view = (at.eye - at.position).normalize();
    let towards = at.normal.dot(view) >= 0.0;
    let normal = if towards { at.normal } else { -at.normal };
    (view, normal)
}

/// Blinn–Phong (Blinn 1977): 10 % ambient, diffuse, and a highlight of the light's colour.
pub fn phong(at: &Point, color: DVec3, specular: f64, shininess: f64, lights: &[Light]) -> DVec3 {
    let (view, normal) = frame(at);
    let mut radiance = 0.1 * at.ambient * color;
    for light in lights {
        let (toward, _) = light.seen_from(at.position);
        let diffuse = normal.dot(toward).max(0.0);
        let halfway = (toward + view).normalize();
        let highlight = if diffuse > 0.0 {
            normal.dot(halfway).max(0.0).powf(shininess)
        } else {
            0.0
        };
        radiance += light.color * (color * diffuse + specular * highlight);
    }
    radiance
}

/// What a physically based surface reflects of light that arrives along `toward` into `view`, both unit vectors on the normal's
/// side: Cook–Torrance and Lambert, not yet times the cosine.
fn reflectance(
    normal: DVec3,
    view: DVec3,
    toward: DVec3,
    albedo: DVec3,
    metallic: f64,
    roughness: f64,
) -> DVec3 {
    let roughness = roughness.max(0.04);
    let (a, k) = (roughness * roughness, (roughness + 1.0).powi(2) / 8.0);
    let halfway = (toward + view).normalize();
    let n_v = normal.dot(view).max(1e-4);
    let (n_l, n_h) = (normal.dot(toward).max(0.0), normal.dot(halfway).max(0.0));
    let spread = n_h * n_h * (a * a - 1.0) + 1.0;
    let distribution = a * a / (PI * spread * spread);
    let shadowing = 1.0 / ((n_l * (1.0 - k) + k) * (n_v * (1.0 - k) + k));
    let grazing = |cosine: f64| (1.0 - cosine).clamp(0.0, 1.0).powi(5);
    // What a dielectric scatters inside went in at the light's angle and comes out at the eye's.
    let inside = 0.96 * 0.96 * (1.0 - grazing(n_l)) * (1.0 - grazing(n_v));
    let diffuse = inside * (1.0 - metallic) / PI;
    let head_on = 0.04 + (albedo - 0.04) * metallic;
    let fresnel = head_on + (1.0 - head_on) * grazing(halfway.dot(view));
    diffuse * albedo + distribution * shadowing * 0.25 * fresnel
}

/// Physically based shading by lights, of which those with a place fall off with the square of the distance, and 3 % ambient.
pub fn physically_based(
    at: &Point,
    albedo: DVec3,
    metallic: f64,
    roughness: f64,
    lights: &[Light],
) -> DVec3 {
    let (view, normal) = frame(at);
    let mut radiance = 0.03 * at.ambient * albedo;
    for light in lights {
        let (toward, squared) = light.seen_from(at.position);
        let n_l = normal.dot(toward).max(0.0);
        let part = reflectance(normal, view, toward, albedo, metallic, roughness);
        radiance += part * light.color / squared * n_l;
    }
    radiance
}

#[cfg(test)]
mod tests {
    use super::*;

    /// White furnace: under light of 1 from everywhere a white surface reflects no more than 1, whatever its roughness and
    /// metal, seen from any angle; and a good part of it: what bounces more than once is not computed.
    ///
    /// Integrated over 400 × 200 directions: highlights of roughness 0.3 and more are ten times as wide as their distance.
    #[test]
    fn no_energy_is_made() {
        let normal = DVec3::Z;
        for metallic in [0.0, 0.5, 1.0] {
            for roughness in [0.3, 0.5, 0.7, 1.0] {
                for elevation in [0.2f64, 0.6, 1.0] {
                    let across = (1.0 - elevation * elevation).sqrt();
                    let view = DVec3::new(across, 0.0, elevation);
                    let (rings, spokes) = (400, 200);
                    let mut total = 0.0;
                    for i in 0..rings {
                        let z = (f64::from(i) + 0.5) / f64::from(rings);
                        for j in 0..spokes {
                            let turn = (f64::from(j) + 0.5) / f64::from(spokes) * 2.0 * PI;
                            let r = (1.0 - z * z).sqrt();
                            let toward = DVec3::new(r * turn.cos(), r * turn.sin(), z);
                            let white = DVec3::ONE;
                            let f = reflectance(normal, view, toward, white, metallic, roughness);
                            total += f.x * z * 2.0 * PI / f64::from(rings * spokes);
                        }
                    }
                    let at =
                        format!("metallic {metallic}, roughness {roughness}, cosine {elevation}");
                    assert!(total <= 1.01, "{at}: {total}");
                    // Little bounces more than once from a smooth surface seen from above.
                    let nearly_all = elevation < 1.0 || roughness > 0.3 || total >= 0.85;
                    assert!(nearly_all && total > 0.2, "{at}: {total}");
                }
            }
        }
    }

    /// A light straight above a matt dielectric: the closed form of Lambert under the square law, plus the highlight.
    #[test]
    fn a_matt_surface_under_a_light() {
        let at = Point {
            position: DVec3::ZERO,
            normal: DVec3::Z,
            eye: 5.0 * DVec3::Z,
            ambient: 1.0,
        };
        let light = Light {
            source: Source::Point(2.0 * DVec3::Z),
            color: DVec3::new(8.0, 4.0, 0.0),
        };
        // D = 1/π and G = 1 for roughness 1, F = 0.04 each way.
        let found = physically_based(&at, DVec3::splat(0.5), 0.0, 1.0, &[light]);
        let reflected = 0.96 * 0.5 / PI * 0.96 + 0.04 * 0.25 / PI;
        let want = 0.015 + reflected * DVec3::new(2.0, 1.0, 0.0);
        assert!(found.abs_diff_eq(want, 1e-12), "{found:?}");
        let lit = phong(&at, DVec3::splat(0.5), 0.25, 20.0, &[light]);
        assert!((lit[0] - (0.05 + 8.0 * 0.75)).abs() < 1e-12, "{lit:?}");
    }
}
