//! Lists of files: addresses of blocks and steps, lists written again, fingerprints.

use morsmooth::io::{Collection, CollectionKind, fingerprint, read, resolve};

use super::{content, file};

const TREE: &str = "\u{feff}<?xml version='1.0'?>\n<VTKFile type=\"vtkMultiBlockDataSet\" version='1.0'><vtkMultiBlockDataSet>\n\
    <Block index=\"0\" name=\"flow\"><DataSet index=\"3\" name=\"wall\" file='a.vti' time='x'/><Block index='7'><Piece index=\"0\" name=\"p\">\
    <DataSet index=\"0\" file=\"b &amp; c.vti\"/></Piece></Block></Block><!-- twice the same name -->\
    <DataSet index=\"1\" name=\"twin\" file=\"a.vti\"/><DataSet index=\"2\" name=\"twin\"/>\n</vtkMultiBlockDataSet>\
    <FieldData><DataArray type=\"Int8\" Name=\"n\" format=\"ascii\">1</DataArray></FieldData></VTKFile>\n";

fn tree() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy(file("image_ascii.vti"), folder.path().join("a.vti")).unwrap();
    std::fs::copy(file("turned_raw_none_64.vti"), folder.path().join("b & c.vti")).unwrap();
    std::fs::write(folder.path().join("t.vtm"), TREE).unwrap();
    folder
}

#[test]
fn blocks_have_addresses_by_names_and_by_numbers() {
    let folder = tree();
    let path = folder.path().join("t.vtm");
    let list = Collection::read(&path).unwrap().unwrap();
    assert_eq!(list.kind, CollectionKind::Blocks);
    let addresses: Vec<(&str, &str)> = list.entries.iter().map(|entry| (entry.address.as_str(), entry.numbers.as_str())).collect();
    assert_eq!(addresses, [("flow/wall", "0/3"), ("flow/7/p/0", "0/7/0/0"), ("1", "1")]);
    assert_eq!(list.empty, ["2"]);
    for (address, own) in [("flow/wall", "a.vti"), ("0/3", "a.vti"), ("flow/7/p/0", "b & c.vti"), ("1", "a.vti")] {
        let own = folder.path().join(own);
        assert_eq!(resolve(path.join(address)).unwrap(), own);
        assert_eq!(content(&read(path.join(address)).unwrap()), content(&read(own).unwrap()), "{address}");
    }
    for (address, words) in [("flow", "found no block \"flow\"; expected one of flow/wall, flow/7/p/0, 1"), ("2", "found no block \"2\"")] {
        let error = read(path.join(address)).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
    // Other files are none, and a path that leads nowhere stays what it is.
    assert_eq!(Collection::read(folder.path().join("a.vti")).unwrap(), None);
    assert_eq!(resolve("no/such/file").unwrap(), std::path::Path::new("no/such/file"));
}

#[test]
fn a_list_written_again_differs_in_names_of_files_only() {
    let folder = tree();
    let list = Collection::read(folder.path().join("t.vtm")).unwrap().unwrap();
    let write = |files: [Option<&str>; 3]| {
        let files: Vec<Option<String>> = files.iter().map(|file| file.map(str::to_owned)).collect();
        let path = folder.path().join("copy.vtm");
        list.write_temporary(&path, &files).unwrap().commit().unwrap();
        std::fs::read_to_string(path).unwrap()
    };
    let bare = TREE.trim_start_matches('\u{feff}');
    assert_eq!(write([Some("a.vti"), Some("b & c.vti"), Some("a.vti")]), bare);
    let expected = bare.replacen("'a.vti'", "'&lt;x&gt;&apos;&quot;.vtu'", 1).replace("\"a.vti\"", "\"z.vti\"").replace(" file=\"b &amp; c.vti\"", " ");
    assert_eq!(write([Some("<x>'\".vtu"), None, Some("z.vti")]), expected);
    let again = Collection::read(folder.path().join("copy.vtm")).unwrap().unwrap();
    assert_eq!((again.empty, again.entries.len()), (vec!["flow/7/p/0".to_owned(), "2".to_owned()], 2));
    assert!(again.entries[0].path.ends_with("<x>'\".vtu"));
}

#[test]
fn a_list_that_names_itself_ends() {
    let folder = tempfile::tempdir().unwrap();
    let text = |file: &str| format!("<VTKFile type=\"Collection\"><Collection><DataSet timestep=\"0\" file=\"{file}\"/></Collection></VTKFile>");
    std::fs::write(folder.path().join("own.pvd"), text("own.pvd")).unwrap();
    std::fs::write(folder.path().join("a.pvd"), text("b.pvd")).unwrap();
    std::fs::write(folder.path().join("b.pvd"), text("a.pvd")).unwrap();
    for name in ["own.pvd", "a.pvd", "own.pvd/0/0/0/0/0", "a.pvd/0/0/0/0/0/0/x"] {
        let error = read(folder.path().join(name)).unwrap_err().to_string();
        assert!(error.contains("cannot be read here") || error.contains("found no block"), "{name}: {error}");
    }
    let _ = fingerprint(folder.path().join("a.pvd")).unwrap();
}

#[test]
fn a_fingerprint_changes_with_every_byte_that_would_be_read() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["wavelet.pvti", "wavelet_0.vti", "wavelet_1.vti", "wavelet_2.vti"] {
        std::fs::copy(file("parallel").join(name), folder.path().join(name)).unwrap();
    }
    let path = folder.path().join("wavelet.pvti");
    let mut seen = vec![fingerprint(&path).unwrap()];
    assert_eq!(seen[0], fingerprint(&path).unwrap());
    for name in ["wavelet_2.vti", "wavelet.pvti", "wavelet_0.vti"] {
        let place = folder.path().join(name);
        let mut bytes = std::fs::read(&place).unwrap();
        let middle = bytes.len() / 2;
        bytes[middle] ^= 1;
        std::fs::write(&place, bytes).unwrap();
        // The list itself may now be broken; it is put back.
        let found = fingerprint(&path);
        if name == "wavelet.pvti" {
            std::fs::copy(file("parallel").join(name), place).unwrap();
        } else {
            seen.push(found.unwrap());
        }
    }
    seen.sort_unstable();
    seen.dedup();
    assert_eq!(seen.len(), 3);
    std::fs::remove_file(folder.path().join("wavelet_1.vti")).unwrap();
    assert!(fingerprint(&path).unwrap_err().to_string().contains("wavelet_1.vti"));
    // FNV-1a of nothing, and then of its length.
    std::fs::write(folder.path().join("empty"), "").unwrap();
    let expected = (0..8).fold(0xcbf2_9ce4_8422_2325u64, |hash, _| hash.wrapping_mul(0x0100_0000_01b3));
    assert_eq!(fingerprint(folder.path().join("empty")).unwrap(), expected);
}
