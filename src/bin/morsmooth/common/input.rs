//! From the command line to a field on a domain.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use morsmooth::field::{Precision, VertexId};
use morsmooth::io::{ArrayData, DataArray, DataSet, MaskSources, mask, read};
use morsmooth::mesh::{Domain, Mask, check};
use morsmooth::operators::{Derived, OperatorError, derive};
use morsmooth::smooth::{SmoothError, constant_components};

use crate::args::{DeriveKind, FieldArgs, FieldsArgs};
use crate::common::ground::Grounds;
use crate::common::number::short;
use crate::common::pattern::fits;
use crate::failure::Failure;

/// A scalar field of a file, on the part of its points that is the domain.
pub struct FieldInput {
    /// The file.
    pub path: PathBuf,
    /// All of it, shared by the fields of one file.
    pub dataset: Arc<DataSet>,
    /// Name of the field.
    pub name: String,
    /// Whether it was derived from the array of a vector.
    pub is_derived: bool,
    /// The mask asked for.
    pub mask: Option<String>,
    /// The domain, shared by fields with the same holes.
    pub domain: Arc<Domain>,
    /// Value at every point of the file; NaN where a derived field has none.
    pub on_points: Vec<f64>,
    /// Value at every vertex of the domain.
    pub values: Vec<f64>,
    /// Width in which results are stored: that of the array.
    pub precision: Precision,
    /// What was found and handled while the domain was made.
    pub notes: Vec<String>,
}

impl FieldInput {
    /// Reads the file, finds the array, builds the domain.
    pub fn load(args: &FieldArgs) -> Result<Self, Failure> {
        let dataset = Arc::new(read(&args.input).map_err(|error| Failure::usage(error.to_string()))?);
        let array = choose(&dataset, args)?;
        Self::of_array(&dataset, array, args, &Grounds::of_one_file())
    }

    /// Reads the file once, and a field for every array meant; fields with the same holes share their domain.
    pub fn load_all(args: &FieldsArgs) -> Result<Vec<Self>, Failure> {
        let dataset = Arc::new(read(&args.input).map_err(|error| Failure::usage(error.to_string()))?);
        Self::all_of(&dataset, args, &Grounds::of_one_file())
    }

    /// As [`FieldInput::load_all`], of a data set that was read from `args.input`.
    pub fn all_of(dataset: &Arc<DataSet>, args: &FieldsArgs, grounds: &Grounds) -> Result<Vec<Self>, Failure> {
        let single = |array: Option<String>| FieldArgs {
            input: args.input.clone(),
            array,
            mask: args.mask.clone(),
            derive: args.derive,
        };
        let names = array_names(dataset, args, &single(None))?;
        let mut inputs: Vec<Self> = Vec::with_capacity(names.len());
        for name in names {
            let args = single(name);
            let array = choose(dataset, &args)?;
            let input = Self::of_array(dataset, array, &args, grounds)?;
            if inputs.iter().any(|other| other.name == input.name) {
                return Err(Failure::usage(format!("the array '{}' was named twice; expected each once", input.name)));
            }
            inputs.push(input);
        }
        Ok(inputs)
    }

    /// The field of one array, on the domain of another field where that is the same.
    pub fn of_array(dataset: &Arc<DataSet>, array: &DataArray, args: &FieldArgs, grounds: &Grounds) -> Result<Self, Failure> {
        let sources =
            MaskSources { array: args.mask.clone(), holes: vec![array.name.clone()], ..MaskSources::default() };
        let file = |error: &dyn std::fmt::Display| Failure::file(&args.input, error);
        let kept = mask(dataset, &sources).map_err(|error| file(&error))?;
        let full = grounds.domain(dataset, &kept).map_err(|error| file(&error))?;
        let precision = match array.data {
            ArrayData::F32(_) => Precision::F32,
            _ => Precision::F64,
        };
        let (name, on_points) = match args.derive {
            None => (array.name.clone(), array.to_f64(0)),
            Some(kind) => (format!("{}_{}", array.name, label(kind)), derived(array, kind, &full, precision).map_err(|error| file(&error))?),
        };
        let values = full.restrict(&on_points);
        if let Some(vertex) = values.iter().position(|value| !value.is_finite()) {
            let point = full.point_of_vertex()[vertex];
            let text = format!("array {name} is {} at point {point}; expected a finite number", values[vertex]);
            return Err(file(&text).hint("NaN marks a hole; an infinite value must be masked (--mask) or repaired"));
        }
        let mut notes: Vec<String> = full.notes.iter().map(ToString::to_string).collect();
        let (domain, values) = match constant_parts(&full, &values) {
            Some((constant, found)) => {
                notes.extend(found);
                let kept = kept_without(dataset, kept, &constant);
                let domain = grounds.domain(dataset, &kept).map_err(|error| file(&error))?;
                let values = domain.restrict(&on_points);
                (domain, values)
            }
            None => (full, values),
        };
        Ok(Self {
            path: args.input.clone(),
            dataset: Arc::clone(dataset),
            name,
            is_derived: args.derive.is_some(),
            mask: args.mask.clone(),
            domain,
            on_points,
            values,
            precision,
            notes,
        })
    }

