//! What can be wrong with the data of a test.

/// Why a test cannot be made of the data it was given.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum StatsError {
    /// A variance needs two runs at the least.
    #[error("{found} runs: at least {needed} are needed")]
    TooFewRuns {
        /// At least this many.
        needed: usize,
        /// What there were.
        found: usize,
    },
    /// Runs without a single block.
    #[error("the runs hold no block")]
    NoBlocks,
    /// Two things that should have the same number of blocks.
    #[error("{found} blocks where {expected} were expected")]
    BlockCount {
        /// As in the first run.
        expected: usize,
        /// What was there.
        found: usize,
    },
    /// NaN or infinite. Non-finite pixels are to be counted and reported before any statistics.
    #[error("run {run}, block {block} is not finite")]
    NotFinite {
        /// Index of the run.
        run: usize,
        /// Index of the block.
        block: usize,
    },
    /// A reference that is not finite, or whose standard error or degrees of freedom are negative.
    #[error("the reference of block {block} is not usable")]
    BadReference {
        /// Index of the block.
        block: usize,
    },
    /// A line through logarithms needs positive coordinates and positive errors.
    #[error("point {index} of the line is not positive and finite, or has no error")]
    BadPoint {
        /// Index of the point.
        index: usize,
    },
    /// A slope needs two places.
    #[error("a slope needs points at two different x")]
    NoSlope,
}
