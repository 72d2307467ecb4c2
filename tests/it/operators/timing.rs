//! Time to build operators. `cargo test --release --test it -- --ignored --nocapture operators::timing`

use crate::mesh::shapes::grid;
use crate::mesh::timing::best_of;
use morsmooth::operators::{Derived, cotangent_laplacian, derive, lumped_mass, positive_laplacian};

#[test]
#[ignore = "a measurement, not a check"]
fn operators() {
    for dims in [[403, 344, 1], [1000, 1000, 1], [100, 100, 100]] {
        let complex = grid(dims);
        best_of(&format!("cotangent {dims:?}"), || cotangent_laplacian(&complex).unwrap());
        best_of(&format!("positive {dims:?}"), || positive_laplacian(&complex).unwrap());
        best_of(&format!("mass {dims:?}"), || lumped_mass(&complex).unwrap());
        best_of(&format!("vorticity {dims:?}"), || derive(&complex, complex.points(), Derived::Vorticity).unwrap());
    }
}
