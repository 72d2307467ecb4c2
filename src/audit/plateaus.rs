//! Extrema where values were given to whole sets of vertices: connected vertices of one value are one place.
//!
//! A handle of a shape holds a bone or a region at one value. Counted vertex by vertex, such a plateau has no strict extremum, or as many as
//! it has vertices; counted as one place, it is a minimum if no neighbour of it is below, a maximum if none is above. Reads the top
//! simplices alone, and shares nothing with what produced the field.

use crate::field::{FieldError, VertexId, check_finite};
use crate::mesh::SimplicialComplex;

use super::report::{Defects, ExtremumType, MovedValue, ValueRule};

/// The extrema of a field against the values that were given.
#[derive(Debug, Clone, PartialEq)]
pub struct PlateauReport {
    /// Nothing spurious, nothing missing, no value moved, nothing flat.
    pub passed: bool,
    /// Minima found, a plateau counting as one.
    pub found_minima: usize,
    /// Maxima found, likewise.
    pub found_maxima: usize,
    /// Plateaus that hold vertices given the least value: they have to be minima.
    pub wanted_minima: usize,
    /// Plateaus that hold vertices given the greatest value: they have to be maxima.
    pub wanted_maxima: usize,
    /// Extrema without any given value, by their lowest vertices.
    pub spurious: Defects<(VertexId, ExtremumType)>,
    /// Plateaus of the least or greatest given value that are no minima or maxima, by their lowest vertices.
    pub missing: Defects<(VertexId, ExtremumType)>,
    /// Given values that the field does not have.
    pub moved_values: Defects<MovedValue>,
    /// Vertices without a given value on their plateau that have an equal neighbour, and none strictly below or none strictly above: there
    /// plain `<` and `<=` disagree.
    pub flat: Defects<VertexId>,
    /// Least and greatest value of the field.
    pub range: (f64, f64),
}

/// What lies at a plateau.
#[derive(Clone, Copy, Default)]
struct Place {
    lower: bool,
    higher: bool,
    given: bool,
    vertices: usize,
}

