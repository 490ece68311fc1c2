//! Symmetric sparse matrices by rows.

/// A symmetric sparse matrix, both triangles stored by rows, columns ascending.
#[derive(Debug, Clone, Default)]
pub struct SymmetricSparse {
    /// Row `i` occupies `row_offsets[i]..row_offsets[i + 1]`.
    pub row_offsets: Vec<u32>,
    /// Column of each entry.
    pub columns: Vec<u32>,
    /// Value of each entry.
    pub values: Vec<f64>,
}

impl SymmetricSparse {
    /// Number of rows.
    pub fn size(&self) -> usize {
        self.row_offsets.len().saturating_sub(1)
    }

    /// The entries `(column, value)` of row `i`.
    pub fn row(&self, i: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let range = self.row_offsets[i] as usize..self.row_offsets[i + 1] as usize;
        range.map(|entry| (self.columns[entry] as usize, self.values[entry]))
    }

    /// The columns of row `i`: the vertex itself and its neighbours.
    pub fn neighbours(&self, i: usize) -> &[u32] {
        &self.columns[self.row_offsets[i] as usize..self.row_offsets[i + 1] as usize]
    }

    /// Values of the rows after some rounds in which each becomes the mean of those of its [`SymmetricSparse::neighbours`].
    pub fn averaged(&self, mut values: Vec<f64>, rounds: usize) -> Vec<f64> {
        for _ in 0..rounds {
            let mean = |i: usize| {
                let around = self.neighbours(i);
                around.iter().map(|&next| values[next as usize]).sum::<f64>() / around.len() as f64
            };
            values = (0..values.len()).map(mean).collect();
        }
        values
    }
}
