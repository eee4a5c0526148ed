//! `.spz` files (Niantic 2024): splats of about 20 bytes before compression by gzip.
//!
//! Read here: the crates for it decompress whatever a file holds before they look at its header.

use super::{Cloud, MAX_DEGREE, Splat, three, with_largest};
use crate::{
    files::Files,
    import::surface::{Fault, in_file},
    mesh::Mesh,
    splats::harmonics_of,
};
use flate2::read::GzDecoder;
use glam::{Vec3, Vec4};
use peelnet_core::files::counted;
use std::{f32::consts::FRAC_1_SQRT_2, io, path::Path};

/// `NGSP`, in the order of the file's bytes.
const MAGIC: [u8; 4] = 0x5053_474e_u32.to_le_bytes();

/// Bytes of the header: magic, version, count, degree, bits behind the binary point of a position, flags, and one of padding.
const HEADER: usize = 16;

/// Bits of the flags.
const ANTIALIASED: u8 = 1;
const EXTENDED: u8 = 2;

/// The constant harmonic's coefficient of byte b is (b / 255 − 0.5) over this.
const COLOR_SCALE: f32 = 0.15;

/// Reads an `.spz` file of version 2 or 3. Lists follow the header: positions, opacities, colours, scales, rotations, harmonics.
pub(in crate::import) fn read(
    path: &Path,
    bytes: &[u8],
    files: &mut Files<'_>,
) -> Result<Mesh, Fault> {
    // Version 4 is not one stream of gzip.
    let newer = bytes.strip_prefix(&MAGIC).and_then(|b| b.first_chunk());
    if let Some(version) = newer {
        return Err(refused(u32::from_le_bytes(*version)));
    }
    let mut input = GzDecoder::new(bytes);
    let mut header = [0; HEADER];
    io::Read::read_exact(&mut input, &mut header).map_err(|e| fault(&e))?;
    let word = |at: usize| u32::from_le_bytes([0, 1, 2, 3].map(|b| header[at + b]));
    if !header.starts_with(&MAGIC) {
        let message =
            "does not begin with 'NGSP' when unpacked: is it an .spz file? Export it again";
        return Err(in_file(message));
    }
    let (version, count) = (word(4), word(8));
    let [degree, bits, flags, _] = [12, 13, 14, 15].map(|at| header[at]);
    let rotation_bytes = match version {
        2 => 3,
        3 => 4,
        _ => return Err(refused(version)),
    };
    if degree > MAX_DEGREE {
        return Err(in_file(format!(
            "has harmonics of degree {degree}, and at most {MAX_DEGREE} are read; export it with fewer"
        )));
    }
    if flags & EXTENDED != 0 {
        let message = "has extensions, which move what is read; save it without them";
        return Err(in_file(message));
    }
    let more = harmonics_of(degree) - 1;
    files
        .budget
        .take_mesh(count.into(), count.into())
        .map_err(in_file)?;
    let lengths = [9, 1, 3, 3, rotation_bytes, 3 * more];
    let needed = lengths.iter().sum::<usize>() as u64 * u64::from(count);
    // It grows as the file holds bytes, whatever the header says.
    let mut data = Vec::new();
    let limited = &mut io::Read::take(&mut input, needed);
    io::Read::read_to_end(limited, &mut data).map_err(|e| fault(&e))?;
    if (data.len() as u64) < needed {
        return Err(in_file(format!(
            "its header says that it has {}, which take {}, and it has {}; is the file cut off?",
            counted(count.into(), "splat"),
            counted(needed, "byte"),
            data.len()
        )));
    }
    // At the end, the sum of its bytes is checked.
    let more_bytes = io::Read::read(&mut input, &mut [0]).map_err(|e| fault(&e))?;
    if more_bytes > 0 {
        files.warn(path, "not read: bytes behind its last splat");
    }
    let mut rest = &data[..];
    let lists = lengths.map(|length| {
        let (list, others) = rest.split_at(length * count as usize);
        rest = others;
        list
    });
    let scale = 2f32.powi(-i32::from(bits));
    let mut cloud = Cloud::new(degree, flags & ANTIALIASED != 0);
    let mut harmonics = vec![[0.0; 3]; 1 + more];
    for i in 0..count as usize {
        let own = |list: usize| &lists[list][i * lengths[list]..(i + 1) * lengths[list]];
        let [center, color, scales] = [0, 2, 3].map(own);
        harmonics[0] = [0, 1, 2].map(|k| (f32::from(color[k]) / 255.0 - 0.5) / COLOR_SCALE);
        for (harmonic, bytes) in harmonics[1..].iter_mut().zip(own(5).chunks_exact(3)) {
            *harmonic = [0, 1, 2].map(|k| (f32::from(bytes[k]) - 128.0) / 128.0);
        }
        let splat = Splat {
            center: three(|k| fixed(&center[3 * k..]) * scale),
            scale: three(|k| (f32::from(scales[k]) / 16.0 - 10.0).exp()),
            rotation: match *own(4) {
                [x, y, z] => first_three([x, y, z]),
                [a, b, c, d] => smallest_three(u32::from_le_bytes([a, b, c, d])),
                _ => Vec4::ZERO,
            },
            opacity: f32::from(own(1)[0]) / 255.0,
        };
        cloud.push(splat, &harmonics);
    }
    cloud.into_mesh(path, files)
}

fn refused(version: u32) -> Fault {
    in_file(format!(
        "is of version {version}, and 2 and 3 are read; save it as one of them, or as .ply"
    ))
}

fn fault(e: &io::Error) -> Fault {
    in_file(match e.kind() {
        io::ErrorKind::UnexpectedEof => "ends inside of its data; is the file empty or cut off?",
        _ => "cannot be unpacked: is it an .spz file, and is it damaged? Export it again",
    })
}

/// A whole number of three bytes with a sign.
fn fixed(bytes: &[u8]) -> f32 {
    (i32::from_le_bytes([0, bytes[0], bytes[1], bytes[2]]) >> 8) as f32
}

/// x, y and z, of which w follows: it is not negative.
fn first_three(bytes: [u8; 3]) -> Vec4 {
    let xyz = Vec3::from_array(bytes.map(|b| f32::from(b) / 127.5 - 1.0));
    xyz.extend((1.0 - xyz.length_squared()).max(0.0).sqrt())
}

/// The number of the largest of x, y, z, w in two bits, and the others in ten each, the last one lowest: a sign and nine bits of 1/√2.
fn smallest_three(mut bits: u32) -> Vec4 {
    let largest = (bits >> 30) as usize;
    let mut rotation = [0f32; 4];
    for k in (0..4).rev().filter(|k| *k != largest) {
        let size = (bits & 511) as f32 / 511.0 * FRAC_1_SQRT_2;
        rotation[k] = if bits & 512 == 0 { size } else { -size };
        bits >>= 10;
    }
    Vec4::from_array(with_largest(rotation, largest))
}
