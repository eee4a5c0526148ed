//! PLY files (Turk 1994), ASCII and binary of either byte order: meshes of scanners, and splats.
//!
//! `ply-rs-bw` reads the header and the elements. Before it, counts are compared with the length of the file, so that nothing is made of what a
//! file cannot hold, and numbers of text that its grammar refuses, such as `.5` and `1.`, are written in another way.

use super::{
    obj::BRIGHT,
    ply_elements::{ALPHA, BLUE, Face, GREEN, INDICES, RED, Skipped, U, Vertex},
    polygons::{Triangulator, strip},
    splats,
    surface::{Fault, fault_of, in_file, warn_of_rest},
};
use crate::{budget::Budget, files::Files, mesh::Mesh};
use glam::{DVec3, Vec2, Vec3};
use peelnet_core::files::{counted, printable};
use ply_rs_bw::{
    parser::{ParseError, Parser, Reader},
    ply::{ElementDef, Encoding, Header, PropertyAccess, PropertyType, ScalarType},
};
use std::{borrow::Cow, io::ErrorKind, path::Path};

const MAX_HEADER: usize = 1 << 20;

/// Reads a PLY file of splats, or of a mesh: positions, normals, colours with opacity, texture coordinates (of vertices or of the vertices of faces), polygons and
/// triangle strips.
///
/// Colours in bytes are sRGB, as programs show them, colours in floating-point numbers linear. Missing normals are computed.
pub(super) fn read(path: &Path, bytes: &[u8], files: &mut Files<'_>) -> Result<Mesh, Fault> {
    let head = head_length(bytes)?;
    let is_text = String::from_utf8_lossy(&bytes[..head]).contains("format ascii");
    let bytes = if is_text {
        Cow::Owned(rewritten(bytes)?)
    } else {
        Cow::Borrowed(bytes)
    };
    let head = head_length(&bytes)?;
    let mut input = Reader::new(&*bytes);
    let header = Parser::<Skipped>::new().read_header(&mut input);
    let header = header.map_err(|e| fault("header", &e, true))?;
    check_header(&header, &bytes[..head], (bytes.len() - head) as u64)?;
    let more_lines = match is_text {
        true => check_lines(&header, &bytes, head)?,
        false => 0,
    };
    let warn_of_more = |input: &Reader<&[u8]>, files: &mut Files<'_>| {
        let (rest, unit) = match is_text {
            true => (more_lines, "line"),
            false => (input.get_ref().len() as u64, "byte"),
        };
        warn_of_rest(files, path, rest, unit, "element");
    };
    if let Some(read) = splats::ply::reader(&header) {
        let mesh = read(&mut input, &header, path, files)?;
        warn_of_more(&input, files);
        return Ok(mesh);
    }
    let count = |name: &str| header.elements.get(name).map_or(0, |e| e.count as u64);
    let (vertices, faces) = (count("vertex"), count("face") + count("tristrips"));
    if faces == 0 {
        return Err(in_file(match vertices {
            0 => "holds no faces; is the file empty or cut off?".into(),
            n => format!(
                "holds {} and no faces: it is a point cloud; reconstruct a surface of it first, and export that",
                counted(n, "point")
            ),
        }));
    }
    // Polygons of more than three vertices are counted when they are met.
    let taken = files.budget.take_mesh(faces, vertices);
    taken.map_err(in_file)?;
    let is_texture = |c: &String| c.trim_start().starts_with("TextureFile");
    if header.comments.iter().any(is_texture) {
        let message = "not drawn: its texture; name it as color_map in a scene file";
        files.warn(path, message);
    }
    for element in header.elements.values() {
        let is_read = |name: &str| match element.name.as_str() {
            "vertex" => Vertex::reads(name),
            "face" | "tristrips" => Face::reads(name),
            _ => false,
        };
        for name in element.properties.keys().filter(|name| !is_read(name)) {
            let what = format!("{name} of {}", element.name);
            files.warnings.not_drawn(path, &what);
        }
    }
    let mut reader = Faces {
        surface: Mesh::default(),
        budget: &mut files.budget,
        triangulator: Triangulator::default(),
        vertex_uvs: Vec::new(),
        short_faces: 0,
        is_bright: false,
    };
    for element in header.elements.values() {
        match element.name.as_str() {
            "vertex" => reader.vertices(elements(&mut input, element, &header)?, element)?,
            "face" | "tristrips" => {
                reader.faces(elements(&mut input, element, &header)?, element)?
            }
            // It has no bytes, however many there are.
            _ if element.properties.is_empty() => {}
            _ => drop(elements::<Skipped>(&mut input, element, &header)?),
        }
    }
    let (surface, short_faces) = (reader.surface, reader.short_faces);
    if reader.is_bright {
        files.warn(path, BRIGHT);
    }
    warn_of_more(&input, files);
    if short_faces > 0 {
        let count = counted(short_faces, "face");
        files.warn(path, &(count + " of fewer than 3 vertices left out"));
    }
    Ok(surface)
}

