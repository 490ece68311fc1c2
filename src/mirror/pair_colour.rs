//! Colours that make pairs visible: a vertex and its partner share one, distinct pairs differ.
//!
//! The colour is a smooth function of what the two ends of a pair have in common: the middle of their
//! positions and half their distance. The principal components of these four numbers become hue,
//! lightness and chroma in OKLab (B. Ottosson, "A perceptual color space for image processing", 2020),
//! so that equal steps look equally large. Confidence fades to grey.

use crate::detect::correspondence::Symmetry;
use crate::mesh::rotation::eigenvectors;
use crate::mesh::vector::{squared_norm, subtract};
use crate::mesh::{Mesh, NONE};

/// What a pair has in common: the middle of the two positions, and half their distance.
type Common = [f64; 4];

/// Lightness and chroma of the middle of the range, and how far each is moved.
const LIGHTNESS: f64 = 0.74;
const LIGHTNESS_SPAN: f64 = 0.20;
const CHROMA: f64 = 0.125;
const CHROMA_SPAN: f64 = 0.05;
/// Hues in degrees from the low to the high end: less than a full turn, so that the ends differ.
const HUE_START: f64 = 265.0;
const HUE_SPAN: f64 = -300.0;
/// Lightness of the grey that stands for "not known".
const GREY: [f64; 3] = [0.72, 0.0, 0.0];
/// Share of the even spread over all vertices (the rest keeps the original spacing).
const EQUALISED: f64 = 0.5;

/// One 8-bit sRGB colour per caller's vertex; grey where there is no partner or no confidence.
///
/// Cost: O(n log n).
pub fn pair_colours(mesh: &Mesh, symmetry: &Symmetry) -> Vec<[u8; 3]> {
    let common: Vec<Option<Common>> =
        (0..symmetry.partner.len()).map(|vertex| common_of_pair(mesh, symmetry, vertex)).collect();
    let known: Vec<Common> = common.iter().flatten().copied().collect();
    let axes = principal_axes(&known);
    let scales = axes.map(|axis| Spread::new(known.iter().map(|common| dot(common, &axis)).collect()));
    let colour = |(vertex, common): (usize, &Option<Common>)| match common {
        None => srgb(GREY),
        Some(common) => {
            let shares: [f64; 3] = std::array::from_fn(|k| scales[k].share(dot(common, &axes[k])));
            srgb(faded(shares, f64::from(symmetry.confidence[vertex])))
        }
    };
    common.iter().enumerate().map(colour).collect()
}

fn common_of_pair(mesh: &Mesh, symmetry: &Symmetry, vertex: usize) -> Option<Common> {
    let place = |vertex: usize| {
        let point = mesh.point_of_vertex[vertex];
        (point != NONE).then(|| mesh.positions[point as usize])
    };
    let (own, other) = (place(vertex)?, place(usize::try_from(symmetry.partner[vertex]).ok()?)?);
    let [x, y, z] = std::array::from_fn(|k| (own[k] + other[k]) / 2.0);
    Some([x, y, z, squared_norm(subtract(own, other)).sqrt() / 2.0])
}

/// The three directions of largest variance.
fn principal_axes(samples: &[Common]) -> [Common; 3] {
    let (variances, vectors) = eigenvectors(covariance(samples));
    let mut order = [0, 1, 2, 3];
    order.sort_by(|&a, &b| variances[b].total_cmp(&variances[a]));
    std::array::from_fn(|k| {
        let axis = vectors.map(|row| row[order[k]]);
        // Of the two ends of an axis always the same is ahead.
        let ahead: f64 = (0..4).map(|i| (1.0 + 0.1 * (i + k) as f64) * axis[i]).sum();
        if ahead < 0.0 { axis.map(|x| -x) } else { axis }
    })
}

fn covariance(samples: &[Common]) -> [Common; 4] {
    let count = samples.len().max(1) as f64;
    let mean: Common = std::array::from_fn(|i| samples.iter().map(|sample| sample[i]).sum::<f64>() / count);
    let entry = |i: usize, j: usize| {
        samples.iter().map(|sample| (sample[i] - mean[i]) * (sample[j] - mean[j])).sum::<f64>() / count
    };
    std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
}

