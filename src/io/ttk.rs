//! The Morse–Smale complex as data sets in the layout of the Topology ToolKit's filter MorseSmaleComplex.
//!
//! Names, integer types and meanings of the arrays are TTK's, so that its filters and ParaView states take the files. Two
//! of them surprise: TTK's `AscendingManifold` tells the *maximum* to which a vertex ascends and `DescendingManifold` the
//! minimum to which it descends, the other way round than the names of the manifolds in Morse theory.

use rayon::prelude::*;

use crate::field::{VertexId, VertexOrder};
use crate::mesh::{Cell, Domain, Triangulation};
use crate::morse::{CriticalPoint, LineKind, MorseSmaleComplex, SeparatrixLine};

use super::array::{ArrayData, DataArray};
use super::dataset::{Attributes, CellArray, DataSet, Geometry, Role};

/// Why a complex cannot be put into TTK's layout.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TtkError {
    /// TTK's ids are 32-bit integers.
    #[error("found {found} points; expected at most {}, which is what TTK's 32-bit ids can name", i32::MAX)]
    TooManyPoints {
        /// Points of the data set.
        found: usize,
    },
    /// The array of values does not belong to the data set.
    #[error("array of {found} values for {expected} points; expected one a point")]
    ScalarLength {
        /// Points of the data set.
        expected: usize,
        /// Values of the array.
        found: usize,
    },
}

/// What the arrays are made from.
#[derive(Debug)]
pub struct TtkComplex<'a, T> {
    /// The `n` vertices and their cells.
    pub triangulation: &'a T,
    /// Order of the vertices.
    pub order: &'a VertexOrder,
    /// The field on all points of the file, in the type and under the name that critical points carry on.
    pub scalar: &'a DataArray,
    /// The complex.
    pub complex: &'a MorseSmaleComplex,
    /// Which vertex is which point, and which simplex which cell.
    pub numbering: Numbering<'a>,
}

/// From vertices and simplices to the points and cells of the file.
#[derive(Debug, Clone)]
pub struct Numbering<'a> {
    /// `None` where every vertex has the number of its point.
    point_of_vertex: Option<&'a [u32]>,
    /// Empty where cells of the file were cut.
    cell_of_top: Vec<u32>,
    points: usize,
}

impl<'a> Numbering<'a> {
    /// The numbering of a domain.
    ///
    /// Top cells keep the number that their cell has in the file if every cell is one simplex; cells that were cut, such as
    /// those of a grid, and all edges and triangles in between are numbered by the triangulation.
    ///
    /// # Errors
    /// [`TtkError::TooManyPoints`].
    ///
    /// # Cost
    /// Linear.
    pub fn new(domain: &'a Domain) -> Result<Self, TtkError> {
        let points = checked(domain.point_count())?;
        let mut cells = domain.cell_of_simplex().to_vec();
        cells.sort_unstable();
        let is_cut = cells.windows(2).any(|pair| pair[0] == pair[1]) || cells.last().is_some_and(|&last| last > i32::MAX as u32);
        let cell_of_top = if is_cut { Vec::new() } else { cells_of_tops(domain) };
        Ok(Self { point_of_vertex: Some(domain.point_of_vertex()), cell_of_top, points })
    }

    /// The numbering of a whole grid: vertices are points.
    ///
    /// # Errors
    /// [`TtkError::TooManyPoints`].
    pub fn of_points(count: usize) -> Result<Self, TtkError> {
        Ok(Self { point_of_vertex: None, cell_of_top: Vec::new(), points: checked(count)? })
    }

    fn point(&self, vertex: VertexId) -> i32 {
        self.point_of_vertex.map_or(vertex.0, |points| points[vertex.index()]) as i32
    }
}

fn checked(points: usize) -> Result<usize, TtkError> {
    if i32::try_from(points).is_ok() { Ok(points) } else { Err(TtkError::TooManyPoints { found: points }) }
}

