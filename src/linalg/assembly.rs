//! The tree of supernodes: who passes its update to whom, and into which places.

use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;

/// Stands for no parent.
pub(super) const NONE: u32 = u32::MAX;

/// The assembly tree of a factor whose columns are postordered, so that every subtree is a run of supernodes, of columns and
/// of stored values.
#[derive(Debug)]
pub(super) struct Assembly {
    /// First column of each supernode, and the number of columns.
    pub columns: Vec<u32>,
    row_starts: Vec<u32>,
    rows: Vec<u32>,
    /// Where the values of each supernode begin, and their number.
    pub values: Vec<usize>,
    /// The supernode that takes each one's update, or [`NONE`].
    pub parent: Vec<u32>,
    child_starts: Vec<u32>,
    children: Vec<u32>,
    /// For each row of a supernode its place among the columns and rows of the parent.
    relative: Vec<u32>,
    run_starts: Vec<u32>,
    /// Where runs of rows that are neighbours in the parent too begin, for each supernode, and the number of its rows.
    runs: Vec<u32>,
    /// Distance from the root, modulo two: siblings share a stack, and parents read from the other one.
    pub parity: Vec<u8>,
    /// Multiplications and additions of each supernode's elimination.
    pub flops: Vec<f64>,
}

impl Assembly {
    pub fn new(structure: &SymbolicSupernodalCholesky<u32>) -> Self {
        let count = structure.n_supernodes();
        let mut columns = structure.supernode_begin().to_vec();
        columns.push(structure.nrows() as u32);
        let row_starts = structure.col_ptr_for_row_idx().to_vec();
        let rows = structure.row_idx().to_vec();
        let mut owner = vec![0u32; structure.nrows()];
        for supernode in 0..count {
            owner[columns[supernode] as usize..columns[supernode + 1] as usize].fill(supernode as u32);
        }
        let mut values = vec![0];
        let mut parent = vec![NONE; count];
        let mut flops = vec![0.0; count];
        let mut child_starts = vec![0u32; count + 1];
        for supernode in 0..count {
            let below = &rows[row_starts[supernode] as usize..row_starts[supernode + 1] as usize];
            let width = (columns[supernode + 1] - columns[supernode]) as usize;
            let height = width + below.len();
            values.push(values[supernode] + height * width);
            flops[supernode] = (below.len()..height).map(|rows| (rows as f64 + 1.0).powi(2)).sum();
            if let Some(&first) = below.first() {
                parent[supernode] = owner[first as usize];
                child_starts[parent[supernode] as usize + 1] += 1;
            }
        }
        for supernode in 0..count {
            child_starts[supernode + 1] += child_starts[supernode];
        }
        let mut next = child_starts.clone();
        let mut children = vec![0; child_starts[count] as usize];
        for (child, &parent) in parent.iter().enumerate().filter(|&(_, &parent)| parent != NONE) {
            children[next[parent as usize] as usize] = child as u32;
            next[parent as usize] += 1;
        }
        let mut parity = vec![0u8; count];
        for supernode in (0..count).rev() {
            if parent[supernode] != NONE {
                parity[supernode] = 1 - parity[parent[supernode] as usize];
            }
        }
        let (relative, run_starts, runs) = (Vec::new(), vec![0], Vec::new());
        let mut assembly =
            Self { columns, row_starts, rows, values, parent, child_starts, children, relative, run_starts, runs, parity, flops };
        assembly.relative = assembly.places_in_parents();
        assembly.find_runs();
        assembly
    }

    fn find_runs(&mut self) {
        for supernode in 0..self.count() {
            let relative = &self.relative[self.row_starts[supernode] as usize..self.row_starts[supernode + 1] as usize];
            let breaks = (0..relative.len()).filter(|&place| place == 0 || relative[place] != relative[place - 1] + 1);
            self.runs.extend(breaks.map(|place| place as u32));
            self.runs.push(relative.len() as u32);
            self.run_starts.push(self.runs.len() as u32);
        }
    }

    /// Both lists rise, so one walk along the parent finds all places.
    fn places_in_parents(&self) -> Vec<u32> {
        let mut relative = vec![0; self.rows.len()];
        for supernode in 0..self.count() {
            let parent = self.parent[supernode];
            if parent == NONE {
                continue;
            }
            let parent = parent as usize;
            let (first, end) = (self.columns[parent], self.columns[parent + 1]);
            let above = self.rows(parent);
            let mut place = 0;
            let begin = self.row_starts[supernode] as usize;
            for (slot, &row) in relative[begin..].iter_mut().zip(self.rows(supernode)) {
                *slot = if row < end {
                    row - first
                } else {
                    while above[place] < row {
                        place += 1;
                    }
                    end - first + place as u32
                };
            }
        }
        relative
    }

    /// Number of supernodes.
    pub fn count(&self) -> usize {
        self.parent.len()
    }

    /// Number of columns of a supernode.
    pub fn width(&self, supernode: usize) -> usize {
        (self.columns[supernode + 1] - self.columns[supernode]) as usize
    }

    /// Number of rows below the diagonal block of a supernode: the size of its update matrix.
    pub fn reach(&self, supernode: usize) -> usize {
        (self.row_starts[supernode + 1] - self.row_starts[supernode]) as usize
    }

    /// Columns and rows of a supernode.
    pub fn height(&self, supernode: usize) -> usize {
        self.width(supernode) + self.reach(supernode)
    }

    /// The rows below the diagonal block, rising.
    pub fn rows(&self, supernode: usize) -> &[u32] {
        &self.rows[self.row_starts[supernode] as usize..self.row_starts[supernode + 1] as usize]
    }

    /// Place of each row among the columns and rows of the parent, rising.
    pub fn relative(&self, supernode: usize) -> &[u32] {
        &self.relative[self.row_starts[supernode] as usize..self.row_starts[supernode + 1] as usize]
    }

    /// Where runs of neighbours begin among the rows, and the number of rows.
    pub fn runs(&self, supernode: usize) -> &[u32] {
        &self.runs[self.run_starts[supernode] as usize..self.run_starts[supernode + 1] as usize]
    }

    /// The supernodes that pass their updates to this one, rising.
    pub fn children(&self, supernode: usize) -> &[u32] {
        &self.children[self.child_starts[supernode] as usize..self.child_starts[supernode + 1] as usize]
    }
}