fn fault(what: &str, e: &ParseError, has_lines: bool) -> Fault {
    let message = match e.kind() {
        ErrorKind::UnexpectedEof => format!("ends inside of '{what}'; is the file cut off?"),
        _ => format!("'{what}' cannot be read; repair it, or export the mesh again"),
    };
    (e.line().filter(|_| has_lines), message)
}

pub(super) fn elements<E: PropertyAccess>(
    input: &mut Reader<&[u8]>,
    element: &ElementDef,
    header: &Header,
) -> Result<Vec<E>, Fault> {
    let read = Parser::<E>::new().read_payload_for_element(input, element, header);
    let has_lines = header.encoding == Encoding::Ascii;
    read.map_err(|e| fault(&printable(&element.name), &e, has_lines))
}

/// Where the header ends, bytes.
fn head_length(bytes: &[u8]) -> Result<usize, Fault> {
    const END: &[u8] = b"end_header";
    if !bytes.starts_with(b"ply") {
        let message = "does not begin with 'ply': is it a PLY file? Export it again";
        return Err((Some(1), message.into()));
    }
    let start = &bytes[..bytes.len().min(MAX_HEADER)];
    let is_end = |w: &[u8]| matches!(w[0], b'\n' | b'\r') && &w[1..] == END;
    let at = start.windows(END.len() + 1).position(is_end);
    at.map(|at| at + 1 + END.len()).ok_or_else(|| {
        let message = format!(
            "has no 'end_header' in its first {}; is the file cut off?",
            counted(start.len() as u64, "byte")
        );
        in_file(message)
    })
}

/// A file of text as the crate reads it: a line for each element, and numbers as Rust writes them.
fn rewritten(bytes: &[u8]) -> Result<Vec<u8>, Fault> {
    let text = String::from_utf8_lossy(bytes).replace("\r\n", "\n");
    let text = text.replace('\r', "\n");
    let head = head_length(text.as_bytes())?;
    let (head, body) = text.split_at(text[head..].find('\n').map_or(text.len(), |n| head + n + 1));
    let mut out = head.to_owned();
    for line in body.lines().filter(|line| !line.trim().is_empty()) {
        let number = |word: &str| match word.parse::<f64>() {
            Ok(x) if x.is_finite() => x.to_string(),
            _ => word.to_owned(),
        };
        let words: Vec<String> = line.split_whitespace().map(number).collect();
        out.push_str(&words.join(" "));
        out.push('\n');
    }
    Ok(out.into_bytes())
}

