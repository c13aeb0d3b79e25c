//! The threads of a run, as the framework sees them.

use crate::Observer;
use manylight_framework::Scheduler;
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering::Relaxed};
use std::sync::{Mutex, OnceLock};
use std::time::Instant;

/// Runs the tasks of one pass on the pool it is called in, until it is told to stop.
pub struct Workers<'a> {
    cancel: &'a AtomicBool,
    /// Whether anyone in this pass has been told to stop. A pass that ended before anyone asked is complete, even if
    /// `cancel` is set a moment later.
    told: AtomicBool,
    first_run: OnceLock<Instant>,
    observer: Mutex<&'a mut dyn Observer>,
}

impl<'a> Workers<'a> {
    pub fn new(cancel: &'a AtomicBool, observer: &'a mut dyn Observer) -> Self {
        Workers { cancel, told: AtomicBool::new(false), first_run: OnceLock::new(), observer: Mutex::new(observer) }
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
        let done = AtomicUsize::new(0);
        // One task at a time: tiles differ too much in cost to be handed out in blocks.
        (0..tasks).into_par_iter().with_max_len(1).for_each(|i| {
            if !self.cancelled() {
                task(i);
                let done = done.fetch_add(1, Relaxed) + 1;
                // Nobody waits for the observer: who finds it busy tells it nothing.
                if let Ok(mut observer) = self.observer.try_lock() {
                    observer.during_pass(done, tasks);
                }
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
