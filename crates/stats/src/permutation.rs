//! Permutation tests of the largest |t| over all blocks.

use crate::rng::Rng;
use crate::runs::check_blocks;
use crate::{Runs, StatsError};

/// Enough permutations to test at alpha = 0.01 with 1 % of error of the p value.
pub const PERMUTATIONS: usize = 9999;

/// What a permutation test found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Permutation {
    /// The largest |t| over the blocks.
    pub largest_t: f64,
    /// Where it is.
    pub block: usize,
    /// Permutations drawn.
    pub permutations: usize,
    /// (1 + permutations with a |t| at least as large) / (1 + permutations). Family-wise: no adjustment is needed.
    pub p_value: f64,
}

/// Do the runs have the exact means? Signs of whole runs' deviations are flipped: exact if deviations are as likely as
/// their opposites, whatever their law and however the blocks depend on each other. Skewed runs want `block_test`'s t.
pub fn sign_flip(a: &Runs, exact: &[f64], permutations: usize, seed: u64) -> Result<Permutation, StatsError> {
    check_blocks(a.blocks(), exact.len())?;
    if let Some(block) = exact.iter().position(|x| !x.is_finite()) {
        return Err(StatsError::BadReference { block });
    }
    let n = a.runs() as f64;
    let deviations: Vec<Vec<f64>> =
        a.rows().iter().map(|row| row.iter().zip(exact).map(|(x, m)| x - m).collect()).collect();
    let mut squares = vec![0.0; exact.len()];
    deviations.iter().flat_map(|row| row.iter().enumerate()).for_each(|(k, d)| squares[k] += d * d);
    let mut sums = vec![0.0; exact.len()];
    let mut t_of = |sign: &mut dyn FnMut() -> f64| {
        sums.fill(0.0);
        for row in &deviations {
            let s = sign();
            sums.iter_mut().zip(row).for_each(|(sum, d)| *sum += s * d);
        }
        // Flipping leaves the squares as they are.
        largest(sums.iter().zip(&squares).map(|(sum, square)| {
            let variance = (square - sum * sum / n).max(0.0) / (n - 1.0);
            ratio(sum / n, variance / n)
        }))
    };
    let observed = t_of(&mut || 1.0);
    let mut rng = Rng::new(seed);
    let (mut bits, mut left) = (0, 0);
    let mut coin = || {
        if left == 0 {
            (bits, left) = (rng.next_u64(), 64);
        }
        left -= 1;
        if bits >> left & 1 == 0 { 1.0 } else { -1.0 }
    };
    Ok(summary(observed, permutations, || t_of(&mut coin).1))
}

/// Do the runs of `a` and `b` have the same means? Labels of whole runs are permuted: exact if both follow the same law,
/// asymptotically valid if only their means agree (Welch's t is what is permuted; have as many runs of both).
pub fn label_permutation(a: &Runs, b: &Runs, permutations: usize, seed: u64) -> Result<Permutation, StatsError> {
    check_blocks(a.blocks(), b.blocks())?;
    // Deviations from the first run: sums of squares of large means would cancel.
    let origin = &a.rows()[0];
    let shifted = |row: &Vec<f64>| row.iter().zip(origin).map(|(x, o)| x - o).collect::<Vec<f64>>();
    let rows: Vec<Vec<f64>> = a.rows().iter().chain(b.rows()).map(shifted).collect();
    let blocks = origin.len();
    let all = Sums::of(blocks, rows.iter());
    let (n, m) = (a.runs() as f64, b.runs() as f64);
    let t_of = |order: &[usize]| {
        let first = Sums::of(blocks, order[..a.runs()].iter().map(|&i| &rows[i]));
        largest((0..blocks).map(|k| {
            let (mean_a, error_a) = mean_and_error(first.sum[k], first.square[k], n);
            let (mean_b, error_b) = mean_and_error(all.sum[k] - first.sum[k], all.square[k] - first.square[k], m);
            ratio(mean_a - mean_b, error_a + error_b)
        }))
    };
    let mut order: Vec<usize> = (0..rows.len()).collect();
    let observed = t_of(&order);
    let mut rng = Rng::new(seed);
    Ok(summary(observed, permutations, || {
        for i in 0..a.runs() {
            order.swap(i, i + rng.below(rows.len() - i));
        }
        t_of(&order).1
    }))
}

