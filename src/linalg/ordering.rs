//! Orders of elimination that keep a sparse Cholesky factor sparse.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::amd;

use super::dissection::Part;
use super::pattern::work;
use super::{CsrMatrix, FactorError, Permutation};

/// Smaller patterns gain nothing from dissection. In the plane it is even with minimum degree at 15,000 unknowns; in solids it fills a third less
/// at 3,500 vertices, and 40 % less at 12,000 (measured).
const SMALL: usize = 3_000;

/// Above this size dissection is taken unseen; below, folded surfaces may be better off with minimum degree, and both are tried.
const LARGE: usize = 150_000;

/// The order to use for a symmetric pattern: minimum degree for small patterns and where there are no coordinates, nested dissection for
/// large ones, whichever needs less work in between.
///
/// Neighbouring unknowns with equal rows (the components of a vector at a vertex) are ordered as one.
///
/// # Arguments
/// * `pattern`: `n x n`, symmetric; values are not read.
/// * `coordinates`: the place of each unknown, any unit, where there is one.
///
/// # Errors
/// [`FactorError`] where the pattern is not square or the lengths differ.
pub fn fill_reducing_order(pattern: &CsrMatrix, coordinates: Option<&[[f64; 3]]>) -> Result<Permutation, FactorError> {
    check_square(pattern)?;
    check_count(pattern, coordinates)?;
    let groups = Groups::of(pattern);
    let (starts, indices) = groups.graph(pattern);
    let whole = |order: Vec<u32>| postordered(pattern, Permutation::from_parts(groups.expanded(&order)));
    let by_degree = || approximate_minimum_degree(groups.count(), &starts, &indices).map(whole);
    match coordinates {
        Some(places) if groups.count() >= LARGE => Ok(whole(dissected(&starts, &indices, &groups.places(places))?)),
        Some(places) if groups.count() >= SMALL => {
            let both = rayon::join(|| dissected(&starts, &indices, &groups.places(places)).map(whole), by_degree);
            let (by_place, by_degree) = (both.0?, both.1?);
            let (place, degree) = rayon::join(|| work(pattern, &by_place), || work(pattern, &by_degree));
            Ok(if place <= degree { by_place } else { by_degree })
        }
        _ => by_degree(),
    }
}

/// Runs of consecutive unknowns whose rows are the same.
struct Groups {
    starts: Vec<u32>,
    of: Vec<u32>,
}

impl Groups {
    fn of(pattern: &CsrMatrix) -> Self {
        let mut groups = Self { starts: Vec::new(), of: Vec::with_capacity(pattern.rows()) };
        for row in 0..pattern.rows() {
            if row == 0 || pattern.row(row).0 != pattern.row(row - 1).0 || pattern.row(row).0.is_empty() {
                groups.starts.push(row as u32);
            }
            groups.of.push(groups.starts.len() as u32 - 1);
        }
        groups.starts.push(pattern.rows() as u32);
        groups
    }

    fn count(&self) -> usize {
        self.starts.len() - 1
    }

    /// The pattern between groups, as the first row of each has it.
    fn graph(&self, pattern: &CsrMatrix) -> (Vec<u32>, Vec<u32>) {
        let mut starts = Vec::with_capacity(self.starts.len());
        let mut indices = Vec::new();
        starts.push(0);
        for &row in &self.starts[..self.count()] {
            let begin = indices.len();
            // Columns rise, and so do their groups.
            for &column in pattern.row(row as usize).0 {
                let group = self.of[column as usize];
                if indices.len() == begin || indices.last() != Some(&group) {
                    indices.push(group);
                }
            }
            starts.push(indices.len() as u32);
        }
        (starts, indices)
    }

    fn places(&self, places: &[[f64; 3]]) -> Vec<[f64; 3]> {
        self.starts[..self.count()].iter().map(|&row| places[row as usize]).collect()
    }

    fn expanded(&self, order: &[u32]) -> Vec<u32> {
        order.iter().flat_map(|&group| self.starts[group as usize]..self.starts[group as usize + 1]).collect()
    }
}

/// Approximate minimum degree of a symmetric pattern, followed by a postorder of the elimination tree.
///
/// # Errors
/// [`FactorError::NotSquare`]; [`FactorError::Engine`] where memory runs out.
///
/// # Source
/// Amestoy, Davis, Duff 1996, through `faer`.
pub fn minimum_degree(pattern: &CsrMatrix) -> Result<Permutation, FactorError> {
    check_square(pattern)?;
    let n = pattern.rows();
    let (starts, indices) = pattern_arrays(pattern);
    let order = approximate_minimum_degree(n, &starts, &indices)?;
    Ok(postordered(pattern, Permutation::from_parts(order)))
}

