// Gaussian splats (Kerbl et al. 2023): the ellipse that one covers on the screen, where in depth it lies there, and its colour.
import package::scene::camera::camera;
@if(splat_color && !display) import package::helpers::display::light_of;

// As `SplatData` in peelnet_render, geometry/splats.rs.
struct Splat {
    // Covariance in the world: xx, xy, xz.
    covariance_x: vec3f,
    opacity: f32,
    // yy, yz, zz.
    covariance_yz: vec3f,
    // Where its harmonics begin, times 8, their degree times 2, and whether opacity makes up for the blur.
    harmonics: u32,
    // Quaternion from the world to the object, in which harmonics are said.
    object_from_world: vec4f,
}

@group(0) @binding(4) var<storage, read> splats: array<Splat>;
// Two half floats each: red, green and blue of each harmonic in turn.
@if(splat_color) @group(0) @binding(5) var<storage, read> harmonics: array<u32>;

// Variance added on the screen, pixels squared: no splat is narrower than a pixel.
const SPLAT_BLUR: f32 = 0.3;
// No splat covers more: behind it something is always seen.
const MOST_COVERED: f32 = 0.99;
// Less is not drawn.
const FAINTEST: f32 = 1.0 / 255.0;
// How far aside the projection is still followed, of the depth. Farther aside it stretches without end.
const FARTHEST_ASIDE: f32 = 2.0;
// Most that the depth of a splat differs within it, of the reciprocal of its depth: what passes the eye stays in front of it.
const MOST_TILTED: f32 = 0.5;

// A corner of the triangle around a splat.
struct SplatCorner {
    position: vec4f,
    // From the centre, in standard deviations.
    gaussian: vec2f,
    opacity: f32,
}

fn times_covariance(splat: Splat, v: vec3f) -> vec3f {
    let a = splat.covariance_x;
    let b = splat.covariance_yz;
    return vec3f(dot(a, v), dot(vec3f(a.y, b.xy), v), dot(vec3f(a.z, b.yz), v));
}

// A fragment's depth is that where the Gaussian is largest along its ray, for a projection that is linear around the centre: its mean, given
// the pixel. Those depths form a plane, on which the triangle lies: splats and surfaces cross pixel by pixel.
fn splat_corner(splat: Splat, center: vec3f, corner: u32) -> SplatCorner {
    let m = transpose(camera.clip_from_world);
    let clip = camera.clip_from_world * vec4f(center, 1.0);
    let depth = clip.w;
    let half_frame = 0.5 * vec2f(camera.frame_size);
    let seen = vec2f(clip.xy) / depth;
    let ahead = camera.eye + depth * m[3].xyz;
    let aside = center - ahead;
    let kept = aside * min(1.0, FARTHEST_ASIDE * depth / max(length(aside), 1e-20));
    let followed = (camera.clip_from_world * vec4f(ahead + kept, 1.0)).xy / depth;
    // What a step in the world is on the screen, pixels, and along the view axis.
    let right = (m[0].xyz - followed.x * m[3].xyz) * (half_frame.x / depth);
    let up = (m[1].xyz - followed.y * m[3].xyz) * (half_frame.y / depth);
    let of_right = times_covariance(splat, right);
    let of_up = times_covariance(splat, up);
    let sharp = vec3f(dot(right, of_right), dot(right, of_up), dot(up, of_up));
    let wide = sharp + vec3f(SPLAT_BLUR, 0.0, SPLAT_BLUR);
    var opacity = splat.opacity;
    if (splat.harmonics & 1u) == 1u {
        let areas = vec2f(sharp.x * sharp.z - sharp.y * sharp.y, wide.x * wide.z - wide.y * wide.y);
        opacity *= sqrt(max(areas.x, 0.0) / areas.y);
    }
    // Before the near plane, or never seen.
    if clip.z <= 0.0 || opacity <= FAINTEST {
        return SplatCorner(vec4f(0.0, 0.0, -1.0, 1.0), vec2f(0.0), 0.0);
    }
    // Axes of the ellipse, and the standard deviations along them.
    let middle = 0.5 * (wide.x + wide.z);
    let apart = 0.5 * (wide.x - wide.z);
    let radius = sqrt(apart * apart + wide.y * wide.y);
    let deviations = sqrt(vec2f(middle + radius, max(middle - radius, SPLAT_BLUR)));
    let leaning = vec2f(apart + radius, wide.y);
    let other = vec2f(wide.y, radius - apart);
    let chosen = select(other, leaning, apart >= 0.0);
    let major = select(vec2f(1.0, 0.0), normalize(chosen), dot(chosen, chosen) > 1e-12);
    let minor = vec2f(-major.y, major.x);
    // Half of an equilateral triangle around the circle of this radius: corners twice as far out.
    let reach = sqrt(2.0 * log(opacity / FAINTEST));
    let angle = f32(corner) * 2.0943951;
    let gaussian = 2.0 * reach * vec2f(cos(angle), sin(angle));
    let offset = gaussian.x * deviations.x * major + gaussian.y * deviations.y * minor;
    // Depth for each standard deviation along the axes, of the centre's depth.
    let deeper = vec2f(dot(m[3].xyz, of_right), dot(m[3].xyz, of_up)) / depth;
    let slope = vec2f(dot(deeper, major), dot(deeper, minor)) / deviations;
    let tilt = dot(slope, gaussian);
    let most = 2.0 * reach * length(slope);
    let w = depth / (1.0 - tilt * min(1.0, MOST_TILTED / max(most, 1e-12)));
    let z = clip.z + camera.window_depth_at_infinity * (w - depth);
    return SplatCorner(vec4f((seen + offset / half_frame) * w, z, w), gaussian, opacity);
}

