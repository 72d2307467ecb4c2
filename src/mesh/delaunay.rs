//! Outlines filled with triangles. The only home of the crate `spade`.

use super::measure::ZERO_MEASURE;
use super::outline::{OutlineError, OutlineOptions, OutlinePlace, Size};
use super::SimplicialComplex;
use crate::field::VertexId;
use spade::handles::{FixedFaceHandle, FixedVertexHandle, InnerTag};
use spade::{
    AngleLimit, ConstrainedDelaunayTriangulation, Intersection, LineIntersectionIterator, Point2, RefinementParameters, Triangulation,
};
use std::collections::{BTreeMap, VecDeque};

type Triangles = ConstrainedDelaunayTriangulation<Point2<f64>>;

/// Rounds in which long edges are halved and angles mended after that.
const ROUNDS: usize = 8;

/// Fills outlines with triangles.
///
/// A point is inside where a way from far out crosses an odd number of rings: a ring in a ring is a hole, a ring in the hole an
/// island. In which direction a ring runs does not matter. The triangulation is Delaunay but for the rings, which stay as
/// they are; new points on them divide their segments. An angle between two segments that is smaller than the bound stays.
///
/// # Arguments
/// * `rings`: places of each ring, in order; the last one is joined to the first. Equal places in a row count as one.
/// * `options`: how large and how blunt triangles are.
///
/// # Returns
/// A complex in the plane z = 0. Its first vertices are the places as given, ring by ring, bit by bit; then come new ones. Triangles are
/// counter-clockwise.
///
/// # Errors
/// [`OutlineError`] names rings and places, counted from 0, where rings cross, touch, or are no rings.
///
/// # Cost
/// O(n log n) usually, one thread.
///
/// # Source
/// Ruppert 1995, *A Delaunay refinement algorithm for quality 2-dimensional mesh generation*, as the crate `spade` has it.
///
/// # Example
/// ```
/// use morsmooth::mesh::{OutlineOptions, Size, triangulate};
/// let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
/// let hole = square.map(|[x, y]| [0.25 + x / 2.0, 0.25 + y / 2.0]);
/// let mesh = triangulate(&[square.to_vec(), hole.to_vec()], &OutlineOptions { max_edge: Size::Absolute(0.2), ..OutlineOptions::default() })?;
/// let area: f64 = (0..mesh.simplex_count()).map(|triangle| mesh.measure(triangle)).sum();
/// assert!((area - 0.75).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn triangulate(rings: &[Vec<[f64; 2]>], options: &OutlineOptions) -> Result<SimplicialComplex, OutlineError> {
    let rings = without_repeats(rings);
    let diagonal = super::outline::check(&rings, options)?;
    let mut triangles = Triangles::new();
    let handles = insert_points(&mut triangles, &rings)?;
    insert_segments(&mut triangles, &rings, &handles)?;
    let longest = match options.max_edge {
        Size::Fraction(part) => part * diagonal,
        Size::Absolute(length) => length,
        Size::Unbounded => f64::INFINITY,
    };
    let mut triangles = with_short_segments(triangles, &rings, longest, options.max_vertices)?;
    refine(&mut triangles, options, longest)?;
    assemble(&triangles, &rings)
}

/// Rings without places that repeat the one before.
fn without_repeats(rings: &[Vec<[f64; 2]>]) -> Vec<Vec<[f64; 2]>> {
    let clean = |ring: &Vec<[f64; 2]>| {
        let mut ring = ring.clone();
        ring.dedup();
        while ring.len() > 1 && ring.first() == ring.last() {
            ring.pop();
        }
        ring
    };
    rings.iter().map(clean).collect()
}

