//! Materials, their textures, and the UV sets and transforms of these.

use super::nodes::{Reader, finite, name_of};
use crate::{
    files::MAX_IMAGE,
    material::{Lighting, Material},
    specular_glossiness::{Values, convert},
    texture::{Maps, Texture, Wrap},
};
use glam::{Affine2, Vec2};
use gltf::{
    material::{AlphaMode, PbrSpecularGlossiness},
    texture::{MagFilter, WrappingMode},
};
use peelnet_core::files::printable;
use std::{path::Path, sync::Arc};

/// The UV set of a texture, and the transform of its UVs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Placement {
    pub set: u32,
    pub transform: Affine2,
}

impl Placement {
    /// KHR_texture_transform: scaled, turned, moved.
    fn of(info: &gltf::texture::Info<'_>) -> Self {
        let set = info.tex_coord();
        let Some(t) = info.texture_transform() else {
            let transform = Affine2::IDENTITY;
            return Self { set, transform };
        };
        let [scale, offset] = [t.scale(), t.offset()].map(Vec2::from);
        Self {
            set: t.tex_coord().unwrap_or(set),
            transform: Affine2::from_scale_angle_translation(scale, -t.rotation(), offset),
        }
    }
}

/// The specular–glossiness workflow of a material that has it. An unlit one has neither workflow.
fn specular_glossiness<'a>(m: &gltf::Material<'a>) -> Option<PbrSpecularGlossiness<'a>> {
    m.pbr_specular_glossiness().filter(|_| !m.unlit())
}

