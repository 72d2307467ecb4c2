//! `morsmooth animate`: poses between key poses, each frame on its own.

use std::ffi::OsString;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use morsmooth::io::{PendingFile, read_keys, write_collection};
use morsmooth::mesh::Pose;
use rayon::prelude::*;
use serde_json::{Value, json};

use crate::Outcome;
use crate::args::TalkArgs;
use crate::common::output::{check_output, is_same_place};
use crate::common::report::{command_line, write_report};
use crate::common::talk::Talk;
use crate::failure::Failure;
use crate::shapes::deform::{Ending, facts, method_name, photograph, pose_facts};
use crate::shapes::posed::{PoseArgs, Session, Verdict};
use crate::shapes::shape::{Rig, RigArgs, Shape, is_png};
use crate::shapes::shape_file::{Written, write_and_audit, write_warped};

/// `morsmooth animate`.
#[derive(Debug, Args)]
pub struct AnimateArgs {
    /// Mesh of triangles in a plane z = constant or of tetrahedra, an outline (.csv), or a photograph (.png).
    pub mesh: PathBuf,

    /// Collection to write (.pvd); its frames OUT_0000.vtu, OUT_0001.vtu ... lie beside it. Of a photograph every frame has a picture
    /// OUT_0000.png as well.
    pub output: PathBuf,

    /// Handles and weights.
    #[command(flatten)]
    pub rig: RigArgs,

    /// Key poses with their times (.json): {"keys": [{"time": 0, "handles": {...}}, ...]}, handles as in a pose.
    #[arg(long, value_name = "FILE")]
    pub keys: PathBuf,

    /// Frames, evenly from the first to the last time.
    #[arg(long, value_name = "N", default_value_t = 48, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub frames: u32,

    /// Photograph that is warped with the mesh, whose coordinates are its pixels from the lower left corner; the pictures of the frames are
    /// OUT_0000.png, OUT_0001.png ...
    #[arg(long, value_name = "FILE.png")]
    pub image: Option<PathBuf>,

    /// How the shape is found.
    #[command(flatten)]
    pub how: PoseArgs,

    /// What is said, and threads.
    #[command(flatten)]
    pub talk: TalkArgs,
}

/// A frame that was solved and written beside its place.
struct Frame {
    time: f64,
    written: Written,
    picture: Option<PendingFile>,
    ending: Ending,
    told: Value,
    warning: Option<String>,
}

/// Runs the command.
pub fn run(args: &AnimateArgs) -> Result<Outcome, Failure> {
    let begin = Instant::now();
    check(args)?;
    let talk = Talk::new(args.talk.quiet);
    talk.stage("reading");
    let shape = Shape::load(&args.mesh, &args.rig)?;
    shape.domain.notes.iter().for_each(|note| talk.line(&format!("note: {note}")));
    talk.stage("weights");
    let rig = Rig::load(&shape, &args.rig)?;
    let keys = read_keys(&args.keys, &rig.set, shape.complex()).map_err(|error| Failure::usage(error.to_string()))?;
    let photograph = photograph(args.image.as_deref(), &shape)?;
    let names = frame_names(&args.output, args.frames as usize, "vtu");
    let pictures = photograph.as_ref().map(|_| frame_names(&args.output, names.len(), "png"));
    let inputs = [Some(&args.mesh), Some(&args.keys), args.rig.handles.as_ref(), args.rig.weights.as_ref(), args.image.as_ref()];
    for name in names.iter().chain(pictures.iter().flatten()) {
        if let Some(input) = inputs.into_iter().flatten().find(|input| is_same_place(input, name)) {
            return Err(Failure::file(name, format!("the frame would overwrite {}; expected another output", input.display())));
        }
    }
    talk.stage(&format!("{} frames", names.len()));
    let session = Session::new(&shape, &rig, &args.how)?;
    // Every frame begins anew: its bits depend neither on the others nor on the number of threads.
    let each = (0..names.len()).into_par_iter().with_max_len(1);
    let frames: Result<Vec<Frame>, Failure> = each
        .map_init(
            || session.fork(),
            |session, index| {
                let time = frame_time(&keys, index, names.len());
                let posed = session.pose(&pose_at(&keys, time), &mut |_, _| {})?;
                let written = write_and_audit(&names[index], &shape, &posed, session.folded())?;
                let ending = Ending::of(&posed, &written.audit, &args.how);
                let target = pictures.as_ref().map(|pictures| &pictures[index]);
                let picture = photograph.as_ref().zip(target).map(|(photograph, target)| write_warped(target, photograph, &shape, &posed));
                let picture = picture.transpose()?;
                let mut told = pose_facts(&shape, &rig, &posed, &written.audit);
                told["time"] = json!(time);
                told["file"] = json!(names[index]);
                if let Some(target) = target {
                    told["picture"] = json!(target);
                }
                told["written"] = json!(ending.is_kept);
                let warning = match &posed.verdict {
                    Verdict::Good => None,
                    Verdict::Warned(text) => Some(text.clone()),
                    Verdict::Contradiction(blame, _) => Some(blame.to_string()),
                };
                Ok(Frame { time, written, picture, ending, told, warning })
            },
        )
        .collect();
    let frames = frames?;
    let is_kept = frames.iter().all(|frame| frame.ending.is_kept);
    let is_done = frames.iter().all(|frame| frame.ending.is_done);
    talk.finish();
    for (index, frame) in frames.iter().enumerate() {
        if let Some(text) = &frame.warning {
            talk.warn(&format!("frame {index} (time {}): {text}", frame.time));
        }
    }
    let told: Vec<Value> = frames.iter().map(|frame| frame.told.clone()).collect();
    let smallest = frames.iter().map(|frame| frame.written.audit[1].smallest.min(frame.written.audit[0].smallest)).fold(f64::INFINITY, f64::min);
    let bad: Vec<String> = (0..frames.len()).filter(|&index| !frames[index].ending.is_done).map(|index| index.to_string()).collect();
    if is_kept {
        commit(args, frames, &names)?;
    }
    let seconds = begin.elapsed().as_secs_f64();
    if let Some(path) = &args.talk.report {
        let report = json!({
            "program": "morsmooth", "version": env!("CARGO_PKG_VERSION"), "command": command_line(),
            "input": args.mesh, "output": args.output, "written": is_kept, "method": method_name(args.how.method),
            "mesh": facts(&shape, &rig), "frames": told, "seconds": seconds,
        });
        write_report(path, &report)?;
    }
    if !args.talk.quiet {
        let verdict = match bad.as_slice() {
            [] => format!("passed in all {} frames, smallest det F {smallest:.3e}, rounding to 32 bits included", names.len()),
            bad => format!("not met in {} of {} frames: {}", bad.len(), names.len(), bad.join(", ")),
        };
        let output = if is_kept { args.output.display().to_string() } else { format!("none: {} was not written", args.output.display()) };
        let complex = shape.complex();
        let mut out = std::io::stdout().lock();
        for (what, text) in [
            ("mesh", format!("{} vertices, {} elements", complex.vertex_count(), complex.simplex_count())),
            ("handles", format!("{}, weights: {}", rig.held.names.len(), rig.source)),
            (
                "frames",
                format!(
                    "{} from {} keys{}, {seconds:.2} s",
                    names.len(),
                    keys.len(),
                    if pictures.is_some() { ", each with a picture" } else { "" }
                ),
            ),
            ("audit", verdict),
            ("output", output),
        ] {
            let _ = writeln!(out, "{what:<15} {text}");
        }
    }
    Ok(if is_done { Outcome::Done } else { Outcome::NotMet })
}

