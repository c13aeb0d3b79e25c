//! What can go wrong before anything is held against anything.

/// Why nothing could be verified.
#[derive(Debug, thiserror::Error)]
pub enum VerifyError {
    /// One of the crate's own scenes is broken.
    #[error("a scene of the verifier cannot be read: {0}")]
    Scene(String),
    /// The yardstick failed.
    #[error("the yardstick failed in `{place}`: {reason}")]
    Yardstick {
        /// Where.
        place: String,
        /// What it said.
        reason: String,
    },
}
