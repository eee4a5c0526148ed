//! Scenes of unlit cards: every pixel's colour follows from their planes alone.

use bevy::prelude::*;

/// A rectangle of one colour, seen from both sides.
#[derive(Clone, Copy, Debug)]
pub struct Card {
    /// Places the square of side 1 in the xy plane.
    pub transform: Transform,
    /// Linear, not multiplied by alpha.
    pub color: LinearRgba,
}

pub const BACKGROUND: LinearRgba = LinearRgba::new(0.25, 0.5, 0.75, 1.0);

/// Where the camera of all scenes stands. It looks at the origin.
pub const EYE: Vec3 = Vec3::new(0.0, 0.0, 6.0);

pub fn card(at: [f32; 3], size: [f32; 2], color: [f32; 4]) -> Card {
    Card {
        transform: Transform::from_translation(at.into())
            .with_scale(Vec3::new(size[0], size[1], 1.0)),
        color: LinearRgba::from_f32_array(color),
    }
}

/// Two overlapping cards, the red one in front. Bevy sorts by the middle of a mesh, seen from the camera's plane, and gets these right.
pub fn two() -> Vec<Card> {
    vec![
        card([-0.5, 0.0, 1.0], [2.5, 2.0], [1.0, 0.0, 0.0, 0.5]),
        card([0.5, 0.0, -1.0], [3.0, 3.0], [0.0, 1.0, 0.0, 0.5]),
    ]
}

/// Two cards that face the camera: culled materials show their fronts.
pub fn facing() -> [Card; 2] {
    let [mut first, mut second] = <[Card; 2]>::try_from(two()).expect("two cards");
    first.color.alpha = 0.6;
    second.color.alpha = 0.7;
    [first, second]
}

/// Two cards that cut each other: no order of the two is right.
pub fn crossing() -> Vec<Card> {
    let turned = |angle, color| {
        let mut card = card([0.0; 3], [3.0, 3.0], color);
        card.transform.rotation = Quat::from_rotation_y(angle);
        card
    };
    vec![
        turned(0.7, [1.0, 0.0, 0.0, 0.5]),
        turned(-0.7, [0.0, 1.0, 0.0, 0.7]),
    ]
}

/// Many cards of any size, opacity and direction, that cut one another, around an opaque one.
pub fn many(count: usize) -> Vec<Card> {
    // A linear congruential generator: the same scene everywhere. In 0 .. 1.
    let mut state = 1u64;
    let mut one = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / (1u64 << 24) as f32
    };
    let mut opaque = card([0.3, -0.2, 0.0], [0.8, 2.6], [0.9, 0.8, 0.1, 1.0]);
    opaque.transform.rotation = Quat::from_rotation_y(0.3);
    let transparent = (0..count).map(|_| {
        let at = [one() * 3.0 - 1.5, one() * 3.0 - 1.5, one() * 4.0 - 2.0];
        let size = [one() * 2.0 + 0.8, one() * 2.0 + 0.8];
        let color = [one(), one(), one(), 0.15 + 0.7 * one()];
        let turn = Quat::from_euler(
            EulerRot::YXZ,
            one() * 2.4 - 1.2,
            one() * 2.4 - 1.2,
            one() * 3.0,
        );
        let mut card = card(at, size, color);
        card.transform.rotation = turn;
        card
    });
    std::iter::once(opaque).chain(transparent).collect()
}

pub fn material(color: LinearRgba) -> StandardMaterial {
    StandardMaterial {
        unlit: true,
        double_sided: true,
        cull_mode: None,
        // Blended where it is not opaque.
        ..Color::from(color).into()
    }
}

pub fn spawn_of<M: Material>(app: &mut App, card: &Card, material: M) -> Entity {
    let world = app.world_mut();
    let mesh = Rectangle::new(1.0, 1.0);
    let mesh = world.resource_mut::<Assets<Mesh>>().add(mesh);
    let material = world.resource_mut::<Assets<M>>().add(material);
    let parts = (Mesh3d(mesh), MeshMaterial3d(material), card.transform);
    world.spawn(parts).id()
}

/// Adds cards to an application, and says their entities.
pub fn spawn(app: &mut App, cards: &[Card]) -> Vec<Entity> {
    let spawn = |card: &Card| spawn_of(app, card, material(card.color));
    cards.iter().map(spawn).collect()
}
