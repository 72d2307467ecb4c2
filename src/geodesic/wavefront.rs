//! The wave that runs from the sources: which side is crossed next, and what becomes of its windows.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::envelope::{Envelope, insert_all};
use super::source::SurfacePoint;
use super::surface::{Link, Side, Surface};
use super::turn::sectors;
use super::window::{Crossing, Window, hypot};
use crate::mesh::SimplicialComplex;

/// A way that is shorter by less than this part changes nothing.
const TIE: f64 = 1e-14;
/// A window is dropped where a way along an edge is shorter by this part; rounding must not drop the ray that runs along it.
const FILTER: f64 = 1e-12;

/// The last way by which a vertex was reached, for vertices where paths bend: a side with the vertex as apex, and the point from
/// which the way comes straight, in the plane of that side.
#[derive(Debug, Clone, Copy)]
pub(super) struct Arrival {
    pub side: u32,
    pub from: [f64; 2],
}

/// Distances found so far, and windows still to be carried on.
pub(super) struct Wavefront<'a> {
    complex: &'a SimplicialComplex,
    surface: &'a Surface,
    distances: Vec<f64>,
    arrivals: Vec<Option<Arrival>>,
    envelopes: Vec<Envelope>,
    /// The key under which each side waits in the queue; infinite if it does not.
    waiting: Vec<f64>,
    /// Sides, and after them vertices, by the least distance to be carried on.
    queue: BinaryHeap<Reverse<(u64, u32)>>,
    batch: Vec<Window>,
    left: Leaving,
    right: Leaving,
    scratch: Envelope,
}

/// Windows that leave a triangle through one side, by rising place, and their least distance.
struct Leaving {
    windows: Vec<Window>,
    least: f64,
}

impl Default for Leaving {
    fn default() -> Self {
        Self { windows: Vec::new(), least: f64::INFINITY }
    }
}

impl Leaving {
    /// Adds a window, unless it is beaten: told from the distances at its ends.
    #[inline]
    fn add(&mut self, window: Window, is_beaten: impl Fn([f64; 2]) -> bool) {
        let ends = [window.distance(window.begin), window.distance(window.end)];
        if !is_beaten(ends) {
            self.least = self.least.min(window.least(ends[0], ends[1]));
            self.windows.push(window);
        }
    }
}

impl<'a> Wavefront<'a> {
    /// Starts at the sources, which are on the smallest cells that hold them.
    pub fn new(complex: &'a SimplicialComplex, surface: &'a Surface, sources: &[SurfacePoint]) -> Self {
        let vertices = complex.vertex_count();
        let mut wave = Self {
            complex,
            surface,
            distances: vec![f64::INFINITY; vertices],
            arrivals: vec![None; vertices],
            envelopes: vec![Vec::new(); surface.sides.len()],
            waiting: vec![f64::INFINITY; surface.sides.len()],
            queue: BinaryHeap::new(),
            batch: Vec::new(),
            left: Leaving::default(),
            right: Leaving::default(),
            scratch: Vec::new(),
        };
        for source in sources {
            wave.start(source);
        }
        wave
    }

    /// Runs until nothing changes.
    pub fn run(mut self) -> Vec<f64> {
        loop {
            while let Some(Reverse((key, number))) = self.queue.pop() {
                let sides = self.surface.sides.len() as u32;
                if number < sides {
                    if self.waiting[number as usize].to_bits() == key {
                        self.waiting[number as usize] = f64::INFINITY;
                        self.cross(number);
                    }
                } else if self.distances[(number - sides) as usize].to_bits() == key {
                    self.bend(number - sides);
                }
            }
            if !self.relax() {
                break;
            }
        }
        let scale = self.surface.scale;
        self.distances.iter().map(|distance| distance * scale).collect()
    }