    /// The vertex of a point of the file.
    pub fn vertex_of_point(&self, source: &Path, point: u64) -> Result<VertexId, Failure> {
        let points = self.domain.point_count();
        let vertex = usize::try_from(point).ok().and_then(|point| self.domain.vertex_of_point().get(point));
        match vertex {
            Some(Some(vertex)) => Ok(*vertex),
            Some(None) => Err(Failure::file(source, format!("point {point} is not in the domain of {}; expected a point that is neither masked nor left out", self.path.display()))),
            None => Err(Failure::file(source, format!("found point {point}; {} has points 0 to {}", self.path.display(), points.saturating_sub(1)))),
        }
    }

    /// An error of the library as one about the file, vertices translated to points.
    pub fn smooth_failure(&self, error: &SmoothError) -> Failure {
        if let SmoothError::Operator(OperatorError::ZeroMeasure { .. }) = error {
            // The mesh knows the user's cell and points.
            if let Err(fault) = check(&self.domain) {
                return Failure::file(&self.path, fault);
            }
        }
        let failure = Failure::file(&self.path, error);
        let vertices = error.vertices();
        let points = self.domain.points_of(&vertices);
        if vertices.iter().zip(&points).all(|(vertex, point)| vertex.0 == *point) {
            return failure;
        }
        let names: Vec<String> =
            vertices.iter().zip(&points).map(|(vertex, point)| format!("vertex {vertex} is point {point} of the file")).collect();
        failure.hint(names.join(", "))
    }
}

/// The points of components with one value only, beside components that vary, and a note on each.
///
/// No strict field is near such a component, so it is left out and keeps its values. A field without any variation is left
/// to the library to refuse.
fn constant_parts(domain: &Domain, values: &[f64]) -> Option<(Vec<u32>, Vec<String>)> {
    let constant = constant_components(&domain.complex, values);
    let left_out: usize = constant.iter().map(Vec::len).sum();
    if left_out == 0 || left_out == values.len() {
        return None;
    }
    let points = constant.iter().flat_map(|vertices| domain.points_of(vertices)).collect();
    let notes = constant.iter().map(|vertices| {
        format!(
            "the field is constant (value {:?}) on a part of {} points, first point {}; left out, they keep their value",
            values[vertices[0].index()],
            vertices.len(),
            domain.point_of_vertex()[vertices[0].index()]
        )
    });
    Some((points, notes.collect()))
}

fn kept_without(dataset: &DataSet, mut kept: Mask, points: &[u32]) -> Mask {
    let keep = kept.keep_points.get_or_insert_with(|| vec![true; dataset.point_count()]);
    points.iter().for_each(|&point| keep[point as usize] = false);
    kept
}

/// The names asked for: `None` is the only array of the file. A name with commas is a list, unless an array has that name.
fn array_names(dataset: &DataSet, args: &FieldsArgs, any: &FieldArgs) -> Result<Vec<Option<String>>, Failure> {
    if let Some(pattern) = &args.array_pattern {
        let fitting: Vec<_> =
            candidates(dataset, any).filter(|array| fits(pattern, &array.name)).map(|array| Some(array.name.clone())).collect();
        if fitting.is_empty() {
            let names: Vec<&str> = candidates(dataset, any).map(|array| array.name.as_str()).collect();
            let text = format!("found no array that fits the pattern '{pattern}'; expected one of: {}", names.join(", "));
            return Err(Failure::file(&args.input, text));
        }
        return Ok(fitting);
    }
    let split = |name: &String| match dataset.point_array(name) {
        None if name.contains(',') => name.split(',').map(|part| Some(part.trim().to_owned())).collect(),
        _ => vec![Some(name.clone())],
    };
    Ok(if args.array.is_empty() { vec![None] } else { args.array.iter().flat_map(split).collect() })
}

