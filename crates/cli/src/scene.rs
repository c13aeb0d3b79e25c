//! `manylight scene`.

use crate::args::Scene;
use crate::failure::Failure;
use crate::output::{did_you_mean, say, table};
use manylight_scene_io::parametric::{self, ParametricScene, parametric_scenes};
use std::path::PathBuf;

/// Writes a scene, describes it, or lists them all.
pub fn run(args: &Scene) -> Result<(), Failure> {
    let Some(name) = &args.name else {
        say(all());
        return Ok(());
    };
    let scene = find(name)?;
    let rest = parse(&args.rest)?;
    if args.help || rest.help {
        say(described(scene).trim_end());
        return Ok(());
    }
    let no_directory = || Failure::Mistake(format!("where to? `manylight scene {name} -o DIR`"));
    let files = parametric::write(name, &rest.parameters, &rest.output.ok_or_else(no_directory)?)?;
    let names: Vec<String> = files.iter().map(|path| path.display().to_string()).collect();
    say(format!("wrote {}", names.join(", ")));
    Ok(())
}

fn find(name: &str) -> Result<&'static ParametricScene, Failure> {
    parametric_scenes().iter().find(|s| s.name == name).ok_or_else(|| {
        let hint = did_you_mean(name, parametric_scenes().iter().map(|s| s.name));
        Failure::Mistake(format!("there is no parametric scene `{name}`{hint}; `manylight scene` shows all"))
    })
}

fn all() -> String {
    let rows: Vec<_> = parametric_scenes().iter().map(|s| [s.name.to_string(), s.summary.to_string()]).collect();
    let usage = "`manylight scene NAME [--key value]... -o DIR` writes one; `manylight scene NAME --help` shows its parameters.";
    format!("{}\n{usage}", table(&rows))
}

fn described(scene: &ParametricScene) -> String {
    let rows: Vec<_> =
        scene.params.iter().map(|p| [format!("--{} {}", p.name, p.default), p.help.to_string()]).collect();
    format!("{}: {}\n\nParameters with their defaults:\n{}", scene.name, scene.summary, table(&rows))
}

/// What stands after the name of the scene.
#[derive(Debug, Default, PartialEq)]
struct Rest {
    help: bool,
    output: Option<PathBuf>,
    parameters: Vec<(String, String)>,
}

/// The parameters are those of the scene, so that only the scene knows their names.
fn parse(words: &[String]) -> Result<Rest, Failure> {
    let mut rest = Rest::default();
    let mut words = words.iter();
    while let Some(word) = words.next() {
        let key = match word.strip_prefix("--").or_else(|| word.strip_prefix('-').filter(|key| key.len() == 1)) {
            Some("h" | "help") => {
                rest.help = true;
                continue;
            }
            Some(key) if !key.is_empty() => key,
            _ => return Err(Failure::Mistake(format!("`{word}` is not a parameter: expected --key value or -o DIR"))),
        };
        let (key, value) = match key.split_once('=') {
            Some((key, value)) => (key, value),
            None => match words.next() {
                Some(value) => (key, value.as_str()),
                None => return Err(Failure::Mistake(format!("`{word}` has no value: expected {word} VALUE"))),
            },
        };
        match key {
            "o" | "output" => rest.output = Some(value.into()),
            _ => rest.parameters.push((key.into(), value.into())),
        }
    }
    Ok(rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(line: &str) -> Result<Rest, Failure> {
        parse(&line.split_whitespace().map(String::from).collect::<Vec<_>>())
    }
    #[test]
    fn parameters_and_the_directory_may_come_in_any_order_and_form() {
        let expected = Rest {
            help: false,
            output: Some("dir".into()),
            parameters: vec![("lamps".into(), "10".into()), ("offset".into(), "-1".into())],
        };
        assert_eq!(parsed("--lamps 10 -o dir --offset -1").unwrap(), expected);
        assert_eq!(parsed("--output=dir --lamps=10 --offset=-1").unwrap(), expected);
        assert!(parsed("--help").unwrap().help);
    }
    #[test]
    fn what_is_neither_is_named() {
        for (line, named) in
            [("lamps", "`lamps`"), ("--lamps", "--lamps VALUE"), ("-lamps 3", "`-lamps`"), ("--", "`--`")]
        {
            let mistake = parsed(line).unwrap_err().to_string();
            assert!(mistake.contains(named), "{mistake}");
        }
    }
}
