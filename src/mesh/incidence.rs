//! Incidence lists of a complex: stars, faces, neighbours, duplicates.
//!
//! Every list is grouped by its lowest vertex, and the group of a vertex is read off its star. So the lists come out
//! sorted without a global sort, groups are small and close in memory, and chunks of vertices run in parallel with one
//! possible result.

use super::complex::EdgeId;
use crate::field::VertexId;
use rayon::prelude::*;

/// Vertices handled by one parallel task. Any size gives the same result; this one amortises a task of about 1 ms.
const CHUNK: usize = 8192;

/// Top simplices at each vertex, by rising number.
#[derive(Debug, Clone)]
pub(super) struct Star {
    offsets: Vec<u32>,
    simplices: Vec<u32>,
}

impl Star {
    /// Counting sort of the corners. All corners must be below `vertices`.
    pub(super) fn new(vertices: usize, stride: usize, simplices: &[u32]) -> Self {
        let mut next = vec![0u32; vertices + 1];
        for &vertex in simplices {
            next[vertex as usize] += 1;
        }
        // next[v] := first slot of v; the last entry counts nothing and becomes the total.
        let mut total = 0;
        for slot in &mut next {
            total += std::mem::replace(slot, total);
        }
        let offsets = next.clone();
        let mut star = vec![0u32; simplices.len()];
        for (simplex, corners) in simplices.chunks_exact(stride).enumerate() {
            for &vertex in corners {
                let slot = &mut next[vertex as usize];
                star[*slot as usize] = simplex as u32;
                *slot += 1;
            }
        }
        Self { offsets, simplices: star }
    }

    pub(super) fn of(&self, vertex: usize) -> &[u32] {
        &self.simplices[self.offsets[vertex] as usize..self.offsets[vertex + 1] as usize]
    }

    fn vertices(&self) -> usize {
        self.offsets.len() - 1
    }

    /// Lets `visit` list the group of every vertex and joins the groups by rising vertex.
    fn gather<T: Send + Sync + Clone>(&self, visit: impl Fn(usize, &mut Vec<T>) + Sync) -> Vec<T> {
        let vertices = self.vertices();
        let parts: Vec<Vec<T>> = (0..vertices.div_ceil(CHUNK))
            .into_par_iter()
            .map(|chunk| {
                let mut part = Vec::new();
                for vertex in chunk * CHUNK..((chunk + 1) * CHUNK).min(vertices) {
                    visit(vertex, &mut part);
                }
                part
            })
            .collect();
        parts.concat()
    }
}

/// The corners of a simplex above `vertex`, and how many they are.
fn corners_above(corners: &[u32], vertex: usize) -> ([u32; 3], usize) {
    let mut above = [0; 3];
    let mut count = 0;
    for &corner in corners {
        if corner as usize > vertex {
            above[count] = corner;
            count += 1;
        }
    }
    (above, count)
}

/// All edges, each once, by rising vertices, sorted.
pub(super) fn edges(star: &Star, stride: usize, simplices: &[u32]) -> Vec<[VertexId; 2]> {
    star.gather(|vertex, list: &mut Vec<[VertexId; 2]>| {
        let mut group = Group::at(list);
        for &simplex in star.of(vertex) {
            let (above, count) = corners_above(corners(stride, simplices, simplex), vertex);
            for &corner in &above[..count] {
                group.push([VertexId::from(vertex), VertexId(corner)]);
            }
        }
        group.sort_and_dedup();
    })
}

/// All triangles, each once, by rising vertices, sorted. Of a complex of dimension 2 or 3.
pub(super) fn triangles(star: &Star, stride: usize, simplices: &[u32]) -> Vec<[VertexId; 3]> {
    star.gather(|vertex, list: &mut Vec<[VertexId; 3]>| {
        let mut group = Group::at(list);
        for &simplex in star.of(vertex) {
            let (mut above, count) = corners_above(corners(stride, simplices, simplex), vertex);
            let above = &mut above[..count];
            above.sort_unstable();
            for (position, &middle) in above.iter().enumerate() {
                for &highest in &above[position + 1..] {
                    group.push([VertexId::from(vertex), VertexId(middle), VertexId(highest)]);
                }
            }
        }
        group.sort_and_dedup();
    })
}

