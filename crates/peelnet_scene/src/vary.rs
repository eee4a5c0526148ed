//! Variations of a scene, for training: the same geometry with other colours, opacities, cameras and scales.

use crate::{material::Material, scene::Scene};
use glam::{Quat, Vec3};
use peelnet_core::random::Random;

/// How a copy's opacities are drawn. The hardest cases for networks are among them: extremes in one pixel, near-opaque and
/// very faint layers.
#[derive(Clone, Copy, Debug)]
enum Alphas {
    /// Each object its own, from the whole range.
    Uniform,
    /// One for all.
    Same,
    /// Each object nearly nothing or nearly opaque.
    Extremes,
    /// All near-opaque.
    Dense,
    /// All faint.
    Faint,
    /// Nearer objects one range, farther ones another.
    Bands,
}

const SCHEMES: [Alphas; 6] = [
    Alphas::Uniform,
    Alphas::Same,
    Alphas::Extremes,
    Alphas::Dense,
    Alphas::Faint,
    Alphas::Bands,
];

impl Scene {
    /// The variation number `copy`, drawn from the seed, the scene's name and the number alone; copy 0 is the scene itself.
    pub fn varied(&self, seed: u64, copy: u32) -> Self {
        if copy == 0 {
            return self.clone();
        }
        let mut words: Vec<u64> = self.name.bytes().map(u64::from).collect();
        words.push(copy.into());
        let mut random = Random::new(seed, &words);
        let mut scene = self.clone();
        vary_materials(&mut scene, &mut random);
        vary_cameras(&mut scene, &mut random);
        let exponent = random.between(-2.0, 2.0);
        scene = scene.scaled(10f32.powf(exponent));
        scene
    }
}

fn vary_materials(scene: &mut Scene, random: &mut Random) {
    let scheme = SCHEMES[random.below(SCHEMES.len())];
    let same = random.between(0.02, 0.98);
    let eye = scene.views[0].position;
    let mut distances: Vec<f32> = scene
        .objects
        .iter()
        .map(|o| (o.world_from_object.w_axis.truncate() - eye).length())
        .collect();
    let of: Vec<f32> = distances.clone();
    distances.sort_by(f32::total_cmp);
    let middle = distances.get(distances.len() / 2).copied().unwrap_or(0.0);
    let bands = [random.between(0.02, 0.98), random.between(0.02, 0.98)];
    for (object, distance) in scene.objects.iter_mut().zip(of) {
        for material in &mut object.materials {
            // Drawn even for opaque surfaces, so that one more of them changes nothing else.
            let (color, u) = (random.color(), random.unit());
            material.color = color;
            if material.is_opaque() {
                continue;
            }
            let alpha = match scheme {
                Alphas::Uniform => 0.02 + 0.96 * u,
                Alphas::Same => same,
                Alphas::Extremes => {
                    if u < 0.5 {
                        0.02
                    } else {
                        0.98
                    }
                }
                Alphas::Dense => 0.8 + 0.19 * u,
                Alphas::Faint => 0.02 + 0.18 * u,
                Alphas::Bands => {
                    (bands[usize::from(distance > middle)] + 0.1 * (u - 0.5)).clamp(0.02, 0.98)
                }
            };
            *material = Material {
                alpha,
                blend: true,
                ..material.clone()
            };
        }
    }
}

fn vary_cameras(scene: &mut Scene, random: &mut Random) {
    let yaw = random.between(0.0, 360.0);
    let pitch = random.between(-15.0, 15.0);
    let distance = random.between(0.8, 1.5);
    let fov = random.between(0.8, 1.25);
    for view in &mut scene.views {
        let turned = view.orbited(yaw);
        let offset = turned.position - turned.target;
        let side = offset.cross(turned.up).normalize_or(Vec3::X);
        let tilted = Quat::from_axis_angle(side, pitch.to_radians()) * offset;
        // A pitch that would look along `up` is left out.
        let steep = tilted
            .normalize_or_zero()
            .dot(turned.up.normalize_or_zero())
            .abs()
            > 0.99;
        let offset = if steep { offset } else { tilted };
        *view = turned;
        view.position = turned.target + offset * distance;
        view.far *= distance.max(1.0);
        view.fov_y_degrees = (view.fov_y_degrees * fov).clamp(5.0, 120.0);
    }
}
