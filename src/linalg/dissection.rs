//! Nested dissection of a graph whose vertices have places.
//!
//! Every part carries its own small graph and its vertices sorted along each axis, so that a cut costs a few passes over the part
//! and both halves go on side by side.

use std::collections::VecDeque;

use super::FactorError;
use super::ordering::approximate_minimum_degree;

/// Largest part that is left to minimum degree. Smaller leaves cut more separators than they save,
/// larger ones grow the fill of minimum degree; between 100 and 300 nothing moves by more than a few percent.
const LEAF: usize = 200;

/// Parts below this size are not worth another thread.
const SHARED: usize = 4_000;

/// The smaller side of a cut has at least this share of the part.
const LEAST_SIDE: f64 = 0.42;

/// How much of its size a separator may lose for a cut through the middle.
const IMBALANCE: f64 = 0.5;

/// Axes along which a part is shorter than this share of its longest one are not tried.
const SHORT_AXIS: f64 = 0.6;

/// A connected or disconnected part of a graph, with local numbers.
pub(super) struct Part {
    starts: Vec<u32>,
    neighbours: Vec<u32>,
    /// The vertex of the whole graph behind each local number.
    names: Vec<u32>,
    /// Local numbers along each axis.
    sorted: [Vec<u32>; 3],
}

/// A way to cut a part: the first `position` of these go to one side.
struct Cut {
    order: Vec<u32>,
    position: usize,
    cost: f64,
}

impl Part {
    /// The whole graph.
    ///
    /// # Arguments
    /// * `starts`, `neighbours`: both directions of each edge; loops are dropped.
    pub fn whole(starts: &[u32], neighbours: &[u32], places: &[[f64; 3]]) -> Self {
        let n = places.len();
        let mut part = Self {
            starts: vec![0],
            neighbours: Vec::with_capacity(neighbours.len()),
            names: (0..n as u32).collect(),
            sorted: Default::default(),
        };
        for vertex in 0..n {
            let row = &neighbours[starts[vertex] as usize..starts[vertex + 1] as usize];
            part.neighbours.extend(row.iter().filter(|&&other| other as usize != vertex));
            part.starts.push(part.neighbours.len() as u32);
        }
        let along = |axis: usize| {
            let mut order = part.names.clone();
            order.sort_unstable_by(|&a, &b| places[a as usize][axis].total_cmp(&places[b as usize][axis]).then(a.cmp(&b)));
            order
        };
        let (x, (y, z)) = rayon::join(|| along(0), || rayon::join(|| along(1), || along(2)));
        part.sorted = [x, y, z];
        part
    }

    fn len(&self) -> usize {
        self.names.len()
    }

    fn around(&self, vertex: u32) -> &[u32] {
        &self.neighbours[self.starts[vertex as usize] as usize..self.starts[vertex as usize + 1] as usize]
    }

    /// The order of elimination: both halves, then what separates them.
    pub fn dissect(self, places: &[[f64; 3]]) -> Result<Vec<u32>, FactorError> {
        if self.len() <= LEAF {
            let order = approximate_minimum_degree(self.len(), &self.starts, &self.neighbours)?;
            return Ok(order.into_iter().map(|local| self.names[local as usize]).collect());
        }
        let is_shared = self.len() >= SHARED;
        let cut = self.best_cut(places);
        let mut side = vec![1u8; self.len()];
        cut.order[..cut.position].iter().for_each(|&vertex| side[vertex as usize] = 0);
        self.separate(&mut side);
        let separator: Vec<u32> = (0..self.len()).filter(|&local| side[local] == 2).map(|local| self.names[local]).collect();
        if separator.len() == self.len() {
            return Ok(separator);
        }
        let (first, second) = (self.restricted(&side, 0), self.restricted(&side, 1));
        drop(self);
        let (first, second) = if is_shared {
            rayon::join(|| first.dissect(places), || second.dissect(places))
        } else {
            (first.dissect(places), second.dissect(places))
        };
        let mut order = first?;
        order.extend(second?);
        order.extend(separator);
        Ok(order)
    }

