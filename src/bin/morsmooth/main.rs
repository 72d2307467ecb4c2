//! `morsmooth`: parse, resolve, run, report. The only code that prints.
#![allow(clippy::print_stdout, clippy::print_stderr)]

mod animate;
mod args;
mod beside;
mod by_hand;
mod check;
mod complex;
mod complex_report;
mod convert;
mod deform;
mod diffuse;
mod diffuse_colours;
mod extrema;
mod failure;
mod geodesic;
mod geodesic_report;
mod geodesic_sources;
mod ground;
mod info;
mod input;
mod interpolate;
mod interpolate_data;
mod journal;
mod number;
mod output;
mod pattern;
mod persistence;
mod pictures;
mod pose;
mod pose_audit;
mod posed;
mod report;
mod series;
mod series_input;
mod shape;
mod shape_file;
mod shape_pictures;
mod shape_input;
mod simplify;
mod smooth;
mod smooth_series;
mod steps;
mod steps_report;
mod stop;
mod table;
mod talk;
mod weight_arrays;
mod weights;
mod weights_report;
mod wishes;
mod written;

use std::process::ExitCode;

use clap::Parser;

use args::{Cli, Command};
use failure::Failure;

/// How a run ended: 0 done and audited, 1 finished but the guarantee was not met, 2 usage or input; 130 and 143 if it was told to stop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Outcome {
    Done,
    NotMet,
}

fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => {
            // Help and version are data; everything else is a usage error.
            let code = if error.use_stderr() { 2 } else { 0 };
            let _ = error.print();
            return ExitCode::from(code);
        }
    };
    match run(&cli.command) {
        Ok(Outcome::Done) => ExitCode::SUCCESS,
        Ok(Outcome::NotMet) => ExitCode::from(1),
        Err(failure) => {
            failure.print();
            ExitCode::from(2)
        }
    }
}

fn run(command: &Command) -> Result<Outcome, Failure> {
    stop::tidy_when_told_to_stop()?;
    let threads = match command {
        Command::Animate(args) => args.talk.threads,
        Command::Deform(args) => args.talk.threads,
        Command::Geodesic(args) => args.talk.threads,
        Command::Info(args) => args.talk.threads,
        Command::Extrema(args) => args.talk.threads,
        Command::Smooth(args) => args.talk.threads,
        Command::Simplify(args) => args.talk.threads,
        Command::Persistence(args) => args.talk.threads,
        Command::Interpolate(args) => args.talk.threads,
        Command::Diffuse(args) => args.talk.threads,
        Command::Series(args) => args.talk.threads,
        Command::Check(args) => args.talk.threads,
        Command::Complex(args) => args.talk.threads,
        Command::Convert(args) => args.talk.threads,
        Command::Pose(args) => args.talk.threads,
        Command::Weights(args) => args.talk.threads,
    };
    if let Some(threads) = threads {
        if threads == 0 {
            return Err(Failure::usage("found --threads 0; expected at least 1"));
        }
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build_global()
            .map_err(|error| Failure::usage(format!("{threads} threads could not be started: {error}")))?;
    }
    match command {
        Command::Animate(args) => animate::run(args),
        Command::Deform(args) => deform::run(args),
        Command::Geodesic(args) => geodesic::run(args),
        Command::Info(args) => info::run(args),
        Command::Extrema(args) => extrema::run(args),
        Command::Smooth(args) => smooth::run(args),
        Command::Simplify(args) => simplify::run(args),
        Command::Persistence(args) => persistence::run(args),
        Command::Interpolate(args) => interpolate::run(args),
        Command::Diffuse(args) => diffuse::run(args),
        Command::Series(args) => series::run(args),
        Command::Check(args) => check::run(args),
        Command::Complex(args) => complex::run(args),
        Command::Convert(args) => convert::run(args),
        Command::Pose(args) => pose::run(args),
        Command::Weights(args) => weights::run(args),
    }
}
