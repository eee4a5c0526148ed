//! Gaussian splats: points with the extension `KHR_gaussian_splatting`.
//!
//! The `gltf` crate knows no attributes with names of extensions, so these are taken out of the JSON before it reads that.
//!
//! `SCALE` holds standard deviations, as the ratified extension says. Its drafts of 2025 had their logarithms, most of which are negative and
//! standard deviations never are: lists of mostly negative numbers are read as logarithms.

use super::{checks::is_addressed, nodes::Reader};
use crate::{
    error::SceneError,
    import::{
        splats::{Cloud, MAX_DEGREE, Splat, turned::Turn},
        surface::Fault,
    },
    material::Material,
    splats::harmonics_of,
};
use glam::{Mat4, Vec3, Vec4};
use gltf::{
    Accessor, Semantic,
    accessor::{DataType, Dimensions, Item, Iter},
    mesh::Mode,
};
use peelnet_core::files::printable;
use serde_json::Value;
use std::collections::{BTreeMap, HashMap};

/// The extension, and what its attributes' names begin with.
pub(super) const SPLATTING: &str = "KHR_gaussian_splatting";
const PREFIX: &str = "KHR_gaussian_splatting:";

/// What the extension says of a primitive.
#[derive(Default)]
pub(super) struct Declared {
    /// Numbers of accessors by attributes' names behind the prefix.
    accessors: BTreeMap<String, usize>,
    kernel: String,
    color_space: String,
    /// An extension of the extension: in another form of data.
    extension: Option<String>,
}

/// By the numbers of meshes and of their primitives.
pub(super) type AllDeclared = HashMap<(usize, usize), Declared>;

/// Takes the extension's attributes out of a document, and the extension out of the required ones.
pub(super) fn take_declared(document: &mut Value) -> AllDeclared {
    let required = document.get_mut("extensionsRequired");
    if let Some(required) = required.and_then(Value::as_array_mut) {
        required.retain(|name| name != SPLATTING);
    }
    let mut all = AllDeclared::new();
    let meshes = document.get_mut("meshes").and_then(Value::as_array_mut);
    for (i, mesh) in meshes.into_iter().flatten().enumerate() {
        let primitives = mesh.get_mut("primitives").and_then(Value::as_array_mut);
        for (j, primitive) in primitives.into_iter().flatten().enumerate() {
            let attributes = primitive.get_mut("attributes");
            let mut accessors = BTreeMap::new();
            if let Some(attributes) = attributes.and_then(Value::as_object_mut) {
                attributes.retain(|name, accessor| {
                    let Some(name) = name.strip_prefix(PREFIX) else {
                        return true;
                    };
                    let accessor = accessor.as_u64().and_then(|i| usize::try_from(i).ok());
                    accessors.insert(name.to_owned(), accessor.unwrap_or(usize::MAX));
                    false
                });
            }
            let Some(extension) = primitive["extensions"].get(SPLATTING) else {
                continue;
            };
            let text = |key: &str| extension[key].as_str().unwrap_or_default().to_owned();
            let extensions = extension["extensions"].as_object();
            let declared = Declared {
                accessors,
                kernel: text("kernel"),
                color_space: text("colorSpace"),
                extension: extensions.and_then(|e| e.keys().next().cloned()),
            };
            all.insert((i, j), declared);
        }
    }
    all
}

impl Declared {
    /// What of it is not drawn at all, and its name.
    fn not_drawn(&self) -> Option<(&'static str, &str)> {
        let has_rotation = self.accessors.contains_key("ROTATION");
        if let Some(name) = self.extension.as_deref().filter(|_| !has_rotation) {
            return Some(("splats with the extension ", name));
        }
        // Harmonics of linear light are not those of what a display shows, which splats here have.
        let is_display = matches!(&*self.color_space, "" | "srgb_rec709_display");
        (!is_display).then_some(("splats whose colour space is ", &*self.color_space))
    }

