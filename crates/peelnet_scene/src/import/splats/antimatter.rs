//! `.splat` files (antimatter15/splat): splats of 32 bytes each and nothing else, so the length is all that can be checked.

use super::{Cloud, Splat, coefficient, three};
use crate::{
    files::Files,
    import::surface::{Fault, in_file},
    mesh::Mesh,
};
use glam::Vec4;
use peelnet_core::files::counted;
use std::path::Path;

/// Bytes of a splat: position and scale in 32-bit numbers, red, green, blue, opacity, and a rotation w, x, y, z in bytes.
const SPLAT: usize = 32;

/// Reads a `.splat` file. It has no harmonics beyond the colour.
pub(in crate::import) fn read(
    path: &Path,
    bytes: &[u8],
    files: &mut Files<'_>,
) -> Result<Mesh, Fault> {
    let held = bytes.len();
    if held == 0 || !held.is_multiple_of(SPLAT) {
        return Err(in_file(format!(
            "has {}, which is no multiple of {SPLAT}; is it a .splat file, and is it empty or cut off?",
            counted(held as u64, "byte")
        )));
    }
    let count = (held / SPLAT) as u64;
    files.budget.take_mesh(count, count).map_err(in_file)?;
    let mut cloud = Cloud::new(0, false);
    for splat in bytes.chunks_exact(SPLAT) {
        let number = |k: usize| f32::from_le_bytes([0, 1, 2, 3].map(|b| splat[4 * k + b]));
        let [r, g, b, a, w, x, y, z] = [24, 25, 26, 27, 28, 29, 30, 31].map(|k| splat[k]);
        let part = |byte: u8| (f32::from(byte) - 128.0) / 128.0;
        let color = [r, g, b].map(|c| coefficient(f32::from(c) / 255.0));
        let splat = Splat {
            center: three(number),
            scale: three(|k| number(3 + k)),
            rotation: Vec4::from_array([x, y, z, w].map(part)),
            opacity: f32::from(a) / 255.0,
        };
        cloud.push(splat, &[color]);
    }
    cloud.into_mesh(path, files)
}
