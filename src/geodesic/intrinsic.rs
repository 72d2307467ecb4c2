//! The intrinsic Delaunay triangulation of a surface: the same surface, cut into triangles without obtuse angles opposite each other.
//!
//! Edges are straight lines within the surface, known by their lengths alone. An edge whose opposite angles add up to more than a half
//! turn is flipped: its two triangles are unfolded into the plane, and the other diagonal takes its place. The vertices stay, and so do
//! all distances; only the cotangents get better. None of the resulting edges has a negative weight.
//!
//! Literature: Bobenko, Springborn 2007, *A discrete Laplace–Beltrami operator for simplicial surfaces*; Fisher, Springborn, Bobenko,
//! Schröder 2006, *An algorithm for the construction of intrinsic Delaunay triangulations*; Sharp, Soliman, Crane 2019, *Navigating
//! intrinsic triangulations*.

use std::collections::VecDeque;

use crate::mesh::{SimplicialComplex, minus, norm};

/// A side without a neighbour.
const NO_SIDE: u32 = u32::MAX;
/// Cotangents whose sum is this much below zero, relative to their size, are worth a flip: corners on one circle are not.
const TOLERANCE: f64 = 1e-10;
/// Flips a side, at most. There is always an end; rounding on slivers shall not move it.
const PATIENCE: usize = 1000;

/// A triangulation known by the lengths of its sides. Side k of a triangle runs from corner k to the next.
///
/// Two corners of a triangle may be one vertex, and two triangles may share two sides.
pub(super) struct Intrinsic {
    /// The corners of every triangle.
    pub corners: Vec<[u32; 3]>,
    /// The lengths of its sides, divided by `scale`.
    pub lengths: Vec<[f64; 3]>,
    /// A power of two near the size of the mesh, so that fourth powers of lengths neither overflow nor vanish.
    pub scale: f64,
    /// The side, three times its triangle plus its number, across each side.
    across: Vec<u32>,
    /// Edges that were flipped.
    pub flips: usize,
}

impl Intrinsic {
    /// The triangulation as it is.
    ///
    /// Edges of more than two triangles, and edges across which no orientation goes on, as on a Möbius strip, join nothing and stay.
    ///
    /// # Arguments
    /// * `complex`: triangles of positive area.
    pub fn of(complex: &SimplicialComplex) -> Self {
        let mut corners: Vec<[u32; 3]> = complex.simplices().chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect();
        let turned = turned(&corners);
        corners.iter_mut().zip(turned).filter(|(_, turned)| *turned).for_each(|(corners, _)| corners.swap(1, 2));
        let scale = complex.bounding_box_diagonal().log2().floor().exp2();
        let place = |vertex: u32| complex.points()[vertex as usize].map(|part| part / scale);
        let length = |a: u32, b: u32| norm(minus(place(a), place(b)));
        let lengths = corners.iter().map(|&[a, b, c]| [length(a, b), length(b, c), length(c, a)]).collect();
        let mut across = vec![NO_SIDE; 3 * corners.len()];
        for (one, other) in pairs(&corners) {
            if runs_up(&corners, one) != runs_up(&corners, other) {
                (across[one as usize], across[other as usize]) = (other, one);
            }
        }
        Self { corners, lengths, scale, across, flips: 0 }
    }

    /// Flips edges until all are Delaunay; one after the other, in an order that depends on the mesh alone.
    ///
    /// # Cost
    /// O(m) for m sides and the flips, which are few: fewer than sides on all meshes that were measured.
    pub fn flipped(mut self) -> Self {
        let sides = self.across.len() as u32;
        let mut queue: VecDeque<u32> = (0..sides).filter(|&side| self.across[side as usize] > side).collect();
        let mut is_queued = vec![false; sides as usize];
        queue.iter().for_each(|&side| is_queued[side as usize] = true);
        while let Some(side) = queue.pop_front() {
            is_queued[side as usize] = false;
            if self.flips >= PATIENCE * sides as usize {
                break;
            }
            let other = self.across[side as usize];
            if other == NO_SIDE || other / 3 == side / 3 || self.is_delaunay(side, other) || !self.flip(side, other) {
                continue;
            }
            // The sides around the quadrilateral see another apex now.
            for near in [side, other].into_iter().flat_map(|side| [0, 2].map(|k| side / 3 * 3 + k)) {
                if self.across[near as usize] != NO_SIDE && !is_queued[near as usize] {
                    is_queued[near as usize] = true;
                    queue.push_back(near);
                }
            }
        }
        self
    }

    /// The area of a triangle.
    pub fn area(&self, triangle: usize) -> f64 {
        0.5 * double_area(self.lengths[triangle]) * self.scale * self.scale
    }

    /// The cotangent of the angle opposite to each side.
    pub fn cotangents(&self, triangle: usize) -> [f64; 3] {
        let lengths = self.lengths[triangle];
        let area = double_area(lengths);
        [0, 1, 2].map(|side| {
            let [own, next, last] = [0, 1, 2].map(|step| lengths[(side + step) % 3]);
            // next² + last² - own² without the loss of digits.
            (next * next + (last - own) * (last + own)) / (2.0 * area)
        })
    }

    /// The gradients of the barycentric coordinates of the second and third corner, in a plane of the triangle's own.
    pub fn gradients(&self, triangle: usize) -> [[f64; 3]; 3] {
        let base = self.lengths[triangle][0];
        let [x, y] = apex(self.lengths[triangle]);
        let rise = 1.0 / (y * self.scale);
        [[1.0 / (base * self.scale), -x / base * rise, 0.0], [0.0, rise, 0.0], [0.0; 3]]
    }

