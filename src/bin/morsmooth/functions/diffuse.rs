//! `morsmooth diffuse`: colours at points and along curves, spread over a shape or an image.

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::{Args, ValueEnum};
use morsmooth::audit::{PlateauReport, audit_plateaus};
use morsmooth::field::VertexId;
use morsmooth::interpolate::{Blend, Diffused, InterpolateOptions, Interpolator, diffuse};
use morsmooth::io::{ArrayData, DataArray, DataSet, Geometry, PendingFile, read, write_temporary};
use morsmooth::plot::{Painting, PixelSize, is_in_gamut, paint, to_bytes};
use serde_json::{Value, json};

use crate::Outcome;
use crate::args::{MethodKind, OutlineArgs, TalkArgs};
use crate::common::beside::{fitting, write_image};
use crate::common::input::FieldInput;
use crate::common::output::{check_output, check_target, is_same_place};
use crate::common::report::{command_line, header, status_name, write_report};
use crate::common::shape_input::{domain, load};
use crate::common::talk::Talk;
use crate::failure::Failure;
use crate::functions::diffuse_colours::{Colour, given, image_colours, parse_colour};

/// `morsmooth diffuse`.
#[derive(Debug, Args)]
pub struct DiffuseArgs {
    /// Shape: an outline .csv, which is filled with triangles, a planar mesh, or an image .png, whose pixels are the points and whose
    /// transparent pixels are outside.
    pub input: PathBuf,

    /// Image to write.
    pub output: PathBuf,

    /// The shape with the colours as arrays, besides: .vtu, .vtp or .vti.
    pub mesh_output: Option<PathBuf>,

    /// Colours: a table with the columns x, y (or point) and colour (#rrggbb; or r, g, b from 0 to 255); rows of one 'curve' that follow
    /// each other are joined, colours run linearly along it. Or JSON: [{"point": [x, y], "colour": "#ff8000"}, {"curve": [[x, y], ...],
    /// "colours": [...]}]. Or an image of the size of the input, whose opaque pixels count.
    #[arg(long, visible_alias = "colors", value_name = "FILE")]
    pub colours: PathBuf,

    /// How colours are spread.
    #[arg(long, value_enum, default_value_t = MethodKind::Monotone)]
    pub method: MethodKind,

    /// Order of the energy, 1 to 4.
    #[arg(long, value_name = "K", default_value_t = 2, value_parser = clap::value_parser!(u8).range(1..=4))]
    pub order: u8,

    /// What is interpolated: red, green and blue (monotone then promises that no channel has an extremum but at given colours), or a
    /// basis function a colour.
    #[arg(long, value_enum, default_value_t = BlendKind::Channels)]
    pub blend: BlendKind,

    /// Width of the image in pixels. An image keeps its own size.
    #[arg(long, value_name = "PIXELS", default_value_t = 512, conflicts_with = "pixel", value_parser = clap::value_parser!(u32).range(1..=16384))]
    pub width: u32,

    /// Size of a pixel in units of the points.
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true)]
    pub pixel: Option<f64>,

    /// Colour of an image that is outside as well: #rrggbb.
    #[arg(long, value_name = "COLOUR")]
    pub outside: Option<String>,

    /// Array whose zeros are holes in the domain.
    #[arg(long, value_name = "NAME")]
    pub mask: Option<String>,

    /// How an outline is filled.
    #[command(flatten)]
    pub outline: OutlineArgs,

    /// Write the output even if the audit fails.
    #[arg(long)]
    pub keep_unaudited: bool,

    /// What is said, and threads.
    #[command(flatten)]
    pub talk: TalkArgs,
}

/// Values of `--blend`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum BlendKind {
    /// Red, green and blue, each by itself.
    Channels,
    /// A basis function for every given colour.
    Basis,
}

const CHANNELS: [&str; 3] = ["red", "green", "blue"];
/// The mask made of an image: which pixels are inside.
const INSIDE: &str = "inside";

