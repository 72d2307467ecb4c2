//! Functions of least energy within bounds.
//!
//! Literature: Jacobson, Baran, Popović, Sorkine 2011, *Bounded biharmonic weights for real-time deformation*; Hintermüller, Ito, Kunisch
//! 2002, *The primal-dual active set strategy as a semismooth Newton method*.

use crate::linalg::CsrMatrix;
use crate::qp::{Constraints, Engine, Minimum, Objective, Problem, QpError, Settings, Solution};

use super::InterpolateError;
use super::boundary::range;
use super::method::InterpolateOptions;

/// Most changes of the active set before the interior point takes over. Where the set settles at all, it does so in 3 to 10.
const MOST_CHANGES: usize = 14;
/// Orders up to which the active set settles as a rule.
const SETTLING_ORDER: usize = 2;
/// A value of the interior point this near to a bound, as part of the distance of the bounds, lies on it.
const ON_BOUND: f64 = 1e-6;
/// A value this far beyond a bound is on it.
const ROUNDING: f64 = 1e-12;

/// How the bounded function was found.
pub(super) enum Ending {
    /// By its active set: exact.
    Settled(Minimum),
    /// By the interior point.
    Interior(Box<Solution>),
}

/// A function within bounds.
pub(super) struct Bounded {
    pub values: Vec<f64>,
    pub rows: usize,
    pub active: usize,
    pub iterations: usize,
    pub ending: Ending,
}

/// Where a value is held.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Side {
    Inside,
    Low,
    High,
}

/// The problem of one function.
pub(super) struct Box01<'a> {
    pub objective: &'a Objective,
    pub order: usize,
    /// Values on the scale on which the bounds are 0 and 1.
    pub fixed: Vec<Option<f64>>,
    pub low: f64,
    pub unit: f64,
    pub options: &'a InterpolateOptions,
}

impl<'a> Box01<'a> {
    pub fn new(
        objective: &'a Objective,
        order: usize,
        fixed: &[Option<f64>],
        options: &'a InterpolateOptions,
    ) -> Result<Self, InterpolateError> {
        let (low, high) = options.bounds.unwrap_or_else(|| range(fixed));
        if let Some((vertex, value)) = fixed.iter().enumerate().find_map(|(vertex, value)| {
            value.filter(|&value| value < low || value > high).map(|value| (vertex.into(), value))
        }) {
            return Err(InterpolateError::OutsideBounds { vertex, value, low, high });
        }
        let unit = if high > low { high - low } else { 1.0 };
        let fixed = fixed.iter().map(|value| value.map(|value| (value - low) / unit)).collect();
        Ok(Self { objective, order, fixed, low, unit, options })
    }

    /// # Arguments
    /// * `near`: the minimiser without bounds.
    pub fn solve(&self, engine: &mut Engine, near: &[f64]) -> Result<Bounded, InterpolateError> {
        let start: Vec<f64> = near.iter().map(|&value| (value - self.low) / self.unit).collect();
        let rows = 2 * self.fixed.iter().filter(|value| value.is_none()).count();
        if self.order <= SETTLING_ORDER && let Some((minimum, iterations)) = self.active_set(engine, &start)? {
            let values = self.values(&minimum.x, 0.0);
            let active = self.fixed.iter().zip(&minimum.x).filter(|(fixed, x)| fixed.is_none() && (**x == 0.0 || **x == 1.0)).count();
            return Ok(Bounded { values, rows, active, iterations, ending: Ending::Settled(minimum) });
        }
        let solution = self.interior_point(engine, &start)?;
        let polished = self.polished(engine, &solution)?;
        let values = match &polished {
            Some(x) => self.values(x, 0.0),
            None => self.values(&solution.x, ON_BOUND),
        };
        let active = solution.slack.iter().zip(&solution.dual).filter(|(slack, dual)| slack < dual).count();
        Ok(Bounded { values, rows, active, iterations: solution.iterations, ending: Ending::Interior(Box::new(solution)) })
    }

    fn values(&self, x: &[f64], on_bound: f64) -> Vec<f64> {
        let value = |x: f64| match x {
            x if x <= on_bound => self.low,
            x if x >= 1.0 - on_bound => self.low + self.unit,
            x => self.options.precision.round(self.low + self.unit * x),
        };
        x.iter().map(|&x| value(x)).collect()
    }

