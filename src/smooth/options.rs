//! What a user can ask of [`smooth`](super::smooth).

use crate::field::Precision;
use crate::monotone::{EdgeSet, Strategy, Strictness};
use crate::morse::Selection;

/// The field on which extrema are measured, and whose values they keep.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum SelectOn {
    /// The data themselves: for values that are trusted.
    #[default]
    Data,
    /// The unconstrained smooth field: for noisy data, so that no extremum sits on a noise peak.
    Smooth,
}

/// How the smoothing length is found.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Length {
    /// By generalised cross-validation, see [`cross_validated_length`](super::cross_validated_length).
    #[default]
    Automatic,
    /// A fraction of the diagonal of the bounding box.
    OfDiagonal(f64),
    /// In the units of the points.
    Absolute(f64),
}

/// What is kept of the values at the wanted extrema.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum ExtremumValues {
    /// They stay as they are in the field on which the extrema were selected.
    #[default]
    Keep,
    /// Nothing: only place and kind of the extremum are guaranteed.
    Free,
    /// They stay within this fraction of the range of the field on which the extrema were selected.
    Within(f64),
}

/// What of the Morse complex of the simplified field is kept besides its extrema.
///
/// The values kept are those of the field on which extrema were selected, simplified to the wanted ones; only values, not
/// the type of the critical point, are guaranteed there.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum KeepAlso {
    /// Nothing.
    #[default]
    Nothing,
    /// Values at the saddles between wanted extrema.
    Saddles,
    /// Values along the separatrices that lead from these saddles to wanted extrema, without the saddles.
    Separatrices,
    /// Both.
    Both,
}

/// Options of [`smooth`](super::smooth). The default selects on the data, needs a `selection`, and takes k = 2.
#[derive(Debug, Clone)]
pub struct SmoothOptions<'a> {
    /// Which extrema are wanted.
    pub selection: Selection,
    /// The field on which they are measured.
    pub select_on: SelectOn,
    /// Order k of the polyharmonic energy, 1 to 4.
    pub order: usize,
    /// Smoothing length.
    pub length: Length,
    /// Confidence in each value, `n` finite numbers not below 0.
    pub confidence: Option<&'a [f64]>,
    /// Smoothness mask, `n` numbers in [0, 1]; 0 allows a C0 spike.
    pub smoothness: Option<&'a [f64]>,
    /// Values at the wanted extrema.
    pub values: ExtremumValues,
    /// What is kept besides the extrema.
    pub keep_also: KeepAlso,
    /// The representative function.
    pub strategy: Strategy,
    /// Which edges take its direction.
    pub edges: EdgeSet,
    /// Rounds in which the solution becomes the representative function of the next.
    pub refine: usize,
    /// Width in which the result is stored.
    pub precision: Precision,
    /// [`Strictness::TiesByIndex`] gives the raw optimum: no margins, ties allowed where the index breaks them.
    pub strictness: Strictness,
    /// Relative duality gap at which the solver stops.
    pub relative_gap: f64,
}

impl SmoothOptions<'_> {
    /// Defaults for a selection.
    pub fn new(selection: Selection) -> Self {
        Self {
            selection,
            select_on: SelectOn::default(),
            order: 2,
            length: Length::default(),
            confidence: None,
            smoothness: None,
            values: ExtremumValues::default(),
            keep_also: KeepAlso::default(),
            strategy: Strategy::default(),
            edges: EdgeSet::default(),
            refine: 0,
            precision: Precision::default(),
            strictness: Strictness::default(),
            relative_gap: 1e-8,
        }
    }
}