fn insert_points(triangles: &mut Triangles, rings: &[Vec<[f64; 2]>]) -> Result<Vec<Vec<FixedVertexHandle>>, OutlineError> {
    let mut owner: Vec<OutlinePlace> = Vec::new();
    let mut handles = Vec::with_capacity(rings.len());
    for (ring, points) in rings.iter().enumerate() {
        let mut row = Vec::with_capacity(points.len());
        for (point, &position) in points.iter().enumerate() {
            let [x, y] = position;
            let here = OutlinePlace { ring, point };
            let handle = triangles.insert(Point2::new(x, y)).map_err(|_| OutlineError::Coordinate { place: here, position })?;
            if let Some(&first) = owner.get(handle.index()) {
                return Err(OutlineError::Touching { first, second: here, position });
            }
            owner.push(here);
            row.push(handle);
        }
        handles.push(row);
    }
    Ok(handles)
}

/// Makes every segment an edge; refuses those that cross or touch another.
fn insert_segments(
    triangles: &mut Triangles,
    rings: &[Vec<[f64; 2]>],
    handles: &[Vec<FixedVertexHandle>],
) -> Result<(), OutlineError> {
    let mut owner: BTreeMap<[usize; 2], OutlinePlace> = BTreeMap::new();
    let place_of: Vec<OutlinePlace> =
        handles.iter().enumerate().flat_map(|(ring, row)| (0..row.len()).map(move |point| OutlinePlace { ring, point })).collect();
    for (ring, row) in handles.iter().enumerate() {
        for (point, &from) in row.iter().enumerate() {
            let to = row[(point + 1) % row.len()];
            let here = OutlinePlace { ring, point };
            for intersection in LineIntersectionIterator::new_from_handles(triangles, from, to) {
                match intersection {
                    Intersection::VertexIntersection(vertex) if vertex.fix() != from && vertex.fix() != to => {
                        let [x, y]: [f64; 2] = vertex.position().into();
                        return Err(OutlineError::Touching { first: here, second: place_of[vertex.index()], position: [x, y] });
                    }
                    Intersection::EdgeIntersection(edge) if edge.is_constraint_edge() => {
                        let ends = edge.vertices().map(|vertex| vertex.fix());
                        let other = owner.get(&key(ends)).copied().unwrap_or(here);
                        let position = crossing([from, to].map(|end| place(triangles, end)), ends.map(|end| place(triangles, end)));
                        let lengths = [&rings[other.ring], &rings[ring]].map(Vec::len);
                        return Err(OutlineError::Crossing { first: other, second: here, lengths, position });
                    }
                    Intersection::EdgeOverlap(edge) if edge.is_constraint_edge() => {
                        let ends = edge.vertices().map(|vertex| vertex.fix());
                        let first = owner.get(&key(ends)).copied().unwrap_or(here);
                        return Err(OutlineError::Touching { first, second: here, position: place(triangles, from) });
                    }
                    _ => {}
                }
            }
            triangles.add_constraint(from, to);
            owner.insert(key([from, to]), here);
        }
    }
    Ok(())
}

fn key(ends: [FixedVertexHandle; 2]) -> [usize; 2] {
    let [a, b] = ends.map(|end| end.index());
    [a.min(b), a.max(b)]
}

fn place(triangles: &Triangles, vertex: FixedVertexHandle) -> [f64; 2] {
    triangles.vertex(vertex).position().into()
}

/// Where two segments cross, to rounding.
fn crossing([a, b]: [[f64; 2]; 2], [c, d]: [[f64; 2]; 2]) -> [f64; 2] {
    let turn = |p: [f64; 2], q: [f64; 2]| p[0] * q[1] - p[1] * q[0];
    let (along, other, offset) = ([b[0] - a[0], b[1] - a[1]], [d[0] - c[0], d[1] - c[1]], [c[0] - a[0], c[1] - a[1]]);
    let share = turn(offset, other) / turn(along, other);
    [a[0] + share * along[0], a[1] + share * along[1]]
}

