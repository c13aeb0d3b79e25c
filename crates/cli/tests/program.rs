//! The program from outside: what it prints, what it writes, how it ends.

use manylight_render::files::{Attribute, read_exr};
use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use tempfile::TempDir;

/// A lamp over a floor, seen from the side.
const SCENE: &str = r#"<scene version="3.0.0">
    <default name="albedo" value="0.5"/>
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
        <bsdf type="diffuse"><rgb name="reflectance" value="$albedo"/></bsdf>
    </shape>
    <shape type="rectangle">
        <transform name="to_world"><rotate x="1" angle="90"/><scale value="0.5"/><translate y="2"/></transform>
        <emitter type="area"><rgb name="radiance" value="10"/></emitter>
    </shape>
</scene>"#;

/// A directory with the scene in it, and nothing else.
fn workplace() -> TempDir {
    let directory = tempfile::tempdir().unwrap();
    fs::write(directory.path().join("lamp.xml"), SCENE).unwrap();
    directory
}
fn command(directory: &Path, args: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_manylight"));
    command.current_dir(directory).args(args.split_whitespace());
    command
}
fn manylight(directory: &TempDir, args: &str) -> Output {
    command(directory.path(), args).output().unwrap()
}
/// Runs it and demands an exit code; returns what it printed to stdout and stderr.
fn ends_with(code: i32, directory: &TempDir, args: &str) -> (String, String) {
    let output = manylight(directory, args);
    let (out, err) = (String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap());
    assert_eq!(output.status.code(), Some(code), "`{args}` printed\n{out}\n{err}");
    (out, err)
}
/// The mistake is one sentence that names the thing.
fn is_refused(directory: &TempDir, args: &str, names: &str) {
    let before = files(directory);
    let (out, err) = ends_with(1, directory, args);
    assert!(err.contains(names), "`{args}` does not name `{names}`: {err}");
    assert!(out.is_empty() && !err.contains("panicked"), "{out}{err}");
    assert_eq!(files(directory), before, "`{args}` left something behind");
}
fn files(directory: &TempDir) -> Vec<String> {
    let names = fs::read_dir(directory).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<_> = names.collect();
    names.sort();
    names
}
fn json(text: &str) -> serde_json::Value {
    serde_json::from_str(text).unwrap()
}

