//! `manylight list`.

use crate::args::List;
use crate::failure::Failure;
use crate::output::{say, table};
use manylight_framework::Claim;
use manylight_math::DAffine3;
use manylight_recipes::{MethodInfo, Param, build, method, methods};
use manylight_scene::{Camera, Scene};

/// Lists the methods, or describes one.
pub fn run(args: &List) -> Result<(), Failure> {
    match &args.method {
        None => say(all()),
        Some(name) => say(described(method(name)?)?.trim_end()),
    }
    Ok(())
}

fn all() -> String {
    let rows: Vec<_> = methods().iter().map(|m| [m.name.to_string(), m.summary.to_string()]).collect();
    let default = methods()[0].name;
    format!(
        "{}\nThe default is {default}, or vrl where a scene has media. `manylight list NAME` shows a method's parameters.",
        table(&rows)
    )
}

fn described(method: &MethodInfo) -> Result<String, Failure> {
    let MethodInfo { name, summary, paper, .. } = method;
    let claim = default_claim(name)?;
    let parameters = parameters(method.params());
    Ok(format!(
        "{name}: {summary}\n{paper}\nWith the defaults: {claim}.\n\nParameters, set by -P name=value:\n{parameters}"
    ))
}

/// What a method promises with its default parameters. A method is built for a scene: any will do.
fn default_claim(name: &str) -> Result<Claim, Failure> {
    let mut nothing = Scene::builder();
    nothing.camera(Camera::perspective(DAffine3::IDENTITY, 45.0, (1, 1))?);
    Ok(build(name, &[], &nothing.build()?)?.claim)
}

/// Name with default, what it can be, and what it means, of each parameter.
fn parameters(params: impl Iterator<Item = Param>) -> String {
    let describe = |p: Param| {
        let with = p.part_of.map_or(String::new(), |(other, values)| format!(" (with {other}={})", values.join("|")));
        let unit = if p.unit.is_empty() { String::new() } else { format!(" [{}]", p.unit) };
        format!("  {}={}{unit}: {}{with}\n      {}\n", p.name, p.default, p.kind.expected(), p.help)
    };
    params.map(describe).collect()
}
