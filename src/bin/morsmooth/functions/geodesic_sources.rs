//! Where the distances of `morsmooth geodesic` start.

use std::path::{Path, PathBuf};

use clap::Args;
use morsmooth::field::VertexId;
use morsmooth::geodesic::{SurfacePoint, nearest_point, sample_curve};
use morsmooth::mesh::Domain;

use crate::failure::Failure;

/// The sources asked for.
#[derive(Debug, Clone, Args)]
pub struct SourceArgs {
    /// Points of the file, by number: 17,92. The distance is that from the nearest of all sources, unless --each is given.
    #[arg(long, value_name = "POINT", value_delimiter = ',')]
    pub source: Vec<u64>,

    /// A place in space, x,y,z; its nearest point of the surface is a source, in a face, on an edge or at a vertex. May be repeated.
    #[arg(long, value_name = "X,Y,Z", value_parser = place, allow_hyphen_values = true)]
    pub source_point: Vec<[f64; 3]>,

    /// A curve on the surface: a text file with a place x y z a line, each two in a common triangle; it is sampled.
    #[arg(long, value_name = "FILE")]
    pub source_curve: Option<PathBuf>,

    /// Spacing of the samples of the curve, as a part of the diagonal of the bounding box. Distances are too long by half of it at most.
    #[arg(long, value_name = "FRACTION", value_parser = crate::args::fraction, default_value = "0.1%", requires = "source_curve")]
    pub curve_spacing: f64,

    /// How far a place may lie off the surface, as a part of the diagonal of the bounding box.
    #[arg(long, value_name = "FRACTION", value_parser = crate::args::fraction, default_value = "1%")]
    pub source_tolerance: f64,
}

/// The sources on the mesh.
pub struct Sources {
    /// Points of the surface.
    pub points: Vec<SurfacePoint>,
    /// The sources in words, as they were given, and how many of the points belong to each: one, or the samples of the curve.
    pub given: Vec<(String, usize)>,
    /// Spacing of samples of a curve, in the units of the mesh; 0 without a curve.
    pub spacing: f64,
    /// What was done to find them.
    pub notes: Vec<String>,
    /// Corners of the cells that hold sources, by rising vertex.
    corners: Vec<VertexId>,
}

impl Sources {
    /// Finds the sources on the domain.
    pub fn resolve(args: &SourceArgs, input: &Path, domain: &Domain) -> Result<Self, Failure> {
        let complex = &domain.complex;
        let diagonal = complex.bounding_box_diagonal();
        let mut sources = Self { points: Vec::new(), given: Vec::new(), spacing: 0.0, notes: Vec::new(), corners: Vec::new() };
        for &point in &args.source {
            let found = usize::try_from(point).ok().and_then(|point| domain.vertex_of_point().get(point));
            let vertex = match found {
                Some(Some(vertex)) => *vertex,
                Some(None) => {
                    let text = format!("--source {point} is not in the domain; expected a point of a cell that is not masked");
                    return Err(Failure::file(input, text));
                }
                None => {
                    let text = format!("found --source {point}; the file has points 0 to {}", domain.point_count().saturating_sub(1));
                    return Err(Failure::file(input, text));
                }
            };
            sources.points.push(SurfacePoint::Vertex(vertex));
            sources.given.push((format!("point {point}"), 1));
        }
        let most = args.source_tolerance * diagonal;
        let on_surface = |at: [f64; 3], what: String| -> Result<SurfacePoint, Failure> {
            let Some((point, off)) = nearest_point(complex, at) else {
                return Err(Failure::file(input, format!("{what} needs a surface of triangles; found dimension {}", complex.dimension())));
            };
            if off > most {
                let text = format!("{what} lies {off:e} off the surface; expected at most {most:e}");
                return Err(Failure::file(input, text).hint("--source-tolerance allows more"));
            }
            Ok(point)
        };
        for &at in &args.source_point {
            let point = on_surface(at, format!("--source-point {},{},{}", at[0], at[1], at[2]))?;
            sources.notes.push(format!("--source-point {},{},{} is {}", at[0], at[1], at[2], describe(&point, domain)));
            sources.points.push(point);
            sources.given.push((format!("place {},{},{}", at[0], at[1], at[2]), 1));
        }
        if let Some(path) = &args.source_curve {
            let places = read_curve(path)?;
            let curve = places
                .iter()
                .map(|&(line, at)| on_surface(at, format!("{}, line {line}: the place", path.display())))
                .collect::<Result<Vec<_>, _>>()?;
            sources.spacing = args.curve_spacing * diagonal;
            let samples = sample_curve(complex, &curve, sources.spacing).map_err(|error| Failure::file(path, error))?;
            sources.notes.push(format!(
                "{} samples along the curve, at most {:e} apart: distances are too long by at most {:e}",
                samples.len(),
                sources.spacing,
                sources.spacing / 2.0
            ));
            sources.given.push((format!("curve {}", path.display()), samples.len()));
            sources.points.extend(samples);
        }
        if sources.points.is_empty() {
            return Err(Failure::usage("found no source; expected --source, --source-point or --source-curve"));
        }
        sources.corners = sources.points.iter().flat_map(|point| corners(point, domain)).collect();
        sources.corners.sort_unstable();
        sources.corners.dedup();
        Ok(sources)
    }

