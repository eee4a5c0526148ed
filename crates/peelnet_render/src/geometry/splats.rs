//! Splats on the GPU: covariances in the world, and the harmonics of their colours.

use crate::geometry::RenderError;
use crate::gpu::{Gpu, wgpu};
use bytemuck::{Pod, Zeroable};
use half::f16;
use peelnet_scene::{Object, Scene, Splats, harmonics_of};

/// `Splat` in `scene/splat.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct SplatData {
    /// Of the covariance in the world: xx, xy, xz.
    pub covariance_x: [f32; 3],
    pub opacity: f32,
    /// yy, yz, zz.
    pub covariance_yz: [f32; 3],
    /// Where its harmonics begin, in words, times 8; their degree times 2; whether opacity makes up for the blur.
    pub harmonics: u32,
    /// Quaternion.
    pub object_from_world: [f32; 4],
}

/// All splats of a scene, object by object.
#[derive(Debug)]
pub(crate) struct SplatBuffers {
    pub splats: wgpu::Buffer,
    pub harmonics: wgpu::Buffer,
    /// For each object the number of its first splat, and the word at which its harmonics begin.
    begins: Vec<[u32; 2]>,
}

/// Words of one splat's harmonics: half floats in pairs.
const fn words(degree: u8) -> usize {
    (3 * harmonics_of(degree)).div_ceil(2)
}

impl SplatBuffers {
    /// Uploads the splats of a scene; `None` where it has none.
    ///
    /// # Errors
    /// More than the adapter's largest binding holds.
    pub fn new(gpu: &Gpu, scene: &Scene) -> Result<Option<Self>, RenderError> {
        let (mut splats, mut harmonics) = (Vec::new(), Vec::new());
        let mut begins = Vec::with_capacity(scene.objects.len());
        let all = || scene.objects.iter().filter_map(|o| o.mesh.splats.as_ref());
        let count: usize = all().map(|s| s.opacities.len()).sum();
        if count == 0 {
            return Ok(None);
        }
        let halves: usize = all().map(|s| s.opacities.len() * words(s.degree)).sum();
        for bytes in [count * size_of::<SplatData>(), halves * 4] {
            let limit = gpu.limits.max_storage_buffer_binding_size;
            // 29 bits count the words.
            let limit = limit.min(1 << 31);
            let what = format!("scene '{}' with {count} splats", scene.name);
            let hint = "remove splats, or harmonics of high degree, in an editor of splats";
            gpu.check_limit(what, bytes as u64, limit, "bytes", hint)?;
        }
        for object in &scene.objects {
            let begin = [splats.len() as u32, harmonics.len() as u32];
            begins.push(begin);
            if let Some(own) = &object.mesh.splats {
                splats.extend(placed(object, own, begin[1]));
                harmonics.extend(packed(own));
            }
        }
        let usage = wgpu::BufferUsages::STORAGE;
        Ok(Some(Self {
            splats: gpu.upload("splats", &splats, usage),
            harmonics: gpu.upload("harmonics", &harmonics, usage),
            begins,
        }))
    }

    /// The number of an object's first splat.
    pub fn first(&self, object: usize) -> u32 {
        self.begins[object][0]
    }

    /// Writes an object's splats where it stands now.
    pub fn place(&self, gpu: &Gpu, scene: &Scene, number: usize) {
        let object = &scene.objects[number];
        if let Some(own) = &object.mesh.splats {
            let [first, word] = self.begins[number];
            let splats: Vec<_> = placed(object, own, word).collect();
            gpu.write_at(&self.splats, first as usize, &splats);
        }
    }
}

/// The splats of an object in the world; their harmonics begin at a word.
fn placed<'a>(
    object: &'a Object,
    splats: &'a Splats,
    word: u32,
) -> impl Iterator<Item = SplatData> + 'a {
    let (_, turn, _) = object.world_from_object.to_scale_rotation_translation();
    let object_from_world = turn.inverse().to_array();
    let flags = u32::from(splats.degree) << 1 | u32::from(splats.antialiased);
    (0..splats.opacities.len()).map(move |i| {
        let [xx, xy, xz, yy, yz, zz] = splats.covariance(i, &object.world_from_object);
        SplatData {
            covariance_x: [xx, xy, xz],
            opacity: splats.opacities[i],
            covariance_yz: [yy, yz, zz],
            harmonics: (word + (i * words(splats.degree)) as u32) << 3 | flags,
            object_from_world,
        }
    })
}

/// Red, green and blue of each harmonic in turn, two half floats in a word.
fn packed(splats: &Splats) -> impl Iterator<Item = u32> {
    let own = splats.harmonics.chunks(harmonics_of(splats.degree));
    own.flat_map(move |all| {
        let halves = all.iter().flatten().map(|&x| f16::from_f32(x).to_bits());
        let mut halves: Vec<u16> = halves.collect();
        halves.resize(2 * words(splats.degree), 0);
        let (pairs, _) = halves.as_chunks::<2>();
        let word = |[low, high]: &[u16; 2]| u32::from(*low) | u32::from(*high) << 16;
        pairs.iter().map(word).collect::<Vec<u32>>()
    })
}