/// Whether a data set has any array that could be meant.
pub fn has_fields(dataset: &DataSet, args: &FieldsArgs) -> bool {
    let any = FieldArgs { input: args.input.clone(), array: None, mask: args.mask.clone(), derive: args.derive };
    let Ok(names) = array_names(dataset, args, &any) else { return false };
    names.iter().any(|name| match name {
        Some(name) => dataset.point_array(name).is_some(),
        None => candidates(dataset, &any).next().is_some(),
    })
}

/// Numeric point arrays that could be meant.
fn candidates<'a>(dataset: &'a DataSet, args: &'a FieldArgs) -> impl Iterator<Item = &'a DataArray> {
    let vectors = args.derive.is_some();
    dataset.point_data.arrays.iter().filter(move |array| {
        let fits = if vectors { (2..=3).contains(&array.components) } else { array.components == 1 };
        fits && !matches!(array.data, ArrayData::String(_))
            && Some(&array.name) != args.mask.as_ref()
            && !array.name.starts_with("vtkGhost")
    })
}

/// The array that is meant.
pub fn choose<'a>(dataset: &'a DataSet, args: &'a FieldArgs) -> Result<&'a DataArray, Failure> {
    let file = |text: String| Failure::file(&args.input, text);
    let found: Vec<&DataArray> = candidates(dataset, args).collect();
    let wanted = if args.derive.is_some() { "vector" } else { "scalar" };
    let list = || match found.is_empty() {
        true => format!("the file has no {wanted} point array"),
        false => format!("{wanted} point arrays: {}", found.iter().map(|array| describe(array)).collect::<Vec<_>>().join(", ")),
    };
    let Some(name) = &args.array else {
        return match found.as_slice() {
            [only] => Ok(only),
            [] => Err(file(format!("found no {wanted} point array; expected one to work on")).hint("'morsmooth info FILE' lists what is there")),
            many => Err(file(format!("found {} {wanted} point arrays; expected --array NAME", many.len())).hint(list())),
        };
    };
    let Some(array) = dataset.point_array(name) else {
        let failure = file(format!("found no point array '{name}'; expected one of those in the file")).hint(list());
        return Err(match dataset.cell_array(name) {
            Some(_) => failure.hint(format!("'{name}' is a cell array; turn it into a point array first (ParaView: Cell Data to Point Data)")),
            None => failure,
        });
    };
    if matches!(array.data, ArrayData::String(_)) {
        return Err(file(format!("array '{name}' holds texts; expected numbers")).hint(list()));
    }
    match (args.derive, array.components) {
        (None, 1) | (Some(_), 2 | 3) => Ok(array),
        (None, components) => Err(file(format!("array '{name}' has {components} components; expected 1"))
            .hint("--derive magnitude, vorticity, divergence, q-criterion or okubo-weiss makes a scalar of a vector")),
        (Some(_), components) => Err(file(format!("array '{name}' has {components} components; expected a vector of 2 or 3 for --derive")).hint(list())),
    }
}

/// Name and range of an array, for lists.
pub fn describe(array: &DataArray) -> String {
    if matches!(array.data, ArrayData::String(_)) {
        return format!("{} (texts)", array.name);
    }
    if array.components != 1 {
        return format!("{} ({} components)", array.name, array.components);
    }
    let values = array.to_f64(0);
    let (low, high) = values
        .iter()
        .filter(|value| !value.is_nan())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &value| (low.min(value), high.max(value)));
    if low > high { format!("{} (no values)", array.name) } else { format!("{} ({} to {})", array.name, short(low), short(high)) }
}

/// What a derived field is called, after the name of the vector.
fn label(kind: DeriveKind) -> &'static str {
    match kind {
        DeriveKind::Vorticity => "vorticity",
        DeriveKind::Divergence => "divergence",
        DeriveKind::Magnitude => "magnitude",
        DeriveKind::QCriterion => "q_criterion",
        DeriveKind::OkuboWeiss => "okubo_weiss",
    }
}

fn derived(array: &DataArray, kind: DeriveKind, domain: &Domain, precision: Precision) -> Result<Vec<f64>, OperatorError> {
    let component = |index: usize| match index < array.components {
        true => domain.restrict(&array.to_f64(index)),
        false => vec![0.0; domain.complex.vertex_count()],
    };
    let (x, y, z) = (component(0), component(1), component(2));
    let vectors: Vec<[f64; 3]> = x.iter().zip(&y).zip(&z).map(|((&x, &y), &z)| [x, y, z]).collect();
    let kind = match kind {
        DeriveKind::Vorticity => Derived::Vorticity,
        DeriveKind::Divergence => Derived::Divergence,
        DeriveKind::Magnitude => Derived::Magnitude,
        DeriveKind::QCriterion => Derived::QCriterion,
        DeriveKind::OkuboWeiss => Derived::OkuboWeiss,
    };
    let values = derive(&domain.complex, &vectors, kind)?;
    let rounded: Vec<f64> = values.iter().map(|&value| precision.round(value)).collect();
    let mut on_points = vec![f64::NAN; domain.point_count()];
    domain.extend(&rounded, &mut on_points);
    Ok(on_points)
}

