//! Broken files: each mistake at its line and column, in words that say what to do.

use manylight_scene_io::{Diagnostic, Errors, LoadOptions, load, parse};
use std::path::Path;

/// Reads a scene that stands inside `<scene>`, from line 2 on; a camera is added where the text has none.
fn errors_of(body: &str) -> Vec<Diagnostic> {
    let camera = if body.contains("<sensor") { "" } else { "<sensor type=\"perspective\"/>" };
    let shape = if body.contains("<shape") { "" } else { "<shape type=\"sphere\"/>" };
    whole(&format!("<scene version=\"3.0.0\">\n{body}\n{camera}{shape}\n</scene>"), &LoadOptions::default())
}
fn whole(text: &str, options: &LoadOptions) -> Vec<Diagnostic> {
    match parse(text, Path::new("t.xml"), Path::new("/nonexistent"), options) {
        Ok(_) => Vec::new(),
        Err(Errors(list)) => list,
    }
}

/// Body, line, column, words of the message, words of the help.
type Case = (&'static str, u32, u32, &'static str, &'static str);

#[test]
fn each_mistake_has_its_place_and_says_what_to_do() {
    #[rustfmt::skip]
    let cases: &[Case] = &[
        // The tree.
        ("<shap type=\"sphere\"/>", 2, 1, "<shap> is no element", "did you mean <shape>?"),
        ("<shape type=\"sphere\"><frob/></shape>", 2, 22, "<frob> is no element", "properties are"),
        ("<shape/>", 2, 1, "<shape> needs the attribute `type`", ""),
        ("<shape type=\"sphere\" ide=\"a\"/>", 2, 22, "<shape> has no attribute `ide`", "did you mean `id`?"),
        ("<shape type=\"sphere\">word</shape>", 2, 22, "text has no meaning inside <shape>", ""),
        ("<include filename=\"a.xml\"/>", 2, 20, "cannot read `/nonexistent/a.xml`", ""),
        ("<include/>", 2, 1, "<include> needs the attribute `filename`", ""),
        ("<path value=\"meshes\"/>", 2, 14, "there is no folder `/nonexistent/meshes`", ""),
        ("<bsdf type=\"diffuse\" id=\"wood\"/><alias id=\"wod\" as=\"b\"/>", 2, 44, "no object before here has the id `wod`", "did you mean `wood`?"),
        ("<bsdf type=\"diffuse\" id=\"a\"/><alias id=\"a\" as=\"a\"/>", 2, 48, "the id `a` is given twice (first at t.xml:2:1)", ""),
        ("<default name=\"a\"/>", 2, 1, "<default> needs the attribute `value`", ""),
        ("<shape type=\"sphere\"><default name=\"a\" value=\"1\"/></shape>", 2, 22, "<default> cannot stand inside <shape>", ""),
        ("<default name=\"resx\" value=\"8\"/>\n<shape type=\"sphere\"><float name=\"radius\" value=\"$rexs\"/></shape>", 3, 50, "`$rexs` is not defined", "did you mean `$resx`?"),
        ("<shape type=\"sphere\"><float name=\"radius\" value=\"$r\"/></shape>", 2, 50, "`$r` is not defined", "-D r=.."),
        // Plugins and properties.
        ("<shape type=\"spere\"/>", 2, 14, "there is no shape `spere`", "did you mean `sphere`?"),
        ("<shape type=\"sdfgrid\"/>", 2, 14, "the shape `sdfgrid` is not supported yet", "supported are `obj`"),
        ("<shape type=\"cylinder\"><point name=\"p1\" value=\"0\"/></shape>", 2, 14, "`p0` and `p1` of a cylinder", ""),
        ("<shape type=\"instance\"/>", 2, 14, "an `instance` needs a reference to a `shapegroup`", ""),
        ("<shape type=\"shapegroup\"/>", 2, 14, "a `shapegroup` needs shapes inside it", ""),
        ("<shape type=\"shapegroup\"><shape type=\"cube\"><emitter type=\"area\"/></shape></shape>", 2, 26, "inside a `shapegroup` cannot shine", ""),
        ("<shape type=\"shapegroup\"><shape type=\"instance\"/></shape>", 2, 26, "a `shapegroup` cannot hold `instance`", ""),
        ("<emitter type=\"projector\"/>", 2, 16, "the emitter `projector` is not supported yet", "`point`"),
        ("<emitter type=\"spot\"><float name=\"cutoff_angle\" value=\"0\"/></emitter>", 2, 56, "`cutoff_angle` must lie between 0.1 and 180", ""),
        ("<emitter type=\"spot\"><float name=\"beam_width\" value=\"30\"/></emitter>", 2, 54, "`beam_width` must lie between 0 and `cutoff_angle`", ""),
        ("<emitter type=\"spot\"><texture name=\"texture\" type=\"checkerboard\"/></emitter>", 2, 22, "`texture` of a `spot` is not supported", ""),
        ("<sensor type=\"distant\"/>", 2, 15, "the sensor `distant` is not supported yet", "`perspective`"),
        ("<sensor type=\"thinlens\"/>", 2, 15, "`thinlens` needs an `aperture_radius`", ""),
        ("<sensor type=\"thinlens\"><float name=\"aperture_radius\" value=\"-1\"/></sensor>", 2, 62, "`aperture_radius` must be greater than zero", ""),
        ("<sensor type=\"orthographic\"><float name=\"fov\" value=\"40\"/></sensor>", 2, 29, "the sensor `orthographic` has no property `fov`", ""),
        ("<integrator type=\"pth\"/>", 2, 19, "there is no integrator `pth`", "did you mean `path`?"),
        ("<shape type=\"sphere\"><float name=\"radios\" value=\"1\"/></shape>", 2, 22, "the shape `sphere` has no property `radios`", "did you mean `radius`?"),
        ("<shape type=\"sphere\"><boolean name=\"flipNormals\" value=\"true\"/></shape>", 2, 22, "no property `flipNormals`", "did you mean `flip_normals`?"),
        ("<bsdf type=\"diffuse\"><float name=\"zz\" value=\"1\"/></bsdf>", 2, 22, "no property `zz`", "it takes `reflectance`"),
        ("<bsdf type=\"diffuse\"><texture type=\"checkerboard\"/></bsdf>", 2, 22, "takes no <texture> here (or it needs a name)", ""),
        ("<shape type=\"sphere\"><float name=\"radius\" value=\"1\"/>\n<float name=\"radius\" value=\"2\"/></shape>", 3, 1, "`radius` is given twice (first at t.xml:2:22)", ""),
        ("<bsdf type=\"diffuse\" id=\"a\"/>\n<bsdf type=\"diffuse\" id=\"a\"/>", 3, 26, "the id `a` is given twice (first at t.xml:2:1)", ""),
        ("<bsdf type=\"diffuse\" id=\"Wood\"/><shape type=\"sphere\"><ref id=\"wood\"/></shape>", 2, 63, "no object has the id `wood`", "did you mean `Wood`?"),
        ("<bsdf type=\"twosided\" id=\"a\"><ref id=\"a\"/></bsdf>", 2, 39, "references lead in a circle", ""),
        // Values.
        ("<shape type=\"sphere\"><float name=\"radius\" value=\"one\"/></shape>", 2, 50, "`one` is not a number", ""),
        ("<shape type=\"sphere\"><float name=\"radius\" value=\"\"/></shape>", 2, 50, "expected a number, found nothing", ""),
        ("<shape type=\"sphere\"><float name=\"radius\" value=\"inf\"/></shape>", 2, 50, "`inf` is not a finite number", ""),
        ("<shape type=\"sphere\"><float name=\"radius\" value=\"1e60\"/></shape>", 2, 50, "`1e60` is not a finite number", ""),
        ("<shape type=\"sphere\"><float name=\"radius\" value=\"-1\"/></shape>", 2, 50, "`radius` must be greater than zero", ""),
        ("<shape type=\"sphere\"><string name=\"radius\" value=\"1\"/></shape>", 2, 22, "`radius` must be a number (<float>), not <string>", ""),
        ("<shape type=\"sphere\"><boolean name=\"flip_normals\" value=\"1\"/></shape>", 2, 58, "`1` is not a truth value", ""),
        ("<shape type=\"sphere\"><point name=\"center\" x=\"1\"/></shape>", 2, 22, "<point> needs the attribute `y`", ""),
        ("<shape type=\"sphere\"><point name=\"center\" x=\"1\" value=\"1\"/></shape>", 2, 43, "<point> has `value` already", ""),
        ("<shape type=\"sphere\"><point name=\"center\" value=\"1 2\"/></shape>", 2, 50, "expected one number or three, found 2", ""),
        ("<integrator type=\"path\"><integer name=\"max_depth\" value=\"2.5\"/></integrator>", 2, 58, "`2.5` is not a whole number", ""),
        ("<integrator type=\"path\"><integer name=\"max_depth\" value=\"-2\"/></integrator>", 2, 58, "`max_depth` must be between -1", ""),
        // Transforms.
        ("<shape type=\"cube\"><transform name=\"to_world\"><scale x=\"0\"/></transform></shape>", 2, 20, "the transform is singular", ""),
        ("<shape type=\"cube\"><transform name=\"to_world\"><scle x=\"2\"/></transform></shape>", 2, 47, "<scle> cannot stand inside <transform>", "did you mean `scale`?"),
        ("<shape type=\"cube\"><transform name=\"to_world\"><matrix value=\"1 2\"/></transform></shape>", 2, 62, "<matrix> takes 9 or 16 numbers, not 2", ""),
        ("<shape type=\"cube\"><transform name=\"to_world\"><matrix value=\"1 0 0 0 0 1 0 0 0 0 1 0 0 0 1 1\"/></transform></shape>", 2, 62, "the last row of <matrix>", ""),
        ("<shape type=\"cube\"><transform name=\"to_world\"><rotate angle=\"9\"/></transform></shape>", 2, 47, "the axis of <rotate> is zero", ""),
        ("<shape type=\"cube\"><transform name=\"to_world\"><lookat origin=\"0 0 0\" target=\"0 2 0\" up=\"0 1 0\"/></transform></shape>", 2, 47, "`up` of <lookat> is parallel", ""),
        ("<shape type=\"cube\"><transform name=\"to_world\"><lookat origin=\"1 1 1\" target=\"1 1 1\"/></transform></shape>", 2, 47, "are the same point", ""),
        ("<shape type=\"sphere\"><transform name=\"to_world\"><scale x=\"2\"/></transform></shape>", 2, 22, "must scale all axes alike", ""),
        ("<shape type=\"disk\"><transform name=\"to_world\"><scale x=\"2\"/></transform></shape>", 2, 20, "must scale x and y alike", ""),
        // Colours, BSDFs, textures.
        ("<bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"1.2\"/></bsdf>", 2, 53, "`reflectance` must lie between 0 and 1", ""),
        ("<bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"1 1\"/></bsdf>", 2, 53, "a colour is one number or three, not 2", ""),
        ("<bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"#ff8000\"/></bsdf>", 2, 53, "write `1.0000 0.2159 0.0000`", ""),
        ("<bsdf type=\"diffuse\"><spectrum name=\"reflectance\" value=\"700:1, 400:0\"/></bsdf>", 2, 58, "wavelengths must rise: 400 follows 700", ""),
        ("<bsdf type=\"diffuse\"><spectrum name=\"reflectance\" filename=\"red.spd\"/></bsdf>", 2, 61, "cannot read `/nonexistent/red.spd`", ""),
        ("<shape type=\"serialized\"><string name=\"filename\" value=\"no.serialized\"/></shape>", 2, 57, "cannot read `/nonexistent/no.serialized`", ""),
        ("<shape type=\"serialized\"><string name=\"filename\" value=\"a\"/><integer name=\"shape_index\" value=\"-1\"/></shape>", 2, 96, "`shape_index` must be between 0 and", ""),
        ("<shape type=\"merge\"/>", 2, 14, "a `merge` needs shapes inside it", ""),
        ("<bsdf type=\"diffuse\"><boolean name=\"reflectance\" value=\"true\"/></bsdf>", 2, 22, "`reflectance` must be a colour (<rgb>, <float>), not <boolean>", ""),
        ("<bsdf type=\"twosided\"/>", 2, 13, "`twosided` needs a nested <bsdf>", ""),
        ("<bsdf type=\"twosided\"><bsdf type=\"dielectric\"/></bsdf>", 2, 23, "`twosided` cannot hold `dielectric`", ""),
        ("<bsdf type=\"mask\"/>", 2, 13, "`mask` needs one nested <bsdf>", ""),
        ("<bsdf type=\"twosided\"><bsdf type=\"mask\"><bsdf type=\"diffuse\"/></bsdf></bsdf>", 2, 23, "`twosided` cannot hold `mask`", "inside the `mask`"),
        ("<bsdf type=\"mask\"><bsdf type=\"mask\"><bsdf type=\"diffuse\"/></bsdf></bsdf>", 2, 1, "a `mask` inside a `mask`", ""),
        ("<bsdf type=\"mask\"><bsdf type=\"null\"/></bsdf>", 2, 19, "`null` cannot stand inside another BSDF", ""),
        ("<shape type=\"cube\"><bsdf type=\"mask\"><bsdf type=\"diffuse\"/></bsdf><emitter type=\"area\"/></shape>", 2, 14, "whose BSDF is a `mask` cannot shine", ""),
        ("<bsdf type=\"bumpmap\"><bsdf type=\"diffuse\"/></bsdf>", 2, 13, "`bumpmap` needs a nested <texture>", ""),
        ("<bsdf type=\"bumpmap\"><texture type=\"checkerboard\"/><bsdf type=\"diffuse\"/></bsdf>", 2, 37, "`bumpmap` needs a `bitmap`", ""),
        ("<bsdf type=\"blendbsdf\"><float name=\"weight\" value=\"0.5\"/><bsdf type=\"diffuse\"/></bsdf>", 2, 13, "`blendbsdf` needs two nested <bsdf>", ""),
        ("<bsdf type=\"blendbsdf\"><bsdf type=\"diffuse\"/><bsdf type=\"diffuse\"/></bsdf>", 2, 13, "`blendbsdf` needs a `weight`", ""),
        ("<bsdf type=\"roughplastic\"><texture type=\"checkerboard\" name=\"alpha\"/></bsdf>", 2, 27, "`alpha` of the bsdf `roughplastic` cannot be a texture", ""),
        ("<bsdf type=\"roughdielectric\"><float name=\"int_ior\" value=\"1\"/><float name=\"ext_ior\" value=\"1\"/></bsdf>", 2, 13, "`int_ior` and `ext_ior` of the bsdf `roughdielectric` must differ", ""),
        ("<bsdf type=\"dielectric\"><string name=\"int_ior\" value=\"watre\"/></bsdf>", 2, 55, "there is no dielectric `watre`", "did you mean `water`?"),
        ("<bsdf type=\"conductor\"><string name=\"material\" value=\"au\"/></bsdf>", 2, 55, "there is no conductor `au`", "did you mean `Au`?"),
        ("<bsdf type=\"conductor\"><string name=\"material\" value=\"Au\"/><float name=\"k\" value=\"1\"/></bsdf>", 2, 55, "give either `material` or `eta` and `k`", ""),
        ("<bsdf type=\"roughconductor\"><float name=\"alpha_u\" value=\"0.1\"/></bsdf>", 2, 13, "give `alpha`, or both `alpha_u` and `alpha_v`", ""),
        ("<bsdf type=\"roughplastic\"><string name=\"distribution\" value=\"phong\"/></bsdf>", 2, 62, "`distribution` must be `beckmann` or `ggx`, not `phong`", ""),
        ("<bsdf type=\"principled\"><float name=\"eta\" value=\"1.3\"/><float name=\"specular\" value=\"0.5\"/></bsdf>", 2, 86, "give either `eta` or `specular`", ""),
        ("<bsdf type=\"principled\"><float name=\"metallic\" value=\"1.5\"/></bsdf>", 2, 55, "`metallic` must lie between 0 and 1", ""),
        ("<bsdf type=\"principled\"><float name=\"metalic\" value=\"1\"/></bsdf>", 2, 25, "no property `metalic`", "did you mean `metallic`?"),
        ("<bsdf type=\"twosided\"><bsdf type=\"principled\"><float name=\"spec_trans\" value=\"1\"/></bsdf></bsdf>", 2, 23, "`twosided` cannot hold a `principled` with `spec_trans`", ""),
        ("<texture type=\"bitmap\"/>", 2, 16, "the texture `bitmap` needs a `filename`", ""),
        ("<texture type=\"bitmap\"><string name=\"filename\" value=\"no.png\"/></texture>", 2, 55, "cannot read `/nonexistent/no.png`", ""),
        ("<texture type=\"checkerboard\"><transform name=\"to_uv\"><scale y=\"0\"/></transform></texture>", 2, 30, "`to_uv` is singular", ""),
        // Shapes, emitters.
        ("<shape type=\"obj\"/>", 2, 14, "the shape `obj` needs a `filename`", ""),
        ("<shape type=\"ply\"><string name=\"filename\" value=\"no.ply\"/></shape>", 2, 50, "cannot read `/nonexistent/no.ply`", ""),
        ("<shape type=\"sphere\"><bsdf type=\"diffuse\"/><bsdf type=\"diffuse\"/></shape>", 2, 44, "has a <bsdf> already", ""),
        ("<shape type=\"sphere\"><emitter type=\"point\"/></shape>", 2, 37, "a shape can only hold an `area` emitter", ""),
        ("<shape type=\"sphere\"><medium type=\"homogeneous\"/></shape>", 2, 22, "needs the name `interior` or `exterior`", ""),
        ("<shape type=\"sphere\"><bsdf type=\"null\"/><emitter type=\"area\"/></shape>", 2, 14, "whose BSDF is `null` cannot shine here", ""),
        ("<emitter type=\"area\"/>", 2, 16, "an `area` emitter is part of a shape", ""),
        ("<emitter type=\"constant\"/>\n<emitter type=\"constant\"/>", 3, 1, "only one light can surround a scene (the first is at t.xml:2:1)", ""),
        ("<emitter type=\"point\"><rgb name=\"intensity\" value=\"-1 0 0\"/></emitter>", 2, 52, "`intensity` must not be negative", ""),
        ("<emitter type=\"point\"><point name=\"position\" value=\"1\"/><transform name=\"to_world\"/></emitter>", 2, 16, "give either `position` or `to_world`", ""),
        ("<emitter type=\"directional\"><vector name=\"direction\" value=\"0\"/></emitter>", 2, 29, "`direction` must not be zero", ""),
        ("<medium type=\"homogeneous\"><phase type=\"hg\"><float name=\"g\" value=\"1\"/></phase></medium>", 2, 68, "`g` must lie between -1 and 1", ""),
        ("<medium type=\"homogeneous\"><rgb name=\"albedo\" value=\"1 2 0\"/></medium>", 2, 54, "`albedo` must lie between 0 and 1", ""),
        ("<medium type=\"homogeneous\"><float name=\"scale\" value=\"-1\"/></medium>", 2, 55, "`scale` must not be negative", ""),
        ("<medium type=\"homogeneous\"><rgb name=\"emission\" value=\"1 1 1\"/><rgb name=\"sigma_t\" value=\"1 0 1\"/></medium>", 2, 15, "must not be clear in a channel in which it emits", ""),
        ("<medium type=\"homogeneous\"><float name=\"emission_scale\" value=\"2\"/></medium>", 2, 15, "`emission_scale` needs an `emission`", ""),
        ("<medium type=\"homogeneous\"><rgb name=\"emission\" value=\"1\"/><float name=\"emission_scale\" value=\"-2\"/></medium>", 2, 96, "`emission_scale` must not be negative", ""),
        ("<medium type=\"homogeneous\"><rgb name=\"emission\" value=\"1\"/><rgb name=\"temperature\" value=\"1\"/></medium>", 2, 15, "leave one out", ""),
        ("<medium type=\"homogeneous\"><string name=\"ramp\" value=\"0: 1 1 1\"/></medium>", 2, 15, "`ramp` needs a `temperature`", ""),
        ("<medium type=\"homogeneous\"><rgb name=\"temperature\" value=\"1\"/></medium>", 2, 15, "a `temperature` is a <volume>", ""),
        ("<medium type=\"heterogeneous\"><volume name=\"temperature\" type=\"gridvolume\"><string name=\"filename\" value=\"fire.VDB\"/></volume></medium>", 2, 106, "`fire.VDB` is an OpenVDB grid, which is not read", ".vol"),
        ("<medium type=\"homogeneous\"><volume name=\"albedo\" type=\"gridvolume\"/></medium>", 2, 15, "write type=\"heterogeneous\" for a grid", ""),
        ("<medium type=\"heterogeneous\"><volume name=\"sigma_t\" type=\"gridvolume\"/></medium>", 2, 59, "needs a `filename`", ""),
        // The camera.
        ("<sensor type=\"perspective\"><float name=\"fov\" value=\"180\"/></sensor>", 2, 53, "`fov` must lie between 0 and 180", ""),
        ("<sensor type=\"perspective\"><string name=\"focal_length\" value=\"long\"/></sensor>", 2, 63, "`long` is not a focal length", ""),
        ("<sensor type=\"perspective\"><float name=\"fov\" value=\"40\"/><string name=\"fov_axis\" value=\"z\"/></sensor>", 2, 89, "`fov_axis` must be `x`, `y`, `diagonal`, `smaller` or `larger`", ""),
        ("<sensor type=\"perspective\"><transform name=\"to_world\"><scale value=\"2\"/></transform></sensor>", 2, 28, "`to_world` of a camera cannot scale", ""),
        ("<sensor type=\"perspective\"><film type=\"hdrfilm\"><integer name=\"width\" value=\"0\"/></film></sensor>", 2, 78, "`width` must be between 1 and", ""),
        ("<sensor type=\"perspective\"><film type=\"hdrfilm\"><integer name=\"crop_width\" value=\"8\"/></film></sensor>", 2, 49, "`crop_width` is not supported", ""),
        ("<sensor type=\"perspective\"><film type=\"hdrfilm\"><rfilter type=\"bx\"/></film></sensor>", 2, 64, "there is no rfilter `bx`", "did you mean `box`?"),
    ];
    for (body, line, col, message, help) in cases {
        let errors = errors_of(body);
        let shown = Errors(errors.clone());
        let [e] = &errors[..] else { panic!("{body}\nexpected one mistake, found {}:\n{shown}", errors.len()) };
        assert_eq!((e.line, e.col), (*line, *col), "{body}\n{shown}");
        assert!(e.message.contains(message), "{body}\n{shown}");
        assert!(e.help.as_deref().unwrap_or("").contains(help), "{body}\n{shown}");
        assert_eq!(e.source_line.chars().count().min(e.caret), e.caret, "{body}");
    }
}

#[test]
fn files_that_are_no_scene_are_refused_at_once() {
    let cases: &[(&str, u32, u32, &str)] = &[
        ("", 1, 1, "not well-formed XML"),
        ("<scene version=\"3.0.0\">\n  <shape\n</scene>", 3, 1, "not well-formed XML"),
        (
            "<scene version=\"3.0.0\">\n  <shape type=\"a\">\n</scene>",
            3,
            1,
            "not well-formed XML: expected 'shape' tag, not 'scene'",
        ),
        ("<scene version=\"3.0.0\"><a></a>", 1, 31, "not well-formed XML: the root node was opened but never closed"),
        ("<html/>", 1, 1, "the root element is <html>: expected <scene"),
        ("<scene/>", 1, 1, "<scene> needs the attribute `version`"),
        ("<scene version=\"new\"/>", 1, 17, "`new` is not a version"),
        ("<!DOCTYPE a [<!ENTITY b \"c\">]><scene version=\"3.0.0\"/>", 1, 1, "not well-formed XML"),
    ];
    for (text, line, col, message) in cases {
        let errors = whole(text, &LoadOptions::default());
        let shown = Errors(errors.clone());
        let [e] = &errors[..] else { panic!("{text}\n{shown}") };
        assert_eq!((e.line, e.col), (*line, *col), "{text}\n{shown}");
        assert!(e.message.contains(message), "{text}\n{shown}");
    }
}

#[test]
fn all_mistakes_of_a_file_are_reported_in_their_order() {
    let errors = errors_of(
        "<bsdf type=\"difuse\" id=\"a\"/>\n<shape type=\"sphere\">\n<float name=\"radius\" value=\"x\"/>\n<ref id=\"b\"/>\n</shape>\n\
         <shape type=\"cube\"><ref id=\"a\"/><float name=\"size\" value=\"1\"/></shape>\n<emitter type=\"lamp\"/>",
    );
    let lines: Vec<u32> = errors.iter().map(|e| e.line).collect();
    assert_eq!(lines, [2, 4, 5, 7, 8], "{}", Errors(errors));
}

#[test]
fn a_whole_message_is_the_place_the_line_a_caret_and_help() {
    let errors = errors_of("  <bsdf type=\"roughplastic\"><float name=\"alfa\" value=\"0.1\"/></bsdf>");
    let want = "t.xml:2:29: the bsdf `roughplastic` has no property `alfa`
  2 |   <bsdf type=\"roughplastic\"><float name=\"alfa\" value=\"0.1\"/></bsdf>
    |                             ^
  help: did you mean `alpha`?";
    assert_eq!(Errors(errors).to_string(), want);
}

#[test]
fn a_scene_needs_a_camera_and_a_shape() {
    let errors = whole("<scene version=\"3.0.0\"/>", &LoadOptions::default());
    let messages: Vec<&str> = errors.iter().map(|e| e.message.as_str()).collect();
    assert_eq!(
        messages,
        ["the scene has no camera: it needs a <sensor type=\"perspective\">", "the scene has no shapes"]
    );
}

#[test]
fn a_define_that_nothing_asks_for_is_a_mistake_and_names_the_nearest() {
    let text = "<scene version=\"3.0.0\"><default name=\"resx\" value=\"8\"/><sensor type=\"perspective\"/><shape type=\"cube\"/></scene>";
    let defines = |name: &str| LoadOptions { defines: vec![(name.into(), "4".into())], ..LoadOptions::default() };
    assert_eq!(whole(text, &defines("resx")), []);
    let errors = whole(text, &defines("rexs"));
    assert_eq!(
        Errors(errors).to_string(),
        "t.xml: the scene has no parameter `rexs` (given by -D)\n  help: did you mean `resx`?"
    );
}

#[test]
fn a_missing_scene_file_and_a_folder_are_said_to_be_that() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("scene.xml"), b"<scene version=\"3.0.0\">\xff").unwrap();
    let message = |name: &str| load(&folder.path().join(name), &LoadOptions::default()).unwrap_err().to_string();
    assert!(message("scen.xml").contains("did you mean `scene.xml`?"), "{}", message("scen.xml"));
    assert!(message("").contains("it is not a file"));
    assert!(message("scene.xml").contains(":1:24: the file is not UTF-8 text"), "{}", message("scene.xml"));
}