#[test]
fn a_rendering_writes_the_image_a_png_and_statistics() {
    let here = workplace();
    let (out, _) = ends_with(0, &here, "render lamp.xml -o a.exr --passes 3 --seed 7 --stats a.json -P paths=16");
    assert_eq!(files(&here), ["a.exr", "a.json", "a.png", "lamp.xml"]);
    assert!(out.contains("instant-radiosity") && out.contains("3 passes") && out.contains("a.png"), "{out}");

    let picture = read_exr(&here.path().join("a.exr")).unwrap();
    assert_eq!((picture.image.width, picture.image.height), (24, 16));
    assert!(picture.image.pixels.iter().all(|p| p.is_finite()) && picture.image.pixels.iter().any(|p| !p.is_black()));
    assert!(picture.standard_error.unwrap().pixels.iter().any(|p| !p.is_black()));
    assert_eq!(picture.attributes["seed"], Attribute::Text("7".into()));
    assert_eq!(picture.attributes["passes"], Attribute::Number(3.0));
    let Attribute::Text(parameters) = &picture.attributes["parameters"] else { panic!("parameters are text") };
    assert!(parameters.contains("paths=16"), "{parameters}");

    let stats = json(&fs::read_to_string(here.path().join("a.json")).unwrap());
    assert_eq!(stats["method"], "instant-radiosity");
    assert_eq!(stats["passes"], 3);
    assert_eq!(stats["parameters"]["paths"], "16");
    assert!(stats["rays"]["camera"].as_u64().unwrap() >= 3 * 24 * 16);
    assert!(stats["rays"]["shadow"].as_u64().unwrap() > 0);
    assert!(stats["estimated_error"].as_f64().unwrap() > 0.0);
    assert_eq!(stats["non_finite"]["count"], 0);
}
#[test]
fn without_a_name_the_image_is_called_after_the_scene_and_quiet_prints_nothing() {
    let here = workplace();
    let (out, err) = ends_with(0, &here, "render lamp.xml --passes 1 -P paths=4 --quiet");
    assert_eq!((out.as_str(), err.as_str()), ("", ""));
    assert_eq!(files(&here), ["lamp.exr", "lamp.png", "lamp.xml"]);
    let picture = read_exr(&here.path().join("lamp.exr")).unwrap();
    assert_eq!(picture.standard_error, None, "one pass says nothing of its error");
}
#[test]
fn the_image_depends_on_the_seed_and_not_on_the_threads() {
    let here = workplace();
    let pixels = |name: &str, options: &str| {
        ends_with(0, &here, &format!("render lamp.xml -o {name}.exr --passes 2 -P paths=8 {options}"));
        read_exr(&here.path().join(name).with_extension("exr")).unwrap().image
    };
    let one = pixels("one", "--threads 1");
    assert!(one == pixels("two", "--threads 2"));
    assert!(one == pixels("seven", "--threads 7"));
    assert!(one != pixels("other", "--seed 1"));
}
#[test]
fn the_scene_can_be_changed_from_the_command_line() {
    let here = workplace();
    let image = |options: &str| {
        ends_with(0, &here, &format!("render lamp.xml -o a.exr --passes 2 -P paths=8 {options}"));
        read_exr(&here.path().join("a.exr")).unwrap().image
    };
    assert!(image("") != image("-D albedo=0.9"));
    let small = image("--size 6x5 --filter tent");
    assert_eq!((small.width, small.height), (6, 5));
}
#[test]
fn exposure_is_in_the_png_alone() {
    let here = workplace();
    let render = |name: &str, ev: &str| {
        let (out, _) =
            ends_with(0, &here, &format!("render lamp.xml -o {name}.exr --passes 1 -P paths=8 --exposure {ev}"));
        let read = |extension| fs::read(here.path().join(name).with_extension(extension)).unwrap();
        (out, read("png"), read_exr(&here.path().join(name).with_extension("exr")).unwrap().image)
    };
    let (out, bright, a) = render("bright", "2");
    let (_, dark, b) = render("dark", "-2");
    assert!(out.contains("+2.0 EV"), "{out}");
    assert!(bright != dark && a == b);
}
#[test]
fn a_time_is_kept_to_but_two_passes_always_finish() {
    let here = workplace();
    // Passes that take longer than a millisecond on any machine.
    let (out, _) = ends_with(0, &here, "render lamp.xml --time 1ms -P paths=2048");
    assert!(out.contains("2 passes"), "{out}");
    let begin = std::time::Instant::now();
    ends_with(0, &here, "render lamp.xml --time 1s -P paths=4");
    let seconds = begin.elapsed().as_secs_f64();
    // How much longer depends on what else the machine does.
    assert!(seconds > 0.9, "{seconds}");
}

