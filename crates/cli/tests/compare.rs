//! `manylight compare` from outside: its files, its numbers, its page.

mod browser;

use manylight_framework::Image;
use manylight_render::files::read_exr;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use tempfile::TempDir;

const SCENE: &str = r#"<scene version="3.0.0">
    <integrator type="path"><integer name="max_depth" value="4"/></integrator>
    <sensor type="perspective">
        <float name="fov" value="45"/>
        <transform name="to_world"><lookat origin="0, 3, 6" target="0, 0, 0" up="0, 1, 0"/></transform>
        <film type="hdrfilm">
            <integer name="width" value="24"/>
            <integer name="height" value="16"/>
            <rfilter type="box"/>
        </film>
    </sensor>
    <shape type="rectangle">
        <transform name="to_world"><rotate x="1" angle="-90"/><scale value="3"/></transform>
        <bsdf type="diffuse"><rgb name="reflectance" value="0.5"/></bsdf>
    </shape>
    <shape type="rectangle">
        <transform name="to_world"><rotate x="1" angle="90"/><scale value="0.5"/><translate y="2"/></transform>
        <emitter type="area"><rgb name="radiance" value="10"/></emitter>
    </shape>
</scene>"#;

fn manylight(directory: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_manylight")).current_dir(directory).args(args).output().unwrap()
}
fn ends_with(code: i32, directory: &Path, args: &str) -> (String, String) {
    let output = manylight(directory, &args.split_whitespace().collect::<Vec<_>>());
    let (out, err) = (String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap());
    assert_eq!(output.status.code(), Some(code), "`{args}` printed\n{out}\n{err}");
    (out, err)
}
/// A directory with a scene, and an image of it with its standard error as reference.
fn workplace() -> TempDir {
    let here = tempfile::tempdir().unwrap();
    fs::write(here.path().join("lamp.xml"), SCENE).unwrap();
    ends_with(0, here.path(), "render lamp.xml --method path -P spp=16 --passes 32 --seed 99 -o reference.exr --quiet");
    here
}
const COMPARE: &str = "compare lamp.xml -m path,instant-radiosity:paths=16,bound=none --passes 8,2,4 --runs 3 --seed 5 -o out \
                       --image other=other.exr@2.5";
fn compared() -> TempDir {
    let here = workplace();
    ends_with(0, here.path(), "render lamp.xml --method path --passes 3 --seed 1 -o other.exr --quiet");
    let (out, _) = ends_with(0, here.path(), COMPARE);
    assert!(out.contains("8 passes") && out.contains("has the least error") && out.contains("index.html"), "{out}");
    here
}

/// Lines of a CSV file by the names in the first; cells may be quoted.
fn rows(text: &str) -> Vec<BTreeMap<String, String>> {
    let cells = |line: &str| -> Vec<String> {
        let (mut out, mut quoted) = (vec![String::new()], false);
        for c in line.chars() {
            match c {
                '"' => quoted = !quoted,
                ',' if !quoted => out.push(String::new()),
                c => out.last_mut().unwrap().push(c),
            }
        }
        out
    };
    let mut lines = text.lines();
    let names = cells(lines.next().unwrap());
    lines.map(|l| names.iter().cloned().zip(cells(l)).collect()).collect()
}
fn channels(image: &Image) -> Vec<f64> {
    image.pixels.iter().flat_map(|p| p.to_array()).map(f64::from).collect()
}

