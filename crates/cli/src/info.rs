//! `manylight info`.

use crate::args::Info;
use crate::failure::Failure;
use crate::loading::load;
use crate::output::{say, table};
use crate::units;
use manylight_framework::{Claim, PathClasses};
use manylight_recipes::{build, default_method, method, methods};
use manylight_scene::{Inventory, Scene};
use manylight_scene_io::{LoadOptions, Loaded};
use std::collections::BTreeMap;
use std::time::Instant;

/// Says what a scene holds, what it takes to render it, and what methods leave out of it.
pub fn run(args: &Info) -> Result<(), Failure> {
    if let Some(name) = &args.method {
        method(name)?;
    }
    let options = LoadOptions { defines: args.defines.clone(), ..LoadOptions::default() };
    let start = Instant::now();
    let Loaded { scene, warnings, files } = load(&args.scene, &options, false)?;
    let seconds = start.elapsed();
    for warning in &warnings {
        eprintln!("warning: {warning}");
    }
    say(format!("{}: {} files, loaded in {}\n", args.scene.display(), files.len(), units::time(seconds)));
    say(contents(&scene).trim_end());
    say(format!("\nWhat it takes:\n{}", demands(&scene).trim_end()));
    say(match &args.method {
        Some(name) => format!("\nThe method:\n{}", one_method(name, &args.parameters, &scene)?.trim_end()),
        None => format!("\nMethods, with their default parameters:\n{}", all_methods(&scene).trim_end()),
    });
    Ok(())
}

/// "a: 1, b: 2", or "none".
fn list(counts: &BTreeMap<&'static str, usize>) -> String {
    let each: Vec<String> = counts.iter().map(|(kind, n)| format!("{kind}: {n}")).collect();
    if each.is_empty() { "none".into() } else { each.join(", ") }
}

fn contents(scene: &Scene) -> String {
    let i = scene.inventory();
    let (width, height) = scene.camera().size;
    let extent = scene.bounds();
    let size = if extent.is_empty() { manylight_math::Vec3::ZERO } else { extent.hi - extent.lo };
    let row = |what: &str, is: String| [what.to_string(), is];
    let depth = scene.max_depth().map_or("no limit".into(), |edges| format!("{edges} edges"));
    let lights = match i.shining_triangles {
        0 => list(&i.lights),
        n => list(&i.lights).replacen(
            &format!("area: {}", i.lights["area"]),
            &format!("area: {} ({n} triangles)", i.lights["area"]),
            1,
        ),
    };
    let bytes = |n: usize| format!("{}B", units::count(n as f64));
    let memory = format!(
        "{} (meshes {}, tree {}, images {})",
        bytes(i.mesh_bytes + i.tree_bytes + i.image_bytes),
        bytes(i.mesh_bytes),
        bytes(i.tree_bytes),
        bytes(i.image_bytes)
    );
    table(&[
        row("image", format!("{width} x {height} pixels; paths: {depth}")),
        row("shapes", shapes(&i)),
        row("extent", format!("{:.4} x {:.4} x {:.4} m, surface {:.4} m^2", size.x, size.y, size.z, scene.area())),
        row("BSDFs", format!("{} (shapes that have one)", list(&i.bsdfs))),
        row("lights", lights),
        row("media", list(&i.media)),
        row("textures", list(&i.textures)),
        row("memory", memory),
    ])
}

fn shapes(i: &Inventory) -> String {
    let each = i.shapes.iter().map(|(kind, n)| {
        let plural = match (*kind, n) {
            (_, 1) => "",
            ("mesh", _) => "es",
            _ => "s",
        };
        let kind = if *kind == "boundary" && *n != 1 { "boundarie" } else { kind };
        let triangles = if kind == "mesh" { format!(" of {} triangles", i.triangles) } else { String::new() };
        format!("{n} {kind}{plural}{triangles}")
    });
    let each: Vec<String> = each.collect();
    if each.is_empty() { "none".into() } else { each.join(", ") }
}

/// What it takes to render the scene, in sentences.
fn demands(scene: &Scene) -> String {
    let i = scene.inventory();
    let has = |kind: &str| i.bsdfs.contains_key(kind);
    let mut said: Vec<&str> = Vec::new();
    if scene.has_media() {
        said.push("participating media, which few methods know: see below");
    }
    if scene.has_delta_lobes() {
        said.push("mirrors or glass: no virtual light can be connected through them, path-traced steps cross them");
    } else {
        said.push("nothing that light goes through or is mirrored by without scattering");
    }
    if has("roughconductor") || has("roughplastic") || has("roughdielectric") {
        said.push("rough reflections: sharp ones are walked through on the eye's side (`sharp`), or take `vsl`");
    }
    if has("mask") {
        said.push("masks: rays meet them by a coin, shadow rays by what they let through");
    }
    if scene.emitters().has_environment() {
        said.push("light from all around, which virtual lights bring from infinity");
    }
    if i.shining_triangles > 1000 {
        said.push(
            "many shining triangles: light sets over a tree (light-bvh, stochastic-lightcuts) find the near ones",
        );
    }
    if !scene.emitters().shine() {
        said.push("nothing shines: any image is black");
    }
    said.iter().map(|s| format!("  {s}\n")).collect()
}

fn one_method(name: &str, parameters: &[(String, String)], scene: &Scene) -> Result<String, Failure> {
    let recipe = build(name, parameters, scene)?;
    let warnings: String = recipe.warnings.iter().map(|w| format!("  {w}\n")).collect();
    Ok(format!("  {name}: {}\n{warnings}", here(recipe.claim, scene)))
}

/// A promise in a scene where nothing is a mirror, or nearly: nothing can be missed because of one.
fn here(claim: Claim, scene: &Scene) -> Claim {
    let bsdfs = scene.inventory().bsdfs;
    let rough = ["roughconductor", "roughplastic", "roughdielectric"].iter().any(|kind| bsdfs.contains_key(kind));
    if rough || scene.has_delta_lobes() || claim.misses.contains(PathClasses::INDIRECT) {
        return claim;
    }
    Claim { misses: claim.misses.without(PathClasses::CAUSTICS).without(PathClasses::MIRRORED), ..claim }
}

/// What each method promises here, or why it cannot be.
fn all_methods(scene: &Scene) -> String {
    let default = default_method(scene);
    let rows: Vec<_> = methods()
        .iter()
        .map(|m| {
            let says = match build(m.name, &[], scene) {
                Ok(recipe) => here(recipe.claim, scene).to_string(),
                Err(error) => format!("not here: {error}"),
            };
            [if m.name == default { format!("{} (default)", m.name) } else { m.name.to_string() }, says]
        })
        .collect();
    table(&rows)
}
