//! The pairing of one lower star with few neighbours: sets of cells are masks, and so are the queues.

/// Most lower neighbours.
pub(super) const LOWER: usize = 16;

/// The link of the lower star of a vertex. Lower neighbours are numbered by rising rank, and cells of the star are named by
/// them.
pub(super) trait LowerLink {
    /// The neighbours that form a triangle with the vertex and one of them, as a set.
    fn adjacent(&self, a: usize) -> u16;
    /// The neighbours that form a tetrahedron with the vertex and two of them, as a set.
    fn thirds(&self, a: usize, b: usize) -> u16;
    /// Pairs the vertex with the edge to its lowest neighbour.
    fn pair_vertex(&self);
    /// Pairs the edge to one neighbour with the triangle of it and another.
    fn pair_edge(&self, edge: usize, other: usize);
    /// Pairs the triangle of two neighbours with the tetrahedron of them and a third.
    fn pair_triangle(&self, triangle: [usize; 2], third: usize);
}

/// A triangle or tetrahedron of a lower star, by its other vertices from the highest on.
#[derive(Clone, Copy)]
enum Local {
    Triangle(usize, usize),
    Tetrahedron(usize, usize, usize),
}

/// A set of triangles and tetrahedra of one lower star, from which the lowest is taken.
///
/// The numbers of the vertices of a cell, read as the bits of one number, compare as the field compares cells: by their
/// vertices from the highest on, a face before its cofaces. So the lowest cell is found from its highest vertex on.
#[derive(Default)]
struct Queue {
    /// Highest vertices of the cells.
    tops: u16,
    /// By highest vertex: second vertices.
    seconds: [u16; LOWER],
    /// By highest vertex: second vertices of triangles.
    triangles: [u16; LOWER],
    /// By highest and second vertex: third vertices.
    tetrahedra: [[u16; LOWER]; LOWER],
}

/// The first number in a set that is not empty; the remainder tells the compiler that it is within the arrays.
fn first(set: u16) -> usize {
    set.trailing_zeros() as usize % LOWER
}

impl Queue {
    fn push_triangle(&mut self, a: usize, b: usize) {
        self.tops |= 1 << a;
        self.seconds[a] |= 1 << b;
        self.triangles[a] |= 1 << b;
    }

    fn push_tetrahedron(&mut self, a: usize, b: usize, c: usize) {
        self.tops |= 1 << a;
        self.seconds[a] |= 1 << b;
        self.tetrahedra[a][b] |= 1 << c;
    }

    fn pop(&mut self) -> Option<Local> {
        if self.tops == 0 {
            return None;
        }
        let a = first(self.tops);
        let seconds = self.seconds[a];
        let (b, bit) = (first(seconds), seconds & seconds.wrapping_neg());
        let thirds = self.tetrahedra[a][b];
        let (cell, is_last) = if self.triangles[a] & bit != 0 {
            self.triangles[a] ^= bit;
            (Local::Triangle(a, b), thirds == 0)
        } else {
            let rest = thirds & thirds.wrapping_sub(1);
            self.tetrahedra[a][b] = rest;
            (Local::Tetrahedron(a, b, first(thirds)), rest == 0)
        };
        if is_last {
            self.seconds[a] = seconds ^ bit;
            if seconds == bit {
                self.tops &= self.tops.wrapping_sub(1);
            }
        }
        Some(cell)
    }
}

/// Work space for one lower star after the other; its queues are empty in between.
#[derive(Default)]
pub(super) struct MaskStar {
    /// Edges that are paired or critical.
    edges_done: u16,
    /// By vertex: the other vertices of triangles that are paired or critical.
    triangles_done: [u16; LOWER],
    /// Cells that had exactly one open facet when they were put here.
    one: Queue,
    /// Cells without open facets, which no facet can be paired with; edges are not listed.
    zero: Queue,
}

