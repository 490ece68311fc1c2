//! The embedded sign network: its weights and its forward pass.
//!
//! A layer is `max(W x + b, 0)`. Three layers run at each point, a maximum runs over the points, and two more
//! layers give the logits; the last has no `max(., 0)`. A column of a matrix holds all channels of one point.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatRef, Par};

use super::REFERENCES;

/// Points that the network was trained at.
pub(super) const POINTS: usize = 256;
/// Channels of the input, of the three layers at a point and of the two after the maximum (`training/network.py`).
const WIDTHS: [usize; 6] = [REFERENCES + 1, 48, 96, 192, 64, 3];
/// Of each layer the weights, input by input, then the biases: little-endian `f32` (`training/export.py`).
const WEIGHTS: &[u8] = include_bytes!("../../../models/signnet.weights");

const _: () = {
    let (mut count, mut layer) = (0, 0);
    while layer + 1 < WIDTHS.len() {
        count += (WIDTHS[layer] + 1) * WIDTHS[layer + 1];
        layer += 1;
    }
    assert!(WEIGHTS.len() == 4 * count);
};

/// One linear layer.
#[derive(Debug)]
struct Layer {
    /// Outputs by inputs.
    weights: Mat<f32>,
    biases: Vec<f32>,
}

impl Layer {
    /// `W x` of each column `x`.
    fn multiply(&self, input: MatRef<f32>, output: &mut Mat<f32>) {
        matmul(output, Accum::Replace, &self.weights, input, 1.0, Par::Seq);
    }

    /// From `W x` to `max(W x + b, least)`.
    fn activate(&self, output: &mut Mat<f32>, least: f32) {
        for column in 0..output.ncols() {
            for (value, bias) in output.col_as_slice_mut(column).iter_mut().zip(&self.biases) {
                *value = (*value + bias).max(least);
            }
        }
    }
}

/// The layers of the embedded network.
#[derive(Debug)]
pub(super) struct ForwardPass(Box<[Layer; 5]>);

impl ForwardPass {
    pub(super) fn new() -> Self {
        let mut numbers = WEIGHTS.as_chunks::<4>().0.iter().map(|&bytes| f32::from_le_bytes(bytes));
        let mut take = |count| numbers.by_ref().take(count).collect::<Vec<f32>>();
        Self(Box::new(std::array::from_fn(|layer| {
            let (inputs, outputs) = (WIDTHS[layer], WIDTHS[layer + 1]);
            let weights = take(inputs * outputs);
            let weights = MatRef::from_column_major_slice(&weights, outputs, inputs).to_owned();
            Layer { weights, biases: take(outputs) }
        })))
    }

    /// Logits (even, odd, neither) of `k` eigenfunctions; `values` has [`POINTS`] rows of `k` numbers.
    pub(super) fn logits(&self, values: &[f64], k: usize) -> Vec<[f32; 3]> {
        let [first, second, third, fourth, fifth] = self.0.as_ref();
        let functions = canonical(MatRef::from_row_major_slice(values, POINTS, k));
        let mut input = functions.subcols(0, REFERENCES).to_owned();
        input.resize_with(POINTS, REFERENCES + 1, |_, _| 0.0);
        let [mut one, mut two, mut three] = [1, 2, 3].map(|layer| Mat::zeros(WIDTHS[layer], POINTS));
        let mut pooled = Mat::full(WIDTHS[3], k, f32::NEG_INFINITY);
        for function in 0..k {
            input.col_as_slice_mut(REFERENCES).copy_from_slice(functions.col_as_slice(function));
            first.multiply(input.transpose(), &mut one);
            first.activate(&mut one, 0.0);
            second.multiply(one.as_ref(), &mut two);
            second.activate(&mut two, 0.0);
            third.multiply(two.as_ref(), &mut three);
            keep_largest(pooled.col_as_slice_mut(function), &three);
        }
        third.activate(&mut pooled, 0.0);
        let (mut four, mut logits) = (Mat::zeros(WIDTHS[4], k), Mat::zeros(WIDTHS[5], k));
        fourth.multiply(pooled.as_ref(), &mut four);
        fourth.activate(&mut four, 0.0);
        fifth.multiply(four.as_ref(), &mut logits);
        fifth.activate(&mut logits, f32::NEG_INFINITY);
        logits.col_iter().map(|three| [three[0], three[1], three[2]]).collect()
    }
}

/// Each column in single precision, of root mean square 1, with the sign that makes the sum of its cubes
/// non-negative: the same numbers whatever its scale and sign were.
fn canonical(functions: MatRef<f64>) -> Mat<f32> {
    let factors: Vec<f64> = functions
        .col_iter()
        .map(|column| {
            let size = column.squared_norm_l2().sqrt() / (POINTS as f64).sqrt() + 1e-9;
            let cubes: f64 = column.iter().map(|value| value * value * value).sum();
            if cubes < 0.0 { -1.0 / size } else { 1.0 / size }
        })
        .collect();
    Mat::from_fn(POINTS, functions.ncols(), |point, j| (functions[(point, j)] * factors[j]) as f32)
}

/// The larger of each kept value and those of its row.
fn keep_largest(kept: &mut [f32], found: &Mat<f32>) {
    for point in 0..found.ncols() {
        for (kept, &found) in kept.iter_mut().zip(found.col_as_slice(point)) {
            *kept = if found > *kept { found } else { *kept };
        }
    }
}
