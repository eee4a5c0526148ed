//! Hair.

use super::{MAX_TRIANGLES, Strands, length};
use crate::{error::within, mesh::Mesh};
use glam::{Vec2, Vec3};
use peelnet_core::random::Random;
use std::f32::consts::{PI, TAU};

/// Length of the shortest strand as a part of the longest.
const SHORTEST: f32 = 0.7;

/// Width at the tip as a part of the width at the root.
const TIP: f32 = 1.0 / 3.0;

/// Strands stay so far outside of the sphere, as a part of its radius.
const CLEARANCE: f32 = 0.02;

/// Turns of a curl along a strand.
const TURNS: f32 = 3.0;

impl Strands {
    /// Two for each rectangle.
    pub(super) const fn triangles(&self) -> usize {
        self.count.saturating_mul(self.segments).saturating_mul(2)
    }

    /// The ribbons, and UVs: u across a ribbon, v from its tip down to its root.
    pub(super) fn surface(&self) -> Result<Mesh, String> {
        self.check()?;
        let rows = self.segments + 1;
        let mut surface = Mesh::default();
        let mut random = Random::new(self.seed, &[0x4a_1e]);
        for strand in 0..self.count {
            let (course, mut side) = self.course(&mut random);
            for (i, &p) in course.iter().enumerate() {
                let t = i as f32 / self.segments as f32;
                let along = course[(i + 1).min(self.segments)] - course[i.saturating_sub(1)];
                let along = along.normalize_or(Vec3::NEG_Y);
                // The side is carried along, so that a ribbon does not twist where it bends.
                side =
                    (side - along * side.dot(along)).normalize_or(along.any_orthonormal_vector());
                let half = side * (self.width / 2.0 * (1.0 - t * (1.0 - TIP)));
                // Hair is lit by the direction away from the head, as if it were round.
                let out = p.normalize_or(Vec3::Y);
                let normal = (out - along * out.dot(along)).normalize_or(side.cross(along));
                surface.positions.extend([p - half, p + half]);
                surface.normals.extend([normal; 2]);
            }
            let base = (strand * rows * 2) as u32;
            for i in 0..self.segments as u32 {
                surface.push_rectangle([0, 1, 2, 3].map(|k| base + 2 * i + k));
            }
        }
        surface.unwrap(|i| {
            let along = (i / 2 % rows) as f32 / self.segments as f32;
            Vec2::new((i % 2) as f32, 1.0 - along)
        });
        Ok(surface)
    }

    /// Points along a strand from its root, and the direction of its width.
    fn course(&self, random: &mut Random) -> (Vec<Vec3>, Vec3) {
        // Heights of even area on a sphere are even (Archimedes).
        let y = random.between(self.roots, 1.0);
        let around = random.between(0.0, TAU);
        let ring = (1.0 - y * y).max(0.0).sqrt();
        let out = Vec3::new(ring * around.cos(), y, ring * around.sin());
        let length = self.length * random.between(SHORTEST, 1.0);
        let (phase, bend) = (random.between(0.0, TAU), random.between(0.6, 1.4));
        let side = out.any_orthonormal_vector();
        let turned = random.between(0.0, PI);
        let side = side * turned.cos() + out.cross(side) * turned.sin();
        let step = length / self.segments as f32;
        let least = self.radius * (1.0 + CLEARANCE);
        let (mut p, mut direction) = (out * least, out);
        let mut points = vec![p];
        for i in 0..self.segments {
            let pull = self.droop * bend * step / self.radius;
            direction = (direction + Vec3::NEG_Y * pull * 2.0).normalize_or(Vec3::NEG_Y);
            let a = phase + TAU * TURNS * i as f32 / self.segments as f32;
            let across = direction.any_orthonormal_vector();
            let wind = across * a.cos() + direction.cross(across) * a.sin();
            let mut next = p + (direction + wind * self.curl).normalize_or(direction) * step;
            if next.length() < least {
                next = next.normalize_or(out) * least;
                direction = (next - p).normalize_or(direction);
            }
            p = next;
            points.push(p);
        }
        (points, side)
    }

    fn check(&self) -> Result<(), String> {
        length("radius", self.radius)?;
        length("length", self.length)?;
        length("width", self.width)?;
        for (name, x, low, high) in [
            ("droop", self.droop, 0.0, 100.0),
            ("curl", self.curl, 0.0, 10.0),
            ("roots", self.roots, -1.0, 1.0),
        ] {
            within(name, x, low, high).map_err(|(name, message)| format!("{name} {message}"))?;
        }
        if !(2..=MAX_TRIANGLES).contains(&self.triangles()) {
            return Err(format!(
                "count {} and segments {} must be 1 or more, and twice their product at most {MAX_TRIANGLES}",
                self.count, self.segments
            ));
        }
        Ok(())
    }
}
