//! Reading and writing take a moment only: bounds far above what was measured, to notice a slip of an order of magnitude.

use std::time::Instant;

use morsmooth::io::{ArrayData, DataArray, DataSet, Extent, Geometry, read, write};

#[test]
fn a_small_image_takes_milliseconds() {
    let mut dataset = DataSet::new(Geometry::ImageData {
        extent: Extent([0, 127, 0, 127, 0, 0]),
        origin: [0.0; 3],
        spacing: [1.0; 3],
        direction: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
    });
    for number in 0..6 {
        let values = (0..128 * 128).map(|step| f64::from(step * number).sin()).collect();
        dataset.set_point_array(DataArray::new(format!("array {number}"), 1, ArrayData::F64(values)));
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("small.vti");
    let best = (0..10)
        .map(|_| {
            let start = Instant::now();
            write(&path, &dataset).unwrap();
            assert_eq!(read(&path).unwrap().point_count(), 128 * 128);
            start.elapsed()
        })
        .min()
        .unwrap();
    eprintln!("writing and reading 128 x 128 x 6 values: {best:?}");
    assert!(best.as_millis() < 50, "{best:?}");
}
