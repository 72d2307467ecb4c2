//! `morsmooth series`: a table in, its columns smoothed along one of them, the table out with all that it had.

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::{Args, ValueEnum};
use morsmooth::audit::{AuditReport, Plateaus};
use morsmooth::field::VertexId;
use morsmooth::io::{PendingFile, Table};
use morsmooth::plot::{PlaceKind, SeriesChart, write_atomically};
use morsmooth::smooth::{MeasuredField, Selected, SmoothOptions, Smoothed, Smoother, select_extrema};
use serde_json::{Value, json};

use crate::Outcome;
use crate::args::{EdgesKind, FieldsArgs, LengthArgs, SelectKind, SelectionArgs, SmoothArgs, StrategyKind, TalkArgs, ValuesKind, extremum_values};
use crate::common::output::{check_output, check_target, is_same_place};
use crate::common::report::{SmoothJob, write_report};
use crate::common::talk::Talk;
use crate::common::wishes::{array_names, check_keep, wishes};
use crate::common::written::{OrderArrays, Produced, write_and_audit};
use crate::failure::Failure;
use crate::fields::smooth::{Plan, options};
use crate::functions::series_input::{Series, SeriesTable};

/// `morsmooth series`.
#[derive(Debug, Args)]
pub struct SeriesArgs {
    /// Table to read: columns separated by commas, semicolons or tabs, lines that begin with # are comments.
    pub input: PathBuf,

    /// File to write: .csv, .tsv or .txt keeps the table and appends a column; .vtp and .vtk write a polyline.
    pub output: PathBuf,

    /// Column of places: numbers, or dates such as 2001-01-05, 20010105, 2001-01-05T12:30, 2001-01, 2001-Q3. By default the first column
    /// of dates, else the first of rising or falling numbers. Days are the unit of dates.
    #[arg(long, value_name = "COLUMN", visible_alias = "date")]
    pub x: Option<String>,

    /// Columns to work on; a list a,b,c or given several times. Needed only where there are several of numbers.
    #[arg(long, value_name = "COLUMN", visible_alias = "array", value_delimiter = ',')]
    pub y: Vec<String>,

    /// Column whose zeros mark values that count as missing.
    #[arg(long, value_name = "COLUMN")]
    pub mask: Option<String>,

    /// Missing values: bridged by the line (they stay missing), or filled by the smooth series.
    #[arg(long, value_enum, default_value_t = MissingKind::Bridge)]
    pub missing: MissingKind,

    /// Name of the column written; <COLUMN>_smooth by default.
    #[arg(long, value_name = "NAME", visible_alias = "name")]
    pub output_array: Option<String>,

    /// Which extrema are wanted. Points are rows, counted from 0.
    #[command(flatten)]
    pub selection: SelectionArgs,

    /// Series on which extrema are measured, and whose values they keep: the data (trusted values), or the unconstrained
    /// smooth series (noisy data).
    #[arg(long, value_enum, default_value_t = SelectKind::Data)]
    pub select: SelectKind,

    /// Values at the extrema: keep, free, or within a part of the range such as 5%.
    #[arg(long, value_name = "keep|free|FRACTION", default_value = "keep", value_parser = extremum_values, allow_hyphen_values = true)]
    pub values: ValuesKind,

    /// Order of the energy, 1 to 4.
    #[arg(long, value_name = "K", default_value_t = 2, value_parser = clap::value_parser!(u8).range(1..=4))]
    pub order: u8,

    /// How far noise is averaged away.
    #[command(flatten)]
    pub length: LengthArgs,

    /// Places where the series may keep a sharp corner: dates or numbers of the axis, or the words max and min.
    #[arg(long, value_name = "PLACE", value_delimiter = ',', allow_hyphen_values = true)]
    pub spike: Vec<String>,

    /// Keep a sharp corner at all wanted extrema of the data.
    #[arg(long, value_enum, value_name = "WHICH")]
    pub spikes: Option<SpikesKind>,

    /// Rounds in which the solution becomes the representative function of the next.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub refine: usize,

    /// Draw data, smooth series and kept extrema: .svg or .png.
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,

