//! Smooth scalar fields with exactly the wanted minima and maxima.
//!
//! A field `h` measured on a mesh or grid carries thousands of noise extrema. Over all fields `f` the crate solves
//!
//! ```text
//! minimise    γ_L E_k(f) + γ_D (f - h)ᵀ D (f - h)        E_k(f) = ½ fᵀ (L M⁻¹)^(k-1) L f
//! subject to  f_i = g_i        for the wanted extrema
//!             f_i < f_j        for the monotonicity edges (i, j)
//! ```
//!
//! where the edges take their direction from a *representative function* that has exactly the wanted extrema
//! (Jacobson, Weinkauf, Sorkine 2012, eq. 12–14), and proves the result with an audit that shares no code with
//! the solver.
#![forbid(unsafe_code)]

pub mod audit;
pub mod field;
pub mod io;
pub mod linalg;
pub mod mesh;
pub mod monotone;
pub mod morse;
pub mod operators;
pub mod plot;
pub mod qp;
pub mod smooth;
