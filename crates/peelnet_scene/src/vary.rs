//! Variations of a scene, for training: the same geometry with other colours, opacities, cameras and scales.

use crate::{
    material::Lighting,
    scene::{Object, Scene},
};
use glam::{Quat, Vec3};
use peelnet_core::random::Random;

/// How a copy's opacities are drawn: from a number of the object, 0 … 1, one of the copy, and one of all objects as near. The hardest
/// cases for networks are among them: extremes in one pixel, near-opaque and very faint layers.
const SCHEMES: [fn(f32, f32, f32) -> f32; 6] = [
    // From the whole range.
    |own, _, _| 0.02 + 0.96 * own,
    |_, same, _| same,
    |own, _, _| if own < 0.5 { 0.02 } else { 0.98 },
    // All near-opaque, all faint.
    |own, _, _| 0.8 + 0.19 * own,
    |own, _, _| 0.02 + 0.18 * own,
    // Nearer objects one range, farther ones another.
    |own, _, band| (band + 0.1 * (own - 0.5)).clamp(0.02, 0.98),
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
        // No light suits both at another scale: light that falls off with the distance, and light that does not.
        let [phong, pbr] = [Lighting::Phong, Lighting::Pbr].map(|l| scene.has_lighting(l));
        if phong && pbr {
            return scene;
        }
        scene.scaled(10f32.powf(exponent))
    }
}

fn vary_materials(scene: &mut Scene, random: &mut Random) {
    let scheme = SCHEMES[random.below(SCHEMES.len())];
    let same = random.between(0.02, 0.98);
    let eye = scene.views[0].position;
    let distance = |o: &Object| (o.world_from_object.w_axis.truncate() - eye).length();
    let distances: Vec<f32> = scene.objects.iter().map(distance).collect();
    let mut sorted = distances.clone();
    sorted.sort_by(f32::total_cmp);
    let middle = sorted.get(sorted.len() / 2).copied().unwrap_or(0.0);
    let bands = [random.between(0.02, 0.98), random.between(0.02, 0.98)];
    for (object, distance) in scene.objects.iter_mut().zip(distances) {
        for material in &mut object.materials {
            // Drawn even for opaque surfaces, so that one more of them changes nothing else.
            let (color, u) = (random.color(), random.unit());
            material.color = color;
            if material.is_opaque() {
                continue;
            }
            let alpha = scheme(u, same, bands[usize::from(distance > middle)]);
            material.alpha_cutoff = material.cutoff_at(alpha);
            material.alpha = alpha;
            material.blend = true;
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
        let [along, up] = [tilted, turned.up].map(Vec3::normalize_or_zero);
        let steep = along.dot(up).abs() > 0.99;
        let offset = if steep { offset } else { tilted };
        *view = turned;
        view.position = turned.target + offset * distance;
        view.far *= distance.max(1.0);
        view.fov_y_degrees = (view.fov_y_degrees * fov).clamp(5.0, 120.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        material::Material,
        scene::{Light, Source},
    };

    fn scene(materials: &[Material]) -> Scene {
        let mut scene = crate::suite::load("cups").unwrap();
        scene.objects.truncate(materials.len());
        for (object, material) in scene.objects.iter_mut().zip(materials) {
            object.materials.fill(material.clone());
        }
        scene.lights = vec![Light {
            source: Source::Point(Vec3::new(1.0, 2.0, 3.0)),
            color: [1.0; 3],
            intensity: 5.0,
        }];
        scene
    }

    /// What falls off with the square of the distance arrives as bright at every scale; so does what does not fall off.
    #[test]
    fn light_is_as_bright_at_every_scale() {
        let [phong, pbr] = [Lighting::Phong, Lighting::Pbr].map(Material::default_with);
        let place = |scene: &Scene| match scene.lights[0].source {
            Source::Point(place) => place.length(),
            Source::Toward(_) => unreachable!("the light is a point"),
        };
        for copy in 1..9 {
            for (materials, power) in [(vec![phong.clone()], 0), (vec![pbr.clone()], 2)] {
                let scene = scene(&materials);
                let copy = scene.varied(1, copy);
                let factor = place(&copy) / place(&scene);
                let arriving = copy.lights[0].intensity / factor.powi(power);
                assert!((arriving / 5.0 - 1.0).abs() < 1e-4, "{factor}: {arriving}");
            }
            let both = scene(&[phong.clone(), pbr.clone()]);
            assert_eq!(both.varied(1, copy).lights, both.lights);
        }
    }

    /// A cut-out that is thinned keeps its holes, and gets no others.
    #[test]
    fn cut_outs_keep_their_holes() {
        let material = Material {
            alpha_cutoff: Some(0.25),
            blend: true,
            ..Material::unlit([1.0; 3], 0.5)
        };
        for copy in 1..9 {
            let copy = scene(std::slice::from_ref(&material)).varied(1, copy);
            let Material {
                alpha,
                alpha_cutoff,
                ..
            } = copy.objects[0].materials[0];
            assert!((alpha_cutoff.unwrap() / alpha - 0.5).abs() < 1e-6);
        }
    }
}
