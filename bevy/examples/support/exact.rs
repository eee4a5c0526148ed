//! The exact image of cards: rays through the samples of each pixel, in 64 bits, composited front to back.
//!
//! It shares no code with any renderer: planes are cut by rays, and colours are those that the scene says.

use super::cards::{BACKGROUND, Card, EYE};
use bevy::{
    math::{DMat4, DVec2, DVec3, DVec4},
    prelude::*,
};

/// Vertical field of view of the camera, Bevy's default.
const FIELD_OF_VIEW: f64 = std::f64::consts::FRAC_PI_4;
/// Rasterisers and rays may disagree about a pixel that an edge passes within this, in pixels.
const MARGIN: f64 = 0.02;

pub struct Pixel {
    /// Red, green and blue of 255 as a screen gets them, not rounded.
    pub color: [f64; 3],
    /// Whether no edge and no cut passes a sample.
    pub is_certain: bool,
}

/// How far a picture is from the exact one, of 255.
#[derive(Clone, Copy, Debug)]
pub struct Errors {
    /// Root of the mean square, of all channels.
    pub rmse: f64,
    pub max: f64,
    /// Share of pixels with a channel that is more than 2 off.
    pub visible: f64,
    /// Share of pixels that were judged.
    pub judged: f64,
}

/// Where the samples of a pixel lie, in eighths of it, as Vulkan and Direct3D have them.
fn places_of(count: u32) -> &'static [[u8; 2]] {
    match count {
        1 => &[[4, 4]],
        4 => &[[3, 1], [7, 3], [1, 5], [5, 7]],
        _ => panic!("{count} samples have no places here"),
    }
}

/// A card as rays see it: `local_from_world`, and its colour and opacity.
type Plane = (DMat4, DVec4);

/// The image of cards at a size, with so many samples a pixel.
pub fn picture(cards: &[Card], size: UVec2, sample_count: u32) -> Vec<Pixel> {
    let planes = cards.iter().map(|card| {
        let local_from_world = card.transform.to_matrix().as_dmat4().inverse();
        (local_from_world, card.color.to_vec4().as_dvec4())
    });
    let planes: Vec<Plane> = planes.collect();
    let places = places_of(sample_count);
    let pixels = (0..size.x * size.y).map(|index| {
        let corner = UVec2::new(index % size.x, index / size.x).as_dvec2();
        let mut sum = DVec3::ZERO;
        let mut is_certain = true;
        for &place in places {
            let point = corner + DVec2::from(place.map(f64::from)) / 8.0;
            let hits = hits_at(&planes, point, size);
            sum += composited(&planes, &hits);
            for away in [[1.0, 1.0], [-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0]] {
                let beside = point + MARGIN * DVec2::from(away);
                is_certain &= hits == hits_at(&planes, beside, size);
            }
        }
        let mean = sum / places.len() as f64;
        let color = mean.to_array().map(|v| encoded(v) * 255.0);
        Pixel { color, is_certain }
    });
    pixels.collect()
}

/// Which cards the ray through a point of the image meets, front to back.
fn hits_at(planes: &[Plane], point: DVec2, size: UVec2) -> Vec<usize> {
    let size = size.as_dvec2();
    let half = (FIELD_OF_VIEW * 0.5).tan();
    let from_middle = (point / size * 2.0 - 1.0) * DVec2::new(half * size.x / size.y, -half);
    // Its length along the view's axis is 1, so that hits are distances along that axis.
    let direction = from_middle.extend(-1.0);
    let mut hits = Vec::new();
    for (index, (local_from_world, _)) in planes.iter().enumerate() {
        let from = *local_from_world * EYE.as_dvec3().extend(1.0);
        let along = *local_from_world * direction.extend(0.0);
        let distance = -from.z / along.z;
        let at = from + along * distance;
        if distance > 0.1 && at.x.abs() <= 0.5 && at.y.abs() <= 0.5 {
            hits.push((distance, index));
        }
    }
    hits.sort_by(|a, b| a.0.total_cmp(&b.0));
    hits.into_iter().map(|(_, index)| index).collect()
}

fn composited(planes: &[Plane], hits: &[usize]) -> DVec3 {
    let mut color = DVec3::ZERO;
    let mut transmittance = 1.0;
    for &index in hits {
        let (_, layer) = planes[index];
        color += transmittance * layer.w * layer.truncate();
        transmittance *= 1.0 - layer.w;
    }
    color + transmittance * BACKGROUND.to_vec3().as_dvec3()
}

/// The sRGB curve.
pub fn encoded(linear: f64) -> f64 {
    if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * linear.powf(1.0 / 2.4) - 0.055
    }
}

/// Compares a picture of four bytes a pixel with the exact one.
pub fn errors_of(exact: &[Pixel], picture: &[u8]) -> Errors {
    let (mut squares, mut max, mut visible, mut judged) = (0.0, 0.0f64, 0u32, 0u32);
    let pairs = exact.iter().zip(picture.chunks(4));
    for (exact, bytes) in pairs.filter(|(exact, _)| exact.is_certain) {
        judged += 1;
        let differences = [0, 1, 2].map(|c| (exact.color[c] - f64::from(bytes[c])).abs());
        let worst = differences.into_iter().fold(0.0, f64::max);
        squares += differences.iter().map(|d| d * d).sum::<f64>();
        max = max.max(worst);
        visible += u32::from(worst > 2.0);
    }
    Errors {
        rmse: (squares / f64::from(3 * judged)).sqrt(),
        max,
        visible: f64::from(visible) / f64::from(judged),
        judged: f64::from(judged) / exact.len() as f64,
    }
}

pub fn bytes_of(exact: &[Pixel]) -> Vec<u8> {
    let bytes = |pixel: &Pixel| {
        let [red, green, blue] = pixel.color.map(|v| (v + 0.5) as u8);
        [red, green, blue, 255]
    };
    exact.iter().flat_map(bytes).collect()
}