#[test]
fn mistakes_are_named_with_what_was_probably_meant() {
    let here = workplace();
    is_refused(&here, "render lamp.xml --method instant-radiosty", "instant-radiosity");
    is_refused(&here, "render lamp.xml -P pahts=16", "paths");
    is_refused(&here, "render lamp.xml -P paths=many", "many");
    is_refused(&here, "render lamp.xml --filter bxo", "bxo");
    is_refused(&here, "render nothing.xml", "nothing.xml");
    is_refused(&here, "render lamp.xml --passes 0", "--passes");
    is_refused(&here, "render lamp.xml --time 30", "30s");
    is_refused(&here, "render lamp.xml -o a.png", ".exr");
    is_refused(&here, "list instant-radiosty", "instant-radiosity");
    is_refused(&here, "diff a.exr b.exr", "a.exr");
    is_refused(&here, "rendr lamp.xml", "render");
    fs::write(here.path().join("broken.xml"), SCENE.replace("rectangle", "rectangel")).unwrap();
    is_refused(&here, "render broken.xml", "broken.xml");
}
#[test]
fn what_cannot_be_written_is_found_out_before_rendering() {
    let here = workplace();
    // An hour: were it to render first, this test would not end.
    is_refused(&here, "render lamp.xml --time 1h -o nowhere/a.exr", "nowhere");
    is_refused(&here, "render lamp.xml --time 1h -o a.exr --stats nowhere/a.json", "nowhere");
    fs::create_dir(here.path().join("b.png")).unwrap();
    is_refused(&here, "render lamp.xml --time 1h -o b.exr", "b.png");
}
#[cfg(unix)]
#[test]
fn ctrl_c_writes_what_there_is_and_says_so() {
    use std::io::{BufRead, BufReader};
    use std::process::Stdio;
    let here = workplace();
    let mut render = command(here.path(), "render lamp.xml --time 1h -P paths=4");
    let mut child = render.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
    let first = lines.next().unwrap().unwrap();
    assert!(first.starts_with("pass 1"), "{first}");
    Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    let rest: Vec<String> = lines.map(Result::unwrap).collect();
    assert_eq!(child.wait().unwrap().code(), Some(3), "{rest:?}");
    assert!(rest.iter().any(|line| line.contains("interrupted")), "{rest:?}");
    assert_eq!(files(&here), ["lamp.exr", "lamp.png", "lamp.xml"]);
    assert!(read_exr(&here.path().join("lamp.exr")).unwrap().image.pixels.iter().any(|p| !p.is_black()));
}

#[test]
fn diff_tells_equal_from_different_and_can_fail() {
    let here = workplace();
    ends_with(0, &here, "render lamp.xml -o a.exr --passes 2 -P paths=8");
    ends_with(0, &here, "render lamp.xml -o b.exr --passes 2 -P paths=8 --seed 1");
    ends_with(0, &here, "render lamp.xml -o small.exr --passes 1 --size 3x3");
    ends_with(0, &here, "diff a.exr a.exr --fail-above 0");
    ends_with(0, &here, "diff a.exr b.exr");
    ends_with(0, &here, "diff a.exr b.exr --fail-above 1000");
    let (out, err) = ends_with(2, &here, "diff a.exr b.exr --fail-above 1e-9 --json");
    assert!(json(&out).is_object());
    assert!(err.contains("a.exr") && err.contains("1e-9"), "{err}");
    is_refused(&here, "diff a.exr small.exr", "24");
}
#[test]
fn list_shows_the_methods_and_what_each_promises() {
    let here = workplace();
    let (out, _) = ends_with(0, &here, "list");
    assert!(out.contains("instant-radiosity") && out.contains("path"), "{out}");
    let (out, _) = ends_with(0, &here, "list instant-radiosity");
    assert!(out.contains("Keller") && out.contains("paths") && out.contains("bound"), "{out}");
}
#[test]
fn info_counts_what_a_scene_holds_and_says_what_methods_miss() {
    let here = workplace();
    let (out, _) = ends_with(0, &here, "info lamp.xml");
    for line in [
        "24 x 16 pixels",
        "2 meshes of 4 triangles",
        "area: 1 (2 triangles)",
        "diffuse: 2",
        "nothing that light goes through",
    ] {
        assert!(out.contains(line), "no `{line}` in\n{out}");
    }
    let glass = SCENE.replace("</scene>", "<shape type=\"sphere\"><bsdf type=\"dielectric\"/></shape></scene>");
    fs::write(here.path().join("glass.xml"), glass).unwrap();
    let (out, _) = ends_with(0, &here, "info glass.xml --method power-sampling -P paths=7");
    for line in [
        "1 sphere",
        "dielectric: 1",
        "mirrors or glass",
        "power-sampling",
        "leaves out the light that reaches a surface",
    ] {
        assert!(out.contains(line), "no `{line}` in\n{out}");
    }
    assert!(!out.contains("light-tracing"), "{out}");
    is_refused(&here, "info glass.xml --method power", "power-sampling");
    is_refused(&here, "info none.xml", "none.xml");
}

