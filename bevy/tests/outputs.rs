//! What other render systems get: depth and coverage of the weighed surfaces.

#[path = "../examples/support/mod.rs"]
mod support;

use bevy::{
    core_pipeline::schedule::{Core3d, Core3dSystems},
    prelude::*,
    render::{
        RenderApp,
        render_resource::*,
        renderer::{RenderContext, RenderDevice, ViewQuery},
        view::ViewDepthStencilTexture,
    },
};
use bevy_peelnet::{CoverageMask, LearnedTransparency, PeelnetModel};
use support::{
    cards::{self, Card},
    headless::Headless,
};

/// A row of the mask is as long as copies must be aligned.
const SIZE: UVec2 = UVec2::new(128, 96);
/// The near plane of Bevy's cameras.
const NEAR: f32 = 0.1;
/// What 16 bits of sums and of the mask may round.
const ROUNDED: f32 = 1.0 / 512.0;

/// Two cards of half opacity, the left one at a distance of 5 and the right one at 7, and something barely there in front of all.
fn scene() -> Vec<Card> {
    let mut scene = cards::two();
    scene.push(cards::card(
        [0.0, 0.0, 3.0],
        [20.0, 20.0],
        [1.0, 1.0, 1.0, 0.002],
    ));
    scene
}

/// Pixels of the left card alone, of both, of the right one alone, and of neither.
const PIXELS: [u32; 4] = [35, 64, 90, 115];

/// Where a system of the application's own copies both to.
#[derive(Resource)]
struct Copies {
    depth: Buffer,
    mask: Buffer,
}

fn copy(
    view: ViewQuery<(&ViewDepthStencilTexture, Option<&CoverageMask>)>,
    copies: Option<Res<Copies>>,
    mut context: RenderContext<'_, '_>,
) {
    let (depth, mask) = view.into_inner();
    let Some(copies) = copies else { return };
    let mut copy = |texture: &Texture, buffer, bytes| {
        let into = TexelCopyBufferInfo {
            buffer,
            layout: TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(bytes * SIZE.x),
                rows_per_image: None,
            },
        };
        let encoder = context.command_encoder();
        encoder.copy_texture_to_buffer(texture.as_image_copy(), into, texture.size());
    };
    if depth.texture().sample_count() == 1 {
        copy(depth.texture(), &copies.depth, 4);
    }
    if let Some(CoverageMask(mask)) = mask {
        copy(&mask.texture, &copies.mask, 2);
    }
}

/// Depth and mask at the four pixels, in the middle row.
fn outputs(msaa: Msaa, settings: LearnedTransparency) -> ([f32; 4], [f32; 4]) {
    let mut headless = Headless::new(SIZE, msaa, PeelnetModel::medium(), &scene()).learned();
    let mut camera = headless.camera();
    let mut camera = camera.get_mut::<Camera3d>().expect("is a camera");
    camera.depth_texture_usages.0 |= TextureUsages::COPY_SRC.bits();
    let render = headless.app.sub_app_mut(RenderApp);
    render.add_systems(
        Core3d,
        copy.after(Core3dSystems::EarlyPostProcess)
            .before(Core3dSystems::PostProcess),
    );
    // Asked for while running.
    headless.picture();
    headless.camera().insert(settings);
    let render = headless.app.sub_app_mut(RenderApp).world_mut();
    let device = render.resource::<RenderDevice>().clone();
    let [depth, mask] = [4, 2].map(|bytes| {
        device.create_buffer(&BufferDescriptor {
            label: None,
            size: u64::from(bytes * SIZE.x * SIZE.y),
            usage: BufferUsages::COPY_DST | BufferUsages::MAP_READ,
            mapped_at_creation: false,
        })
    });
    let copies = [depth.clone(), mask.clone()];
    render.insert_resource(Copies { depth, mask });
    headless.picture();
    let render = headless.app.sub_app_mut(RenderApp).world_mut();
    render.remove_resource::<Copies>();
    let [depth, mask] = copies.map(|buffer| {
        buffer.map_async(MapMode::Read, .., |result| result.expect("is mapped"));
        device.poll(PollType::wait_indefinitely()).expect("waits");
        let bytes = buffer.get_mapped_range(..).expect("is mapped").to_vec();
        let row = bytes.len() / SIZE.y as usize;
        bytes[row * (SIZE.y as usize / 2)..][..row].to_vec()
    });
    let depth = PIXELS.map(|x| {
        let at = 4 * x as usize;
        f32::from_le_bytes(depth[at..at + 4].try_into().expect("four bytes"))
    });
    let mask = PIXELS.map(|x| {
        let at = 2 * x as usize;
        half(u16::from_le_bytes([mask[at], mask[at + 1]]))
    });
    (depth, mask)
}

/// A half float of at least 2⁻¹⁴, or zero.
fn half(bits: u16) -> f32 {
    if bits == 0 {
        return 0.0;
    }
    let exponent = i32::from(bits >> 10) - 15;
    (1.0 + f32::from(bits & 0x3ff) / 1024.0) * 2f32.powi(exponent)
}

fn assert_near(found: [f32; 4], expected: [f32; 4], most: f32) {
    let mut pairs = found.into_iter().zip(expected);
    assert!(
        pairs.all(|(a, b)| (a - b).abs() <= most),
        "{found:?}, not {expected:?}"
    );
}

#[test]
fn depth_is_that_of_the_nearest_surface_where_enough_is_covered() {
    let [left, right] = [NEAR / 5.0, NEAR / 7.0];
    for (depth_threshold, expected) in [
        (None, [0.0; 4]),
        (Some(0.4), [left, left, right, 0.0]),
        (Some(0.6), [0.0, left, 0.0, 0.0]),
        (Some(0.8), [0.0; 4]),
    ] {
        let settings = LearnedTransparency {
            depth_threshold,
            ..default()
        };
        let (depth, _) = outputs(Msaa::Off, settings);
        assert_near(depth, expected, 1e-6);
    }
}

#[test]
fn the_mask_is_the_opacity_of_all_surfaces_together() {
    let asked = LearnedTransparency {
        mask: true,
        ..default()
    };
    let expected = [0.5, 0.5 * 0.5, 0.5, 1.0].map(|clear| 1.0 - clear * 0.998);
    for msaa in [Msaa::Off, Msaa::Sample4] {
        let (depth, mask) = outputs(msaa, asked);
        assert_near(mask, expected, ROUNDED);
        // Depth is not asked for.
        assert_near(depth, [0.0; 4], 0.0);
    }
    // The buffer is as it was made: nothing is written.
    let (_, mask) = outputs(Msaa::Off, LearnedTransparency::default());
    assert_near(mask, [0.0; 4], 0.0);
}
