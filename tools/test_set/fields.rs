//! Problems of smooth fields as the program makes them: planted bumps under noise, or two poles without data.

use std::error::Error;

use morsmooth::field::VertexOrder;
use morsmooth::mesh::{Domain, Grid, Mask, SimplicialComplex};
use morsmooth::monotone::{
    EdgeSet, EnergyWeights, Fitter, MonotoneConstraints, MonotonicityGraph, Operators, ValueRule, harmonic, levels,
    representative,
};
use morsmooth::morse::{Selection, Threshold, WantedExtrema};
use morsmooth::qp::Problem;
use morsmooth::smooth::{MeasuredField, select_extrema};

use super::problems::{Random, jittered_grid};

/// A problem with what a caller of the engine has at hand.
pub struct Made {
    pub problem: Problem,
    /// A place for each unknown.
    pub coordinates: Vec<[f64; 3]>,
    /// Where the solve begins: the minimiser without cones, or a strictly feasible point.
    pub start: Option<Vec<f64>>,
}

/// Smoothing length as a part of the diagonal, and margin as a part of what the levels rise: those of the program.
const LENGTH: f64 = 0.01;
const MARGIN: f64 = 1e-6;

/// The unit square with jittered points, `side x side` of them.
pub fn plane(side: usize, random: &mut Random) -> SimplicialComplex {
    let (points, triangles) = jittered_grid(side, 0.2, random);
    let scale = 1.0 / (side - 1) as f64;
    let points = points.into_iter().map(|p| p.map(|part| part * scale)).collect();
    SimplicialComplex::new(2, points, triangles.into_iter().flatten().collect()).expect("a grid is a complex")
}

/// `count` points on a line.
pub fn series(count: usize) -> SimplicialComplex {
    let points = (0..count).map(|i| [i as f64 / (count - 1) as f64, 0.0, 0.0]).collect();
    let edges = (1..count as u32).flat_map(|i| [i - 1, i]).collect();
    SimplicialComplex::new(1, points, edges).expect("a path is a complex")
}

/// A torus of `around x across` points with the radii 1 and 0.4, the tube swelling and shrinking three times.
pub fn torus(around: usize, across: usize) -> SimplicialComplex {
    let turn = std::f64::consts::TAU;
    let mut points = Vec::new();
    let mut triangles = Vec::new();
    for i in 0..around {
        for j in 0..across {
            let (u, v) = (turn * i as f64 / around as f64, turn * j as f64 / across as f64);
            let tube = 0.4 * (1.0 + 0.2 * (3.0 * u).sin() + 0.1 * (4.0 * v).cos());
            let far = 1.0 + tube * v.cos();
            points.push([far * u.cos(), far * u.sin(), tube * v.sin()]);
            let at = |i: usize, j: usize| ((i % around) * across + j % across) as u32;
            let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
            triangles.extend([a, b, c, a, c, d]);
        }
    }
    SimplicialComplex::new(2, points, triangles).expect("a torus is a complex")
}

/// A cube of `side³` points, as the program subdivides a grid.
pub fn volume(side: usize) -> SimplicialComplex {
    let step = 1.0 / (side - 1) as f64;
    let grid = Grid::image([side; 3], [0.0; 3], [step; 3]);
    Domain::from_grid(&grid, &Mask::none()).expect("a grid is a domain").complex
}

/// Bumps and dips at least `apart` from each other, under noise of standard deviation 0.1.
pub fn noisy(complex: &SimplicialComplex, bumps: usize, apart: f64, random: &mut Random) -> Vec<f64> {
    let points = complex.points();
    let distance = |a: [f64; 3], b: [f64; 3]| ((a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2) + (a[2] - b[2]).powi(2)).sqrt();
    let mut centres: Vec<([f64; 3], f64)> = Vec::new();
    while centres.len() < bumps {
        let centre = points[((random.unit() * points.len() as f64) as usize).min(points.len() - 1)];
        if centres.iter().all(|known| distance(known.0, centre) > apart) {
            let height = 0.5 + random.unit();
            centres.push((centre, if centres.len() % 3 < 2 { height } else { -height }));
        }
    }
    let bump = |p: [f64; 3], (centre, height): &([f64; 3], f64)| height * (-(distance(p, *centre) / (0.45 * apart)).powi(2)).exp();
    points.iter().map(|&p| centres.iter().map(|centre| bump(p, centre)).sum::<f64>() + 0.1 * random.normal()).collect()
}

