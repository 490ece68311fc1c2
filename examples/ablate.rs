//! Detects each mesh with one thing changed at a time: `ablate OUT LIST VARIANTS.json` (evaluation/ablate.py).
//!
//! LIST has a line "NAME PATH" for each mesh. VARIANTS maps a variant's name to the fields of the default plans, `small`, `wide`
//! and `large`, that it changes, and the `mechanisms` that it switches off; `null` in place of a plan leaves it out. Every map is accepted. Writes OUT/VARIANT/NAME.map and a line for each detection in OUT/log.jsonl.

use intrinsym::internals::base::effort::{Mechanisms, Plan};
use intrinsym::internals::detect::driver::detect_by;
use intrinsym::{Detection, Limits, Mesh, Options, Progress, io};
use serde_json::{Map, Value, json};
use std::error::Error;
use std::fs::{self, File};
use std::io::Write;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [out, list, variants] = &arguments[..] else {
        return Err("usage: ablate OUT LIST VARIANTS.json".into());
    };
    let out = Path::new(out);
    let variants: Map<String, Value> = serde_json::from_str(&fs::read_to_string(variants)?)?;
    let mut log = File::create(out.join("log.jsonl"))?;
    let list = fs::read_to_string(list)?;
    // The first mesh is detected once before, so that what is made once in a process counts for no variant.
    let lines: Vec<&str> = list.lines().collect();
    for (name, path) in lines.iter().filter_map(|line| line.split_once(' ')) {
        let file = io::read(Path::new(path), &Limits::default())?;
        let mesh = Mesh::new(&file.polygons, &Limits::default())?;
        for (variant, changes) in &variants {
            let (options, (plans, mechanisms)) =
                (Options { threads: 1, plausibility: 0, ..Options::default() }, changed(changes)?);
            let start = cpu_seconds()?;
            let found = detect_by(&mesh, &options, &plans, mechanisms, &Progress::default());
            let cpu = cpu_seconds()? - start;
            let line = match found {
                Ok(found) => {
                    write_map(&out.join(variant), name, &found)?;
                    described(&found)
                }
                Err(error) => json!({ "error": error.to_string() }),
            };
            let mut line = line;
            (line["mesh"], line["variant"], line["cpu"]) = (name.into(), variant.as_str().into(), cpu.into());
            writeln!(log, "{line}")?;
        }
    }
    Ok(())
}

/// The default plans and mechanisms with the fields of `changes` replaced, in structures too.
fn changed(changes: &Value) -> Result<(Vec<Plan>, Mechanisms), Box<dyn Error>> {
    let mut plans = json!({
        "small": Plan::small(), "wide": Plan::wide(), "large": Plan::large(), "mechanisms": Mechanisms::default(),
    });
    merge(&mut plans, changes)?;
    let plan = |name| serde_json::from_value::<Option<Plan>>(plans[name].clone());
    let mechanisms = serde_json::from_value(plans["mechanisms"].clone())?;
    Ok(([plan("small")?, plan("wide")?, plan("large")?].into_iter().flatten().collect(), mechanisms))
}

fn merge(into: &mut Value, changes: &Value) -> Result<(), Box<dyn Error>> {
    let (Value::Object(into_fields), Value::Object(fields)) = (&mut *into, changes) else {
        *into = changes.clone();
        return Ok(());
    };
    for (name, value) in fields {
        merge(into_fields.get_mut(name).ok_or_else(|| format!("no field {name} in the plans"))?, value)?;
    }
    Ok(())
}

fn write_map(folder: &Path, name: &str, found: &Detection) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(folder)?;
    if let Some(symmetry) = found.symmetries.first() {
        let partners = symmetry.partner.iter().map(|partner| format!("{partner}\n"));
        fs::write(folder.join(format!("{name}.map")), partners.collect::<String>())?;
    }
    Ok(())
}

fn described(found: &Detection) -> Value {
    let best = found.symmetries.first();
    json!({
        "plausibility": best.map(|symmetry| symmetry.plausibility),
        "mean_confidence": best.map(|symmetry| symmetry.mean_confidence),
        "judged": found.report.judged,
    })
}

/// CPU seconds of the process's first thread, which does all the work: the first number of schedstat is in nanoseconds.
fn cpu_seconds() -> Result<f64, Box<dyn Error>> {
    let text = fs::read_to_string("/proc/self/schedstat")?;
    Ok(text.split_whitespace().next().ok_or("no schedstat")?.parse::<f64>()? * 1e-9)
}
