//! Inversion-free deformation of planar and solid meshes: a convex problem for the engine.
//!
//! ```text
//! E_ex  = 1/2 sum_i v_i |F_i - R_i|^2                     ex-rotated elasticity
//! E_tar = alpha |C x - d|^2                               soft handles (or hard ones: fixed unknowns)
//! E_vol = nu/2 sum_i v_i (trace(R_i^T F_i) - dim)^2       linearised incompressibility
//! subject to  sym(R_i^T F_i) - eps_i I  positive semi-definite, which implies det F_i > 0
//! ```
//!
//! with the rest areas or volumes `v_i`, the deformation gradients `F_i`, linear in the positions x, and a target rotation
//! `R_i` for every element, which comes as data. [`RestShape`] is what the undeformed mesh says, [`Deformer`] adds the handles and
//! assembles a [`qp::Problem`](crate::qp::Problem) for given rotations and targets. [`RestShape::deformation_gradients`]
//! and its neighbours judge positions, whoever made them.
//!
//! Unknowns are displacements from [`Deformer::reference`], vertex by vertex: `x[vertex * dim + axis]`. A row of cones is the scaled lower triangle of a symmetric
//! matrix, row by row, `(s11, √2 s21, s22, √2 s31, √2 s32, s33)`.
//!
//! # Source
//! Liu, Gao, Zhu, Sifakis, Kavan 2016, *Fast and robust inversion-free shape manipulation*, equations 1 to 5; the cone is
//! that of Kovalsky, Aigerman, Basri, Lipman 2014, *Controlling singular values with semidefinite programming*.

mod blame;
mod closest;
mod comparison;
mod cones;
mod deformer;
mod energy;
mod error;
mod feasibility;
mod held;
mod inside;
mod options;
mod orientation;
mod outcome;
mod polar;
mod rest;
pub mod rotations;
pub mod skinning;
mod solver;
mod state;
mod weights;

pub use blame::Blame;
pub use comparison::{
    AugmentedOptions, Barrier, BarrierOptions, Compared, Comparison, DetPenaltyOptions, Ending, Lagrangian,
};
pub use deformer::{DeformOptions, Deformer, Hold};
pub use energy::DeformEnergy;
pub use error::DeformError;
pub use held::HeldVertices;
pub use options::{Begin, FactorChoice, OnContradiction, SolveMethod, SolveOptions};
pub use outcome::{DeformStatus, Deformed, Effort, ElementReport, HandlePlace, Substitute};
pub use polar::nearest_rotations;
pub use rest::RestShape;
pub use solver::{DeformPreview, DeformSolver};
pub use state::determinant;