#[test]
fn broken_meshes_and_images_are_errors_where_they_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).unwrap();
    write("range.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n");
    write("cut.ply", b"ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nend_header\nxx");
    write("not.png", b"hello");
    write("cut.png", &[0x89, b'P', b'N', b'G', 13, 10, 26, 10, 0, 0]);
    write("cut.exr", &[0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0]);
    for (plugin, file, want) in [
        ("shape type=\"obj\"", "range.obj", "line 4: a face names number 4 of 3 vertices"),
        ("shape type=\"ply\"", "cut.ply", "Unexpected end of file"),
        ("texture type=\"bitmap\"", "not.png", "not an image of a supported format"),
        ("texture type=\"bitmap\"", "cut.png", "cannot be decoded"),
        ("texture type=\"bitmap\"", "cut.exr", "cannot be decoded"),
    ] {
        let tag = plugin.split(' ').next().unwrap();
        let text = format!(
            "<scene version=\"3.0.0\"><sensor type=\"perspective\"/><shape type=\"cube\"/>\n<{plugin}>\n<string name=\"filename\" value=\"{file}\"/></{tag}></scene>"
        );
        let errors = parse(&text, Path::new("t.xml"), folder.path(), &LoadOptions::default()).unwrap_err();
        assert_eq!((errors.0.len(), errors.0[0].line, errors.0[0].col), (1, 3, 32), "{errors}");
        assert!(errors.0[0].message.contains(want) && errors.0[0].message.contains(file), "{errors}");
    }
}

