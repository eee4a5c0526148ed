use peelnet_core::srgb;
use ply_rs_bw::ply::{Property, PropertyAccess, PropertyAccessResult as Answer};

/// Names of the channels of a vertex's colour, as programs write them.
pub(super) const RED: [&str; 3] = ["red", "r", "diffuse_red"];
pub(super) const GREEN: [&str; 3] = ["green", "g", "diffuse_green"];
pub(super) const BLUE: [&str; 3] = ["blue", "b", "diffuse_blue"];
pub(super) const ALPHA: [&str; 3] = ["alpha", "a", "diffuse_alpha"];

/// Names of a texture coordinate of a vertex.
pub(super) const U: [&str; 4] = ["s", "u", "texture_u", "texture_s"];

/// Names of the vertices of a face.
pub(super) const INDICES: [&str; 2] = ["vertex_indices", "vertex_index"];

/// A vertex. What a file does not say has its default.
pub(super) struct Vertex {
    pub position: [f32; 3],
    pub normal: [f32; 3],
    /// Linear RGB and alpha.
    pub color: [f32; 4],
    pub uv: [f32; 2],
}

impl Vertex {
    /// Whether a property of this name becomes part of it.
    pub fn reads(name: &str) -> bool {
        matches!(
            Self::new().set_property(name, Property::Float(0.0)),
            Answer::Set
        )
    }
}

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self {
            position: [0.0; 3],
            normal: [0.0; 3],
            color: [1.0; 4],
            uv: [0.0; 2],
        }
    }

    fn set_property(&mut self, name: &str, value: Property) -> Answer {
        let Some(x) = value.to_f32_lossy() else {
            return Answer::Ignored;
        };
        match name {
            _ if RED.contains(&name) => self.color[0] = linear(&value, x),
            _ if GREEN.contains(&name) => self.color[1] = linear(&value, x),
            _ if BLUE.contains(&name) => self.color[2] = linear(&value, x),
            _ if ALPHA.contains(&name) => self.color[3] = share(&value, x),
            "x" => self.position[0] = x,
            "y" => self.position[1] = x,
            "z" => self.position[2] = x,
            "nx" => self.normal[0] = x,
            "ny" => self.normal[1] = x,
            "nz" => self.normal[2] = x,
            "s" | "u" | "texture_u" | "texture_s" => self.uv[0] = x,
            "t" | "v" | "texture_v" | "texture_t" => self.uv[1] = x,
            _ => return Answer::Ignored,
        }
        Answer::Set
    }
}

/// A value that should be 0 … 1; of whole numbers, the largest of a byte, or of a 16-bit number, is 1.
fn share(value: &Property, x: f32) -> f32 {
    let most = match value {
        Property::Float(_) | Property::Double(_) => 1.0,
        Property::UShort(_) => 65_535.0,
        _ => 255.0,
    };
    x / most
}

/// A channel of a colour as linear light. Whole numbers are sRGB.
fn linear(value: &Property, x: f32) -> f32 {
    let share = share(value, x);
    match value {
        Property::Float(_) | Property::Double(_) => share,
        _ => srgb::decode(share),
    }
}

/// A polygon or a strip.
#[derive(Default)]
pub(super) struct Face {
    pub indices: Vec<i64>,
    /// Two for each vertex, or none.
    pub uvs: Vec<f32>,
}

impl Face {
    /// Whether a property of this name becomes part of it.
    pub fn reads(name: &str) -> bool {
        name == "texcoord" || INDICES.contains(&name)
    }
}

impl PropertyAccess for Face {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, value: Property) -> Answer {
        match (name, value) {
            ("texcoord", Property::ListFloat(uvs)) => self.uvs = uvs,
            ("texcoord", Property::ListDouble(uvs)) => {
                self.uvs = uvs.into_iter().map(|x| x as f32).collect();
            }
            (name, value) if INDICES.contains(&name) => match whole(value) {
                Some(indices) => self.indices = indices,
                None => return Answer::UnsupportedType,
            },
            _ => return Answer::Ignored,
        }
        Answer::Set
    }
}

fn whole(list: Property) -> Option<Vec<i64>> {
    fn all<T: Into<i64>>(list: Vec<T>) -> Vec<i64> {
        list.into_iter().map(T::into).collect()
    }
    Some(match list {
        Property::ListChar(list) => all(list),
        Property::ListShort(list) => all(list),
        Property::ListInt(list) => all(list),
        list => all(list.to_u32_list()?),
    })
}

/// An element that is read because others follow it.
pub(super) struct Skipped;

impl PropertyAccess for Skipped {
    fn new() -> Self {
        Self
    }
}