fn cells_of_tops(domain: &Domain) -> Vec<u32> {
    let (complex, cells) = (&domain.complex, domain.cell_of_simplex());
    let mut cell_of_top = vec![0; cells.len()];
    for (simplex, &cell) in cells.iter().enumerate() {
        // Edges and triangles are sorted; tetrahedra keep their order.
        let top = match *complex.simplex(simplex) {
            [a, b] => complex.edge(VertexId(a), VertexId(b)).map(|edge| edge.0 as usize),
            [a, b, c] => complex.triangle([a, b, c].map(VertexId)).map(|triangle| triangle.0 as usize),
            _ => Some(simplex),
        };
        if let Some(slot) = top.and_then(|top| cell_of_top.get_mut(top)) {
            *slot = cell;
        }
    }
    cell_of_top
}

impl<T: Triangulation> TtkComplex<'_, T> {
    /// Critical points (port 0 of TTK's filter): one vertex cell a point.
    ///
    /// Point arrays: `CellDimension` (Int8, active), `CellId` (Int32), the field at the highest vertex (its own name and
    /// type), `IsOnBoundary` (Int8), `ttkVertexScalarField` (Int32, the point of the highest vertex), `ManifoldSize`
    /// (Int32, vertices in the basin of an extremum, 0 for saddles). Minima come first, and the `k`-th of them has label
    /// `k` in the segmentation; so do maxima, which come last.
    ///
    /// # Errors
    /// [`TtkError::ScalarLength`].
    pub fn critical_points(&self) -> Result<DataSet, TtkError> {
        self.check()?;
        let points = &self.complex.points;
        let positions: Vec<f32> = points.iter().flat_map(|point| self.position(point.cell)).collect();
        let mut verts = CellArray::default();
        (0..points.len() as i64).for_each(|point| verts.push([point]));
        let mut dataset = poly_data(positions, verts, CellArray::default());
        let at: Vec<usize> = points.iter().map(|point| self.numbering.point(point.vertex) as usize).collect();
        let arrays = vec![
            bytes("CellDimension", points.iter().map(|point| point.cell.dimension as i8)),
            ints("CellId", points.iter().map(|point| self.cell_id(point.cell))),
            DataArray::new(self.scalar.name.clone(), 1, picked(&self.scalar.data, &at)),
            bytes("IsOnBoundary", points.iter().map(|point| i8::from(point.is_on_boundary))),
            ints("ttkVertexScalarField", points.iter().map(|point| self.numbering.point(point.vertex))),
            ints("ManifoldSize", points.iter().map(|point| point.region_size as i32)),
        ];
        dataset.point_data = Attributes { arrays, active: vec![(Role::Scalars, "CellDimension".to_owned())] };
        Ok(dataset)
    }

    /// 1-separatrices (port 1): one line cell of two points a step, points not shared between separatrices.
    ///
    /// Point arrays: `ttkMaskScalarField` (Int8: 0 at both ends, 1 between), `CellDimension` (Int8), `CellId` (Int32). Cell
    /// arrays: `SourceId`, `DestinationId` (Int32: cell ids of the saddle and of the extremum, of a connector those of 1-saddle
    /// and 2-saddle), `SeparatrixId` (Int32), `SeparatrixType` (Int8, active: 0 to minima, 1 saddle connectors, dimension - 1
    /// to maxima), `SeparatrixFunctionMaximum`, `...Minimum`, `...Difference` (Float64), and
    /// `NumberOfCriticalPointsOnBoundary` (Int8).
    ///
    /// # Errors
    /// [`TtkError::ScalarLength`].
    pub fn separatrices(&self) -> Result<DataSet, TtkError> {
        self.check()?;
        let lines = &self.complex.lines;
        let cells: Vec<Cell> = lines.iter().flat_map(|line| line.cells.iter().copied()).collect();
        let positions: Vec<[f32; 3]> = cells.par_iter().map(|&cell| self.position(cell)).collect();
        let mut segments = CellArray::default();
        let mut steps: Vec<usize> = Vec::new();
        let mut mask: Vec<i8> = Vec::with_capacity(cells.len());
        for (number, line) in lines.iter().enumerate() {
            let begin = mask.len() as i64;
            let last = line.cells.len() - 1;
            mask.extend((0..=last).map(|place| i8::from(place != 0 && place != last)));
            (begin..begin + last as i64).for_each(|point| segments.push([point, point + 1]));
            steps.extend(std::iter::repeat_n(number, last));
        }
        let mut dataset = poly_data(positions.into_flattened(), CellArray::default(), segments);
        dataset.point_data.arrays = vec![
            bytes("ttkMaskScalarField", mask.into_iter()),
            bytes("CellDimension", cells.iter().map(|cell| cell.dimension as i8)),
            ints("CellId", cells.iter().map(|&cell| self.cell_id(cell))),
        ];
        let ends = |line: &SeparatrixLine| [line.source, line.destination].map(|place| self.complex.points[place]);
        let ranges: Vec<[f64; 2]> = lines.iter().map(|line| self.range(&ends(line))).collect();
        let each_int = |name: &str, value: &dyn Fn(usize) -> i32| ints(name, steps.iter().map(|&line| value(line)));
        let each_byte = |name: &str, value: &dyn Fn(usize) -> i8| bytes(name, steps.iter().map(|&line| value(line)));
        let each_double = |name: &str, value: &dyn Fn([f64; 2]) -> f64| {
            DataArray::new(name, 1, ArrayData::F64(steps.iter().map(|&line| value(ranges[line])).collect()))
        };
        let boundary = |line: usize| ends(&lines[line]).iter().filter(|point| point.is_on_boundary).count() as i8;
        let arrays = vec![
            each_int("SourceId", &|line| self.cell_id(ends(&lines[line])[0].cell)),
            each_int("DestinationId", &|line| self.cell_id(ends(&lines[line])[1].cell)),
            each_int("SeparatrixId", &|line| line as i32),
            each_byte("SeparatrixType", &|line| self.separatrix_type(lines[line].kind)),
            each_double("SeparatrixFunctionMaximum", &|[_, high]| high),
            each_double("SeparatrixFunctionMinimum", &|[low, _]| low),
            each_double("SeparatrixFunctionDifference", &|[low, high]| high - low),
            each_byte("NumberOfCriticalPointsOnBoundary", &boundary),
        ];
        dataset.cell_data = Attributes { arrays, active: vec![(Role::Scalars, "SeparatrixType".to_owned())] };
        Ok(dataset)
    }

    /// Segmentation (port 3): the input with three more point arrays, all Int32, -1 on points outside the domain.
    ///
    /// `AscendingManifold`: the maximum to which a vertex ascends; `DescendingManifold`: the minimum to which it descends;
    /// `MorseSmaleManifold`: one number a pair of the two. Labels count minima and maxima in the order of the critical points.
    /// TTK leaves -1 where an ascending path meets the boundary; here it goes on along the boundary, to a maximum there, so
    /// every vertex of the domain has all three.
    ///
    /// # Arguments
    /// * `input`: the data set from which the domain was made.
    ///
    /// # Errors
    /// [`TtkError::ScalarLength`].
    pub fn segmentation(&self, input: &DataSet) -> Result<DataSet, TtkError> {
        self.check()?;
        let mut dataset = input.clone();
        let complex = self.complex;
        let on_points = |name: &str, label: &dyn Fn(VertexId) -> Option<u32>| {
            let mut labels = vec![-1; self.numbering.points];
            for vertex in (0..complex.minima.vertex_count()).map(VertexId::from) {
                labels[self.numbering.point(vertex) as usize] = label(vertex).map_or(-1, |label| label as i32);
            }
            DataArray::new(name, 1, ArrayData::I32(labels))
        };
        dataset.set_point_array(on_points("AscendingManifold", &|vertex| complex.maxima.label(vertex)));
        dataset.set_point_array(on_points("DescendingManifold", &|vertex| complex.minima.label(vertex)));
        dataset.set_point_array(on_points("MorseSmaleManifold", &|vertex| complex.regions.label(vertex)));
        Ok(dataset)
    }

    fn check(&self) -> Result<(), TtkError> {
        let (expected, found) = (self.numbering.points, self.scalar.data.len());
        if expected == found { Ok(()) } else { Err(TtkError::ScalarLength { expected, found }) }
    }

    /// Vertices are named by their points, top cells by their cells where these are simplices.
    fn cell_id(&self, cell: Cell) -> i32 {
        let tops = &self.numbering.cell_of_top;
        match cell.dimension {
            0 => self.numbering.point(VertexId(cell.index)),
            dimension if usize::from(dimension) == self.triangulation.dimension() && !tops.is_empty() => {
                tops[cell.index as usize] as i32
            }
            _ => cell.index as i32,
        }
    }

    fn separatrix_type(&self, kind: LineKind) -> i8 {
        match kind {
            LineKind::Descending => 0,
            LineKind::Connector => 1,
            LineKind::Ascending => self.triangulation.dimension() as i8 - 1,
        }
    }

    /// Lowest value of the lowest vertices, highest value of the highest vertices of two critical cells.
    fn range(&self, ends: &[CriticalPoint; 2]) -> [f64; 2] {
        let value = |vertex: Option<VertexId>| {
            let at = vertex.map_or(0, |vertex| self.numbering.point(vertex) as usize);
            self.scalar.data.number(at).unwrap_or(f64::NAN)
        };
        let by_rank = |vertex: &VertexId| self.order.rank(*vertex);
        let vertices = ends.iter().flat_map(|point| self.triangulation.cell_vertices(point.cell));
        [value(vertices.clone().min_by_key(by_rank)), value(vertices.max_by_key(by_rank))]
    }

    fn position(&self, cell: Cell) -> [f32; 3] {
        let points: Vec<[f64; 3]> =
            self.triangulation.cell_vertices(cell).into_iter().map(|corner| self.triangulation.point(corner)).collect();
        incentre(&points).map(|coordinate| coordinate as f32)
    }
}

