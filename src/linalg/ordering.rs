//! Orders of elimination that keep a sparse Cholesky factor sparse.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::amd;

use super::{CsrMatrix, FactorError, Permutation};

/// Largest part that nested dissection leaves to minimum degree. Smaller leaves cut more separators than they save,
/// larger ones grow the fill of minimum degree; between 100 and 300 nothing moves by more than a few percent.
const LEAF: usize = 200;

/// Problems below this size gain nothing from dissection (measured: equal work at 15,000, half of it at 250,000).
const SMALL: usize = 20_000;

/// The order to use for a symmetric pattern: nested dissection for large patterns with coordinates, else minimum degree.
///
/// # Arguments
/// * `pattern`: `n x n`, symmetric; values are not read.
/// * `coordinates`: the place of each unknown, any unit, where there is one.
///
/// # Errors
/// [`FactorError`] where the pattern is not square or the lengths differ.
pub fn fill_reducing_order(pattern: &CsrMatrix, coordinates: Option<&[[f64; 3]]>) -> Result<Permutation, FactorError> {
    match coordinates {
        Some(places) if pattern.rows() >= SMALL => nested_dissection(pattern, places),
        _ => minimum_degree(pattern),
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
/// Each part is cut at the median of its longest axis; the separator is the layer of the smaller side that touches
/// the other one in `pattern` (so it is wide enough for any stencil), and is eliminated after both sides. Parts
/// of at most 200 unknowns are left to minimum degree.
///
/// # Arguments
/// * `pattern`: `n x n`, symmetric; values are not read.
/// * `coordinates`: `n` places, any unit. Equal places are allowed; ties are cut by index.
///
/// # Errors
/// [`FactorError::NotSquare`], [`FactorError::CoordinateCount`], [`FactorError::Engine`].
///
/// # Cost
/// O(n log n + entries x depth) time, O(n) extra memory.
///
/// # Source
/// George 1973; measured against METIS in planar meshes: the same work from 250,000 unknowns on, a seventh of the time to find it.
pub fn nested_dissection(pattern: &CsrMatrix, coordinates: &[[f64; 3]]) -> Result<Permutation, FactorError> {
    check_square(pattern)?;
    let n = pattern.rows();
    if coordinates.len() != n {
        return Err(FactorError::CoordinateCount { expected: n, found: coordinates.len() });
    }
    let mut dissection = Dissection { pattern, coordinates, side: vec![0; n], local: vec![0; n], order: Vec::with_capacity(n) };
    let mut all: Vec<u32> = (0..n as u32).collect();
    dissection.part(&mut all)?;
    let order = dissection.order;
    Ok(postordered(pattern, Permutation::from_parts(order)))
}

/// The state of a dissection: where the current part's unknowns stand, and what has been ordered so far.
struct Dissection<'a> {
    pattern: &'a CsrMatrix,
    coordinates: &'a [[f64; 3]],
    /// 0: outside the current part, 1: first side, 2: second side, 3: separator.
    side: Vec<u8>,
    /// Position within a leaf.
    local: Vec<u32>,
    order: Vec<u32>,
}

impl Dissection<'_> {
    fn part(&mut self, part: &mut [u32]) -> Result<(), FactorError> {
        if part.len() <= LEAF {
            return self.leaf(part);
        }
        let axis = self.longest_axis(part);
        let key = |&vertex: &u32| (self.coordinates[vertex as usize][axis], vertex);
        let middle = part.len() / 2;
        part.select_nth_unstable_by(middle, |a, b| {
            let ((x, i), (y, j)) = (key(a), key(b));
            x.total_cmp(&y).then(i.cmp(&j))
        });
        for (position, &vertex) in part.iter().enumerate() {
            self.side[vertex as usize] = if position < middle { 1 } else { 2 };
        }
        let touching = |from: u8, to: u8| -> Vec<u32> {
            let touches = |vertex: &u32| self.pattern.row(*vertex as usize).0.iter().any(|&other| self.side[other as usize] == to);
            part.iter().copied().filter(|&vertex| self.side[vertex as usize] == from && touches(&vertex)).collect()
        };
        let (first, second) = (touching(1, 2), touching(2, 1));
        let mut separator = if first.len() <= second.len() { first } else { second };
        for &vertex in &separator {
            self.side[vertex as usize] = 3;
        }
        let mut sides = [Vec::with_capacity(middle), Vec::with_capacity(part.len() - middle)];
        for &vertex in part.iter() {
            match self.side[vertex as usize] {
                1 => sides[0].push(vertex),
                2 => sides[1].push(vertex),
                _ => {}
            }
            self.side[vertex as usize] = 0;
        }
        for side in &mut sides {
            self.part(side)?;
        }
        // Within the separator any order gives the same fill; along the cut keeps neighbours together.
        separator.sort_unstable();
        self.order.extend(separator);
        Ok(())
    }

    fn leaf(&mut self, part: &mut [u32]) -> Result<(), FactorError> {
        part.sort_unstable();
        for (position, &vertex) in part.iter().enumerate() {
            self.side[vertex as usize] = 1;
            self.local[vertex as usize] = position as u32;
        }
        let mut starts = Vec::with_capacity(part.len() + 1);
        let mut indices = Vec::new();
        starts.push(0u32);
        for &vertex in part.iter() {
            let inside = self.pattern.row(vertex as usize).0.iter().filter(|&&other| self.side[other as usize] == 1);
            indices.extend(inside.map(|&other| self.local[other as usize]));
            starts.push(indices.len() as u32);
        }
        for &vertex in part.iter() {
            self.side[vertex as usize] = 0;
        }
        let order = approximate_minimum_degree(part.len(), &starts, &indices)?;
        self.order.extend(order.iter().map(|&local| part[local as usize]));
        Ok(())
    }

    fn longest_axis(&self, part: &[u32]) -> usize {
        let mut low = [f64::INFINITY; 3];
        let mut high = [f64::NEG_INFINITY; 3];
        for &vertex in part {
            for axis in 0..3 {
                low[axis] = low[axis].min(self.coordinates[vertex as usize][axis]);
                high[axis] = high[axis].max(self.coordinates[vertex as usize][axis]);
            }
        }
        let extent = |axis: usize| high[axis] - low[axis];
        (1..3).fold(0, |best, axis| if extent(axis) > extent(best) { axis } else { best })
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
fn approximate_minimum_degree(n: usize, starts: &[u32], indices: &[u32]) -> Result<Vec<u32>, FactorError> {
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
