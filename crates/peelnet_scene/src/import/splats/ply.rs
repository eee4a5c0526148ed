//! Splats in PLY files: as Kerbl et al. (INRIA 2023) write them, and compressed (PlayCanvas, SuperSplat), where blocks of 256 splats share their
//! ranges of numbers.

use super::{Cloud, MAX_DEGREE, Splat, coefficient, three, with_largest};
use crate::{
    files::Files,
    import::{
        ply::elements,
        ply_elements::Skipped,
        surface::{Fault, in_file},
    },
    mesh::Mesh,
    splats::harmonics_of,
};
use glam::{Vec3, Vec4};
use peelnet_core::files::{counted, printable};
use ply_rs_bw::{
    parser::Reader,
    ply::{
        ElementDef, Encoding, Header, Property, PropertyAccess, PropertyAccessResult as Answer,
        PropertyType, ScalarType,
    },
};
use std::{f32::consts::FRAC_1_SQRT_2, path::Path};

/// Splats that share their ranges in a compressed file.
const CHUNK: usize = 256;

/// Reads what is behind the header of a file of splats.
type Read = fn(&mut Reader<&[u8]>, &Header, &Path, &mut Files<'_>) -> Result<Mesh, Fault>;

/// The reader of a file of splats, by its elements' properties; `None` of another file.
pub(in crate::import) fn reader(header: &Header) -> Option<Read> {
    let has = |element: &str, names: [&str; 2]| {
        let element = header.elements.get(element);
        element.is_some_and(|e| names.iter().all(|n| e.properties.contains_key(*n)))
    };
    if has("vertex", ["f_dc_0", "scale_0"]) {
        return Some(read_plain);
    }
    let is_packed = has("vertex", ["packed_position", "packed_rotation"]);
    (is_packed && header.elements.contains_key("chunk")).then_some(read_compressed)
}

/// Reads plain splats: scales are logarithms, opacities logits, rotations w, x, y, z. Other properties, such as normals, are ignored.
fn read_plain(
    input: &mut Reader<&[u8]>,
    header: &Header,
    path: &Path,
    files: &mut Files<'_>,
) -> Result<Mesh, Fault> {
    let mut read = None;
    for element in header.elements.values() {
        if element.name != "vertex" {
            skip(input, element, header)?;
            continue;
        }
        let count = element.count as u64;
        files.budget.take_mesh(count, count).map_err(in_file)?;
        let place = |name: &str| place(element, name);
        let center = [place("x")?, place("y")?, place("z")?];
        let scale = [place("scale_0")?, place("scale_1")?, place("scale_2")?];
        let [w, x] = [place("rot_0")?, place("rot_1")?];
        let rotation = [x, place("rot_2")?, place("rot_3")?, w];
        let color = [place("f_dc_0")?, place("f_dc_1")?, place("f_dc_2")?];
        let opacity = place("opacity")?;
        let (degree, rest) = rest_of(element, path, files)?;
        let mut cloud = Cloud::new(degree, false);
        let mut harmonics = vec![[0.0; 3]; harmonics_of(degree)];
        rows(input, element, header, |row| {
            let number = |place: usize| row[place] as f32;
            harmonics[0] = color.map(number);
            for (harmonic, places) in harmonics[1..].iter_mut().zip(&rest) {
                *harmonic = places.map(number);
            }
            let splat = Splat {
                center: Vec3::from_array(center.map(number)),
                scale: Vec3::from_array(scale.map(|k| number(k).exp())),
                rotation: Vec4::from_array(rotation.map(number)),
                opacity: 1.0 / (1.0 + (-number(opacity)).exp()),
            };
            cloud.push(splat, &harmonics);
        })?;
        read = Some(cloud);
    }
    let cloud = read.unwrap_or_else(|| Cloud::new(0, false));
    cloud.into_mesh(path, files)
}

/// The degree that an element's `f_rest_0` … have, and the places of red, green and blue of each: all of red come first, then green, then blue.
fn rest_of(
    element: &ElementDef,
    path: &Path,
    files: &mut Files<'_>,
) -> Result<(u8, Vec<[usize; 3]>), Fault> {
    let places = (0..).map_while(|i| find(element, &format!("f_rest_{i}")));
    let places: Vec<usize> = places.collect();
    let n = places.len();
    let degree = (0..=4).find(|d| 3 * (harmonics_of(*d) - 1) == n);
    let Some(degree) = degree else {
        return Err(in_file(format!(
            "its elements '{}' have {n} of 'f_rest_0', 'f_rest_1', …, and splats 0, 9, 24 or 45; export it again",
            element.name
        )));
    };
    if degree > MAX_DEGREE {
        files.warnings.not_drawn(path, "harmonics of degree 4");
    }
    let (drawn, each) = (degree.min(MAX_DEGREE), n / 3);
    let places = (1..harmonics_of(drawn)).map(|k| [0, 1, 2].map(|c| places[c * each + k - 1]));
    Ok((drawn, places.collect()))
}

/// Names of a chunk's ranges behind `min_` and `max_`, and bits of the numbers in them.
const RANGES: [(&str, usize); 9] = [
    ("x", 11),
    ("y", 10),
    ("z", 11),
    ("scale_x", 11),
    ("scale_y", 10),
    ("scale_z", 11),
    ("r", 8),
    ("g", 8),
    ("b", 8),
];

/// Least and largest values of a chunk: of positions, logarithms of scales, and colours.
type Ranges = [[f32; 2]; 9];

/// Reads compressed splats. Colours are in display space; those of older files have no ranges.
fn read_compressed(
    input: &mut Reader<&[u8]>,
    header: &Header,
    path: &Path,
    files: &mut Files<'_>,
) -> Result<Mesh, Fault> {
    let count = |name: &str| header.elements.get(name).map_or(0, |e| e.count);
    let (splats, chunks) = (count("vertex"), count("chunk"));
    let taken = files.budget.take_mesh(splats as u64, splats as u64);
    taken.map_err(in_file)?;
    if chunks < splats.div_ceil(CHUNK) {
        return Err(in_file(format!(
            "has {} and {}, and needs one for every {CHUNK} splats; export it again",
            counted(splats as u64, "splat"),
            counted(chunks as u64, "chunk")
        )));
    }
    let mut ranges: Vec<Ranges> = Vec::new();
    let mut packed: Vec<[u32; 4]> = Vec::new();
    let mut degree = 0;
    let mut more: Vec<[f32; 3]> = Vec::new();
    for element in header.elements.values() {
        match element.name.as_str() {
            "chunk" => {
                let mut places = [None; 9];
                for (k, (name, _)) in RANGES.into_iter().enumerate() {
                    let [low, high] = ["min", "max"].map(|end| format!("{end}_{name}"));
                    // Older files have colours of 0 … 1.
                    if k < 6 || find(element, &low).is_some() {
                        places[k] = Some([place(element, &low)?, place(element, &high)?]);
                    }
                }
                rows(input, element, header, |row| {
                    let ends = |p: [usize; 2]| p.map(|p| row[p] as f32);
                    ranges.push(places.map(|p| p.map_or([0.0, 1.0], ends)));
                })?;
            }
            "vertex" => {
                let place = |name: &str| place(element, &format!("packed_{name}"));
                let [position, rotation] = [place("position")?, place("rotation")?];
                let places = [position, rotation, place("scale")?, place("color")?];
                rows(input, element, header, |row| {
                    // Whole numbers of 32 bits, with or without a sign.
                    packed.push(places.map(|p| row[p] as i64 as u32));
                })?;
            }
            "sh" => {
                if element.count != splats {
                    return Err(in_file(format!(
                        "has {} and {} of 'sh'; export it again",
                        counted(splats as u64, "splat"),
                        element.count
                    )));
                }
                let places;
                (degree, places) = rest_of(element, path, files)?;
                let value = |x: f64| (x as f32 / 255.0 - 0.5) * 8.0;
                rows(input, element, header, |row| {
                    more.extend(places.iter().map(|p| p.map(|p| value(row[p]))));
                })?;
            }
            _ => skip(input, element, header)?,
        }
    }
    let mut cloud = Cloud::new(degree, false);
    let each = harmonics_of(degree) - 1;
    let mut harmonics = vec![[0.0; 3]; 1 + each];
    for (i, packed) in packed.into_iter().enumerate() {
        let (splat, color) = unpacked(packed, &ranges[i / CHUNK]);
        harmonics[0] = color.map(coefficient);
        harmonics[1..].copy_from_slice(&more[i * each..(i + 1) * each]);
        cloud.push(splat, &harmonics);
    }
    cloud.into_mesh(path, files)
}

/// The lowest `bits` of a number as a part of the largest one.
fn part(x: u32, bits: usize) -> f32 {
    let most = (1u32 << bits) - 1;
    (x & most) as f32 / most as f32
}

/// A compressed splat and its colour. The first of three numbers is in the highest bits.
fn unpacked([position, rotation, scale, color]: [u32; 4], ranges: &Ranges) -> (Splat, [f32; 3]) {
    let mixed = |word: u32, shift: u32, range: usize| {
        let t = part(word >> shift, RANGES[range].1);
        let [low, high] = ranges[range];
        low * (1.0 - t) + high * t
    };
    let three_of =
        |word: u32, shifts: [u32; 3], first: usize| three(|k| mixed(word, shifts[k], first + k));
    // The number of the largest of w, x, y, z, and the others in their order, of ±1/√2.
    let largest = (rotation >> 30) as usize;
    let mut wxyz = [0.0; 4];
    let others = [20, 10, 0].map(|shift| (part(rotation >> shift, 10) - 0.5) * 2.0 * FRAC_1_SQRT_2);
    let places = (0..4).filter(|k| *k != largest);
    places.zip(others).for_each(|(k, x)| wxyz[k] = x);
    let [w, x, y, z] = with_largest(wxyz, largest);
    let splat = Splat {
        center: three_of(position, [21, 11, 0], 0),
        scale: three_of(scale, [21, 11, 0], 3).map(f32::exp),
        rotation: Vec4::new(x, y, z, w),
        opacity: part(color, 8),
    };
    (splat, three_of(color, [24, 16, 8], 6).to_array())
}

/// The place of a property in an element's rows.
fn find(element: &ElementDef, name: &str) -> Option<usize> {
    element.properties.keys().position(|key| key == name)
}

fn place(element: &ElementDef, name: &str) -> Result<usize, Fault> {
    find(element, name).ok_or_else(|| {
        in_file(format!(
            "its elements '{}' have no '{name}', which splats have; export it again",
            element.name
        ))
    })
}

/// The numbers of an element of text.
struct Row(Vec<f64>);

impl PropertyAccess for Row {
    fn new() -> Self {
        Self(Vec::new())
    }

    fn set_property(&mut self, _: &str, value: Property) -> Answer {
        // Properties are set in their order.
        self.0.push(match value {
            Property::Double(x) => x,
            Property::UInt(x) => x.into(),
            Property::Int(x) => x.into(),
            value => value.to_f32_lossy().unwrap_or(f32::NAN).into(),
        });
        Answer::Set
    }
}

fn skip(input: &mut Reader<&[u8]>, element: &ElementDef, header: &Header) -> Result<(), Fault> {
    // Without properties it has no bytes, however many there are.
    match element.properties.is_empty() {
        true => Ok(()),
        false => elements::<Skipped>(input, element, header).map(drop),
    }
}

/// Reads the numbers of each of some elements in the order of their properties. Not by the crate where they are binary: it looks up each of up
/// to 62 names for each of millions of splats.
fn rows(
    input: &mut Reader<&[u8]>,
    element: &ElementDef,
    header: &Header,
    mut read: impl FnMut(&[f64]),
) -> Result<(), Fault> {
    let name = printable(&element.name);
    let mut types = Vec::new();
    for (property, definition) in &element.properties {
        let PropertyType::Scalar(scalar) = &definition.data_type else {
            let property = printable(property);
            let message = format!("{property} of '{name}' is a list; export it again");
            return Err(in_file(message));
        };
        types.push(scalar);
    }
    if header.encoding == Encoding::Ascii {
        let all = elements::<Row>(input, element, header)?;
        all.iter().for_each(|row| read(&row.0));
        return Ok(());
    }
    let is_big = header.encoding == Encoding::BinaryBigEndian;
    let sizes = types.iter().map(|t| size(t));
    let length: usize = sizes.sum();
    let bytes = *input.get_ref();
    let all = length
        .checked_mul(element.count)
        .and_then(|all| bytes.split_at_checked(all));
    let (own, rest) =
        all.ok_or_else(|| in_file(format!("ends inside of '{name}'; is the file cut off?")))?;
    *input.get_mut() = rest;
    let mut row = vec![0.0; types.len()];
    for mut bytes in own.chunks_exact(length) {
        for (x, scalar) in row.iter_mut().zip(&types) {
            let (number, others) = bytes.split_at(size(scalar));
            *x = value(number, scalar, is_big);
            bytes = others;
        }
        read(&row);
    }
    Ok(())
}

const fn size(scalar: &ScalarType) -> usize {
    match scalar {
        ScalarType::Char | ScalarType::UChar => 1,
        ScalarType::Short | ScalarType::UShort => 2,
        ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
        ScalarType::Double => 8,
    }
}

/// A number of the bytes that its type has.
fn value(bytes: &[u8], scalar: &ScalarType, is_big: bool) -> f64 {
    let mut little = [0; 8];
    for (k, byte) in bytes.iter().enumerate() {
        little[if is_big { bytes.len() - 1 - k } else { k }] = *byte;
    }
    let bits = u64::from_le_bytes(little);
    match scalar {
        ScalarType::Char => (bits as i8).into(),
        ScalarType::UChar => (bits as u8).into(),
        ScalarType::Short => (bits as i16).into(),
        ScalarType::UShort => (bits as u16).into(),
        ScalarType::Int => (bits as i32).into(),
        ScalarType::UInt => (bits as u32).into(),
        ScalarType::Float => f32::from_bits(bits as u32).into(),
        ScalarType::Double => f64::from_bits(bits),
    }
}
