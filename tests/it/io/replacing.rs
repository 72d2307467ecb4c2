//! Files appear whole or not at all.

use morsmooth::io::{is_same_file, read, write, write_temporary};

use super::{content, file};

#[test]
fn a_file_is_in_its_place_only_after_commit() {
    let folder = tempfile::tempdir().unwrap();
    let target = folder.path().join("out.vti");
    std::fs::write(&target, "old").unwrap();
    let dataset = read(file("image_ascii.vti")).unwrap();
    let pending = write_temporary(&target, &dataset).unwrap();
    assert_eq!(std::fs::read(&target).unwrap(), b"old");
    assert_eq!(content(&read(pending.path()).unwrap()), content(&dataset));
    assert_eq!(pending.path().parent(), pending.target().parent());
    pending.commit().unwrap();
    assert_eq!(content(&read(&target).unwrap()), content(&dataset));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn a_file_that_is_not_committed_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let dataset = read(file("image_ascii.vti")).unwrap();
    drop(write_temporary(folder.path().join("out.vti"), &dataset).unwrap());
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn places_that_take_no_file_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let dataset = read(file("image_ascii.vti")).unwrap();
    let missing = folder.path().join("no/such/folder/out.vti");
    let error = write(&missing, &dataset).unwrap_err().to_string();
    assert_eq!(error, format!("cannot write {}: No such file or directory (os error 2)", missing.display()));

    let directory = folder.path().join("folder.vti");
    std::fs::create_dir(&directory).unwrap();
    let error = write(&directory, &dataset).unwrap_err().to_string();
    assert_eq!(error, format!("cannot write {}: it is a folder", directory.display()));

    let protected = folder.path().join("protected.vti");
    std::fs::write(&protected, "mine").unwrap();
    let mut permissions = std::fs::metadata(&protected).unwrap().permissions();
    permissions.set_readonly(true);
    std::fs::set_permissions(&protected, permissions).unwrap();
    let error = write(&protected, &dataset).unwrap_err().to_string();
    assert_eq!(error, format!("cannot write {}: it is write-protected", protected.display()));
    assert_eq!(std::fs::read(&protected).unwrap(), b"mine");
}

#[cfg(unix)]
#[test]
fn a_link_keeps_leading_to_its_file() {
    let folder = tempfile::tempdir().unwrap();
    let (real, link) = (folder.path().join("real.vti"), folder.path().join("link.vti"));
    std::fs::write(&real, "old").unwrap();
    std::os::unix::fs::symlink(&real, &link).unwrap();
    assert!(is_same_file(&real, &link));
    let dataset = read(file("image_ascii.vti")).unwrap();
    write(&link, &dataset).unwrap();
    assert!(std::fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(content(&read(&real).unwrap()), content(&dataset));
}

#[test]
fn the_same_file_is_known_by_any_name() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.vti");
    std::fs::write(&path, "").unwrap();
    std::fs::hard_link(&path, folder.path().join("b.vti")).unwrap();
    assert!(is_same_file(&path, &folder.path().join(".").join("a.vti")));
    assert!(is_same_file(&path, &folder.path().join("b.vti")));
    std::fs::write(folder.path().join("c.vti"), "").unwrap();
    assert!(!is_same_file(&path, &folder.path().join("c.vti")));
    assert!(!is_same_file(&path, &folder.path().join("none.vti")));
}
