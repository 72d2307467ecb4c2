//! The assembled problem against energies and eigenvalues computed apart from it, and refusals.

mod assembly;
mod comparison;
mod driver;
mod feasibility;
mod refusals;
mod scene;
mod skinning;
mod solve;

#[path = "../../../tools/bench/scenes.rs"]
#[allow(dead_code)]
pub mod scenes;

use morsmooth::deform::{DeformOptions, Hold};
use scenes::Scene;

/// A planar and a solid scene, small.
fn both() -> Vec<Scene> {
    vec![scenes::quad(6), scenes::bar(8, 2, 70.0)]
}

/// All combinations of holding and incompressibility.
fn kinds() -> Vec<DeformOptions> {
    let holds = [Hold::Soft { alpha: 1e4 }, Hold::Soft { alpha: 3.0 }, Hold::Hard];
    holds
        .into_iter()
        .flat_map(|hold| [0.0, 0.4].map(|incompressibility| DeformOptions { hold, incompressibility, margin: 2.0 }))
        .collect()
}
