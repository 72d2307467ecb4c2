//! Images: `.png`, 8 bits a channel, as image data whose first row is the lowest, as VTK reads them.

use std::io::{BufWriter, Cursor, Write};

use image::codecs::png::PngEncoder;
use image::{DynamicImage, ExtendedColorType, ImageDecoder, ImageEncoder, ImageFormat, ImageReader};

use crate::io::array::{ArrayData, DataArray};
use crate::io::dataset::{DataSet, Extent, Geometry, Role};
use crate::io::error::{Fault, Place};
use crate::io::write::Objection;

/// Name of the array of pixels, as VTK's own reader has it.
const NAME: &str = "PNGImage";

/// How many bytes of pixels a byte of the file can stand for at the most.
const MOST_EXPANSION: u64 = 1_040;

/// Reads an image; a point a pixel, 1 to 4 components of 8 bits. Deeper channels are rounded to 8 bits.
pub(super) fn read(bytes: &[u8]) -> Result<DataSet, Fault> {
    let told = |error: image::ImageError| Fault::new(Place::File, error.to_string(), "a PNG image");
    let decoder = ImageReader::with_format(Cursor::new(bytes), ImageFormat::Png).into_decoder().map_err(told)?;
    let (width, height) = decoder.dimensions();
    let bits = u64::from(width).saturating_mul(height.into()).saturating_mul(decoder.original_color_type().bits_per_pixel().into());
    if bits / 8 > MOST_EXPANSION.saturating_mul(bytes.len() as u64) {
        let found = format!("an image of {width} x {height} pixels in {} bytes", bytes.len());
        return Err(Fault::new(Place::File, found, "no more than the compressor can pack"));
    }
    let decoded = DynamicImage::from_decoder(decoder).map_err(told)?;
    let (width, height) = (decoded.width() as usize, decoded.height() as usize);
    let (components, pixels) = match (decoded.color().has_color(), decoded.color().has_alpha()) {
        (false, false) => (1, decoded.into_luma8().into_raw()),
        (false, true) => (2, decoded.into_luma_alpha8().into_raw()),
        (true, false) => (3, decoded.into_rgb8().into_raw()),
        (true, true) => (4, decoded.into_rgba8().into_raw()),
    };
    let extent = Extent::of_dimensions([width as i32, height as i32, 1]);
    let mut dataset = DataSet::new(Geometry::ImageData {
        extent,
        origin: [0.0; 3],
        spacing: [1.0; 3],
        direction: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
    });
    let flipped = pixels.chunks_exact(width * components).rev().flatten().copied().collect();
    dataset.set_point_array(DataArray::new(NAME, components, ArrayData::U8(flipped)));
    dataset.point_data.active.push((Role::Scalars, NAME.to_owned()));
    Ok(dataset)
}

/// The array that is the image: the active scalars, or else the only one of bytes.
fn pixels(dataset: &DataSet) -> Option<(usize, usize, &DataArray)> {
    let Geometry::ImageData { extent, .. } = &dataset.geometry else { return None };
    let [width, height, 1] = extent.dimensions() else { return None };
    let is_image = |array: &&DataArray| matches!(array.data, ArrayData::U8(_)) && (1..=4).contains(&array.components);
    let active = dataset.point_data.active(Role::Scalars).and_then(|name| dataset.point_array(name)).filter(is_image);
    let mut all = dataset.point_data.arrays.iter().filter(is_image);
    let array = match (active, all.next(), all.next()) {
        (Some(active), ..) => active,
        (None, Some(only), None) => only,
        _ => return None,
    };
    Some((width, height, array))
}

/// What an image leaves out, in words; an objection where the data set is none.
pub(super) fn losses(dataset: &DataSet) -> Result<Vec<String>, Objection> {
    let Some((.., image)) = pixels(dataset) else {
        let expected = "image data in the x-y plane with one point array of bytes, of 1 to 4 components";
        return Err((dataset.geometry.name().to_owned(), expected.to_owned()));
    };
    let others = dataset.point_data.arrays.iter().filter(|array| array.name != image.name);
    let mut lost: Vec<String> = others.map(|array| format!("point array \"{}\"", array.name.escape_debug())).collect();
    lost.extend(dataset.cell_data.arrays.iter().map(|array| format!("cell array \"{}\"", array.name.escape_debug())));
    lost.extend(dataset.field_data.iter().map(|array| format!("field array \"{}\"", array.name.escape_debug())));
    if let Geometry::ImageData { origin, spacing, .. } = &dataset.geometry
        && (*origin != [0.0; 3] || spacing[..2] != [1.0; 2])
    {
        lost.push("origin and spacing".to_owned());
    }
    Ok(lost)
}

/// Writes the image, its highest row first.
pub(super) fn write<W: Write>(dataset: &DataSet, out: &mut BufWriter<W>) -> std::io::Result<()> {
    let Some((width, height, DataArray { data: ArrayData::U8(bytes), components, .. })) = pixels(dataset) else {
        return Err(std::io::Error::other("the data set is no image"));
    };
    let flipped: Vec<u8> = bytes.chunks_exact((width * components).max(1)).rev().flatten().copied().collect();
    let colour = match components {
        1 => ExtendedColorType::L8,
        2 => ExtendedColorType::La8,
        3 => ExtendedColorType::Rgb8,
        _ => ExtendedColorType::Rgba8,
    };
    PngEncoder::new(out).write_image(&flipped, width as u32, height as u32, colour).map_err(std::io::Error::other)
}

/// The data set of an image in memory, rows from the top.
///
/// # Arguments
/// * `pixels`: `width x height x 4` bytes: red, green, blue and alpha.
///
/// # Panics
/// If the number of bytes is another one: a broken promise of the caller.
pub fn image_dataset(width: u32, height: u32, pixels: &[u8]) -> DataSet {
    let (across, down) = (width as usize, height as usize);
    assert_eq!(pixels.len(), 4 * across * down, "four bytes a pixel");
    let mut dataset = DataSet::new(Geometry::ImageData {
        extent: Extent::of_dimensions([width as i32, height as i32, 1]),
        origin: [0.0; 3],
        spacing: [1.0; 3],
        direction: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
    });
    let flipped = pixels.chunks_exact((4 * across).max(1)).rev().flatten().copied().collect();
    dataset.set_point_array(DataArray::new(NAME, 4, ArrayData::U8(flipped)));
    dataset
}
