//! When enough has been rendered.

use std::time::Duration;

/// How much may be rendered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Budget {
    /// So many passes.
    Passes(u64),
    /// So much time, from the start of the method (the scene and its BVH being there) to the end of the last pass.
    Time(Duration),
}

impl Budget {
    /// Whether rendering ends after `passes` passes that took `elapsed`.
    ///
    /// A time is met by whole passes, as nearly as they allow: rendering ends when the next pass, should it take as long as
    /// the mean of those before, would end further from the budget than now. Two passes always finish, since one alone
    /// says nothing of its error.
    pub fn is_spent(self, passes: u64, elapsed: Duration) -> bool {
        match self {
            Budget::Passes(n) => passes >= n,
            Budget::Time(budget) => {
                passes >= 2 && {
                    let next = elapsed + elapsed.div_f64(passes as f64);
                    next.abs_diff(budget) > elapsed.abs_diff(budget)
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEN: Budget = Budget::Time(Duration::from_secs(10));

    /// Passes that all take `each` seconds: how many are rendered?
    fn passes_of(each: f64, budget: Budget) -> u64 {
        (1..).find(|&n| budget.is_spent(n, Duration::from_secs_f64(each * n as f64))).unwrap()
    }
    #[test]
    fn passes_are_counted() {
        assert_eq!(passes_of(1e3, Budget::Passes(7)), 7);
        assert_eq!(passes_of(0.0, Budget::Passes(1)), 1);
    }
    #[test]
    fn a_time_is_met_by_the_nearest_number_of_passes() {
        assert_eq!(passes_of(1.0, TEN), 10);
        assert_eq!(passes_of(2.9, TEN), 3, "8.7 s is nearer than 11.6 s");
        assert_eq!(passes_of(3.9, TEN), 3, "11.7 s is nearer than 7.8 s");
        assert_eq!(passes_of(0.003, TEN), 3333);
    }
    #[test]
    fn the_end_is_never_further_from_the_budget_than_half_a_pass_unless_two_passes_take_longer() {
        for each in (1..1000).map(|i| 0.005 * f64::from(i)) {
            let end = each * passes_of(each, TEN) as f64;
            assert!((end - 10.0).abs() <= 0.5 * each + 1e-6, "{each}: {end}");
        }
    }
    #[test]
    fn the_first_two_passes_always_finish() {
        assert_eq!(passes_of(100.0, TEN), 2);
        assert_eq!(passes_of(1.0, Budget::Time(Duration::ZERO)), 2);
    }
    #[test]
    fn an_endless_time_never_overflows() {
        assert!(!Budget::Time(Duration::MAX).is_spent(5, Duration::from_secs(1)));
    }
}
