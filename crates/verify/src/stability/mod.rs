//! Is a method stable where numbers are hard?
//!
//! Scenes that are built to break things, each with a closed form or a quadrature where there is one. Of each method in each
//! of them is asked:
//!
//! - Is every sample finite, and every light path's flux? Does nothing panic?
//! - Is the mean of the passes what its claim says of the truth, by a test over passes?
//! - Are the pixels the same when the metre, or the watt, is a million times as large or small (2^20: rounding stays the same, so
//!   that whatever has a length of its own in it shows)?

mod case;
mod cell;
mod media;
mod site;
mod surfaces;

pub use case::{Case, Truth};
pub use cell::{COLUMNS, Cell, Column, csv};
pub use site::Units;

use crate::finding::Outcome;
use crate::measure::{Effort, Passed, joined, means, pass};
use crate::subject::{Built, Subject};
use crate::verifier::{ALPHA, Promise, edges, promise};
use manylight_framework::Image;
use manylight_stats::{Alternative, BlockTest, Reference, Runs};
use rayon::prelude::*;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// The metre or the watt becomes so many times as large, and as small.
const FACTOR: f64 = (1u64 << 20) as f64;
/// What a pixel may differ by in other units: a few roundings. None is known that does.
const SAME: f64 = 1e-4;
/// What a truth may be off by: approximations of closed forms, and f32 sums.
const ROUNDING: f64 = 2e-4;
/// Passes at first: each may make thousands of lights.
const FIRST: u64 = 16;

/// Puts subjects through hard cases.
#[derive(Clone, Copy, Debug)]
pub struct Stability {
    /// How hard to look.
    pub effort: Effort,
    /// What all random numbers follow from.
    pub seed: u64,
}

impl Stability {
    /// A subject in all cases, which are looked at side by side.
    pub fn run(&self, subject: &dyn Subject) -> Vec<Cell> {
        let cases: Vec<&Case> = Case::all().collect();
        cases.par_iter().map(|case| self.cell(subject, case)).collect()
    }
    /// A subject in a case. Whatever panics is a failure of the cell, and of nothing else.
    pub fn cell(&self, subject: &dyn Subject, case: &Case) -> Cell {
        let mut cell = Cell {
            subject: subject.name(),
            case: case.name,
            outcome: Outcome::Skipped,
            passes: 0,
            non_finite: 0,
            broken_paths: 0,
            error: None,
            std_error: None,
            longer: None,
            brighter: None,
            why: String::new(),
        };
        let work = catch_unwind(AssertUnwindSafe(|| self.look(subject, case, &mut cell)));
        let failure = match work {
            Ok(Ok(())) => return cell,
            Ok(Err(reason)) => reason,
            Err(panic) => {
                let words = panic.downcast_ref::<String>().map(String::as_str);
                format!("panic: {}", words.or(panic.downcast_ref::<&str>().copied()).unwrap_or("without words"))
            }
        };
        Cell { outcome: Outcome::Fails, why: failure, ..cell }
    }
    fn look(&self, subject: &dyn Subject, case: &Case, cell: &mut Cell) -> Result<(), String> {
        let scene = case.scene(Units::PLAIN)?;
        let built = match subject.build(&scene, &[]) {
            Ok(built) => built,
            Err(reason) => {
                cell.why = reason;
                return Ok(());
            }
        };
        let mut faults = Vec::new();
        cell.outcome = Outcome::Holds { would_have_seen: None };
        let runs = self.passes(&scene, &built, cell)?;
        if cell.non_finite > 0 {
            faults.push(format!("{} samples were NaN, infinite or negative", cell.non_finite));
        }
        if cell.broken_paths > 0 {
            faults.push(format!("{} light paths had a flux that was not finite", cell.broken_paths));
        }
        let claim = built.method.claim();
        match case.truth(edges(&scene, &claim)) {
            None => cell.why = "no closed form".into(),
            Some(truth) => {
                let promised = promise(&scene, case.bounded_g, true, &claim, subject.is_path_tracer());
                if let Some(fault) = held(&runs, truth, promised, cell) {
                    faults.push(fault);
                }
            }
        }
        let (image, _) = pass(&scene, &built, self.seed, 0)?;
        let rescaled = |units: Units| self.difference(subject, case, &image, units);
        let largest = |a: Units, b: Units| Ok::<f64, String>(rescaled(a)?.max(rescaled(b)?));
        let (longer, shorter) = (Units { length: FACTOR, light: 1.0 }, Units { length: 1.0 / FACTOR, light: 1.0 });
        let (brighter, darker) = (Units { length: 1.0, light: FACTOR }, Units { length: 1.0, light: 1.0 / FACTOR });
        for (value, what) in [(largest(longer, shorter), "length"), (largest(brighter, darker), "light")].into_iter() {
            let slot = if what == "length" { &mut cell.longer } else { &mut cell.brighter };
            match value {
                Ok(x) => {
                    *slot = Some(x);
                    if !(x <= SAME) {
                        faults.push(format!("pixels change by {x:.1e} with the unit of {what}"));
                    }
                }
                Err(e) => faults.push(e),
            }
        }
        if !faults.is_empty() {
            cell.outcome = Outcome::Fails;
            cell.why = faults.join("; ");
        }
        Ok(())
    }
    /// Passes, as means of the whole image, until they say enough or have cost enough.
    fn passes(&self, scene: &manylight_scene::Scene, built: &Built, cell: &mut Cell) -> Result<Runs, String> {
        let mut rows: Vec<Vec<f64>> = Vec::new();
        let mut work = 0;
        loop {
            let begin = rows.len() as u64;
            for i in begin..begin + begin.max(FIRST) {
                let (image, Passed { cost, non_finite, broken_paths }) = pass(scene, built, self.seed, i)?;
                cell.non_finite += non_finite;
                cell.broken_paths += broken_paths;
                work += cost;
                rows.push(means(&image, 1));
            }
            cell.passes = rows.len() as u64;
            if 2 * work > self.effort.work || crate::measure::seen(&rows, self.effort.target) {
                return Runs::new(joined(rows)).map_err(|e| e.to_string());
            }
        }
    }
    /// Largest relative difference of a pixel from `image`, in other units.
    fn difference(&self, subject: &dyn Subject, case: &Case, image: &Image, units: Units) -> Result<f64, String> {
        let what = format!("with lengths x {:.0e} and light x {:.0e}", units.length, units.light);
        let scene = case.scene(units)?;
        let built = subject.build(&scene, &[]).map_err(|e| format!("{what}: {e}"))?;
        let (other, passed) = pass(&scene, &built, self.seed, 0).map_err(|e| format!("{what}: {e}"))?;
        if passed.non_finite + passed.broken_paths > 0 {
            return Err(format!(
                "{what}: {} samples or paths were not finite",
                passed.non_finite + passed.broken_paths
            ));
        }
        let mean = means(image, 1);
        let pairs = image.pixels.iter().zip(&other.pixels);
        let differences = pairs.flat_map(|(a, b)| {
            let (a, b) = (a.to_array().map(f64::from), b.to_array().map(|x| f64::from(x) / units.light));
            [0, 1, 2].map(|c| if a[c] == b[c] { 0.0 } else { (a[c] - b[c]).abs() / a[c].abs().max(mean[c]) })
        });
        Ok(differences.fold(0.0, f64::max))
    }
}