#[test]
fn a_parametric_scene_is_written_and_can_be_rendered() {
    let here = workplace();
    let (out, _) = ends_with(0, &here, "scene");
    assert!(out.contains("many-lamps"), "{out}");
    assert_eq!(ends_with(0, &here, "scene --help").0, out);
    let (out, _) = ends_with(0, &here, "scene many-lamps --help");
    assert!(out.contains("Parameters") && out.contains("lamps"), "{out}");
    let (out, _) = ends_with(0, &here, "scene many-lamps --lamps 10 -o lamps");
    assert!(out.contains("lamps"), "{out}");
    ends_with(0, &here, "render lamps/scene.xml --passes 1 --size 8x8 -P paths=4");
    assert!(files(&here).contains(&"lamps.exr".into()));
    is_refused(&here, "scene many-lmaps -o x", "many-lamps");
    is_refused(&here, "scene many-lamps --lmaps 3 -o x", "lamps");
    is_refused(&here, "scene many-lamps --lamps few -o x", "few");
    is_refused(&here, "scene many-lamps --lamps 3", "-o");
    is_refused(&here, "scene many-lamps lamps 3 -o x", "--key value");
}
#[test]
fn help_shows_only_what_there_is() {
    let here = workplace();
    let (out, _) = ends_with(0, &here, "--help");
    let commands = out.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
    let names: Vec<_> = commands.filter_map(|line| line.split_whitespace().next()).collect();
    assert_eq!(
        names,
        ["render", "lights", "diff", "compare", "verify", "gallery", "explain", "info", "list", "scene", "help"]
    );
    ends_with(0, &here, "--version");
    ends_with(1, &here, "");
}

#[test]
fn an_output_never_overwrites_what_the_scene_is_made_of_nor_another_output() {
    let directory = workplace();
    is_refused(&directory, "render lamp.xml -o a.exr --stats lamp.xml --passes 1", "belongs to the scene");
    is_refused(&directory, "render lamp.xml -o a.exr --stats a.png --passes 1", "named for two outputs");
    assert_eq!(fs::read_to_string(directory.path().join("lamp.xml")).unwrap(), SCENE);
}

#[test]
fn a_pixel_is_explained_by_its_lights_its_bound_and_its_compensation() {
    let directory = workplace();
    let told = |args: &str| {
        let out = manylight(&directory, &format!("explain lamp.xml --pixel 12,12 --seed 3 {args}"));
        assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
        String::from_utf8(out.stdout).unwrap()
    };
    let number = |text: &str, line: &str| -> f64 {
        let line = text.lines().find(|l| l.trim_start().starts_with(line)).unwrap_or_else(|| panic!("{line}: {text}"));
        line.split_whitespace().rev().nth(2).unwrap().parse().unwrap()
    };
    let text = told("-P direct=virtual -P paths=16 -P bound=0.1");
    let (pixel, lights) = (number(&text, "the pixel"), number(&text, "virtual lights"));
    assert!(told("-P lights=power").contains("before the light set weighs it"));
    assert!(pixel > 0.0 && (pixel - lights).abs() < 1e-3 * pixel, "all light is the lights': {text}");
    assert!(number(&text, "taken by the bound") > 0.0 && number(&text, "compensation") == 0.0, "{text}");
    let unbound = told("-P direct=virtual -P paths=16 -P bound=none");
    let all = lights + number(&text, "taken by the bound");
    assert!((number(&unbound, "virtual lights") / all - 1.0).abs() < 1e-3, "{text}\n{unbound}");
    for c in ["kollig-keller", "local"] {
        let text = told(&format!("-P direct=virtual -P paths=16 -P bound=0.1 -P compensation={c}"));
        assert!((number(&text, "virtual lights") / lights - 1.0).abs() < 1e-3, "{c}: {text}");
        // Nothing but the lamp lights the floor: what a frame brings back is told whole, however many samples there are.
        let text = told(&format!("-P direct=virtual -P paths=16 -P bound=0.1 -P spp=4 -P compensation={c}"));
        let parts = ["virtual lights", "compensation", "the rest"].map(|line| number(&text, line));
        assert!((parts.iter().sum::<f64>() / number(&text, "the pixel") - 1.0).abs() < 1e-3, "{c}: {text}");
    }
    let out = manylight(&directory, "explain lamp.xml --pixel 24,0");
    assert_eq!(out.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&out.stderr).contains("24 x 16 pixels"));
}

