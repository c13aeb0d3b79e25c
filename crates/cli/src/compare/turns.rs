//! One run of all methods, which take turns pass by pass: what disturbs the machine disturbs all alike.

use super::Entry;
use crate::failure::Failure;
use manylight_framework::Image;
use manylight_render::{Accumulator, Budget, Progress, RenderError, Rendering, Session, Settings};
use manylight_report::Cost;
use manylight_scene::Scene;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// A method at one of its budgets.
pub struct Snapshot {
    /// Which of the methods.
    pub entry: usize,
    /// The budget it has just spent.
    pub budget: Cost,
    /// All passes so far.
    pub rendering: Rendering,
    /// The means of every other pass, from two passes on: independent of each other.
    pub halves: Option<[Image; 2]>,
}

struct Turn<'s> {
    session: Session<'s>,
    halves: [Accumulator; 2],
    /// Budgets spent.
    spent: usize,
}

/// Renders all methods until their last budget, and hands each snapshot to `seen`. Budgets ascend, and a larger one goes on from the
/// smaller. `false`: it was interrupted.
pub fn run(
    scene: &Scene,
    entries: &[Entry],
    budgets: &[Cost],
    (seed, threads): (u64, Option<usize>),
    cancel: &Arc<AtomicBool>,
    seen: &mut dyn FnMut(Snapshot) -> Result<(), Failure>,
) -> Result<bool, Failure> {
    let Some(last) = budgets.last().copied() else { return Ok(true) };
    let (width, height) = (scene.camera().size.0 as usize, scene.camera().size.1 as usize);
    let mut turns = Vec::new();
    for e in entries {
        let settings = Settings { budget: budget(last), seed, spp: e.recipe.spp, threads };
        let session = Session::new(scene, &*e.recipe.method, &settings)?;
        turns.push(Turn { session, halves: [0, 1].map(|_| Accumulator::new(width, height)), spent: 0 });
    }
    // Whoever has spent the smallest part of the largest budget is next; of equals, the first.
    while let Some(next) = (0..turns.len())
        .filter(|&i| turns[i].spent < budgets.len())
        .min_by(|&i, &j| turns[i].part(last).total_cmp(&turns[j].part(last)))
    {
        let turn = &mut turns[next];
        let even = turn.session.passes() % 2;
        let pass = match turn.session.step(&mut |_: &Progress| (), cancel) {
            Ok(Some(pass)) => pass,
            Ok(None) | Err(RenderError::Interrupted) => return Ok(false),
            Err(e) => return Err(e.into()),
        };
        turn.halves[even as usize].add(&pass)?;
        let (passes, elapsed) = (turn.session.passes(), turn.session.elapsed());
        while let Some(&cost) = budgets.get(turn.spent).filter(|c| budget(**c).is_spent(passes, elapsed)) {
            turn.spent += 1;
            let halves = (passes > 1).then(|| [0, 1].map(|i| turn.halves[i].mean()));
            seen(Snapshot { entry: next, budget: cost, rendering: turn.session.rendering(), halves })?;
        }
    }
    Ok(true)
}

impl Turn<'_> {
    fn part(&self, of: Cost) -> f64 {
        let done = match of {
            Cost::Seconds(_) => self.session.elapsed().as_secs_f64(),
            Cost::Passes(_) => self.session.passes() as f64,
        };
        done / of.value()
    }
}

fn budget(cost: Cost) -> Budget {
    match cost {
        Cost::Passes(n) => Budget::Passes(n),
        Cost::Seconds(s) => Budget::Time(Duration::from_secs_f64(s)),
    }
}
