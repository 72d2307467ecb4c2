//! All handles in one problem: monotone weights that sum to one.
//!
//! The last handle's weights are one minus those of the others, `w_h = 1 - w_1 - ... - w_m`, m = h - 1. Its energy couples the others,
//!
//! ```text
//! sum_j E_k(w_j) + E_k(w_1 + ... + w_m)  =  1/2 xᵀ ((I + J) ⊗ Q) x,    J = 1 1ᵀ
//! ```
//!
//! and its monotonicity edges are rows over all of them. `(I + J) ⊗ L (M⁻¹ L)^(k-1)` is again a chain, with the stiffness `B ⊗ L` and
//! `B^k = I + J`, so that it is multiplied through like any other and never trusted in formed shape. The factor has about m² times the
//! entries of a single handle's.

use crate::field::VertexId;
use crate::linalg::CsrMatrix;
use crate::monotone::{Strictness, repair};
use crate::qp::{Constraints, Engine, KktForm, Objective, Problem, Settings, Term};

use super::contraction::Contraction;
use super::controlled::{Controlled, Directions};
use super::interpolator::{InterpolateReport, Interpolated, Interpolator};
use super::method::InterpolateOptions;
use super::{BoundaryValues, InterpolateError};

/// Largest factor that is tried: 3 GB.
const MOST_ENTRIES: usize = 400_000_000;

/// Margins of the rows, as parts of what the harmonic weights rise by along them.
const MARGIN: f64 = 1e-6;

/// Monotone weights that sum to one up to the repair of the last digits.
pub(super) fn coupled(
    interpolator: &mut Interpolator<'_>,
    given: &[BoundaryValues],
    options: &InterpolateOptions,
) -> Result<Vec<Interpolated>, InterpolateError> {
    let (handles, free) = (given.len(), given.len().saturating_sub(1));
    if handles < 2 {
        return interpolator.solve_each(super::Method::Monotone, given, options);
    }
    let entries = interpolator.factor_entries().saturating_mul(free * free);
    if entries > MOST_ENTRIES {
        return Err(InterpolateError::TooLarge { handles, entries, limit: MOST_ENTRIES });
    }
    let parts = interpolator.parts(given)?;
    let n = interpolator.complex().vertex_count();
    let mut contractions = Vec::with_capacity(handles);
    for (fixed, (given, harmonic)) in parts.fixed.iter().zip(given.iter().zip(&parts.harmonic)) {
        contractions.push(Contraction::new(interpolator.complex(), fixed, harmonic, given.wanted.as_ref())?);
    }
    let fixed = &parts.fixed;
    for vertex in 0..n {
        let count = fixed.iter().filter(|fixed| fixed[vertex].is_some()).count();
        let sum: f64 = fixed.iter().filter_map(|fixed| fixed[vertex]).sum();
        if count > 0 && (count < handles || (sum - 1.0).abs() > 1e-12) {
            return Err(InterpolateError::NoPartition { vertex: vertex.into(), sum });
        }
    }
    // The handle that is left out must have no constant part: that would be an equation between the others.
    let Some(last) = (0..handles).rev().find(|&handle| contractions[handle].constant == 0) else {
        return Err(InterpolateError::Count { what: "handles that reach every part of the mesh", found: 0, expected: 1 });
    };
    let column: Vec<Option<usize>> = (0..handles).map(|handle| (handle != last).then(|| handle - usize::from(handle > last))).collect();

    let objective = coupled_objective(interpolator.smooth(), free)?;
    let points: Vec<[f64; 3]> = interpolator.complex().points().iter().flat_map(|&point| std::iter::repeat_n(point, free)).collect();
    let form = if interpolator.is_mixed() { KktForm::Mixed } else { KktForm::Automatic };
    let mut engine = Engine::in_form(&objective, None, Some(&points), form)?;

    let controlled: Vec<Controlled<'_>> =
        contractions.iter().map(|contraction| Controlled::new(contraction, interpolator.smooth(), options)).collect();
    let mut directions: Vec<Directions> = Vec::with_capacity(handles);
    for (controlled, harmonic) in controlled.iter().zip(&parts.harmonic) {
        // Only along the harmonic weights' own order is it certain that monotone weights sum to one.
        directions.push(controlled.directions(harmonic, harmonic)?);
    }

    let mut held = vec![None; n * free];
    let mut start = vec![0.0; n * free];
    for (handle, place) in column.iter().enumerate().filter_map(|(handle, place)| Some((handle, (*place)?))) {
        let contraction = &contractions[handle];
        for vertex in 0..n {
            held[vertex * free + place] = contraction.fixed[contraction.node[vertex] as usize];
            start[vertex * free + place] = parts.pinned[handle][vertex];
        }
    }
    let unknown = |vertex: VertexId, place: usize| (vertex.index() * free + place) as u32;
    let (mut triplets, mut offset) = (Vec::new(), Vec::new());
    for (handle, contraction) in contractions.iter().enumerate() {
        for edge in directions[handle].graph.edges() {
            let (low, high) = (edge.low.index(), edge.high.index());
            if contraction.fixed[low].is_some() && contraction.fixed[high].is_some() {
                continue;
            }
            let ends = nearest_ends(interpolator, contraction, [edge.low, edge.high]);
            let row = offset.len() as u32;
            for (vertex, sign) in ends.into_iter().zip([-1.0, 1.0]) {
                match column[handle] {
                    Some(place) => triplets.push((row, unknown(vertex, place), sign)),
                    None => triplets.extend((0..free).map(|place| (row, unknown(vertex, place), -sign))),
                }
            }
            let rise = parts.harmonic[handle][ends[1].index()] - parts.harmonic[handle][ends[0].index()];
            offset.push(-(MARGIN * rise).max(0.0));
        }
    }
    let matrix = CsrMatrix::from_triplets(offset.len(), n * free, &triplets)?;
    let problem = Problem { objective, fixed: held, constraints: Constraints::nonnegative(matrix, offset) };
    let settings = Settings { relative_gap: options.relative_gap, ..Settings::default() };
    let clock = std::time::Instant::now();
    let solution = engine.solve(&problem, Some(&start), &settings, &mut |_| {})?;
    let seconds = clock.elapsed().as_secs_f64() / handles as f64;

    let mut found = Vec::with_capacity(handles);
    for (handle, contraction) in contractions.iter().enumerate() {
        let value = |vertex: usize| match column[handle] {
            Some(place) => solution.x[vertex * free + place],
            None => 1.0 - solution.x[vertex * free..(vertex + 1) * free].iter().sum::<f64>(),
        };
        let nodes: Vec<f64> = contraction.member.iter().map(|vertex| value(vertex.index())).collect();
        let repaired = repair(&directions[handle].graph, &nodes, &controlled[handle].rules, options.precision, Strictness::Plain)
            .map_err(|found| InterpolateError::NotRepresentable { vertex: contraction.member[found.vertex.index()] })?;
        let values = contraction.spread(&repaired.values);
        let members = |nodes: &[VertexId]| nodes.iter().map(|node| contraction.member[node.index()]).collect();
        let report = InterpolateReport {
            energy: interpolator.energy(&values),
            status: solution.status.clone(),
            residual: solution.kkt.backward,
            gap: solution.kkt.duality_gap,
            rows: solution.slack.len(),
            iterations: solution.iterations,
            factorizations: solution.factorizations,
            minima: members(&contraction.wanted.minima),
            maxima: members(&contraction.wanted.maxima),
            constant: contraction.constant,
            guide_replaced: directions[handle].replaced,
            largest_repair: repaired.largest_move,
            seconds,
            ..InterpolateReport::solved()
        };
        found.push(Interpolated { values, report });
    }
    Ok(found)
}

