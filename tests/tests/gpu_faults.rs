use peelnet_core::fragment::Fragment;
use peelnet_peel::{
    Peel,
    read_back::{FragmentReader, RawTile},
};
use peelnet_render::gpu::{Gpu, GpuError};
use peelnet_render::{MethodOptions, MethodSpec, PixelSample, RenderError, Renderer};
use peelnet_tests::{assert_refused, frame, gpu, prepare, walls};

fn stack() -> Vec<Fragment> {
    (0..20)
        .map(|i| Fragment::new(1.0 + i as f32, 0.2, [i as f32 / 20.0, 0.5, 0.1]))
        .collect()
}

/// Storage for all fragments does not fit: the frame is drawn in smaller tiles, all fragments are there, and it is reported.
#[test]
fn full_memory_makes_smaller_tiles() {
    let mut gpu = gpu();
    let size = [64, 48];
    let scene = walls(&stack(), [0.1, 0.2, 0.3]);
    let draw = |gpu: &Gpu| frame(gpu, &scene, "abuffer", MethodOptions::sized(size));
    let whole = draw(&gpu);
    assert!(whole.stats.tiles == 1 && !gpu.memory_was_full());
    // 64 x 48 pixels of 20 colours of 16 bytes are 983,040 bytes; targets of 16 bytes a pixel fit.
    gpu.pretend_memory(100_000);
    let tiled = draw(&gpu);
    // Halved until it fits: 983,040 / 16.
    assert_eq!(tiled.stats.tiles, 16);
    assert_eq!(tiled.stats.fragments, whole.stats.fragments);
    assert_eq!(tiled.image, whole.image);
    assert!(gpu.memory_was_full());

    let mut reader = FragmentReader::new(&gpu, &scene, size, Peel::SBuffer, false, None).unwrap();
    let mut fragments = 0;
    let take = |tile: &mut RawTile| {
        fragments += tile.depths.len();
        Ok(())
    };
    let (view, all) = (&scene.views[0], PixelSample::ALL);
    let found = reader.read_view(view, all, None, take).unwrap();
    assert_eq!((fragments, found.tiles), (64 * 48 * 20, 16));
}

/// Where not even the frame's targets fit, or a single pixel's fragments, one error says what needs how much.
#[test]
fn what_cannot_be_made_smaller_is_an_error() {
    let mut gpu = gpu();
    let scene = walls(&stack(), [0.0; 3]);
    let method: MethodSpec = "abuffer".parse().unwrap();
    gpu.pretend_memory(10_000);
    let renderer = Renderer::new(&gpu, &scene).unwrap();
    let refused = renderer.method(&method, MethodOptions::sized([64, 48]));
    let is_memory = |e: &RenderError| matches!(e, RenderError::Gpu(GpuError::OutOfMemory { .. }));
    assert!(refused.as_ref().is_err_and(is_memory), "{refused:?}");
    assert_refused(refused, &["49152 bytes", "smaller frame"]);
    // Fragments of one pixel of colour take 320 bytes.
    gpu.pretend_memory(300);
    let renderer = Renderer::new(&gpu, &scene).unwrap();
    let mut prepared = prepare(&renderer, &method, [4, 3]);
    assert_refused(renderer.image(&mut prepared, &scene.views[0]), &["20"]);
}

/// A device that goes away is one clear error, at whatever comes next: no panic, no hang, and no talk of a bug.
#[test]
fn a_lost_device_is_one_clear_error() {
    let scene = walls(&stack(), [0.0; 3]);
    let all = "abuffer linked-list dual-peel wboit-eq9 mboit4 kbuffer-4 stochastic-4";
    for name in all.split(' ') {
        let gpu = gpu();
        let renderer = Renderer::new(&gpu, &scene).unwrap();
        let mut prepared = prepare(&renderer, name, [16, 12]);
        renderer.image(&mut prepared, &scene.views[0]).unwrap();
        gpu.device.destroy();
        let lost = renderer.image(&mut prepared, &scene.views[0]);
        let is_lost = matches!(lost, Err(RenderError::Gpu(GpuError::Lost(_))));
        assert!(is_lost, "{name}: {lost:?}");
        assert_refused(lost, &["run again"]);
    }
}