/// Where TTK puts a cell: vertices where they are, edges at their middle, triangles at the centre of the inscribed circle,
/// tetrahedra at the mean of those centres of their four faces.
fn incentre(points: &[[f64; 3]]) -> [f64; 3] {
    let weighted = |weights: &[f64], points: &[[f64; 3]]| {
        let sum: f64 = weights.iter().sum();
        [0, 1, 2].map(|axis| weights.iter().zip(points).map(|(weight, point)| weight * point[axis]).sum::<f64>() / sum)
    };
    match points {
        [a, b, c] => {
            let length = |p: &[f64; 3], q: &[f64; 3]| (0..3).map(|axis| (p[axis] - q[axis]).powi(2)).sum::<f64>().sqrt();
            let weights = [length(b, c), length(a, c), length(a, b)];
            if weights.iter().sum::<f64>() > 0.0 { weighted(&weights, points) } else { *a }
        }
        [a, b, c, d] => {
            let faces = [[*a, *b, *c], [*a, *b, *d], [*a, *c, *d], [*b, *c, *d]].map(|face| incentre(&face));
            weighted(&[1.0; 4], &faces)
        }
        _ => weighted(&vec![1.0; points.len()], points),
    }
}

fn poly_data(positions: Vec<f32>, verts: CellArray, lines: CellArray) -> DataSet {
    let points = DataArray::new("Points", 3, ArrayData::F32(positions));
    let (polys, strips) = (CellArray::default(), CellArray::default());
    DataSet::new(Geometry::PolyData { points, verts, lines, polys, strips })
}

