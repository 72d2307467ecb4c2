//! Damaged files: an error or a data set, never a panic, never more memory than the file can fill.

use morsmooth::io::{MaskSources, domain, mask};

use super::{file, read_text};

/// A generator without a seed from outside: the same damage every time.
pub(super) struct Random(pub(super) u64);

impl Random {
    pub(super) fn below(&mut self, bound: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % bound as u64) as usize
    }
}

const SOURCES: [&str; 18] = [
    "image_ascii.vti",
    "image_raw_none_64.vti",
    "image_raw_lz4_32.vti",
    "image_raw_lzma_64.vti",
    "image_base64_zlib_32.vti",
    "image_binary_zlib_64.vti",
    "image_big_endian.vti",
    "rectilinear_raw_zlib_64.vtr",
    "structured_ascii.vts",
    "poly_raw_zlib_64.vtp",
    "poly_two_pieces.vtp",
    "polyhedron_ascii.vtu",
    "polyhedron_raw_zlib_64.vtu",
    "polyhedron_42_binary.vtk",
    "poly_51_binary.vtk",
    "unstructured_51_ascii.vtk",
    "rectilinear_42_binary.vtk",
    "structured_42_ascii.vtk",
];

/// Reads and, if that succeeds, builds the domain, which must not panic either.
fn survive(folder: &tempfile::TempDir, bytes: &[u8]) -> bool {
    match read_text(folder, "damaged", bytes) {
        Ok(dataset) => {
            // A grid without arrays may declare any size; building it is what the user then asks for.
            if dataset.point_count() < 1000 {
                let _ = mask(&dataset, &MaskSources::default()).map(|mask| domain(&dataset, &mask));
            }
            true
        }
        Err(error) => {
            assert!(error.to_string().contains("expected"), "{error}");
            false
        }
    }
}

#[test]
fn truncated_files_are_refused_or_read() {
    let folder = tempfile::tempdir().unwrap();
    for name in SOURCES {
        let whole = std::fs::read(file(name)).unwrap();
        for part in 0..60 {
            survive(&folder, &whole[..whole.len() * part / 60]);
        }
    }
}

#[test]
fn files_cut_in_half_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for path in super::files() {
        let whole = std::fs::read(&path).unwrap();
        // Half a file without arrays can be a whole one.
        if !path.to_str().unwrap().contains("empty") {
            assert!(!survive(&folder, &whole[..whole.len() / 2]), "{}", path.display());
        }
    }
}

#[test]
fn flipped_bits_never_panic() {
    let folder = tempfile::tempdir().unwrap();
    let mut random = Random(0x1234_5678_9abc_def1);
    for name in SOURCES {
        let whole = std::fs::read(file(name)).unwrap();
        for _ in 0..200 {
            let mut damaged = whole.clone();
            for _ in 0..=random.below(3) {
                let place = random.below(damaged.len());
                damaged[place] ^= 1 << random.below(8);
            }
            survive(&folder, &damaged);
        }
    }
}

#[test]
fn digits_replaced_by_others_never_panic() {
    let folder = tempfile::tempdir().unwrap();
    let mut random = Random(0xfeed_5678_9abc_def1);
    for name in SOURCES {
        let whole = std::fs::read(file(name)).unwrap();
        let digits: Vec<usize> = (0..whole.len()).filter(|&place| whole[place].is_ascii_digit()).collect();
        for _ in 0..150 {
            let mut damaged = whole.clone();
            let place = digits[random.below(digits.len())];
            let replacement: &[u8] = [&b"-1"[..], b"9", b"99999999999", b"0", b"18446744073709551615"][random.below(5)];
            damaged.splice(place..=place, replacement.iter().copied());
            survive(&folder, &damaged);
        }
    }
}

#[test]
fn damaged_lists_never_panic() {
    let folder = tempfile::tempdir().unwrap();
    let whole = b"<VTKFile type=\"vtkMultiBlockDataSet\" version=\"1.0\"><vtkMultiBlockDataSet><Block index=\"0\" name=\"a\">\
        <DataSet index=\"0\" name=\"b\" file=\"n.vtu\"/><DataSet index=\"1\"/></Block></vtkMultiBlockDataSet></VTKFile>";
    let path = folder.path().join("list.vtm");
    let mut random = Random(0xabcd_5678_9abc_def1);
    let (mut read, mut refused) = (0, 0);
    for round in 0..2000 {
        let mut damaged = whole.to_vec();
        if round % 4 == 0 {
            damaged.truncate(random.below(whole.len()));
        } else {
            let place = random.below(damaged.len());
            damaged[place] ^= 1 << random.below(8);
        }
        std::fs::write(&path, &damaged).unwrap();
        match morsmooth::io::Collection::read(&path) {
            Ok(_) => read += 1,
            Err(error) => {
                assert!(error.to_string().contains("expected"), "{error}");
                refused += 1;
            }
        }
    }
    assert!(read > 100 && refused > 100, "{read} {refused}");
}
