//! How many votes each pair of points has.

/// The votes of pairs, listed by the lower point of each.
#[derive(Clone)]
pub(super) struct Votes {
    /// Per lower point the higher ones that have votes with it, and these.
    with: Vec<Vec<(u32, i32)>>,
    /// The lower points that have a list.
    listed: Vec<u32>,
}

impl Votes {
    /// For pairs of `count` points; none has votes yet.
    pub fn new(count: usize) -> Votes {
        Votes { with: vec![Vec::new(); count], listed: Vec::new() }
    }

    /// Adds `votes` to those of a pair, which may be new; the sum.
    pub fn add(&mut self, low: u32, high: u32, votes: i32) -> i32 {
        let list = &mut self.with[low as usize];
        if let Some((_, sum)) = list.iter_mut().find(|(other, _)| *other == high) {
            *sum += votes;
            return *sum;
        }
        if list.is_empty() {
            self.listed.push(low);
        }
        list.push((high, votes));
        votes
    }

    /// The votes of a pair.
    pub fn of(&self, low: u32, high: u32) -> i32 {
        self.with(low).find(|&(other, _)| other == high).map_or(0, |(_, votes)| votes)
    }

    /// The higher points that have votes with a lower one, and these.
    pub fn with(&self, low: u32) -> impl Iterator<Item = (u32, i32)> {
        self.with[low as usize].iter().copied()
    }

    /// Takes back all votes. O(pairs that have some).
    pub fn clear(&mut self) {
        self.listed.drain(..).for_each(|low| self.with[low as usize].clear());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn votes_of_a_pair_add_up_until_they_are_cleared() {
        let mut votes = Votes::new(4);
        assert_eq!(
            [(0, 2, 5), (0, 3, 7), (1, 3, 1), (0, 2, 6)].map(|(a, b, n)| votes.add(a, b, n)),
            [5, 7, 1, 11]
        );
        assert_eq!(votes.with(0).collect::<Vec<_>>(), [(2, 11), (3, 7)]);
        assert_eq!([votes.of(0, 2), votes.of(1, 3), votes.of(2, 3)], [11, 1, 0]);
        votes.clear();
        assert_eq!((votes.of(0, 2), votes.with(1).count()), (0, 0));
        assert_eq!(votes.add(0, 2, 3), 3);
    }
}
