//! Persistence diagrams as data sets, in the layout of the Topology ToolKit.

use crate::field::VertexId;
use crate::mesh::Domain;
use crate::morse::{PersistenceDiagram, PersistencePair};

use super::array::{ArrayData, DataArray, ValueType};
use super::dataset::{CellArray, DataSet, Geometry};

/// VTK's number for a line of two points.
const LINE: u8 = 3;
/// TTK's number for a maximum; minima are 0, saddles 1 and 2.
const MAXIMUM: i32 = 3;

/// Where the points of a diagram lie.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum DiagramLayout {
    /// In the plane of birth and death, with the diagonal as last cell; the places in the domain are the array `Coordinates`.
    #[default]
    Plane,
    /// At the vertices of the domain; without diagonal.
    Embedded,
}

/// The field of which a diagram is.
#[derive(Debug, Clone, Copy)]
pub struct DiagramField<'a> {
    /// The domain.
    pub domain: &'a Domain,
    /// `n` values.
    pub values: &'a [f64],
    /// The type in which births and persistences are stored: that of the array in the file.
    pub value_type: ValueType,
}

/// A pair as TTK lists it.
struct Row {
    vertices: [VertexId; 2],
    kinds: [i32; 2],
    pair_type: i32,
    is_finite: bool,
}

/// The diagram of a field as an unstructured grid with a line a pair, from its birth to its death.
///
/// Vertices are named by the points of the file. Classes that never die, first of all that of the global minimum, are paired
/// with the global maximum, as in TTK, and marked by `IsFinite` 0; those of the dimension of the domain are left out. Critical
/// types are those of TTK: 0 minimum, 1 and 2 saddles, 3 maximum; of a curve the deaths are maxima.
///
/// # Arguments
/// * `diagram`: of the order of the field's values.
///
/// # Returns
/// Point arrays `ttkVertexScalarField`, `CriticalType` (Int32) and, in the plane, `Coordinates` (Float32); cell arrays
/// `PairIdentifier`, `PairType` (Int32), `Persistence`, `Birth` (type of the values), `IsFinite` (UInt8). Pairs come by birth,
/// so that the first one is the global pair.
///
/// # Cost
/// O(p) for p pairs.
///
/// # Source
/// Layout: TTK, core/vtk/ttkPersistenceDiagram, `DiagramToVTU`.
pub fn diagram_dataset(diagram: &PersistenceDiagram, field: &DiagramField<'_>, layout: DiagramLayout) -> DataSet {
    let rows = rows(diagram);
    let value = |vertex: VertexId| field.values[vertex.index()];
    let place = |vertex: VertexId| field.domain.complex.point(vertex).map(|coordinate| coordinate as f32);
    let mut points: Vec<f32> = Vec::with_capacity(6 * rows.len());
    for Row { vertices: [birth, death], .. } in &rows {
        match layout {
            DiagramLayout::Embedded => [birth, death].into_iter().for_each(|&vertex| points.extend(place(vertex))),
            DiagramLayout::Plane => {
                let (born, dead) = (value(*birth) as f32, value(*death) as f32);
                points.extend([born, born, 0.0, born, dead, 0.0]);
            }
        }
    }
    let mut cells = CellArray::default();
    (0..rows.len() as i64).for_each(|pair| cells.push([2 * pair, 2 * pair + 1]));
    let persistences: Vec<f64> = rows.iter().map(|row| value(row.vertices[1]) - value(row.vertices[0])).collect();
    let births: Vec<f64> = rows.iter().map(|row| value(row.vertices[0])).collect();
    let value_type = fitting(field.value_type, &persistences);
    let mut columns = Columns {
        identifier: (0..rows.len() as i32).collect(),
        pair_type: rows.iter().map(|row| row.pair_type).collect(),
        persistence: persistences,
        birth: births,
        is_finite: rows.iter().map(|row| u8::from(row.is_finite)).collect(),
    };
    if let (DiagramLayout::Plane, Some(last)) = (layout, rows.len().checked_sub(1)) {
        // The diagonal, from the lowest birth to the highest.
        cells.push([0, 2 * last as i64]);
        columns.identifier.push(-1);
        columns.pair_type.push(-1);
        columns.persistence.push(2.0 * columns.persistence[0]);
        columns.birth.push(0.0);
        columns.is_finite.push(0);
    }
    let types = vec![LINE; cells.len()];
    let points = DataArray::new("Points", 3, ArrayData::F32(points));
    let mut dataset = DataSet::new(Geometry::UnstructuredGrid { points, cells, types, polyhedra: None });
    let both = || rows.iter().flat_map(|row| row.vertices);
    let name = |vertex: VertexId| field.domain.point_of_vertex()[vertex.index()] as i32;
    let mut set = |name: &str, components, data| dataset.point_data.set(DataArray::new(name, components, data));
    set("ttkVertexScalarField", 1, ArrayData::I32(both().map(name).collect()));
    set("CriticalType", 1, ArrayData::I32(rows.iter().flat_map(|row| row.kinds).collect()));
    if layout == DiagramLayout::Plane {
        set("Coordinates", 3, ArrayData::F32(both().flat_map(place).collect()));
    }
    let mut set = |name: &str, data| dataset.cell_data.set(DataArray::new(name, 1, data));
    set("PairIdentifier", ArrayData::I32(columns.identifier));
    set("PairType", ArrayData::I32(columns.pair_type));
    set("Persistence", ArrayData::of_numbers(value_type, &columns.persistence));
    set("Birth", ArrayData::of_numbers(value_type, &columns.birth));
    set("IsFinite", ArrayData::U8(columns.is_finite));
    dataset
}

/// The type asked for, unless a persistence is too great for it: bytes from -100 to 100 differ by 200.
fn fitting(value_type: ValueType, persistences: &[f64]) -> ValueType {
    let most = match value_type {
        ValueType::I8 => f64::from(i8::MAX),
        ValueType::I16 => f64::from(i16::MAX),
        ValueType::I32 => f64::from(i32::MAX),
        ValueType::I64 => i64::MAX as f64,
        _ => f64::INFINITY,
    };
    if persistences.iter().all(|&persistence| persistence <= most) { value_type } else { ValueType::F64 }
}

/// The cell arrays, the diagonal included. What twice the global persistence is cut to, where it does not fit, means nothing.
struct Columns {
    identifier: Vec<i32>,
    pair_type: Vec<i32>,
    persistence: Vec<f64>,
    birth: Vec<f64>,
    is_finite: Vec<u8>,
}

fn rows(diagram: &PersistenceDiagram) -> Vec<Row> {
    let dimension = diagram.dimension() as i32;
    let row = |pair: &PersistencePair| {
        let pair_type = i32::from(pair.dimension);
        // In 2-D the saddle of a saddle–maximum pair is written as a 2-saddle.
        let birth_kind = if dimension == 2 && pair_type == 1 { 2 } else { pair_type };
        let (death, death_kind) = match pair.death_vertex {
            Some(death) if pair_type + 1 < dimension => (death, pair_type + 1),
            Some(death) => (death, MAXIMUM),
            None if pair_type < dimension => (diagram.highest_vertex()?, MAXIMUM),
            None => return None,
        };
        let is_finite = pair.death_vertex.is_some();
        Some(Row { vertices: [pair.birth_vertex, death], kinds: [birth_kind, death_kind], pair_type, is_finite })
    };
    diagram.pairs().iter().filter_map(row).collect()
}