/// Vertices of two nodes that are neighbours in the mesh: rows lie inside the pattern then.
fn nearest_ends(interpolator: &Interpolator<'_>, contraction: &Contraction, [low, high]: [VertexId; 2]) -> [VertexId; 2] {
    let [a, b] = [low, high].map(|node| contraction.member[node.index()]);
    let beside = |vertex: VertexId, node: VertexId| {
        let neighbours = interpolator.complex().neighbours(vertex);
        neighbours.iter().copied().find(|neighbour| contraction.node[neighbour.index()] == node.0)
    };
    // Only nodes with a value have several vertices, and no row has two of those.
    match (contraction.fixed[low.index()].is_some(), contraction.fixed[high.index()].is_some()) {
        (true, _) => [beside(b, low).unwrap_or(a), b],
        (_, true) => [a, beside(a, high).unwrap_or(b)],
        _ => [a, b],
    }
}

/// `(I + J) ⊗ L (M⁻¹ L)^(k-1)` as a chain; the unknowns of a vertex lie together.
fn coupled_objective(single: &Objective, free: usize) -> Result<Objective, InterpolateError> {
    let [Term::Chain { scale, stiffness, weights, order }] = &single.terms[..] else {
        return Ok(single.clone());
    };
    let m = free as f64;
    // B = (I + J)^(1/k): 1 on what is orthogonal to the ones, (1 + m)^(1/k) on the ones.
    let shared = ((1.0 + m).powf(1.0 / *order as f64) - 1.0) / m;
    let n = stiffness.rows();
    let mut triplets = Vec::with_capacity(stiffness.entries() * free * free);
    for row in 0..n {
        let (columns, values) = stiffness.row(row);
        for (&column, &value) in columns.iter().zip(values) {
            for i in 0..free {
                for j in 0..free {
                    let factor = if i == j { 1.0 + shared } else { shared };
                    triplets.push(((row * free + i) as u32, column * free as u32 + j as u32, factor * value));
                }
            }
        }
    }
    let stiffness = CsrMatrix::from_triplets(n * free, n * free, &triplets)?;
    let weights = weights.iter().flat_map(|&weight| std::iter::repeat_n(weight, free)).collect();
    let term = Term::Chain { scale: *scale, stiffness, weights, order: *order };
    Ok(Objective { terms: vec![term], linear: vec![0.0; n * free], constant: 0.0 })
}
