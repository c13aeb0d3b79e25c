//! `manylight verify --stability`.

use super::Registered;
use crate::args::Verify;
use crate::failure::Failure;
use crate::output::{say, table};
use manylight_recipes::{COMPOSED, methods};
use manylight_render::files::write_atomically;
use manylight_verify::stability::{Case, Cell, Stability, csv};
use manylight_verify::{Effort, Outcome, Subject};

/// Light paths a pass at most: hard numbers need no more, and there are many cells.
const PATHS: u64 = 64;

/// Puts methods through all hard cases.
pub fn run(args: &Verify, chosen: Option<Registered>) -> Result<(), Failure> {
    let alone = chosen.is_some();
    let subjects = chosen.map_or_else(|| all(args.thorough), |one| vec![one]);
    let effort = if args.thorough {
        Effort { work: 20_000_000, ..Effort::THOROUGH }
    } else {
        Effort { work: 50_000, ..Effort::QUICK }
    };
    let stability = Stability { effort, seed: args.seed };
    let mut cells = Vec::new();
    for subject in &subjects {
        let of_one = stability.run(subject);
        if alone {
            // What is wrong with a parameter is wrong everywhere.
            if let Some(cell) = of_one.first().filter(|_| of_one.iter().all(|c| c.outcome == Outcome::Skipped)) {
                return Err(Failure::Mistake(cell.why.clone()));
            }
            let cases: Vec<_> = Case::all().map(|c| [c.name.to_string(), c.about.to_string()]).collect();
            say(table(&cases));
        }
        say(summary(&subject.name(), &of_one, alone));
        cells.extend(of_one);
    }
    if let Some(path) = &args.table {
        let json = path.extension().is_some_and(|e| e == "json");
        let text = if json { serde_json::to_string_pretty(&cells)? } else { csv(&cells) };
        write_atomically(path, text.as_bytes())?;
        say(format!("wrote {}", path.display()));
    }
    let failed = cells.iter().filter(|c| c.outcome == Outcome::Fails).count();
    let asked = cells.iter().filter(|c| c.outcome != Outcome::Skipped).count();
    if failed > 0 {
        return Err(Failure::CheckFailed(format!("{failed} of {asked} cells of the table fail")));
    }
    say(format!("{asked} cells of the table, none fails"));
    Ok(())
}

/// Each method as it is, with few lights; and without its bound: all of them if `thorough`, else those whose generator and light set are
/// the plainest, since the bound does not know these.
fn all(thorough: bool) -> Vec<Registered> {
    let mut all = Vec::new();
    for info in methods() {
        let is = |name: &str, of: &dyn Fn(&str) -> bool| {
            info.params().find(|p| p.name == name).is_some_and(|p| of(p.default))
        };
        // What composes all others is what its defaults are.
        if info.name == COMPOSED && !thorough {
            continue;
        }
        let many = is("paths", &|n| n.parse().is_ok_and(|n: u64| n > PATHS));
        let few: Vec<_> = many.then(|| ("paths".to_string(), PATHS.to_string())).into_iter().collect();
        let plainest = !is("generator", &|g| g != "keller") && is("lights", &|l| l == "all");
        all.push(Registered { info, parameters: few.clone() });
        if is("bound", &|b| b != "none") && (thorough || plainest) {
            let parameters = few.into_iter().chain([("bound".into(), "none".into())]).collect();
            all.push(Registered { info, parameters });
        }
    }
    all
}

/// A line, and one for each cell that fails, or for all.
fn summary(name: &str, cells: &[Cell], all: bool) -> String {
    let count = |word: &str| cells.iter().filter(|c| c.outcome.word() == word).count();
    let most = |of: fn(&Cell) -> Option<f64>| cells.iter().filter_map(of).fold(0.0, f64::max);
    let bad: u64 = cells.iter().map(|c| c.non_finite + c.broken_paths).sum();
    let head = format!(
        "{name}: {} hold, {} fail, {} without verdict, {} skipped; {bad} samples or paths not finite; scaled, pixels move by {:.0e}",
        count("holds"),
        count("FAILS"),
        count("no verdict"),
        count("skipped"),
        most(|c| c.longer).max(most(|c| c.brighter)),
    );
    let number = |x: Option<f64>| x.map_or("-".into(), |x| format!("{x:+.1e}"));
    let shown = cells.iter().filter(|c| all || c.outcome == Outcome::Fails);
    let rows: Vec<_> = shown
        .map(|c| {
            let error = c.error.map_or("-".into(), |e| format!("{e:+.1e} +- {:.0e}", c.std_error.unwrap_or(0.0)));
            [c.outcome.word().into(), c.case.into(), error, number(c.longer), number(c.brighter), c.why.clone()]
        })
        .collect();
    if rows.is_empty() { head } else { format!("{head}\n{}", table(&rows).trim_end()) }
}
