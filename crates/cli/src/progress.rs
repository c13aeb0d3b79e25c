//! Progress on stderr: a bar on a terminal, a line now and then elsewhere.

use crate::units;
use indicatif::{ProgressBar, ProgressStyle};
use manylight_render::{Budget, Observer, Progress};
use std::io::IsTerminal;
use std::time::{Duration, Instant};

/// Tells the user where the rendering stands.
pub struct Report {
    budget: Budget,
    start: Instant,
    passes: u64,
    target: Target,
}

enum Target {
    Nobody,
    Bar(ProgressBar),
    /// Plain lines, the next of them not before this time.
    Lines(Duration),
}

/// Where there is no terminal, time between two lines.
const BETWEEN_LINES: Duration = Duration::from_secs(5);
const STEPS: u64 = 1000;

impl Report {
    /// Starts to report.
    pub fn new(budget: Budget, quiet: bool) -> Self {
        let target = match (quiet, std::io::stderr().is_terminal()) {
            (true, _) => Target::Nobody,
            (false, true) => Target::Bar(bar()),
            (false, false) => Target::Lines(BETWEEN_LINES),
        };
        Report { budget, start: Instant::now(), passes: 0, target }
    }
    /// Takes the bar away, so that the summary stands alone.
    pub fn finish(self) {
        if let Target::Bar(bar) = self.target {
            bar.finish_and_clear();
        }
    }
}

impl Observer for Report {
    fn after_pass(&mut self, progress: &Progress) {
        self.passes = progress.passes;
        match &mut self.target {
            Target::Nobody => {}
            Target::Bar(bar) => {
                bar.set_position(steps(self.budget, progress.passes as f64, progress.elapsed));
                bar.set_message(line(self.budget, progress));
            }
            Target::Lines(next) => {
                if progress.passes == 1 || progress.elapsed >= *next {
                    eprintln!("{}", line(self.budget, progress));
                    *next = progress.elapsed + BETWEEN_LINES;
                }
            }
        }
    }
    fn during_pass(&mut self, done: usize, tasks: usize) {
        let part = done as f64 / tasks as f64;
        let elapsed = self.start.elapsed();
        match &mut self.target {
            Target::Nobody => {}
            Target::Bar(bar) => {
                bar.set_position(steps(self.budget, self.passes as f64 + part, elapsed));
                if self.passes == 0 {
                    bar.set_message(format!("pass 1: {:.0} %", 100.0 * part));
                }
            }
            Target::Lines(next) => {
                if elapsed >= *next {
                    eprintln!("pass {}: {:.0} %, {}", self.passes + 1, 100.0 * part, units::time(elapsed));
                    *next = elapsed + BETWEEN_LINES;
                }
            }
        }
    }
}

fn bar() -> ProgressBar {
    let bar = ProgressBar::new(STEPS);
    let style = ProgressStyle::with_template("{spinner} {bar:30} {wide_msg}");
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    bar.set_message("pass 1");
    bar.enable_steady_tick(Duration::from_millis(200));
    bar
}

/// How much of the budget is spent, 0 to 1.
fn fraction(budget: Budget, passes: f64, elapsed: Duration) -> f64 {
    let fraction = match budget {
        Budget::Passes(n) => passes / n as f64,
        Budget::Time(time) => elapsed.as_secs_f64() / time.as_secs_f64(),
    };
    fraction.clamp(0.0, 1.0)
}

fn steps(budget: Budget, passes: f64, elapsed: Duration) -> u64 {
    (fraction(budget, passes, elapsed) * STEPS as f64) as u64
}

fn line(budget: Budget, progress: &Progress) -> String {
    let done = fraction(budget, progress.passes as f64, progress.elapsed);
    // 1 / done - 1: what is left of the budget as a multiple of what is spent.
    let left = progress.elapsed.as_secs_f64() * (1.0 / done - 1.0);
    let left = Duration::try_from_secs_f64(left).unwrap_or(Duration::ZERO);
    let passes = match budget {
        Budget::Passes(n) => format!("pass {} of {n}", progress.passes),
        Budget::Time(_) => format!("pass {}", progress.passes),
    };
    let speed = units::count(progress.rays as f64 / progress.elapsed.as_secs_f64().max(1e-9));
    let error = progress.estimated_error.map_or(String::new(), |e| format!(", relMSE about {e:.2e}"));
    format!("{passes}, {} ({} left){error}, {speed} rays/s", units::time(progress.elapsed), units::time(left))
}

#[cfg(test)]
mod tests {
    use super::*;

    const PROGRESS: Progress =
        Progress { passes: 3, elapsed: Duration::from_secs(6), estimated_error: Some(0.01234), rays: 7_200_000 };

    #[test]
    fn a_line_says_what_is_done_what_is_left_and_how_good_it_is() {
        let passes = line(Budget::Passes(12), &PROGRESS);
        assert_eq!(passes, "pass 3 of 12, 6.0 s (18.0 s left), relMSE about 1.23e-2, 1.20 M rays/s");
        let time = line(Budget::Time(Duration::from_secs(30)), &PROGRESS);
        assert_eq!(time, "pass 3, 6.0 s (24.0 s left), relMSE about 1.23e-2, 1.20 M rays/s");
    }
    #[test]
    fn a_budget_overdrawn_by_the_first_two_passes_leaves_nothing() {
        let first = Progress { passes: 1, estimated_error: None, ..PROGRESS };
        assert_eq!(line(Budget::Time(Duration::from_secs(1)), &first), "pass 1, 6.0 s (0.0 s left), 1.20 M rays/s");
    }
}