#[test]
fn numbers_are_those_that_the_images_give_by_hand() {
    let here = compared();
    let at = |name: &str| here.path().join("out").join(name);
    let rows = rows(&fs::read_to_string(at("rows.csv")).unwrap());
    assert_eq!(rows.len(), 2 * 3 * 3 + 1);
    let reference = read_exr(&here.path().join("reference.exr")).unwrap();
    let (r, s) = (channels(&reference.image), channels(&reference.standard_error.unwrap()));
    let mean = |values: Vec<f64>| values.iter().sum::<f64>() / values.len() as f64;
    let eps = 0.01 * mean(r.clone()).powi(2);
    let mut with_file = 0;
    for row in rows.iter().filter(|row| !row["file"].is_empty()) {
        let path = if row["method"] == "other" { here.path().join(&row["file"]) } else { at(&row["file"]) };
        let i = channels(&read_exr(&path).unwrap().image);
        let over = |f: &dyn Fn(usize) -> f64| mean((0..r.len()).map(f).collect());
        let relmse = over(&|k| (i[k] - r[k]).powi(2) / (r[k] * r[k] + eps));
        let own = over(&|k| s[k] * s[k] / (r[k] * r[k] + eps));
        let rmse = over(&|k| (i[k] - r[k]).powi(2)).sqrt();
        for (name, by_hand) in [("relmse", relmse), ("relmse_net", relmse - own), ("rmse", rmse)] {
            let written: f64 = row[name].parse().unwrap();
            assert!((written / by_hand - 1.0).abs() < 1e-9, "{name}: {written} and by hand {by_hand}");
        }
        let [net, bias, noise] = ["relmse_net", "bias", "noise"].map(|n| row[n].parse::<f64>().ok());
        assert!(bias.is_none() || (net.unwrap() - bias.unwrap() - noise.unwrap()).abs() < 1e-12);
        with_file += 1;
    }
    assert_eq!(with_file, 7, "the first run's images, and the one from elsewhere");
    let study: serde_json::Value = serde_json::from_str(&fs::read_to_string(at("study.json")).unwrap()).unwrap();
    assert_eq!(study["study"]["rows"].as_array().unwrap().len(), rows.len());
    assert_eq!(study["summary"].as_array().unwrap().len(), 7);
    assert_eq!(study["verdict"].as_array().unwrap().len(), 3);
    assert!(study["columns"]["relmse"].as_str().unwrap().contains("eps"));
    for svg in ["relmse.svg", "percentile.svg"] {
        assert!(fs::read_to_string(at(svg)).unwrap().starts_with("<svg"), "{svg}");
    }
}

#[test]
fn taking_turns_changes_no_image() {
    let here = compared();
    ends_with(
        0,
        here.path(),
        "render lamp.xml --method instant-radiosity -P paths=16 -P bound=none --passes 4 --seed 5 -o alone.exr --quiet",
    );
    let text = fs::read_to_string(here.path().join("out/rows.csv")).unwrap();
    let rows = rows(&text);
    let row =
        rows.iter().find(|r| r["method"].starts_with("instant") && r["passes"] == "4" && r["run"] == "0").unwrap();
    assert_eq!((row["seed"].as_str(), row["budget"].as_str()), ("5", "4 passes"));
    let turns = read_exr(&here.path().join("out").join(&row["file"])).unwrap();
    let alone = read_exr(&here.path().join("alone.exr")).unwrap();
    assert!(turns.image == alone.image && turns.standard_error == alone.standard_error);
}

#[test]
fn mistakes_are_named_and_leave_nothing_behind() {
    let here = workplace();
    fs::write(here.path().join("sub.xml"), SCENE).unwrap();
    let files = || fs::read_dir(here.path()).unwrap().count();
    let before = files();
    let refused = |args: &str, names: &str| {
        let (_, err) = ends_with(1, here.path(), args);
        assert!(err.contains(names), "`{args}` does not name `{names}`: {err}");
        assert_eq!(files(), before, "`{args}` left something behind");
    };
    refused("compare lamp.xml -m path -o out --reference none.exr", "none.exr");
    refused("compare lamp.xml -m pth -o out", "`path`");
    refused("compare lamp.xml -m path:ssp=3 -o out", "`spp`");
    refused("compare lamp.xml -m path,path -o out", "named twice");
    refused("compare lamp.xml -m path -o out --baseline vsl", "none of the methods: path");
    refused("compare lamp.xml -m path -o out --size 8x8", "24x16");
    refused("compare lamp.xml -m path -o out --times 1s --passes 2", "--passes");
    refused("compare lamp.xml -m path -o out --image a.exr", "NAME=FILE.exr@SECONDS");
    refused("compare lamp.xml -m path -o .", "belongs to the scene");
    refused("compare lamp.xml -m path -o out --seed 98 --runs 2", "--seed 100");
    fs::remove_file(here.path().join("reference.exr")).unwrap();
    let (_, err) = ends_with(1, here.path(), "compare lamp.xml -m path -o out");
    assert!(err.contains("--reference") && err.contains("--method path"), "{err}");
}