/// Runs the command.
pub fn run(args: &DiffuseArgs) -> Result<Outcome, Failure> {
    let begin = Instant::now();
    check_paths(args)?;
    let talk = Talk::new(args.talk.quiet);
    talk.stage("reading");
    let (input, is_image) = shape(args)?;
    input.notes.iter().for_each(|note| talk.line(&format!("note: {note}")));
    let given = given(&args.colours, &input)?;

    talk.stage("solving");
    let complex = &input.domain.complex;
    let told = |error: morsmooth::interpolate::InterpolateError| Failure::file(&args.input, error);
    let mut interpolator = Interpolator::new(complex, usize::from(args.order)).map_err(told)?;
    let blend = match args.blend {
        BlendKind::Channels => Blend::Channels,
        BlendKind::Basis => Blend::Basis,
    };
    let found = diffuse(&mut interpolator, &given, (args.method.method(), blend), &InterpolateOptions::default()).map_err(told)?;

    talk.stage("writing, and audit of what was written");
    let painting = match is_image {
        true => pixels(&input, &found),
        false => {
            let size = args.pixel.map_or(PixelSize::Width(args.width), PixelSize::Units);
            paint(complex, found.channels.each_ref().map(Vec::as_slice), size).map_err(|error| Failure::file(&args.output, error))?
        }
    };
    let image = write_image(&args.output, (painting.width, painting.height), &painting.rgba)?;
    let (mesh, channels) = match &args.mesh_output {
        Some(path) => {
            let (pending, channels) = write_mesh(path, &input, &found)?;
            (Some(pending), channels)
        }
        None => (None, found.channels.clone()),
    };
    let verdicts = (0..3)
        .map(|channel| {
            let values: Vec<(VertexId, f64)> = given.iter().map(|&(vertex, colour)| (vertex, colour[channel])).collect();
            audit_plateaus(complex, &channels[channel], &values).map_err(|error| Failure::file(&args.output, error))
        })
        .collect::<Result<Vec<PlateauReport>, Failure>>()?;
    let promised = args.method == MethodKind::Monotone && blend == Blend::Channels;
    let outside = outside_of_given(&found, &given);
    // The least and the greatest value need not be extrema of their own, only nothing else may be one, and nothing may move.
    let holds = |verdict: &PlateauReport| verdict.spurious.count == 0 && verdict.moved_values.count == 0;
    let passed = verdicts.iter().all(holds) && outside == 0;
    let is_kept = passed || !promised || args.keep_unaudited;
    if is_kept {
        for pending in std::iter::once(image).chain(mesh) {
            pending.commit().map_err(|error| Failure::usage(error.to_string()))?;
        }
    }
    talk.finish();
    for report in found.reports.iter().filter(|report| report.status != morsmooth::qp::QpStatus::Solved) {
        talk.warn(&format!("the solver ended {}: not proven optimal (relative gap {:.1e})", status_name(&report.status), report.gap));
    }
    let told = Told { args, input: &input, given: &given, found: &found, painting: &painting, verdicts: &verdicts, outside, passed, promised, is_kept };
    if let Some(path) = &args.talk.report {
        write_report(path, &told.to_json(begin.elapsed().as_secs_f64()))?;
    }
    if !args.talk.quiet {
        told.print();
    }
    Ok(if passed || !promised { Outcome::Done } else { Outcome::NotMet })
}

fn check_paths(args: &DiffuseArgs) -> Result<(), Failure> {
    check_output(&args.input, &args.output, args.talk.report.as_deref(), &[&args.colours])?;
    let is_png = |path: &Path| path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png"));
    if !is_png(&args.output) {
        return Err(Failure::file(&args.output, "the image has another ending; expected .png"));
    }
    if is_same_place(&args.output, &args.colours) {
        return Err(Failure::file(&args.output, "the output would overwrite the file of --colours; expected another name"));
    }
    if let Some(mesh) = &args.mesh_output {
        check_target(mesh)?;
        if let Some(other) = [&args.input, &args.colours, &args.output].into_iter().find(|other| is_same_place(mesh, other)) {
            return Err(Failure::file(mesh, format!("the mesh would overwrite {}; expected another name", other.display())));
        }
    }
    Ok(())
}