    fn best_cut(&self, places: &[[f64; 3]]) -> Cut {
        let extent = |axis: usize| {
            let place = |end: Option<&u32>| end.map_or(0.0, |&local| places[self.names[local as usize] as usize][axis]);
            place(self.sorted[axis].last()) - place(self.sorted[axis].first())
        };
        let extents = [0, 1, 2].map(extent);
        let longest = extents.into_iter().fold(0.0, f64::max);
        let axes = (0..3).filter(|&axis| extents[axis] >= SHORT_AXIS * longest);
        let mut best: Option<Cut> = None;
        let mut rank = vec![0; self.len()];
        for order in axes.map(|axis| self.sorted[axis].clone()).chain(std::iter::once_with(|| self.levels())) {
            let (position, cost) = self.position(&order, &mut rank);
            if best.as_ref().is_none_or(|best| cost < best.cost) {
                best = Some(Cut { order, position, cost });
            }
        }
        best.unwrap_or_else(|| Cut { order: self.sorted[0].clone(), position: self.len() / 2, cost: 0.0 })
    }

    /// Where along an order a cut has the thinnest layer on its thinner side, with its cost.
    fn position(&self, order: &[u32], rank: &mut [u32]) -> (usize, f64) {
        let n = self.len();
        for (place, &vertex) in order.iter().enumerate() {
            rank[vertex as usize] = place as u32;
        }
        // A vertex is in the lower layer of the cuts between it and its last neighbour, and in the upper one of those since its first.
        let (mut lower, mut upper) = (vec![0i32; n + 2], vec![0i32; n + 2]);
        for (place, &vertex) in order.iter().enumerate() {
            let (mut first, mut last) = (place, place);
            for &other in self.around(vertex) {
                let other = rank[other as usize] as usize;
                first = first.min(other);
                last = last.max(other);
            }
            lower[place + 1] += 1;
            lower[last + 1] -= 1;
            upper[first + 1] += 1;
            upper[place + 1] -= 1;
        }
        let (least, most) = ((LEAST_SIDE * n as f64) as usize, n - (LEAST_SIDE * n as f64) as usize);
        let (mut below, mut above) = (0, 0);
        let mut best = (n / 2, f64::INFINITY);
        for position in 0..=most {
            below += lower[position];
            above += upper[position];
            if position >= least.max(1) {
                let imbalance = (position as f64 / n as f64 - 0.5).abs();
                let cost = f64::from(below.min(above)) * (1.0 + IMBALANCE * imbalance);
                // Towards the middle on equal terms.
                if cost < best.1 {
                    best = (position, cost);
                }
            }
        }
        best
    }

    /// Vertices by their distance from an end of the part: what cuts a folded surface where no plane does.
    fn levels(&self) -> Vec<u32> {
        let first = self.breadth_first(0);
        let end = first.last().copied().unwrap_or(0);
        self.breadth_first(end)
    }

    fn breadth_first(&self, seed: u32) -> Vec<u32> {
        let mut seen = vec![false; self.len()];
        let mut order = Vec::with_capacity(self.len());
        let mut head = 0;
        for start in std::iter::once(seed).chain(0..self.len() as u32) {
            if seen[start as usize] {
                continue;
            }
            seen[start as usize] = true;
            order.push(start);
            while head < order.len() {
                let vertex = order[head];
                head += 1;
                for &other in self.around(vertex) {
                    if !seen[other as usize] {
                        seen[other as usize] = true;
                        order.push(other);
                    }
                }
            }
        }
        order
    }

