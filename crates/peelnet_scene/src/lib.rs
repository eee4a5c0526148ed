//! Placeholder types until the crate is written.
#![allow(missing_docs)]
use glam::{Mat4, Vec3};
use std::{ops::Range, path::PathBuf, sync::Arc};
#[derive(Clone, Debug)]
pub struct Scene { pub name: String, pub source: PathBuf, pub hash: String, pub background: [f32; 3], pub views: Vec<Camera>, pub lights: Vec<Light>, pub objects: Vec<Object>, pub held_out: bool, pub warnings: Vec<String> }
#[derive(Clone, Debug)]
pub struct Object { pub name: String, pub mesh: Arc<Mesh>, pub world_from_object: Mat4, pub layer: u32, pub materials: Vec<Material> }
#[derive(Clone, Debug)]
pub struct Mesh { pub positions: Vec<Vec3>, pub normals: Vec<Vec3>, pub triangles: Vec<[u32; 3]>, pub parts: Vec<Part> }
#[derive(Clone, Debug)]
pub struct Part { pub name: String, pub triangles: Range<usize>, pub material: Material }
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lighting { Unlit, Phong }
#[derive(Clone, Debug)]
pub struct Material { pub name: String, pub color: [f32; 3], pub alpha: f32, pub lighting: Lighting, pub specular: f32, pub shininess: f32, pub double_sided: bool, pub blend: bool }
#[derive(Clone, Copy, Debug)]
pub struct Camera { pub position: Vec3, pub target: Vec3, pub up: Vec3, pub fov_y_degrees: f32, pub near: f32, pub far: f32 }
#[derive(Clone, Copy, Debug)]
pub struct Light { pub position: Vec3, pub color: [f32; 3], pub intensity: f32 }
impl Camera {
    pub fn view_from_world(&self) -> Mat4 { glam::camera::rh::view::look_at_mat4(self.position, self.target, self.up) }
    pub fn clip_from_view(&self, aspect: f32) -> Mat4 { glam::camera::rh::proj::directx::perspective(self.fov_y_degrees.to_radians(), aspect, self.near, self.far) }
}
impl Scene { pub fn varied(&self, _seed: u64, _copy: u32) -> Scene { self.clone() } }