/// The domain, and whether its points are the pixels of an image.
fn shape(args: &DiffuseArgs) -> Result<(FieldInput, bool), Failure> {
    let mut dataset = load(&args.input, &args.outline)?;
    let is_image = args.input.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png"));
    let outside = match &args.outside {
        None => None,
        Some(text) => Some(parse_colour(text).ok_or_else(|| Failure::usage(format!("found --outside '{text}'; expected a colour such as #ffffff")))?),
    };
    if outside.is_some() && !is_image {
        return Err(Failure::usage("found --outside for a shape that is no image; expected a .png, or --mask"));
    }
    let mut mask = args.mask.clone();
    if let (true, Some(colours)) = (is_image, image_colours(&dataset)) {
        let is_inside = |&[r, g, b, alpha]: &[f64; 4]| u8::from(alpha > 0.0 && outside != Some([r, g, b]));
        let inside: Vec<u8> = colours.iter().map(is_inside).collect();
        if inside.contains(&0) {
            dataset.set_point_array(DataArray::new(INSIDE, 1, ArrayData::U8(inside)));
            mask = Some(INSIDE.to_owned());
        }
    }
    Ok((domain(&args.input, dataset, mask.as_ref(), "RGB")?, is_image))
}

/// An image whose pixels are the points.
fn pixels(input: &FieldInput, found: &Diffused) -> Painting {
    let [width, height] = match &input.dataset.geometry {
        Geometry::ImageData { extent, .. } => [extent.dimensions()[0], extent.dimensions()[1]],
        _ => [0, 0],
    };
    let mut painting = Painting { width: width as u32, height: height as u32, rgba: Vec::new(), covered: 0, out_of_gamut: 0 };
    // Images begin with their highest row.
    for point in (0..height).rev().flat_map(|row| row * width..(row + 1) * width) {
        let Some(vertex) = input.domain.vertex_of_point()[point] else {
            painting.rgba.extend([0; 4]);
            continue;
        };
        let colour = [0, 1, 2].map(|channel| found.channels[channel][vertex.index()]);
        painting.covered += 1;
        painting.out_of_gamut += usize::from(!is_in_gamut(colour));
        painting.rgba.extend(to_bytes(colour));
        painting.rgba.push(255);
    }
    painting
}

/// Writes the channels and the colours in bytes; the channels as the file has them.
fn write_mesh(path: &Path, input: &FieldInput, found: &Diffused) -> Result<(PendingFile, [Vec<f64>; 3]), Failure> {
    let told = |error: morsmooth::io::IoError| Failure::usage(error.to_string());
    let mut dataset = DataSet::clone(&input.dataset);
    let mut bytes = vec![0u8; 3 * input.domain.point_count()];
    for (vertex, &point) in input.domain.point_of_vertex().iter().enumerate() {
        let colour = to_bytes([0, 1, 2].map(|channel| found.channels[channel][vertex]));
        bytes[3 * point as usize..3 * point as usize + 3].copy_from_slice(&colour);
    }
    dataset.set_point_array(DataArray::new("RGB", 3, ArrayData::U8(bytes)));
    for (name, channel) in CHANNELS.iter().zip(&found.channels) {
        let mut on_points = vec![f64::NAN; input.domain.point_count()];
        input.domain.extend(channel, &mut on_points);
        dataset.set_point_array(DataArray::new(*name, 1, ArrayData::F64(on_points)));
    }
    let pending = write_temporary(path, &fitting(dataset, path)?).map_err(told)?;
    let written = read(pending.path()).map_err(told)?;
    let mut channels = [Vec::new(), Vec::new(), Vec::new()];
    for (name, channel) in CHANNELS.iter().zip(&mut channels) {
        let array = written.point_array(name).ok_or_else(|| Failure::file(path, format!("the array {name} just written is not in the file")))?;
        *channel = input.domain.restrict(&array.to_f64(0));
    }
    Ok((pending, channels))
}

