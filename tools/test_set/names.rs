//! The problems by name.

use std::error::Error;

use morsmooth::deform::DeformOptions;

use super::fields::{self, Made};
use super::problems::Random;
use super::scenes::{self, Scene};

/// The twelve, from small to large.
pub const TWELVE: [&str; 12] = [
    "grid-5041-data-k2",
    "series-1000-data-k3",
    "grid-7396-nodata-k3",
    "deform-quad-40",
    "deform-swirl-180",
    "grid-15129-data-k2",
    "grid-15129-nodata-k2",
    "deform-bar-170",
    "volume-13824-data-k2",
    "torus-20000-data-k2",
    "grid-58081-data-k2",
    "grid-58081-nodata-k4",
];

/// Two more that take minutes and gigabytes.
pub const LARGE: [&str; 2] = ["grid-250000-data-k2", "grid-1000000-data-k2"];

/// A problem, and the scene it was made from where it is a deformation.
pub fn make(name: &str) -> Result<(Made, Option<Scene>), Box<dyn Error>> {
    let mut random = Random(7);
    let square = |n: usize| (n as f64).sqrt().round() as usize;
    let parts: Vec<&str> = name.split('-').collect();
    let number = |place: usize| parts[place].parse::<usize>();
    let made = match parts[0] {
        "grid" if parts[2] == "data" => {
            let complex = fields::plane(square(number(1)?), &mut random);
            let data = fields::noisy(&complex, 15, 0.17, &mut random);
            fields::smoothing(&complex, &data, order(&parts)?, 0.1)?
        }
        "grid" => fields::without_data(&fields::plane(square(number(1)?), &mut random), order(&parts)?)?,
        "series" => {
            let complex = fields::series(number(1)?);
            let data = fields::noisy(&complex, 9, 0.08, &mut random);
            // Fewer extrema than the smooth field has, so that rows are active.
            fields::smoothing(&complex, &data, order(&parts)?, 0.5)?
        }
        "torus" => {
            let across = square(number(1)? / 2);
            let complex = fields::torus(2 * across, across);
            let data = fields::noisy(&complex, 18, 0.45, &mut random);
            fields::smoothing(&complex, &data, order(&parts)?, 0.1)?
        }
        "volume" => {
            let complex = fields::volume((number(1)? as f64).cbrt().round() as usize);
            let data = fields::noisy(&complex, 12, 0.35, &mut random);
            fields::smoothing(&complex, &data, order(&parts)?, 0.1)?
        }
        "deform" => {
            let scene = match parts[1] {
                "quad" => scenes::quad(number(2)?),
                "swirl" => scenes::swirl(40, parts[2].parse()?),
                "bar" => scenes::bar(30, 6, parts[2].parse()?),
                other => return Err(format!("found scene {other}; expected quad, swirl or bar").into()),
            };
            let deformer = scene.deformer(DeformOptions::default());
            let problem = deformer.problem(&scene.rotations, &scene.targets)?;
            let made = Made { problem, coordinates: deformer.coordinates(), start: None };
            return Ok((made, Some(scene)));
        }
        other => return Err(format!("found problem {other}; expected one of {TWELVE:?} or {LARGE:?}").into()),
    };
    Ok((made, None))
}

/// `k2` is 2.
fn order(parts: &[&str]) -> Result<usize, Box<dyn Error>> {
    let last = parts[parts.len() - 1];
    Ok(last.strip_prefix('k').ok_or_else(|| format!("found {last}; expected k1 to k4"))?.parse()?)
}