    /// Windows and distances in the triangles that hold a source.
    fn start(&mut self, source: &SurfacePoint) {
        let surface = self.surface;
        if let SurfacePoint::Vertex(vertex) = source {
            self.distances[vertex.index()] = 0.0;
            // No way of arrival: paths leave in all directions.
            self.arrivals[vertex.index()] = None;
            for &triangle in self.complex.star(*vertex) {
                let opposite = surface.opposite(triangle, vertex.0);
                let side = &surface.sides[opposite as usize];
                self.reach(side.corners[0], side.left_length, None);
                self.reach(side.corners[1], side.right_length, None);
                self.leave(opposite, side.apex, 0.0, [0.0, side.length]);
            }
            return;
        }
        for triangle in source.triangles(self.complex) {
            let weights = source.weights_in(self.complex, triangle);
            for corner in 0..3u32 {
                let number = 3 * triangle + corner;
                let side = &surface.sides[number as usize];
                let place = |step: u32| weights[((corner + step) % 3) as usize];
                let at = [place(1) * side.length + place(2) * side.apex[0], place(2) * side.apex[1]];
                let apex_distance = hypot(side.apex[0] - at[0], side.apex[1] - at[1]);
                self.reach(side.corners[2], apex_distance, Some(Arrival { side: number, from: at }));
                // A source on the side itself does not shine through it.
                if place(2) > 0.0 {
                    self.leave(number, at, 0.0, [0.0, side.length]);
                }
            }
        }
    }

    /// Carries all waiting windows of a side across its triangle.
    fn cross(&mut self, number: u32) {
        let surface = self.surface;
        let side = &surface.sides[number as usize];
        let [a, b, c] = side.corners;
        let mut batch = std::mem::take(&mut self.batch);
        batch.clear();
        for entry in self.envelopes[number as usize].iter_mut().filter(|entry| entry.is_pending) {
            entry.is_pending = false;
            batch.push(entry.window);
        }
        let along = self.distances[a as usize] + side.left_length;
        self.reach(c, along, Some(Arrival { side: number, from: [0.0, 0.0] }));
        let along = self.distances[b as usize] + side.right_length;
        self.reach(c, along, Some(Arrival { side: number, from: [side.length, 0.0] }));
        let crossing = Crossing::new(side);
        let (mut left, mut right) = (std::mem::take(&mut self.left), std::mem::take(&mut self.right));
        for window in &batch {
            let passage = crossing.pass(window);
            if let Some(distance) = passage.apex {
                self.reach(c, distance, Some(Arrival { side: number, from: [window.x, window.y] }));
            }
            if let Some(child) = passage.left {
                left.add(child, |ends| self.is_beaten_left(side, &child, ends));
            }
            if let Some(child) = passage.right {
                right.add(child, |ends| self.is_beaten_right(side, &child, ends));
            }
        }
        self.enter(side.left, &mut left, side.left_length);
        self.enter(side.right, &mut right, side.right_length);
        (self.batch, self.left, self.right) = (batch, left, right);
    }

    /// Whether no shortest path leaves through a window of the side from `a` to `c`, because a vertex offers a shorter way to every ray.
    ///
    /// The ray to the far end is longer than the way over `a` along the side; then so is every other ray of the window, by the
    /// triangle inequality; likewise over `c` to the near end; and the way from `b` to the near end crosses every ray.
    ///
    /// # Arguments
    /// * `near`, `far`: distances at the begin and the end of the window.
    #[inline]
    fn is_beaten_left(&self, side: &Side, child: &Window, [near, far]: [f64; 2]) -> bool {
        let [a, b, c] = side.corners.map(|corner| self.distances[corner as usize]);
        let part = child.begin / side.left_length;
        a + child.end < far * (1.0 - FILTER)
            || c + (side.left_length - child.begin) < near * (1.0 - FILTER)
            || b + hypot(side.length - part * side.apex[0], part * side.apex[1]) < near * (1.0 - FILTER)
    }

