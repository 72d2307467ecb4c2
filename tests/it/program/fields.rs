//! Small data sets, and a count of extrema that knows nothing of the library's.

use morsmooth::io::{ArrayData, CellArray, DataArray, DataSet, Extent, Geometry, MaskSources, domain, mask};

/// A double array.
pub fn doubles(name: &str, values: &[f64]) -> DataArray {
    DataArray::new(name, 1, ArrayData::F64(values.to_vec()))
}

/// An image with unit spacing.
pub fn image(dims: [usize; 3], arrays: Vec<DataArray>) -> DataSet {
    stretched([1.0; 3], [0.0; 3], dims, arrays)
}

/// An image with any spacing and origin.
pub fn stretched(spacing: [f64; 3], origin: [f64; 3], dims: [usize; 3], arrays: Vec<DataArray>) -> DataSet {
    let last = dims.map(|points| points as i32 - 1);
    let direction = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    let extent = Extent([0, last[0], 0, last[1], 0, last[2]]);
    let mut dataset = DataSet::new(Geometry::ImageData { extent, origin, spacing, direction });
    dataset.point_data.arrays = arrays;
    dataset
}

/// A number in [-1, 1] that looks random.
pub fn noise(number: usize) -> f64 {
    let mut bits = (number as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((bits ^ (bits >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

/// A few hills and valleys under noise.
pub fn hills(width: usize, height: usize) -> Vec<f64> {
    let value = |i: usize| {
        let (x, y) = ((i % width) as f64, (i / width) as f64);
        (x / 4.0).sin() * (y / 3.0).cos() + 0.3 * noise(i)
    };
    (0..width * height).map(value).collect()
}

/// The hills as the array `h` of an image.
pub fn hilly(width: usize, height: usize) -> DataSet {
    image([width, height, 1], vec![doubles("h", &hills(width, height))])
}

/// Cells of one length.
pub fn cells(corners: usize, points: &[i64]) -> CellArray {
    let mut list = CellArray::default();
    points.chunks(corners).for_each(|cell| list.push(cell.iter().copied()));
    list
}

/// A surface of polygons with the array `h`.
pub fn surface(points: &[[f64; 3]], polys: CellArray, values: &[f64]) -> DataSet {
    let (verts, lines, strips) = (CellArray::default(), CellArray::default(), CellArray::default());
    let mut dataset = DataSet::new(Geometry::PolyData { points: positions(points), verts, lines, polys, strips });
    dataset.set_point_array(doubles("h", values));
    dataset
}

/// An unstructured grid of cells of one VTK type with the array `h`.
pub fn unstructured(points: &[[f64; 3]], cells: CellArray, vtk_type: u8, values: &[f64]) -> DataSet {
    let types = vec![vtk_type; cells.len()];
    let points = positions(points);
    let mut dataset = DataSet::new(Geometry::UnstructuredGrid { points, cells, types, polyhedra: None });
    dataset.set_point_array(doubles("h", values));
    dataset
}

pub fn positions(points: &[[f64; 3]]) -> DataArray {
    DataArray::new("Points", 3, ArrayData::F64(points.concat()))
}

/// Points of a grid in a plane.
pub fn lattice(width: usize, height: usize) -> Vec<[f64; 3]> {
    (0..width * height).map(|i| [(i % width) as f64, (i / width) as f64, 0.0]).collect()
}

/// Corners of the squares of a grid, four a square.
pub fn squares(width: usize, height: usize) -> Vec<i64> {
    let mut corners = Vec::new();
    for y in 0..height - 1 {
        for x in 0..width - 1 {
            let low = (y * width + x) as i64;
            corners.extend([low, low + 1, low + width as i64 + 1, low + width as i64]);
        }
    }
    corners
}

/// Minima and maxima under plain `<`, by point, holes left out; points without any neighbour are neither.
pub fn plain_extrema(
    dataset: &DataSet,
    values: &[f64],
    mask_name: Option<&str>,
    holes_of: Option<&str>,
) -> (Vec<usize>, Vec<usize>) {
    let around = neighbours(dataset, mask_name, holes_of);
    let extrema = |beats: &dyn Fn(f64, f64) -> bool| -> Vec<usize> {
        let wins = |&i: &usize| !around[i].is_empty() && around[i].iter().all(|&j| beats(values[i], values[j]));
        (0..values.len()).filter(wins).collect()
    };
    (extrema(&|a, b| a < b), extrema(&|a, b| a > b))
}

/// Neighbours of every point. For images in the x-y plane written out by hand, else those of the library's domain.
fn neighbours(dataset: &DataSet, mask_name: Option<&str>, holes_of: Option<&str>) -> Vec<Vec<usize>> {
    let mut around = vec![Vec::new(); dataset.point_count()];
    match &dataset.geometry {
        Geometry::ImageData { extent, .. } if is_flat(extent) && mask_name.is_none_or(|name| dataset.cell_array(name).is_none()) => {
            let [width, height, _] = extent.dimensions();
            let flags = mask_name.map(|name| dataset.point_array(name).unwrap().to_f64(0));
            let data = holes_of.and_then(|name| dataset.point_array(name)).map(|array| array.to_f64(0));
            let kept = |i: usize| {
                flags.as_ref().is_none_or(|flags| flags[i] != 0.0) && data.as_ref().is_none_or(|data| !data[i].is_nan())
            };
            for y in 0..height - 1 {
                for x in 0..width - 1 {
                    let low = y * width + x;
                    for triangle in [[low, low + 1, low + width + 1], [low, low + width, low + width + 1]] {
                        if triangle.iter().all(|&i| kept(i)) {
                            for i in triangle {
                                around[i].extend(triangle.iter().copied().filter(|&j| j != i));
                            }
                        }
                    }
                }
            }
        }
        _ => {
            let holes = holes_of.filter(|name| dataset.point_array(name).is_some()).map(str::to_owned);
            let sources = MaskSources {
                array: mask_name.map(str::to_owned),
                holes: holes.into_iter().collect(),
                ..MaskSources::default()
            };
            let domain = domain(dataset, &mask(dataset, &sources).unwrap()).unwrap();
            for (vertex, &point) in domain.point_of_vertex().iter().enumerate() {
                let near = domain.complex.neighbours(vertex.into());
                around[point as usize] = domain.points_of(near).iter().map(|&point| point as usize).collect();
            }
        }
    }
    around
}

fn is_flat(extent: &Extent) -> bool {
    let [width, height, depth] = extent.dimensions();
    width > 1 && height > 1 && depth == 1
}