/// The same with every segment divided into equal parts that are short enough; given points come first.
fn with_short_segments(
    whole: Triangles,
    rings: &[Vec<[f64; 2]>],
    longest: f64,
    most: usize,
) -> Result<Triangles, OutlineError> {
    // Rounding must not make a part too long.
    let parts = |from: [f64; 2], to: [f64; 2]| ((to[0] - from[0]).hypot(to[1] - from[1]) / longest * (1.0 + 1e-9)).ceil().max(1.0);
    let segments = || rings.iter().flat_map(|ring| ring.iter().copied().zip(ring.iter().copied().cycle().skip(1)));
    let count: f64 = segments().map(|(from, to)| parts(from, to)).sum();
    if count == whole.num_vertices() as f64 {
        return Ok(whole);
    }
    if count > most as f64 {
        return Err(OutlineError::TooMany { allowed: most });
    }
    let too_fine = OutlineError::TooFine { longest };
    let mut triangles = Triangles::new();
    let mut insert = |[x, y]: [f64; 2]| {
        let next = triangles.num_vertices();
        // A place that is there already, or too near to zero for the predicates.
        triangles.insert(Point2::new(x, y)).ok().filter(|handle| handle.index() == next)
    };
    for &place in rings.iter().flatten() {
        insert(place).ok_or_else(|| too_fine.clone())?;
    }
    let mut chains = Vec::new();
    let mut first = 0;
    for ring in rings {
        for (point, &from) in ring.iter().enumerate() {
            let after = (point + 1) % ring.len();
            let (to, parts) = (ring[after], parts(from, ring[after]));
            let mut chain = vec![FixedVertexHandle::from_index(first + point)];
            for part in 1..parts as usize {
                let share = part as f64 / parts;
                let place = [0, 1].map(|axis| from[axis] + share * (to[axis] - from[axis]));
                chain.push(insert(place).ok_or_else(|| too_fine.clone())?);
            }
            chain.push(FixedVertexHandle::from_index(first + after));
            chains.push(chain);
        }
        first += ring.len();
    }
    for chain in chains {
        for ends in chain.windows(2) {
            if !triangles.can_add_constraint(ends[0], ends[1]) {
                return Err(too_fine);
            }
            triangles.add_constraint(ends[0], ends[1]);
        }
    }
    Ok(triangles)
}

/// Adds points until angles, areas and edges are as asked.
fn refine(triangles: &mut Triangles, options: &OutlineOptions, longest: f64) -> Result<(), OutlineError> {
    // An equilateral triangle of the longest edge.
    let area = options.max_area.unwrap_or(f64::INFINITY).min(longest * longest * 3f64.sqrt() / 4.0);
    let enough = |found: usize| match found > options.max_vertices {
        true => Err(OutlineError::TooMany { allowed: options.max_vertices }),
        false => Ok(()),
    };
    if options.min_angle == 0.0 && area.is_infinite() {
        // The refinement would still divide segments for the sake of Delaunay triangles.
        return Ok(());
    }
    for round in 0..=ROUNDS {
        let mut parameters = RefinementParameters::<f64>::new()
            .exclude_outer_faces(true)
            .with_angle_limit(AngleLimit::from_deg(options.min_angle))
            .with_max_additional_vertices(options.max_vertices.saturating_sub(triangles.num_vertices()) + 1);
        if area.is_finite() {
            parameters = parameters.with_max_allowed_area(area);
        }
        if !triangles.refine(parameters).refinement_complete {
            return Err(OutlineError::TooMany { allowed: options.max_vertices });
        }
        let halved = halve_long_edges(triangles, longest, options.max_vertices)?;
        enough(triangles.num_vertices())?;
        // Halves of long edges can leave small angles, which the next round mends; the bound on edges holds in any case.
        if halved == 0 || round == ROUNDS {
            break;
        }
    }
    Ok(())
}