    /// Write the output even if the audit fails.
    #[arg(long)]
    pub keep_unaudited: bool,

    /// What is said, and threads.
    #[command(flatten)]
    pub talk: TalkArgs,
}

/// Values of `--missing`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum MissingKind {
    /// They stay missing, the line bridges them.
    Bridge,
    /// They get a value of the smooth series.
    Fill,
}

/// Values of `--spikes`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SpikesKind {
    /// Every wanted extremum.
    All,
}

/// One smooth column.
struct SmoothColumn<'a> {
    series: &'a Series,
    name: String,
    smoothed: Smoothed,
    spikes: Vec<VertexId>,
}

/// Runs the command.
pub fn run(args: &SeriesArgs) -> Result<Outcome, Failure> {
    let begin = Instant::now();
    let others: Vec<&Path> = args.selection.keep.iter().chain(&args.plot).map(PathBuf::as_path).collect();
    check_output(&args.input, &args.output, args.talk.report.as_deref(), &others)?;
    check_keep(&args.selection, &args.output)?;
    check_plot(args)?;
    if args.spikes.is_some() && args.select == SelectKind::Smooth {
        return Err(Failure::usage("found --spikes all with --select smooth, where extrema are known only afterwards; expected --spike PLACE, or --select data"));
    }
    let talk = Talk::new(args.talk.quiet);
    talk.stage("reading");
    let table = SeriesTable::load(args)?;
    let columns = table.columns(args)?;
    let all = columns.iter().map(|&column| table.series(args, column)).collect::<Result<Vec<_>, _>>()?;
    if let (Some(name), true) = (&args.output_array, all.len() > 1) {
        return Err(Failure::usage(format!("found --output-array {name} for {} columns; expected it with one column only", all.len())));
    }
    let read_seconds = begin.elapsed().as_secs_f64();
    let smooth_args = smooth_args(args, &all);
    let mut results = Vec::new();
    for series in &all {
        results.extend(smooth(args, &smooth_args, &table, series, &talk)?);
    }

    talk.stage("writing, and audit of the file as written");
    let writing = Instant::now();
    let produced: Vec<Produced<'_>> = results.iter().map(SmoothColumn::produced).collect();
    let (pending, verdicts) = write(args, &table, &produced)?;
    let write_seconds = writing.elapsed().as_secs_f64();
    let passed = verdicts.iter().all(|verdict| verdict.passed);
    let is_kept = passed || args.keep_unaudited;
    for result in &results {
        draw(args, &table, result, results.len())?;
    }
    // Last, so that whatever fails before leaves no output.
    if is_kept {
        pending.commit().map_err(|error| Failure::usage(error.to_string()))?;
    } else {
        drop(pending);
    }
    talk.finish();
    let jobs: Vec<SmoothJob<'_>> = results
        .iter()
        .zip(&verdicts)
        .map(|(result, audit)| SmoothJob {
            args: &smooth_args,
            output: &smooth_args.output,
            input: &result.series.input,
            output_array: &result.name,
            result: &result.smoothed,
            audit,
            written: is_kept,
            read_seconds,
            write_seconds,
            seconds: begin.elapsed().as_secs_f64(),
        })
        .collect();
    jobs.iter().filter_map(SmoothJob::warning).for_each(|warning| talk.warn(&warning));
    if let Some(path) = &args.talk.report {
        let reports: Vec<Value> = jobs.iter().zip(&results).map(|(job, result)| told(job, &table, result)).collect();
        let report = match <[Value; 1]>::try_from(reports) {
            Ok([only]) => only,
            Err(many) => json!({ "program": "morsmooth", "version": env!("CARGO_PKG_VERSION"), "results": many }),
        };
        write_report(path, &report)?;
    }
    if !args.talk.quiet {
        for (job, result) in jobs.iter().zip(&results) {
            print_series(&table, result);
            crate::common::report::print_lines(&job.summary());
        }
    }
    Ok(if passed { Outcome::Done } else { Outcome::NotMet })
}

