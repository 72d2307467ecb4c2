//! Images: read as VTK reads them, written back, damaged.

use morsmooth::io::{ArrayData, DataArray, DataSet, Extent, Geometry, image_dataset, losses, read, write};

use super::read_text;

fn image(width: i32, height: i32, components: usize) -> DataSet {
    let mut dataset = DataSet::new(Geometry::ImageData {
        extent: Extent([0, width - 1, 0, height - 1, 0, 0]),
        origin: [0.0; 3],
        spacing: [1.0; 3],
        direction: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
    });
    let bytes = (0..width as usize * height as usize * components).map(|byte| (byte * 31 % 251) as u8).collect();
    dataset.set_point_array(DataArray::new("PNGImage", components, ArrayData::U8(bytes)));
    dataset
}

#[test]
fn images_of_one_to_four_components_come_back() {
    let folder = tempfile::tempdir().unwrap();
    for components in 1..=4 {
        let before = image(7, 4, components);
        let path = folder.path().join("a.png");
        write(&path, &before).unwrap();
        let after = read(&path).unwrap();
        assert_eq!((&after.geometry, &after.point_data.arrays), (&before.geometry, &before.point_data.arrays));
        assert_eq!(losses(&path, &before).unwrap(), Vec::<String>::new());
    }
}

#[test]
fn the_first_row_of_an_image_is_the_highest_of_the_data_set() {
    let pixels: Vec<u8> = (0..2 * 3).flat_map(|pixel| [pixel, 0, 0, 255]).collect();
    let dataset = image_dataset(2, 3, &pixels);
    let red = dataset.point_data.arrays[0].to_f64(0);
    assert_eq!(red, [4.0, 5.0, 2.0, 3.0, 0.0, 1.0]);
}

#[test]
fn what_is_no_image_is_refused_and_what_is_lost_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    let mut solid = image(4, 3, 3);
    solid.set_point_array(DataArray::new("depth", 1, ArrayData::F64(vec![0.0; 12])));
    assert_eq!(losses(&path, &solid).unwrap(), ["point array \"depth\""]);
    let line = morsmooth::io::polyline(&[0.0, 1.0], &[0, 1]);
    let message = write(&path, &line).unwrap_err().to_string();
    assert!(message.ends_with("found PolyData; expected image data in the x-y plane with one point array of bytes, of 1 to 4 components"), "{message}");
    assert!(!path.exists());
}

#[test]
fn damaged_images_are_refused_and_never_a_panic() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    write(&path, &image(9, 5, 4)).unwrap();
    let whole = std::fs::read(&path).unwrap();
    for length in [1, 8, 20, 33, 41, whole.len() - 30] {
        assert!(read_text(&folder, "cut.png", &whole[..length]).is_err(), "{length}");
    }
    for place in (0..whole.len()).step_by(3) {
        let mut broken = whole.clone();
        broken[place] ^= 0x55;
        // A flip in a chunk that is not looked at may pass.
        let _ = read_text(&folder, "flip.png", &broken);
    }
    let message = read_text(&folder, "text.png", b"no image at all").unwrap_err().to_string();
    assert!(message.contains("text.png: found ") && message.ends_with("expected a PNG image"), "{message}");
}
