//! Which checks a claim calls for, and how they are made.

use crate::finding::{self, Finding, Report};
use crate::measure::{Effort, measure};
use crate::place::Place;
use crate::subject::{Built, Knobs, Subject};
use crate::{VerifyError, ladder};
use manylight_framework::{Claim, KnobSet, PathClasses};
use manylight_reference::{BidirectionalPathTracer, Combine, PathTracer};
use manylight_scene::Scene;
use manylight_stats::{Alternative, BlockTest, Outcome, Reference, Runs, Verdict};
use std::collections::BTreeMap;
use std::sync::Mutex;

/// Probability that a right subject fails, all its checks together.
pub const ALPHA: f64 = 1e-3;
/// Checks that share it.
const CHECKS: f64 = 6.0;
/// Rounding of f32 sums.
const ROUNDING: f64 = 2e-5;

/// Holds subjects against their claims, and remembers what the yardsticks measured.
pub struct Verifier {
    /// How hard to look.
    pub effort: Effort,
    /// What all random numbers follow from.
    pub seed: u64,
    places: Vec<Place>,
    truths: Mutex<BTreeMap<(usize, u32, bool), Runs>>,
}

impl Verifier {
    /// In some places.
    pub fn new(places: Vec<Place>, effort: Effort, seed: u64) -> Verifier {
        Verifier { effort, seed, places, truths: Mutex::default() }
    }
    /// All checks that the subject's claim calls for.
    pub fn verify(&self, subject: &dyn Subject) -> Result<Report, VerifyError> {
        let mut report = Report { subject: subject.name(), claim: None, findings: Vec::new() };
        for (at, place) in self.places.iter().enumerate() {
            match subject.build(&place.scene, &[]) {
                Err(reason) => report.findings.push(found(place, "built", finding::Outcome::Skipped, reason)),
                Ok(built) => {
                    let claim = built.method.claim();
                    report.claim.get_or_insert(claim);
                    report.findings.push(self.mean(subject, at, &built, &claim)?);
                    if !claim.is_unbiased() && claim.vanishes_with != KnobSet::NONE && place.for_knobs {
                        report.findings.push(self.vanishing(subject, at, &claim)?);
                    }
                }
            }
        }
        Ok(report)
    }
    /// Are the block means what the claim says of them?
    fn mean(&self, subject: &dyn Subject, at: usize, built: &Built, claim: &Claim) -> Result<Finding, VerifyError> {
        let place = &self.places[at];
        let (check, alternative) =
            match promise(&place.scene, place.bounded_g, place.exact.is_some(), claim, subject.is_path_tracer()) {
                Promise::Same => ("mean is the truth's", Alternative::Different),
                Promise::Darker => ("nowhere too bright", Alternative::Greater),
                Promise::Nothing(why) => {
                    // Still: no sample may be NaN.
                    let outcome = measure(
                        &place.scene,
                        built,
                        self.seed,
                        0,
                        Effort { work: self.effort.work / 8, ..self.effort },
                    );
                    return Ok(match outcome {
                        Ok(_) => found(place, "mean", finding::Outcome::Skipped, why),
                        Err(reason) => found(place, "finite", finding::Outcome::Fails, reason),
                    });
                }
            };
        let runs = match measure(&place.scene, built, self.seed, 0, self.effort) {
            Ok(runs) => runs,
            Err(reason) => return Ok(found(place, check, finding::Outcome::Fails, reason)),
        };
        let test = BlockTest { alpha: ALPHA / CHECKS, alternative, rounding: ROUNDING, ..BlockTest::default() };
        let edges = edges(&place.scene, claim);
        let verdict = match place.exact {
            Some(exact) => {
                let all = exact(edges);
                let mean = all.iter().sum::<f64>() / 3.0;
                let means: Vec<f64> = (0..runs.blocks() - 1).map(|k| all[k % 3]).chain([mean]).collect();
                test.run(&runs, Reference::Exact(&means))
            }
            None => test.run(&runs, Reference::Runs(&self.truth(at, edges, subject.is_path_tracer())?)),
        };
        Ok(match verdict {
            Err(e) => found(place, check, finding::Outcome::NoVerdict, e.to_string()),
            Ok(v) => {
                let outcome = match (v.passes(), v.rejected()) {
                    (true, _) => finding::Outcome::Holds { would_have_seen: v.detectable.map(|d| d.common) },
                    (_, true) => finding::Outcome::Fails,
                    _ => finding::Outcome::NoVerdict,
                };
                found(place, check, outcome, words(&v))
            }
        })
    }
    /// Does the bias go away along the knobs?
    fn vanishing(&self, subject: &dyn Subject, at: usize, claim: &Claim) -> Result<Finding, VerifyError> {
        let place = &self.places[at];
        let check = format!("bias vanishes with {}", claim.vanishes_with.names().join(" and "));
        if !claim.finite_variance && !place.bounded_g {
            let why = "by its claim the variance is infinite here".to_string();
            return Ok(found(place, &check, finding::Outcome::Skipped, why));
        }
        let truth = self.truth(at, edges(&place.scene, claim), subject.is_path_tracer())?;
        let mut ends = Vec::new();
        for end in [ladder::Rung::near(claim.vanishes_with), ladder::Rung::far(claim.vanishes_with)] {
            let knobs: &Knobs = &end.knobs;
            let built = match subject.build(&place.scene, knobs) {
                Ok(built) => built,
                Err(reason) => {
                    return Ok(found(place, &check, finding::Outcome::NoVerdict, format!("{}: {reason}", end.name())));
                }
            };
            match measure(&place.scene, &built, self.seed.wrapping_add(1), end.first_pass, self.effort) {
                Ok(runs) => ends.push(ladder::Bias::of(&runs, &truth)),
                Err(reason) => {
                    return Ok(found(place, &check, finding::Outcome::Fails, format!("{}: {reason}", end.name())));
                }
            }
        }
        let (outcome, detail) = ladder::judge(ends[0], ends[1]);
        Ok(found(place, &check, outcome, detail))
    }
    /// The yardstick's runs in a place, for paths up to so many edges.
    fn truth(&self, at: usize, edges: u32, of_path: bool) -> Result<Runs, VerifyError> {
        let key = (at, edges, of_path);
        let known = self.truths.lock().ok().and_then(|t| t.get(&key).cloned());
        if let Some(runs) = known {
            return Ok(runs);
        }
        let place = &self.places[at];
        let method: Box<dyn manylight_framework::Method> = if of_path {
            Box::new(BidirectionalPathTracer {
                max_edges: edges,
                min_edges: 1,
                certain_edges: 5,
                combine: Combine::Balance,
            })
        } else {
            Box::new(PathTracer { max_edges: edges, ..PathTracer::default() })
        };
        // Noise of the truth is to be no concern: it is shared by all subjects.
        let effort = Effort { target: 0.25 * self.effort.target, work: self.effort.work.saturating_mul(8) };
        let runs = measure(&place.scene, &Built { method, spp: 16 }, self.seed ^ 0x7275_7468, 0, effort)
            .map_err(|reason| VerifyError::Yardstick { place: place.name.clone(), reason })?;
        if let Ok(mut truths) = self.truths.lock() {
            truths.insert(key, runs.clone());
        }
        Ok(runs)
    }
}