/// A material's textures in the order of [`Maps::all`], and their placements. A texture of specular colours and glossiness is in the place of
/// metallic and roughness.
fn placed_textures<'a>(m: &gltf::Material<'a>) -> [Option<(gltf::Texture<'a>, Placement)>; 5] {
    let pbr = m.pbr_metallic_roughness();
    let [color, finish] = match specular_glossiness(m) {
        Some(pbr) => [pbr.diffuse_texture(), pbr.specular_glossiness_texture()],
        None => [pbr.base_color_texture(), pbr.metallic_roughness_texture()],
    };
    let placed = [color, finish, m.emissive_texture()]
        .map(|info| info.map(|t| (t.texture(), Placement::of(&t))));
    // The crate does not return the transforms of normal and occlusion maps: they are taken to be the first of the others'.
    let first = placed.iter().flatten().next();
    let transform = first.map_or(Affine2::IDENTITY, |(_, placement)| placement.transform);
    let shared = |set: u32| Placement { set, transform };
    let [color, finish, emissive] = placed;
    let normal = m.normal_texture();
    let normal = normal.map(|t| (t.texture(), shared(t.tex_coord())));
    let occlusion = m.occlusion_texture();
    let occlusion = occlusion.map(|t| (t.texture(), shared(t.tex_coord())));
    [color, normal, finish, occlusion, emissive]
}

impl Reader<'_, '_> {
    /// A texture, read once, `opaque` without its opacity; `None`, with a warning, where it cannot be drawn.
    fn image(&mut self, image: &gltf::Image<'_>, opaque: bool) -> Option<Arc<Texture>> {
        // Of many images with one source, it is decoded once.
        let source = match image.source() {
            gltf::image::Source::View { view, .. } => {
                let bytes = self.buffers.get(view.buffer().index());
                format!("{:?} at {}", bytes.map(Arc::as_ptr), view.offset())
            }
            gltf::image::Source::Uri { uri, .. } => {
                let folder = self.path.parent().unwrap_or(Path::new("."));
                let uri = urlencoding::decode(uri).unwrap_or(uri.into());
                self.files.identity(&folder.join(&*uri))
            }
        };
        let key = (source, opaque);
        if let Some(known) = self.images.get(&key) {
            return known.clone();
        }
        let found = if opaque {
            self.image(image, false).map(|found| match found.has_alpha {
                true => Arc::new(found.opaque()),
                false => found,
            })
        } else {
            let name = name_of(image.name(), "image", image.index());
            match self.decode(image, &name) {
                Ok(texture) => Some(Arc::new(texture)),
                Err(why) => {
                    let shown = match image.source() {
                        gltf::image::Source::Uri { uri, .. } if !uri.starts_with("data:") => {
                            format!("{} ('{}')", printable(&name), printable(uri))
                        }
                        _ => printable(&name).into_owned(),
                    };
                    self.missing("", &shown, &format!(", which {why}"));
                    None
                }
            }
        };
        self.images.insert(key, found.clone());
        found
    }

    fn decode(&mut self, image: &gltf::Image<'_>, name: &str) -> Result<Texture, String> {
        let read;
        let bytes = match image.source() {
            gltf::image::Source::View { view, .. } => {
                let bytes = self.buffers.get(view.buffer().index());
                let end = view.offset().saturating_add(view.length());
                let bytes = bytes.and_then(|b| b.get(view.offset()..end));
                bytes.ok_or("lies beyond its buffer")?
            }
            gltf::image::Source::Uri { uri, .. } => {
                read = self.read_uri(uri, MAX_IMAGE)?;
                &read
            }
        };
        Texture::decode(name, bytes, &mut self.files.budget)
    }

    /// A material's maps, and their common placement.
    fn maps(&mut self, m: &gltf::Material<'_>) -> (Maps, Placement) {
        let textures = placed_textures(m);
        let mut placements = textures.iter().flatten().map(|(_, placement)| *placement);
        let placement = placements.next().unwrap_or_default();
        let samplers = textures.iter().flatten().map(|(t, _)| {
            let sampler = t.sampler();
            (sampler.wrap_s(), sampler.wrap_t(), sampler.mag_filter())
        });
        let samplers: Vec<_> = samplers.collect();
        if samplers.windows(2).any(|w| w[0] != w[1]) {
            let what = "a map with its own sampler (the first map's is used)";
            self.missing(what, "", "");
        }
        // The first is the base colour, whose file may hold an opacity.
        let mut opaque = m.alpha_mode() == AlphaMode::Opaque;
        let [color, normal, metallic_roughness, occlusion, emissive] = textures.map(|texture| {
            let opaque = std::mem::take(&mut opaque);
            let (texture, own) = texture?;
            if own.transform != placement.transform {
                let what = "a map with its own texture transform (the first map's is used)";
                self.missing(what, "", "");
            }
            if own.set != placement.set {
                let what = "a map on other texture coordinates than the first map's";
                self.missing(what, "", "");
                return None;
            }
            // Of an extension that is not read, such as another format of images.
            let Some(image) = texture.source() else {
                self.missing("a texture without an image", "", "");
                return None;
            };
            self.image(&image, opaque)
        });
        let repeat = (WrappingMode::Repeat, WrappingMode::Repeat, None);
        let (wrap_s, wrap_t, filter) = samplers.first().copied().unwrap_or(repeat);
        let wrap = |mode| match mode {
            WrappingMode::Repeat => Wrap::Repeat,
            WrappingMode::MirroredRepeat => Wrap::Mirror,
            WrappingMode::ClampToEdge => Wrap::Clamp,
        };
        let normal_scale = m.normal_texture().map_or(1.0, |n| n.scale());
        let occlusion_strength = m.occlusion_texture().map_or(1.0, |o| o.strength());
        let maps = Maps {
            color,
            normal,
            metallic_roughness,
            occlusion,
            emissive,
            displacement: None,
            normal_scale: finite(normal_scale, -100.0, 100.0),
            occlusion_strength: finite(occlusion_strength, 0.0, 1.0),
            wrap: [wrap(wrap_s), wrap(wrap_t)],
            nearest: filter == Some(MagFilter::Nearest),
        };
        (maps, placement)
    }

    /// Converts a material of the specular–glossiness workflow, whose second map is in the place of metallic and roughness.
    fn convert(&mut self, material: &mut Material, pbr: &PbrSpecularGlossiness<'_>) {
        let unit = |x: f32| finite(x, 0.0, 1.0);
        let values = Values {
            diffuse: material.color,
            specular: pbr.specular_factor().map(unit),
            glossiness: unit(pbr.glossiness_factor()),
        };
        let specular = material.maps.metallic_roughness.take();
        if let Err(why) = convert(values, material, specular.as_ref(), self.files) {
            let what = format!("maps of the specular–glossiness workflow, which take {why}");
            self.missing(&what, "", "");
            material.maps.color = None;
            // Without maps it takes nothing.
            let _ = convert(values, material, None, self.files);
        }
    }

    pub fn material(&mut self, m: &gltf::Material<'_>) -> (Material, Placement) {
        let (maps, placement) = self.maps(m);
        let pbr = m.pbr_metallic_roughness();
        let specular = specular_glossiness(m);
        let [r, g, b, a] = match &specular {
            Some(pbr) => pbr.diffuse_factor(),
            None => pbr.base_color_factor(),
        };
        let lighting = if m.unlit() {
            Lighting::Unlit
        } else {
            Lighting::Pbr
        };
        let strength = m.emissive_strength().unwrap_or(1.0);
        let (alpha, blend, alpha_cutoff) = match m.alpha_mode() {
            AlphaMode::Opaque => (1.0, false, None),
            AlphaMode::Mask => (a, false, Some(m.alpha_cutoff().unwrap_or(0.5))),
            AlphaMode::Blend => (a, true, None),
        };
        let mut is_beyond = false;
        let mut within = |x: f32, high: f32| {
            let value = finite(x, 0.0, high);
            is_beyond |= value != x;
            value
        };
        let mut material = Material {
            name: m.name().unwrap_or("unnamed").to_owned(),
            color: [r, g, b].map(|c| within(c, 1.0)),
            alpha: within(alpha, 1.0),
            metallic: within(pbr.metallic_factor(), 1.0),
            roughness: within(pbr.roughness_factor(), 1.0),
            emission: m.emissive_factor().map(|c| within(c * strength, 1e6)),
            maps,
            alpha_cutoff: alpha_cutoff.map(|c| finite(c, 0.0, 1.0)),
            double_sided: m.double_sided(),
            blend,
            ..Material::default_with(lighting)
        };
        if let Some(pbr) = specular {
            self.convert(&mut material, &pbr);
        }
        // What passes is not scattered: glTF's mix of both, as opacity and colour (McGuire and Mara 2016).
        if let Some(t) = m.transmission() {
            if t.transmission_texture().is_some() {
                self.missing("transmission maps (the factor alone is drawn)", "", "");
            }
            let passing = within(t.transmission_factor(), 1.0);
            material.transmission = material.color.map(|c| c * passing);
            material.color = material.color.map(|c| c * (1.0 - passing));
        }
        // Such files are lit by their base colour alone.
        if m.unlit() {
            (material.emission, material.maps.emissive) = ([0.0; 3], None);
        }
        if is_beyond {
            self.files.warnings.clamped(self.path, &material.name);
        }
        (material, placement)
    }
}