/// Sums and sums of squares of each block.
struct Sums {
    sum: Vec<f64>,
    square: Vec<f64>,
}

impl Sums {
    fn of<'a>(blocks: usize, rows: impl Iterator<Item = &'a Vec<f64>>) -> Self {
        let mut sums = Sums { sum: vec![0.0; blocks], square: vec![0.0; blocks] };
        for row in rows {
            for ((sum, square), x) in sums.sum.iter_mut().zip(&mut sums.square).zip(row) {
                *sum += x;
                *square += x * x;
            }
        }
        sums
    }
}

/// Mean and squared standard error.
fn mean_and_error(sum: f64, square: f64, n: f64) -> (f64, f64) {
    (sum / n, (square - sum * sum / n).max(0.0) / ((n - 1.0) * n))
}

/// |t|; nothing differs from itself, and anything differs infinitely where there is no variance.
fn ratio(difference: f64, squared_error: f64) -> f64 {
    if difference == 0.0 { 0.0 } else { difference.abs() / squared_error.sqrt() }
}

/// The largest with its index.
fn largest(ts: impl Iterator<Item = f64>) -> (usize, f64) {
    ts.enumerate().fold((0, 0.0), |best, t| if t.1 > best.1 { t } else { best })
}

fn summary(observed: (usize, f64), permutations: usize, mut draw: impl FnMut() -> f64) -> Permutation {
    let (block, largest_t) = observed;
    // The observed arrangement drawn again is summed in another order: it has to count as equal.
    let as_large = (0..permutations).filter(|_| draw() >= largest_t * (1.0 - 1e-9)).count();
    Permutation { largest_t, block, permutations, p_value: (1 + as_large) as f64 / (1 + permutations) as f64 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::{assert_at_most, assert_between, count, runs};
    use crate::{Alternative, MeanTest};

    #[test]
    fn the_statistic_is_the_largest_t() {
        let mut rng = Rng::new(1);
        let a = runs(&mut rng, 7, 5, |rng, k| 10.0 + k as f64 + rng.normal());
        let b = runs(&mut rng, 9, 5, |rng, k| 10.0 + k as f64 + rng.normal());
        let exact = [10.0, 11.0, 12.0, 13.0, 14.0];
        let t_of = |test: &dyn Fn(usize) -> MeanTest| largest((0..5).map(|k| test(k).t.abs()));
        let one = t_of(&|k| MeanTest::one_sample(&a.moments(k), exact[k], Alternative::Different));
        let two = t_of(&|k| MeanTest::welch(&a.moments(k), &b.moments(k), Alternative::Different));
        for (test, t) in [(sign_flip(&a, &exact, 9, 1).unwrap(), one), (label_permutation(&a, &b, 9, 1).unwrap(), two)]
        {
            assert!(test.block == t.0 && (test.largest_t / t.1 - 1.0).abs() < 1e-9, "{test:?} {t:?}");
        }
    }
    #[test]
    fn the_same_seed_gives_the_same_p() {
        let a = runs(&mut Rng::new(2), 10, 4, |rng, _| rng.normal());
        let p = |seed| sign_flip(&a, &[0.0; 4], 999, seed).unwrap().p_value;
        assert_eq!(p(5), p(5));
        assert!((p(5) - p(6)).abs() < 0.1 && p(5) != p(6));
    }
    #[test]
    fn three_runs_have_eight_signs() {
        // All of one sign: 2 of the 8 flips are as extreme.
        let a = Runs::new(vec![vec![1.0], vec![1.1], vec![0.9]]).unwrap();
        let p = sign_flip(&a, &[0.0], PERMUTATIONS, 3).unwrap().p_value;
        assert!((p - 0.25).abs() < 0.02, "{p}");
        // 3 + 3 apart: 2 of the 20 labellings.
        let b = Runs::new(vec![vec![2.0], vec![2.1], vec![1.9]]).unwrap();
        let p = label_permutation(&a, &b, PERMUTATIONS, 3).unwrap().p_value;
        assert!((p - 0.1).abs() < 0.015, "{p}");
    }
    #[test]
    fn both_err_as_often_as_they_say_even_without_a_variance() {
        // Signed Pareto: no variance; blocks share half of what they are.
        let tail = |rng: &mut Rng| rng.pareto(1.5) * if rng.uniform() < 0.5 { 1.0 } else { -1.0 };
        let errs = count(1, 1000, |rng| {
            let shared = Runs::new(
                (0..12)
                    .map(|_| {
                        let s = tail(rng);
                        (0..4).map(|_| s + tail(rng)).collect()
                    })
                    .collect(),
            );
            sign_flip(&shared.unwrap(), &[0.0; 4], 199, rng.next_u64()).unwrap().p_value <= 0.05
        });
        assert_between(errs, 1000, 0.05, 0.05);
        let errs = count(2, 1000, |rng| {
            let a = runs(rng, 10, 4, |rng, _| rng.pareto(1.5));
            let b = runs(rng, 10, 4, |rng, _| rng.pareto(1.5));
            label_permutation(&a, &b, 199, rng.next_u64()).unwrap().p_value <= 0.05
        });
        assert_between(errs, 1000, 0.05, 0.05);
    }
    #[test]
    fn unequal_variances_with_equal_run_counts_do_little_harm() {
        let errs = count(3, 1000, |rng| {
            let a = runs(rng, 20, 4, |rng, _| 1.0 + rng.normal());
            let b = runs(rng, 20, 4, |rng, _| 1.0 + 0.1 * rng.normal());
            label_permutation(&a, &b, 199, rng.next_u64()).unwrap().p_value <= 0.05
        });
        assert_at_most(errs, 1000, 0.06);
    }
    #[test]
    fn a_liar_is_rejected() {
        // 1 % of bias at 2 % of noise: 64 runs see it 4 standard errors off in each of 4 blocks.
        let seen = count(4, 300, |rng| {
            let a = runs(rng, 64, 4, |rng, _| 1.01 * (1.0 + 0.02 * rng.normal()));
            sign_flip(&a, &[1.0; 4], 499, rng.next_u64()).unwrap().p_value <= 0.01
        });
        assert_between(seen, 300, 0.99, 1.0);
        let seen = count(5, 300, |rng| {
            let a = runs(rng, 64, 4, |rng, k| if k == 2 { 1.02 } else { 1.0 } + 0.02 * rng.normal());
            let b = runs(rng, 64, 4, |rng, _| 1.0 + 0.02 * rng.normal());
            let test = label_permutation(&a, &b, 499, rng.next_u64()).unwrap();
            test.p_value <= 0.01 && test.block == 2
        });
        assert_between(seen, 300, 0.97, 1.0);
    }
    #[test]
    fn blocks_without_variance() {
        let a = Runs::new(vec![vec![1.0, 0.1]; 8]).unwrap();
        assert_eq!(label_permutation(&a, &a, 99, 1).unwrap().p_value, 1.0);
        assert_eq!(sign_flip(&a, &[1.0, 0.1], 99, 1).unwrap().p_value, 1.0);
        assert!(sign_flip(&a, &[1.0, 0.2], 999, 1).unwrap().p_value < 0.02);
    }
    #[test]
    fn what_does_not_fit_is_refused() {
        let a = Runs::new(vec![vec![1.0, 2.0]; 3]).unwrap();
        assert_eq!(sign_flip(&a, &[1.0], 9, 1), Err(StatsError::BlockCount { expected: 2, found: 1 }));
        assert_eq!(sign_flip(&a, &[1.0, f64::NAN], 9, 1), Err(StatsError::BadReference { block: 1 }));
    }
}