    /// The same for the side from `c` to `b`.
    #[inline]
    fn is_beaten_right(&self, side: &Side, child: &Window, [far, near]: [f64; 2]) -> bool {
        let [a, b, c] = side.corners.map(|corner| self.distances[corner as usize]);
        let part = child.end / side.right_length;
        c + child.end < near * (1.0 - FILTER)
            || b + (side.right_length - child.begin) < far * (1.0 - FILTER)
            || a + hypot(side.apex[0] + part * (side.length - side.apex[0]), (1.0 - part) * side.apex[1]) < near * (1.0 - FILTER)
    }

    /// Lets windows into the neighbour behind a link, and forgets them.
    fn enter(&mut self, link: Link, leaving: &mut Leaving, length: f64) {
        if let Some((number, is_same_way)) = link.get()
            && !leaving.windows.is_empty()
        {
            if is_same_way {
                // The neighbour counts places from the other end.
                leaving.windows.iter_mut().for_each(|window| *window = window.turned(length));
                leaving.windows.reverse();
            }
            let place = number as usize;
            insert_all(&mut self.envelopes[place], &leaving.windows, length, &mut self.scratch);
            if leaving.least < self.waiting[place] {
                self.waiting[place] = leaving.least;
                self.queue.push(Reverse((leaving.least.to_bits(), number)));
            }
        }
        leaving.windows.clear();
        leaving.least = f64::INFINITY;
    }

    /// Sends a window out of a triangle through one of its sides, from a point of the triangle in the plane of that side.
    fn leave(&mut self, number: u32, from: [f64; 2], sigma: f64, [begin, end]: [f64; 2]) {
        let side = &self.surface.sides[number as usize];
        // Seen from the neighbour, which starts at the other end.
        let window = Window { begin, end, x: from[0], y: -from[1], sigma }.turned(side.length);
        let [a, b] = [side.corners[0], side.corners[1]].map(|corner| self.distances[corner as usize]);
        let mut leaving = std::mem::take(&mut self.left);
        leaving.add(window, |[at_begin, at_end]| {
            b + window.end < at_end * (1.0 - FILTER) || a + (side.length - window.begin) < at_begin * (1.0 - FILTER)
        });
        self.enter(self.surface.across[number as usize], &mut leaving, side.length);
        self.left = leaving;
    }

    /// Takes a way to a vertex if it is the shortest so far.
    fn reach(&mut self, vertex: u32, distance: f64, arrival: Option<Arrival>) {
        let slot = &mut self.distances[vertex as usize];
        if distance < *slot * (1.0 - TIE) || (*slot == f64::INFINITY && distance < *slot) {
            *slot = distance;
            if self.surface.bends[vertex as usize] {
                self.arrivals[vertex as usize] = arrival;
                let number = self.surface.sides.len() as u32 + vertex;
                self.queue.push(Reverse((distance.to_bits(), number)));
            }
        }
    }

    /// Lets paths leave a vertex at which they may bend, in the directions that make half a turn or more with their arrival.
    fn bend(&mut self, vertex: u32) {
        let sigma = self.distances[vertex as usize];
        let arrival = self.arrivals[vertex as usize];
        for (number, interval) in sectors(self.complex, self.surface, vertex, arrival) {
            let apex = self.surface.sides[number as usize].apex;
            self.leave(number, apex, sigma, interval);
        }
    }

    /// Takes ways along edges that are shorter than what was found. Without rounding there are none.
    fn relax(&mut self) -> bool {
        const SLACK: f64 = 1e-12;
        let mut is_changed = false;
        for number in 0..self.surface.sides.len() {
            let side = &self.surface.sides[number];
            let [a, b, c] = side.corners;
            for (end, length, from) in [(a, side.left_length, [0.0, 0.0]), (b, side.right_length, [side.length, 0.0])] {
                let (here, there) = (self.distances[end as usize], self.distances[c as usize]);
                if here + length < there * (1.0 - SLACK) {
                    self.reach(c, here + length, Some(Arrival { side: number as u32, from }));
                    is_changed = true;
                }
            }
        }
        is_changed
    }
}

