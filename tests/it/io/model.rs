//! The data sets of the crate `vtkio`, both ways; its reader on what our writer wrote.

use morsmooth::io::{ArrayData, DataArray, DataSet, Geometry, IndexWidth, Role, from_vtkio, read, to_vtkio, write};
use vtkio::model::{DataSet as Theirs, Extent, ImageDataPiece, IOBuffer, Piece, PolyDataPiece, VertexNumbers, Vtk};

use super::{content, file};

const SOURCES: [&str; 5] = ["image_ascii.vti", "rectilinear_ascii.vtr", "structured_ascii.vts", "poly_ascii.vtp", "unstructured_ascii.vtu"];

/// What the other model has room for.
fn reduced(name: &str) -> DataSet {
    let mut dataset = read(file(name)).unwrap();
    dataset.field_data.clear();
    for attributes in [&mut dataset.point_data, &mut dataset.cell_data] {
        attributes.arrays.retain(|array| !matches!(array.data, ArrayData::String(_)));
        attributes.active.retain(|(role, _)| matches!(role, Role::Scalars | Role::Vectors));
        attributes.arrays.iter_mut().for_each(|array| {
            array.component_names.clear();
            array.information.clear();
            array.id_type = false;
        });
    }
    // VTK keeps the range of the points among their information, and widths of their numbers.
    match &mut dataset.geometry {
        Geometry::ImageData { origin, spacing, .. } => (*origin, *spacing) = ([0.5, -0.25, 0.0], [0.5, 2.0, 1.0]),
        Geometry::RectilinearGrid { coordinates, .. } => coordinates.iter_mut().for_each(|axis| axis.information.clear()),
        Geometry::StructuredGrid { points, .. } => points.information.clear(),
        Geometry::PolyData { points, verts, lines, polys, strips } => {
            points.information.clear();
            [verts, lines, polys, strips].into_iter().for_each(|cells| cells.width = IndexWidth::default());
        }
        Geometry::UnstructuredGrid { points, cells, .. } => {
            points.information.clear();
            cells.width = IndexWidth::default();
        }
    }
    dataset
}

#[test]
fn there_and_back_nothing_changes() {
    for name in SOURCES {
        let dataset = reduced(name);
        let (vtk, lost) = to_vtkio(&dataset).unwrap();
        assert_eq!(lost, Vec::<String>::new(), "{name}");
        let mut back = from_vtkio(&vtk).unwrap();
        // Names of axes and points, and widths of numbers of points, are no part of the other model.
        if let (Geometry::RectilinearGrid { coordinates: a, .. }, Geometry::RectilinearGrid { coordinates: b, .. }) = (&mut back.geometry, &dataset.geometry) {
            a.iter_mut().zip(b.iter()).for_each(|(a, b)| a.name.clone_from(&b.name));
        }
        assert_eq!(content(&back), content(&dataset), "{name}");
    }
}

#[test]
fn what_is_lost_is_told() {
    let whole = read(file("image_ascii.vti")).unwrap();
    let (_, lost) = to_vtkio(&whole).unwrap();
    for words in ["field array \"TimeValue\"", "point array \"labels\" of texts", "names of the components of point array \"velocity\"", "digits of origin"] {
        assert!(lost.iter().any(|one| one.contains(words)), "no {words} in {lost:?}");
    }
    assert!(to_vtkio(&read(file("turned_raw_none_64.vti")).unwrap()).unwrap().1.contains(&"rotated axes".to_owned()));
    assert!(to_vtkio(&read(file("polyhedron_ascii.vtu")).unwrap()).unwrap_err().to_string().contains("found polyhedra"));
}

#[test]
fn their_reader_reads_what_our_writer_wrote() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["poly_ascii.vtp", "unstructured_ascii.vtu", "structured_ascii.vts", "image_ascii.vti"] {
        // Arrays that its legacy reader knows.
        let mut dataset = reduced(name);
        for attributes in [&mut dataset.point_data, &mut dataset.cell_data] {
            attributes.active.clear();
            attributes.arrays.retain(|array| matches!(array.data, ArrayData::F64(_) | ArrayData::F32(_) | ArrayData::I32(_)) && array.name.is_ascii());
        }
        let path = folder.path().join(format!("{name}.vtk"));
        write(&path, &dataset).unwrap();
        let theirs = from_vtkio(&Vtk::import(&path).unwrap_or_else(|error| panic!("{name}: {error:?}"))).unwrap();
        let ours = read(&path).unwrap();
        assert_eq!((theirs.point_count(), theirs.cell_count()), (ours.point_count(), ours.cell_count()), "{name}");
        assert_eq!(theirs.points_f64(), ours.points_f64(), "{name}");
        let arrays = |dataset: &DataSet| -> Vec<(String, ArrayData)> {
            dataset.point_data.arrays.iter().chain(&dataset.cell_data.arrays).map(|array: &DataArray| (array.name.clone(), array.data.clone())).collect()
        };
        assert_eq!(arrays(&theirs), arrays(&ours), "{name}");
        assert!(!arrays(&ours).is_empty());
    }
}

#[test]
fn broken_data_sets_are_refused() {
    let of = |data: Theirs| Vtk { version: Default::default(), title: String::new(), byte_order: vtkio::model::ByteOrder::BigEndian, data, file_path: None };
    let polys = |numbers: VertexNumbers| {
        let piece = PolyDataPiece { points: IOBuffer::F32(vec![0.0; 9]), polys: Some(numbers), ..PolyDataPiece::default() };
        from_vtkio(&of(piece.into()))
    };
    let good = polys(VertexNumbers::Legacy { num_cells: 1, vertices: vec![3, 0, 1, 2] }).unwrap();
    assert_eq!((good.point_count(), good.cell_count()), (3, 1));
    for numbers in [
        VertexNumbers::Legacy { num_cells: 2, vertices: vec![3, 0, 1, 2] },
        VertexNumbers::Legacy { num_cells: 1, vertices: vec![3, 0, 1, 7] },
        VertexNumbers::XML { connectivity: vec![0, 1], offsets: vec![3] },
        VertexNumbers::XML { connectivity: vec![u64::MAX], offsets: vec![1] },
    ] {
        let error = polys(numbers.clone()).unwrap_err().to_string();
        assert!(error.contains("expected"), "{numbers:?}: {error}");
    }
    let source = Piece::Source("x.vtp".into(), None);
    let error = from_vtkio(&of(Theirs::PolyData { meta: None, pieces: vec![source] })).unwrap_err().to_string();
    assert!(error.contains("load_all_pieces"), "{error}");
    let piece = ImageDataPiece { extent: Extent::Dims([u32::MAX, 1, 1]), data: Default::default() };
    assert!(from_vtkio(&of(piece.into())).is_err());
}