/// Puts a point into the middle of every inner edge that is too long, until there is none; tells how many.
fn halve_long_edges(triangles: &mut Triangles, longest: f64, most: usize) -> Result<usize, OutlineError> {
    let mut count = 0;
    loop {
        let inside = inside(triangles);
        let is_inside = |face: Option<FixedFaceHandle<InnerTag>>| face.is_some_and(|face| inside[face.index()]);
        let mut long: Vec<(f64, [usize; 2], Point2<f64>)> = triangles
            .undirected_edges()
            .filter(|edge| edge.length_2() > longest * longest)
            .filter(|edge| {
                let edge = edge.as_directed();
                is_inside(edge.face().fix().as_inner()) || is_inside(edge.rev().face().fix().as_inner())
            })
            .map(|edge| {
                let [from, to] = edge.positions();
                let middle = Point2::new(from.x / 2.0 + to.x / 2.0, from.y / 2.0 + to.y / 2.0);
                (edge.length_2(), key(edge.vertices().map(|vertex| vertex.fix())), middle)
            })
            .collect();
        if long.is_empty() {
            return Ok(count);
        }
        // The longest first: its middle often shortens its neighbours.
        long.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let before = triangles.num_vertices();
        for (_, ends, middle) in long {
            let [from, to] = ends.map(FixedVertexHandle::from_index);
            let Some(edge) = triangles.get_edge_from_neighbors(from, to) else { continue };
            // Segments are short already; points put on them afterwards are off them by rounding.
            if edge.is_constraint_edge() || triangles.insert_with_hint(middle, from).is_err() {
                // A coordinate too small for the predicates: only rounding can have made it, and another edge will do.
                continue;
            }
            if triangles.num_vertices() > most {
                return Err(OutlineError::TooMany { allowed: most });
            }
        }
        if triangles.num_vertices() == before {
            return Err(OutlineError::TooFine { longest });
        }
        count += triangles.num_vertices() - before;
    }
}

/// Whether each inner face of the triangulation is inside the rings: a way from outside crosses an odd number of them.
fn inside(triangles: &Triangles) -> Vec<bool> {
    let mut crossings: Vec<Option<bool>> = vec![None; triangles.num_inner_faces() + 1];
    let mut queue = VecDeque::new();
    for edge in triangles.convex_hull() {
        if let Some(face) = edge.rev().face().as_inner()
            && crossings[face.index()].is_none()
        {
            crossings[face.index()] = Some(edge.is_constraint_edge());
            queue.push_back(face.fix());
        }
    }
    while let Some(face) = queue.pop_front() {
        let own = crossings[face.index()] == Some(true);
        for edge in triangles.face(face).adjacent_edges() {
            if let Some(next) = edge.rev().face().as_inner()
                && crossings[next.index()].is_none()
            {
                crossings[next.index()] = Some(own != edge.is_constraint_edge());
                queue.push_back(next.fix());
            }
        }
    }
    crossings.into_iter().map(|odd| odd == Some(true)).collect()
}

/// The triangles inside, with the vertices of rings first and no vertex that only triangles outside have.
fn assemble(triangles: &Triangles, rings: &[Vec<[f64; 2]>]) -> Result<SimplicialComplex, OutlineError> {
    let given = rings.iter().map(Vec::len).sum::<usize>();
    let inside = inside(triangles);
    let mut number = vec![None; triangles.num_vertices()];
    let mut points: Vec<[f64; 3]> = rings.iter().flatten().map(|&[x, y]| [x, y, 0.0]).collect();
    (0..given).for_each(|vertex| number[vertex] = Some(vertex as u32));
    let mut corners = Vec::new();
    for face in triangles.inner_faces().filter(|face| inside[face.index()]) {
        for vertex in face.vertices() {
            let number = number[vertex.index()].get_or_insert_with(|| {
                let position = vertex.position();
                points.push([position.x, position.y, 0.0]);
                points.len() as u32 - 1
            });
            corners.push(*number);
        }
    }
    let complex = SimplicialComplex::new(2, points, corners)?;
    match complex.first_zero_measure() {
        Some((triangle, ratio)) if ratio < ZERO_MEASURE => {
            let [x, y, _] = complex.point(VertexId(complex.simplex(triangle)[0]));
            Err(OutlineError::Flat { position: [x, y], ratio })
        }
        _ => Ok(complex),
    }
}
