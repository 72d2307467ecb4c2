//! `morsmooth deform`: a shape follows its handles, and no element turns inside out.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use morsmooth::audit::OrientationReport;
use morsmooth::deform::RestShape;
use morsmooth::io::read_pose;
use morsmooth::plot::Photograph;
use serde_json::{Value, json};

use crate::Outcome;
use crate::args::TalkArgs;
use crate::common::output::{check_directory, check_output, check_target, is_same_place};
use crate::common::report::{command_line, write_report};
use crate::common::talk::Talk;
use crate::failure::Failure;
use crate::shapes::posed::{MethodKind, PoseArgs, Posed, Session, Verdict};
use crate::shapes::shape::{Rig, RigArgs, Shape, is_png};
use crate::shapes::shape_file::{audit_json, audit_line, judge, write_and_audit, write_warped};
use crate::shapes::shape_pictures;

/// `morsmooth deform`.
#[derive(Debug, Args)]
pub struct DeformArgs {
    /// Mesh of triangles in a plane z = constant or of tetrahedra, an outline (.csv: x, y, and a ring number), or a photograph (.png).
    pub mesh: PathBuf,

    /// File to write: the mesh with its points moved and four more cell arrays. For a photograph a .png, the warped photograph.
    pub output: PathBuf,

    /// Handles and weights.
    #[command(flatten)]
    pub rig: RigArgs,

    /// Where the handles go (.json; .dmat with a quaternion a bone).
    #[arg(long, value_name = "FILE")]
    pub pose: PathBuf,

    /// How the shape is found.
    #[command(flatten)]
    pub how: PoseArgs,

    /// Photograph that is warped with the mesh, whose coordinates are its pixels from the lower left corner.
    #[arg(long, value_name = "FILE.png", requires = "out_image")]
    pub image: Option<PathBuf>,

    /// Write the warped photograph here.
    #[arg(long, value_name = "FILE.png")]
    pub out_image: Option<PathBuf>,

    /// Draw every iterate into this directory.
    #[arg(long, value_name = "DIR")]
    pub preview: Option<PathBuf>,

    /// Draw the shape before and after into this directory.
    #[arg(long, value_name = "DIR")]
    pub plots: Option<PathBuf>,

    /// What is said, and threads.
    #[command(flatten)]
    pub talk: TalkArgs,
}

/// Runs the command.
pub fn run(args: &DeformArgs) -> Result<Outcome, Failure> {
    let begin = Instant::now();
    check(args)?;
    let talk = Talk::new(args.talk.quiet);
    talk.stage("reading");
    let shape = Shape::load(&args.mesh, &args.rig)?;
    let photograph = photograph(args.image.as_deref(), &shape)?;
    shape.domain.notes.iter().for_each(|note| talk.line(&format!("note: {note}")));
    talk.stage("weights");
    let rig = Rig::load(&shape, &args.rig)?;
    let pose = read_pose(&args.pose, &rig.set, shape.complex()).map_err(|error| Failure::usage(error.to_string()))?;
    let read_seconds = begin.elapsed().as_secs_f64();
    talk.stage("deforming");
    let solving = Instant::now();
    let mut session = Session::new(&shape, &rig, &args.how)?;
    let mut drawer = Drawer::new(args.preview.as_deref(), &shape, session.rest())?;
    let posed = session.pose(&pose, &mut |iteration, positions| drawer.draw(iteration, positions))?;
    drawer.end()?;
    let solve_seconds = solving.elapsed().as_secs_f64();
    talk.stage("writing, and audit of the file as written");
    let is_picture = is_png(&args.output);
    let (pending, audit, lost) = if is_picture {
        (None, judge(&shape, session.folded(), &posed.points)?, Vec::new())
    } else {
        let written = write_and_audit(&args.output, &shape, &posed, session.folded())?;
        (Some(written.pending), written.audit, written.lost)
    };
    let ending = Ending::of(&posed, &audit, &args.how);
    if ending.is_kept {
        let target = if is_picture { Some(&args.output) } else { args.out_image.as_ref() };
        let image = photograph.as_ref().zip(target).map(|(photograph, target)| write_warped(target, photograph, &shape, &posed)).transpose()?;
        for file in image.into_iter().chain(pending) {
            file.commit().map_err(|error| Failure::usage(error.to_string()))?;
        }
    }
    if let Some(directory) = &args.plots {
        shape_pictures::before_after(directory, &shape, &rig, &posed)?;
    }
    talk.finish();
    let extension = args.output.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    lost.iter().filter(|_| ending.is_kept).for_each(|what| talk.warn(&format!(".{extension} has no room for {what}")));
    ending.tell(&posed, &shape, &args.how, &talk);
    let seconds = [read_seconds, solve_seconds, begin.elapsed().as_secs_f64()];
    if let Some(path) = &args.talk.report {
        write_report(path, &told(args, (&shape, &rig), &posed, &audit, (&ending, seconds)))?;
    }
    if !args.talk.quiet {
        print(args, (&shape, &rig), &posed, &audit, (&ending, seconds));
    }
    Ok(if ending.is_done { Outcome::Done } else { Outcome::NotMet })
}

