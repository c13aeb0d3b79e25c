//! `manylight gallery` from outside: its page and its files.

mod browser;

use std::fs;
use std::process::{Command, Output};

fn gallery(args: &[&str]) -> (Option<i32>, String, String) {
    let scenes = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes");
    let Output { status, stdout, stderr } = Command::new(env!("CARGO_BIN_EXE_manylight"))
        .args(["gallery", "--scenes", scenes])
        .args(args)
        .output()
        .unwrap();
    (status.code(), String::from_utf8(stdout).unwrap(), String::from_utf8(stderr).unwrap())
}

/// Two figures with images, told apart by their prefix: what each does leaves the other alone.
const USER: &str = r#"<script>
const seen = [], $ = id => document.getElementById(id);
const key = (id, key) => { $(id).focus(); $(id).dispatchEvent(new KeyboardEvent('keydown', { key, bubbles: true })); };
const look = what => seen.push(`${what}: ${$('splotches-mode').value} ${$('compensation-mode').value}`);
look('start');
key('splotches-view', 'd'); look('first');
key('compensation-view', 'd'); look('both');
key('splotches-view', 'd'); look('second');
seen.push('pictures: ' + $('compensation-left').options.length + ' drawings: ' + document.querySelectorAll('svg').length);
document.documentElement.dataset.seen = seen.join(' | ');
</script>"#;

#[test]
fn figures_become_one_page_that_works_from_disk() {
    let here = tempfile::tempdir().unwrap();
    let out = here.path().join("out");
    let only = "splotches,compensation,phase-functions,light-tree,grids";
    let (code, text, err) = gallery(&["--quick", "--size", "24x18", "-o", out.to_str().unwrap(), "--only", only]);
    assert_eq!(code, Some(0), "{text}{err}");
    let page = fs::read_to_string(out.join("gallery.html")).unwrap();
    for name in only.split(',') {
        assert!(page.contains(&format!("<section id=\"{name}\">")), "{name}");
    }
    assert!(page.contains("--method instant-radiosity -P paths=128 -P bound=none --passes 2 --seed 0 --size 24x18"));
    // Truth and errors: the unbounded lights are not it.
    assert!(page.contains("(own noise ") && page.contains("<th>relMSE</th>"));
    for file in ["splotches.png", "compensation.png", "light-tree-1.svg", "phase-functions-2.svg", "grids-7.svg"] {
        assert!(out.join(file).is_file(), "{file}");
    }
    // The table of angles and densities: where phase functions are sharp the table is worth most.
    let Some(html) = browser::attributes(here.path(), &page, USER) else { return };
    assert!(html.contains("data-ready=\"8\"") && !html.contains("data-errors"), "{html}");
    for expected in [
        "start: split split",
        "first: difference split",
        "both: difference difference",
        "second: split difference",
        "pictures: 5 drawings: 13",
    ] {
        assert!(html.contains(expected), "`{expected}` is missing: {html}");
    }
}

#[test]
fn mistakes_are_named() {
    let here = tempfile::tempdir().unwrap();
    let out = here.path().join("out");
    let (code, _, err) = gallery(&["-o", out.to_str().unwrap(), "--only", "splotchs"]);
    assert!(code == Some(1) && err.contains("did you mean `splotches`?") && !out.exists(), "{err}");
    let run = |args: &[&str]| {
        let done = Command::new(env!("CARGO_BIN_EXE_manylight")).arg("gallery").args(args).output().unwrap();
        (done.status.code(), String::from_utf8(done.stderr).unwrap())
    };
    let (code, err) = run(&["-o", out.to_str().unwrap(), "--scenes", "nowhere"]);
    assert!(code == Some(1) && err.contains("--scenes") && !out.exists(), "{err}");
}