#[test]
fn lights_writes_where_they_are() {
    let here = workplace();
    for method in ["instant-radiosity", "rejection", "bidirectional-ir", "metropolis-ir"] {
        let args = format!("lights lamp.xml --method {method} -P paths=64 -o {method}.ply");
        let (out, _) = ends_with(0, &here, &args);
        assert!(out.contains(&format!("wrote {method}.ply")), "{out}");
        let bytes = fs::read(here.path().join(format!("{method}.ply"))).unwrap();
        let header = String::from_utf8_lossy(&bytes[..bytes.windows(11).position(|w| w == b"end_header\n").unwrap()]);
        let lights: usize = header.split("element vertex ").nth(1).unwrap().lines().next().unwrap().parse().unwrap();
        // Six floats, the edges, and three bytes of colour.
        assert!(lights > 0 && bytes.len() == header.len() + 11 + lights * 31, "{method}: {lights} lights");
    }
    // As text, the same twice; the lights of a lamp over a floor lie on the floor.
    let text = |name: &str| {
        ends_with(0, &here, &format!("lights lamp.xml --ascii -P paths=50 --seed 3 -o {name}"));
        fs::read_to_string(here.path().join(name)).unwrap()
    };
    let (a, b) = (text("a.ply"), text("b.ply"));
    assert_eq!(a, b);
    for line in a.split("end_header\n").nth(1).unwrap().lines() {
        let numbers: Vec<f32> = line.split(' ').map(|n| n.parse().unwrap()).collect();
        assert!(numbers.len() == 10 && numbers[1].abs() < 1e-3 && numbers[6] == 1.0, "{line}");
    }
    is_refused(&here, "lights lamp.xml --method path -o c.ply", "instant-radiosity");
    is_refused(&here, "lights lamp.xml -o c.obj", ".ply");
    is_refused(&here, "lights lamp.xml -P pathes=3 -o c.ply", "paths");
}

#[test]
fn frames_are_the_renders_of_their_numbers_and_an_animation() {
    let here = workplace();
    let common = "--passes 2 -P paths=16 --exposure 0";
    let (out, _) = ends_with(
        0,
        &here,
        &format!("render lamp.xml -o a.exr --frames 8..10 --seed 5 -D albedo=0.$frame --stats s-$frame.json {common}"),
    );
    let names = ["08", "09", "10"].map(|n| [format!("a-{n}.exr"), format!("a-{n}.png")]).concat();
    let stats = ["08", "09", "10"].map(|n| format!("s-{n}.json"));
    let mut all: Vec<String> =
        names.into_iter().chain(stats).chain(["a-animation.png".into(), "lamp.xml".into()]).collect();
    all.sort();
    assert_eq!(files(&here), all);
    assert!(out.contains("pixels change by") && out.contains("flicker by"), "{out}");

    ends_with(0, &here, &format!("render lamp.xml -o b.exr --seed 14 -D albedo=0.9 {common}"));
    let pixels = |name: &str| read_exr(&here.path().join(name)).unwrap().image;
    assert_eq!(pixels("a-09.exr"), pixels("b.exr"));
    assert_ne!(pixels("a-08.exr"), pixels("b.exr"));
}
#[test]
fn frames_fill_the_scenes_parameter_and_say_if_there_is_none() {
    let here = workplace();
    let turning =
        SCENE.replace(r#"name="albedo" value="0.5""#, r#"name="frame" value="0""#).replace("$albedo", "0.$frame");
    fs::write(here.path().join("turning.xml"), turning).unwrap();
    ends_with(0, &here, "render turning.xml -o f.exr --frames 01..02 --passes 1 -P paths=4 -q");
    assert!(files(&here).contains(&"f-02.exr".to_string()), "{:?}", files(&here));
    is_refused(&here, "render lamp.xml --frames 1..2 --passes 1", "`frame`");
    for range in ["2..1", "1", "a..b", "-1..2", "1..99999999999"] {
        is_refused(&here, &format!("render turning.xml --frames={range}"), "such as 1..48");
    }
}