fn check_plot(args: &SeriesArgs) -> Result<(), Failure> {
    let Some(plot) = &args.plot else { return Ok(()) };
    check_target(plot)?;
    let extension = plot.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    if !["svg", "png"].iter().any(|known| extension.eq_ignore_ascii_case(known)) {
        return Err(Failure::file(plot, format!("found a plot ending in '{extension}'; expected .svg or .png")));
    }
    match [&args.input, &args.output].into_iter().find(|other| is_same_place(plot, other)) {
        Some(other) => Err(Failure::file(plot, format!("the plot would overwrite {}; expected another name", other.display()))),
        None => Ok(()),
    }
}

/// The same wishes in the words of `morsmooth smooth`.
fn smooth_args(args: &SeriesArgs, all: &[Series]) -> SmoothArgs {
    let array = all.iter().map(|series| series.input.name.clone()).collect();
    SmoothArgs {
        field: FieldsArgs { input: args.input.clone(), array, array_pattern: None, mask: None, derive: None },
        output: args.output.clone(),
        output_array: args.output_array.clone(),
        selection: args.selection.clone(),
        select: args.select,
        values: args.values,
        keep_also: None,
        order: args.order,
        length: args.length,
        confidence: None,
        smoothness: None,
        representative: StrategyKind::SmoothThenSimplify,
        edges: EdgesKind::Minimal,
        refine: args.refine,
        gap: 1e-8,
        raw: false,
        plots: None,
        keep_unaudited: args.keep_unaudited,
        talk: args.talk.clone(),
    }
}

/// One column, once for every wish.
fn smooth<'a>(
    args: &SeriesArgs,
    smooth_args: &SmoothArgs,
    table: &SeriesTable,
    series: &'a Series,
    talk: &Talk,
) -> Result<Vec<SmoothColumn<'a>>, Failure> {
    let input = &series.input;
    input.notes.iter().for_each(|note| talk.line(&format!("note: {note}")));
    let wishes = wishes(&args.selection, input)?;
    let roles = [("x", Some(table.table.names()[table.along].as_str())), ("--mask", args.mask.as_deref())];
    let names = array_names(args.output_array.as_deref(), "_smooth", input, &wishes, &roles)?;
    let complex = &input.domain.complex;
    let confidence = (!series.filled.is_empty()).then(|| {
        let mut confidence = vec![1.0; complex.vertex_count()];
        series.filled.iter().filter_map(|&row| series.vertex(row)).for_each(|vertex| confidence[vertex.index()] = 0.0);
        confidence
    });
    let mut plan = Plan { input, wishes, names, confidence, smoothness: None };
    talk.stage("operators");
    let mut smoother = Smoother::new(complex, usize::from(args.order)).map_err(|error| input.smooth_failure(&error))?;
    let mut results = Vec::new();
    for place in 0..plan.wishes.len() {
        let selection = plan.wishes[place].selection.clone();
        let mut spikes = named_spikes(args, table, series)?;
        let mut corners = Vec::new();
        if args.select == SelectKind::Data {
            let field = MeasuredField::new(complex, input.values.clone()).map_err(|error| input.smooth_failure(&error))?;
            let Selected { wanted, unavoidable } =
                select_extrema(complex, &field, &selection).map_err(|error| input.smooth_failure(&error))?;
            if args.spikes.is_some() {
                spikes.extend(wanted.minima.iter().chain(&wanted.maxima));
            }
            // The last step of the noise at an end, which only is an extremum because every line ends in one, would bend the whole
            // series: its energy is that of a feature as long as one step.
            // At order 1 there are corners everywhere.
            for &end in unavoidable.iter().filter(|_| args.order > 1) {
                corners.push(end);
                corners.extend(complex.neighbours(end));
            }
        }
        spikes.sort_unstable();
        spikes.dedup();
        corners.extend(&spikes);
        plan.smoothness = (!corners.is_empty()).then(|| {
            let mut smoothness = vec![1.0; complex.vertex_count()];
            corners.iter().for_each(|corner| smoothness[corner.index()] = 0.0);
            smoothness
        });
        let options = SmoothOptions { selection, ..options(smooth_args, &plan)? };
        let smoothed = smoother
            .smooth(&input.values, &options, &mut |step| talk.progress(&step))
            .map_err(|error| input.smooth_failure(&error))?;
        results.push(SmoothColumn { series, name: plan.names[place].clone(), smoothed, spikes });
    }
    Ok(results)
}