    /// The degree of the harmonics that it names.
    fn degree(&self) -> u8 {
        let has = |d: &u8| {
            self.accessors
                .contains_key(&format!("SH_DEGREE_{d}_COEF_0"))
        };
        (1..=MAX_DEGREE).take_while(has).last().unwrap_or(0)
    }
}

/// How many splats of a primitive are drawn.
pub(super) fn count(primitive: &gltf::Primitive<'_>, declared: &Declared) -> Option<u64> {
    let is_drawn = primitive.mode() == Mode::Points && declared.not_drawn().is_none();
    let positions = primitive.get(&Semantic::Positions).filter(|_| is_drawn);
    positions.map(|a| a.count() as u64)
}

impl Reader<'_, '_> {
    /// Adds the splats of a primitive in its place in the world. Budgets have been taken.
    pub fn splats(
        &mut self,
        mesh: &gltf::Mesh<'_>,
        primitive: &gltf::Primitive<'_>,
        declared: &Declared,
        world: Mat4,
    ) -> Result<(), SceneError> {
        let place = format!("mesh {}, primitive {}", mesh.index(), primitive.index());
        if let Some((what, name)) = declared.not_drawn() {
            self.missing(what, &printable(name), "");
            return Ok(());
        }
        if !matches!(&*declared.kernel, "" | "ellipse") {
            let what = "kernels of splats (ellipses are drawn): ";
            self.missing(what, &printable(&declared.kernel), "");
        }
        if primitive.indices().is_some() {
            self.missing("indices of splats (all are drawn): ", &place, "");
        }
        let read = self.cloud(primitive, declared, world);
        let mesh_of = |cloud: Cloud, reader: &mut Self| {
            let mesh = cloud.into_mesh(reader.path, reader.files);
            mesh.map_err(|(_, message): Fault| message)
        };
        let part = read.and_then(|cloud| mesh_of(cloud, self));
        let part = part.map_err(|message| self.fail(format!("{place}: {message}")))?;
        let part = part.into_part(
            mesh.name().unwrap_or(&place),
            Material::unlit([1.0; 3], 1.0),
        );
        let warnings = &mut self.files.warnings;
        self.loaded.mesh.append(part, &self.not_drawn, warnings);
        Ok(())
    }

    fn cloud(
        &mut self,
        primitive: &gltf::Primitive<'_>,
        declared: &Declared,
        world: Mat4,
    ) -> Result<Cloud, String> {
        let turn = Turn::new(world).ok_or("its node scales it to nothing; give it a size")?;
        let positions = primitive.get(&Semantic::Positions);
        let positions = positions.ok_or("has no positions; export it again")?;
        let n = positions.count();
        let accessor = |name: &str| {
            let number = declared.accessors.get(name).copied();
            let number =
                number.ok_or_else(|| format!("has no '{PREFIX}{name}'; export it again"))?;
            let accessor = self.document.accessors().nth(number);
            let accessor = accessor.filter(|a| a.count() == n);
            accessor.ok_or_else(|| {
                format!("'{PREFIX}{name}' is no accessor of {n} values; export it again")
            })
        };
        let centers: Vec<[f32; 3]> = self.vectors(&positions, Dimensions::Vec3)?;
        let rotations: Vec<[f32; 4]> = self.vectors(&accessor("ROTATION")?, Dimensions::Vec4)?;
        let mut scales: Vec<[f32; 3]> = self.vectors(&accessor("SCALE")?, Dimensions::Vec3)?;
        let opacities: Vec<f32> = self.vectors(&accessor("OPACITY")?, Dimensions::Scalar)?;
        let degree = declared.degree();
        let mut lists: Vec<Vec<[f32; 3]>> = Vec::new();
        for d in 0..=degree {
            for k in 0..2 * d + 1 {
                let coefficients = accessor(&format!("SH_DEGREE_{d}_COEF_{k}"))?;
                lists.push(self.vectors(&coefficients, Dimensions::Vec3)?);
            }
        }
        let all = scales.as_flattened_mut();
        let negative = all.iter().filter(|x| **x < 0.0).count();
        if 2 * negative > all.len() {
            all.iter_mut().for_each(|x| *x = x.exp());
            let message = "scales of splats are negative: they are read as logarithms, as drafts of the extension had them";
            self.files.warn(self.path, message);
        }
        let mut cloud = Cloud::new(degree, false);
        let mut harmonics = vec![[0.0; 3]; harmonics_of(degree)];
        for i in 0..n {
            let mut splat = Splat {
                center: Vec3::from_array(centers[i]),
                scale: Vec3::from_array(scales[i]),
                rotation: Vec4::from_array(rotations[i]),
                opacity: opacities[i],
            };
            for (harmonic, list) in harmonics.iter_mut().zip(&lists) {
                *harmonic = list[i];
            }
            // Turned, a negative scale might look like a positive one.
            if splat.scale.min_element() < 0.0 {
                splat.opacity = f32::NAN;
            }
            turn.apply(&mut splat, &mut harmonics);
            cloud.push(splat, &harmonics);
        }
        Ok(cloud)
    }

