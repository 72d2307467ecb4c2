//! A symmetric pattern and the structure of its factor.

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::sparse::linalg::SymbolicSupernodalParams;
use faer::sparse::linalg::cholesky::{simplicial, supernodal};
use faer::sparse::SymbolicSparseColMatRef;

use super::assembly::Assembly;
use super::ordering::postordered;
use super::tasks::{Places, Task, plan};
use super::{CsrMatrix, FactorError, Permutation};

/// Supernodes of up to so many columns are merged while their share of stored zeros stays below the second number.
///
/// The thresholds of faer (and of CHOLMOD); others were not measured.
const MERGE: [(usize, f64); 4] = [(4, 1.0), (16, 0.8), (48, 0.1), (usize::MAX, 0.05)];

/// A symmetric pattern and the structure of its Cholesky factor under a given order of elimination.
///
/// Values of matrices with this pattern live in a flat array of [`entries`](Self::entries) numbers, the lower triangle
/// of the permuted matrix; [`slot`](Self::slot) says where the entry (i, j) goes.
#[derive(Debug)]
pub struct SymbolicCholesky {
    order: Permutation,
    inverse: Vec<u32>,
    pub(super) starts: Vec<u32>,
    indices: Vec<u32>,
    pub(super) assembly: Assembly,
    pub(super) task: Task,
    pub(super) places: Places,
    /// Place in the factor of each entry.
    pub(super) targets: Vec<u32>,
    pub(super) widest: usize,
    factor_entries: usize,
    factor_flops: f64,
}

impl SymbolicCholesky {
    /// Analyses a pattern; always supernodal, which is five times faster than faer's own choice on planar meshes.
    ///
    /// # Arguments
    /// * `pattern`: `n x n`, symmetric, both triangles; values are not read; missing diagonal entries are added.
    /// * `order`: order of elimination of the `n` unknowns; it is postordered, which changes no fill.
    ///
    /// # Errors
    /// [`FactorError::NotSquare`], [`FactorError::NotAPermutation`] (wrong length), [`FactorError::Engine`].
    ///
    /// # Cost
    /// O(entries of the factor's structure).
    pub fn new(pattern: &CsrMatrix, order: Permutation) -> Result<Self, FactorError> {
        let n = pattern.rows();
        if n != pattern.columns() {
            return Err(FactorError::NotSquare { rows: n, columns: pattern.columns() });
        }
        if order.len() != n {
            return Err(FactorError::NotAPermutation { index: order.len(), size: n });
        }
        let order = postordered(pattern, order);
        let inverse = order.inverse();
        let (lower, upper) = triangles(pattern, order.order(), &inverse);
        let matrix = SymbolicSparseColMatRef::<u32>::new_checked(n, n, &upper.0, None, &upper.1);
        let mut tree = vec![0i32; n];
        let mut counts = vec![0u32; n];
        let scratch = StackReq::any_of(&[
            simplicial::prefactorize_symbolic_cholesky_scratch::<u32>(n, upper.1.len()),
            supernodal::factorize_supernodal_symbolic_cholesky_scratch::<u32>(n),
        ]);
        let mut memory = MemBuffer::new(scratch);
        let tree = simplicial::prefactorize_symbolic_cholesky(&mut tree, &mut counts, matrix, MemStack::new(&mut memory));
        let factor_entries = counts.iter().map(|&count| count as usize).sum();
        let factor_flops = counts.iter().map(|&count| f64::from(count) * f64::from(count)).sum();
        let structure = supernodal::factorize_supernodal_symbolic_cholesky(
            matrix,
            tree,
            &counts,
            MemStack::new(&mut memory),
            SymbolicSupernodalParams { relax: Some(&MERGE) },
        )
        .map_err(|error| FactorError::Engine { message: format!("analysis: {error:?}") })?;
        let assembly = Assembly::new(&structure);
        let (task, places) = plan(&assembly);
        let targets = targets(&assembly, &lower);
        let widest = (0..assembly.count()).map(|supernode| assembly.width(supernode)).max().unwrap_or(0);
        let (starts, indices) = lower;
        Ok(Self { order, inverse, starts, indices, assembly, task, places, targets, widest, factor_entries, factor_flops })
    }

    /// New position of each unknown.
    pub(super) fn inverse(&self) -> &[u32] {
        &self.inverse
    }

    /// Number of unknowns.
    pub fn size(&self) -> usize {
        self.inverse.len()
    }

    /// Number of values of a matrix with this pattern (one triangle with the diagonal).
    pub fn entries(&self) -> usize {
        self.indices.len()
    }

    /// Nonzeros of the factor, without the zeros that supernodes store.
    pub fn factor_entries(&self) -> usize {
        self.factor_entries
    }