/// Nested dissection along the coordinates, followed by a postorder of the elimination tree.
///
/// Each part is cut where the layer that must be removed is thinnest, near the middle of one of its longer axes or of the
/// distances within the part (which cut folded surfaces better than any plane); the separator is the smallest set of vertices that
/// meets every edge of `pattern` across the cut, and is eliminated after both sides. Parts of at most 200 unknowns are left to minimum
/// degree. Halves run side by side.
///
/// # Arguments
/// * `pattern`: `n x n`, symmetric; values are not read.
/// * `coordinates`: `n` places, any unit. Equal places are allowed; ties are cut by index.
///
/// # Errors
/// [`FactorError::NotSquare`], [`FactorError::CoordinateCount`], [`FactorError::Engine`].
///
/// # Cost
/// O(n log n + entries x depth) time, O(entries) extra memory.
///
/// # Source
/// George 1973; Pothen and Fan 1990 (separators from matchings).
pub fn nested_dissection(pattern: &CsrMatrix, coordinates: &[[f64; 3]]) -> Result<Permutation, FactorError> {
    check_square(pattern)?;
    check_count(pattern, Some(coordinates))?;
    let (starts, indices) = pattern_arrays(pattern);
    let order = dissected(&starts, &indices, coordinates)?;
    Ok(postordered(pattern, Permutation::from_parts(order)))
}

fn dissected(starts: &[u32], indices: &[u32], places: &[[f64; 3]]) -> Result<Vec<u32>, FactorError> {
    Part::whole(starts, indices, places).dissect(places)
}

fn check_count(pattern: &CsrMatrix, coordinates: Option<&[[f64; 3]]>) -> Result<(), FactorError> {
    match coordinates {
        Some(places) if places.len() != pattern.rows() => {
            Err(FactorError::CoordinateCount { expected: pattern.rows(), found: places.len() })
        }
        _ => Ok(()),
    }
}

fn check_square(pattern: &CsrMatrix) -> Result<(), FactorError> {
    if pattern.rows() == pattern.columns() {
        Ok(())
    } else {
        Err(FactorError::NotSquare { rows: pattern.rows(), columns: pattern.columns() })
    }
}

fn pattern_arrays(pattern: &CsrMatrix) -> (Vec<u32>, Vec<u32>) {
    let mut starts = Vec::with_capacity(pattern.rows() + 1);
    let mut indices = Vec::with_capacity(pattern.entries());
    starts.push(0);
    for row in 0..pattern.rows() {
        indices.extend_from_slice(pattern.row(row).0);
        starts.push(indices.len() as u32);
    }
    (starts, indices)
}

/// faer's order of a symmetric pattern given by both triangles.
pub(super) fn approximate_minimum_degree(n: usize, starts: &[u32], indices: &[u32]) -> Result<Vec<u32>, FactorError> {
    if n == 0 {
        return Ok(Vec::new());
    }
    let matrix = SymbolicSparseColMatRef::<u32>::new_checked(n, n, starts, None, indices);
    let mut order = vec![0u32; n];
    let mut inverse = vec![0u32; n];
    let mut memory = MemBuffer::new(amd::order_scratch::<u32>(n, indices.len()));
    amd::order(&mut order, &mut inverse, matrix, amd::Control::default(), MemStack::new(&mut memory))
        .map_err(|error| FactorError::Engine { message: format!("minimum degree: {error:?}") })?;
    Ok(order)
}

/// Reorders so that every subtree of the elimination tree is contiguous: same fill, longer supernodes.
pub(super) fn postordered(pattern: &CsrMatrix, permutation: Permutation) -> Permutation {
    let n = permutation.len();
    let inverse = permutation.inverse();
    let parent = elimination_tree(pattern, permutation.order(), &inverse);
    const NONE: u32 = u32::MAX;
    let mut first_child = vec![NONE; n];
    let mut next_sibling = vec![NONE; n];
    let mut roots = Vec::new();
    for node in (0..n).rev() {
        match parent[node] {
            NONE => roots.push(node as u32),
            up => {
                next_sibling[node] = first_child[up as usize];
                first_child[up as usize] = node as u32;
            }
        }
    }
    let mut visited = Vec::with_capacity(n);
    let mut stack = Vec::new();
    for &root in roots.iter().rev() {
        stack.push(root);
        while let Some(&node) = stack.last() {
            let child = first_child[node as usize];
            if child == NONE {
                visited.push(permutation.order()[node as usize]);
                stack.pop();
            } else {
                first_child[node as usize] = next_sibling[child as usize];
                stack.push(child);
            }
        }
    }
    Permutation::from_parts(visited)
}

/// Parent of each column in the elimination tree of the permuted pattern, `u32::MAX` for a root (Liu 1990).
fn elimination_tree(pattern: &CsrMatrix, order: &[u32], inverse: &[u32]) -> Vec<u32> {
    let n = order.len();
    let mut parent = vec![u32::MAX; n];
    let mut ancestor = vec![u32::MAX; n];
    for column in 0..n as u32 {
        for &old in pattern.row(order[column as usize] as usize).0 {
            let mut node = inverse[old as usize];
            while node < column {
                let next = std::mem::replace(&mut ancestor[node as usize], column);
                if next == u32::MAX {
                    parent[node as usize] = column;
                    break;
                }
                node = next;
            }
        }
    }
    parent
}
