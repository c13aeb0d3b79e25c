//! The program `manylight`.
fn main() {}