/// Vertices with a channel beyond the range of the given colours.
fn outside_of_given(found: &Diffused, given: &[(VertexId, Colour)]) -> usize {
    let range = |channel: usize| {
        given.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), (_, colour)| (low.min(colour[channel]), high.max(colour[channel])))
    };
    let ranges = [range(0), range(1), range(2)];
    // Beyond rounding of the linear methods.
    const ROUNDING: f64 = 1e-9;
    let is_outside = |vertex: &usize| {
        (0..3).any(|channel| {
            let value = found.channels[channel][*vertex];
            value < ranges[channel].0 - ROUNDING || value > ranges[channel].1 + ROUNDING
        })
    };
    (0..found.channels[0].len()).filter(is_outside).count()
}

/// What is told of a run.
struct Told<'a> {
    args: &'a DiffuseArgs,
    input: &'a FieldInput,
    given: &'a [(VertexId, Colour)],
    found: &'a Diffused,
    painting: &'a Painting,
    verdicts: &'a [PlateauReport],
    outside: usize,
    passed: bool,
    promised: bool,
    is_kept: bool,
}

impl Told<'_> {
    fn to_json(&self, seconds: f64) -> Value {
        let channel = |(name, verdict): (&&str, &PlateauReport)| {
            json!({
                "name": name, "minima": verdict.found_minima, "maxima": verdict.found_maxima, "spurious": verdict.spurious.count,
                "moved_values": verdict.moved_values.count, "range": [verdict.range.0, verdict.range.1],
            })
        };
        let solver = |report: &morsmooth::interpolate::InterpolateReport| {
            json!({ "status": status_name(&report.status), "energy": report.energy, "iterations": report.iterations, "seconds": report.seconds, "gap": report.gap })
        };
        let mut report = header(self.input);
        report["command"] = json!(command_line());
        report["output"] = json!(self.args.output);
        report["method"] = json!(self.args.method.method());
        report["order"] = json!(self.args.order);
        report["given_vertices"] = json!(self.given.len());
        report["pixels"] = json!({
            "width": self.painting.width, "height": self.painting.height, "covered": self.painting.covered,
            "out_of_gamut": self.painting.out_of_gamut,
        });
        report["vertices_outside_given_range"] = json!(self.outside);
        report["channels"] = json!(CHANNELS.iter().zip(self.verdicts).map(channel).collect::<Vec<_>>());
        report["functions"] = json!(self.found.reports.iter().map(solver).collect::<Vec<_>>());
        report["passed"] = json!(self.passed);
        report["promised"] = json!(self.promised);
        report["written"] = json!(self.is_kept);
        report["seconds"] = json!(seconds);
        report
    }

    fn print(&self) {
        use std::io::Write;
        let (painting, args) = (self.painting, self.args);
        let spurious: Vec<usize> = self.verdicts.iter().map(|verdict| verdict.spurious.count).collect();
        let moved: usize = self.verdicts.iter().map(|verdict| verdict.moved_values.count).sum();
        let verdict = match (self.passed, self.promised) {
            (true, _) => "passed: no channel has an extremum or a value beyond the given colours".to_owned(),
            (false, true) => format!("FAILED: {} spurious extrema, {moved} moved values", spurious.iter().sum::<usize>()),
            (false, false) => "not promised by this method".to_owned(),
        };
        let seconds: f64 = self.found.reports.iter().map(|report| report.seconds).sum();
        let lines = [
            ("domain", format!("{} vertices, {} simplices; colours given at {}", self.input.values.len(), self.input.domain.complex.simplex_count(), self.given.len())),
            ("method", format!("{} of order {}, {} functions, {seconds:.2} s", args.method.method(), args.order, self.found.reports.len())),
            ("image", format!("{} x {} pixels, {} on the shape", painting.width, painting.height, painting.covered)),
            ("out of gamut", format!("{} pixels; {} vertices beyond the range of the given colours", painting.out_of_gamut, self.outside)),
            ("spurious extrema", format!("red {}, green {}, blue {}", spurious[0], spurious[1], spurious[2])),
            ("audit", verdict),
            ("output", if self.is_kept { args.output.display().to_string() } else { "none".to_owned() }),
        ];
        let mut out = std::io::stdout().lock();
        for (what, text) in lines {
            let _ = writeln!(out, "{what:<17}{text}");
        }
    }
}