/// What a claim says of means in a scene.
pub(crate) enum Promise {
    /// They are the truth's.
    Same,
    /// They are nowhere above it.
    Darker,
    /// Nothing, and why.
    Nothing(String),
}

/// What a claim says of means in a scene. `closed`: the truth is known in closed form.
pub(crate) fn promise(scene: &Scene, bounded_g: bool, closed: bool, claim: &Claim, of_path: bool) -> Promise {
    let infinite = !claim.finite_variance && !bounded_g;
    // Of what is missing, direct light alone can be told apart here.
    let some_missing = !claim.misses.without(PathClasses::INDIRECT).is_empty()
        || claim.misses.common(PathClasses::INDIRECT) == PathClasses::CAUSTICS;
    match (claim.is_unbiased(), claim.brightens) {
        _ if of_path && scene.has_media() && !closed => {
            Promise::Nothing("it is the yardstick in media itself, and there is no other".into())
        }
        _ if infinite => {
            Promise::Nothing("by its claim the variance is infinite here: no mean of passes says anything".into())
        }
        (true, _) if some_missing && scene.has_delta_lobes() => Promise::Darker,
        (true, _) => Promise::Same,
        (false, false) => Promise::Darker,
        (false, true) => Promise::Nothing("its bias may have either sign, and is not bounded".into()),
    }
}

/// Longest path that counts: direct light alone if the method makes nothing else.
pub(crate) fn edges(scene: &Scene, claim: &Claim) -> u32 {
    let most = scene.max_depth().unwrap_or(u32::MAX);
    if claim.misses.contains(PathClasses::INDIRECT) { most.min(2) } else { most }
}

/// A verdict in a line.
pub(crate) fn words(v: &Verdict) -> String {
    if let Outcome::HeavyTail { block, top } = v.outcome {
        let share = 100.0 * top.share;
        return format!(
            "heavy tail: {} of {} runs carry {share:.0} % of the variance of block {block}",
            top.top_runs, top.runs
        );
    }
    let worst = v.worst.relative.map_or("where it is black".into(), |r| format!("{:+.2} %", 100.0 * r));
    let seen = v.detectable.map_or(String::new(), |d| {
        format!("; would have seen {:.2} % of the whole or {:.1} % of any block", 100.0 * d.common, 100.0 * d.single)
    });
    format!("worst block off by {worst}, t = {:.1}, p = {:.2e}{seen}", v.worst.test.t, v.worst.adjusted_p)
}

fn found(place: &Place, check: &str, outcome: finding::Outcome, detail: String) -> Finding {
    Finding { place: place.name.clone(), check: check.into(), outcome, detail }
}
