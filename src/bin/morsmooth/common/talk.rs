//! Words go to standard error, and progress only where a person watches.

use std::io::{IsTerminal, Write};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};
use morsmooth::smooth::SmoothProgress;

/// Progress and summary on standard error.
pub struct Talk {
    quiet: bool,
    bar: ProgressBar,
    on_terminal: bool,
}

impl Talk {
    /// Silent if `quiet`; a spinner on a terminal, a line a stage otherwise.
    pub fn new(quiet: bool) -> Self {
        let on_terminal = std::io::stderr().is_terminal();
        let bar = if quiet || !on_terminal { ProgressBar::hidden() } else { ProgressBar::new_spinner() };
        let template = if std::env::var_os("NO_COLOR").is_some() {
            "{spinner} [{elapsed}] {msg}"
        } else {
            "{spinner:.cyan} [{elapsed}] {msg}"
        };
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        bar.enable_steady_tick(Duration::from_millis(100));
        Self { quiet, bar, on_terminal }
    }

    /// Begins a stage.
    pub fn stage(&self, stage: &str) {
        if self.quiet {
            return;
        }
        if self.on_terminal {
            self.bar.set_message(stage.to_owned());
        } else {
            self.line(&format!("{stage} ..."));
        }
    }

    /// Passes on what the library says.
    pub fn progress(&self, progress: &SmoothProgress) {
        match progress {
            SmoothProgress::Stage(stage) => self.stage(stage),
            SmoothProgress::Solver(step) if self.on_terminal => self.bar.set_message(format!(
                "quadratic problem, iteration {}, relative gap {:.1e}, residual {:.1e}",
                step.iteration, step.gap, step.stationarity
            )),
            SmoothProgress::Solver(_) => {}
        }
    }

    /// Says a line. A closed pipe is not an error.
    pub fn line(&self, line: &str) {
        if !self.quiet {
            self.bar.suspend(|| {
                let _ = writeln!(std::io::stderr().lock(), "{line}");
            });
        }
    }

    /// Says what nobody may miss, quiet or not.
    pub fn warn(&self, warning: &str) {
        self.bar.suspend(|| {
            let _ = writeln!(std::io::stderr().lock(), "warning: {warning}");
        });
    }

    /// Removes the spinner.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}
