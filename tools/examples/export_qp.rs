//! The quadratic problem behind one run of `morsmooth smooth`, and its solution, in files that any solver can read.
//!
//!     cargo run --release --example export_qp -- FIELD.vti FOLDER array=NAME [mask=NAME] [persistence=0.2]
//!         [select=data|smooth] [order=2] [length=0.01] [gap=1e-8] [solve=yes|no]
//!
//! `length` is a part of the diagonal. Writes
//!
//!     P.mtx         the quadratic form, formed          n x n, symmetric
//!     L.mtx         the stiffness of its product form   P = scale L (diag(weights) L)^(order - 1) + diag(diagonal)
//!     A.mtx         the rows                            m x n
//!     problem.json  linear (q), constant, fixed, offset (b); scale, weights, order, diagonal; and the solution:
//!                   x, dual, objective, status, the residuals that it reports, iterations and seconds
//!
//! for `minimise 1/2 xᵀ P x + qᵀ x + constant subject to x_i = fixed_i, A x + b >= 0`, over `x = (field - shift) / unit`.
#![allow(clippy::print_stderr)]

#[path = "../test_set/export.rs"]
#[allow(dead_code)]
mod export;

use std::collections::HashMap;
use std::error::Error;
use std::path::Path;

use morsmooth::field::{Precision, VertexOrder};
use morsmooth::io::{ArrayData, MaskSources, domain, mask, read};
use morsmooth::monotone::{
    EdgeSet, EnergyWeights, Fitter, MonotoneConstraints, MonotonicityGraph, Operators, ValueRule, levels,
    representative,
};
use morsmooth::morse::{Selection, Threshold};
use morsmooth::qp::{Engine, Settings};
use morsmooth::smooth::{MeasuredField, select_extrema};
use serde_json::Value;

use export::Formed;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [input, folder, options @ ..] = arguments.as_slice() else {
        return Err("usage: export_qp FIELD.vti FOLDER array=NAME [NAME=VALUE ...]".into());
    };
    let mut given = HashMap::new();
    for option in options {
        let (name, value) = option.split_once('=').ok_or_else(|| format!("found {option}; expected NAME=VALUE"))?;
        given.insert(name, value);
    }
    let text = |name: &str, default: &'static str| given.get(name).copied().unwrap_or(default);
    let number = |name: &str, default: &'static str| text(name, default).parse::<f64>();

    let dataset = read(Path::new(input))?;
    let name = given.get("array").ok_or("expected array=NAME")?.to_string();
    let sources = MaskSources { array: given.get("mask").map(|name| name.to_string()), holes: vec![name.clone()], ghosts: true };
    let domain = domain(&dataset, &mask(&dataset, &sources)?)?;
    let array = dataset.point_array(&name).ok_or("the file has no such point array")?;
    let precision = if matches!(array.data, ArrayData::F32(_)) { Precision::F32 } else { Precision::F64 };
    let (data, complex) = (domain.restrict(&array.to_f64(0)), &domain.complex);

    let operators = Operators::new(complex)?;
    let order: usize = text("order", "2").parse()?;
    let mut fitter = Fitter::new(complex, &operators, order)?;
    let weights = EnergyWeights {
        order,
        length: number("length", "0.01")? * complex.bounding_box_diagonal(),
        confidence: None,
        smoothness: None,
    };
    let field = match text("select", "data") {
        "data" => data.clone(),
        "smooth" => fitter.minimiser(&data, &weights, &vec![None; data.len()])?,
        other => return Err(format!("found select={other}; expected data or smooth").into()),
    };
    let measured = MeasuredField::new(complex, field)?;
    let threshold = Selection::Threshold(Threshold::Fraction(number("persistence", "0.2")?));
    let wanted = select_extrema(complex, &measured, &threshold)?.wanted;
    let mut rules = vec![ValueRule::Free; data.len()];
    let mut pins = vec![None; data.len()];
    for vertex in wanted.minima.iter().chain(&wanted.maxima) {
        let value = precision.round(measured.values[vertex.index()]);
        rules[vertex.index()] = ValueRule::Exactly(value);
        pins[vertex.index()] = Some(value);
    }
    let pinned = fitter.minimiser(&data, &weights, &pins)?;
    // Rounding to the stored width may have moved the greatest value beyond the range.
    let range = pins.iter().flatten().fold(measured.range(), |(low, high), &value| (low.min(value), high.max(value)));
    // As the program does: the pinned field, simplified; if that order contradicts the wanted values, the selected field.
    let guide = |order: &VertexOrder| -> Result<_, Box<dyn Error>> {
        let graph = MonotonicityGraph::new(complex, &representative(complex, order, &wanted)?.order, &wanted, EdgeSet::Minimal);
        let levels = levels(&graph, &rules, range).map_err(|found| format!("the order contradicts the values: {found:?}"))?;
        Ok((graph, levels))
    };
    let (graph, levels) = guide(&VertexOrder::of_values(&pinned)?).or_else(|_| guide(&measured.order))?;
    // The margins of the program: a part of what the levels rise, so that rounding to the stored width leaves no ties.
    let margin = if precision == Precision::F32 { 1e-4 } else { 1e-6 };
    let constraints = MonotoneConstraints { graph: &graph, levels: &levels, rules: &rules, margin, feasible: None };
    let fit = fitter.problem(&data, &weights, &constraints, &pinned)?;

    let settings = Settings { relative_gap: number("gap", "1e-8")?, ..Settings::default() };
    let solution = match text("solve", "yes") {
        "no" => None,
        _ => {
            let mut engine = Engine::new(&fit.problem.objective, None, Some(complex.points()))?;
            Some(engine.solve(&fit.problem, Some(&fit.start), &settings, &mut |_| ())?)
        }
    };
    std::fs::create_dir_all(folder)?;
    let more = [("solution", solution.as_ref().map_or(Value::Null, export::solution))];
    export::write(Path::new(folder), &fit.problem, Formed::Yes, &more)?;
    eprintln!(
        "{} unknowns, {} fixed, {} rows{}",
        fit.start.len(),
        fit.problem.fixed.iter().flatten().count(),
        fit.problem.constraints.offset.len(),
        solution.map_or(String::new(), |solution| format!(
            "; {:?}, {} iterations, {:.3} s, gap {:.1e}",
            solution.status, solution.iterations, solution.timings.total, solution.kkt.duality_gap
        ))
    );
    Ok(())
}