/// The vertices of `--spike`.
fn named_spikes(args: &SeriesArgs, table: &SeriesTable, series: &Series) -> Result<Vec<VertexId>, Failure> {
    let values = &series.input.values;
    let extreme = |sign: f64| {
        let by_value = |a: &usize, b: &usize| (sign * values[*a]).total_cmp(&(sign * values[*b])).then(b.cmp(a));
        (0..values.len()).max_by(by_value).map_or(VertexId(0), VertexId::from)
    };
    let vertex = |text: &String| match text.trim() {
        "max" => Ok(extreme(1.0)),
        "min" => Ok(extreme(-1.0)),
        text => {
            let kind = if table.axis.is_dates { "a date such as 2001-01-05" } else { "a number" };
            let place = table
                .axis
                .place(text)
                .ok_or_else(|| Failure::usage(format!("found --spike '{text}'; expected {kind}, max or min")))?;
            let distance = |row: &&usize| (table.axis.values[**row] - place).abs();
            let nearest = series.rows.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).copied().unwrap_or(0);
            let found = series.vertex(nearest).filter(|_| table.axis.values[nearest] == place);
            found.ok_or_else(|| {
                let column = &series.input.name;
                Failure::file(&args.input, format!("column {column} has no value at '{text}' of --spike; the nearest is at {}", table.place(nearest)))
            })
        }
    };
    args.spike.iter().map(vertex).collect()
}

/// Writes a table as a table and anything else as a polyline, and judges what is in the file then.
fn write(args: &SeriesArgs, table: &SeriesTable, produced: &[Produced<'_>]) -> Result<(PendingFile, Vec<AuditReport>), Failure> {
    let extension = args.output.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    if !["csv", "tsv", "txt"].iter().any(|known| extension.eq_ignore_ascii_case(known)) {
        return write_and_audit(&args.output, produced, OrderArrays::Omitted);
    }
    let mut written = table.table.clone();
    for result in produced {
        written.set_numbers(result.name, &result.array().to_f64(0));
    }
    let told = |error: morsmooth::io::IoError| Failure::usage(error.to_string());
    let pending = written.write_temporary(&args.output).map_err(told)?;
    let again = Table::read(pending.path()).map_err(told)?;
    let judge = |result: &Produced<'_>| {
        let lost = || Failure::file(&args.output, format!("the column {} just written is not in the file", result.name));
        let values = again.numbers(again.column(result.name).ok_or_else(lost)?).map_err(told)?;
        result.judge(&result.input.domain.restrict(&values)).map_err(|error| Failure::file(&args.output, error))
    };
    let verdicts = produced.iter().map(judge).collect::<Result<Vec<_>, _>>()?;
    Ok((pending, verdicts))
}

impl SmoothColumn<'_> {
    fn produced(&self) -> Produced<'_> {
        Produced {
            input: &self.series.input,
            name: &self.name,
            values: &self.smoothed.values,
            wanted: &self.smoothed.wanted,
            rules: &self.smoothed.rules,
            plateaus: Plateaus::Refused,
        }
    }

    /// What a spike is at: a wanted extremum, or a mere corner.
    fn kind(&self, vertex: VertexId) -> &'static str {
        let wanted = &self.smoothed.wanted;
        match (wanted.minima.binary_search(&vertex), wanted.maxima.binary_search(&vertex)) {
            (Ok(_), _) => "minimum",
            (_, Ok(_)) => "maximum",
            _ => "no extremum",
        }
    }
}