#[cfg(unix)]
#[test]
fn ctrl_c_writes_the_runs_that_there_are() {
    use std::io::{BufRead, BufReader};
    use std::process::Stdio;
    let here = workplace();
    let mut command = Command::new(env!("CARGO_BIN_EXE_manylight"));
    command
        .current_dir(here.path())
        .args(["compare", "lamp.xml", "-m", "path", "--passes", "2", "--runs", "10000", "-o", "out"]);
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
    assert!(lines.next().unwrap().unwrap().starts_with("run 1 of 10000"));
    Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    lines.for_each(drop);
    assert_eq!(child.wait().unwrap().code(), Some(3));
    let rows = rows(&fs::read_to_string(here.path().join("out/rows.csv")).unwrap());
    assert!(!rows.is_empty() && rows.len() < 10_000);
}

/// What a user does, and what the page then shows: put behind the page's own script.
const USER: &str = r#"<script>
const seen = [], $ = id => document.getElementById(id);
const look = what => seen.push(`${what}: ${$('left').value} ${$('right').value} ${$('mode').value} ${$('ev').value}`);
const key = (key, more = {}) => document.body.dispatchEvent(new KeyboardEvent('keydown', { key, bubbles: true, ...more }));
const colour = (x, y) => { const c = $('view'); return [...c.getContext('2d').getImageData(x * c.width, y * c.height, 1, 1).data].slice(0, 3); };
look('start');
key('3', { code: 'Digit3' }); key('@', { code: 'Digit2', shiftKey: true }); look('digits');
key('d'); look('difference');
key('4', { code: 'Digit1' });
seen.push('reference from itself: ' + colour(0.02, 0.9));
key('d');
const before = colour(0.25, 0.75).join(); key('+'); key('+'); look('exposure');
seen.push('brighter: ' + (before !== colour(0.25, 0.75).join()));
const r = $('view').getBoundingClientRect();
const mouse = (type, x) => $('view').dispatchEvent(new PointerEvent(type, { clientX: r.left + x * r.width, clientY: r.top + 0.53 * r.height, bubbles: true, pointerId: 1 }));
mouse('pointerdown', 0.5); mouse('pointermove', 0.2); mouse('pointerup', 0.2);
seen.push('slider: ' + location.hash.includes('at=0.2'));
seen.push('status: ' + $('status').textContent.startsWith('pixel 4,8 ') + ' ' + $('status').textContent);
$('view').dispatchEvent(new WheelEvent('wheel', { deltaY: -480, clientX: r.left + r.width / 2, clientY: r.top + r.height / 2, cancelable: true }));
seen.push('zoom: ' + location.hash.includes('zoom=4'));
key('0'); look('reset');
const heads = document.querySelectorAll('#table th'), first = () => document.querySelector('#table tbody td').textContent;
const unsorted = first(); heads[6].click(); const ascending = first(); heads[6].click();
seen.push('sorted: ' + (ascending !== first()));
document.documentElement.dataset.seen = seen.join(' | ');
</script>"#;

#[test]
fn the_page_works_from_disk_with_keys_and_mouse() {
    let here = compared();
    let page = fs::read_to_string(here.path().join("out/index.html")).unwrap();
    assert!(
        !page.contains("http://") && !page.contains("https://")
            || page.matches("http").count() == page.matches("http://www.w3.org/").count()
    );
    let Some(html) = browser::attributes(here.path(), &page, USER) else { return };
    assert!(html.contains("data-ready=\"8\"") && !html.contains("data-errors"), "{html}");
    for expected in [
        "start: 0 1 split",
        "digits: 2 1 split",
        "difference: 2 1 difference",
        "reference from itself: 0,0,0",
        "brighter: true",
        "slider: true",
        "status: true",
        "zoom: true",
        "reset: 0 1 split",
        "sorted: true",
    ] {
        assert!(html.contains(expected), "`{expected}` is missing: {html}");
    }
}
