//! Ctrl-C and the request to end: nothing half-written stays behind.

use crate::failure::Failure;

/// Has the program remove its temporary files when it is interrupted (exit code 130) or told to end (143), as shells count signals.
///
/// Systems without signals end the program as before.
#[cfg(unix)]
pub fn tidy_when_told_to_stop() -> Result<(), Failure> {
    use morsmooth::io::remove_pending_files;
    use signal_hook::consts::{SIGINT, SIGTERM};
    use signal_hook::iterator::Signals;

    const SIGNALLED: i32 = 128;
    let failed = |error: std::io::Error| Failure::usage(format!("no thread can wait for signals: {error}"));
    let mut signals = Signals::new([SIGINT, SIGTERM]).map_err(failed)?;
    let wait = move || {
        if let Some(signal) = signals.forever().next() {
            remove_pending_files(|| std::process::exit(SIGNALLED + signal))
        }
    };
    std::thread::Builder::new().name("signals".to_owned()).spawn(wait).map(|_| ()).map_err(failed)
}

#[cfg(not(unix))]
pub fn tidy_when_told_to_stop() -> Result<(), Failure> {
    Ok(())
}
