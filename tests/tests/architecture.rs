//! The shape of the workspace: which crate may know which, and what sources may not do.
//!
//! Arrows are read from `cargo metadata --no-deps`, which needs neither a network nor a downloaded registry. Only normal
//! and build dependencies are arrows: tests of a crate may use whatever they need.

use cargo_metadata::{DependencyKind, Metadata, MetadataCommand};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Every member with its floor: a crate knows crates of lower floors only, so those of one floor do not know each other.
const FLOORS: &[(u32, &[&str])] = &[
    (1, &["math", "stats"]),
    (2, &["sampling", "geometry"]),
    (3, &["bsdf", "media"]),
    (4, &["scene"]),
    (5, &["framework", "scene-io"]),
    (
        6,
        &[
            "vpl",
            "compensation",
            "lgh",
            "light-list",
            "lamps",
            "light-tree",
            "many-lights",
            "reference",
            "render",
            "volume-lights",
        ],
    ),
    (7, &["metropolis-ir", "photon", "vrl", "vsl"]),
    (RECIPES, &["recipes", "report", "verify"]),
    (9, &["cli"]),
    (10, &["manylight", "embree"]),
    (11, &["integration", "benches"]),
];

/// From this floor on crates put parts together.
const RECIPES: u32 = 8;

/// Arrows that are wrong although they point down: who, whom, why.
const NEVER: &[(&str, &[&str], &str)] = &[
    (
        "light-list",
        &["scene", "geometry", "bsdf"],
        "a light set asks questions: it sees no scene, no shape and no material",
    ),
    (
        "light-tree",
        &["scene", "geometry", "bsdf"],
        "a light set asks questions: it sees no scene, no shape and no material",
    ),
    ("lgh", &["scene", "geometry", "bsdf"], "a light set asks questions: it sees no scene, no shape and no material"),
    ("vpl", &["lgh", "light-list", "light-tree"], "a kernel does not know who asks it"),
    ("vsl", &["light-list", "light-tree"], "a kernel does not know who asks it"),
    ("stats", &["math", "sampling", "scene", "framework"], "the judge knows no renderer"),
];

/// Crates that share no transport code, directly or by way of others, else the yardstick errs with what it measures.
const APART: [&str; 5] = ["reference", "vpl", "many-lights", "lamps", "volume-lights"];

/// Parts that only `recipes` and what is above it may name.
const PARTS: &[&str] = &[
    "compensation",
    "lamps",
    "lgh",
    "light-list",
    "light-tree",
    "many-lights",
    "reference",
    "render",
    "volume-lights",
];

/// What only some crates may do to the world: what, as it looks in a source, who may.
const WORLDLY: &[(&str, &[&str], &[&str])] = &[
    ("uses files", &["std::fs", "fs::", "File::"], &["scene-io", "render", "cli"]),
    ("prints", &["print!(", "println!(", "dbg!(", "stdout(", "stderr("], &["cli"]),
    ("reads a clock", &["Instant::now", "SystemTime::now", ".elapsed("], &["render", "cli"]),
    ("starts threads", &["thread::spawn", "thread::scope", "thread::Builder", "ThreadPoolBuilder"], &["render", "cli"]),
    ("reads the environment", &["std::env", "env::", "std::process", "std::net"], &["cli"]),
];

/// Calls a library in C, by unsafe code, which the lints of the workspace forbid. Benchmarks alone use it.
const FOREIGN: &str = "embree";

/// Longest source file. [lines]
const MOST_LINES: usize = 600;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("`tests` is a folder of the workspace").to_owned()
}

fn metadata() -> Metadata {
    // The command takes the program from the variable `CARGO`, which is set while tests run.
    MetadataCommand::new().current_dir(root()).no_deps().exec().expect("`cargo metadata` describes this workspace")
}

/// A package's name without what all of them share.
fn short(package: &str) -> &str {
    package.strip_prefix("manylight-").unwrap_or(package)
}

fn floors() -> BTreeMap<&'static str, u32> {
    FLOORS.iter().flat_map(|(floor, names)| names.iter().map(move |n| (*n, *floor))).collect()
}

/// Each member, with the members that it depends on.
fn arrows() -> BTreeMap<String, BTreeSet<String>> {
    let metadata = metadata();
    let members: BTreeSet<&str> = metadata.packages.iter().map(|p| p.name.as_str()).collect();
    let of = |p: &cargo_metadata::Package| {
        let arrows = p.dependencies.iter().filter(|d| d.kind != DependencyKind::Development);
        arrows.filter(|d| members.contains(d.name.as_str())).map(|d| short(&d.name).to_owned()).collect()
    };
    metadata.packages.iter().map(|p| (short(&p.name).to_owned(), of(p))).collect()
}

