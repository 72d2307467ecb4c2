//! Smooth scalar fields with exactly the wanted minima and maxima.
//!
//! A field `h` measured on a mesh or grid carries thousands of noise extrema. Over all fields `f` the crate solves
//!
//! ```text
//! minimise    l^(2k) E_k(f) + (f - h)ᵀ D (f - h)         E_k(f) = ½ fᵀ (L M⁻¹)^(k-1) L f,   k = 1, 2, 3, 4
//! subject to  f_i = g_i        for the wanted extrema i
//!             f_i < f_j        for the monotonicity edges (i, j)
//! ```
//!
//! with the cotangent Laplacian L, the lumped mass M, the data weights D and the smoothing length l. The edges take their
//! direction from a *representative function*, any field with exactly the wanted extrema, so the problem is convex. The result
//! has exactly the wanted extrema under plain `<` in the precision in which it is stored, and an audit that shares no code
//! with the solver proves it.
//!
//! ```
//! use morsmooth::{mesh, morse::{Selection, Threshold}, smooth::{SmoothOptions, smooth}};
//! let domain = mesh::Domain::from_grid(&mesh::Grid::image([9, 1, 1], [0.0; 3], [1.0; 3]), &mesh::Mask::none())?;
//! let noisy = [0.0, 0.4, 0.3, 0.9, 1.0, 0.7, 0.8, 0.2, 0.1];
//! let options = SmoothOptions::new(Selection::Threshold(Threshold::Fraction(0.3)));
//! let result = smooth(&domain.complex, &noisy, &options, &mut |_| {})?;
//! assert_eq!(result.report.wanted.to_string(), "2 minima, 1 maximum");
//! assert_eq!(result.values[4], 1.0);
//! assert!(result.values[..5].is_sorted_by(|a, b| a < b) && result.values[4..].is_sorted_by(|a, b| a > b));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Floors
//! A module uses only modules of lower floors; a test enforces it.
//!
//! | floor | modules |
//! |---|---|
//! | 4 | [`smooth`], [`interpolate`] |
//! | 3 | [`monotone`], [`deform`], [`geodesic`], [`io`], [`plot`] |
//! | 2 | [`operators`], [`morse`], [`audit`] |
//! | 1 | [`mesh`], [`qp`] |
//! | 0 | [`linalg`], [`field`] |
//!
//! # Sources
//! * Jacobson, Weinkauf, Sorkine 2012, *Smooth shape-aware functions with controlled extrema*: the problem.
//! * Robins, Wood, Sheppard 2011, *Theory and algorithms for constructing discrete Morse complexes*: the gradient.
//! * Edelsbrunner, Letscher, Zomorodian 2002, *Topological persistence and simplification*: pairs and the elder rule.
//! * Tierny, Pascucci 2012; Lukasczyk, Garth, Maciejewski, Tierny 2020: the flood.
//! * Günther, Jacobson, Reininghaus, Seidel, Sorkine-Hornung, Weinkauf 2014: refinement of the representative function.
//! * Jacobson, Baran, Popović, Sorkine 2011, *Bounded biharmonic weights for real-time deformation*: bounded weights.
//! * Liu, Gao, Zhu, Sifakis, Kavan 2016, *Fast and robust inversion-free shape manipulation*: deformation, penalty continuation.
//! * Jacobson, Baran, Popović, Sorkine 2011: bounded biharmonic weights. Kavan, Collins, Žára, O'Sullivan 2008: dual quaternions.
//! * Surazhsky, Surazhsky, Kirsanov, Gortler, Hoppe 2005; Xin, Wang 2009; Qin, Han, Yu, Yu, Zhang 2016: exact distances.
//! * Crane, Weischedel, Wardetzky 2013: distances by heat. Ruppert 1995: triangles in an outline.
//! * Mehrotra 1992; Gondzio 1996: the interior point method.
//! * Burman, Chow, Nolan 1994: the smoothing length.
#![forbid(unsafe_code)]

pub mod audit;
pub mod deform;
pub mod field;
pub mod geodesic;
pub mod interpolate;
pub mod io;
pub mod linalg;
pub mod mesh;
pub mod monotone;
pub mod morse;
pub mod operators;
pub mod plot;
pub mod qp;
pub mod smooth;