fn check(args: &AnimateArgs) -> Result<(), Failure> {
    let mut inputs: Vec<&Path> = vec![&args.keys];
    inputs.extend([&args.rig.handles, &args.rig.weights, &args.image].into_iter().flatten().map(PathBuf::as_path));
    check_output(&args.mesh, &args.output, args.talk.report.as_deref(), &inputs)?;
    let is_collection = args.output.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("pvd"));
    if !is_collection {
        return Err(Failure::file(&args.output, "found another ending than .pvd; expected a ParaView collection"));
    }
    if is_png(&args.mesh) && args.rig.triangles > 5_000_000 {
        return Err(Failure::usage("found more than 5000000 triangles a frame; expected fewer"));
    }
    Ok(())
}

/// All frames first, then the file that lists them.
fn commit(args: &AnimateArgs, frames: Vec<Frame>, names: &[PathBuf]) -> Result<(), Failure> {
    let fail = |error: &dyn std::fmt::Display| Failure::usage(error.to_string());
    let entries: Vec<(f64, String)> = frames
        .iter()
        .zip(names)
        .map(|(frame, name)| (frame.time, name.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()))
        .collect();
    let collection = write_collection(&args.output, &entries).map_err(|error| fail(&error))?;
    for frame in frames {
        for file in std::iter::once(frame.written.pending).chain(frame.picture) {
            file.commit().map_err(|error| fail(&error))?;
        }
    }
    collection.commit().map_err(|error| fail(&error))
}

fn frame_names(output: &Path, frames: usize, extension: &str) -> Vec<PathBuf> {
    let digits = frames.saturating_sub(1).to_string().len().max(4);
    let stem = output.file_stem().map(OsString::from).unwrap_or_default();
    let name = |index: usize| {
        let mut name = stem.clone();
        name.push(format!("_{index:0digits$}.{extension}"));
        output.with_file_name(name)
    };
    (0..frames).map(name).collect()
}

fn frame_time(keys: &[(f64, Pose)], index: usize, frames: usize) -> f64 {
    let (Some((first, _)), Some((last, _))) = (keys.first(), keys.last()) else { return 0.0 };
    if index + 1 == frames && frames > 1 {
        return *last;
    }
    first + (last - first) * index as f64 / (frames - 1).max(1) as f64
}

/// The pose at a time within the keys.
fn pose_at(keys: &[(f64, Pose)], time: f64) -> Pose {
    let after = keys.partition_point(|(at, _)| *at <= time).min(keys.len() - 1).max(1);
    let ((from, before), (to, next)) = (&keys[after - 1], &keys[after]);
    before.between(next, (time - from) / (to - from))
}
