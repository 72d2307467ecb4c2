//! The lower stars of a grid: at most 14 neighbours, so that cells are sets of bits and queues are masks.

use crate::mesh::FreudenthalLattice;

use super::link::{Codes, Link, SLOTS, link};

/// A set of cells of one lower star, from which the lowest is taken.
///
/// Lower neighbours are numbered by rising rank; the set of those numbers, read as a binary number, compares as the field
/// compares the cells: by their vertices from the highest on, a face before its cofaces. So the lowest cell is found
/// from its highest vertex on.
#[derive(Default)]
struct Queue {
    /// Highest vertices of the cells.
    tops: u16,
    edges: u16,
    /// By highest vertex: second vertices.
    seconds: [u16; SLOTS],
    triangles: [u16; SLOTS],
    /// By highest and second vertex: third vertices.
    tetrahedra: [[u16; SLOTS]; SLOTS],
}

/// A cell of a lower star but for its highest vertex, by rising rank of the others from the right.
#[derive(Clone, Copy)]
enum Local {
    Edge(usize),
    Triangle(usize, usize),
    Tetrahedron(usize, usize, usize),
}

impl Queue {
    fn push(&mut self, cell: Local) {
        match cell {
            Local::Edge(a) => {
                self.tops |= 1 << a;
                self.edges |= 1 << a;
            }
            Local::Triangle(a, b) => {
                self.tops |= 1 << a;
                self.seconds[a] |= 1 << b;
                self.triangles[a] |= 1 << b;
            }
            Local::Tetrahedron(a, b, c) => {
                self.tops |= 1 << a;
                self.seconds[a] |= 1 << b;
                self.tetrahedra[a][b] |= 1 << c;
            }
        }
    }

    fn pop(&mut self) -> Option<Local> {
        if self.tops == 0 {
            return None;
        }
        let a = self.tops.trailing_zeros() as usize;
        let cell = if self.edges >> a & 1 == 1 {
            self.edges &= self.edges - 1;
            Local::Edge(a)
        } else {
            let b = self.seconds[a].trailing_zeros() as usize;
            let cell = if self.triangles[a] >> b & 1 == 1 {
                self.triangles[a] &= self.triangles[a] - 1;
                Local::Triangle(a, b)
            } else {
                let c = self.tetrahedra[a][b].trailing_zeros() as usize;
                self.tetrahedra[a][b] &= self.tetrahedra[a][b] - 1;
                Local::Tetrahedron(a, b, c)
            };
            if self.triangles[a] >> b & 1 == 0 && self.tetrahedra[a][b] == 0 {
                self.seconds[a] &= !(1 << b);
            }
            cell
        };
        if self.edges >> a & 1 == 0 && self.seconds[a] == 0 {
            self.tops &= self.tops - 1;
        }
        Some(cell)
    }
}

/// Where the pairs of lower stars are written: dimension, number of the cell, what it keeps.
pub(super) trait Sink: Fn(usize, u32, u8) {}

impl<F: Fn(usize, u32, u8)> Sink for F {}

/// Work space for the lower star of one point after the other; its queues are empty in between.
pub(super) struct LatticeStar {
    link: &'static Link,
    /// By dimension and cell of the star: its number less that of the first cell at the point, modulo 2^32.
    shifts: [Vec<u32>; 4],
    /// Types of cells by dimension.
    kinds: [u32; 4],
    point: u32,
    /// Neighbours by rank: numbers in the link.
    slots: [usize; SLOTS],
    /// Ranks of the lower neighbours by number in the link.
    places: [u16; SLOTS],
    lower: u16,
    adjacent: [u16; SLOTS],
    edges_done: u16,
    triangles_done: [u16; SLOTS],
    one: Queue,
    zero: Queue,
}

impl LatticeStar {
    pub(super) fn new(lattice: &FreudenthalLattice) -> Self {
        let link = link(lattice.dimension());
        let kinds = [0, 1, 2, 3].map(|dimension| lattice.kinds(dimension) as u32);
        let shift = |dimension: usize| {
            let of_cell = |&(back, kind): &(u8, u32)| {
                kind.wrapping_sub(lattice.steps()[back as usize].wrapping_mul(kinds[dimension]))
            };
            link.anchors[dimension].iter().map(of_cell).collect()
        };
        Self {
            link,
            shifts: [0, 1, 2, 3].map(shift),
            kinds,
            point: 0,
            slots: [0; SLOTS],
            places: [0; SLOTS],
            lower: 0,
            adjacent: [0; SLOTS],
            edges_done: 0,
            triangles_done: [0; SLOTS],
            one: Queue::default(),
            zero: Queue::default(),
        }
    }

