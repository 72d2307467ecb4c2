//! What is said of a run of `morsmooth complex`.

use std::io::Write;
use std::path::{Path, PathBuf};

use morsmooth::mesh::{SimplicialComplex, Triangulation};
use morsmooth::morse::{LineKind, MorseSmaleComplex};
use morsmooth::plot::{FieldView, PictureOptions, complex_picture};
use serde_json::{Value, json};

use crate::common::number::short;
use crate::common::pictures::{plot_failure, prepare};
use crate::failure::Failure;
use crate::fields::complex::Field;

/// Everything about one run.
pub struct ComplexJob<'a> {
    pub field: &'a Field,
    pub complex: &'a MorseSmaleComplex,
    /// Number of cells by dimension.
    pub cells: [usize; 4],
    pub dimension: usize,
    /// Critical cells by dimension before simplification.
    pub unsimplified: [usize; 4],
    pub threshold: Option<f64>,
    pub targets: &'a [PathBuf],
    pub seconds: f64,
}

/// What critical points of each dimension are called.
fn names(dimension: usize) -> Vec<&'static str> {
    match dimension {
        1 => vec!["minima", "maxima"],
        2 => vec!["minima", "saddles", "maxima"],
        _ => vec!["minima", "1-saddles", "2-saddles", "maxima"],
    }
}

impl ComplexJob<'_> {
    fn lines(&self, kind: LineKind) -> usize {
        self.complex.lines.iter().filter(|line| line.kind == kind).count()
    }

    /// The report.
    pub fn to_json(&self) -> Value {
        let counts = |counts: [usize; 4]| -> Value {
            names(self.dimension).into_iter().zip(counts).map(|(name, count)| (name.to_owned(), json!(count))).collect()
        };
        let mut report = json!({
            "program": "morsmooth",
            "version": env!("CARGO_PKG_VERSION"),
            "input": self.field.path.display().to_string(),
            "array": self.field.scalar.name,
            "mask": self.field.mask,
            "points": self.field.dataset.point_count(),
            "vertices": self.cells[0],
            "simplices": self.cells[self.dimension],
            "dimension": self.dimension,
            "notes": self.field.notes,
        });
        report["threshold"] = json!(self.threshold);
        report["critical_cells_unsimplified"] = counts(self.unsimplified);
        report["critical_points"] = counts(self.complex.counts);
        report["maxima_on_the_boundary_only"] = json!(self.complex.boundary_maxima);
        report["separatrices"] = json!({
            "descending": self.lines(LineKind::Descending),
            "ascending": self.lines(LineKind::Ascending),
            "saddle_connectors": self.lines(LineKind::Connector),
            "tangled_saddle_pairs": self.complex.tangled,
        });
        report["segments"] = json!({
            "minima": self.complex.minima.extrema().len(),
            "maxima": self.complex.maxima.extrema().len(),
            "both": self.complex.regions.pairs().len(),
        });
        report["outputs"] = self.targets.iter().map(|target| target.display().to_string()).collect();
        report["seconds"] = json!({ "compute": self.seconds });
        report
    }

    /// The summary, on standard output; a closed pipe is not an error.
    pub fn print(&self) {
        let list = |counts: [usize; 4]| {
            let named = names(self.dimension).into_iter().zip(counts);
            named.map(|(name, count)| format!("{count} {name}")).collect::<Vec<_>>().join(", ")
        };
        let (low, high) = self.field.values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &v| (l.min(v), h.max(v)));
        let mut lines = vec![
            ("field", format!("{} on {} vertices, values {} to {}", self.field.scalar.name, self.field.values.len(), short(low), short(high))),
            ("critical cells", list(self.unsimplified)),
        ];
        let rule = self.threshold.map_or(String::new(), |threshold| format!(" (persistence above {})", short(threshold)));
        lines.push(("kept", format!("{}{rule}", list(self.complex.counts))));
        if self.complex.boundary_maxima > 0 {
            lines.push(("", format!("{} of the maxima are on the boundary, where no cell is critical", self.complex.boundary_maxima)));
        }
        let connectors = match self.dimension {
            3 => format!(", {} saddle connectors", self.lines(LineKind::Connector)),
            _ => String::new(),
        };
        lines.push((
            "separatrices",
            format!("{} descending, {} ascending{connectors}", self.lines(LineKind::Descending), self.lines(LineKind::Ascending)),
        ));
        if self.complex.tangled > 0 {
            lines.push(("", format!("{} pairs of saddles have too many V-paths between them to draw one", self.complex.tangled)));
        }
        lines.push((
            "segments",
            format!(
                "{} of minima, {} of maxima, {} of both",
                self.complex.minima.extrema().len(),
                self.complex.maxima.extrema().len(),
                self.complex.regions.pairs().len()
            ),
        ));
        lines.push(("time", format!("{:.2} s", self.seconds)));
        lines.extend(self.targets.iter().map(|target| ("output", target.display().to_string())));
        let mut stdout = std::io::stdout().lock();
        for (what, text) in lines {
            let _ = writeln!(stdout, "{what:<15} {text}");
        }
    }
}

/// The field with its Morse–Smale complex.
///
/// # Arguments
/// * `complex`: what is coloured; `cells`: the same vertices with the cells of the Morse–Smale complex.
pub fn picture<T: Triangulation>(
    directory: &Path,
    job: &ComplexJob<'_>,
    complex: &SimplicialComplex,
    cells: &T,
) -> Result<(), Failure> {
    prepare(directory)?;
    let (minima, maxima) = (job.complex.minima.extrema(), job.complex.maxima.extrema());
    let title = format!("{} minima, {} maxima, {} separatrices", minima.len(), maxima.len(), job.complex.lines.len());
    let view = FieldView { title: &title, values: &job.field.values, minima, maxima };
    let options = PictureOptions { label: job.field.scalar.name.clone(), ..PictureOptions::default() };
    let target = directory.join("complex.png");
    complex_picture(complex, cells, job.complex, &view, &options)
        .and_then(|picture| picture.write_png(&target))
        .map_err(|error| plot_failure(&target, &error))
}
