//! The text of every shader, by module path.

macro_rules! sources {
    ($($path:literal = $file:literal),* $(,)?) => {
        /// Module path and text of every file in `shaders/`.
        pub const SOURCES: &[(&str, &str)] = &[
            $(($path, include_str!(concat!("../../../shaders/", $file)))),*
        ];
    };
}

sources! {
    "helpers::absorbance" = "helpers/absorbance.wgsl",
    "helpers::guards" = "helpers/guards.wgsl",
    "helpers::hash" = "helpers/hash.wgsl",
    "helpers::resolve" = "helpers/resolve.wgsl",
    "helpers::screen" = "helpers/screen.wgsl",
    "helpers::weights" = "helpers/weights.wgsl",
    "methods::abuffer::composite" = "methods/abuffer/composite.wgsl",
    "methods::blended::gather" = "methods/blended/gather.wgsl",
    "methods::deep_thesis::gather" = "methods/deep_thesis/gather.wgsl",
    "methods::deep_thesis::statistics" = "methods/deep_thesis/statistics.wgsl",
    "methods::depth_peel::resolve" = "methods/depth_peel/resolve.wgsl",
    "methods::depth_peel::under" = "methods/depth_peel/under.wgsl",
    "methods::dual_peel::blend" = "methods/dual_peel/blend.wgsl",
    "methods::dual_peel::resolve" = "methods/dual_peel/resolve.wgsl",
    "methods::wboit::gather" = "methods/wboit/gather.wgsl",
    "methods::wboit::resolve" = "methods/wboit/resolve.wgsl",
    "methods::mboit4::gather" = "methods/mboit4/gather.wgsl",
    "methods::mboit4::moments" = "methods/mboit4/moments.wgsl",
    "methods::mboit4::reconstruct" = "methods/mboit4/reconstruct.wgsl",
    "methods::mboit4::resolve" = "methods/mboit4/resolve.wgsl",
    "methods::weighted_average::gather" = "methods/weighted_average/gather.wgsl",
    "methods::weighted_average::resolve" = "methods/weighted_average/resolve.wgsl",
    "methods::weighted_sum::gather" = "methods/weighted_sum/gather.wgsl",
    "methods::weighted_sum::resolve" = "methods/weighted_sum/resolve.wgsl",
    "peel::collect_dual" = "peel/collect_dual.wgsl",
    "peel::collect_single" = "peel/collect_single.wgsl",
    "peel::count" = "peel/count.wgsl",
    "peel::dual" = "peel/dual.wgsl",
    "peel::dual_init" = "peel/dual_init.wgsl",
    "peel::scan_blocks" = "peel/scan_blocks.wgsl",
    "peel::scan_pixels" = "peel/scan_pixels.wgsl",
    "peel::scan_top" = "peel/scan_top.wgsl",
    "peel::single" = "peel/single.wgsl",
    "peel::sort" = "peel/sort.wgsl",
    "peel::store" = "peel/store.wgsl",
    "peel::tile" = "peel/tile.wgsl",
    "scene::camera" = "scene/camera.wgsl",
    "scene::opaque" = "scene/opaque.wgsl",
    "scene::shade" = "scene/shade.wgsl",
    "scene::surface" = "scene/surface.wgsl",
    "scene::vertex" = "scene/vertex.wgsl",
    "scene::visible" = "scene/visible.wgsl",
}
