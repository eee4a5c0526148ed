//! Changes of a scene in place: what changed is written, what it needs anew comes from caches.

use crate::{
    RasterError, SceneBuffers,
    scene::set_of,
    uniforms::{LightData, MaterialData},
    upload::{Placement, Sharing, Vertex, write_attributes, write_shared},
};
use peelnet_gpu::{Gpu, wgpu};
use peelnet_scene::{Light, MAX_LIGHTS, Material, Setting, Variant};

impl SceneBuffers {
    /// Moves an object: its vertices are uploaded again, and where a mirror or tangents may change it, which of them are the same.
    ///
    /// # Errors
    /// An object that the scene does not have.
    pub fn set_transform(
        &mut self,
        gpu: &Gpu,
        object: usize,
        world_from_object: glam::Mat4,
    ) -> Result<(), RasterError> {
        let count = self.scene.objects.len();
        let found = self.scene.objects.get_mut(object);
        let moved = found.ok_or(RasterError::NoSuch {
            what: "object",
            index: object,
            count,
        })?;
        let was_mirrored = Placement::of(moved).mirrored;
        moved.world_from_object = world_from_object;
        let object_data = &self.scene.objects[object];
        let placement = Placement::of(object_data);
        let turned = placement.mirrored != was_mirrored;
        let mut sharing = None;
        let parts = self.parts.iter_mut().enumerate();
        for (number, part) in parts.filter(|(_, p)| p.place.0 == object) {
            let triangles = &object_data.mesh.parts[part.place.1].triangles;
            let vertices: Vec<Vertex> = placement
                .vertices(triangles.clone(), number as u32)
                .collect();
            if vertices.is_empty() {
                continue;
            }
            let first = part.run.vertices.start as usize;
            gpu.write_at(&self.vertices, first, &vertices);
            let attributes = placement.attributes(triangles, part.run.variant);
            // Positions and UVs are the same wherever the object stands.
            if turned || part.run.variant.has_normal_map() {
                let sharing = sharing.get_or_insert_with(|| Sharing::of(placement));
                write_shared(gpu, &self.shared, sharing, triangles, &attributes, first);
            }
            write_attributes(
                gpu,
                &mut self.attributes,
                self.vertex_count,
                first,
                &attributes,
            );
            part.measure(&vertices);
        }
        Ok(())
    }

    /// Gives a part of an object another material. Other values of the same kind are one small write; a material that needs other
    /// shader features, textures or the other pass changes [`Self::generation`].
    ///
    /// # Errors
    /// An object or part that the scene does not have, or a texture beyond the adapter's limits.
    pub fn set_material(
        &mut self,
        gpu: &Gpu,
        object: usize,
        part: usize,
        material: Material,
    ) -> Result<(), RasterError> {
        let missing = |what, index, count| RasterError::NoSuch { what, index, count };
        let count = self.scene.objects.len();
        let found = self.scene.objects.get_mut(object);
        let found = found.ok_or_else(|| missing("object", object, count))?;
        let count = found.materials.len();
        let slot = found.materials.get_mut(part);
        *slot.ok_or_else(|| missing("part", part, count))? = material;
        let place = (object, part);
        let Some(number) = self.parts.iter().position(|p| p.place == place) else {
            return Ok(());
        };
        let object = &self.scene.objects[object];
        let data = MaterialData::of(&object.materials[part], object.layer.unwrap_or(0));
        gpu.write_at(&self.materials, number, &[data]);
        if self.specify(gpu, number)? {
            self.upload_lights(gpu)?;
            self.arrange();
            self.generation += 1;
        }
        self.colors_changed();
        Ok(())
    }

    /// Replaces all lights. As many as before or fewer are one small write.
    ///
    /// # Errors
    /// More than [`MAX_LIGHTS`], or a texture beyond the adapter's limits, of materials that were unlit so far.
    pub fn set_lights(&mut self, gpu: &Gpu, lights: Vec<Light>) -> Result<(), RasterError> {
        check_lights(&lights)?;
        let before = Setting::of(&self.scene);
        self.scene.lights = lights;
        if Setting::of(&self.scene) != before {
            for number in 0..self.parts.len() {
                self.specify(gpu, number)?;
            }
            self.arrange();
            self.generation += 1;
        }
        self.upload_lights(gpu)?;
        self.colors_changed();
        Ok(())
    }

    /// Brings a part's variant, textures and attributes up to date with its material. Returns whether anything but values changed.
    fn specify(&mut self, gpu: &Gpu, number: usize) -> Result<bool, RasterError> {
        let (object, part) = self.parts[number].place;
        let object = &self.scene.objects[object];
        let material = &object.materials[part];
        let triangles = object.mesh.parts[part].triangles.clone();
        let variant = Variant::of(material, object, Setting::of(&self.scene));
        let maps = set_of(gpu, &mut self.maps, material, variant, &triangles)?;
        let opaque = material.is_opaque();
        let part = &mut self.parts[number];
        if (part.run.variant, part.run.maps, part.opaque) == (variant, maps, opaque) {
            return Ok(false);
        }
        if part.run.variant != variant {
            let placement = Placement::of(object);
            let attributes = placement.attributes(&triangles, variant);
            let first = part.run.vertices.start as usize;
            let sharing = &mut Sharing::of(placement);
            write_shared(gpu, &self.shared, sharing, &triangles, &attributes, first);
            write_attributes(
                gpu,
                &mut self.attributes,
                self.vertex_count,
                first,
                &attributes,
            );
        }
        (part.run.variant, part.run.maps, part.opaque) = (variant, maps, opaque);
        Ok(true)
    }

    /// What of the scene's colours decides targets.
    fn colors_changed(&mut self) {
        let (grey, tinted) = (self.scene.is_grey(), self.scene.is_tinted());
        if (self.grey, self.tinted) != (grey, tinted) {
            (self.grey, self.tinted) = (grey, tinted);
            self.generation += 1;
        }
    }

    /// Writes the lights where any material is lit; makes their buffer larger where they do not fit.
    pub(crate) fn upload_lights(&mut self, gpu: &Gpu) -> Result<(), RasterError> {
        check_lights(&self.scene.lights)?;
        let drawn = self.parts.iter().filter(|p| !p.run.vertices.is_empty());
        let is_lit = drawn.into_iter().any(|p| p.run.variant.is_lit());
        let lights: Vec<_> = self.scene.lights.iter().map(LightData::of).collect();
        let bytes: &[u8] = bytemuck::cast_slice(&lights);
        match &self.lights {
            Some(buffer) if buffer.size() >= bytes.len() as u64 => {
                gpu.queue.write_buffer(buffer, 0, bytes);
            }
            _ if is_lit => {
                self.lights = Some(gpu.upload("lights", &lights, wgpu::BufferUsages::STORAGE));
                self.generation += 1;
            }
            _ => {}
        }
        Ok(())
    }
}

/// Shaders loop over all lights.
fn check_lights(lights: &[Light]) -> Result<(), RasterError> {
    if lights.len() > MAX_LIGHTS {
        return Err(RasterError::TooManyLights(lights.len()));
    }
    Ok(())
}
