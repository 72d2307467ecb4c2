//! From files to domains.

use morsmooth::io::{ArrayData, DataArray, DataSet, DomainIoError, Extent, Geometry, MaskSources, domain, mask, read};

use super::{file, read_text};

fn image(points: [i32; 3]) -> DataSet {
    let [x, y, z] = points.map(|count| count - 1);
    DataSet::new(Geometry::ImageData {
        extent: Extent([0, x, 0, y, 0, z]),
        origin: [0.0; 3],
        spacing: [1.0; 3],
        direction: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
    })
}

fn masked(dataset: &DataSet, sources: &MaskSources) -> Result<[usize; 3], DomainIoError> {
    let complex = domain(dataset, &mask(dataset, sources)?)?.complex;
    Ok([complex.dimension(), complex.vertex_count(), complex.simplex_count()])
}

fn by_name(name: &str) -> MaskSources {
    MaskSources { array: Some(name.into()), ..MaskSources::default() }
}

#[test]
fn every_kind_of_file_becomes_a_domain() {
    for (name, expected) in [
        ("image_ascii.vti", [2, 9, 8]),
        ("rectilinear_ascii.vtr", [3, 12, 12]),
        ("structured_ascii.vts", [2, 6, 4]),
        // One triangle of the quadrilateral is in the strip too.
        ("poly_ascii.vtp", [2, 9, 5]),
        ("structured_42_binary.vtk", [2, 6, 4]),
    ] {
        assert_eq!(masked(&read(file(name)).unwrap(), &MaskSources::default()).unwrap(), expected, "{name}");
    }
    let volume = masked(&read(file("unstructured_ascii.vtu")).unwrap(), &MaskSources::default()).unwrap();
    assert_eq!(volume[..2], [3, 9]);
}

#[test]
fn polylines_of_either_kind_of_file_become_a_domain_of_dimension_1() {
    let folder = tempfile::tempdir().unwrap();
    let points = r#"<Points><DataArray type="Float32" NumberOfComponents="3">0 0 0 1 2 0 2 1 0 3 4 0</DataArray></Points>"#;
    let poly = format!(
        r#"<VTKFile type="PolyData"><PolyData><Piece NumberOfPoints="4" NumberOfLines="1">{points}
        <Lines><DataArray type="Int64" Name="connectivity">0 1 2 3</DataArray>
        <DataArray type="Int64" Name="offsets">4</DataArray></Lines></Piece></PolyData></VTKFile>"#
    );
    let cells = format!(
        r#"<VTKFile type="UnstructuredGrid"><UnstructuredGrid><Piece NumberOfPoints="4" NumberOfCells="3">{points}
        <Cells><DataArray type="Int32" Name="connectivity">0 1 1 2 2 3</DataArray>
        <DataArray type="Int32" Name="offsets">2 4 6</DataArray><DataArray type="UInt8" Name="types">3 3 3</DataArray>
        </Cells></Piece></UnstructuredGrid></VTKFile>"#
    );
    for text in [poly, cells] {
        let dataset = read_text(&folder, "line", text.as_bytes()).unwrap();
        assert_eq!(masked(&dataset, &MaskSources::default()).unwrap(), [1, 4, 3]);
    }
}

#[test]
fn a_mask_by_name_takes_points_or_cells_out() {
    let mut grid = image([3, 3, 1]);
    grid.set_point_array(DataArray::new("valid", 1, ArrayData::I8(vec![1, 1, 1, 1, 1, 1, 1, 1, 0])));
    grid.cell_data.set(DataArray::new("fluid", 1, ArrayData::F32(vec![1.0, f32::NAN, 2.0, -3.0])));
    assert_eq!(masked(&grid, &by_name("valid")).unwrap(), [2, 8, 6]);
    assert_eq!(masked(&grid, &by_name("fluid")).unwrap(), [2, 8, 6]);
    assert_eq!(masked(&grid, &MaskSources::default()).unwrap(), [2, 9, 8]);
}

#[test]
fn nan_values_are_holes() {
    let mut grid = image([3, 3, 1]);
    let mut values = vec![0.0; 9];
    values[0] = f64::NAN;
    grid.set_point_array(DataArray::new("h", 1, ArrayData::F64(values)));
    let sources = MaskSources { holes: vec!["h".into()], ..MaskSources::default() };
    assert_eq!(masked(&grid, &sources).unwrap(), [2, 8, 6]);
}

#[test]
fn hidden_points_and_cells_are_outside_but_duplicates_inside() {
    let mut grid = image([3, 3, 1]);
    grid.set_point_array(DataArray::new("vtkGhostType", 1, ArrayData::U8(vec![2, 1, 0, 0, 0, 0, 0, 0, 0])));
    assert_eq!(masked(&grid, &MaskSources::default()).unwrap(), [2, 8, 6]);
    grid.cell_data.set(DataArray::new("vtkGhostType", 1, ArrayData::U8(vec![1, 0, 0, 32])));
    assert_eq!(masked(&grid, &MaskSources::default()).unwrap(), [2, 7, 4]);
    let all = MaskSources { ghosts: false, ..MaskSources::default() };
    assert_eq!(masked(&grid, &all).unwrap(), [2, 9, 8]);
    // Old files mark duplicates by level; they are no holes.
    let mut old = image([3, 3, 1]);
    old.set_point_array(DataArray::new("vtkGhostLevels", 1, ArrayData::U8(vec![1; 9])));
    assert_eq!(masked(&old, &MaskSources::default()).unwrap(), [2, 9, 8]);
}

#[test]
fn masks_that_are_none_are_refused() {
    let grid = read(file("image_ascii.vti")).unwrap();
    let message = |sources: &MaskSources| mask(&grid, sources).unwrap_err().to_string();
    assert_eq!(
        message(&by_name("valid")),
        "found no point or cell array \"valid\"; expected one of: speed, single ρ, velocity, int8, uint8, int16, uint16, \
         int32, uint32, int64, uint64, bits, ids, labels, material"
    );
    assert_eq!(
        message(&by_name("velocity")),
        "found 3 components of type Float64 in mask \"velocity\"; expected one number each"
    );
    assert_eq!(message(&by_name("labels")), "found 1 components of type String in mask \"labels\"; expected one number each");
    let holes = MaskSources { holes: vec!["speeed".into()], ..MaskSources::default() };
    assert!(message(&holes).starts_with("found no point array \"speeed\"; expected one of: speed, single ρ"));
}

#[test]
fn cells_without_subdivision_are_refused_by_name_unless_masked() {
    let mut dataset = read(file("polyhedron_ascii.vtu")).unwrap();
    let error = masked(&dataset, &MaskSources::default()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "found cell 4 of VTK type 42 (polyhedron); expected linear cells (types 1 to 14): linearise or tetrahedralise it, or mask it"
    );
    dataset.cell_data.set(DataArray::new("linear", 1, ArrayData::Bit(vec![true, true, false, false, false])));
    assert_eq!(masked(&dataset, &by_name("linear")).unwrap()[..2], [3, 9]);
}

#[test]
fn an_empty_data_set_is_no_domain() {
    for name in ["empty.vtp", "empty_base64.vtu"] {
        let error = masked(&read(file(name)).unwrap(), &MaskSources::default()).unwrap_err();
        assert!(error.to_string().starts_with("the domain is empty: 0 points, 0 cells"), "{error}");
    }
}