/// Checks that each name stands once, as the crate keeps one of two, and that as many bytes as the header's counts need follow it.
fn check_header(header: &Header, head: &[u8], held: u64) -> Result<(), Fault> {
    let text = String::from_utf8_lossy(head);
    let lines = text.split(['\n', '\r']);
    let count = |word: &str| lines.clone().filter(|l| l.starts_with(word)).count();
    let properties = header.elements.values().map(|e| e.properties.len());
    if count("element") != header.elements.len() || count("property") != properties.sum::<usize>() {
        let message = "its header names an element or a property twice; export it again";
        return Err(in_file(message));
    }
    let mut needed = 0u64;
    for element in header.elements.values() {
        // Nothing of the file would bound their count.
        if element.properties.is_empty()
            && ["vertex", "face", "tristrips"].contains(&&*element.name)
        {
            return Err(in_file(format!(
                "its elements '{}' have no properties; export it again",
                element.name
            )));
        }
        let types = element.properties.values().map(|p| &p.data_type);
        let least: u64 = types.map(|t| least_bytes(t, header.encoding)).sum();
        needed = needed.saturating_add(least.saturating_mul(element.count as u64));
        // The last number needs no space behind it.
        if needed > held + 1 {
            return Err(in_file(format!(
                "its header says that it has {} of '{}', which take {} at least, and {held} follow it; is the file cut off?",
                element.count,
                printable(&element.name),
                counted(needed, "byte"),
            )));
        }
    }
    Ok(())
}

/// Checks that no line has more values than its element, as the crate drops them; returns how many lines follow the last element.
fn check_lines(header: &Header, bytes: &[u8], head: usize) -> Result<u64, Fault> {
    let text = String::from_utf8_lossy(bytes);
    let before = bytes[..head].iter().filter(|b| **b == b'\n').count() + 1;
    let mut lines = text.lines().zip(1..).skip(before);
    for element in header.elements.values() {
        // Without properties it has no lines.
        let count = match element.properties.is_empty() {
            true => 0,
            false => element.count,
        };
        for (line, i) in lines.by_ref().take(count) {
            let mut words = line.split_whitespace();
            for property in element.properties.values() {
                let word = words.next();
                if let PropertyType::List(..) = property.data_type {
                    // What is no count is an error of the crate.
                    let length = word.and_then(|word| word.parse().ok());
                    words
                        .by_ref()
                        .take(length.unwrap_or(usize::MAX))
                        .for_each(drop);
                }
            }
            if words.next().is_some() {
                let name = printable(&element.name);
                let message = format!(
                    "'{name}' has more values here than its properties take; repair the line, or export the mesh again"
                );
                return Err((Some(i), message));
            }
        }
    }
    Ok(lines.count() as u64)
}

/// The fewest bytes that a property takes.
fn least_bytes(property: &PropertyType, encoding: Encoding) -> u64 {
    // A digit and a blank.
    if encoding == Encoding::Ascii {
        return 2;
    }
    let (PropertyType::Scalar(first) | PropertyType::List(first, _)) = property;
    match first {
        ScalarType::Char | ScalarType::UChar => 1,
        ScalarType::Short | ScalarType::UShort => 2,
        ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
        ScalarType::Double => 8,
    }
}

struct Faces<'a> {
    surface: Mesh,
    budget: &'a mut Budget,
    triangulator: Triangulator,
    /// One for each vertex, or none.
    vertex_uvs: Vec<Vec2>,
    short_faces: u64,
    /// Whether colours were cut off.
    is_bright: bool,
}