/// A point array of weights, on the vertices.
pub fn weights_array(input: &FieldInput, name: &str) -> Result<Vec<f64>, Failure> {
    let Some(array) = input.dataset.point_array(name) else {
        let names: Vec<&str> = input.dataset.point_data.arrays.iter().map(|array| array.name.as_str()).collect();
        return Err(Failure::file(&input.path, format!("found no point array '{name}'; expected one of {}", names.join(", "))));
    };
    if matches!(array.data, ArrayData::String(_)) {
        return Err(Failure::file(&input.path, format!("array '{name}' holds texts; expected one number a point")));
    }
    if array.components != 1 {
        return Err(Failure::file(&input.path, format!("array '{name}' has {} components; expected one number a point", array.components)));
    }
    Ok(input.domain.restrict(&array.to_f64(0)))
}

/// Which points of a persistence diagram are meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PointKind {
    /// Its minima.
    Minima,
    /// Its maxima.
    Maxima,
    /// Both.
    Extrema,
}

/// Vertices listed in a file: point numbers in a text, or the extrema of a persistence diagram in a VTK file.
pub fn read_points(path: &Path, kind: PointKind, input: &FieldInput) -> Result<Vec<VertexId>, Failure> {
    let is_vtk = path.extension().and_then(|extension| extension.to_str()).is_some_and(|extension| {
        ["vtu", "vtp", "vtk", "vtkhdf"].iter().any(|vtk| extension.eq_ignore_ascii_case(vtk))
    });
    let points = if is_vtk { diagram_points(path, kind)? } else { listed_points(path)? };
    let mut vertices = points.into_iter().map(|point| input.vertex_of_point(path, point)).collect::<Result<Vec<_>, _>>()?;
    vertices.sort_unstable();
    vertices.dedup();
    if vertices.is_empty() {
        return Err(Failure::file(path, "found no point number; expected at least one"));
    }
    Ok(vertices)
}

fn listed_points(path: &Path) -> Result<Vec<u64>, Failure> {
    let text = std::fs::read_to_string(path).map_err(|error| Failure::file(path, format!("cannot be read: {error}")))?;
    let mut points = Vec::new();
    for (number, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or("");
        for word in line.split(|character: char| character.is_whitespace() || character == ',').filter(|word| !word.is_empty()) {
            let point = word.parse().map_err(|_| {
                Failure::file(path, format!("line {}: found '{word}'; expected a point number (0, 1, 2, ...)", number + 1))
            })?;
            points.push(point);
        }
    }
    Ok(points)
}

/// Extrema of a kind, of a diagram in TTK's layout; all vertices where no critical type says what is a saddle.
fn diagram_points(path: &Path, wanted: PointKind) -> Result<Vec<u64>, Failure> {
    let diagram = read(path).map_err(|error| Failure::usage(error.to_string()))?;
    let ids = diagram.point_array("ttkVertexScalarField").ok_or_else(|| {
        Failure::file(path, "found no point array 'ttkVertexScalarField'; expected a persistence diagram as TTK writes it")
    })?;
    let kinds = diagram.point_array("CriticalType").map(|array| array.to_f64(0));
    const MINIMUM: f64 = 0.0;
    const MAXIMUM: f64 = 3.0;
    let is_wanted = |kind: f64| match wanted {
        PointKind::Minima => kind == MINIMUM,
        PointKind::Maxima => kind == MAXIMUM,
        PointKind::Extrema => kind == MINIMUM || kind == MAXIMUM,
    };
    let is_meant = |place: usize| kinds.as_ref().is_none_or(|kinds| kinds.get(place).is_some_and(|&kind| is_wanted(kind)));
    let ids = ids.to_f64(0);
    let wanted = ids.iter().enumerate().filter(|&(place, _)| is_meant(place));
    wanted
        .map(|(_, &id)| match id >= 0.0 && id.fract() == 0.0 {
            true => Ok(id as u64),
            false => Err(Failure::file(path, format!("found vertex {id} in ttkVertexScalarField; expected a point number"))),
        })
        .collect()
}
