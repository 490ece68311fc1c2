//! Parity of the first eigenfunctions without a network: a beam search over their images.
//!
//! Under a reflection every eigenfunction with a simple eigenvalue is even (+1) or odd (-1)
//! (M. Ovsjanikov, J. Sun, L. Guibas, "Global Intrinsic Symmetries of Shapes", 2008). Where two
//! eigenvalues nearly coincide, noise mixes their functions, and the reflection acts on the pair by
//! any 2 x 2 reflection; a few angles of it are tried beside the four sign pairs. A start (a block
//! diagonal matrix S) is judged by how near the transformed embedding comes to the embedding itself:
//! `mean over x of min over y |phi(x) S - phi(y)|^2`, which is extended one block at a time.

use crate::spectral::sampling::Samples;
use faer::Mat;
use pulp::{Arch, Simd, WithSimd};

/// Samples, at most, whose images are sought among each other.
const SAMPLES: usize = 420;
/// Eigenvalues closer than this ratio are taken as a pair, or three, that may mix.
const NEAR_RATIO: f64 = 1.2;

/// Directions tried for their reflections: no direction is farther from one of them, or from its opposite, than some 15
/// degrees.
const DIRECTIONS: usize = 64;

/// How one block of eigenfunctions is transformed: 1 x 1 or 2 x 2, row by row.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Block {
    Single(f32),
    Pair([[f32; 2]; 2]),
}

struct Beam {
    blocks: Vec<Block>,
    /// Samples x samples: squared distances so far, of images from all.
    distances: Vec<f32>,
}

/// Columns of a block, and how they are transformed.
struct Step<'a> {
    columns: &'a [Vec<f32>],
    block: Block,
}

/// The best starts at each length of `lengths` (ascending), best first, `width` of each.
///
/// A start may be one longer than asked for, where a mixed pair straddles the length.
/// Cost: O(width x longest x SAMPLES^2).
pub fn search(samples: &Samples, eigenvalues: &[f64], lengths: &[usize], width: usize) -> Vec<Vec<Mat<f64>>> {
    let longest = lengths.last().copied().unwrap_or(0).min(samples.rows.ncols());
    let count = samples.count().min(SAMPLES);
    let mut beams = vec![Beam { blocks: Vec::new(), distances: vec![0.0; count * count] }];
    let mut found = Vec::new();
    let mut index = 0;
    while index < longest {
        let size = if is_pair(&eigenvalues[index..samples.rows.ncols()]) { 2 } else { 1 };
        let columns: Vec<Vec<f32>> = (index..index + size)
            .map(|j| (0..count).map(|i| samples.rows[(i, j)] as f32).collect())
            .collect();
        beams = extend_all(&beams, &columns, &block_options(size), width);
        for _ in lengths.iter().filter(|length| index < **length && **length <= index + size) {
            found.push(beams.iter().map(|beam| matrix(&beam.blocks)).collect());
        }
        index += size;
    }
    found
}

/// Whether the first two of these functions form a block.
fn is_pair(eigenvalues: &[f64]) -> bool {
    matches!(eigenvalues, [first, second, ..] if *second < NEAR_RATIO * first)
}

/// Reflections in planes of all directions, and half turns about them, of the three lowest eigenfunctions, if their eigenvalues
/// nearly coincide, as those of the regular solids do; else none.
pub fn involutions_of_three(eigenvalues: &[f64]) -> Vec<Mat<f64>> {
    let is_triple = matches!(eigenvalues, [first, _, third, ..] if *third < NEAR_RATIO * first);
    // A spiral of equal areas down the hemisphere; the golden angle keeps its turns apart.
    let golden = std::f64::consts::PI * (3.0 - 5f64.sqrt());
    let direction = |index: usize| {
        let height = 1.0 - (index as f64 + 0.5) / DIRECTIONS as f64;
        let (sine, cosine) = (golden * index as f64).sin_cos();
        let radius = (1.0 - height * height).sqrt();
        [radius * cosine, radius * sine, height]
    };
    let householder = |n: [f64; 3], sign: f64| {
        Mat::from_fn(3, 3, |i, j| sign * (if i == j { 1.0 } else { 0.0 } - 2.0 * n[i] * n[j]))
    };
    let directions = (0..if is_triple { DIRECTIONS } else { 0 }).map(direction);
    directions.flat_map(|n| [householder(n, 1.0), householder(n, -1.0)]).collect()
}

fn extend_all(beams: &[Beam], columns: &[Vec<f32>], options: &[Block], width: usize) -> Vec<Beam> {
    let mut ranked: Vec<(f32, usize, Block)> = Vec::with_capacity(options.len() * beams.len());
    // Energies of the best `width` so far, ascending: what exceeds them all need not be known exactly.
    let mut best = Vec::with_capacity(width + 1);
    for (parent, beam) in beams.iter().enumerate() {
        for &block in options {
            let bound = if best.len() < width { f32::MAX } else { best[width - 1] };
            let energy = extended_energy(beam, &Step { columns, block }, bound);
            best.insert(best.partition_point(|other| *other <= energy), energy);
            best.truncate(width);
            ranked.push((energy, parent, block));
        }
    }
    ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
    ranked.truncate(width);
    let extend_one =
        |&(_, parent, block): &(f32, usize, Block)| extend(&beams[parent], &Step { columns, block });
    ranked.iter().map(extend_one).collect()
}