    /// The points of each source by itself.
    pub fn each(&self) -> Vec<Vec<SurfacePoint>> {
        let mut rest = self.points.as_slice();
        let own = self.given.iter().map(|&(_, count)| {
            let (own, others) = rest.split_at(count);
            rest = others;
            own.to_vec()
        });
        own.collect()
    }

    /// Whether a vertex is a corner of a cell that holds a source.
    pub fn is_near(&self, _domain: &Domain, vertex: VertexId) -> bool {
        self.corners.binary_search(&vertex).is_ok()
    }
}

fn corners(point: &SurfacePoint, domain: &Domain) -> Vec<VertexId> {
    match *point {
        SurfacePoint::Vertex(vertex) => vec![vertex],
        SurfacePoint::Edge { edge, .. } => domain.complex.edges()[edge.0 as usize].to_vec(),
        SurfacePoint::Face { triangle, .. } => domain.complex.simplex(triangle).iter().map(|&vertex| VertexId(vertex)).collect(),
    }
}

fn describe(point: &SurfacePoint, domain: &Domain) -> String {
    let points: Vec<String> = domain.points_of(&corners(point, domain)).iter().map(ToString::to_string).collect();
    match point {
        SurfacePoint::Vertex(_) => format!("point {} of the file", points[0]),
        SurfacePoint::Edge { .. } => format!("on the edge of the points {}", points.join(" and ")),
        SurfacePoint::Face { .. } => format!("in the face of the points {}", points.join(", ")),
    }
}

fn place(text: &str) -> Result<[f64; 3], String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|number| number.trim().parse::<f64>()).collect();
    match numbers.as_deref() {
        Ok(&[x, y, z]) if [x, y, z].iter().all(|part| part.is_finite()) => Ok([x, y, z]),
        _ => Err(format!("found '{text}'; expected three finite numbers x,y,z")),
    }
}

fn read_curve(path: &Path) -> Result<Vec<(usize, [f64; 3])>, Failure> {
    let text = std::fs::read_to_string(path).map_err(|error| Failure::file(path, format!("cannot be read: {error}")))?;
    let mut places = Vec::new();
    for (number, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or("").trim();
        if line.is_empty() {
            continue;
        }
        let words: Vec<&str> = line.split(|c: char| c.is_whitespace() || c == ',').filter(|word| !word.is_empty()).collect();
        let place = place(&words.join(",")).map_err(|error| Failure::file(path, format!("line {}: {error}", number + 1)))?;
        places.push((number + 1, place));
    }
    if places.is_empty() {
        return Err(Failure::file(path, "found no place; expected lines x y z"));
    }
    Ok(places)
}