/// All that a crate knows, directly or by way of others.
fn reachable<'a>(from: &'a str, arrows: &'a BTreeMap<String, BTreeSet<String>>) -> BTreeSet<&'a str> {
    let (mut seen, mut next) = (BTreeSet::new(), vec![from]);
    while let Some(name) = next.pop() {
        next.extend(arrows[name].iter().map(String::as_str).filter(|n| seen.insert(*n)));
    }
    seen
}

/// Sources of a member's library or program: path and text.
fn sources(member: &Path) -> Vec<(PathBuf, String)> {
    let (mut files, mut folders) = (Vec::new(), vec![member.join("src")]);
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display())) {
            let path = entry.expect("a folder of the workspace can be listed").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "rs") {
                let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
                files.push((path, text));
            }
        }
    }
    files.sort();
    files
}

/// The crates under `crates/`: name and sources.
fn crates() -> Vec<(String, Vec<(PathBuf, String)>)> {
    let folder =
        |p: &cargo_metadata::Package| p.manifest_path.parent().expect("a manifest lies in a folder").to_owned();
    let metadata = metadata();
    let ours = metadata.packages.iter().filter(|p| folder(p).parent().is_some_and(|f| f.ends_with("crates")));
    ours.map(|p| (short(&p.name).to_owned(), sources(folder(p).as_std_path()))).collect()
}

/// The lines of a source with their numbers, without comments, and without the test module at its end.
fn code(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let lines: Vec<&str> = text.lines().map(str::trim).collect();
    let opens = |l: &str| l.starts_with("mod ") && l.ends_with('{');
    let end = lines.windows(2).position(|l| l[0] == "#[cfg(test)]" && opens(l[1])).unwrap_or(lines.len());
    lines.into_iter().take(end).enumerate().map(|(i, l)| (i + 1, l)).filter(|(_, l)| !l.starts_with("//"))
}

/// Names of the files of a crate that are test modules: `#[cfg(test)]` and then `mod name;`.
fn test_modules(sources: &[(PathBuf, String)]) -> BTreeSet<String> {
    let of = |text: &str| -> Vec<String> {
        let lines: Vec<&str> = text.lines().map(str::trim).collect();
        let declared = lines.windows(2).filter(|l| l[0] == "#[cfg(test)]");
        declared.filter_map(|l| l[1].strip_prefix("mod ")?.strip_suffix(';').map(|name| format!("{name}.rs"))).collect()
    };
    sources.iter().flat_map(|(_, text)| of(text)).collect()
}

/// Fails with all complaints at once.
fn none(complaints: Vec<String>) {
    assert!(complaints.is_empty(), "\n{}\n", complaints.join("\n"));
}

#[test]
fn every_member_has_one_floor() {
    let mut listed: Vec<&str> = FLOORS.iter().flat_map(|f| f.1.iter().copied()).collect();
    listed.sort_unstable();
    let arrows = arrows();
    let members: Vec<&str> = arrows.keys().map(String::as_str).collect();
    assert_eq!(listed, members, "left: the table `FLOORS`; right: the members of the workspace");
}

#[test]
fn arrows_point_to_lower_floors() {
    let floors = floors();
    let mut wrong = Vec::new();
    for (from, known) in &arrows() {
        for to in known.iter().filter(|to| floors[to.as_str()] >= floors[from.as_str()]) {
            let (f, t) = (floors[from.as_str()], floors[to.as_str()]);
            wrong.push(format!("`{from}` (floor {f}) depends on `{to}` (floor {t}): arrows point down only"));
        }
    }
    none(wrong);
}

#[test]
fn no_arrow_is_one_of_the_forbidden_ones() {
    let arrows = arrows();
    let mut wrong = Vec::new();
    for (from, never, why) in NEVER {
        let found = never.iter().filter(|to| arrows[*from].contains(**to));
        wrong.extend(found.map(|to| format!("`{from}` depends on `{to}`: {why}")));
    }
    none(wrong);
}

#[test]
fn the_yardstick_and_what_it_measures_share_no_transport_code() {
    let arrows = arrows();
    let mut wrong = Vec::new();
    for from in APART {
        let known = reachable(from, &arrows);
        wrong.extend(APART.iter().filter(|to| known.contains(*to)).map(|to| format!("`{from}` reaches `{to}`")));
    }
    none(wrong);
}

#[test]
fn only_recipes_and_above_put_parts_together() {
    let floors = floors();
    let mut wrong = Vec::new();
    for (from, known) in arrows().iter().filter(|(from, _)| floors[from.as_str()] < RECIPES) {
        let parts = PARTS.iter().filter(|p| known.contains(**p));
        wrong.extend(parts.map(|p| format!("`{from}` depends on `{p}`: leave it to `recipes` to name both")));
    }
    none(wrong);
}