/// Spreads values over 0..=1, half by their size and half by their rank.
struct Spread {
    sorted: Vec<f64>,
}

impl Spread {
    fn new(mut values: Vec<f64>) -> Spread {
        values.sort_by(f64::total_cmp);
        Spread { sorted: values }
    }

    fn share(&self, value: f64) -> f64 {
        let (low, high) = (self.sorted[0], self.sorted[self.sorted.len() - 1]);
        let linear = if high > low { ((value - low) / (high - low)).clamp(0.0, 1.0) } else { 0.5 };
        let below = self.sorted.partition_point(|&other| other < value);
        let not_above = self.sorted.partition_point(|&other| other <= value);
        let rank = (below + not_above) as f64 / (2 * self.sorted.len()) as f64;
        EQUALISED * rank + (1.0 - EQUALISED) * linear
    }
}

/// OKLab colour of the three shares, faded to grey as confidence falls.
fn faded(shares: [f64; 3], confidence: f64) -> [f64; 3] {
    let hue = (HUE_START + HUE_SPAN * shares[0]).to_radians();
    let lightness = LIGHTNESS + LIGHTNESS_SPAN * (shares[1] - 0.5);
    let chroma = CHROMA + CHROMA_SPAN * (shares[2] - 0.5);
    let colour = [lightness, chroma * hue.cos(), chroma * hue.sin()];
    let kept = confidence.clamp(0.0, 1.0);
    std::array::from_fn(|k| kept * colour[k] + (1.0 - kept) * GREY[k])
}

/// OKLab to 8-bit sRGB, clipped to the gamut.
fn srgb([lightness, a, b]: [f64; 3]) -> [u8; 3] {
    let cone = [
        lightness + 0.396_337_777_4 * a + 0.215_803_757_3 * b,
        lightness - 0.105_561_345_8 * a - 0.063_854_172_8 * b,
        lightness - 0.089_484_177_5 * a - 1.291_485_548 * b,
    ]
    .map(|value| value.powi(3));
    let linear = [
        4.076_741_662_1 * cone[0] - 3.307_711_591_3 * cone[1] + 0.230_969_929_2 * cone[2],
        -1.268_438_004_6 * cone[0] + 2.609_757_401_1 * cone[1] - 0.341_319_396_5 * cone[2],
        -0.004_196_086_3 * cone[0] - 0.703_418_614_7 * cone[1] + 1.707_614_701 * cone[2],
    ];
    linear.map(|value| {
        let value = value.clamp(0.0, 1.0);
        let encoded =
            if value <= 0.003_130_8 { 12.92 * value } else { 1.055 * value.powf(1.0 / 2.4) - 0.055 };
        (255.0 * encoded).round() as u8
    })
}

fn dot(a: &Common, b: &Common) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn oklab_white_grey_and_red_are_srgb_white_grey_and_red() {
        assert_eq!(srgb([1.0, 0.0, 0.0]), [255, 255, 255]);
        let grey = srgb([0.6, 0.0, 0.0]);
        assert!(grey[0] == grey[1] && grey[1] == grey[2]);
        // sRGB red as its author's page gives it: L = 0.628, a = 0.225, b = 0.126.
        assert_eq!(srgb([0.627_955, 0.224_863, 0.125_846]), [255, 0, 0]);
    }

    #[test]
    fn principal_axes_follow_the_variance() {
        let samples: Vec<Common> = (0..64)
            .map(|i| [9.0 * f64::from(i % 2), 3.0 * f64::from(i / 2 % 2), f64::from(i / 4 % 2), 0.0])
            .collect();
        let axes = principal_axes(&samples);
        for (k, axis) in axes.iter().enumerate() {
            assert!((axis[k].abs() - 1.0).abs() < 1e-6, "axis {k} is {axis:?}");
        }
    }

    #[test]
    fn no_confidence_is_grey_whatever_the_pair() {
        assert_eq!(srgb(faded([0.1, 0.9, 0.4], 0.0)), srgb(GREY));
        assert_ne!(srgb(faded([0.1, 0.9, 0.4], 1.0)), srgb(GREY));
    }
}