    /// Pairs the cells of the lower star of a point that has lower neighbours; cells that are not written are critical.
    ///
    /// # Arguments
    /// * `point`: its number.
    /// * `lower`: its lower neighbours, a set of numbers in the link.
    /// * `ranks`: ranks of the neighbours; those of others than the lower ones are `i32::MAX`.
    pub(super) fn pair(&mut self, point: u32, lower: u16, ranks: &[i32; 16], sink: &impl Sink) {
        self.point = point;
        self.lower = lower;
        self.sort(ranks);
        let link = self.link;
        let codes = link.of_edge[self.slots[0]];
        sink(0, point, codes.up);
        sink(1, self.number(1, self.slots[0]), codes.down);
        let count = lower.count_ones() as usize;
        if count == 1 {
            return;
        }
        self.meet(count);
        self.edges_done = 1;
        self.triangles_done[..count].fill(0);
        let all = (1u32 << count) - 1;
        self.zero.tops = all as u16 & !1;
        self.zero.edges = all as u16 & !1;
        self.offer_triangles(0);
        loop {
            while let Some(cell) = self.one.pop() {
                match cell {
                    Local::Edge(_) => {}
                    Local::Triangle(a, b) => self.pair_triangle(a, b, sink),
                    Local::Tetrahedron(a, b, c) => self.pair_tetrahedron(a, b, c, sink),
                }
            }
            match self.zero.pop() {
                Some(Local::Edge(a)) if self.edges_done >> a & 1 == 0 => {
                    self.edges_done |= 1 << a;
                    self.offer_triangles(a);
                }
                Some(Local::Triangle(a, b)) if self.triangles_done[a] >> b & 1 == 0 => {
                    self.close_triangle(a, b);
                    self.offer_tetrahedra(a, b);
                }
                Some(_) => {}
                None => return,
            }
        }
    }

    /// Numbers the lower neighbours by rank.
    fn sort(&mut self, ranks: &[i32; 16]) {
        for slot in 0..self.link.slots {
            // Counting has no branch to mispredict, and vectorises.
            let below: i32 = ranks.iter().map(|&rank| i32::from(rank < ranks[slot])).sum();
            self.places[slot] = below as u16;
        }
        let mut rest = self.lower;
        while rest != 0 {
            let slot = rest.trailing_zeros() as usize;
            self.slots[self.places[slot] as usize] = slot;
            rest &= rest - 1;
        }
    }

    /// Finds the triangles of the lower star.
    fn meet(&mut self, count: usize) {
        for place in 0..count {
            let mut rest = self.link.adjacent[self.slots[place]] & self.lower;
            let mut adjacent = 0;
            while rest != 0 {
                adjacent |= 1 << self.places[rest.trailing_zeros() as usize];
                rest &= rest - 1;
            }
            self.adjacent[place] = adjacent;
        }
    }

    fn pair_triangle(&mut self, a: usize, b: usize, sink: &impl Sink) {
        if self.triangles_done[a] >> b & 1 == 1 {
            return;
        }
        let (edge, other) = match (self.edges_done >> a & 1, self.edges_done >> b & 1) {
            (0, _) => (a, b),
            (_, 0) => (b, a),
            _ => return self.zero.push(Local::Triangle(a, b)),
        };
        let codes = self.link.of_triangle[self.slots[edge]][self.slots[other]];
        self.write(1, self.slots[edge], codes, sink);
        self.edges_done |= 1 << edge;
        self.close_triangle(a, b);
        self.offer_triangles(edge);
        self.offer_tetrahedra(a, b);
    }

    fn pair_tetrahedron(&mut self, a: usize, b: usize, c: usize, sink: &impl Sink) {
        let open = |x: usize, y: usize| self.triangles_done[x] >> y & 1 == 0;
        let (x, y, third) = if open(a, b) {
            (a, b, c)
        } else if open(a, c) {
            (a, c, b)
        } else if open(b, c) {
            (b, c, a)
        } else {
            return self.zero.push(Local::Tetrahedron(a, b, c));
        };
        let triangle = self.link.of_triangle[self.slots[x]][self.slots[y]].upper as usize;
        let codes = self.link.of_tetrahedron[triangle][self.slots[third]];
        self.write(2, triangle, codes, sink);
        self.close_triangle(x, y);
        self.offer_tetrahedra(x, y);
    }

    /// Triangles of an edge that is done and of one that is not.
    fn offer_triangles(&mut self, edge: usize) {
        let mut rest = self.adjacent[edge] & !self.edges_done & !self.triangles_done[edge];
        while rest != 0 {
            let other = rest.trailing_zeros() as usize;
            rest &= rest - 1;
            self.one.push(Local::Triangle(edge.max(other), edge.min(other)));
        }
    }

    /// Tetrahedra of a triangle that is done and of one more that is and one that is not.
    fn offer_tetrahedra(&mut self, a: usize, b: usize) {
        let mut rest = self.link.thirds[self.slots[a]][self.slots[b]] & self.lower;
        while rest != 0 {
            let c = self.places[rest.trailing_zeros() as usize] as usize;
            rest &= rest - 1;
            if (self.triangles_done[a] ^ self.triangles_done[b]) >> c & 1 == 1 {
                // a > b always.
                self.one.push(if c > a {
                    Local::Tetrahedron(c, a, b)
                } else if c > b {
                    Local::Tetrahedron(a, c, b)
                } else {
                    Local::Tetrahedron(a, b, c)
                });
            }
        }
    }

    fn close_triangle(&mut self, a: usize, b: usize) {
        self.triangles_done[a] |= 1 << b;
        self.triangles_done[b] |= 1 << a;
    }

    /// Writes a pair of a cell of the star of some dimension and number, and its partner above.
    fn write(&self, dimension: usize, number_in_star: usize, codes: Codes, sink: &impl Sink) {
        sink(dimension, self.number(dimension, number_in_star), codes.up);
        sink(dimension + 1, self.number(dimension + 1, codes.upper as usize), codes.down);
    }

    fn number(&self, dimension: usize, number_in_star: usize) -> u32 {
        self.point.wrapping_mul(self.kinds[dimension]).wrapping_add(self.shifts[dimension][number_in_star])
    }
}
