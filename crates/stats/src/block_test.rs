//! Are the block means of an image what they should be?

use crate::mean_test::satterthwaite;
use crate::runs::check_blocks;
use crate::verdict::{Detectable, Outcome, Worst};
use crate::{Alternative, Detection, MeanTest, Runs, StatsError, TopShare, Verdict, holm};

/// What an estimator is compared with, block by block.
#[derive(Clone, Copy, Debug)]
pub enum Reference<'a> {
    /// Known exactly.
    Exact(&'a [f64]),
    /// Means with their standard errors, each of which has `degrees` of freedom (runs - 1; infinite if well known).
    Estimate {
        /// Means.
        mean: &'a [f64],
        /// Standard errors of the means.
        std_error: &'a [f64],
        /// Degrees of freedom of the standard errors.
        degrees: f64,
    },
    /// Independent runs of another estimator.
    Runs(&'a Runs),
}

/// The block mean test: t over the runs for each block, Holm over the blocks.
///
/// Few large blocks see more than many small ones. Blocks of one run may depend on each other in any way. Student's t wants
/// block means that are near Gaussian, or many runs: with skewness 1.75 (lognormal, sigma 0.5) in 8 blocks an alpha of 0.05
/// becomes 0.13 at 16 runs, 0.06 at 64 and above.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockTest {
    /// Family-wise probability of rejecting what is right.
    pub alpha: f64,
    /// Power at which the smallest detectable bias is reported.
    pub power: f64,
    /// Which departures count: `Greater` for a method that may darken but never brighten.
    pub alternative: Alternative,
    /// Relative difference that counts as none: rounding to f32. It matters only where there is next to no variance.
    pub rounding: f64,
}

impl Default for BlockTest {
    fn default() -> Self {
        BlockTest { alpha: 0.01, power: 0.9, alternative: Alternative::Different, rounding: 1e-6 }
    }
}

impl BlockTest {
    /// Compares the runs `a` with `reference`. Refuses to conclude if any block is heavy-tailed (`TopShare`).
    pub fn run(&self, a: &Runs, reference: Reference) -> Result<Verdict, StatsError> {
        let means = reference.estimates(a.blocks())?;
        let tests: Vec<MeanTest> = means.iter().enumerate().map(|(k, b)| self.compare(a, k, b)).collect();
        let adjusted = holm(&tests.iter().map(|t| t.p_value).collect::<Vec<_>>());
        let relative = |k: usize, x: f64| (means[k].mean != 0.0).then(|| x / means[k].mean.abs());
        // The first of equals in p; t decides among p values that are all 0.
        let worst = (0..tests.len())
            .min_by(|&i, &j| {
                let by_p = adjusted[i].total_cmp(&adjusted[j]).then(tests[i].p_value.total_cmp(&tests[j].p_value));
                by_p.then(tests[j].t.abs().total_cmp(&tests[i].t.abs()))
            })
            .ok_or(StatsError::NoBlocks)?;
        let detection =
            Detection { alpha: self.alpha, comparisons: tests.len(), power: self.power, alternative: self.alternative };
        let seen =
            (0..tests.len()).filter_map(|k| relative(k, detection.smallest_bias(tests[k].std_error, tests[k].degrees)));
        let outcome = match heaviest_block(a, reference) {
            Some((block, top)) => Outcome::HeavyTail { block, top },
            _ if adjusted[worst] <= self.alpha => Outcome::Rejected,
            _ => Outcome::Passes,
        };
        Ok(Verdict {
            outcome,
            worst: Worst {
                block: worst,
                relative: relative(worst, tests[worst].difference),
                test: tests[worst],
                adjusted_p: adjusted[worst],
            },
            detectable: seen
                .map(|x| Detectable { common: x, single: x })
                .reduce(|x, y| Detectable { common: x.common.min(y.common), single: x.single.max(y.single) }),
            detection,
            runs: a.runs(),
        })
    }
    fn compare(&self, a: &Runs, block: usize, b: &Estimate) -> MeanTest {
        let moments = a.moments(block);
        let std_error = moments.std_error().hypot(b.std_error);
        let degrees = satterthwaite([(moments.std_error(), moments.count() as f64 - 1.0), (b.std_error, b.degrees)]);
        let difference = moments.mean() - b.mean;
        let rounding = (self.rounding * b.mean.abs()).min(difference.abs());
        let beyond = MeanTest::new(difference - rounding.copysign(difference), std_error, degrees, self.alternative);
        MeanTest { difference, ..beyond }
    }
}

