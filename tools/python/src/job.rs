//! Work on a thread of its own, while Python stays awake for signals and progress.

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::Duration;

use morsmooth::smooth::SmoothProgress;
use pyo3::prelude::*;

use crate::failure::Failure;

/// How often signals are looked for.
const WATCH: Duration = Duration::from_millis(50);
/// Stack of the threads, as that of a main thread.
const STACK: usize = 16 << 20;

/// How a call is to run.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Control {
    /// Threads; all cores without.
    threads: Option<usize>,
    /// Called with a text and a part of the work from 0 to 1.
    progress: Option<Py<PyAny>>,
}

/// A step of the work: what is done, and about how much of all has been.
type Step = (String, f64);

/// Passes on what the work says, and stops it when nobody waits for it any more.
pub struct Talk {
    steps: Sender<Step>,
    is_wanted: Arc<AtomicBool>,
    so_far: f64,
}

/// How the work ended: with a result, with a failure, or with a panic.
type Ending<T> = std::thread::Result<Result<T, Failure>>;

/// What unwinds a thread whose result nobody waits for.
struct Unwanted;

impl Talk {
    /// Says what begins now.
    pub fn stage(&mut self, stage: &str, part: f64) {
        if !self.is_wanted.load(Ordering::Relaxed) {
            // Not a panic: nothing is printed, and the thread ends after its destructors have run.
            resume_unwind(Box::new(Unwanted));
        }
        self.so_far = self.so_far.max(part);
        let _ = self.steps.send((stage.to_owned(), self.so_far));
    }

    /// Passes on what the library says of smoothing. Parts are guesses from typical runs.
    pub fn progress(&mut self, progress: &SmoothProgress) {
        match progress {
            SmoothProgress::Stage(stage) => {
                let part = match *stage {
                    "operators" => 0.0,
                    "extrema of the data" => 0.05,
                    "smoothing length" => 0.1,
                    "unconstrained field" => 0.4,
                    "quadratic problem" => 0.5,
                    "repair" => 0.95,
                    _ => self.so_far,
                };
                self.stage(stage, part);
            }
            SmoothProgress::Solver(step) => {
                let digits = -step.gap.clamp(1e-9, 1.0).log10();
                let text = format!("quadratic problem, iteration {}, relative gap {:.1e}", step.iteration, step.gap);
                self.stage(&text, 0.5 + 0.05 * digits);
            }
        }
    }
}

/// Runs work without the interpreter's lock.
///
/// Between the looks at signals the calling thread sleeps. When a signal handler or the progress function raises, the call returns
/// at once with the exception; the work ends by itself at its next step.
pub fn run<T: Send + 'static>(
    py: Python<'_>,
    control: &Control,
    work: impl FnOnce(&mut Talk) -> Result<T, Failure> + Send + 'static,
) -> PyResult<T> {
    if control.threads == Some(0) {
        return Err(Failure::input("found threads=0; expected at least 1").raise(py));
    }
    let (sender, endings) = channel::<Ending<T>>();
    let (steps, told) = channel::<Step>();
    let is_wanted = Arc::new(AtomicBool::new(true));
    let mut talk = Talk { steps, is_wanted: Arc::clone(&is_wanted), so_far: 0.0 };
    let threads = control.threads.or_else(in_a_child);
    let body = move || {
        let result = catch_unwind(AssertUnwindSafe(|| match threads {
            None => work(&mut talk),
            Some(threads) => {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).stack_size(STACK).build();
                let pool = pool.map_err(|error| Failure::input(format!("{threads} threads could not be started: {error}")))?;
                pool.install(|| work(&mut talk))
            }
        }));
        let _ = sender.send(result);
    };
    let started = std::thread::Builder::new().name("morsmooth".to_owned()).stack_size(STACK).spawn(body);
    started.map_err(|error| Failure::input(format!("a thread could not be started: {error}")).raise(py))?;
    let endings = Mutex::new(endings);
    loop {
        let ending = py.detach(|| wait(&endings));
        if let Err(error) = tell(py, control, &told).and_then(|()| py.check_signals()) {
            is_wanted.store(false, Ordering::Relaxed);
            return Err(error);
        }
        match ending {
            None => {}
            Some(Ok(result)) => return result.map_err(|failure| failure.raise(py)),
            Some(Err(panic)) => {
                let text = panic.downcast_ref::<String>().map(String::as_str).or_else(|| panic.downcast_ref::<&str>().copied());
                return Err(Failure::internal(format!("internal error: {}", text.unwrap_or("without a message"))).raise(py));
            }
        }
    }
}

/// In a child made by fork (multiprocessing), where the threads of the common pool are gone: as many of its own as there are cores.
fn in_a_child() -> Option<usize> {
    static FIRST: OnceLock<u32> = OnceLock::new();
    let is_child = *FIRST.get_or_init(std::process::id) != std::process::id();
    is_child.then(|| std::thread::available_parallelism().map_or(1, std::num::NonZero::get))
}

/// The end of the work, if it comes soon.
fn wait<T>(endings: &Mutex<Receiver<Ending<T>>>) -> Option<Ending<T>> {
    let endings = endings.lock().unwrap_or_else(PoisonError::into_inner);
    match endings.recv_timeout(WATCH) {
        Ok(ending) => Some(ending),
        Err(RecvTimeoutError::Timeout) => None,
        Err(RecvTimeoutError::Disconnected) => Some(Ok(Err(Failure::internal("internal error: the work ended without a result")))),
    }
}

/// Calls the progress function with the steps since the last time.
fn tell(py: Python<'_>, control: &Control, told: &Receiver<Step>) -> PyResult<()> {
    let Some(progress) = &control.progress else { return Ok(()) };
    told.try_iter().try_for_each(|step| progress.call1(py, step).map(drop))
}