/// The report of `morsmooth smooth`, with places as the table calls them.
fn told(job: &SmoothJob<'_>, table: &SeriesTable, result: &SmoothColumn<'_>) -> Value {
    let mut report = job.to_json();
    let series = result.series;
    let place = |&vertex: &VertexId| table.place(series.row(vertex)).to_owned();
    let wanted = &result.smoothed.wanted;
    let places = |vertices: &[VertexId]| vertices.iter().map(place).collect::<Vec<_>>();
    let spikes: Vec<Value> =
        result.spikes.iter().map(|vertex| json!({ "row": series.row(*vertex), "place": place(vertex), "kind": result.kind(*vertex) })).collect();
    report["series"] = json!({
        "x": table.table.names()[table.along], "dates": table.axis.is_dates, "rows": table.table.len(),
        "missing": series.missing, "filled": series.filled.len(), "spikes": spikes,
        "minima": places(&wanted.minima), "maxima": places(&wanted.maxima),
    });
    report
}

fn print_series(table: &SeriesTable, result: &SmoothColumn<'_>) {
    use std::io::Write;
    let series = result.series;
    let (Some(&first), Some(&last)) = (series.rows.first(), series.rows.last()) else { return };
    let kind = if table.axis.is_dates { "dates" } else { "numbers" };
    let mut stdout = std::io::stdout().lock();
    let x = &table.table.names()[table.along];
    let _ = writeln!(stdout, "{:<15} {} rows along {x} ({kind}), {} to {}", "series", table.table.len(), table.place(first), table.place(last));
    if !result.spikes.is_empty() {
        let spikes = result.spikes.iter().map(|&spike| format!("{} ({})", table.place(series.row(spike)), result.kind(spike)));
        let shown: Vec<String> = spikes.clone().take(6).collect();
        let rest = result.spikes.len() - shown.len();
        let more = if rest > 0 { format!(" and {rest} more") } else { String::new() };
        let _ = writeln!(stdout, "{:<15} corners allowed at {}{more}", "spikes", shown.join(", "));
    }
}

fn draw(args: &SeriesArgs, table: &SeriesTable, result: &SmoothColumn<'_>, results: usize) -> Result<(), Failure> {
    let Some(plot) = &args.plot else { return Ok(()) };
    let series = result.series;
    let extension = plot.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    let stem = plot.file_stem().and_then(|stem| stem.to_str()).unwrap_or("series");
    let own = format!("{stem}_{}.{extension}", result.name.replace(['/', '\\'], "_"));
    let target = if results > 1 { plot.with_file_name(own) } else { plot.clone() };
    let vertices: Vec<VertexId> = series.rows.iter().filter_map(|&row| series.vertex(row)).collect();
    let places: Vec<f64> = vertices.iter().map(|&vertex| table.axis.values[series.row(vertex)]).collect();
    let is_filled = |vertex: VertexId| series.filled.contains(&series.row(vertex));
    let data: Vec<f64> =
        vertices.iter().map(|&vertex| if is_filled(vertex) { f64::NAN } else { series.input.values[vertex.index()] }).collect();
    let smooth: Vec<f64> = vertices.iter().map(|vertex| result.smoothed.values[vertex.index()]).collect();
    let mut number = vec![0; vertices.len()];
    vertices.iter().enumerate().for_each(|(place, vertex)| number[vertex.index()] = place);
    let numbers = |of: &[VertexId]| of.iter().map(|vertex| number[vertex.index()]).collect::<Vec<_>>();
    let wanted = &result.smoothed.wanted;
    let report = &result.smoothed.report;
    let title = format!("{}: {} of {} extrema", result.name, report.wanted.minima + report.wanted.maxima, report.before.minima + report.before.maxima);
    let chart = SeriesChart {
        title: &title,
        place: &table.table.names()[table.along],
        kind: if table.axis.is_dates { PlaceKind::Days } else { PlaceKind::Numbers },
        places: &places,
        data: &data,
        smooth: &smooth,
        minima: &numbers(&wanted.minima),
        maxima: &numbers(&wanted.maxima),
        spikes: &numbers(&result.spikes),
    };
    let written = match extension.eq_ignore_ascii_case("png") {
        true => chart.picture().and_then(|picture| picture.write_png(&target)),
        false => chart.svg().and_then(|svg| write_atomically(&target, svg.as_bytes())),
    };
    written.map_err(|error| Failure::file(&target, error))
}