/// A scan of the text, without test modules (those in files of their own are told by the files' names). It cannot see what a
/// dependency does, what hides behind another name (`use std::fs as f`), or what follows a test module in its file (clippy's
/// `items_after_test_module` does); words in string literals it takes for code.
#[test]
fn only_who_may_touches_files_clocks_threads_and_the_terminal() {
    let mut wrong = Vec::new();
    for (name, mut sources) in crates() {
        let tests = test_modules(&sources);
        sources.retain(|(path, _)| !path.file_name().is_some_and(|f| tests.iter().any(|t| f == t.as_str())));
        for (what, signs, _) in WORLDLY.iter().filter(|(.., may)| !may.contains(&name.as_str())) {
            for (path, text) in &sources {
                let found = code(text).filter(|(_, line)| signs.iter().any(|s| line.contains(s)));
                wrong.extend(found.map(|(n, line)| format!("{}:{n}: `{name}` {what}: {line}", path.display())));
            }
        }
    }
    none(wrong);
}

#[test]
fn the_scan_sees_code_and_neither_comments_nor_test_modules() {
    let text = "//! std::fs\nuse a; // kept\n#[cfg(test)]\nmod common;\nlet b;\n#[cfg(test)]\nmod tests {\nstd::fs\n}";
    let seen: Vec<_> = code(text).collect();
    assert_eq!(test_modules(&[("lib.rs".into(), text.into())]), BTreeSet::from(["common.rs".to_owned()]));
    assert_eq!(seen, [(2, "use a; // kept"), (3, "#[cfg(test)]"), (4, "mod common;"), (5, "let b;")]);
}

#[test]
fn unsafe_code_is_for_benchmarks_alone() {
    let arrows = arrows();
    let wrong = arrows.iter().filter(|(from, known)| *from != "benches" && known.contains(FOREIGN));
    none(wrong.map(|(from, _)| format!("`{from}` depends on `{FOREIGN}`")).collect());
}

#[test]
fn there_is_one_glam_and_one_rand() {
    // Of the whole lock file: tests and benches speak to our crates in the same vectors.
    let lock = std::fs::read_to_string(root().join("Cargo.lock")).expect("the workspace has a lock file");
    for (name, series) in [("glam", "0.34."), ("rand", "0.10.")] {
        let entries = lock.split("[[package]]").filter(|e| e.contains(&format!("\nname = \"{name}\"\n")));
        let versions: Vec<&str> = entries.filter_map(|e| e.split("version = \"").nth(1)?.split('"').next()).collect();
        assert!(
            matches!(versions[..], [v] if v.starts_with(series)),
            "{name}: expected one {series}x, found {versions:?}"
        );
    }
}

#[test]
fn no_source_file_is_longer_than_a_reader_can_hold() {
    let mut long = Vec::new();
    for (path, text) in crates().into_iter().flat_map(|c| c.1) {
        let lines = text.lines().count();
        if lines > MOST_LINES {
            long.push(format!("{}: {lines} lines; at most {MOST_LINES}", path.display()));
        }
    }
    none(long);
}

#[test]
fn every_library_opens_with_an_example_or_an_explanation() {
    let mut silent = Vec::new();
    for (path, text) in crates().into_iter().flat_map(|c| c.1).filter(|(p, _)| p.ends_with("src/lib.rs")) {
        let page: Vec<&str> = text.lines().take_while(|l| l.starts_with("//!")).collect();
        let explains = page.len() >= 5 || page.iter().any(|l| l.starts_with("//! ```"));
        // One that is empty yet has nothing to explain.
        if code(&text).any(|(_, l)| !l.is_empty()) && !explains {
            silent.push(format!("{}: expected a doc example, or an explanation of 5 lines", path.display()));
        }
    }
    none(silent);
}

#[test]
fn every_member_is_named_after_its_folder_and_takes_the_lints_of_the_workspace() {
    let mut wrong = Vec::new();
    for p in metadata().packages {
        let folder = p.manifest_path.parent().and_then(|f| f.file_name()).expect("a manifest lies in a folder");
        let named = short(&p.name) == folder || (short(&p.name) == "integration" && folder == "tests");
        let manifest = std::fs::read_to_string(&p.manifest_path).expect("a manifest can be read");
        if !named {
            wrong.push(format!("`{}` lies in `{folder}`", p.name));
        }
        if short(&p.name) != FOREIGN && !manifest.contains("[lints]\nworkspace = true") {
            wrong.push(format!("`{}` does not take the lints of the workspace: unsafe code, missing docs", p.name));
        }
    }
    none(wrong);
}
