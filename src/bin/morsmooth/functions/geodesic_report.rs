//! What `morsmooth geodesic` says of a run.

use std::io::Write;

use morsmooth::audit::AuditReport;
use morsmooth::mesh::Domain;
use morsmooth::smooth::Smoothed;
use serde_json::{Value, json};

use crate::common::input::FieldInput;
use crate::common::number::short;
use crate::common::report::{audit_json, audit_line, command_line, status_name, wanted_json};
use crate::functions::geodesic::{Distance, GeodesicArgs, MethodKind, SMOOTH};
use crate::functions::geodesic_sources::Sources;

/// A finished run.
pub struct GeodesicJob<'a> {
    /// What was asked.
    pub args: &'a GeodesicArgs,
    /// Where distances start.
    pub sources: &'a Sources,
    /// Where they are.
    pub domain: &'a Domain,
    /// That from all sources, or from each.
    pub distances: &'a [Distance],
    /// Time of the distances alone, with the layout or the factors.
    pub distance_seconds: f64,
    /// The field that was smoothed, and the result.
    pub smoothed: Option<(FieldInput, Smoothed)>,
    /// The verdict on the file.
    pub audit: Option<AuditReport>,
    /// Time of the run.
    pub seconds: f64,
}

impl GeodesicJob<'_> {
    /// The farthest point and its distance.
    fn farthest(&self, distance: &Distance) -> (u32, f64) {
        let finite = distance.values.iter().enumerate().filter(|(_, distance)| distance.is_finite());
        let farthest = finite.fold((0, 0.0), |best, (vertex, &distance)| if distance > best.1 { (vertex, distance) } else { best });
        (self.domain.point_of_vertex()[farthest.0], farthest.1)
    }

    fn method(&self) -> &'static str {
        match self.args.method {
            MethodKind::Exact => "exact",
            MethodKind::Heat => "heat",
        }
    }

    /// Everything measured.
    pub fn to_json(&self) -> Value {
        let arrays: Vec<Value> = self.distances.iter().map(|distance| self.array(distance)).collect();
        let mut report = json!({
            "program": "morsmooth", "version": env!("CARGO_PKG_VERSION"), "command": command_line(),
            "input": self.args.input, "output": self.args.output, "arrays": arrays, "method": self.method(),
            "sources": self.sources.points.len(), "curve_spacing": self.sources.spacing, "vertices": self.domain.complex.vertex_count(),
            "seconds": { "distances": self.distance_seconds, "run": self.seconds },
        });
        if let (Some((input, result)), Some(audit), Some(fields)) = (&self.smoothed, &self.audit, report.as_object_mut()) {
            fields.insert("output_array".to_owned(), json!(SMOOTH));
            fields.insert("smooth".to_owned(), json!(result.report));
            fields.insert("wanted".to_owned(), wanted_json(input, &result.wanted, &result.selected_on.values, &result.rules));
            fields.insert("audit".to_owned(), audit_json(input, audit));
        }
        report
    }

    fn array(&self, distance: &Distance) -> Value {
        let (point, farthest) = self.farthest(distance);
        json!({
            "array": distance.array, "source": distance.source, "unreached": distance.unreached(),
            "farthest": { "point": point, "distance": farthest },
        })
    }

    /// A few lines; a closed pipe is not an error.
    pub fn print_summary(&self) {
        let mut out = std::io::stdout().lock();
        for distance in self.distances {
            let (point, farthest) = self.farthest(distance);
            let from = match (&distance.source, self.sources.points.len()) {
                (Some(source), _) => source.clone(),
                (None, 1) => "1 source".to_owned(),
                (None, count) => format!("{count} sources"),
            };
            let _ = writeln!(out, "{}: {} from {from}, farthest {} at point {point}", distance.array, self.method(), short(farthest));
            if distance.unreached() > 0 {
                let _ = writeln!(out, "{} points are not reached: NaN", distance.unreached());
            }
        }
        let _ = writeln!(out, "distances in {:.3} s", self.distance_seconds);
        if let (Some((_, result)), Some(audit)) = (&self.smoothed, &self.audit) {
            let report = &result.report;
            let _ = writeln!(out, "{SMOOTH}: before {}, after {}", report.before, report.wanted);
            let stages: Vec<String> = report.timing.stages.iter().map(|(name, seconds)| format!("{name} {seconds:.3}")).collect();
            let _ = writeln!(out, "solver: {}; seconds: {}", status_name(&report.solver.status), stages.join(", "));
            let _ = writeln!(out, "{}", audit_line(audit));
        }
    }
}