/// Pairs (earlier, later) of simplices with the same vertices; `earlier` is always the first of its kind.
///
/// Sorted by the vertices, so the first pair is that of the lowest vertices.
pub(super) fn duplicates(star: &Star, stride: usize, simplices: &[u32]) -> Vec<(u32, u32)> {
    star.gather(|vertex, pairs: &mut Vec<(u32, u32)>| {
        let whole = |simplex: u32| {
            let (mut above, count) = corners_above(corners(stride, simplices, simplex), vertex);
            above[..count].sort_unstable();
            (count + 1 == stride).then_some((above, simplex))
        };
        let mut lowest_here: Vec<([u32; 3], u32)> = star.of(vertex).iter().filter_map(|&simplex| whole(simplex)).collect();
        lowest_here.sort_unstable();
        for run in lowest_here.chunk_by(|a, b| a.0 == b.0) {
            pairs.extend(run[1..].iter().map(|later| (run[0].1, later.1)));
        }
    })
}

/// Neighbours and incident edges of every vertex, by rising neighbour, from the sorted edges.
pub(super) fn adjacency(vertices: usize, edges: &[[VertexId; 2]]) -> (Vec<u32>, Vec<VertexId>, Vec<EdgeId>) {
    let mut next = vec![0u32; vertices + 1];
    for edge in edges {
        next[edge[0].index()] += 1;
        next[edge[1].index()] += 1;
    }
    let mut total = 0;
    for slot in &mut next {
        total += std::mem::replace(slot, total);
    }
    let offsets = next.clone();
    let mut neighbours = vec![VertexId(0); edges.len() * 2];
    let mut incident = vec![EdgeId(0); edges.len() * 2];
    // Edges are sorted, so a first pass that adds lower neighbours and a second that adds upper ones leave every list sorted.
    for (from, to) in [(1, 0), (0, 1)] {
        for (id, edge) in edges.iter().enumerate() {
            let slot = &mut next[edge[from].index()];
            neighbours[*slot as usize] = edge[to];
            incident[*slot as usize] = EdgeId(id as u32);
            *slot += 1;
        }
    }
    (offsets, neighbours, incident)
}

/// Where the group of every vertex begins in a list sorted by `keys`, and the length of the list.
pub(super) fn group_offsets(vertices: usize, keys: impl Iterator<Item = VertexId>) -> Vec<u32> {
    let mut offsets = vec![0u32; vertices + 1];
    for key in keys {
        offsets[key.index() + 1] += 1;
    }
    for vertex in 0..vertices {
        offsets[vertex + 1] += offsets[vertex];
    }
    offsets
}

fn corners(stride: usize, simplices: &[u32], simplex: u32) -> &[u32] {
    &simplices[simplex as usize * stride..(simplex as usize + 1) * stride]
}

/// The tail of a list, sorted and freed of repetitions when it is complete.
struct Group<'a, T> {
    list: &'a mut Vec<T>,
    begin: usize,
}

impl<'a, T: Ord + Copy> Group<'a, T> {
    fn at(list: &'a mut Vec<T>) -> Self {
        let begin = list.len();
        Self { list, begin }
    }

    fn push(&mut self, item: T) {
        self.list.push(item);
    }

    fn sort_and_dedup(self) {
        self.list[self.begin..].sort_unstable();
        let mut kept = self.begin;
        for read in self.begin..self.list.len() {
            if kept == self.begin || self.list[kept - 1] != self.list[read] {
                self.list[kept] = self.list[read];
                kept += 1;
            }
        }
        self.list.truncate(kept);
    }
}
