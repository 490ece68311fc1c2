//! How fast one thread of this machine multiplies matrices and moves memory: what floors are made from.

use criterion::{BenchmarkId, Criterion, Throughput};
use faer::linalg::matmul::matmul;
use faer::traits::ComplexField;
use faer::{Accum, Mat, Par};

/// A product as those of the pipeline: 12,500 x 150 by 150 x 150.
const ROWS: usize = 12_500;
const COLUMNS: usize = 150;
/// Bytes that a copy reads: far more than caches hold, and what the second-level cache holds twice.
const COPIES: [(&str, usize); 2] = [("memory", 256 << 20), ("cache", 256 << 10)];

/// Groups `product` (elements are floating-point operations) and `copy` (bytes are those read and written).
pub fn measure(criterion: &mut Criterion) {
    product::<f64>(criterion, "double");
    product::<f32>(criterion, "single");
    let mut group = criterion.benchmark_group("copy");
    for (name, bytes) in COPIES {
        let from = vec![1u64; bytes / 8];
        let mut to = vec![0u64; bytes / 8];
        group.throughput(Throughput::Bytes(2 * bytes as u64));
        group.bench_function(BenchmarkId::from_parameter(name), |bencher| {
            bencher.iter(|| std::hint::black_box(&mut to).copy_from_slice(std::hint::black_box(&from)));
        });
    }
}

fn product<T: ComplexField + From<u8>>(criterion: &mut Criterion, name: &str) {
    let filled = |rows| Mat::from_fn(rows, COLUMNS, |i, j| T::from(((i * 7 + j * 3) % 11) as u8));
    let (left, right) = (filled(ROWS), filled(COLUMNS));
    let mut out = Mat::<T>::zeros(ROWS, COLUMNS);
    let mut group = criterion.benchmark_group("product");
    group.throughput(Throughput::Elements(2 * (ROWS * COLUMNS * COLUMNS) as u64));
    group.bench_function(BenchmarkId::from_parameter(name), |bencher| {
        bencher.iter(|| {
            matmul(out.as_mut(), Accum::Replace, left.as_ref(), right.as_ref(), T::from(1), Par::Seq);
        });
    });
}