fn bytes(name: &str, values: impl Iterator<Item = i8>) -> DataArray {
    DataArray::new(name, 1, ArrayData::I8(values.collect()))
}

fn ints(name: &str, values: impl Iterator<Item = i32>) -> DataArray {
    DataArray::new(name, 1, ArrayData::I32(values.collect()))
}

/// Some values of an array, in its type.
fn picked(data: &ArrayData, places: &[usize]) -> ArrayData {
    fn pick<V: Clone>(values: &[V], places: &[usize]) -> Vec<V> {
        places.iter().map(|&place| values[place].clone()).collect()
    }
    match data {
        ArrayData::I8(values) => ArrayData::I8(pick(values, places)),
        ArrayData::U8(values) => ArrayData::U8(pick(values, places)),
        ArrayData::I16(values) => ArrayData::I16(pick(values, places)),
        ArrayData::U16(values) => ArrayData::U16(pick(values, places)),
        ArrayData::I32(values) => ArrayData::I32(pick(values, places)),
        ArrayData::U32(values) => ArrayData::U32(pick(values, places)),
        ArrayData::I64(values) => ArrayData::I64(pick(values, places)),
        ArrayData::U64(values) => ArrayData::U64(pick(values, places)),
        ArrayData::F32(values) => ArrayData::F32(pick(values, places)),
        ArrayData::F64(values) => ArrayData::F64(pick(values, places)),
        ArrayData::Bit(values) => ArrayData::Bit(pick(values, places)),
        ArrayData::String(values) => ArrayData::String(pick(values, places)),
    }
}
