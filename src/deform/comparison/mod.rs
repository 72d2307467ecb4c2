//! The methods that inversion-free deformation is compared with, on the same shape, handles and rotations.
//!
//! | method | energy besides the elastic one | finds | may end |
//! |---|---|---|---|
//! | [`Comparison::ex_rotated`] | none | its minimum, one linear system | with inverted elements |
//! | [`Comparison::det_penalty`] | clamped quadratic penalty of `det F` | a local minimum at best | with inverted elements, or not at all |
//! | [`Comparison::locally_injective`] | barrier of `det F`, from the rest shape on | a local minimum at best | short of the targets, or not at all |
//! | [`Comparison::augmented`] | augmented Lagrangian of the semidefinite constraints | the optimum | converged for feasible rotations |
//!
//! They share one Newton method over elements: an energy says what it is in one deformation gradient, the rest is common. They
//! are comparisons: they report how they ended ([`Ending`]) and what they left inverted, and promise nothing.
//!
//! # Sources
//! * Liu, Gao, Zhu, Sifakis, Kavan 2016: which methods, figures 9, 10 and 12, table 2.
//! * Schüller, Kavan, Panozzo, Sorkine-Hornung 2013, *Locally injective mappings*: the barrier.
//! * Apkarian, Noll, Thevenet, Tuan 2004, *A spectral quadratic-SDP method with applications to fixed-order H2 and H∞ synthesis*.
//! * Kočvara, Stingl 2003, *PENNON: a code for convex nonlinear and semidefinite programming*.

mod augmented;
mod barrier;
mod compared;
mod det_penalty;
mod determinant;
mod lagrangian;
mod local;
mod newton;

pub use augmented::AugmentedOptions;
pub use barrier::{Barrier, BarrierOptions};
pub use compared::{Compared, Comparison, Ending};
pub use det_penalty::DetPenaltyOptions;
pub use lagrangian::Lagrangian;