/// One block of a reference.
struct Estimate {
    mean: f64,
    std_error: f64,
    degrees: f64,
}

impl Reference<'_> {
    fn estimates(&self, blocks: usize) -> Result<Vec<Estimate>, StatsError> {
        let estimates: Vec<Estimate> = match *self {
            Reference::Exact(mean) => {
                mean.iter().map(|m| Estimate { mean: *m, std_error: 0.0, degrees: f64::INFINITY }).collect()
            }
            Reference::Estimate { mean, std_error, degrees } => {
                check_blocks(mean.len(), std_error.len())?;
                mean.iter().zip(std_error).map(|(m, s)| Estimate { mean: *m, std_error: *s, degrees }).collect()
            }
            Reference::Runs(b) => (0..b.blocks())
                .map(|k| b.moments(k))
                .map(|m| Estimate { mean: m.mean(), std_error: m.std_error(), degrees: m.count() as f64 - 1.0 })
                .collect(),
        };
        check_blocks(blocks, estimates.len())?;
        let usable =
            |e: &Estimate| e.mean.is_finite() && e.std_error.is_finite() && e.std_error >= 0.0 && e.degrees > 0.0;
        match estimates.iter().position(|e| !usable(e)) {
            Some(block) => Err(StatsError::BadReference { block }),
            None => Ok(estimates),
        }
    }
}