/// Counts the extrema of a field whose values were given at some vertices; those are the only places where it may have any.
///
/// A plateau that is all of its connected part is no extremum.
///
/// # Arguments
/// * `complex`: `n` vertices, any dimension.
/// * `values`: `n` values as they are stored.
/// * `given`: vertices and their values; one that does not exist is missing nothing.
///
/// # Errors
/// [`FieldError`] if there are not `n` values or one is not finite.
///
/// # Cost
/// Near linear in the number of top simplices.
///
/// # Example
/// ```
/// use morsmooth::audit::audit_plateaus;
/// use morsmooth::field::VertexId;
/// use morsmooth::mesh::SimplicialComplex;
/// let line = SimplicialComplex::new(1, vec![[0.0; 3]; 5], vec![0, 1, 1, 2, 2, 3, 3, 4])?;
/// let given = [(VertexId(0), 0.0), (VertexId(1), 0.0), (VertexId(4), 1.0)];
/// assert!(audit_plateaus(&line, &[0.0, 0.0, 0.2, 0.5, 1.0], &given)?.passed);
/// let report = audit_plateaus(&line, &[0.0, 0.0, 0.6, 0.5, 1.0], &given)?;
/// assert_eq!((report.found_minima, report.spurious.count), (2, 2)); // a maximum at 2, a minimum at 3
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn audit_plateaus(
    complex: &SimplicialComplex,
    values: &[f64],
    given: &[(VertexId, f64)],
) -> Result<PlateauReport, FieldError> {
    let n = complex.vertex_count();
    if values.len() != n {
        return Err(FieldError::LengthMismatch { expected: n, found: values.len() });
    }
    check_finite(values)?;
    let mut root: Vec<u32> = (0..n as u32).collect();
    let pairs = || {
        let corners = complex.simplices().chunks_exact(complex.dimension() + 1);
        corners.flat_map(|corners| corners.iter().enumerate().flat_map(|(place, &a)| corners[..place].iter().map(move |&b| (a, b))))
    };
    for (a, b) in pairs().filter(|&(a, b)| values[a as usize] == values[b as usize]) {
        let (a, b) = (find(&mut root, a), find(&mut root, b));
        // The lowest vertex stands for the plateau.
        root[a.max(b) as usize] = a.min(b);
    }
    let root: Vec<u32> = (0..n as u32).map(|vertex| find(&mut root, vertex)).collect();
    let mut places = vec![Place::default(); n];
    let mut beside = vec![[false; 2]; n];
    for (a, b) in pairs() {
        let (low, high) = if values[a as usize] < values[b as usize] { (a, b) } else { (b, a) };
        if values[low as usize] < values[high as usize] {
            places[root[low as usize] as usize].higher = true;
            places[root[high as usize] as usize].lower = true;
            beside[low as usize][1] = true;
            beside[high as usize][0] = true;
        }
    }
    for &vertex in &root {
        places[vertex as usize].vertices += 1;
    }
    let (least, greatest) = given.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &(_, value)| (low.min(value), high.max(value)));
    let (mut must_be_minimum, mut must_be_maximum) = (Vec::new(), Vec::new());
    let mut moved = Vec::new();
    for &(vertex, value) in given.iter().filter(|(vertex, _)| vertex.index() < n) {
        let plateau = root[vertex.index()];
        places[plateau as usize].given = true;
        let found = values[vertex.index()];
        if found != value {
            moved.push(MovedValue { vertex, found, rule: ValueRule::Exactly(value) });
        }
        // Where all given values are one, they ask for nothing.
        if value == least && least < greatest {
            must_be_minimum.push(plateau);
        }
        if value == greatest && least < greatest {
            must_be_maximum.push(plateau);
        }
    }
    let is_flat = |vertex: &usize| {
        let place = &places[root[*vertex] as usize];
        place.vertices > 1 && !place.given && beside[*vertex] != [true; 2]
    };
    let flat: Vec<VertexId> = (0..n).filter(is_flat).map(VertexId::from).collect();
    let (mut spurious, mut missing) = (Vec::new(), Vec::new());
    let (mut found_minima, mut found_maxima) = (0, 0);
    for (vertex, place) in places.iter().enumerate().filter(|&(vertex, _)| root[vertex] as usize == vertex) {
        let vertex = VertexId::from(vertex);
        for (kind, is_extremum, found) in [
            (ExtremumType::Minimum, place.higher && !place.lower, &mut found_minima),
            (ExtremumType::Maximum, place.lower && !place.higher, &mut found_maxima),
        ] {
            *found += usize::from(is_extremum);
            if is_extremum && !place.given {
                spurious.push((vertex, kind));
            }
        }
    }
    let mut wanted = |mut plateaus: Vec<u32>, kind, is_broken: fn(&Place) -> bool| {
        plateaus.sort_unstable();
        plateaus.dedup();
        plateaus.retain(|&plateau| places[plateau as usize].lower || places[plateau as usize].higher);
        let broken = plateaus.iter().filter(|&&plateau| is_broken(&places[plateau as usize]));
        missing.extend(broken.map(|&plateau| (VertexId(plateau), kind)));
        plateaus.len()
    };
    let wanted_minima = wanted(must_be_minimum, ExtremumType::Minimum, |place| place.lower);
    let wanted_maxima = wanted(must_be_maximum, ExtremumType::Maximum, |place| place.higher);
    moved.sort_by_key(|moved| moved.vertex);
    let range = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &value| (low.min(value), high.max(value)));
    Ok(PlateauReport {
        passed: spurious.is_empty() && missing.is_empty() && moved.is_empty() && flat.is_empty(),
        found_minima,
        found_maxima,
        wanted_minima,
        wanted_maxima,
        spurious: Defects::of(spurious),
        missing: Defects::of(missing),
        moved_values: Defects::of(moved),
        flat: Defects::of(flat),
        range,
    })
}

/// The lowest vertex of a plateau, paths halved on the way.
fn find(root: &mut [u32], mut vertex: u32) -> u32 {
    while root[vertex as usize] != vertex {
        root[vertex as usize] = root[root[vertex as usize] as usize];
        vertex = root[vertex as usize];
    }
    vertex
}
