//! Domains that several fields share, with what was analysed of them: arrays of one file, steps of one series.

use std::collections::VecDeque;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use morsmooth::io::{DataSet, Geometry, domain};
use morsmooth::mesh::{Domain, Mask};
use morsmooth::monotone::FitAnalysis;
use morsmooth::smooth::{SmoothError, Smoother};

/// Domains kept for the next field: one of the mesh, and one with the holes of another array.
const KEPT: usize = 2;

/// A domain and what it was made of.
struct Ground {
    /// Absent where all data sets are one.
    geometry: Option<Geometry>,
    mask: Mask,
    domain: OnceLock<Result<Arc<Domain>, String>>,
    analysis: OnceLock<Result<Arc<FitAnalysis>, SmoothError>>,
}

/// The domains used last. Threads that want the same one at the same time make it once.
pub struct Grounds {
    across_files: bool,
    latest: Mutex<VecDeque<Arc<Ground>>>,
    made: AtomicUsize,
}

impl Grounds {
    /// For the fields of one file: their mesh is one.
    pub fn of_one_file() -> Self {
        Self { across_files: false, latest: Mutex::default(), made: AtomicUsize::new(0) }
    }

    /// For fields of several files: their meshes are compared, number by number.
    pub fn across_files() -> Self {
        Self { across_files: true, ..Self::of_one_file() }
    }

    /// The domain of a data set under a mask.
    pub fn domain(&self, dataset: &DataSet, mask: &Mask) -> Result<Arc<Domain>, String> {
        let ground = self.ground(dataset, mask);
        let make = || {
            self.made.fetch_add(1, Ordering::Relaxed);
            domain(dataset, mask).map(Arc::new).map_err(|error| error.to_string())
        };
        ground.domain.get_or_init(make).clone()
    }

    fn ground(&self, dataset: &DataSet, mask: &Mask) -> Arc<Ground> {
        let is_same = |ground: &Arc<Ground>| {
            ground.mask == *mask && ground.geometry.as_ref().is_none_or(|geometry| *geometry == dataset.geometry)
        };
        let mut latest = self.latest.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(ground) = latest.iter().find(|ground| is_same(ground)) {
            return Arc::clone(ground);
        }
        let ground = Arc::new(Ground {
            geometry: self.across_files.then(|| dataset.geometry.clone()),
            mask: mask.clone(),
            domain: OnceLock::new(),
            analysis: OnceLock::new(),
        });
        latest.truncate(KEPT - 1);
        latest.push_front(Arc::clone(&ground));
        ground
    }

    /// What smoothers on a domain share; `None` where it is used once, so that there is nothing to share.
    pub fn analysis(&self, domain: &Arc<Domain>, order: usize) -> Option<Result<Arc<FitAnalysis>, SmoothError>> {
        let is_meant = |ground: &&Arc<Ground>| matches!(ground.domain.get(), Some(Ok(found)) if Arc::ptr_eq(found, domain));
        let ground = {
            let latest = self.latest.lock().unwrap_or_else(PoisonError::into_inner);
            self.across_files.then(|| latest.iter().find(is_meant).cloned())??
        };
        Some(ground.analysis.get_or_init(|| Smoother::analysis(&domain.complex, order).map(Arc::new)).clone())
    }

    /// How many domains were made.
    pub fn made(&self) -> usize {
        self.made.load(Ordering::Relaxed)
    }
}