    fn is_delaunay(&self, side: u32, other: u32) -> bool {
        let cotangent = |side: u32| self.cotangents(side as usize / 3)[side as usize % 3];
        let (a, b) = (cotangent(side), cotangent(other));
        a + b >= -TOLERANCE * (a.abs() + b.abs())
    }

    /// Puts the other diagonal in the place of an edge, as side 1 of both triangles. Slivers that have no area left in their numbers stay.
    fn flip(&mut self, side: u32, other: u32) -> bool {
        let (one, two) = (side as usize / 3, other as usize / 3);
        // Sides and corners from the edge on.
        let turn = |side: u32| [0, 1, 2].map(|step| side / 3 * 3 + (side % 3 + step) % 3);
        let (sides, others) = (turn(side), turn(other));
        let length = |side: u32| self.lengths[side as usize / 3][side as usize % 3];
        let corner = |side: u32| self.corners[side as usize / 3][side as usize % 3];
        let ([i, j, a], b) = (sides.map(corner), corner(others[2]));
        // The edge from i to j on the axis, a above it and b below.
        let (above, below) = (apex(sides.map(length)), apex(others.map(length)));
        let edge = length(side);
        let diagonal = (above[0] - (edge - below[0])).hypot(above[1] + below[1]);
        let new_one = [length(others[1]), diagonal, length(sides[2])];
        let new_two = [length(sides[1]), diagonal, length(others[2])];
        if !(double_area(new_one) > 0.0 && double_area(new_two) > 0.0) {
            return false;
        }
        let first = |triangle: usize| 3 * triangle as u32;
        // Where each outer side goes.
        let moves = [(others[1], first(one)), (sides[2], first(one) + 2), (sides[1], first(two)), (others[2], first(two) + 2)];
        let moved = |side: u32| moves.iter().find(|(old, _)| *old == side).map_or(side, |(_, new)| *new);
        let neighbours = moves.map(|(old, new)| (new, self.across[old as usize]));
        for (new, neighbour) in neighbours {
            let neighbour = if neighbour == NO_SIDE { NO_SIDE } else { moved(neighbour) };
            self.across[new as usize] = neighbour;
            if neighbour != NO_SIDE {
                self.across[neighbour as usize] = new;
            }
        }
        (self.across[3 * one + 1], self.across[3 * two + 1]) = (first(two) + 1, first(one) + 1);
        (self.corners[one], self.corners[two]) = ([i, b, a], [j, a, b]);
        (self.lengths[one], self.lengths[two]) = (new_one, new_two);
        self.flips += 1;
        true
    }
}

/// The third corner of a triangle whose first side lies on the axis, from the origin on.
fn apex([base, right, left]: [f64; 3]) -> [f64; 2] {
    [0.5 * (base + (left - right) * (left + right) / base), double_area([base, right, left]) / base]
}

/// Twice the area from the lengths of the sides, in the order of Kahan, which keeps its digits on slivers; 0 where they make no triangle.
fn double_area(lengths: [f64; 3]) -> f64 {
    let mut sorted = lengths;
    sorted.sort_unstable_by(|a, b| b.total_cmp(a));
    let [a, b, c] = sorted;
    let product = (a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c));
    0.5 * product.max(0.0).sqrt()
}

/// Whether a side runs from the lower to the higher vertex.
fn runs_up(corners: &[[u32; 3]], side: u32) -> bool {
    let (triangle, k) = (side as usize / 3, side as usize % 3);
    corners[triangle][k] < corners[triangle][(k + 1) % 3]
}

/// The two sides of every edge that has two.
fn pairs(corners: &[[u32; 3]]) -> Vec<(u32, u32)> {
    let ends = |side: u32| {
        let (triangle, k) = (side as usize / 3, side as usize % 3);
        let (a, b) = (corners[triangle][k], corners[triangle][(k + 1) % 3]);
        (a.min(b), a.max(b), side)
    };
    let mut sides: Vec<(u32, u32, u32)> = (0..3 * corners.len() as u32).map(ends).collect();
    sides.sort_unstable();
    sides.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)).filter(|group| group.len() == 2).map(|group| (group[0].2, group[1].2)).collect()
}

/// Which triangles to turn over so that neighbours agree, as far as they can.
fn turned(corners: &[[u32; 3]]) -> Vec<bool> {
    let mut across = vec![NO_SIDE; 3 * corners.len()];
    for (one, other) in pairs(corners) {
        (across[one as usize], across[other as usize]) = (other, one);
    }
    let mut turned: Vec<Option<bool>> = vec![None; corners.len()];
    let mut stack = Vec::new();
    for start in 0..corners.len() {
        if turned[start].is_some() {
            continue;
        }
        turned[start] = Some(false);
        stack.push(start);
        while let Some(triangle) = stack.pop() {
            let own = turned[triangle].unwrap_or(false);
            for (side, &other) in across.iter().enumerate().skip(3 * triangle).take(3) {
                if other == NO_SIDE || turned[other as usize / 3].is_some() {
                    continue;
                }
                let is_same_way = runs_up(corners, side as u32) == runs_up(corners, other);
                turned[other as usize / 3] = Some(own != is_same_way);
                stack.push(other as usize / 3);
            }
        }
    }
    turned.into_iter().map(|turned| turned.unwrap_or(false)).collect()
}
