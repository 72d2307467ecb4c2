//! `morsmooth`: parse, resolve, run, report. The only code that prints.
#![allow(clippy::print_stdout, clippy::print_stderr)]

mod args;
mod common;
mod failure;
mod fields;
mod files;
mod functions;
mod shapes;
mod stop;

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
        Command::Animate(args) => shapes::animate::run(args),
        Command::Deform(args) => shapes::deform::run(args),
        Command::Geodesic(args) => functions::geodesic::run(args),
        Command::Info(args) => files::info::run(args),
        Command::Extrema(args) => fields::extrema::run(args),
        Command::Smooth(args) => fields::smooth::run(args),
        Command::Simplify(args) => fields::simplify::run(args),
        Command::Persistence(args) => fields::persistence::run(args),
        Command::Interpolate(args) => functions::interpolate::run(args),
        Command::Diffuse(args) => functions::diffuse::run(args),
        Command::Series(args) => functions::series::run(args),
        Command::Check(args) => fields::check::run(args),
        Command::Complex(args) => fields::complex::run(args),
        Command::Convert(args) => files::convert::run(args),
        Command::Pose(args) => shapes::pose::run(args),
        Command::Weights(args) => functions::weights::run(args),
    }
}
