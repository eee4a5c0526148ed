//! What a scene may take in all, so that a small file cannot ask for endless memory. It is counted before the memory is taken.

/// Most triangles of the meshes that are generated, copied, instanced, or read from files whose headers count them.
pub(crate) const MAX_TRIANGLES: u64 = 50_000_000;

/// Most vertices of these meshes.
const MAX_VERTICES: u64 = 2 * MAX_TRIANGLES;

/// Most triangles of all objects, which share meshes: they are numbered by their vertices, in 32 bits.
pub(crate) const MAX_INSTANCED: u64 = u32::MAX as u64 / 3;

/// Most parts of all objects: each has a material, and is a draw.
pub(crate) const MAX_PARTS: u64 = 1_000_000;

/// Most texels of all textures: 4 GiB.
const MAX_TEXELS: u64 = 1 << 30;

/// Texels that a scene may have whatever its files hold: one texture of the largest size; and how many more it may have for each byte of
/// its images. Photos and painted maps have at most five; one colour, packed, has thousands.
const FREE_TEXELS: u64 = 1 << 26;
const TEXELS_A_BYTE: u64 = 64;

/// Most triangles that displacements cut others into, and most texels of generated patterns: seconds on a CPU.
pub(crate) const MAX_CUT: u64 = 8_000_000;
const MAX_GENERATED_TEXELS: u64 = 1 << 25;

/// Most changes by the states of a timeline, which are checked one by one.
pub(crate) const MAX_CHANGES: u64 = 1_000_000;

/// Most lights of a scene: every lit fragment loops over them.
pub const MAX_LIGHTS: usize = 16_384;

/// Farthest from the origin that anything lies, scene units: squares of larger numbers overflow.
pub(crate) const MAX_COORDINATE: f32 = 1e16;

/// What a scene has taken.
#[derive(Default)]
pub(crate) struct Budget {
    triangles: u64,
    vertices: u64,
    parts: u64,
    texels: u64,
    image_bytes: u64,
    cut: u64,
    generated_texels: u64,
}

impl Budget {
    /// Takes the triangles and vertices of meshes; an error holds the counts and the limit.
    pub fn take_mesh(&mut self, triangles: u64, vertices: u64) -> Result<(), String> {
        take(&mut self.triangles, triangles, MAX_TRIANGLES, "triangles")?;
        take(&mut self.vertices, vertices, MAX_VERTICES, "vertices")
    }

    /// Takes the triangles that a displacement cuts others into.
    pub fn take_cut(&mut self, triangles: u64) -> Result<(), String> {
        let what = "triangles cut by displacements";
        take(&mut self.cut, triangles, MAX_CUT, what)
    }

    /// Takes the texels of a square pattern.
    pub fn take_pattern(&mut self, size: u32) -> Result<(), String> {
        let (texels, what) = (u64::from(size).pow(2), "texels of patterns");
        take(
            &mut self.generated_texels,
            texels,
            MAX_GENERATED_TEXELS,
            what,
        )?;
        self.take_texels([size; 2])
    }

    /// Takes `parts` of each of so many objects.
    pub fn take_parts(&mut self, objects: usize, parts: usize) -> Result<(), String> {
        let parts = (objects as u64).saturating_mul(parts as u64);
        take(&mut self.parts, parts, MAX_PARTS, "parts of objects")
    }

    /// Takes the texels of an image of so many bytes.
    pub fn take_image(&mut self, size: [u32; 2], bytes: usize) -> Result<(), String> {
        self.image_bytes = self.image_bytes.saturating_add(bytes as u64);
        self.take_texels(size)
    }

    /// Takes the texels of a texture that is made.
    pub fn take_texels(&mut self, [width, height]: [u32; 2]) -> Result<(), String> {
        let texels = u64::from(width) * u64::from(height);
        let more = self.image_bytes.saturating_mul(TEXELS_A_BYTE);
        let most = FREE_TEXELS.saturating_add(more).min(MAX_TEXELS);
        take(&mut self.texels, texels, most, "texels").map_err(|e| match most {
            MAX_TEXELS => e,
            _ => format!("{e} ({FREE_TEXELS}, and {TEXELS_A_BYTE} for each byte of its images)"),
        })
    }
}

/// Checks a number that is not summed.
pub(crate) fn check(count: u64, limit: u64, what: &str) -> Result<(), String> {
    take(&mut 0, count, limit, what)
}

fn take(taken: &mut u64, more: u64, limit: u64, what: &str) -> Result<(), String> {
    let all = taken.saturating_add(more);
    if all > limit {
        let before = match *taken {
            0 => String::new(),
            n => format!(" beside {n} before"),
        };
        return Err(format!(
            "{more} {what}{before}: a scene has at most {limit}; give it fewer or smaller ones"
        ));
    }
    *taken = all;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is refused is not taken.
    #[test]
    fn limits_hold_for_the_sum() {
        let mut budget = Budget::default();
        budget.take_parts(1000, 999).expect("fits");
        let e = budget.take_parts(1001, 1).expect_err("too many");
        assert!(e.contains("1001 parts") && e.contains("999000"), "{e}");
        assert!(e.contains("1000000"), "{e}");
        budget.take_parts(1000, 1).expect("fits");
        budget.take_pattern(4096).expect("fits");
        budget.take_pattern(4096).expect("fits");
        let e = budget.take_pattern(4).expect_err("too many");
        assert!(e.contains("texels of patterns beside 33554432"), "{e}");
        // Half of the free texels are patterns'. A byte of an image allows 64 more.
        budget.take_image([8192, 4096], 0).expect("fits");
        budget.take_image([8, 16], 2).expect("fits");
        let e = budget.take_texels([1, 1]).expect_err("too many");
        assert!(
            e.contains("67108992; ") && e.contains("64 for each byte"),
            "{e}"
        );
        let e = budget.take_image([u32::MAX; 2], usize::MAX);
        let e = e.expect_err("too many");
        assert!(e.contains("1073741824") && !e.contains("byte"), "{e}");
        assert!(budget.take_parts(usize::MAX, usize::MAX).is_err());
        assert!(budget.take_mesh(MAX_TRIANGLES, MAX_VERTICES + 1).is_err());
    }
}
