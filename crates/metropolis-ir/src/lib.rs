//! Metropolis instant radiosity (after Segovia, Iehl and Peroche 2007): Markov chains put virtual point lights where they bring
//! the camera something, each about equally much.
//!
//! A chain walks over light paths u, as vectors of the random numbers that they are made of, with a density proportional to
//!
//! > c(u) = sum over the lights j of u of   s_j,      s_j = Phi_j / mean Phi + floor
//!
//! where Phi_j is an *estimate* of what light j brings to the camera, drawn with the state and kept with it (pseudo-marginal:
//! Andrieu and Roberts 2009). Each step leaves one light of its path, j with probability s_j / c, of flux b / (N s_j) times what
//! it would have had alone. b = integral of c du is estimated by a bootstrap, from whose very samples the chains start, each with
//! probability proportional to c: so the lights are unbiased from the first step on (Veach and Guibas 1997), and no burn-in is
//! thrown away.
//!
//! ```
//! use manylight_framework::Promise;
//! use manylight_metropolis_ir::{Metropolis, Start};
//! # use manylight_vpl::{Emission, Keller};
//! let walks = Keller { paths: 1024, max_edges: None, certain_edges: 1, emission: Emission::Full };
//! let metropolis = Metropolis::new(walks);
//! assert!(metropolis.claim().is_unbiased());
//! assert!(!Metropolis { start: Start::Uniform, ..metropolis }.claim().is_unbiased());
//! ```

mod chain;
mod metropolis;
mod perturb;

pub use metropolis::{Metropolis, Start};
pub use perturb::perturb;
