//! Changes of a scene in place: what changed is written, what it needs anew comes from caches.

use crate::geometry::{
    RenderError, SceneBuffers,
    uniforms::{LightData, MaterialData},
    upload::{ATTRIBUTES, Placement, Vertex, floats},
};
use crate::gpu::wgpu;
use peelnet_scene::{Light, MAX_LIGHTS, Material, MaterialFlags, Object};

impl SceneBuffers {
    fn object(&mut self, object: usize) -> Result<&mut Object, RenderError> {
        let count = self.scene.objects.len();
        let found = self.scene.objects.get_mut(object);
        found.ok_or_else(|| missing("object", object, count))
    }

    /// Moves an object: its vertices are uploaded again, and where a mirror or tangents may change it, which of them are the same.
    ///
    /// # Errors
    /// An object that the scene does not have.
    pub fn set_transform(
        &mut self,
        object: usize,
        world_from_object: glam::Mat4,
    ) -> Result<(), RenderError> {
        let moved = self.object(object)?;
        let was_mirrored = Placement::from_object(moved).mirrored;
        moved.world_from_object = world_from_object;
        let turned = Placement::from_object(moved).mirrored != was_mirrored;
        if let Some(splats) = &self.splats {
            splats.place(&self.gpu, &self.scene, object);
        }
        for number in 0..self.parts.len() {
            let part = &mut self.parts[number];
            if part.place.0 != object || part.run.vertices.is_empty() {
                continue;
            }
            let object = &self.scene.objects[object];
            let triangles = object.mesh.parts[part.place.1].triangles.clone();
            let placement = Placement::from_object(object);
            let vertices: Vec<Vertex> = placement.vertices(triangles, number as u32).collect();
            let first = part.run.vertices.start as usize;
            self.gpu.write_at(&self.vertices, first, &vertices);
            part.measure(&vertices, object);
            // Positions and UVs are the same wherever the object stands.
            let shares_anew = turned || part.run.variant.contains(MaterialFlags::NORMAL_MAP);
            self.write_attributes(number, shares_anew);
        }
        Ok(())
    }

    /// Writes what a part's variant reads of its vertices, into buffers made where nothing has read them so far, and if asked for which of
    /// them are the same.
    fn write_attributes(&mut self, number: usize, shares_anew: bool) {
        let part = &self.parts[number];
        let first = part.run.vertices.start as usize;
        let object = &self.scene.objects[part.place.0];
        let triangles = &object.mesh.parts[part.place.1].triangles;
        let first_splat = self
            .splats
            .as_ref()
            .map_or(0, |all| all.first(part.place.0));
        let placement = Placement::from_object(object);
        let attributes = placement.attributes(triangles, part.run.variant, first_splat);
        if shares_anew {
            let numbers = placement.shared(triangles, &attributes, first);
            self.gpu.write_at(&self.shared, first, &numbers);
        }
        for (i, (buffer, values)) in self.attributes.iter_mut().zip(attributes).enumerate() {
            if values.is_empty() {
                continue;
            }
            let buffer = buffer.get_or_insert_with(|| {
                let zeros = vec![0.0f32; self.vertex_count * floats(i)];
                let usage = wgpu::BufferUsages::VERTEX;
                self.gpu.upload(ATTRIBUTES[i].0, &zeros, usage)
            });
            self.gpu.write_at(buffer, first * floats(i), &values);
        }
    }

    /// Gives a part of an object another material. Other values of the same kind are one small write; a material that needs other
    /// shader features, textures or the other pass changes [`Self::generation`].
    ///
    /// # Errors
    /// An object or part that the scene does not have, or a texture beyond the adapter's limits.
    pub fn set_material(
        &mut self,
        object: usize,
        part: usize,
        material: Material,
    ) -> Result<(), RenderError> {
        let place = (object, part);
        let found = self.object(object)?;
        let data = MaterialData::from_material(&material, found.layer.unwrap_or(0));
        let count = found.materials.len();
        let slot = found.materials.get_mut(part);
        *slot.ok_or_else(|| missing("part", part, count))? = material;
        let Some(number) = self.parts.iter().position(|p| p.place == place) else {
            return Ok(());
        };
        self.gpu.write_at(&self.materials, number, &[data]);
        if self.specify(number)? {
            self.upload_lights()?;
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
    pub fn set_lights(&mut self, lights: Vec<Light>) -> Result<(), RenderError> {
        check_lights(&lights)?;
        let before = self.scene.light_flags();
        self.scene.lights = lights;
        if self.scene.light_flags() != before {
            for number in 0..self.parts.len() {
                self.specify(number)?;
            }
            self.arrange();
            self.generation += 1;
        }
        self.upload_lights()?;
        self.colors_changed();
        Ok(())
    }

    /// Brings a part's variant, textures and attributes up to date with its material. Returns whether anything but values changed.
    fn specify(&mut self, number: usize) -> Result<bool, RenderError> {
        let (object, part) = self.parts[number].place;
        let object = &self.scene.objects[object];
        let material = &object.materials[part];
        let triangles = &object.mesh.parts[part].triangles;
        let variant = MaterialFlags::new(material, object, self.scene.light_flags());
        let maps = (self.maps).number(&self.gpu, material, variant, triangles)?;
        let new = (variant, maps, material.is_opaque());
        let part = &mut self.parts[number];
        let old = (part.run.variant, part.run.maps, part.opaque);
        (part.run.variant, part.run.maps, part.opaque) = new;
        if old.0 != variant {
            self.write_attributes(number, true);
        }
        Ok(old != new)
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
    pub(crate) fn upload_lights(&mut self) -> Result<(), RenderError> {
        check_lights(&self.scene.lights)?;
        let drawn = self.parts.iter().filter(|p| !p.run.vertices.is_empty());
        let mut variants = drawn.map(|p| p.run.variant);
        let is_lit = variants.any(|variant| variant.contains(MaterialFlags::LIT));
        let lights = self.scene.lights.iter();
        let lights: Vec<_> = lights.map(LightData::from_light).collect();
        let bytes: &[u8] = bytemuck::cast_slice(&lights);
        match &self.lights {
            Some(buffer) if buffer.size() >= bytes.len() as u64 => {
                self.gpu.queue.write_buffer(buffer, 0, bytes);
            }
            _ if is_lit => {
                let usage = wgpu::BufferUsages::STORAGE;
                self.lights = Some(self.gpu.upload("lights", &lights, usage));
                self.generation += 1;
            }
            _ => {}
        }
        Ok(())
    }
}

fn missing(what: &str, index: usize, count: usize) -> RenderError {
    RenderError::Refused(format!("the scene has no {what} {index}; it has {count}"))
}

/// Shaders loop over all lights.
fn check_lights(lights: &[Light]) -> Result<(), RenderError> {
    if lights.len() > MAX_LIGHTS {
        let count = lights.len();
        return Err(RenderError::Refused(format!(
            "the scene has {count} lights, and at most {MAX_LIGHTS} are drawn; give it fewer, brighter ones"
        )));
    }
    Ok(())
}