/// The problem of smoothing noisy data to the extrema that are prominent in the unconstrained smooth field; their values are kept.
///
/// The order of the vertices is that of the minimiser pinned at these extrema, simplified.
///
/// # Arguments
/// * `threshold`: persistence of what is prominent, as a part of the range.
pub fn smoothing(complex: &SimplicialComplex, data: &[f64], order: usize, threshold: f64) -> Result<Made, Box<dyn Error>> {
    let operators = Operators::new(complex)?;
    let mut fitter = Fitter::new(complex, &operators, order)?;
    let length = LENGTH * complex.bounding_box_diagonal();
    let weights = EnergyWeights { order, length, confidence: None, smoothness: None };
    let measured = MeasuredField::new(complex, fitter.minimiser(data, &weights, &vec![None; data.len()])?)?;
    let wanted = select_extrema(complex, &measured, &Selection::Threshold(Threshold::Fraction(threshold)))?.wanted;
    let pins = pins(complex, &wanted, |vertex| measured.values[vertex]);
    let pinned = fitter.minimiser(data, &weights, &pins)?;
    let representative = representative(complex, &VertexOrder::of_values(&pinned)?, &wanted)?.order;
    constrained(&fitter, (data, &weights), (&wanted, &pins, &representative), &pinned)
}

/// The smoothest field with one minimum of value 0 and one maximum of value 1, ordered by a harmonic function.
pub fn without_data(complex: &SimplicialComplex, order: usize) -> Result<Made, Box<dyn Error>> {
    let operators = Operators::new(complex)?;
    let mut fitter = Fitter::new(complex, &operators, order)?;
    let n = complex.vertex_count();
    let none = vec![0.0; n];
    let weights = EnergyWeights { order, length: 1.0, confidence: Some(&none), smoothness: None };
    let nearest = |x: f64, y: f64| {
        let far = |v: &usize| (complex.points()[*v][0] - x).hypot(complex.points()[*v][1] - y);
        (0..n).min_by(|a, b| far(a).total_cmp(&far(b))).unwrap_or(0)
    };
    let wanted = WantedExtrema { minima: vec![nearest(0.27, 0.31).into()], maxima: vec![nearest(0.71, 0.66).into()] };
    let pins = pins(complex, &wanted, |vertex| if wanted.maxima[0].index() == vertex { 1.0 } else { 0.0 });
    // The data weigh nothing; they only set the unit of the values to 1.
    let mut data = vec![0.0; n];
    data[wanted.maxima[0].index()] = 1.0;
    let pinned = fitter.minimiser(&data, &weights, &pins)?;
    let representative = harmonic(complex, &wanted)?.order;
    constrained(&fitter, (&data, &weights), (&wanted, &pins, &representative), &pinned)
}

fn pins(complex: &SimplicialComplex, wanted: &WantedExtrema, value: impl Fn(usize) -> f64) -> Vec<Option<f64>> {
    let mut pins = vec![None; complex.vertex_count()];
    wanted.minima.iter().chain(&wanted.maxima).for_each(|vertex| pins[vertex.index()] = Some(value(vertex.index())));
    pins
}

fn constrained(
    fitter: &Fitter<'_>,
    (data, weights): (&[f64], &EnergyWeights<'_>),
    (wanted, pins, order): (&WantedExtrema, &[Option<f64>], &VertexOrder),
    pinned: &[f64],
) -> Result<Made, Box<dyn Error>> {
    let complex = fitter.complex();
    let graph = MonotonicityGraph::new(complex, order, wanted, EdgeSet::Minimal);
    let rules: Vec<ValueRule> = pins.iter().map(|pin| pin.map_or(ValueRule::Free, ValueRule::Exactly)).collect();
    let values = pins.iter().flatten();
    let range = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &v| (low.min(v), high.max(v)));
    let levels = levels(&graph, &rules, range).map_err(|found| format!("the order contradicts the values: {found:?}"))?;
    let constraints = MonotoneConstraints { graph: &graph, levels: &levels, rules: &rules, margin: MARGIN, feasible: None };
    let fit = fitter.problem(data, weights, &constraints, pinned)?;
    Ok(Made { problem: fit.problem, coordinates: complex.points().to_vec(), start: Some(fit.start) })
}
