//! The module `operators`.

mod derived;
mod laplacian;
mod mass;
mod refusals;