/// What becomes of a result.
pub struct Ending {
    /// The guarantee is met.
    pub is_done: bool,
    /// The file is kept.
    pub is_kept: bool,
}

impl Ending {
    /// By what the method and the audit say.
    pub fn of(posed: &Posed, audit: &[OrientationReport; 2], args: &PoseArgs) -> Self {
        let is_clean = audit.iter().all(OrientationReport::is_clean);
        match &posed.verdict {
            Verdict::Contradiction(_, is_substituted) => {
                Self { is_done: false, is_kept: is_clean && *is_substituted || args.keep_unaudited }
            }
            Verdict::Good | Verdict::Warned(_) => Self { is_done: is_clean, is_kept: is_clean || args.keep_unaudited },
        }
    }

    /// Warnings, quiet or not.
    pub fn tell(&self, posed: &Posed, shape: &Shape, args: &PoseArgs, talk: &Talk) {
        match &posed.verdict {
            Verdict::Good => {}
            Verdict::Warned(text) => talk.warn(text),
            Verdict::Contradiction(blame, is_substituted) => {
                talk.warn(&blame.to_string());
                let cells = shape.cells_of(&blame.elements);
                if cells.iter().zip(&blame.elements).any(|(&cell, &element)| cell as usize != element) {
                    let listed: Vec<String> = cells.iter().take(5).map(u32::to_string).collect();
                    talk.warn(&format!("in the file these are the cells {}", listed.join(", ")));
                }
                match (is_substituted, self.is_kept) {
                    (true, true) => talk.warn("what is written is the closest shape without inversions that was found"),
                    (_, false) if !args.keep_best => {
                        talk.warn("nothing was written; --keep-best would look for the closest shape without inversions");
                    }
                    _ => {}
                }
            }
        }
    }
}

fn check(args: &DeformArgs) -> Result<(), Failure> {
    let mut inputs: Vec<&Path> = vec![&args.pose];
    inputs.extend([&args.rig.handles, &args.rig.weights, &args.image].into_iter().flatten().map(PathBuf::as_path));
    check_output(&args.mesh, &args.output, args.talk.report.as_deref(), &inputs)?;
    for target in std::iter::once(&args.output).chain(&args.out_image) {
        check_target(target)?;
        if let Some(input) = inputs.iter().chain([&args.mesh.as_path()]).find(|input| is_same_place(input, target)) {
            return Err(Failure::file(target, format!("the output would overwrite {}; expected another name", input.display())));
        }
    }
    if let Some(image) = args.out_image.as_ref().filter(|image| is_same_place(image, &args.output)) {
        return Err(Failure::file(image, "found one name for the mesh and for the photograph; expected two"));
    }
    if is_png(&args.output) && !is_png(&args.mesh) {
        return Err(Failure::file(&args.output, "a photograph comes of a photograph only; expected a mesh file, and --image with --out-image"));
    }
    if args.out_image.is_some() && args.image.is_none() && !is_png(&args.mesh) {
        return Err(Failure::usage("found --out-image without a photograph; expected --image FILE.png, or a .png in the place of the mesh"));
    }
    check_directory(args.preview.as_deref())?;
    check_directory(args.plots.as_deref())
}

/// The photograph to be warped, if any.
pub fn photograph(image: Option<&Path>, shape: &Shape) -> Result<Option<Photograph>, Failure> {
    if let Some(path) = image {
        if shape.complex().dimension() != 2 {
            return Err(Failure::file(path, "a photograph needs a planar mesh; found tetrahedra"));
        }
        return Photograph::read_png(path).map(Some).map_err(|error| Failure::usage(error.to_string()));
    }
    Ok(shape.photograph.clone())
}

/// Draws iterates. The first failure is kept and ends the drawing.
struct Drawer<'a> {
    directory: Option<&'a Path>,
    shape: &'a Shape,
    rest: Option<RestShape>,
    count: usize,
    failure: Option<Failure>,
}

impl<'a> Drawer<'a> {
    fn new(directory: Option<&'a Path>, shape: &'a Shape, rest: &RestShape) -> Result<Self, Failure> {
        directory.map_or(Ok(()), shape_pictures::make)?;
        let rest = directory.map(|_| rest.clone());
        Ok(Self { directory, shape, rest, count: 0, failure: None })
    }

