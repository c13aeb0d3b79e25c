//! How a command can end other than well.

use std::error::Error;
use std::fmt;
use std::process::ExitCode;

/// How a command can end other than well. The program prints it and exits with its code.
#[derive(Debug)]
pub enum Failure {
    /// What was asked for cannot be done; the text says what and why.
    Mistake(String),
    /// A check that was asked for failed.
    CheckFailed(String),
    /// It was interrupted, and what there was is written.
    Interrupted,
    /// It was interrupted before there was anything to write.
    InterruptedEarly,
}

impl Failure {
    /// A mistake, from anything that can say what it is.
    pub fn mistake(what: impl fmt::Display) -> Self {
        Failure::Mistake(what.to_string())
    }
    /// The exit code of the program.
    pub fn code(&self) -> ExitCode {
        ExitCode::from(match self {
            Failure::Mistake(_) => 1,
            Failure::CheckFailed(_) => 2,
            Failure::Interrupted | Failure::InterruptedEarly => 3,
        })
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Failure::Mistake(what) => write!(f, "error: {what}"),
            Failure::CheckFailed(what) => write!(f, "check failed: {what}"),
            Failure::Interrupted => write!(f, "interrupted: what was rendered is written"),
            Failure::InterruptedEarly => write!(f, "interrupted before the first pixel: nothing is written"),
        }
    }
}

impl<E: Error> From<E> for Failure {
    fn from(error: E) -> Self {
        Failure::mistake(error)
    }
}
