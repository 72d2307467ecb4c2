//! What commands share: from names of files and arrays to data, and from results to files, pictures and words.

pub mod beside;
pub mod ground;
pub mod input;
pub mod journal;
pub mod number;
pub mod output;
pub mod pattern;
pub mod pictures;
pub mod report;
pub mod shape_input;
pub mod spot;
pub mod steps;
pub mod steps_report;
pub mod talk;
pub mod weight_arrays;
pub mod wishes;
pub mod written;
