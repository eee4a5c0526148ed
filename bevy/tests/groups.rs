//! Devices with four bind groups, as browsers have: Bevy's own bindings are still right in the group that is shared.

#[path = "../examples/support/mod.rs"]
mod support;

use bevy::{
    asset::RenderAssetUsages,
    light::{ClusteredDecal, EnvironmentMapLight, IrradianceVolume, LightProbe},
    pbr::decal::clustered::clustered_decals_are_usable,
    prelude::*,
    render::{
        RenderApp,
        render_resource::{Extent3d, TextureDimension, TextureFormat, WgpuLimits},
        renderer::RenderAdapter,
        settings::WgpuSettings,
    },
};
use bevy_peelnet::PeelnetPlugin;
use support::{
    cards::{self, spawn_of},
    headless::Headless,
};

const SIZE: UVec2 = UVec2::new(128, 96);

/// Of a device with four bind groups.
fn settings() -> WgpuSettings {
    // All else is as the adapter has it.
    let mut usual = Headless::new(SIZE, Msaa::Off, PeelnetPlugin::default(), &[]);
    usual.run(1);
    let render = usual.app.sub_app(RenderApp).world();
    let limits = WgpuLimits {
        max_bind_groups: 4,
        ..render.resource::<RenderAdapter>().limits()
    };
    WgpuSettings {
        constrained_limits: Some(limits),
        ..default()
    }
}

fn image(size: [u32; 3], dimension: TextureDimension, color: [u8; 4]) -> Image {
    let [width, height, depth_or_array_layers] = size;
    let size = Extent3d {
        width,
        height,
        depth_or_array_layers,
    };
    let format = TextureFormat::Rgba8UnormSrgb;
    let usage = RenderAssetUsages::default();
    Image::new_fill(size, dimension, &color, format, usage)
}

/// Cards that nothing but their surroundings light: a map around all, a volume on the left, and a decal on a part of that.
fn surrounded() -> Headless {
    let plugin = PeelnetPlugin::default();
    let mut headless = Headless::with_settings(SIZE, Msaa::Off, plugin, &[], settings()).learned();
    for card in cards::facing() {
        let lit = StandardMaterial {
            unlit: false,
            ..cards::material(card.color)
        };
        spawn_of(&mut headless.app, &card, lit);
    }
    // None of the images is white, as those are that stand in for missing ones.
    let mut images = headless.app.world_mut().resource_mut::<Assets<Image>>();
    let mut map = EnvironmentMapLight::solid_color(&mut images, Color::linear_rgb(0.1, 0.5, 0.8));
    // Where a volume is in view, maps give their reflections alone.
    map.intensity = 6000.0;
    // One voxel: two signs of three axes.
    let voxels = images.add(image([1, 2, 3], TextureDimension::D3, [120, 90, 30, 255]));
    let decal = images.add(image([1, 1, 1], TextureDimension::D2, [20, 30, 255, 255]));
    headless.camera().insert(map);
    let volume = IrradianceVolume {
        voxels,
        intensity: 4000.0,
        ..default()
    };
    let decal = ClusteredDecal {
        base_color_texture: Some(decal),
        ..default()
    };
    let left = Transform::from_xyz(-2.25, 0.0, 0.0).with_scale(Vec3::new(2.0, 9.0, 9.0));
    let part = Transform::from_xyz(-1.5, 0.7, 1.0).with_scale(Vec3::splat(0.5));
    let world = headless.app.world_mut();
    world.spawn((LightProbe::default(), volume, left));
    world.spawn((decal, part));
    headless
}

#[test]
fn cards_are_exact() {
    let scene = cards::crossing();
    let plugin = PeelnetPlugin::default();
    let headless = Headless::with_settings(SIZE, Msaa::Off, plugin, &scene, settings());
    let mut headless = headless.learned();
    headless.assert_exact(&scene, 1.0);
    assert_eq!(headless.messages(), []);
}

#[test]
fn light_of_the_surroundings_and_decals_are_bevys() {
    let mut headless = surrounded();
    headless.run(1);
    let render = headless.app.sub_app(RenderApp).world();
    let (device, adapter) = (render.resource(), render.resource());
    // Bevy's decals need arrays of textures.
    let has_decals = clustered_decals_are_usable(device, adapter);
    let picture = headless.same_when_sorted();
    // And they are seen. All three pixels are of the red card alone, over the background.
    let [in_volume, in_map, in_decal] = [[29, 60], [41, 60], [29, 32]].map(|[x, y]| {
        let at = 4 * (y * SIZE.x as usize + x);
        &picture[at..at + 4]
    });
    // Unlit it would be 149.
    assert!(in_map[2] > 155, "{in_map:?}");
    assert!(in_volume[0] > 10 + in_map[0], "{in_volume:?}, {in_map:?}");
    assert_eq!(in_decal != in_volume, has_decals, "{in_decal:?}");
}
