//! Names with * and ?: of arrays, of files.

use std::cmp::Ordering;
use std::path::{Path, PathBuf};

use morsmooth::io::is_same_file;

use crate::failure::Failure;

/// Whether a name fits a pattern in which * stands for any characters and ? for one.
pub fn fits(pattern: &str, name: &str) -> bool {
    let (pattern, name): (Vec<char>, Vec<char>) = (pattern.chars().collect(), name.chars().collect());
    // fits[i]: whether the first i characters of the name fit the pattern so far.
    let mut fits = vec![false; name.len() + 1];
    fits[0] = true;
    for wanted in pattern {
        let before = fits.clone();
        for (place, &so_far) in before.iter().enumerate() {
            fits[place] = match wanted {
                '*' => so_far || place > 0 && fits[place - 1],
                _ => place > 0 && before[place - 1] && (wanted == '?' || wanted == name[place - 1]),
            };
        }
    }
    fits[name.len()]
}

/// The files whose names fit a pattern, 2 before 10; `None` for a path that is no pattern.
///
/// # Arguments
/// * `own`: files of an earlier run, which are not meant.
pub fn matching(pattern: &Path, own: &[PathBuf]) -> Result<Option<Vec<PathBuf>>, Failure> {
    let wanted = pattern.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    if !wanted.contains(['*', '?']) || pattern.exists() {
        return Ok(None);
    }
    let folder = match pattern.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let failed = |error: std::io::Error| Failure::file(pattern, format!("the folder {} cannot be read: {error}", folder.display()));
    let mut names: Vec<String> = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let name = entry.map_err(failed)?.file_name().to_string_lossy().into_owned();
        if !name.starts_with('.') && fits(&wanted, &name) {
            names.push(name);
        }
    }
    names.sort_by(|a, b| natural(a, b));
    let is_meant = |file: &PathBuf| file.is_file() && !own.iter().any(|own| is_same_file(own, file));
    let files: Vec<PathBuf> = names.iter().map(|name| pattern.with_file_name(name)).filter(is_meant).collect();
    match files.is_empty() {
        true => Err(Failure::file(pattern, "found no file that fits the pattern; expected at least one")),
        false => Ok(Some(files)),
    }
}

/// Digits compare as numbers.
fn natural(a: &str, b: &str) -> Ordering {
    let (mut left, mut right) = (a, b);
    let digits = |text: &str| text.len() - text.trim_start_matches(|character: char| character.is_ascii_digit()).len();
    loop {
        let (m, n) = (digits(left), digits(right));
        if m == 0 || n == 0 {
            match (left.chars().next(), right.chars().next()) {
                (Some(x), Some(y)) if x == y => {
                    left = &left[x.len_utf8()..];
                    right = &right[y.len_utf8()..];
                }
                (x, y) => return x.cmp(&y).then_with(|| a.cmp(b)),
            }
            continue;
        }
        let (x, y) = (left[..m].trim_start_matches('0'), right[..n].trim_start_matches('0'));
        let order = x.len().cmp(&y.len()).then_with(|| x.cmp(y));
        if order != Ordering::Equal {
            return order;
        }
        left = &left[m..];
        right = &right[n..];
    }
}
