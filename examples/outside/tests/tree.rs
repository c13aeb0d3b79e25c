//! It depends on what it needs, and on nothing else.

use std::collections::BTreeSet;
use std::process::Command;

/// The crates of Manylight that a light and a light set come with, the crate's own five and what these stand on. No scene files, no
/// renderer, no other light set.
const EXPECTED: &[&str] = &["bsdf", "framework", "geometry", "math", "media", "sampling", "scene", "vpl"];

#[test]
fn the_dependency_tree_holds_no_more_than_it_needs() {
    let cargo = std::env::var("CARGO").unwrap_or("cargo".into());
    let manifest = concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml");
    let tree = Command::new(cargo)
        .args(["tree", "--edges", "normal", "--prefix", "none", "--offline", "--manifest-path", manifest])
        .output()
        .unwrap();
    assert!(tree.status.success(), "{}", String::from_utf8_lossy(&tree.stderr));
    let text = String::from_utf8(tree.stdout).unwrap();
    let ours = text.lines().filter_map(|l| l.split(' ').next()?.strip_prefix("manylight-"));
    assert_eq!(ours.collect::<BTreeSet<_>>(), EXPECTED.iter().copied().collect(), "{text}");
}
