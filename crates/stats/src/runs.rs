//! Independent runs of an estimator, tiled into blocks.

use crate::{Moments, StatsError};

/// One number for each run and block. All pixels of one run share its lights and are correlated, so *the run is the unit of
/// every statistic*: rows are independent of each other, columns are not.
#[derive(Clone, Debug, PartialEq)]
pub struct Runs {
    rows: Vec<Vec<f64>>,
}

impl Runs {
    /// Row by row: `rows[run][block]`. At least two runs, as many blocks in each, nothing but finite numbers.
    pub fn new(rows: Vec<Vec<f64>>) -> Result<Self, StatsError> {
        if rows.len() < 2 {
            return Err(StatsError::TooFewRuns { needed: 2, found: rows.len() });
        }
        let expected = rows[0].len();
        if expected == 0 {
            return Err(StatsError::NoBlocks);
        }
        for (run, row) in rows.iter().enumerate() {
            check_blocks(expected, row.len())?;
            if let Some(block) = row.iter().position(|x| !x.is_finite()) {
                return Err(StatsError::NotFinite { run, block });
            }
        }
        Ok(Runs { rows })
    }
    /// With the mean of all blocks as one more block at the end: the whole image, if the blocks have equal sizes.
    pub fn with_mean(mut self) -> Self {
        for row in &mut self.rows {
            row.push(row.iter().sum::<f64>() / row.len() as f64);
        }
        self
    }
    /// Number of runs.
    pub fn runs(&self) -> usize {
        self.rows.len()
    }
    /// Number of blocks.
    pub fn blocks(&self) -> usize {
        self.rows[0].len()
    }
    /// Run by run.
    pub fn rows(&self) -> &[Vec<f64>] {
        &self.rows
    }
    /// One block over all runs.
    pub fn block(&self, block: usize) -> impl Iterator<Item = f64> {
        self.rows.iter().map(move |row| row[block])
    }
    /// Moments of one block over all runs.
    pub fn moments(&self, block: usize) -> Moments {
        self.block(block).collect()
    }
}

/// `found` has to be `expected`.
pub(crate) fn check_blocks(expected: usize, found: usize) -> Result<(), StatsError> {
    if found == expected { Ok(()) } else { Err(StatsError::BlockCount { expected, found }) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_table_of_runs_is_refused() {
        assert_eq!(Runs::new(vec![vec![1.0]]), Err(StatsError::TooFewRuns { needed: 2, found: 1 }));
        assert_eq!(Runs::new(vec![vec![]; 2]), Err(StatsError::NoBlocks));
        assert_eq!(Runs::new(vec![vec![1.0, 2.0], vec![1.0]]), Err(StatsError::BlockCount { expected: 2, found: 1 }));
        let nan = Runs::new(vec![vec![1.0, 2.0], vec![1.0, f64::NAN]]);
        assert_eq!(nan, Err(StatsError::NotFinite { run: 1, block: 1 }));
    }
    #[test]
    fn the_mean_is_one_more_block() {
        let runs = Runs::new(vec![vec![1.0, 3.0], vec![5.0, 9.0]]).unwrap().with_mean();
        assert_eq!((runs.runs(), runs.blocks()), (2, 3));
        assert_eq!(runs.block(2).collect::<Vec<_>>(), [2.0, 7.0]);
        assert_eq!(runs.moments(0).mean(), 3.0);
    }
}