    /// The minimiser held at the bounds where it wants to leave them, by changing the set of such places until it no longer changes;
    /// `None` if that does not happen soon.
    fn active_set(&self, engine: &mut Engine, start: &[f64]) -> Result<Option<(Minimum, usize)>, QpError> {
        let n = start.len();
        let mut side = vec![Side::Inside; n];
        let mut minimum: Option<Minimum> = None;
        let mut gradient = vec![0.0; n];
        for change in 0..MOST_CHANGES {
            let x = minimum.as_ref().map_or(start, |minimum| &minimum.x);
            let next: Vec<Side> = (0..n)
                .map(|i| match (self.fixed[i], side[i]) {
                    (Some(_), _) => Side::Inside,
                    // A held value stays held as long as the energy pulls it outwards.
                    (None, Side::Low) if gradient[i] > 0.0 => Side::Low,
                    (None, Side::High) if gradient[i] < 0.0 => Side::High,
                    (None, Side::Inside) if x[i] < 0.0 => Side::Low,
                    (None, Side::Inside) if x[i] > 1.0 => Side::High,
                    _ => Side::Inside,
                })
                .collect();
            if let Some(found) = minimum.take_if(|_| next == side) {
                return Ok(Some((found, change)));
            }
            side = next;
            let held = self.fixed.iter().zip(&side).map(|(fixed, side)| match side {
                Side::Inside => *fixed,
                Side::Low => Some(0.0),
                Side::High => Some(1.0),
            });
            let held: Vec<Option<f64>> = held.collect();
            let found = engine.minimise(self.objective, &held)?;
            self.objective.gradient_into(&found.x, &mut gradient);
            minimum = Some(found);
        }
        Ok(None)
    }

    /// The minimiser with what the interior point pressed against the bounds held there, and whatever leaves them then: exact where it is
    /// held, smooth elsewhere. `None` if something keeps leaving.
    fn polished(&self, engine: &mut Engine, solution: &Solution) -> Result<Option<Vec<f64>>, QpError> {
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
        // Slacks and duals have different units; their means are of one size at the centre.
        let unit = mean(&solution.dual) / mean(&solution.slack).max(f64::MIN_POSITIVE);
        let mut held = self.fixed.clone();
        let free = (0..held.len()).filter(|&vertex| self.fixed[vertex].is_none());
        for (place, vertex) in free.enumerate() {
            let is_pressed = |row: usize| solution.slack[row] < ON_BOUND && solution.dual[row] > unit * solution.slack[row];
            if is_pressed(2 * place) {
                held[vertex] = Some(0.0);
            } else if is_pressed(2 * place + 1) {
                held[vertex] = Some(1.0);
            }
        }
        for _ in 0..MOST_CHANGES {
            let x = engine.minimise(self.objective, &held)?.x;
            let mut worst: f64 = 0.0;
            for (held, &x) in held.iter_mut().zip(&x).filter(|(held, _)| held.is_none()) {
                worst = worst.max(-x).max(x - 1.0);
                if x < 0.0 {
                    *held = Some(0.0);
                } else if x > 1.0 {
                    *held = Some(1.0);
                }
            }
            if worst <= ROUNDING {
                return Ok(Some(x));
            }
        }
        Ok(None)
    }

    fn interior_point(&self, engine: &mut Engine, start: &[f64]) -> Result<Solution, InterpolateError> {
        let (mut triplets, mut offset) = (Vec::new(), Vec::new());
        for vertex in (0..start.len() as u32).filter(|&vertex| self.fixed[vertex as usize].is_none()) {
            triplets.extend([(offset.len() as u32, vertex, 1.0), (offset.len() as u32 + 1, vertex, -1.0)]);
            offset.extend([0.0, 1.0]);
        }
        let matrix = CsrMatrix::from_triplets(offset.len(), start.len(), &triplets)?;
        let problem = Problem {
            objective: self.objective.clone(),
            fixed: self.fixed.clone(),
            constraints: Constraints::nonnegative(matrix, offset),
        };
        let settings = Settings { relative_gap: self.options.relative_gap, ..Settings::default() };
        Ok(engine.solve(&problem, Some(start), &settings, &mut |_| {})?)
    }
}
