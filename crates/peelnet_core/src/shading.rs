//! Shading in 64 bits: the twin of `shaders/scene/shade.wgsl`, which cites the sources.

use std::f64::consts::PI;

/// A vector, or a linear RGB colour.
pub type V3 = [f64; 3];

/// A light: where it comes from, and linear RGB times intensity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// A place in world space, or the direction of a light without one.
    pub source: Source,
    /// Linear RGB times intensity.
    pub color: V3,
}

/// Where light comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Source {
    /// A place.
    Point(V3),
    /// A direction, of length 1.
    Toward(V3),
}

impl Light {
    /// The direction to it, and what falls off its light by the square law.
    fn seen_from(&self, position: V3) -> (V3, f64) {
        match self.source {
            Source::Toward(direction) => (direction, 1.0),
            Source::Point(place) => {
                let apart = between(position, place);
                let squared = dot(apart, apart).max(1e-8);
                (apart.map(|x| x / squared.sqrt()), squared)
            }
        }
    }
}

/// A surface at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// World space.
    pub position: V3,
    /// Unit normal, either side.
    pub normal: V3,
    /// The eye's position.
    pub eye: V3,
    /// Share of the ambient light that arrives.
    pub ambient: f64,
}

fn dot(a: V3, b: V3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn between(a: V3, b: V3) -> V3 {
    [b[0] - a[0], b[1] - a[1], b[2] - a[2]]
}

fn normalised(v: V3) -> V3 {
    let length = dot(v, v).sqrt();
    v.map(|x| x / length)
}

fn sum(a: V3, b: V3) -> V3 {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// View direction, and the normal on its side.
fn frame(at: &Point) -> (V3, V3) {
    let view = normalised(between(at.position, at.eye));
    let towards = dot(at.normal, view) >= 0.0;
    let normal = if towards {
        at.normal
    } else {
        at.normal.map(|x| -x)
    };
    (view, normal)
}

/// Blinn–Phong (Blinn 1977): 10 % ambient, diffuse, and a highlight of the light's colour.
pub fn phong(at: &Point, color: V3, specular: f64, shininess: f64, lights: &[Light]) -> V3 {
    let (view, normal) = frame(at);
    let mut radiance = color.map(|c| 0.1 * at.ambient * c);
    for light in lights {
        let (toward, _) = light.seen_from(at.position);
        let diffuse = dot(normal, toward).max(0.0);
        let halfway = normalised(sum(toward, view));
        let highlight = if diffuse > 0.0 {
            dot(normal, halfway).max(0.0).powf(shininess)
        } else {
            0.0
        };
        for k in 0..3 {
            radiance[k] += light.color[k] * (color[k] * diffuse + specular * highlight);
        }
    }
    radiance
}

/// What a physically based surface reflects of light that arrives along `toward` into `view`, both unit vectors on the normal's
/// side: Cook–Torrance and Lambert, not yet times the cosine.
pub fn reflectance(
    normal: V3,
    view: V3,
    toward: V3,
    albedo: V3,
    metallic: f64,
    roughness: f64,
) -> V3 {
    let roughness = roughness.max(0.04);
    let (a, k) = (roughness * roughness, (roughness + 1.0).powi(2) / 8.0);
    let halfway = normalised(sum(toward, view));
    let n_v = dot(normal, view).max(1e-4);
    let (n_l, n_h) = (dot(normal, toward).max(0.0), dot(normal, halfway).max(0.0));
    let spread = n_h * n_h * (a * a - 1.0) + 1.0;
    let distribution = a * a / (PI * spread * spread);
    let shadowing = 1.0 / ((n_l * (1.0 - k) + k) * (n_v * (1.0 - k) + k));
    let grazing = |cosine: f64| (1.0 - cosine).clamp(0.0, 1.0).powi(5);
    // What a dielectric scatters inside went in at the light's angle and comes out at the eye's.
    let inside = 0.96 * 0.96 * (1.0 - grazing(n_l)) * (1.0 - grazing(n_v));
    let diffuse = inside * (1.0 - metallic) / PI;
    albedo.map(|albedo| {
        let head_on = 0.04 + (albedo - 0.04) * metallic;
        let fresnel = head_on + (1.0 - head_on) * grazing(dot(halfway, view));
        diffuse * albedo + distribution * shadowing * 0.25 * fresnel
    })
}

/// Physically based shading by lights, of which those with a place fall off with the square of the distance, and 3 % ambient.
pub fn physically_based(
    at: &Point,
    albedo: V3,
    metallic: f64,
    roughness: f64,
    lights: &[Light],
) -> V3 {
    let (view, normal) = frame(at);
    let mut radiance = albedo.map(|c| 0.03 * at.ambient * c);
    for light in lights {
        let (toward, squared) = light.seen_from(at.position);
        let n_l = dot(normal, toward).max(0.0);
        let part = reflectance(normal, view, toward, albedo, metallic, roughness);
        for k in 0..3 {
            radiance[k] += part[k] * light.color[k] / squared * n_l;
        }
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
        let normal = [0.0, 0.0, 1.0];
        for metallic in [0.0, 0.5, 1.0] {
            for roughness in [0.3, 0.5, 0.7, 1.0] {
                for elevation in [0.2f64, 0.6, 1.0] {
                    let view = normalised([(1.0 - elevation * elevation).sqrt(), 0.0, elevation]);
                    let (rings, spokes) = (400, 200);
                    let mut total = 0.0;
                    for i in 0..rings {
                        let z = (f64::from(i) + 0.5) / f64::from(rings);
                        for j in 0..spokes {
                            let turn = (f64::from(j) + 0.5) / f64::from(spokes) * 2.0 * PI;
                            let r = (1.0 - z * z).sqrt();
                            let toward = [r * turn.cos(), r * turn.sin(), z];
                            let f =
                                reflectance(normal, view, toward, [1.0; 3], metallic, roughness);
                            total += f[0] * z * 2.0 * PI / f64::from(rings * spokes);
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
            position: [0.0; 3],
            normal: [0.0, 0.0, 1.0],
            eye: [0.0, 0.0, 5.0],
            ambient: 1.0,
        };
        let light = Light {
            source: Source::Point([0.0, 0.0, 2.0]),
            color: [8.0, 4.0, 0.0],
        };
        // D = 1/π and G = 1 for roughness 1, F = 0.04 each way.
        let found = physically_based(&at, [0.5; 3], 0.0, 1.0, &[light]);
        let reflected = 0.96 * 0.5 / PI * 0.96 + 0.04 * 0.25 / PI;
        for (k, arriving) in [2.0, 1.0, 0.0].into_iter().enumerate() {
            assert!(
                (found[k] - (0.015 + reflected * arriving)).abs() < 1e-12,
                "{found:?}"
            );
        }
        let lit = phong(&at, [0.5; 3], 0.25, 20.0, &[light]);
        assert!((lit[0] - (0.05 + 8.0 * 0.75)).abs() < 1e-12, "{lit:?}");
    }
}