#[test]
fn triangles_without_area_are_left_out_with_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
    write("half.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 4\n");
    let shape = |file: &str| format!("\n<shape type=\"obj\"><string name=\"filename\" value=\"{file}\"/></shape>");
    let text = format!(
        "<scene version=\"3.0.0\"><sensor type=\"perspective\"/>{}{}</scene>",
        shape("flat.obj"),
        shape("half.obj")
    );
    let loaded = parse(&text, Path::new("t.xml"), folder.path(), &LoadOptions::default()).unwrap();
    let want = [
        "t.xml:2:50: `flat.obj`: none of its 1 triangles has an area: it is left out",
        "t.xml:3:50: `half.obj`: 1 triangles without area are left out",
    ];
    assert_eq!(loaded.warnings, want);
    assert_eq!(loaded.scene.geometry().primitive_count(), 1);
}

#[test]
fn thousands_of_mistakes_are_counted_in_a_moment() {
    let refs = (0..20_000).map(|i| format!("<bsdf type=\"twosided\" id=\"here{i}\"><ref id=\"there{i}\"/></bsdf>\n"));
    let start = std::time::Instant::now();
    let errors = errors_of(&refs.collect::<String>());
    assert_eq!(errors.last().map(|e| e.message.as_str()), Some("and 19900 further mistakes"));
    assert!(start.elapsed().as_secs() < 10, "{:?}", start.elapsed());
}