impl MaskStar {
    /// Pairs the cells of the lower star of a vertex with `count` lower neighbours, at least one; cells that are not told to
    /// `link` are critical.
    ///
    /// Source: Robins, Wood, Sheppard 2011, algorithm *ProcessLowerStars*.
    pub(super) fn pair(&mut self, count: usize, link: &impl LowerLink) {
        link.pair_vertex();
        if count == 1 {
            return;
        }
        let all = u16::MAX >> (LOWER - count);
        self.edges_done = 1;
        self.triangles_done = [0; LOWER];
        self.offer_triangles(0, link);
        loop {
            while let Some(cell) = self.one.pop() {
                match cell {
                    Local::Triangle(a, b) => self.pair_triangle(a, b, link),
                    Local::Tetrahedron(a, b, c) => self.pair_tetrahedron(a, b, c, link),
                }
            }
            let open = all & !self.edges_done;
            // An edge comes before all other cells with the same highest vertex.
            if open != 0 && open.trailing_zeros() <= self.zero.tops.trailing_zeros() {
                let edge = first(open);
                self.edges_done |= 1 << edge;
                self.offer_triangles(edge, link);
                continue;
            }
            match self.zero.pop() {
                Some(Local::Triangle(a, b)) if self.triangles_done[a] >> b & 1 == 0 => {
                    self.close_triangle(a, b);
                    self.offer_tetrahedra(a, b, link);
                }
                Some(_) => {}
                None => return,
            }
        }
    }

    fn pair_triangle(&mut self, a: usize, b: usize, link: &impl LowerLink) {
        if self.triangles_done[a] >> b & 1 == 1 {
            return;
        }
        let (edge, other) = match (self.edges_done >> a & 1, self.edges_done >> b & 1) {
            (0, _) => (a, b),
            (_, 0) => (b, a),
            _ => return self.zero.push_triangle(a, b),
        };
        link.pair_edge(edge, other);
        self.edges_done |= 1 << edge;
        self.close_triangle(a, b);
        self.offer_triangles(edge, link);
        self.offer_tetrahedra(a, b, link);
    }

    fn pair_tetrahedron(&mut self, a: usize, b: usize, c: usize, link: &impl LowerLink) {
        let is_open = |x: usize, y: usize| self.triangles_done[x] >> y & 1 == 0;
        let (x, y, third) = if is_open(a, b) {
            (a, b, c)
        } else if is_open(a, c) {
            (a, c, b)
        } else if is_open(b, c) {
            (b, c, a)
        } else {
            // Without an open facet, and no facet of anything itself: critical.
            return;
        };
        link.pair_triangle([x, y], third);
        self.close_triangle(x, y);
        self.offer_tetrahedra(x, y, link);
    }

    /// Triangles of an edge that is done and of one that is not.
    fn offer_triangles(&mut self, edge: usize, link: &impl LowerLink) {
        let mut rest = link.adjacent(edge) & !self.edges_done & !self.triangles_done[edge];
        while rest != 0 {
            let other = first(rest);
            rest &= rest.wrapping_sub(1);
            self.one.push_triangle(edge.max(other), edge.min(other));
        }
    }

    /// Tetrahedra of a triangle that is done and of one more that is and one that is not; `a` is above `b`.
    fn offer_tetrahedra(&mut self, a: usize, b: usize, link: &impl LowerLink) {
        let mut rest = link.thirds(a, b) & (self.triangles_done[a] ^ self.triangles_done[b]);
        while rest != 0 {
            let c = first(rest);
            rest &= rest.wrapping_sub(1);
            if c > a {
                self.one.push_tetrahedron(c, a, b);
            } else if c > b {
                self.one.push_tetrahedron(a, c, b);
            } else {
                self.one.push_tetrahedron(a, b, c);
            }
        }
    }

    fn close_triangle(&mut self, a: usize, b: usize) {
        self.triangles_done[a] |= 1 << b;
        self.triangles_done[b] |= 1 << a;
    }
}