fn block_options(size: usize) -> Vec<Block> {
    if size == 1 {
        return vec![Block::Single(1.0), Block::Single(-1.0)];
    }
    // Two of these angles are those of sign pairs; the others are for a pair that is mixed.
    let reflection = |eighth: u8| {
        let (sine, cosine) = (45.0 * f64::from(eighth)).to_radians().sin_cos();
        Block::Pair([[cosine as f32, sine as f32], [sine as f32, -cosine as f32]])
    };
    let same = [1.0, -1.0].map(|sign| Block::Pair([[sign, 0.0], [0.0, sign]]));
    same.into_iter().chain([0, 4, 1, 2, 3, 5, 6, 7].map(reflection)).collect()
}

fn matrix(blocks: &[Block]) -> Mat<f64> {
    let size = |block: &Block| if matches!(block, Block::Single(_)) { 1 } else { 2 };
    let total = blocks.iter().map(size).sum();
    let mut out = Mat::zeros(total, total);
    let mut at = 0;
    for block in blocks {
        match block {
            Block::Single(sign) => out[(at, at)] = f64::from(*sign),
            Block::Pair(rows) => {
                for (i, row) in rows.iter().enumerate() {
                    for (j, value) in row.iter().enumerate() {
                        out[(at + i, at + j)] = f64::from(*value);
                    }
                }
            }
        }
        at += size(block);
    }
    out
}

impl Step<'_> {
    /// The block's coordinates of the image of `source`.
    #[inline(always)]
    fn image(&self, source: usize) -> [f32; 2] {
        match self.block {
            Block::Single(sign) => [sign * self.columns[0][source], 0.0],
            Block::Pair([[a, b], [c, d]]) => {
                let (x, y) = (self.columns[0][source], self.columns[1][source]);
                [x * a + y * c, x * b + y * d]
            }
        }
    }
}

/// The mean over the samples of the smallest extended distance; infinite if it is above `bound`.
fn extended_energy(beam: &Beam, step: &Step, bound: f32) -> f32 {
    Arch::new().dispatch(ExtendedEnergy { beam, step, bound })
}

/// [`extended_energy`] as an operation that is compiled for each instruction set and chosen at run time.
struct ExtendedEnergy<'a> {
    beam: &'a Beam,
    step: &'a Step<'a>,
    bound: f32,
}

impl WithSimd for ExtendedEnergy<'_> {
    type Output = f32;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> f32 {
        let count = self.step.columns[0].len();
        let mut total = 0.0;
        for (source, row) in self.beam.distances.chunks_exact(count).enumerate() {
            let image = self.step.image(source);
            total += match self.step.columns {
                [single] => smallest(row, [single], [image[0]]),
                [first, second] => smallest(row, [first, second], image),
                _ => unreachable!("a block has one or two columns"),
            };
            // Sums only grow, so the rounded mean does too.
            if total / count as f32 > self.bound {
                return f32::INFINITY;
            }
        }
        total / count as f32
    }
}

/// `min over y of row[y] + |image - columns[y]|^2`, in lanes that the compiler vectorises.
#[inline(always)]
fn smallest<const N: usize>(row: &[f32], columns: [&[f32]; N], image: [f32; N]) -> f32 {
    const LANES: usize = 16;
    let extended = |distance: f32, entry: [f32; N]| {
        (0..N).fold(distance, |sum, k| sum + (image[k] - entry[k]) * (image[k] - entry[k]))
    };
    let mut lanes = [f32::MAX; LANES];
    let (chunks, rest) = row.as_chunks::<LANES>();
    for (index, distances) in chunks.iter().enumerate() {
        let entries = columns.map(|column| &column.as_chunks::<LANES>().0[index]);
        for lane in 0..LANES {
            let candidate = extended(distances[lane], entries.map(|entries| entries[lane]));
            lanes[lane] = if candidate < lanes[lane] { candidate } else { lanes[lane] };
        }
    }
    let first = row.len() - rest.len();
    let rest =
        rest.iter().enumerate().map(|(i, distance)| extended(*distance, columns.map(|c| c[first + i])));
    lanes.into_iter().chain(rest).fold(f32::MAX, f32::min)
}

fn extend(beam: &Beam, step: &Step) -> Beam {
    let mut distances = beam.distances.clone();
    for (source, row) in distances.chunks_exact_mut(step.columns[0].len()).enumerate() {
        let image = step.image(source);
        for (column, value) in step.columns.iter().zip(image) {
            for (distance, entry) in row.iter_mut().zip(column) {
                *distance += (value - entry) * (value - entry);
            }
        }
    }
    let mut blocks = beam.blocks.clone();
    blocks.push(step.block);
    Beam { blocks, distances }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn involutions_of_a_triple_are_their_own_inverses() {
        let found = involutions_of_three(&[1.0, 1.0, 1.0]);
        assert_eq!(found.len(), 2 * DIRECTIONS);
        for (matrix, trace) in found.iter().zip([1.0, -1.0].into_iter().cycle()) {
            assert!((matrix * matrix - Mat::<f64>::identity(3, 3)).norm_max() < 1e-12);
            assert!(((0..3).map(|i| matrix[(i, i)]).sum::<f64>() - trace).abs() < 1e-12);
        }
        assert!(involutions_of_three(&[1.0, 1.0, 2.0 * NEAR_RATIO]).is_empty());
    }
}