    /// Marks with 2 the fewest vertices whose removal leaves no edge between the sides 0 and 1.
    ///
    /// # Source
    /// König 1931: a smallest vertex cover from a largest matching; Pothen and Fan 1990 use it for separators.
    fn separate(&self, side: &mut [u8]) {
        const NONE: u32 = u32::MAX;
        const DEAD: u32 = u32::MAX - 1;
        let sides = &*side;
        let crossing = |vertex: u32| {
            let own = sides[vertex as usize];
            self.around(vertex).iter().copied().filter(move |&other| sides[other as usize] != own)
        };
        let on_border = |&vertex: &u32| sides[vertex as usize] == 0 && crossing(vertex).next().is_some();
        let border: Vec<u32> = (0..self.len() as u32).filter(on_border).collect();
        let mut partner = vec![NONE; self.len()];
        for &vertex in &border {
            if let Some(free) = crossing(vertex).find(|&other| partner[other as usize] == NONE) {
                partner[free as usize] = vertex;
                partner[vertex as usize] = free;
            }
        }
        // Augmenting paths, breadth first from each vertex that is left over.
        let mut seen = vec![NONE; self.len()];
        let mut came_from = vec![NONE; self.len()];
        for &root in &border {
            if partner[root as usize] != NONE {
                continue;
            }
            let mut queue = VecDeque::from([root]);
            let mut visited = Vec::new();
            let mut is_longer = false;
            'search: while let Some(vertex) = queue.pop_front() {
                for other in crossing(vertex) {
                    if seen[other as usize] == root || seen[other as usize] == DEAD {
                        continue;
                    }
                    seen[other as usize] = root;
                    visited.push(other);
                    came_from[other as usize] = vertex;
                    match partner[other as usize] {
                        NONE => {
                            let mut end = other;
                            while end != NONE {
                                let vertex = came_from[end as usize];
                                let next = partner[vertex as usize];
                                partner[end as usize] = vertex;
                                partner[vertex as usize] = end;
                                end = next;
                            }
                            is_longer = true;
                            break 'search;
                        }
                        next => queue.push_back(next),
                    }
                }
            }
            if !is_longer {
                // No later path can come through here either.
                visited.into_iter().for_each(|other| seen[other as usize] = DEAD);
            }
        }
        // Reached by alternating paths from unmatched vertices: the cover is what is not reached here and what is reached there.
        let mut reached = vec![false; self.len()];
        let mut queue: VecDeque<u32> = border.iter().copied().filter(|&vertex| partner[vertex as usize] == NONE).collect();
        queue.iter().for_each(|&vertex| reached[vertex as usize] = true);
        while let Some(vertex) = queue.pop_front() {
            for other in crossing(vertex) {
                if !std::mem::replace(&mut reached[other as usize], true) {
                    let next = partner[other as usize];
                    if next != NONE && !std::mem::replace(&mut reached[next as usize], true) {
                        queue.push_back(next);
                    }
                }
            }
        }
        let cover: Vec<u32> = border
            .iter()
            .flat_map(|&vertex| [vertex, partner[vertex as usize]])
            .filter(|&vertex| vertex != NONE && reached[vertex as usize] != (sides[vertex as usize] == 0))
            .collect();
        cover.into_iter().for_each(|vertex| side[vertex as usize] = 2);
    }

    /// The part on one side.
    fn restricted(&self, side: &[u8], wanted: u8) -> Self {
        let mut local = vec![0; self.len()];
        let mut names = Vec::with_capacity(self.len() / 2);
        for (vertex, &name) in self.names.iter().enumerate() {
            if side[vertex] == wanted {
                local[vertex] = names.len() as u32;
                names.push(name);
            }
        }
        let mut starts = Vec::with_capacity(names.len() + 1);
        starts.push(0);
        let mut neighbours = Vec::with_capacity(self.neighbours.len() / 2);
        for vertex in (0..self.len()).filter(|&vertex| side[vertex] == wanted) {
            let inside = self.around(vertex as u32).iter().filter(|&&other| side[other as usize] == wanted);
            neighbours.extend(inside.map(|&other| local[other as usize]));
            starts.push(neighbours.len() as u32);
        }
        let sorted = [0, 1, 2].map(|axis| {
            let inside = self.sorted[axis].iter().filter(|&&vertex| side[vertex as usize] == wanted);
            inside.map(|&vertex| local[vertex as usize]).collect()
        });
        Self { starts, neighbours, names, sorted }
    }
}