    fn draw(&mut self, iteration: usize, positions: &[f64]) {
        let (Some(directory), Some(rest), None) = (self.directory, &self.rest, &self.failure) else { return };
        let Ok(determinants) = rest.determinants(positions) else { return };
        let mut points = rest.points().to_vec();
        for (point, place) in points.iter_mut().zip(positions.chunks(rest.dimension())) {
            point[..rest.dimension()].copy_from_slice(place);
        }
        let inverted = determinants.iter().filter(|det| det.is_nan() || **det <= 0.0).count();
        let title = format!("iteration {iteration}: {inverted} inverted");
        let target = directory.join(format!("iterate_{:04}.png", self.count));
        self.count += 1;
        self.failure = shape_pictures::single(&target, self.shape, (&title, &points, &determinants)).err();
    }

    fn end(self) -> Result<(), Failure> {
        self.failure.map_or(Ok(()), Err)
    }
}

/// The facts of the mesh and the handles, for reports.
pub fn facts(shape: &Shape, rig: &Rig) -> Value {
    let complex = shape.complex();
    json!({
        "dimension": complex.dimension(), "vertices": complex.vertex_count(), "elements": complex.simplex_count(),
        "handles": rig.held.names, "held_vertices": rig.held.vertices.len(), "weights": rig.source,
    })
}

/// The facts of one pose, for reports.
pub fn pose_facts(shape: &Shape, rig: &Rig, posed: &Posed, audit: &[OrientationReport; 2]) -> Value {
    let mut told = posed.told.clone();
    told["audit"] = audit_json(shape, audit);
    told["handles"] = rig
        .held
        .names
        .iter()
        .zip(&posed.distances)
        .map(|(name, (most, mean))| json!({ "name": name, "largest_distance": most, "mean_distance": mean }))
        .collect();
    if let Verdict::Contradiction(blame, _) = &posed.verdict {
        told["blame"] = json!({ "message": blame.to_string(), "handles": blame.names, "cells": shape.cells_of(&blame.elements) });
    }
    told
}

type Facts<'a> = (&'a Ending, [f64; 3]);

fn told(
    args: &DeformArgs,
    (shape, rig): (&Shape, &Rig),
    posed: &Posed,
    audit: &[OrientationReport; 2],
    (ending, [read, solve, total]): Facts<'_>,
) -> Value {
    json!({
        "program": "morsmooth", "version": env!("CARGO_PKG_VERSION"), "command": command_line(),
        "input": args.mesh, "output": args.output, "written": ending.is_kept, "method": method_name(args.how.method),
        "mesh": facts(shape, rig), "result": pose_facts(shape, rig, posed, audit),
        "seconds": { "read_and_weights": read, "deform": solve, "total": total },
    })
}

/// A method as it is typed.
pub fn method_name(method: MethodKind) -> String {
    use clap::ValueEnum;
    method.to_possible_value().map(|value| value.get_name().to_owned()).unwrap_or_default()
}

/// On standard output; a closed pipe is not an error.
fn print(
    args: &DeformArgs,
    (shape, rig): (&Shape, &Rig),
    posed: &Posed,
    audit: &[OrientationReport; 2],
    (ending, [read, solve, total]): Facts<'_>,
) {
    let complex = shape.complex();
    let noun = if complex.dimension() == 2 { "triangles" } else { "tetrahedra" };
    let mut lines = vec![
        ("mesh", format!("{} vertices, {} {noun}", complex.vertex_count(), complex.simplex_count())),
        ("handles", format!("{} ({} held vertices), weights: {}", rig.held.names.len(), rig.held.vertices.len(), rig.source)),
        ("method", method_name(args.how.method)),
    ];
    lines.extend(posed.lines.iter().cloned());
    if let Some(active) = &posed.active {
        lines.push(("constraints", format!("{} of {} active", active.iter().filter(|active| **active).count(), active.len())));
    }
    let far = rig.held.names.iter().zip(&posed.distances).max_by(|a, b| a.1.0.total_cmp(&b.1.0));
    if let Some((name, (most, mean))) = far {
        let line = format!("held vertices of \"{name}\" are farthest from where they were asked to be: {most:.3e} at most, {mean:.3e} on average");
        lines.push(("", line));
    }
    lines.push(("time", format!("{total:.2} s (read and weights {read:.2}, deform {solve:.2}, write and audit {:.2})", total - read - solve)));
    lines.push(("audit", audit_line(audit)));
    let target = args.output.display();
    lines.push(("output", match ending.is_kept {
        true => target.to_string(),
        false => format!("none: {target} was not written"),
    }));
    let mut out = std::io::stdout().lock();
    for (what, text) in lines {
        let _ = writeln!(out, "{what:<15} {text}");
    }
}