    /// Numbers that the factor stores, with the zeros that supernodes store.
    pub fn stored_entries(&self) -> usize {
        self.assembly.values.last().copied().unwrap_or(0)
    }

    /// Multiplications and additions of one factorisation.
    pub fn factor_flops(&self) -> f64 {
        self.factor_flops
    }

    /// The order of elimination.
    pub fn order(&self) -> &Permutation {
        &self.order
    }

    /// Where the entry (`row`, `column`), or its mirror image, lives in an array of values.
    ///
    /// # Errors
    /// [`FactorError::OutsidePattern`] if the pattern has no such entry.
    pub fn slot(&self, row: usize, column: usize) -> Result<u32, FactorError> {
        let (a, b) = (self.inverse[row], self.inverse[column]);
        let (row_new, column_new) = (a.max(b), a.min(b) as usize);
        let begin = self.starts[column_new] as usize;
        let column_rows = &self.indices[begin..self.starts[column_new + 1] as usize];
        let position = column_rows.binary_search(&row_new).map_err(|_| FactorError::OutsidePattern { row, column })?;
        Ok((begin + position) as u32)
    }

    /// Whether (`row`, `column`) lies in the triangle that is stored, so that each pair of a full symmetric matrix counts once.
    pub fn is_stored(&self, row: usize, column: usize) -> bool {
        self.inverse[row] >= self.inverse[column]
    }
}

/// Multiplications and additions of a factorisation under an order of elimination.
pub(super) fn work(pattern: &CsrMatrix, order: &Permutation) -> f64 {
    let n = pattern.rows();
    let (_, upper) = triangles(pattern, order.order(), &order.inverse());
    let matrix = SymbolicSparseColMatRef::<u32>::new_checked(n, n, &upper.0, None, &upper.1);
    let (mut tree, mut counts) = (vec![0i32; n], vec![0u32; n]);
    let mut memory = MemBuffer::new(simplicial::prefactorize_symbolic_cholesky_scratch::<u32>(n, upper.1.len()));
    simplicial::prefactorize_symbolic_cholesky(&mut tree, &mut counts, matrix, MemStack::new(&mut memory));
    counts.iter().map(|&count| f64::from(count) * f64::from(count)).sum()
}

type Triangle = (Vec<u32>, Vec<u32>);

/// Lower and upper triangle of the permuted pattern by columns, rows rising, diagonal always present.
fn triangles(pattern: &CsrMatrix, order: &[u32], inverse: &[u32]) -> (Triangle, Triangle) {
    let n = order.len();
    let mut upper = (Vec::with_capacity(n + 1), Vec::with_capacity(pattern.entries() / 2 + n));
    upper.0.push(0);
    let mut lower_starts = vec![0u32; n + 1];
    for (new, &old) in order.iter().enumerate() {
        let begin = upper.1.len();
        let above = pattern.row(old as usize).0.iter().map(|&old| inverse[old as usize]);
        upper.1.extend(above.filter(|&other| (other as usize) < new));
        upper.1[begin..].sort_unstable();
        upper.1.push(new as u32);
        for &row in &upper.1[begin..] {
            lower_starts[row as usize + 1] += 1;
        }
        upper.0.push(upper.1.len() as u32);
    }
    for column in 0..n {
        lower_starts[column + 1] += lower_starts[column];
    }
    let mut next = lower_starts.clone();
    let mut lower_indices = vec![0; upper.1.len()];
    for new in 0..n {
        for &row in &upper.1[upper.0[new] as usize..upper.0[new + 1] as usize] {
            let slot = &mut next[row as usize];
            lower_indices[*slot as usize] = new as u32;
            *slot += 1;
        }
    }
    ((lower_starts, lower_indices), upper)
}

/// Where each entry of the matrix's lower triangle stands in the factor.
fn targets(assembly: &Assembly, (starts, indices): &Triangle) -> Vec<u32> {
    let mut targets = vec![0; indices.len()];
    for supernode in 0..assembly.count() {
        let (first, end) = (assembly.columns[supernode], assembly.columns[supernode + 1]);
        let rows = assembly.rows(supernode);
        for column in first..end {
            let base = assembly.values[supernode] + (column - first) as usize * assembly.height(supernode);
            let mut place = 0;
            for entry in starts[column as usize] as usize..starts[column as usize + 1] as usize {
                let row = indices[entry];
                let local = if row < end {
                    row - first
                } else {
                    while rows[place] < row {
                        place += 1;
                    }
                    end - first + place as u32
                };
                targets[entry] = (base + local as usize) as u32;
            }
        }
    }
    targets
}
