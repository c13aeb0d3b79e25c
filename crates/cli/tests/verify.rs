//! `manylight verify` from outside.

use std::process::{Command, Output};

fn verify(args: &str) -> (Option<i32>, String, String) {
    let Output { status, stdout, stderr } =
        Command::new(env!("CARGO_BIN_EXE_manylight")).arg("verify").args(args.split_whitespace()).output().unwrap();
    (status.code(), String::from_utf8(stdout).unwrap(), String::from_utf8(stderr).unwrap())
}

#[test]
fn all_registered_methods_keep_their_claims() {
    let (code, out, err) = verify("");
    assert_eq!(code, Some(0), "{out}{err}");
    for method in manylight_recipes::methods() {
        assert!(
            out.lines().any(|l| l.starts_with(&format!("{}: ", method.name))),
            "{} was left out\n{out}",
            method.name
        );
    }
    // Of those alone nothing can be said which promise nothing.
    assert!(out.lines().filter(|l| l.starts_with("no verdict on")).all(|l| l.contains("either sign")), "{out}");
}

#[test]
fn compositions_in_which_every_pair_of_parts_stands_keep_their_claims() {
    let (code, out, err) = verify("--compositions");
    assert_eq!(code, Some(0), "{out}{err}");
    // What promises nothing (screen space, a bias of either sign that nothing takes away) cannot be held against anything.
    let all = out.lines().filter(|l| l.starts_with("many-lights:")).count();
    let silent = out.lines().filter(|l| l.starts_with("no verdict on")).count();
    assert!(all >= 25 && silent * 3 < all, "{silent} of {all}");
    assert!(out.lines().filter(|l| l.starts_with("no verdict on")).all(|l| l.contains("either sign")), "{out}");
}

#[test]
fn mistakes_are_named() {
    for (args, names) in [
        ("instant-radiositi", "`instant-radiosity`"),
        ("path -P ssp=3", "`spp`"),
        ("--all path", "--all"),
        ("path --compositions", "--compositions"),
        ("path --scene nothing.xml", "nothing.xml"),
        ("path --size 8x8", "--scene"),
    ] {
        let (code, out, err) = verify(args);
        assert!(code == Some(1) && out.is_empty() && err.contains(names), "`{args}`: {code:?} {out} {err}");
    }
}

#[test]
fn a_scene_of_ones_own_will_do() {
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/cornell-box/scene.xml");
    let (code, out, err) = verify(&format!("path-lights --scene {scene} --size 8x8"));
    assert!(code == Some(0) && out.contains("holds      scene") && out.contains("would have seen"), "{out}{err}");
}