/// The heavy-tailed block, of either side, whose share is the least likely.
fn heaviest_block(a: &Runs, reference: Reference) -> Option<(usize, TopShare)> {
    let b = if let Reference::Runs(b) = reference { Some(b) } else { None };
    let tops = [Some(a), b].into_iter().flatten();
    tops.flat_map(|runs| (0..runs.blocks()).map(|k| (k, TopShare::new(runs.block(k)))))
        .filter(|(_, top)| top.is_heavy(a.blocks()))
        .min_by(|(_, x), (_, y)| x.chance.total_cmp(&y.chance))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Moments;
    use crate::rng::Rng;
    use crate::synthetic::{assert_at_most, assert_between, count, runs};

    const TEST: BlockTest = BlockTest { alpha: 0.05, power: 0.9, alternative: Alternative::Different, rounding: 0.0 };
    const EXACT: [f64; 8] = [1.0, 2.0, 0.5, 4.0, 1.0, 0.1, 3.0, 1.5];

    /// Runs with noise of 2 %, of which the blocks share `shared`; block k is biased by the factor `bias(k)`.
    fn estimator(rng: &mut Rng, n: usize, shared: f64, bias: impl Fn(usize) -> f64) -> Runs {
        let row = |rng: &mut Rng| {
            let common = rng.normal();
            let own = (1.0 - shared * shared).sqrt();
            let noise = |rng: &mut Rng| 1.0 + 0.02 * (shared * common + own * rng.normal());
            EXACT.iter().enumerate().map(|(k, m)| m * bias(k) * noise(rng)).collect()
        };
        Runs::new((0..n).map(|_| row(rng)).collect()).unwrap()
    }
    fn unbiased(_: usize) -> f64 {
        1.0
    }
    #[test]
    fn what_is_right_is_rejected_as_seldom_as_stated() {
        for n in [4, 16, 64] {
            for shared in [0.0, 0.9] {
                let errs = count(n as u64, 1000, |rng| {
                    TEST.run(&estimator(rng, n, shared, unbiased), Reference::Exact(&EXACT)).unwrap().rejected()
                });
                if shared == 0.0 { assert_between(errs, 1000, 0.045, 0.05) } else { assert_at_most(errs, 1000, 0.05) }
            }
        }
    }
    #[test]
    fn so_it_is_against_noisy_references() {
        let against_runs = count(1, 1000, |rng| {
            let (a, b) = (estimator(rng, 20, 0.5, unbiased), estimator(rng, 40, 0.5, unbiased));
            TEST.run(&a, Reference::Runs(&b)).unwrap().rejected()
        });
        let against_estimate = count(2, 1000, |rng| {
            let b: Vec<Moments> = {
                let b = estimator(rng, 10, 0.5, unbiased);
                (0..8).map(|k| b.moments(k)).collect()
            };
            let mean: Vec<f64> = b.iter().map(Moments::mean).collect();
            let std_error: Vec<f64> = b.iter().map(Moments::std_error).collect();
            let reference = Reference::Estimate { mean: &mean, std_error: &std_error, degrees: 9.0 };
            TEST.run(&estimator(rng, 20, 0.5, unbiased), reference).unwrap().rejected()
        });
        for errs in [against_runs, against_estimate] {
            assert_between(errs, 1000, 0.03, 0.05);
        }
    }
    #[test]
    fn a_liar_by_one_percent_is_rejected_at_the_computed_power() {
        let test = BlockTest { alpha: 0.01, ..TEST };
        let detection = Detection { alpha: 0.01, comparisons: 8, power: 0.9, alternative: Alternative::Different };
        for (n, against) in [(40, 0.0), (81, 0.0), (81, 1.0)] {
            // One block lies. Against an exact value, or as many runs of the truth.
            let bias = 0.01 / (1.01 * 0.02) * (n as f64 / (1.0 + against)).sqrt();
            let degrees = (n as f64 - 1.0) * (1.0 + against);
            let power = detection.power_against(bias, degrees);
            let seen = count(n, 1000, |rng| {
                let a = estimator(rng, n as usize, 0.3, |k| if k == 3 { 1.01 } else { 1.0 });
                let b = estimator(rng, n as usize, 0.3, unbiased);
                let reference = if against == 0.0 { Reference::Exact(&EXACT) } else { Reference::Runs(&b) };
                let verdict = test.run(&a, reference).unwrap();
                verdict.rejected() && verdict.worst.block == 3
            });
            assert_between(seen, 1000, power - 0.02, power + 0.02);
        }
        assert_eq!(detection.runs_needed(0.02, 0.01), 82);
    }
    #[test]
    fn the_reported_smallest_bias_is_the_smallest() {
        let mut rng = Rng::new(5);
        let verdict = TEST.run(&estimator(&mut rng, 100, 0.0, unbiased), Reference::Exact(&EXACT)).unwrap();
        let found = verdict.detectable.unwrap();
        let detection = Detection { comparisons: 8, ..verdict.detection };
        let stated = detection.smallest_bias(0.02 / 10.0, 99.0);
        assert!(
            found.common < stated && stated < found.single && found.single < 1.3 * found.common,
            "{found:?} {stated}"
        );
    }
    #[test]
    fn one_that_only_darkens_may_darken_but_not_brighten() {
        let test = BlockTest { alternative: Alternative::Greater, ..TEST };
        let mut rng = Rng::new(6);
        let mut rejects = |bias: f64| {
            let a = estimator(&mut rng, 50, 0.0, |k| if k == 1 { bias } else { 1.0 });
            test.run(&a, Reference::Exact(&EXACT)).unwrap().rejected()
        };
        assert!(!rejects(0.8) && rejects(1.03));
        let errs = count(7, 1000, |rng| {
            test.run(&estimator(rng, 16, 0.0, unbiased), Reference::Exact(&EXACT)).unwrap().rejected()
        });
        assert_between(errs, 1000, 0.045, 0.05);
    }
    #[test]
    fn a_heavy_tail_gets_no_verdict() {
        let pareto = |seed: u64, n: usize, comparisons: usize| {
            count(seed, 200, |rng| {
                let a = runs(rng, n, comparisons, |rng, _| rng.pareto(1.2));
                // The mean is 6.
                let verdict = TEST.run(&a, Reference::Exact(&vec![6.0; comparisons])).unwrap();
                matches!(verdict.outcome, Outcome::HeavyTail { .. })
            })
        };
        assert_between(pareto(8, 400, 4), 200, 0.95, 1.0);
        // On either side of the comparison, even if the other has a share below the limit that is less likely still.
        let heavy = |i| if i == 4 { 900.0 } else { 1.0 + f64::from(i % 2) };
        let wide = |i| if i < 10 { 15.0 } else { f64::from(i % 7) };
        let a = Runs::new((0..30).map(|i| vec![heavy(i), 2.0]).collect()).unwrap();
        let b = Runs::new((0..2990).map(|i| vec![1.0, wide(i % 997)]).collect()).unwrap();
        let (top_a, top_b) = (TopShare::new(a.block(0)), TopShare::new(b.block(1)));
        assert!(top_a.is_heavy(2) && !top_b.is_heavy(2) && top_b.chance < top_a.chance, "{top_a:?} {top_b:?}");
        for (a, b) in [(&a, &b), (&b, &a)] {
            let verdict = TEST.run(a, Reference::Runs(b)).unwrap();
            assert!(matches!(verdict.outcome, Outcome::HeavyTail { block: 0, .. }), "{verdict}");
            assert!(!verdict.passes() && !verdict.rejected());
        }
    }
    #[test]
    fn skewed_runs_err_more_often_when_they_are_few() {
        // Lognormal with sigma 0.5 in 8 blocks: what Student's t makes of skewness 1.75. More runs mend it.
        for (n, at_most) in [(16, 0.13), (64, 0.07), (256, 0.06)] {
            let errs = count(9, 1000, |rng| {
                let a = runs(rng, n, 8, |rng, _| rng.lognormal(0.5));
                TEST.run(&a, Reference::Exact(&[1.0; 8])).unwrap().rejected()
            });
            assert_at_most(errs, 1000, at_most);
        }
    }
    #[test]
    fn exact_results_pass_up_to_rounding_only() {
        let a = Runs::new(vec![vec![2.000_000_1, 0.0]; 4]).unwrap();
        let run = |rounding| BlockTest { rounding, ..TEST }.run(&a, Reference::Exact(&[2.0, 0.0])).unwrap();
        assert!(run(1e-6).passes() && run(0.0).rejected());
        let off = Runs::new(vec![vec![2.01, 0.0]; 4]).unwrap();
        let verdict = BlockTest::default().run(&off, Reference::Exact(&[2.0, 0.0])).unwrap();
        assert!(verdict.rejected() && verdict.worst.block == 0 && verdict.worst.adjusted_p == 0.0, "{verdict}");
        assert!((verdict.worst.relative.unwrap() - 0.005).abs() < 1e-12);
        // Light where there is none is infinitely wrong, and has no relative size.
        let light = BlockTest::default().run(&off, Reference::Exact(&[2.01, -1e-9])).unwrap();
        assert!(light.rejected() && light.worst.block == 1);
    }
    #[test]
    fn the_summary_says_what_was_seen_and_what_would_have_been() {
        let mut rng = Rng::new(10);
        let run = |a: &Runs| BlockTest::default().run(a, Reference::Exact(&EXACT)).unwrap().to_string();
        let passes = run(&estimator(&mut rng, 100, 0.0, unbiased));
        assert!(passes.starts_with("passes; 8 blocks, 100 runs; worst block "), "{passes}");
        assert!(passes.contains("would have seen 0.") && passes.ends_with("(alpha 0.01, power 0.9)"), "{passes}");
        let rejected = run(&estimator(&mut rng, 100, 0.0, |k| if k == 5 { 1.05 } else { 1.0 }));
        assert!(rejected.starts_with("rejected; 8 blocks, 100 runs; worst block 5: +"), "{rejected}");
        let mut rows = estimator(&mut rng, 100, 0.0, unbiased).rows().to_vec();
        rows[7][2] = 1e4;
        let heavy = run(&Runs::new(rows).unwrap());
        assert!(
            heavy.starts_with("no verdict: heavy tail, 1 of 100 runs carry 99 % of the variance of block 2"),
            "{heavy}"
        );
    }
    #[test]
    fn what_does_not_fit_is_refused() {
        let a = Runs::new(vec![vec![1.0, 2.0]; 3]).unwrap();
        let run = |reference| TEST.run(&a, reference).err();
        assert_eq!(run(Reference::Exact(&[1.0])), Some(StatsError::BlockCount { expected: 2, found: 1 }));
        assert_eq!(run(Reference::Exact(&[1.0, f64::NAN])), Some(StatsError::BadReference { block: 1 }));
        let estimate = |std_error, degrees| run(Reference::Estimate { mean: &[1.0, 2.0], std_error, degrees });
        assert_eq!(estimate(&[0.1, -0.1], 9.0), Some(StatsError::BadReference { block: 1 }));
        assert_eq!(estimate(&[0.1, 0.1], 0.0), Some(StatsError::BadReference { block: 0 }));
        assert_eq!(estimate(&[0.1], 9.0), Some(StatsError::BlockCount { expected: 2, found: 1 }));
    }
}
