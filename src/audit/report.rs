//! The verdict: extrema found against extrema wanted.

use crate::field::{FieldError, VertexId};
use crate::mesh::SimplicialComplex;

use super::extrema::{extrema, strict_extrema};

/// What the value of a wanted extremum has to be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ValueRule {
    /// This value, bit for bit up to the sign of zero.
    Exactly(f64),
    /// Not less than the first and not greater than the second.
    Within(f64, f64),
}

impl ValueRule {
    /// Whether a value obeys the rule; a value that is not a number obeys none.
    pub fn allows(self, value: f64) -> bool {
        match self {
            Self::Exactly(expected) => value == expected,
            Self::Within(low, high) => low <= value && value <= high,
        }
    }
}

/// Whether equal neighbours matter to the verdict.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Plateaus {
    /// A plateau fails the audit: plain `<` and (value, index) order must see the same extrema.
    #[default]
    Refused,
    /// Plateaus are reported but do not fail the audit.
    Allowed,
}

/// What a field is asked to be.
#[derive(Debug, Clone, Copy, Default)]
pub struct Wanted<'a> {
    /// All its minima, in any order, each with a rule for its value if there is one.
    pub minima: &'a [(VertexId, Option<ValueRule>)],
    /// All its maxima, likewise.
    pub maxima: &'a [(VertexId, Option<ValueRule>)],
    /// Whether plateaus fail the audit.
    pub plateaus: Plateaus,
}

/// What an extremum was found or asked to be.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ExtremumType {
    /// No neighbour is below.
    Minimum,
    /// No neighbour is above.
    Maximum,
}

/// Defects of one sort: how many, and the first of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Defects<T> {
    /// How many there are.
    pub count: usize,
    /// At most [`LISTED_DEFECTS`] of them; minima before maxima, by rising vertex.
    pub first: Vec<T>,
}

/// How many defects of one sort an [`AuditReport`] lists.
pub const LISTED_DEFECTS: usize = 100;

impl<T> Defects<T> {
    pub(super) fn of(mut all: Vec<T>) -> Self {
        let count = all.len();
        all.truncate(LISTED_DEFECTS);
        Self { count, first: all }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }
}

/// A wanted extremum whose value breaks its rule.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MovedValue {
    /// The vertex.
    pub vertex: VertexId,
    /// The value found.
    pub found: f64,
    /// The rule for it.
    pub rule: ValueRule,
}

/// The outcome of an audit.
#[derive(Debug, Clone, PartialEq)]
pub struct AuditReport {
    /// Whether the field is exactly what was asked for: nothing missing, nothing spurious, no value moved, and no
    /// plateau unless those are allowed.
    pub passed: bool,
    /// Number of minima in (value, index) order.
    pub found_minima: usize,
    /// Number of maxima in (value, index) order.
    pub found_maxima: usize,
    /// Wanted extrema that are none, or of the other kind.
    pub missing: Defects<(VertexId, ExtremumType)>,
    /// Extrema that are not wanted.
    pub spurious: Defects<(VertexId, ExtremumType)>,
    /// Wanted extrema whose value breaks its rule.
    pub moved_values: Defects<MovedValue>,
    /// Vertices on which plain `<` and `<=` disagree.
    pub plateaus: Defects<VertexId>,
}

/// Compares the extrema of a field with the wanted ones.
///
/// The extrema are counted from the values alone, by lower links, in (value, vertex index) order and under plain `<`;
/// nothing that produced the field is used.
///
/// # Arguments
/// * `complex`: `n` vertices, any dimension.
/// * `values`: `n` values as they are stored: widened from single precision if that is how they are written.
/// * `wanted`: all extrema that the field may and must have. An extremum named twice is named once, with both rules;
///   a vertex that does not exist is missing.
///
/// # Errors
/// [`FieldError`] if there are not `n` values or one is not finite.
///
/// # Cost
/// Linear in the number of top simplices, and a sort of the wanted extrema.
///
/// # Example
/// ```
/// use morsmooth::audit::{ValueRule, Wanted, audit};
/// use morsmooth::field::VertexId;
/// use morsmooth::mesh::SimplicialComplex;
/// let line = SimplicialComplex::new(1, vec![[0.0; 3]; 4], vec![0, 1, 1, 2, 2, 3])?;
/// let minima = [(VertexId(0), Some(ValueRule::Exactly(0.0)))];
/// let maxima = [(VertexId(3), None)];
/// let wanted = Wanted { minima: &minima, maxima: &maxima, ..Wanted::default() };
/// assert!(audit(&line, &[0.0, 1.0, 2.0, 3.0], &wanted)?.passed);
/// let report = audit(&line, &[0.0, 2.0, 1.0, 3.0], &wanted)?;
/// assert_eq!((report.passed, report.spurious.count), (false, 2));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn audit(complex: &SimplicialComplex, values: &[f64], wanted: &Wanted<'_>) -> Result<AuditReport, FieldError> {
    let found = extrema(complex, values)?;
    let plateaus = strict_extrema(complex, values)?.plateaus;
    let (mut missing, mut spurious, mut moved) = (Vec::new(), Vec::new(), Vec::new());
    for (kind, found, wanted) in
        [(ExtremumType::Minimum, &found.minima, wanted.minima), (ExtremumType::Maximum, &found.maxima, wanted.maxima)]
    {
        let mut asked: Vec<VertexId> = wanted.iter().map(|&(vertex, _)| vertex).collect();
        asked.sort_unstable();
        asked.dedup();
        let outside = |of: &[VertexId], all: &[VertexId]| -> Vec<(VertexId, ExtremumType)> {
            let absent = of.iter().filter(|vertex| all.binary_search(vertex).is_err());
            absent.map(|&vertex| (vertex, kind)).collect()
        };
        missing.extend(outside(&asked, found));
        spurious.extend(outside(found, &asked));
        let ruled: Vec<(VertexId, ValueRule)> = wanted.iter().filter_map(|&(vertex, rule)| Some((vertex, rule?))).collect();
        moved.extend(broken_rules(values, &ruled));
    }
    let tolerated = plateaus.is_empty() || wanted.plateaus == Plateaus::Allowed;
    Ok(AuditReport {
        passed: missing.is_empty() && spurious.is_empty() && moved.is_empty() && tolerated,
        found_minima: found.minima.len(),
        found_maxima: found.maxima.len(),
        missing: Defects::of(missing),
        spurious: Defects::of(spurious),
        moved_values: Defects::of(moved),
        plateaus: Defects::of(plateaus),
    })
}

/// The values that break their rules, whether or not their vertices are extrema.
///
/// # Arguments
/// * `values`: `n` values as they are stored.
/// * `rules`: what is asked of some of them; a vertex that does not exist breaks nothing.
///
/// # Cost
/// Linear in the number of rules, and a sort of the broken ones.
pub fn moved_values(values: &[f64], rules: &[(VertexId, ValueRule)]) -> Defects<MovedValue> {
    Defects::of(broken_rules(values, rules))
}

fn broken_rules(values: &[f64], rules: &[(VertexId, ValueRule)]) -> Vec<MovedValue> {
    let mut broken: Vec<MovedValue> = rules
        .iter()
        .filter_map(|&(vertex, rule)| Some((vertex, rule, *values.get(vertex.index())?)))
        .filter(|&(_, rule, found)| !rule.allows(found))
        .map(|(vertex, rule, found)| MovedValue { vertex, found, rule })
        .collect();
    broken.sort_by_key(|moved| moved.vertex);
    broken
}
