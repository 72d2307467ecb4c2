//! Commands that move shapes: deformed without inversion, or skinned and judged.

pub mod animate;
pub mod deform;
pub mod pose;
pub mod pose_audit;
pub mod posed;
pub mod shape;
pub mod shape_file;
pub mod shape_pictures;
