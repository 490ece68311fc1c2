//! Which of some rows gets which of some columns.

/// No column.
const NONE: usize = usize::MAX;

/// For each row a column of its own, so that the costs are least in all. There must be no fewer columns than rows, and finite costs.
///
/// Shortest augmenting paths (R. Jonker, A. Volgenant, "A shortest augmenting path algorithm for dense and sparse linear
/// assignment problems", 1987), without the reductions that they start with. O(rows^2 columns).
pub fn assignment(rows: usize, columns: usize, cost: impl Fn(usize, usize) -> f64) -> Vec<usize> {
    let (mut of_rows, mut of_columns) = (vec![0.0; rows], vec![0.0; columns]);
    let mut row_of = vec![NONE; columns];
    for start in 0..rows {
        // Lengths of paths to the columns, and the column before on each.
        let (mut lengths, mut before) = (vec![f64::INFINITY; columns], vec![NONE; columns]);
        let mut settled = vec![false; columns];
        let (mut last, mut row, mut length) = (NONE, start, 0.0);
        while row != NONE {
            let mut next = NONE;
            for column in (0..columns).filter(|&column| !settled[column]) {
                let other = length + cost(row, column) - of_rows[row] - of_columns[column];
                if other < lengths[column] {
                    (lengths[column], before[column]) = (other, last);
                }
                if next == NONE || lengths[column] < lengths[next] {
                    next = column;
                }
            }
            (last, row, length) = (next, row_of[next], lengths[next]);
            settled[last] = true;
        }
        of_rows[start] += length;
        for column in (0..columns).filter(|&column| settled[column] && column != last) {
            of_rows[row_of[column]] += length - lengths[column];
            of_columns[column] -= length - lengths[column];
        }
        while last != NONE {
            let previous = before[last];
            row_of[last] = if previous == NONE { start } else { row_of[previous] };
            last = previous;
        }
    }
    let mut found = vec![NONE; rows];
    for (column, &row) in row_of.iter().enumerate().filter(|(_, row)| **row != NONE) {
        found[row] = column;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The least cost of all ways to give the rows from `row` on columns that are not `taken`.
    fn least(costs: &[Vec<u8>], row: usize, taken: u32) -> u32 {
        let Some(of_row) = costs.get(row) else { return 0 };
        let free = (0..of_row.len()).filter(|column| taken & 1 << column == 0);
        free.map(|column| u32::from(of_row[column]) + least(costs, row + 1, taken | 1 << column))
            .min()
            .expect("a column is left")
    }

    proptest! {
        #[test]
        fn no_other_assignment_costs_less(
            costs in (0..6usize).prop_flat_map(|rows| {
                proptest::collection::vec(proptest::collection::vec(0..20u8, rows..rows + 1), rows..rows + 1)
            }),
            more in 0..3usize,
        ) {
            let wide: Vec<Vec<u8>> =
                costs.iter().map(|row| row.iter().copied().chain((0..more).map(|c| 3 * c as u8)).collect()).collect();
            let found = assignment(wide.len(), wide.len() + more, |row, column| f64::from(wide[row][column]));
            let taken = found.iter().fold(0, |taken, column| taken | 1u32 << column);
            prop_assert_eq!(taken.count_ones() as usize, wide.len());
            let cost: u32 = found.iter().zip(&wide).map(|(&column, row)| u32::from(row[column])).sum();
            prop_assert_eq!(cost, least(&wide, 0, 0));
        }
    }
}
