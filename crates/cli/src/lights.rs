//! `manylight lights`.

use crate::args::Lights;
use crate::failure::Failure;
use crate::interrupt;
use crate::loading::load;
use crate::output::say;
use manylight_framework::{GenerateError, Probe, VirtualLight};
use manylight_render::files;
use manylight_scene::{EmitterPoint, Scatter};
use manylight_scene_io::LoadOptions;
use manylight_vpl::Vpl;

/// Generates the lights of one pass, and writes them.
pub fn run(args: &Lights) -> Result<(), Failure> {
    files::check_writable(&args.output)?;
    let cancel = interrupt::flag()?;
    let options = LoadOptions { defines: args.defines.clone(), ..LoadOptions::default() };
    let loaded = load(&args.scene, &options, false)?;
    let real = |p: &std::path::Path| p.canonicalize().unwrap_or_else(|_| p.into());
    if loaded.files.iter().any(|f| real(f) == real(&args.output)) {
        return Err(Failure::Mistake(format!(
            "{} belongs to the scene and would be overwritten: choose another -o",
            args.output.display()
        )));
    }
    for warning in &loaded.warnings {
        eprintln!("warning: {warning}");
    }
    let generator = manylight_recipes::point_lights(&args.method, &args.parameters, &loaded.scene)?;
    let mut probe = Probe::default();
    probe.cancel = Some(cancel);
    let batch = generator.generate(&loaded.scene, args.pass, args.seed, &mut probe).map_err(|e| match e {
        GenerateError::Cancelled => Failure::InterruptedEarly,
        other => Failure::Mistake(other.to_string()),
    })?;
    let (here, distant): (Vec<Vpl>, Vec<Vpl>) = batch.lights.into_iter().partition(|l| !is_distant(l));
    files::write_atomically(&args.output, &ply(&here, args.ascii))?;
    let bound_for_nowhere = match distant.len() {
        0 => String::new(),
        n => format!(" ({n} more are infinitely far away, and left out)"),
    };
    say(format!(
        "wrote {}: {} lights of {} light paths{bound_for_nowhere}",
        args.output.display(),
        here.len(),
        batch.paths
    ));
    for name in probe.names() {
        say(format!("{name}: {:.4}", probe.mean(name).unwrap_or(0.0)));
    }
    Ok(())
}

fn is_distant(light: &Vpl) -> bool {
    matches!(light.vertex.scatter, Scatter::Emitter(EmitterPoint::Distant { .. }))
}

/// PLY 1.0, text or little endian.
fn ply(lights: &[Vpl], ascii: bool) -> Vec<u8> {
    let format = if ascii { "ascii" } else { "binary_little_endian" };
    let floats: String =
        ["x", "y", "z", "flux_r", "flux_g", "flux_b"].iter().map(|n| format!("property float {n}\n")).collect();
    let colours: String = ["red", "green", "blue"].iter().map(|n| format!("property uchar {n}\n")).collect();
    let mut out = format!(
        "ply\nformat {format} 1.0\ncomment virtual point lights: metres, watts, edges from the emitter\nelement vertex {}\n{floats}property uint edges\n{colours}end_header\n",
        lights.len()
    )
    .into_bytes();
    for light in lights {
        let (p, flux) = (light.vertex.p.to_array(), light.flux.to_array());
        let brightest = light.flux.largest().max(f32::MIN_POSITIVE);
        let colour = flux.map(|c| (255.0 * (c / brightest).clamp(0.0, 1.0)).round() as u8);
        if ascii {
            let numbers = p.iter().chain(&flux).map(f32::to_string);
            let whole = std::iter::once(light.edges().to_string()).chain(colour.iter().map(u8::to_string));
            out.extend(numbers.chain(whole).collect::<Vec<_>>().join(" ").into_bytes());
            out.push(b'\n');
        } else {
            p.iter().chain(&flux).for_each(|x| out.extend(x.to_le_bytes()));
            out.extend(light.edges().to_le_bytes());
            out.extend(colour);
        }
    }
    out
}
