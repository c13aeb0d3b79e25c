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
fn no_method_breaks_where_numbers_are_hard() {
    let table = tempfile::tempdir().unwrap();
    let path = table.path().join("table.csv");
    let (code, out, err) = verify(&format!("--stability --table {}", path.display()));
    assert_eq!(code, Some(0), "{out}{err}");
    let text = std::fs::read_to_string(&path).unwrap();
    let rows: Vec<Vec<&str>> = text.lines().map(|l| l.split(',').collect()).collect();
    let column = |name: &str| rows[0].iter().position(|c| *c == name).unwrap();
    let (outcome, non_finite, longer) = (column("outcome"), column("non_finite"), column("longer"));
    let looked: Vec<_> = rows[1..].iter().filter(|r| r[outcome] != "skipped").collect();
    // As many as there are, and most with a verdict.
    assert!(looked.len() > 280, "{}", looked.len());
    assert!(looked.iter().filter(|r| r[outcome] == "holds").count() > 180, "{text}");
    assert!(looked.iter().all(|r| r[non_finite] == "0" && r[longer].parse::<f64>().unwrap() < 1e-4), "{text}");
    for method in manylight_recipes::methods().iter().filter(|m| m.name != manylight_recipes::COMPOSED) {
        assert!(rows.iter().any(|r| r[0].split(':').next() == Some(method.name)), "{} was left out", method.name);
    }
}

#[test]
fn what_has_a_length_of_its_own_shows_when_the_metre_changes() {
    // Honest elsewhere, but a bound of 1/m^2 is no number without unit.
    let (code, out, err) = verify("instant-radiosity --stability -P bound=1");
    assert!(code == Some(2) && err.contains("cells of the table fail"), "{out}{err}");
    assert!(out.contains("pixels change by") && out.contains("with the unit of length"), "{out}");
    assert!(!out.contains("with the unit of light") && out.contains("0 samples or paths not finite"), "{out}");
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
        ("path --table out.csv", "--stability"),
        ("path --stability --table out.txt", ".csv or .json"),
        ("--stability --compositions", "--compositions"),
        ("path --stability --sees 0.5", "--sees"),
        ("instant-radiosity --stability -P bound=abc", "bound=abc"),
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
