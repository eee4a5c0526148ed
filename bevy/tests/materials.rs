//! Materials: those of Bevy, lit; those with a hook; those without.

#[path = "../examples/support/mod.rs"]
mod support;

use bevy::{
    asset::uuid_handle,
    pbr::{ExtendedMaterial, MaterialExtension},
    prelude::*,
    reflect::TypePath,
    render::render_resource::AsBindGroup,
    shader::{Shader, ShaderRef},
};
use bevy_peelnet::{Gravity, PeelnetPlugin};
use support::{
    cards::{self, spawn_of},
    headless::Headless,
};

const SIZE: UVec2 = UVec2::new(256, 192);

const HOOKED: Handle<Shader> = uuid_handle!("6d1c1f9e-6f0b-4b53-9b8e-0a5a3c9d7e01");
const PLAIN: Handle<Shader> = uuid_handle!("6d1c1f9e-6f0b-4b53-9b8e-0a5a3c9d7e02");

const SHARED: &str = "
import bevy_pbr::render::forward_io::VertexOutput;

@group(constants::MATERIAL_BIND_GROUP) @binding(0) var<uniform> material_color: vec4f;

@if(!PEELNET)
@fragment
fn fragment(in: VertexOutput) -> @location(0) vec4f {
    return material_color;
}
";

const IMPORT: &str = "
@if(PEELNET)
import bevy_peelnet::draw::{PeelnetOutput, peelnet_output};
";

const HOOK: &str = "
@if(PEELNET)
@fragment
fn fragment(in: VertexOutput, @builtin(sample_index) sample_index: u32) -> PeelnetOutput {
    return peelnet_output(in.position, sample_index, material_color);
}
";

/// A material with a fragment shader of its own: one that takes part, or one that does not.
#[derive(Asset, AsBindGroup, Clone, TypePath)]
struct Own<const TAKES_PART: bool> {
    #[uniform(0)]
    color: LinearRgba,
}

impl<const TAKES_PART: bool> Material for Own<TAKES_PART> {
    fn fragment_shader() -> ShaderRef {
        if TAKES_PART { HOOKED } else { PLAIN }.into()
    }

    fn alpha_mode(&self) -> AlphaMode {
        AlphaMode::Blend
    }
}

type Hooked = Own<true>;
type Plain = Own<false>;

/// Adds a number to Bevy's material, and keeps its shaders.
#[derive(Asset, AsBindGroup, Clone, TypePath)]
struct Extension {
    #[uniform(100)]
    number: f32,
}

impl MaterialExtension for Extension {}

type Extended = ExtendedMaterial<StandardMaterial, Extension>;

fn application(msaa: Msaa) -> Headless {
    let mut headless = Headless::new(SIZE, msaa, PeelnetPlugin::default(), &[]).learned();
    let app = &mut headless.app;
    app.add_plugins((
        MaterialPlugin::<Hooked>::default(),
        MaterialPlugin::<Plain>::default(),
        MaterialPlugin::<Extended>::default(),
    ));
    let mut shaders = app.world_mut().resource_mut::<Assets<Shader>>();
    // Imports stand first.
    let hooked = [IMPORT, SHARED, HOOK].concat();
    let plain = SHARED.to_owned();
    for (handle, text, name) in [(HOOKED, hooked, "hooked"), (PLAIN, plain, "plain")] {
        let shader = Shader::from_wesl(text, format!("tests/{name}.wesl"));
        shaders
            .insert(handle.id(), shader)
            .expect("a constant handle");
    }
    headless
}

/// Two cards in these materials are exact but for this, and nothing is reported.
fn check<M: Material, N: Material>(
    msaa: Msaa,
    most: f64,
    near: impl Fn(LinearRgba) -> M,
    far: impl Fn(LinearRgba) -> N,
) {
    let scene = cards::facing();
    let mut headless = application(msaa);
    spawn_of(&mut headless.app, &scene[0], near(scene[0].color));
    spawn_of(&mut headless.app, &scene[1], far(scene[1].color));
    headless.assert_exact(&scene, most);
    assert_eq!(headless.messages(), []);
}

#[test]
fn materials_with_the_hook_and_extensions_are_weighed_like_bevys() {
    for msaa in [Msaa::Off, Msaa::Sample4] {
        check(msaa, 1.5, cards::material, |color| Hooked { color });
    }
    let extended = |color| Extended {
        base: cards::material(color),
        extension: Extension { number: 1.0 },
    };
    check(Msaa::Off, 1.0, extended, cards::material);
    let premultiplied = |color: LinearRgba| StandardMaterial {
        base_color: (color * color.alpha).with_alpha(color.alpha).into(),
        alpha_mode: AlphaMode::Premultiplied,
        ..cards::material(color)
    };
    check(Msaa::Off, 1.0, premultiplied, premultiplied);
}

#[test]
fn a_material_without_the_hook_is_drawn_by_bevy_and_said_once() {
    let scene = cards::facing();
    let [near, far] = &scene;
    let mut headless = application(Msaa::Off);
    // In front, where Bevy's drawing after the weighed surfaces is right.
    spawn_of(&mut headless.app, near, Plain { color: near.color });
    spawn_of(&mut headless.app, far, cards::material(far.color));
    headless.assert_exact(&scene, 1.0);
    let says = ["does not import bevy_peelnet::draw"];
    headless.assert_said(Gravity::Warning, &says);
}

#[test]
fn light_falls_on_weighed_surfaces_as_on_sorted_ones() {
    let mut headless = application(Msaa::Off);
    for card in cards::facing() {
        let lit = StandardMaterial {
            unlit: false,
            ..cards::material(card.color)
        };
        spawn_of(&mut headless.app, &card, lit);
    }
    let light = (PointLight::default(), Transform::from_xyz(1.0, 1.0, 3.0));
    headless.app.world_mut().spawn(light);
    let sorted = headless.same_when_sorted();
    // And the light is seen: the near card is not of one colour.
    let row = &sorted[(4 * SIZE.x * SIZE.y / 2) as usize..][..(4 * SIZE.x) as usize];
    let reds: std::collections::HashSet<u8> = row.chunks(4).map(|pixel| pixel[0]).collect();
    assert!(reds.len() > 5, "{reds:?}");
}

#[test]
fn sums_of_light_stay_with_bevy() {
    let [near, far] = cards::facing();
    let mut headless = application(Msaa::Off);
    let added = StandardMaterial {
        alpha_mode: AlphaMode::Add,
        ..cards::material(near.color)
    };
    spawn_of(&mut headless.app, &near, added);
    spawn_of(&mut headless.app, &far, cards::material(far.color));
    headless.same_when_sorted();
}
