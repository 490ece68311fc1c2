//! What a person says of a shell's eigenfunctions, as it holds for those of its proxy.
//!
//! Simplified, a shell nearly keeps its eigenfunctions, but those whose eigenvalues nearly coincide may change places or mix.

use crate::base::error::Result;
use crate::base::progress::Progress;
use crate::detect::proxy::Proxy;
use crate::mesh::Shell;
use crate::spectral::dense::product;
use crate::spectral::eigenbasis::Eigenbasis;
use crate::spectral::laplacian::IntrinsicSurface;
use faer::{Mat, MatRef};

/// A function of the proxy is even if this much more of its square is on even functions of the shell than on odd ones.
const CLEAR: f64 = 0.8;

/// Signs of the proxy's first eigenfunctions, from those `known` of the shell's: 1 even, -1 odd, 0 unknown.
///
/// `surface` and `basis` are the proxy's. A function that is a mixture of what is known and what is not, or of even and odd, is
/// unknown. Computes as many eigenfunctions of the shell as there are known signs, by [`Eigenbasis::exact`]: one sparse factorisation.
///
/// # Errors
/// [`crate::Error::Cancelled`], [`crate::Error::Internal`].
pub fn on_proxy(
    shell: &Shell,
    proxy: &Proxy,
    surface: &IntrinsicSurface,
    basis: &Eigenbasis,
    known: &[i8],
    progress: &Progress,
) -> Result<Vec<i8>> {
    let own = IntrinsicSurface::new(shell);
    let own = Eigenbasis::exact(&own, known.len(), progress)?;
    let own = own.at(proxy.vertices(), known.len()).eigenfunctions;
    let mass = &surface.lumped_mass;
    let lengths: Vec<f64> = own
        .col_iter()
        .map(|function| {
            function.iter().zip(mass).map(|(value, mass)| mass * value * value).sum::<f64>().sqrt()
        })
        .collect();
    let weighted = Mat::from_fn(own.nrows(), own.ncols(), |i, j| mass[i] * own[(i, j)] / lengths[j]);
    let likeness = product(basis.eigenfunctions.transpose(), weighted.as_ref());
    let mut signs = parities(likeness.as_ref(), known);
    signs.truncate(signs.iter().rposition(|sign| *sign != 0).map_or(0, |last| last + 1));
    Ok(signs)
}

/// Row i of `likeness` has the cosines of function i with those whose signs are known.
fn parities(likeness: MatRef<f64>, known: &[i8]) -> Vec<i8> {
    let parity = |row: usize| {
        let signs = known.iter().zip(likeness.row(row).iter());
        let sum: f64 = signs.map(|(&sign, cosine)| f64::from(sign) * cosine * cosine).sum();
        if sum.abs() > CLEAR { sum.signum() as i8 } else { 0 }
    };
    (0..likeness.nrows()).map(parity).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signs_follow_functions_that_change_places_and_mixtures_of_one_sign() {
        let r = 0.5f64.sqrt();
        // The first two change places, the next two mix, and so do the last two, which are not of one sign.
        let likeness = faer::mat![
            [0.0, 0.99, 0.0, 0.0, 0.0, 0.0],
            [-0.99, 0.0, 0.0, 0.0, 0.0, 0.0],
            [0.0, 0.0, r, -r, 0.0, 0.0],
            [0.0, 0.0, r, r, 0.0, 0.0],
            [0.0, 0.0, 0.0, 0.0, r, r],
            [0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        ];
        assert_eq!(parities(likeness.as_ref(), &[1, -1, -1, -1, 1, -1]), [-1, 1, -1, -1, 0, 0]);
        assert_eq!(parities(likeness.as_ref(), &[1, -1, -1, -1, 1, 1])[4], 1);
        assert_eq!(parities(likeness.as_ref(), &[0, -1, -1, 0, 1, 0])[..5], [-1, 0, 0, 0, 0]);
    }
}