@if(splat_color)
fn harmonic(begin: u32, k: u32) -> vec3f {
    let first = begin + (3u * k) / 2u;
    let a = unpack2x16float(harmonics[first]);
    let b = unpack2x16float(harmonics[first + 1u]);
    return select(vec3f(a.x, a.y, b.x), vec3f(a.y, b.x, b.y), (k & 1u) == 1u);
}

fn turned(v: vec3f, q: vec4f) -> vec3f {
    return v + 2.0 * cross(q.xyz, cross(q.xyz, v) + q.w * v);
}

// Its colour as it is seen from here, in the space in which the scene blends.
@if(splat_color)
fn splat_color(splat: Splat, center: vec3f) -> vec3f {
    let degree = (splat.harmonics >> 1u) & 3u;
    let begin = splat.harmonics >> 3u;
    let d = turned(normalize(center - camera.eye), splat.object_from_world);
    var color = vec3f(0.5) + 0.2820948 * harmonic(begin, 0u);
    if degree > 0u {
        color += 0.4886025 * (d.z * harmonic(begin, 2u) - d.y * harmonic(begin, 1u) - d.x * harmonic(begin, 3u));
    }
    let s = d * d;
    if degree > 1u {
        color += 1.0925484 * d.x * d.y * harmonic(begin, 4u) - 1.0925484 * d.y * d.z * harmonic(begin, 5u)
            + 0.3153916 * (2.0 * s.z - s.x - s.y) * harmonic(begin, 6u) - 1.0925484 * d.x * d.z * harmonic(begin, 7u)
            + 0.5462742 * (s.x - s.y) * harmonic(begin, 8u);
    }
    if degree > 2u {
        color += -0.5900436 * d.y * (3.0 * s.x - s.y) * harmonic(begin, 9u)
            + 2.8906114 * d.x * d.y * d.z * harmonic(begin, 10u)
            - 0.4570458 * d.y * (4.0 * s.z - s.x - s.y) * harmonic(begin, 11u)
            + 0.3731763 * d.z * (2.0 * s.z - 3.0 * s.x - 3.0 * s.y) * harmonic(begin, 12u)
            - 0.4570458 * d.x * (4.0 * s.z - s.x - s.y) * harmonic(begin, 13u)
            + 1.4453057 * d.z * (s.x - s.y) * harmonic(begin, 14u)
            - 0.5900436 * d.x * (s.x - 3.0 * s.y) * harmonic(begin, 15u);
    }
    let shown = max(color, vec3f(0.0));
    @if(display) return shown;
    @else return light_of(shown);
}
