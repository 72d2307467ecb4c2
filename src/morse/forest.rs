//! Disjoint sets.

/// Disjoint sets in which the caller chooses the root; path halving.
pub(super) struct Forest(Vec<u32>);

impl Forest {
    /// Each of `0..len` in a set of its own.
    pub(super) fn new(len: usize) -> Self {
        Self((0..len as u32).collect())
    }

    /// The root of the set of `member`.
    pub(super) fn root(&mut self, mut member: u32) -> u32 {
        while self.0[member as usize] != member {
            let grandparent = self.0[self.0[member as usize] as usize];
            self.0[member as usize] = grandparent;
            member = grandparent;
        }
        member
    }

    /// Puts the set with root `root` under the root `elder`.
    pub(super) fn attach(&mut self, root: u32, elder: u32) {
        self.0[root as usize] = elder;
    }
}
