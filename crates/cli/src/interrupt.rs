//! Ctrl-C.

use crate::failure::Failure;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A flag that the first Ctrl-C (or SIGTERM) sets; the second one ends the program at once.
pub fn flag() -> Result<Arc<AtomicBool>, Failure> {
    let flag = Arc::new(AtomicBool::new(false));
    let handler = Arc::clone(&flag);
    ctrlc::set_handler(move || {
        if handler.swap(true, Ordering::Relaxed) {
            // What the shell reports for a program that Ctrl-C killed.
            std::process::exit(130);
        }
        eprintln!("\ninterrupted: writing what there is (once more to quit without)");
    })
    .map_err(|e| Failure::Mistake(format!("Ctrl-C cannot be caught: {e}")))?;
    Ok(flag)
}