/// Holds the mean of runs against the truth, as far as is promised; what is wrong.
fn held(runs: &Runs, truth: [f64; 3], promised: Promise, cell: &mut Cell) -> Option<String> {
    let off = (0..3).filter(|c| truth[*c] != 0.0).map(|c| {
        let moments = runs.moments(c);
        ((moments.mean() - truth[c]) / truth[c], moments.std_error() / truth[c])
    });
    let sigmas = |(error, sigma): &(f64, f64)| if *sigma > 0.0 { (error / sigma).abs() } else { error.abs() };
    if let Some((error, sigma)) = off.max_by(|a, b| sigmas(a).total_cmp(&sigmas(b))) {
        (cell.error, cell.std_error) = (Some(error), Some(sigma));
    }
    let alternative = match promised {
        Promise::Same => Alternative::Different,
        Promise::Darker => Alternative::Greater,
        Promise::Nothing(why) => {
            (cell.outcome, cell.why) = (Outcome::NoVerdict, why);
            return None;
        }
    };
    let black = |c: usize| runs.moments(c).mean() == 0.0;
    if (0..3).all(black) && truth != [0.0; 3] && cell.outcome != Outcome::Skipped {
        (cell.outcome, cell.why) = (Outcome::NoVerdict, "every pass is black: what there is to see is too rare".into());
        return None;
    }
    let alpha = ALPHA / Case::all().count() as f64;
    let test = BlockTest { alpha, alternative, rounding: ROUNDING, ..BlockTest::default() };
    match test.run(runs, Reference::Exact(&truth)) {
        Err(e) => (cell.outcome, cell.why) = (Outcome::NoVerdict, e.to_string()),
        Ok(v) if v.rejected() => return Some(format!("the mean is not the truth's: {}", crate::verifier::words(&v))),
        Ok(v) if v.passes() => {
            cell.outcome = Outcome::Holds { would_have_seen: v.detectable.map(|d| d.common) };
        }
        Ok(v) => (cell.outcome, cell.why) = (Outcome::NoVerdict, crate::verifier::words(&v)),
    }
    None
}