impl Faces<'_> {
    fn vertices(&mut self, vertices: Vec<Vertex>, element: &ElementDef) -> Result<(), Fault> {
        let has = |names: &[&str]| names.iter().any(|n| element.properties.contains_key(*n));
        if let Some(axis) = ["x", "y", "z"].into_iter().find(|axis| !has(&[axis])) {
            let message = format!("its vertices have no '{axis}'; export the mesh again");
            return Err(in_file(message));
        }
        for (i, vertex) in vertices.iter().enumerate() {
            let position = Vec3::from(vertex.position);
            if let Some(what) = fault_of(position) {
                return Err(in_file(format!("vertex {i} {what}; repair the mesh")));
            }
            self.surface.positions.push(position);
        }
        if has(&["nx"]) {
            let normals = vertices.iter().map(|v| v.normal.into());
            self.surface.normals = normals.collect();
        }
        let channels = [&RED[..], &GREEN, &BLUE].map(has);
        if channels.contains(&true) && channels.contains(&false) {
            let message =
                "its vertices have some of red, green and blue; export the mesh again with all";
            return Err(in_file(message));
        }
        if channels[0] || has(&ALPHA) {
            let mut colors: Vec<[f32; 4]> = vertices.iter().map(|v| v.color).collect();
            let all = colors.as_flattened_mut().iter_mut();
            for x in all.filter(|x| !(0.0..=1.0).contains(*x)) {
                self.is_bright = true;
                // 0 of what is no number, too.
                *x = if *x > 1.0 { 1.0 } else { 0.0 };
            }
            self.surface.colors = colors;
        }
        if has(&U) {
            // v runs up in PLY, down here.
            let uvs = vertices.iter().map(|v| Vec2::new(v.uv[0], 1.0 - v.uv[1]));
            self.vertex_uvs = uvs.collect();
        }
        Ok(())
    }

    fn faces(&mut self, faces: Vec<Face>, element: &ElementDef) -> Result<(), Fault> {
        let has = |name: &str| element.properties.contains_key(name);
        if !INDICES.into_iter().any(has) {
            let message = format!(
                "its elements '{}' have no vertex_indices; export the mesh again",
                printable(&element.name)
            );
            return Err(in_file(message));
        }
        let has_uvs =
            has("texcoord") || !self.vertex_uvs.is_empty() || !self.surface.uvs.is_empty();
        if has_uvs {
            // Triangles of an element before this one have none.
            let before = self.surface.triangles.len();
            self.surface.uvs.resize(before, [Vec2::ZERO; 3]);
        }
        let is_strip = element.name == "tristrips";
        for (i, face) in faces.iter().enumerate() {
            let mut first = 0;
            // In strips, −1 begins a new one.
            for indices in face.indices.split(|index| is_strip && *index == -1) {
                let corners = self.corners(indices, is_strip);
                let corners = corners.map_err(|e| in_file(format!("{} {i}: {e}", element.name)))?;
                let uv = |k: usize| match face.uvs.get(2 * (first + k)..2 * (first + k) + 2) {
                    Some(uv) => Vec2::new(uv[0], 1.0 - uv[1]),
                    None => {
                        let uv = self.vertex_uvs.get(indices[k] as usize);
                        uv.copied().unwrap_or_default()
                    }
                };
                let uvs = corners.iter().filter(|_| has_uvs);
                self.surface.uvs.extend(uvs.map(|t| t.map(uv)));
                let triangles = corners.iter().map(|t| t.map(|k| indices[k] as u32));
                self.surface.triangles.extend(triangles);
                first += indices.len() + 1;
            }
        }
        Ok(())
    }

    /// The triangles of a polygon or a strip, as numbers of its vertices.
    fn corners(&mut self, indices: &[i64], is_strip: bool) -> Result<Vec<[usize; 3]>, String> {
        let positions = &self.surface.positions;
        let n = positions.len();
        let is_none = |index: &&i64| usize::try_from(**index).ok().is_none_or(|index| index >= n);
        if let Some(index) = indices.iter().find(is_none) {
            return Err(format!(
                "index {index} points at none of the {n} vertices before it; repair the mesh"
            ));
        }
        let more = (indices.len() as u64).saturating_sub(3);
        self.budget.take_mesh(more, 0)?;
        Ok(match indices.len() {
            vertices if is_strip => strip(vertices).collect(),
            0..3 => {
                self.short_faces += 1;
                Vec::new()
            }
            3 => vec![[0, 1, 2]],
            _ => {
                let position = |&i: &i64| positions[i as usize].as_dvec3();
                let vertices: Vec<DVec3> = indices.iter().map(position).collect();
                self.triangulator.triangulate(&vertices)?
            }
        })
    }
}