    /// The values of an accessor, whole numbers as they are or normalized.
    fn vectors<T: Vector>(
        &self,
        accessor: &Accessor<'_>,
        dimensions: Dimensions,
    ) -> Result<Vec<T>, String> {
        let is_fit = accessor.dimensions() == dimensions && is_addressed(accessor);
        let is_normalized = accessor.normalized();
        let read = match accessor.data_type() {
            _ if !is_fit => None,
            DataType::F32 => self.read::<T::Of<f32>, T>(accessor, |v| T::map(v, |x| x)),
            DataType::I8 => self.read::<T::Of<i8>, T>(accessor, |v| {
                T::map(v, |x| normalized(x, 127.0, is_normalized))
            }),
            DataType::U8 => self.read::<T::Of<u8>, T>(accessor, |v| {
                T::map(v, |x| normalized(x, 255.0, is_normalized))
            }),
            DataType::I16 => self.read::<T::Of<i16>, T>(accessor, |v| {
                T::map(v, |x| normalized(x, 32_767.0, is_normalized))
            }),
            DataType::U16 => self.read::<T::Of<u16>, T>(accessor, |v| {
                T::map(v, |x| normalized(x, 65_535.0, is_normalized))
            }),
            DataType::U32 => None,
        };
        read.ok_or_else(|| {
            format!(
                "accessor {} does not hold what splats are made of; export it again",
                accessor.index()
            )
        })
    }

    fn read<I: Item, T>(&self, accessor: &Accessor<'_>, value: impl Fn(I) -> T) -> Option<Vec<T>> {
        let bytes = |b: gltf::Buffer<'_>| self.buffers.get(b.index()).map(|bytes| &bytes[..]);
        let values: Vec<T> = Iter::<I>::new(accessor.clone(), bytes)?
            .map(value)
            .collect();
        (values.len() == accessor.count()).then_some(values)
    }
}

fn normalized(x: impl Into<f32>, most: f32, is_normalized: bool) -> f32 {
    let x = x.into();
    match is_normalized {
        true => (x / most).max(-1.0),
        false => x,
    }
}

/// A value of an accessor, and the same of other numbers.
trait Vector: Sized {
    type Of<N: Item + Copy>: Item;

    fn map<N: Item + Copy>(values: Self::Of<N>, number: impl Fn(N) -> f32) -> Self;
}

impl Vector for f32 {
    type Of<N: Item + Copy> = N;

    fn map<N: Item + Copy>(value: N, number: impl Fn(N) -> f32) -> Self {
        number(value)
    }
}

impl Vector for [f32; 3] {
    type Of<N: Item + Copy> = [N; 3];

    fn map<N: Item + Copy>(values: [N; 3], number: impl Fn(N) -> f32) -> Self {
        values.map(number)
    }
}

impl Vector for [f32; 4] {
    type Of<N: Item + Copy> = [N; 4];

    fn map<N: Item + Copy>(values: [N; 4], number: impl Fn(N) -> f32) -> Self {
        values.map(number)
    }
}
