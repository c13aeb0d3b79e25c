//! The threads of a run, as the framework sees them.

use manylight_framework::Scheduler;
use rayon::prelude::*;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::time::Instant;

/// Runs the tasks of one pass on the pool it is called in, until it is told to stop.
pub struct Workers<'a> {
    cancel: &'a AtomicBool,
    /// Whether anyone in this pass has been told to stop. A pass that ended before anyone asked is complete, even if
    /// `cancel` is set a moment later.
    told: AtomicBool,
    first_run: OnceLock<Instant>,
}

impl<'a> Workers<'a> {
    pub fn new(cancel: &'a AtomicBool) -> Self {
        Workers { cancel, told: AtomicBool::new(false), first_run: OnceLock::new() }
    }
    /// Whether something may have been left out of the pass.
    pub fn cut_short(&self) -> bool {
        self.told.load(Relaxed)
    }
    /// When the first tasks began, if any have: what came before was preparation.
    pub fn first_run(&self) -> Option<Instant> {
        self.first_run.get().copied()
    }
}

impl Scheduler for Workers<'_> {
    fn run(&self, tasks: usize, task: &(dyn Fn(usize) + Sync)) {
        self.first_run.get_or_init(Instant::now);
        // One task at a time: tiles differ too much in cost to be handed out in blocks.
        (0..tasks).into_par_iter().with_max_len(1).for_each(|i| {
            if !self.cancelled() {
                task(i);
            }
        });
    }
    fn cancelled(&self) -> bool {
        let cancelled = self.cancel.load(Relaxed);
        if cancelled {
            self.told.store(true, Relaxed);
        }
        cancelled
    }
}
