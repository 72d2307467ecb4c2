//! What `weights` tells: the table, the JSON report, the pictures.

use std::io::Write;
use std::path::Path;

use morsmooth::audit::{Defects, ExtremumType, PlateauReport};
use morsmooth::field::VertexId;
use morsmooth::interpolate::SkinningWeights;
use morsmooth::plot::{FieldView, PictureOptions, field_picture};
use morsmooth::qp::QpStatus;
use serde_json::{Value, json};

use crate::args::MethodKind;
use crate::common::report::command_line;
use crate::failure::Failure;
use crate::functions::weights::{Scene, WeightsArgs};

/// A run that found weights.
pub struct WeightsJob<'a> {
    /// The command line.
    pub args: &'a WeightsArgs,
    /// Mesh and handles.
    pub scene: &'a Scene,
    /// The weights.
    pub found: &'a SkinningWeights,
    /// The audit of the file, one a handle.
    pub verdicts: &'a [PlateauReport],
    /// Whether the linear systems had auxiliary unknowns.
    pub is_mixed: bool,
    /// Nonzeros of a factor.
    pub factor_entries: usize,
    /// Whether the file was written.
    pub is_kept: bool,
    /// Of reading, operators and analysis, solves, all.
    pub seconds: [f64; 4],
}

impl WeightsJob<'_> {
    /// What a user should know though the run succeeded.
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        for (name, report) in self.scene.attached.names().iter().zip(&self.found.reports) {
            match &report.function.status {
                QpStatus::Solved => {}
                QpStatus::Infeasible(_) => warnings.push(format!("the solver found the order of handle {name} infeasible; the extrema hold all the same")),
                status => warnings.push(format!(
                    "the solver ended with {status:?} on handle {name}: gap {:.1e}, residual {:.1e}; the extrema hold all the same",
                    report.function.gap, report.function.residual
                )),
            }
        }
        warnings
    }

    /// The report.
    pub fn to_json(&self) -> Value {
        let domain = &self.scene.domain;
        let handles = self.scene.attached.names().iter().enumerate().map(|(handle, name)| {
            let (report, verdict) = (&self.found.reports[handle], &self.verdicts[handle]);
            let function = &report.function;
            json!({
                "name": name,
                "array": self.scene.array_name(self.args, handle),
                "vertices": self.scene.attached.vertices()[handle].len(),
                "audit": self.audit_json(verdict),
                "as_found": self.audit_json(&report.found),
                "if_only_divided": report.divided.as_ref().map(|divided| self.audit_json(divided)),
                "energy": report.energy,
                "energy_as_found": function.energy,
                "energy_by_round": function.rounds,
                "solver": {
                    "status": function.status, "residual": function.residual, "gap": function.gap, "rows": function.rows,
                    "active_rows": function.active_rows, "iterations": function.iterations, "factorizations": function.factorizations,
                },
                "constant_vertices": function.constant,
                "representative_replaced": function.guide_replaced,
                "largest_repair": function.largest_repair,
                "seconds": function.seconds,
            })
        });
        let [read, analysis, solve, total] = self.seconds;
        json!({
            "program": "morsmooth",
            "version": env!("CARGO_PKG_VERSION"),
            "command": command_line(),
            "mesh": self.args.mesh,
            "output": self.args.output,
            "written": self.is_kept,
            "vertices": domain.complex.vertex_count(),
            "simplices": domain.complex.simplex_count(),
            "dimension": domain.complex.dimension(),
            "method": format!("{:?}", self.args.method).to_lowercase(),
            "order": self.args.order,
            "partition": format!("{:?}", self.args.partition).to_lowercase(),
            "passed": self.verdicts.iter().all(|verdict| verdict.passed),
            "energy": self.found.energy,
            "off_unity_as_found": self.found.off_unity.0,
            "off_unity": self.found.off_unity.1,
            "turns": self.found.turns,
            "cut_off": self.found.cut_off,
            "mixed_form": self.is_mixed,
            "factor_entries": self.factor_entries,
            "handles": handles.collect::<Vec<_>>(),
            "seconds": { "read": read, "analysis": analysis, "solve": solve, "total": total },
        })
    }

    fn audit_json(&self, report: &PlateauReport) -> Value {
        let point = |vertex: VertexId| self.scene.domain.point_of_vertex()[vertex.index()];
        let kind = |kind| if kind == ExtremumType::Minimum { "minimum" } else { "maximum" };
        let listed = |defects: &Defects<(VertexId, ExtremumType)>| -> Vec<Value> {
            defects.first.iter().map(|&(vertex, of)| json!({ "point": point(vertex), "kind": kind(of) })).collect()
        };
        json!({
            "passed": report.passed,
            "minima": report.found_minima, "maxima": report.found_maxima,
            "wanted_minima": report.wanted_minima, "wanted_maxima": report.wanted_maxima,
            "spurious": report.spurious.count, "first_spurious": listed(&report.spurious),
            "missing": report.missing.count, "first_missing": listed(&report.missing),
            "moved_values": report.moved_values.count,
            "flat": report.flat.count,
            "range": [report.range.0, report.range.1],
        })
    }

    /// The table on standard output; a closed pipe is not an error.
    pub fn print(&self) {
        let mut out = std::io::stdout().lock();
        let complex = &self.scene.domain.complex;
        let method = match self.args.method {
            MethodKind::Harmonic => "harmonic".to_owned(),
            other => format!("{} of order {}", other.method(), self.args.order),
        };
        let _ = writeln!(
            out,
            "{method} weights of {} handles on {} vertices, {} simplices of dimension {}\n",
            self.found.weights.len(),
            complex.vertex_count(),
            complex.simplex_count(),
            complex.dimension()
        );
        let width = self.scene.attached.names().iter().map(|name| name.chars().count()).max().unwrap_or(0).max(6);
        let _ = writeln!(
            out,
            "{:<width$} {:>8} {:>13} {:>13} {:>8} {:>11} {:>11} {:>13} {:>5} {:>8}",
            "handle", "vertices", "minima/wanted", "maxima/wanted", "spurious", "least", "greatest", "energy", "iter", "seconds"
        );
        for (handle, (report, verdict)) in self.found.reports.iter().zip(self.verdicts).enumerate() {
            let _ = writeln!(
                out,
                "{:<width$} {:>8} {:>13} {:>13} {:>8} {:>11.4} {:>11.4} {:>13.6e} {:>5} {:>8.2}",
                self.scene.attached.names()[handle],
                self.scene.attached.vertices()[handle].len(),
                format!("{}/{}", verdict.found_minima, verdict.wanted_minima),
                format!("{}/{}", verdict.found_maxima, verdict.wanted_maxima),
                verdict.spurious.count,
                verdict.range.0,
                verdict.range.1,
                report.energy,
                report.function.iterations,
                report.function.seconds
            );
        }
        let count = |of: fn(&PlateauReport) -> usize| self.verdicts.iter().map(of).sum::<usize>();
        let spurious = count(|verdict| verdict.spurious.count);
        let missing = count(|verdict| verdict.missing.count);
        let _ = writeln!(out, "\nenergy          {:.6e}, the sum over the handles", self.found.energy);
        let (before, after) = self.found.off_unity;
        let turns = if self.found.turns > 1 { format!(", {} turns", self.found.turns) } else { String::new() };
        let _ = writeln!(out, "sum of weights  1 within {after:.1e} ({before:.1e} as found{turns})");
        let broken: usize = self.found.reports.iter().filter_map(|report| Some(report.divided.as_ref()?.spurious.count)).sum();
        if self.args.method == MethodKind::Monotone && self.found.reports.iter().any(|report| report.divided.is_some()) {
            let _ = writeln!(out, "                plain division would have made {broken} spurious extrema");
        }
        if self.found.cut_off > 0.0 {
            let _ = writeln!(out, "cut off         at most {:.1e} of the weights of a point", self.found.cut_off);
        }
        let constant: usize = self.found.reports.iter().map(|report| report.function.constant).sum();
        if constant > 0 {
            let _ = writeln!(out, "constant        {constant} weights at vertices that one handle cuts off from the others");
        }
        let [read, analysis, solve, total] = self.seconds;
        let _ = writeln!(out, "time            {total:.2} s (read {read:.2}, analysis {analysis:.2}, weights {solve:.2})");
        let verdict = match (self.args.method, self.verdicts.iter().all(|verdict| verdict.passed)) {
            (_, true) => "passed: no extremum but at the handles".to_owned(),
            (MethodKind::Monotone, false) => format!("FAILED: {spurious} spurious, {missing} missing extrema"),
            (_, false) => format!("{spurious} spurious, {missing} missing extrema; this method promises none"),
        };
        let _ = writeln!(out, "audit           {verdict}");
        let target = self.args.output.display();
        let _ = match self.is_kept {
            true => writeln!(out, "output          {target}"),
            false => writeln!(out, "output          none: {target} was not written (--keep-unaudited would)"),
        };
    }
}

