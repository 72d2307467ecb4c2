//! How many elements a pose turned inside out, counted by exact predicates on the positions of the file.

use morsmooth::audit::{OrientationReport, orientations};
use morsmooth::deform::RestShape;
use morsmooth::field::Precision;
use morsmooth::mesh::Domain;
use serde_json::{Value, json};

use crate::common::number::short;

/// Inverted elements told by number, at most.
const NAMED: usize = 20;
/// Heights this far apart, as a part of the extent, are no plane any more.
const FLAT: f64 = 1e-12;

/// What was counted.
pub enum Inversions {
    /// Elements that are inverted or flat.
    Counted {
        /// Cells of the file that have one, rising.
        cells: Vec<u32>,
        /// How many elements.
        count: usize,
        /// det F of every element, of its exact sign.
        determinants: Vec<f64>,
        /// The smallest det F.
        smallest: f64,
    },
    /// They could not be counted; why.
    Unknown(String),
}

/// Counts the inverted elements of a domain.
///
/// # Arguments
/// * `places`: a place for every point of the file.
pub fn inversions(domain: &Domain, places: &[[f64; 3]]) -> Inversions {
    let rest = match RestShape::new(&domain.complex) {
        Ok(rest) => rest,
        Err(error) => return Inversions::Unknown(error.to_string()),
    };
    let moved: Vec<[f64; 3]> = domain.point_of_vertex().iter().map(|&point| places[point as usize]).collect();
    let dimension = rest.dimension();
    if dimension == 2 {
        let height = moved.iter().map(|place| (place[2] - moved[0][2]).abs()).fold(0.0, f64::max);
        if height > FLAT * domain.complex.bounding_box_diagonal() {
            return Inversions::Unknown(format!("the pose leaves the plane, by up to {}", short(height)));
        }
    }
    let positions: Vec<f64> = moved.iter().flat_map(|place| place[..dimension].iter().copied()).collect();
    let report = match orientations(&domain.complex, &[], &moved, Precision::F64) {
        Ok(report) => report,
        Err(error) => return Inversions::Unknown(error.to_string()),
    };
    match rest.determinants(&positions) {
        Ok(determinants) => {
            let mut cells: Vec<u32> =
                report.inverted.iter().chain(&report.degenerate).map(|&element| domain.cell_of_simplex()[element]).collect();
            cells.sort_unstable();
            cells.dedup();
            let count = report.inverted.len() + report.degenerate.len();
            Inversions::Counted { cells, count, smallest: report.smallest, determinants: signed(determinants, &report) }
        }
        Err(error) => Inversions::Unknown(error.to_string()),
    }
}

/// Rounded determinants with the signs that are true.
fn signed(mut determinants: Vec<f64>, report: &OrientationReport) -> Vec<f64> {
    for (element, determinant) in determinants.iter_mut().enumerate() {
        *determinant = if report.degenerate.binary_search(&element).is_ok() {
            0.0
        } else if report.inverted.binary_search(&element).is_ok() {
            determinant.min(-f64::MIN_POSITIVE)
        } else {
            determinant.max(f64::MIN_POSITIVE)
        };
    }
    determinants
}

impl Inversions {
    /// det F of every element, if they could be computed.
    pub fn determinants(&self) -> Option<&[f64]> {
        match self {
            Self::Counted { determinants, .. } => Some(determinants),
            Self::Unknown(_) => None,
        }
    }

    /// For a report.
    pub fn to_json(&self) -> Value {
        match self {
            Self::Counted { cells, count, determinants, smallest } => {
                json!({ "count": count, "elements": determinants.len(), "cells_first": cells[..cells.len().min(NAMED)], "smallest_determinant": smallest })
            }
            Self::Unknown(reason) => json!({ "count": null, "reason": reason }),
        }
    }
}

impl std::fmt::Display for Inversions {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Counted { count: 0, determinants, smallest, .. } => write!(f, "none of {} elements; smallest det F {}", determinants.len(), short(*smallest)),
            Self::Counted { cells, count, determinants, smallest } => {
                let named: Vec<String> = cells.iter().take(NAMED / 4).map(u32::to_string).collect();
                let more = if cells.len() > named.len() { ", ..." } else { "" };
                write!(f, "{count} of {} elements (cells {}{more}); smallest det F {}", determinants.len(), named.join(", "), short(*smallest))
            }
            Self::Unknown(reason) => write!(f, "not counted: {reason}"),
        }
    }
}
