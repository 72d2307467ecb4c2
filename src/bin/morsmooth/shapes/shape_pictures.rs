//! Pictures of deformed shapes: before and after, and iterates.

use std::path::Path;

use morsmooth::plot::{ShapeView, shape_picture};

use crate::failure::Failure;
use crate::shapes::posed::Posed;
use crate::shapes::shape::{Rig, Shape};

/// Most held vertices that are marked; regions have many.
const MARKS: usize = 300;

/// `before_after.png`: the rest shape beside the deformed one.
pub fn before_after(directory: &Path, shape: &Shape, rig: &Rig, posed: &Posed) -> Result<(), Failure> {
    make(directory)?;
    let rest = shape.complex().points();
    let inverted = posed.determinants.iter().filter(|det| det.is_nan() || **det <= 0.0).count();
    let title = match inverted {
        0 => "after: no inverted element".to_owned(),
        1 => "after: 1 inverted element".to_owned(),
        count => format!("after: {count} inverted elements"),
    };
    let (before, after) = (marks(rig, rest), marks(rig, &posed.points));
    let ones = vec![1.0; posed.determinants.len()];
    let views = [
        ShapeView { title: "before", points: rest, determinants: Some(&ones), marks: &before },
        ShapeView { title: &title, points: &posed.points, determinants: Some(&posed.determinants), marks: &after },
    ];
    write(&directory.join("before_after.png"), shape, &views, 1600)
}

/// One shape, with its determinants.
pub fn single(target: &Path, shape: &Shape, (title, points, determinants): (&str, &[[f64; 3]], &[f64])) -> Result<(), Failure> {
    write(target, shape, &[ShapeView { title, points, determinants: Some(determinants), marks: &[] }], 640)
}

/// Makes a directory unless it is there.
pub fn make(directory: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(directory).map_err(|error| Failure::file(directory, format!("cannot be made a directory: {error}")))
}

fn write(target: &Path, shape: &Shape, views: &[ShapeView<'_>], width: u32) -> Result<(), Failure> {
    shape_picture(shape.complex(), views, width)
        .and_then(|picture| picture.write_png(target))
        .map_err(|error| Failure::file(target, error))
}

/// Places of held vertices, every k-th where there are many.
fn marks(rig: &Rig, points: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let held = &rig.held.vertices;
    held.iter().step_by(held.len().div_ceil(MARKS).max(1)).map(|vertex| points[vertex.index()]).collect()
}
