//! How many votes each pair of points has.

use crate::mesh::NONE;

/// The votes of pairs, listed by the lower point of each: 4 bytes a point, and 16 for each pair that has votes.
#[derive(Clone)]
pub(super) struct Votes {
    /// Per lower point the entry of its list that is newest, or [`NONE`].
    newest: Vec<u32>,
    entries: Vec<Entry>,
}

#[derive(Clone)]
struct Entry {
    low: u32,
    high: u32,
    votes: i32,
    /// The entry before this one in the list of the lower point, or [`NONE`].
    before: u32,
}

impl Votes {
    /// For pairs of `count` points; none has votes yet.
    pub fn new(count: usize) -> Votes {
        Votes { newest: vec![NONE; count], entries: Vec::new() }
    }

    /// Adds `votes` to those of a pair, which may be new; the sum.
    pub fn add(&mut self, low: u32, high: u32, votes: i32) -> i32 {
        let mut at = self.newest[low as usize];
        while at != NONE {
            let entry = &mut self.entries[at as usize];
            if entry.high == high {
                entry.votes += votes;
                return entry.votes;
            }
            at = entry.before;
        }
        let before = std::mem::replace(&mut self.newest[low as usize], self.entries.len() as u32);
        self.entries.push(Entry { low, high, votes, before });
        votes
    }

    /// The votes of a pair.
    pub fn of(&self, low: u32, high: u32) -> i32 {
        self.with(low).find(|&(other, _)| other == high).map_or(0, |(_, votes)| votes)
    }

    /// The higher points that have votes with a lower one, and these.
    pub fn with(&self, low: u32) -> impl Iterator<Item = (u32, i32)> {
        let entry = |at: u32| self.entries.get(at as usize);
        let list = std::iter::successors(entry(self.newest[low as usize]), move |now| entry(now.before));
        list.map(|entry| (entry.high, entry.votes))
    }

    /// Takes back all votes. O(pairs that have some).
    pub fn clear(&mut self) {
        for entry in self.entries.drain(..) {
            self.newest[entry.low as usize] = NONE;
        }
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
        assert_eq!(votes.with(0).collect::<Vec<_>>(), [(3, 7), (2, 11)]);
        assert_eq!([votes.of(0, 2), votes.of(1, 3), votes.of(2, 3)], [11, 1, 0]);
        votes.clear();
        assert_eq!((votes.of(0, 2), votes.with(1).count()), (0, 0));
        assert_eq!(votes.add(0, 2, 3), 3);
    }
}