/// A picture of every handle's weights with isolines and extrema.
pub fn pictures(directory: &Path, job: &WeightsJob<'_>) -> Result<(), Failure> {
    std::fs::create_dir_all(directory).map_err(|error| Failure::file(directory, format!("cannot be made a directory: {error}")))?;
    for (handle, name) in job.scene.attached.names().iter().enumerate() {
        let report = &job.found.reports[handle];
        let of_kind = |kind| -> Vec<VertexId> {
            let spurious = &report.extrema.spurious.first;
            spurious.iter().filter(|(_, found)| *found == kind).map(|&(vertex, _)| vertex).collect()
        };
        let (mut minima, mut maxima) = (of_kind(ExtremumType::Minimum), of_kind(ExtremumType::Maximum));
        minima.extend(&report.function.minima);
        maxima.extend(&report.function.maxima);
        let verdict = &job.verdicts[handle];
        let title = format!("{name}: {} minima, {} maxima, {} spurious", verdict.found_minima, verdict.found_maxima, verdict.spurious.count);
        let view = FieldView { title: &title, values: &job.found.weights[handle], minima: &minima, maxima: &maxima };
        let options = PictureOptions { label: format!("weight of {name}"), range: Some([0.0, 1.0]), ..PictureOptions::default() };
        let target = directory.join(format!("{}.png", name.replace(['/', '\\'], "_")));
        field_picture(&job.scene.domain.complex, &view, &options)
            .and_then(|picture| picture.write_png(&target))
            .map_err(|error| Failure::file(&target, error))?;
    }
    Ok(())
}
