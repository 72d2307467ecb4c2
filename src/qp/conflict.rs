//! Contradictions among order rows, found by longest paths instead of diverging duals.

use super::Certificate;
use super::rows::Rows;

/// Most rounds of longest paths over arcs with cycles.
const ROUNDS: usize = 1000;

/// A contradiction among the rows that bound one free unknown or the difference of two, if there is one.
///
/// Such a row is an arc `x_j >= x_i + w`, or starts or ends at a ground of value zero. The rows have no common point exactly
/// if some cycle of arcs has a positive sum; its rows, each over its coefficient, are a certificate without residual. Longest
/// paths from the ground find every such cycle through the ground; cycles among the free unknowns are found where their arcs, taken alone,
/// have no topological order.
///
/// # Cost
/// O(m) where the arcs among free unknowns have no cycle; otherwise O(m) a round, and a contradiction that a thousand rounds
/// do not show is left to the interior point.
pub(super) fn contradiction(rows: &Rows) -> Option<Certificate> {
    let ground = rows.matrix.columns() as u32;
    let arcs: Vec<Arc> = (0..rows.order).filter_map(|row| arc(rows, row, ground)).collect();
    let size = ground as usize + 1;
    let (order, acyclic) = topological(&arcs, size, ground);
    let mut height = vec![if acyclic { f64::NEG_INFINITY } else { 0.0 }; size];
    let mut through = vec![u32::MAX; size];
    height[ground as usize] = 0.0;
    let rounds = if acyclic { 1 } else { size.min(ROUNDS) };
    for round in 1..=rounds {
        let mut changed = false;
        for &index in &order {
            let Arc { from, to, weight, .. } = arcs[index as usize];
            let reached = height[from as usize] + weight;
            if to == ground {
                // Rounding of the sum of a path must not pass for a contradiction.
                if through[from as usize] != u32::MAX
                    && reached > 1e-13 * rows.offset_size
                    && let Some(found) = cycle(rows, &arcs, &through, index)
                {
                    return Some(found);
                }
            } else if reached > height[to as usize] + 1e-15 * rows.offset_size {
                height[to as usize] = reached;
                through[to as usize] = index;
                changed = true;
            }
        }
        if !changed {
            break;
        }
        if round.is_power_of_two()
            && let Some(found) = (0..size as u32).find_map(|node| closed_walk(&arcs, &through, node))
        {
            return summed(rows, &arcs, &found);
        }
    }
    None
}

/// `x_to >= x_from + weight`, from the row `coefficient * (x_to - x_from) - coefficient * weight >= 0`.
#[derive(Clone, Copy)]
struct Arc {
    from: u32,
    to: u32,
    weight: f64,
    row: u32,
    coefficient: f64,
}

fn arc(rows: &Rows, row: usize, ground: u32) -> Option<Arc> {
    let (columns, values) = rows.matrix.row(row);
    let (from, to, coefficient) = match (columns, values) {
        (&[column], &[value]) if value > 0.0 => (ground, column, value),
        (&[column], &[value]) => (column, ground, -value),
        (&[first, second], &[a, b]) if a == -b && b > 0.0 => (first, second, b),
        (&[first, second], &[a, b]) if a == -b => (second, first, a),
        _ => return None,
    };
    Some(Arc { from, to, weight: -rows.offset[row] / coefficient, row: row as u32, coefficient })
}

/// The arcs so that those into an unknown come before those out of it, arcs into the ground last; false if the arcs among
/// the free unknowns have a cycle (then in order of rows).
fn topological(arcs: &[Arc], size: usize, ground: u32) -> (Vec<u32>, bool) {
    let mut waiting = vec![0u32; size];
    let mut starts = vec![0u32; size + 1];
    for arc in arcs {
        starts[arc.from as usize + 1] += 1;
        if arc.to != ground {
            waiting[arc.to as usize] += 1;
        }
    }
    for node in 0..size {
        starts[node + 1] += starts[node];
    }
    let mut next = starts.clone();
    let mut leaving = vec![0u32; arcs.len()];
    for (index, arc) in arcs.iter().enumerate() {
        leaving[next[arc.from as usize] as usize] = index as u32;
        next[arc.from as usize] += 1;
    }
    let mut ready: Vec<u32> = (0..size as u32).filter(|&node| waiting[node as usize] == 0).collect();
    let mut order = Vec::with_capacity(arcs.len());
    while let Some(node) = ready.pop() {
        for &index in &leaving[starts[node as usize] as usize..starts[node as usize + 1] as usize] {
            order.push(index);
            let to = arcs[index as usize].to;
            if to != ground {
                waiting[to as usize] -= 1;
                if waiting[to as usize] == 0 {
                    ready.push(to);
                }
            }
        }
    }
    if order.len() == arcs.len() { (order, true) } else { ((0..arcs.len() as u32).collect(), false) }
}

/// The cycle that the arc `last`, into the ground, closes with the longest path to its start.
fn cycle(rows: &Rows, arcs: &[Arc], through: &[u32], last: u32) -> Option<Certificate> {
    let mut path = vec![last];
    let mut node = arcs[last as usize].from;
    while node as usize != rows.matrix.columns() {
        let index = through[node as usize];
        if index == u32::MAX || path.len() > arcs.len() {
            return None;
        }
        path.push(index);
        node = arcs[index as usize].from;
    }
    summed(rows, arcs, &path)
}

/// The arcs of a cycle that following predecessors from `node` runs into, if it does.
fn closed_walk(arcs: &[Arc], through: &[u32], node: u32) -> Option<Vec<u32>> {
    // Floyd's two walkers; the slow one counts nothing, the fast one ends the search at a root.
    let step = |node: u32| match through[node as usize] {
        u32::MAX => None,
        index => Some(arcs[index as usize].from),
    };
    let (mut slow, mut fast) = (node, node);
    loop {
        fast = step(step(fast)?)?;
        slow = step(slow)?;
        if slow == fast {
            break;
        }
    }
    let mut path = Vec::new();
    let mut here = slow;
    loop {
        path.push(through[here as usize]);
        here = step(here)?;
        if here == slow {
            return Some(path);
        }
    }
}

/// The rows of a cycle with their multipliers, if they do contradict each other.
fn summed(rows: &Rows, arcs: &[Arc], path: &[u32]) -> Option<Certificate> {
    let smallest = path.iter().map(|&index| arcs[index as usize].coefficient).fold(f64::INFINITY, f64::min);
    let conflict = -smallest * path.iter().map(|&index| arcs[index as usize].weight).sum::<f64>();
    let mut ray = vec![0.0; rows.len()];
    for &index in path {
        let Arc { row, coefficient, .. } = arcs[index as usize];
        ray[row as usize] = smallest / coefficient;
    }
    (conflict < 0.0).then(|| Certificate::new(rows, &ray, (conflict, 0.0)))
}
